#include "surface/insulators.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/reading.hpp"
#include "geometry/surface_mesh.hpp"
#include "surface/charged_readings.hpp"
#include "surface/contact.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Distance of the points beside a part of a surface, relative to its size; above rounding, below any
/// feature.
constexpr double beside_part = 1e-5;

Insulator insulator_of(const Object& object, const Eigen::Isometry3d& pose, double medium) {
  /// Difference of a permittivity from the medium's, relative, of which little more than rounding is seen.
  constexpr double invisible = 1e-9;
  Insulator result;
  result.name = fmt::format("object \"{}\"", object.name);
  result.ratio = std::get<Dielectric>(object.role).relative_permittivity / medium;
  if (std::abs(result.ratio - 1) < invisible)
    result.ratio = 1;
  if (!(pose * object.pose).matrix().allFinite())
    throw InputError(fmt::format("{}: its pose is not finite", result.name));
  result.surface = surface_triangles(object);
  if (!is_closed(result.surface))
    throw InputError(fmt::format("{} is dielectric, but its surface encloses no volume", result.name));
  for (Triangle& triangle : result.surface)
    triangle = transformed(triangle, pose * object.pose);
  if (signed_volume(result.surface) < 0)
    for (Triangle& triangle : result.surface)
      std::swap(triangle[1], triangle[2]);
  result.box = axis_aligned_box(result.surface);
  refuse_rounding(result.name, result.box);
  result.round = RoundShape::of(object.shape, pose * object.pose);
  return result;
}

/// Throws InputError if a conductor reaches into a cover: it is thicker than the gap.
void refuse_conductors_inside(const Insulator& cover, const ChargedBodies& conductors) {
  /// Part of its size by which a cover is shrunk: what only touches it is then apart.
  constexpr double shrinking = 1e-6;
  const Vector3d centre = cover.box.center();
  ChargedBody shrunk = surface_of(cover);
  for (Triangle& triangle : std::get<TriangleSurface>(shrunk.surface).triangles)
    for (Vector3d& corner : triangle)
      corner += shrinking * (centre - corner);
  for (const ChargedBody& body : conductors.bodies)
    refuse_contact(shrunk, body, "a cover must not be thicker than the gap before it");
}

/// Least cosine of the angle between a part and the surface it lies on.
constexpr double least_parallel_cosine = 1 - 1e-6;

/// Returns true if a point lies on a triangle.
bool lies_on(const Vector3d& point, const Triangle& triangle, double tolerance) {
  const Vector3d own = unit_normal(triangle);
  if (std::abs(own.dot(point - triangle[0])) > tolerance)
    return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d side = triangle[(k + 1) % 3] - triangle[k];
    if (side.cross(point - triangle[k]).dot(own) < -tolerance * side.norm())
      return false;
  }
  return true;
}

/// Returns true if a point lies on one of the triangles that are parallel to a plane through the point.
bool lies_on(const Vector3d& point, const Vector3d& normal, std::span<const Triangle> surface,
             double tolerance) {
  return std::any_of(surface.begin(), surface.end(), [&](const Triangle& triangle) {
    return std::abs(unit_normal(triangle).dot(normal)) >= least_parallel_cosine &&
           lies_on(point, triangle, tolerance);
  });
}

/// Distance below which a point lies on a surface.
double distance_of_touching(const AlignedBox3d& own, const AlignedBox3d& other) {
  return 2 * touching_surfaces * std::max(own.diagonal().norm(), other.diagonal().norm());
}

/// Tells for each body whether the box around it meets that of no other.
std::vector<bool> standing_apart(const InsulatedBodies& bodies) {
  std::vector<AlignedBox3d> boxes;
  /// A facet may be deeper than at its middle.
  constexpr double deeper = 2;
  const auto add = [&](const AlignedBox3d& box, const RoundShape* round, std::span<const Triangle> surface) {
    const Vector3d margin =
        Vector3d::Constant(round != nullptr ? deeper * round->greatest_depth(surface) : 0);
    boxes.emplace_back(box.min() - margin, box.max() + margin);
  };
  for (const ChargedBody& body : bodies.conductors.bodies)
    add(bounds_of(body), round_shape_of(body.surface), triangles_of(body.surface));
  for (const Insulator& insulator : bodies.insulators)
    add(insulator.box, insulator.round ? &*insulator.round : nullptr, insulator.surface);
  for (const ThinFilm& film : bodies.films)
    add(film.box, nullptr, {});
  std::vector<bool> result(boxes.size(), true);
  for (std::size_t k = 0; k < boxes.size(); ++k)
    for (std::size_t other = 0; other < k; ++other)
      if (boxes[k].intersects(boxes[other]))
        result[k] = result[other] = false;
  return result;
}

}  // namespace

