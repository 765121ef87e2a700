#include "surface/simplification.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <meshoptimizer.h>

#include "fringe/gjk.hpp"
#include "geometry/box_tree.hpp"
#include "geometry/surface_mesh.hpp"
#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Number of triangles of a surface up to which it stays as it is in any scene.
constexpr std::size_t few_triangles_of_surface = 100;

/// Collapses edges of a part of a mesh, given by its faces, while the surface moves by less than `tolerance`
/// (m). Vertices stay where they are, those at the border of the part are kept.
std::vector<Triangle> collapsed(const SurfaceMesh& mesh, const std::vector<std::uint32_t>& faces,
                                const Vector3d& centre, double tolerance) {
  check_interruption();
  std::vector<float> positions;
  for (const Vector3d& vertex : mesh.vertices())
    for (const double coordinate : vertex - centre)
      positions.push_back(static_cast<float>(coordinate));
  std::vector<unsigned int> indices;
  for (const std::uint32_t face : faces)
    indices.insert(indices.end(), mesh.faces()[face].begin(), mesh.faces()[face].end());
  constexpr std::size_t stride = 3 * sizeof(float);
  const float scale = meshopt_simplifyScale(positions.data(), mesh.vertices().size(), stride);
  std::vector<unsigned int> left(indices.size());
  left.resize(meshopt_simplify(left.data(), indices.data(), indices.size(), positions.data(),
                               mesh.vertices().size(), stride, 0, static_cast<float>(tolerance) / scale,
                               meshopt_SimplifyLockBorder, nullptr));
  std::vector<Triangle> triangles;
  for (std::size_t k = 0; k < left.size(); k += 3)
    triangles.push_back(
        {mesh.vertices()[left[k]], mesh.vertices()[left[k + 1]], mesh.vertices()[left[k + 2]]});
  return triangles;
}

/// The triangles of a surface in a bounding volume hierarchy.
class NearestTriangle {
 public:
  explicit NearestTriangle(const std::vector<Triangle>& triangles) : triangles_(triangles) {
    std::vector<AlignedBox3d> boxes;
    boxes.reserve(triangles.size());
    for (const Triangle& triangle : triangles)
      boxes.push_back(axis_aligned_box({&triangle, 1}));
    tree_ = BoxTree(boxes);
  }

  double distance(const Vector3d& point) const {
    double nearest = std::numeric_limits<double>::infinity();
    search(tree_.root(), point, nearest);
    return nearest;
  }

 private:
  void search(const BoxTree::Node& node, const Vector3d& point, double& nearest) const {
    if (node.box.exteriorDistance(point) >= nearest)
      return;
    if (node.is_leaf()) {
      nearest = std::min(nearest, gjk_distance({&point, 1}, triangles_[tree_.item(node)]).distance);
      return;
    }
    const BoxTree::Node *first = &tree_.left(node), *second = &tree_.right(node);
    if (second->box.squaredExteriorDistance(point) < first->box.squaredExteriorDistance(point))
      std::swap(first, second);
    search(*first, point, nearest);
    search(*second, point, nearest);
  }

  const std::vector<Triangle>& triangles_;
  BoxTree tree_;
};

/// Returns the mean distance from some faces of a mesh to a surface, weighted by their areas.
double mean_distance(const SurfaceMesh& mesh, const std::vector<std::uint32_t>& faces,
                     const NearestTriangle& surface) {
  /// Number of faces that are looked at: enough for a mean to a tenth.
  constexpr std::size_t samples = 300;
  double sum = 0, area = 0;
  const std::size_t stride = 1 + faces.size() / samples;
  for (std::size_t k = 0; k < faces.size(); k += stride) {
    check_interruption();
    const SurfaceMesh::Face& face = mesh.faces()[faces[k]];
    const Triangle triangle{mesh.vertices()[face[0]], mesh.vertices()[face[1]], mesh.vertices()[face[2]]};
    const double own = twice_area(triangle);
    sum += own * (surface.distance(centre_of(triangle)) + surface.distance(triangle[0])) / 2;
    area += own;
  }
  return area > 0 ? sum / area : 0;
}

}  // namespace

