#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "surface/contact.hpp"
#include "surface/insulators.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// A layer between two equal plane faces.
struct Layer {
  std::vector<Triangle> lower, upper;  ///< with the normal from the lower to the upper face
  Vector3d normal;
  double thickness;
  double area;
};

/// Returns the two faces of a prism with right-angled walls; nothing for other bodies.
std::optional<Layer> layer_of(const Insulator& insulator) {
  /// Largest sine and least cosine of the angle between the normals of walls, of faces and that of the layer.
  constexpr double upright = 1e-9, parallel = 1 - 1e-9;
  const auto& surface = insulator.surface;
  const auto largest = std::max_element(surface.begin(), surface.end(), [](const auto& a, const auto& b) {
    return twice_area(a) < twice_area(b);
  });
  Layer layer;
  layer.normal = unit_normal(*largest);
  const double tolerance = touching_surfaces * insulator.box.diagonal().norm();
  const double top = layer.normal.dot((*largest)[0]);
  double bottom = top;
  for (const Triangle& triangle : surface)
    for (const Vector3d& corner : triangle)
      bottom = std::min(bottom, layer.normal.dot(corner));
  layer.thickness = top - bottom;
  for (const Triangle& triangle : surface) {
    const double cosine = layer.normal.dot(unit_normal(triangle)), height = layer.normal.dot(triangle[0]);
    if (cosine > parallel && std::abs(height - top) <= tolerance)
      layer.upper.push_back(triangle);
    else if (cosine < -parallel && std::abs(height - bottom) <= tolerance)
      layer.lower.push_back({triangle[0], triangle[2], triangle[1]});
    else if (std::abs(cosine) > upright)
      return std::nullopt;
  }
  layer.area = fringe::area(layer.upper);
  return layer;
}

/// Returns a layer without what touches it only: without_skin by a part of its size, and of its thickness.
Insulator without_skin(const Insulator& insulator, const Vector3d& normal) {
  constexpr double of_size = 1e-6, of_thickness = 1e-3;
  Insulator result = insulator;
  for (Triangle& triangle : result.surface)
    for (Vector3d& corner : triangle) {
      const Vector3d inwards = insulator.box.center() - corner;
      corner += of_size * inwards + of_thickness * normal.dot(inwards) * normal;
    }
  return result;
}

/// Returns a dielectric body as a film if it is a thin layer that meets nothing but conductors, and those
/// with one face only.
std::optional<ThinFilm> film_of(const InsulatedBodies& bodies, std::size_t index) {
  /// Largest thickness, relative to the square root of the area.
  constexpr double thin = 0.01;
  const Insulator& insulator = bodies.insulators[index];
  if (insulator.ratio <= 1)
    return std::nullopt;
  const std::optional<Layer> layer = layer_of(insulator);
  if (!layer || layer->thickness > thin * std::sqrt(layer->area))
    return std::nullopt;
  for (std::size_t k = 0; k < bodies.insulators.size(); ++k)
    if (k != index && are_in_contact(surface_of(insulator), surface_of(bodies.insulators[k])))
      return std::nullopt;
  const ChargedBody inside = surface_of(without_skin(insulator, layer->normal));
  const ChargedBody lower{0, 0, TriangleSurface{layer->lower}, insulator.name, {}};
  const ChargedBody upper{0, 0, TriangleSurface{layer->upper}, insulator.name, {}};
  bool is_touched_below = false, is_touched_above = false;
  for (const ChargedBody& body : bodies.conductors.bodies) {
    if (are_in_contact(inside, body))
      return std::nullopt;
    is_touched_below = is_touched_below || are_in_contact(lower, body);
    is_touched_above = is_touched_above || are_in_contact(upper, body);
  }
  if (is_touched_below && is_touched_above)
    return std::nullopt;
  ThinFilm film{insulator.name,
                is_touched_above ? layer->upper : layer->lower,
                {},
                layer->thickness,
                insulator.ratio,
                is_touched_above ? layer->thickness : 0,
                insulator.is_target};
  if (!is_touched_above && !is_touched_below) {
    film.behind = layer->thickness / 2;
    for (Triangle& triangle : film.sheet)
      for (Vector3d& corner : triangle)
        corner += film.behind * layer->normal;
  }
  film.box = axis_aligned_box(film.sheet);
  return film;
}

/// Returns true if a film, the last of the bodies', is much wider than what it lies on. A layer on a
/// conductor alone needs no sheet: its potential hardly varies along it.
bool is_wide(const InsulatedBodies& bodies) {
  /// Least width, in thicknesses, of a rim around a square of the film's area.
  constexpr double rim = 5;
  const ThinFilm& film = bodies.films.back();
  const std::vector<Triangle> parts = divided_surfaces(bodies).back();
  const Surroundings all(bodies, everything(bodies));
  const std::size_t last =
      bodies.conductors.bodies.size() + bodies.insulators.size() + bodies.films.size() - 1;
  double uncovered = 0;
  for (const Triangle& part : parts)
    if (all.state(part, last).kind == PartKind::film)
      uncovered += twice_area(part) / 2;
  return uncovered > 4 * rim * film.thickness * std::sqrt(fringe::area(film.sheet));
}

}  // namespace

InsulatedBodies with_thin_films(InsulatedBodies bodies) {
  for (std::size_t k = bodies.insulators.size(); k-- > 0;) {
    const std::optional<ThinFilm> film = film_of(bodies, k);
    if (!film)
      continue;
    InsulatedBodies changed = bodies;
    changed.insulators.erase(changed.insulators.begin() + static_cast<std::ptrdiff_t>(k));
    changed.films.push_back(*film);
    if (is_wide(changed))
      bodies = std::move(changed);
  }
  return bodies;
}

}  // namespace fringe::detail