Scene without_insulators(const Scene& scene) {
  Scene result = scene;
  std::erase_if(result.objects,
                [](const Object& object) { return std::holds_alternative<Dielectric>(object.role); });
  result.readings.clear();
  return result;
}

std::vector<LinkedInsulator> insulators_on_links(const Scene& scene) {
  std::vector<LinkedInsulator> result;
  const std::vector<bool> are_targets = targets(scene);
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    const Object& object = scene.objects[k];
    if (!std::holds_alternative<Dielectric>(object.role))
      continue;
    result.push_back({insulator_of(object, Eigen::Isometry3d::Identity(), scene.medium.relative_permittivity),
                      object.link});
    result.back().body.is_target = are_targets[k];
  }
  return result;
}

Insulator moved(const Insulator& insulator, const Eigen::Isometry3d& pose) {
  Insulator result = insulator;
  for (Triangle& triangle : result.surface)
    triangle = transformed(triangle, pose);
  result.box = axis_aligned_box(result.surface);
  refuse_rounding(result.name, result.box);
  if (insulator.round)
    result.round = insulator.round->moved(pose);
  return result;
}

ChargedBody surface_of(const Insulator& insulator) {
  return {0, 0, TriangleSurface{insulator.surface, insulator.round}, insulator.name, {}};
}

bool has_insulators(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [](const Object& object) { return std::holds_alternative<Dielectric>(object.role); });
}

void refuse_thick_covers(const Scene& scene) {
  if (!std::ranges::any_of(scene.objects, is_cover))
    return;
  const std::vector<Eigen::Isometry3d> link_poses = world_poses(scene.links);
  ChargedBodies conductors = bodies_on_links(without_insulators(scene));
  for (ChargedBody& body : conductors.bodies)
    body = moved(body, attachment_pose(link_poses, body.link));
  for (const Object& object : scene.objects)
    if (is_cover(object))
      refuse_conductors_inside(
          insulator_of(object, attachment_pose(link_poses, object.link), scene.medium.relative_permittivity),
          conductors);
}

InsulatedBodies insulated_bodies(const Scene& scene, bool with_readings) {
  InsulatedBodies result;
  result.conductors = charged_bodies(without_insulators(scene));
  ChargedBodies& conductors = result.conductors;
  const std::vector<bool> are_targets = targets(scene);
  for (ChargedBody& body : conductors.bodies) {
    body.surface = oriented_triangles(body.surface);
    const std::string& name = conductors.conductors[body.conductor].members[body.member];
    for (std::size_t k = 0; k < scene.objects.size(); ++k)
      if (scene.objects[k].name == name)
        body.is_target = are_targets[k];
  }
  conductors.readings.clear();
  if (with_readings || asks_for_changes(scene))
    conductors.readings = charged_readings(readings(scene), drivable_conductors(conductors));
  const std::vector<Eigen::Isometry3d> link_poses = world_poses(scene.links);
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    const Object& object = scene.objects[k];
    if (!std::holds_alternative<Dielectric>(object.role))
      continue;
    result.insulators.push_back(
        insulator_of(object, attachment_pose(link_poses, object.link), scene.medium.relative_permittivity));
    result.insulators.back().is_target = are_targets[k];
    if (is_cover(object))
      refuse_conductors_inside(result.insulators.back(), conductors);
  }
  return result;
}

bool follows_shape(const Insulator& insulator) {
  /// Least volume over the area to the power 3/2; a flat spheroid of 10 : 1 has 0.025. Beside the opposite
  /// face of thinner curved bodies the solid angles of panels that are divided otherwise are not accurate:
  /// one of 25 : 1 had no solution.
  constexpr double thinnest = 0.02;
  if (!insulator.round || !insulator.round->is_followed())
    return false;
  double area = 0;
  for (const Triangle& triangle : insulator.surface)
    area += twice_area(triangle) / 2;
  return !insulator.round->is_lack_added() ||
         std::abs(signed_volume(insulator.surface)) >= thinnest * std::pow(area, 1.5);
}