Simplification::Zones::Zones(const ChargedBodies& bodies, std::size_t body, std::vector<AlignedBox3d> others,
                             double of_part)
    : others_(std::move(others)) {
  AlignedBox3d conductor;
  for (const ChargedBody& other : bodies.bodies)
    if (other.conductor == bodies.bodies[body].conductor)
      conductor.extend(bounds_of(other));
    else
      others_.push_back(bounds_of(other));
  size_ =
      std::min(conductor.diagonal().norm(), of_part * bounds_of(bodies.bodies[body]).diagonal().norm()) / 4;
}

std::size_t Simplification::Zones::zone(const Vector3d& point) const {
  double distance = size_;
  for (const AlignedBox3d& other : others_)
    distance = std::min(distance, other.exteriorDistance(point));
  const double halvings = std::log2(size_ / distance);
  return static_cast<std::size_t>(std::clamp(halvings, 0.0, count - 1.0));
}

double Simplification::Zones::tolerance(std::size_t zone) const {
  // The least distance in the zone; a distance of less than the last zone's has no end.
  return zone + 1 < count ? std::ldexp(size_, -static_cast<int>(zone) - 1) : 0;
}

Simplification::Simplification(ChargedBodies bodies, double tolerance, std::size_t most_triangles,
                               std::vector<AlignedBox3d> others, double of_part)
    : bodies_(std::move(bodies)), others_(std::move(others)), of_part_(of_part) {
  if (triangles() <= few_triangles)
    return;
  /// Tolerance beyond which a surface would no longer be that of the body.
  constexpr double coarsest = 0.5;
  const ChargedBodies original = bodies_;
  do {
    simplify(original, tolerance);
    tolerance *= 2;
  } while (triangles() > most_triangles && tolerance <= coarsest);
}

std::size_t Simplification::triangles() const {
  std::size_t total = 0;
  for (const ChargedBody& body : bodies_.bodies)
    total += triangles_of(body.surface).size();
  return total;
}

void Simplification::simplify(const ChargedBodies& original, double tolerance) {
  surfaces_.clear();
  for (std::size_t k = 0; k < original.bodies.size(); ++k) {
    const ChargedBody& body = original.bodies[k];
    const std::span<const Triangle> old = triangles_of(body.surface);
    if (old.size() <= few_triangles_of_surface)
      continue;
    Surface surface{k, Zones(original, k, others_, of_part_), std::vector<double>(Zones::count, 0)};
    const SurfaceMesh mesh(old);
    std::array<std::vector<std::uint32_t>, Zones::count> faces;
    check_interruption();
    for (std::uint32_t face = 0; face < old.size(); ++face)
      faces[surface.zones.zone(centre_of(old[face]))].push_back(face);
    const Vector3d centre = bounds_of(body).center();
    std::vector<Triangle> triangles;
    for (std::size_t zone = 0; zone < Zones::count; ++zone) {
      if (faces[zone].empty())
        continue;
      const std::vector<Triangle> part =
          collapsed(mesh, faces[zone], centre, tolerance * surface.zones.tolerance(zone));
      triangles.insert(triangles.end(), part.begin(), part.end());
    }
    if (area(triangles) == 0)
      continue;
    triangles = cleaned(body.name, triangles);
    const NearestTriangle nearest(triangles);
    for (std::size_t zone = 0; zone < Zones::count; ++zone)
      surface.deviations[zone] = mean_distance(mesh, faces[zone], nearest);
    surfaces_.push_back(std::move(surface));
    std::get<TriangleSurface>(bodies_.bodies[k].surface).triangles = std::move(triangles);
  }
}

bool Simplification::is_within() const {
  return !is_changed() && std::all_of(bodies_.bodies.begin(), bodies_.bodies.end(), [](const auto& body) {
    const RoundShape* const round = round_shape_of(body.surface);
    return round == nullptr || round->contains_polyhedron();
  });
}

double Simplification::deviation(std::size_t body, const Vector3d& point) const {
  const auto surface = std::find_if(surfaces_.begin(), surfaces_.end(),
                                    [&](const Surface& candidate) { return candidate.body == body; });
  return surface == surfaces_.end() ? 0 : surface->deviations[surface->zones.zone(point)];
}

}  // namespace fringe::detail