InsulatedBodies with_few_facets(InsulatedBodies bodies) {
  /// Largest number of triangles of a round body: a ball of 12 segments has 120.
  constexpr std::size_t most = 160;
  const std::size_t conductors = bodies.conductors.bodies.size();
  const std::vector<Insulator> given = bodies.insulators;
  const std::vector<bool> were_apart = standing_apart(bodies);
  for (std::size_t k = 0; k < given.size(); ++k) {
    Insulator& insulator = bodies.insulators[k];
    if (!were_apart[conductors + k] || !insulator.round || insulator.surface.size() <= most)
      continue;
    insulator.round = insulator.round->with_fewer_triangles(most);
    insulator.surface = insulator.round->triangles();
    insulator.box = axis_aligned_box(insulator.surface);
  }
  // A box around fewer facets and what they lack is larger.
  const std::vector<bool> are_apart = standing_apart(bodies);
  for (std::size_t k = 0; k < given.size(); ++k)
    if (!are_apart[conductors + k] || !follows_shape(bodies.insulators[k]))
      bodies.insulators[k] = given[k];
  return bodies;
}

Presence everything(const InsulatedBodies& bodies) {
  return {std::vector<bool>(bodies.conductors.bodies.size(), true),
          std::vector<bool>(bodies.insulators.size(), true), std::vector<bool>(bodies.films.size(), true)};
}

Presence without_targets(const InsulatedBodies& bodies) {
  Presence result;
  for (const ChargedBody& body : bodies.conductors.bodies)
    result.conductors.push_back(!body.is_target);
  for (const Insulator& insulator : bodies.insulators)
    result.insulators.push_back(!insulator.is_target);
  for (const ThinFilm& film : bodies.films)
    result.films.push_back(!film.is_target);
  return result;
}

Presence sensors_alone(const InsulatedBodies& bodies) {
  Presence result;
  for (const ChargedBody& body : bodies.conductors.bodies)
    result.conductors.push_back(bodies.conductors.role(body) == Role::sensor);
  result.insulators.assign(bodies.insulators.size(), false);
  result.films.assign(bodies.films.size(), false);
  return result;
}

Surroundings::Surroundings(const InsulatedBodies& bodies, Presence presence)
    : bodies_(bodies), presence_(std::move(presence)), are_apart_(standing_apart(bodies)) {
  for (std::size_t k = 0; k < bodies.conductors.bodies.size(); ++k) {
    const auto* surface = std::get_if<TriangleSurface>(&bodies.conductors.bodies[k].surface);
    if (presence_.conductors[k] && surface != nullptr && is_closed(surface->triangles))
      closed_.push_back({&surface->triangles, axis_aligned_box(surface->triangles)});
  }
}

bool Surroundings::is_in_conductor(const Vector3d& point) const {
  return std::any_of(closed_.begin(), closed_.end(), [&](const Closed& closed) {
    return closed.box.contains(point) && is_in_polyhedron(*closed.surface, point);
  });
}

const Insulator* Surroundings::insulator_at(const Vector3d& point) const {
  for (std::size_t k = bodies_.insulators.size(); k-- > 0;) {
    const Insulator& insulator = bodies_.insulators[k];
    if (presence_.insulators[k] && insulator.box.contains(point) &&
        is_in_polyhedron(insulator.surface, point))
      return &insulator;
  }
  return nullptr;
}

double Surroundings::ratio_at(const Vector3d& point) const {
  const Insulator* const insulator = insulator_at(point);
  return insulator == nullptr || is_in_conductor(point) ? 1 : insulator->ratio;
}

bool Surroundings::is_outside(const Vector3d& point) const {
  return insulator_at(point) == nullptr && !is_in_conductor(point);
}

bool Surroundings::is_outermost(const Triangle& part) const {
  const Vector3d centre = centre_of(part);
  const Vector3d away = beside_part * std::sqrt(twice_area(part)) * unit_normal(part);
  return is_outside(centre - away) || is_outside(centre + away);
}

bool Surroundings::is_inside_conductor(std::size_t insulator) const {
  const auto& surface = bodies_.insulators[insulator].surface;
  return std::all_of(surface.begin(), surface.end(),
                     [&](const Triangle& triangle) { return is_in_conductor(centre_of(triangle)); });
}

template <class Touches>
std::optional<std::size_t> Surroundings::conductor_near(const Vector3d& point, const AlignedBox3d& own,
                                                        const Touches& touches) const {
  for (std::size_t k = 0; k < bodies_.conductors.bodies.size(); ++k) {
    if (!presence_.conductors[k])
      continue;
    const auto triangles = triangles_of(bodies_.conductors.bodies[k].surface);
    const AlignedBox3d box = axis_aligned_box(triangles);
    const double tolerance = distance_of_touching(own, box);
    if (box.exteriorDistance(point) <= tolerance && touches(triangles, tolerance))
      return k;
  }
  return std::nullopt;
}

bool Surroundings::lies_on_conductor(const Triangle& part, const AlignedBox3d& own) const {
  const Vector3d centre = centre_of(part), normal = unit_normal(part);
  return conductor_near(centre, own,
                        [&](std::span<const Triangle> triangles, double tolerance) {
                          return lies_on(centre, normal, triangles, tolerance);
                        })
      .has_value();
}

std::optional<std::size_t> Surroundings::conductor_at(const Vector3d& point, const AlignedBox3d& own) const {
  return conductor_near(point, own, [&](std::span<const Triangle> triangles, double tolerance) {
    return std::any_of(triangles.begin(), triangles.end(),
                       [&](const Triangle& triangle) { return lies_on(point, triangle, tolerance); });
  });
}

std::optional<std::pair<std::size_t, bool>> Surroundings::film_on(const Triangle& part) const {
  const Vector3d centre = centre_of(part), normal = unit_normal(part);
  for (std::size_t k = 0; k < bodies_.films.size(); ++k) {
    const ThinFilm& film = bodies_.films[k];
    const double tolerance = distance_of_touching(film.box, film.box);
    if (presence_.films[k] && film.box.exteriorDistance(centre) <= tolerance &&
        lies_on(centre, normal, film.sheet, tolerance))
      return std::pair(k, normal.dot(unit_normal(film.sheet.front())) > 0);
  }
  return std::nullopt;
}

PartState Surroundings::state(const Triangle& part, std::size_t body) const {
  const std::size_t conductors = bodies_.conductors.bodies.size();
  const std::size_t solids = conductors + bodies_.insulators.size();
  if (body >= solids) {
    const bool is_there =
        presence_.films[body - solids] && !lies_on_conductor(part, bodies_.films[body - solids].box);
    return {is_there ? PartKind::film : PartKind::absent, {1, 1}};
  }
  const bool is_conductor = body < conductors;
  if (!(is_conductor ? presence_.conductors[body] : presence_.insulators[body - conductors]))
    return {};
  const Vector3d centre = centre_of(part), normal = unit_normal(part);
  const double size = std::sqrt(twice_area(part));
  const Vector3d away = beside_part * size * normal;
  // Panels that follow a round shape lie outside of its triangles, and nothing else is near.
  const Ratios ratios = are_apart_[body]
                            ? Ratios{is_conductor ? 1 : bodies_.insulators[body - conductors].ratio, 1}
                            : Ratios{ratio_at(centre - away), ratio_at(centre + away)};
  if (is_conductor)
    return {PartKind::conductor, ratios};
  if (ratios.behind == ratios.before)
    return {};
  if (are_apart_[body])
    return {PartKind::interface, ratios};
  const Insulator& own = bodies_.insulators[body - conductors];
  if (lies_on_conductor(part, own.box))
    return {};
  for (std::size_t k = 0; k + conductors < body; ++k) {
    const Insulator& earlier = bodies_.insulators[k];
    const double tolerance = distance_of_touching(own.box, earlier.box);
    if (presence_.insulators[k] && earlier.box.exteriorDistance(centre) <= tolerance &&
        lies_on(centre, normal, earlier.surface, tolerance))
      return {};
  }
  return {PartKind::interface, ratios};
}

}  // namespace fringe::detail
