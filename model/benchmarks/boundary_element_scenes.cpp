#include "boundary_element_scenes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "fringe/scene_reader.hpp"

namespace fringe::benchmarks {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Object grounded(const std::string& name, const Shape& shape, const Vector3d& centre) {
  Object object;
  object.name = name;
  object.shape = shape;
  object.pose.translate(centre);
  return object;
}

/// Makes a sensor of 10 cm that faces a hand, the target, 5 cm before it.
Scene sensor_and_hand() {
  Scene scene;
  scene.sensors.push_back({"front", {}, 2.5, 5e-12, {{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}}}});
  scene.objects.push_back(grounded("hand", Cuboid{0.08, 0.18, 0.03}, {0, 0, 0.065}));
  scene.objects.back().target = true;
  return scene;
}

/// Makes two parallel plates as the default study has them.
Scene two_plates() {
  Scene scene = sensor_and_hand();
  scene.objects = {grounded("target", Plate{0.1, 0.1}, {0, 0, 0.04})};
  return scene;
}

/// Puts a housing 2 mm behind the sensor.
Scene before_housing() {
  Scene scene = sensor_and_hand();
  scene.objects.push_back(grounded("housing", Cuboid{0.12, 0.12, 0.1}, {0, 0, -0.052}));
  return scene;
}

/// Adds a cylinder 1 mm beside the housing.
Scene beside_cylinder() {
  Scene scene = before_housing();
  scene.objects.push_back(grounded("cylinder", Cylinder{0.04, 0.12, 48}, {0.101, 0, -0.052}));
  return scene;
}

/// Puts the sensor 1 cm before the last of eight links. Each is a capsule from one joint to the next, so that
/// neighbours overlap in the joint between them.
Scene robot_arm() {
  const std::array<Vector3d, 9> joints{{{-0.10, -0.60, -0.80},
                                        {-0.10, -0.60, -0.62},
                                        {0.02, -0.60, -0.60},
                                        {0.02, -0.42, -0.25},
                                        {-0.06, -0.40, -0.20},
                                        {-0.06, -0.10, -0.30},
                                        {0.03, -0.06, -0.30},
                                        {0.03, 0, -0.20},
                                        {0, 0, -0.055}}};
  constexpr std::array radii{0.075, 0.07, 0.06, 0.055, 0.05, 0.05, 0.045, 0.045};
  constexpr int segments = 24;  // 576 triangles a link
  Scene scene = sensor_and_hand();
  for (std::size_t k = 0; k < radii.size(); ++k) {
    const Vector3d along = joints[k + 1] - joints[k];
    scene.objects.push_back(grounded("link " + std::to_string(k + 1),
                                     Capsule{radii[k], along.norm(), segments},
                                     (joints[k] + joints[k + 1]) / 2));
    scene.objects.back().pose.rotate(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), along));
  }
  return scene;
}

/// Returns the points (±a, ±b, ±c), each once.
std::vector<Vector3d> with_all_signs(const Vector3d& point) {
  std::vector<Vector3d> points;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) {
        const Vector3d other = point.cwiseProduct(Vector3d(x, y, z));
        if (std::find(points.begin(), points.end(), other) == points.end())
          points.push_back(other);
      }
  return points;
}

/// Adds the points (±a, ±b, ±c), (±c, ±a, ±b) and (±b, ±c, ±a).
void add_turned(const Vector3d& point, std::vector<Vector3d>& points) {
  for (const Vector3d& turned :
       {point, Vector3d(point[2], point[0], point[1]), Vector3d(point[1], point[2], point[0])})
    for (const Vector3d& other : with_all_signs(turned))
      points.push_back(other);
}

/// Returns the triangles of a convex polyhedron with faces in given directions: those between the first
/// vertex of a face and the others, in order around the face's normal.
std::vector<Triangle> triangles_of(const std::vector<Vector3d>& vertices,
                                   const std::vector<Vector3d>& normals) {
  constexpr double rounding = 1e-9;
  std::vector<Triangle> triangles;
  for (const Vector3d& normal : normals) {
    double farthest = -std::numeric_limits<double>::infinity();
    for (const Vector3d& vertex : vertices)
      farthest = std::max(farthest, normal.dot(vertex));
    std::vector<Vector3d> face;
    for (const Vector3d& vertex : vertices)
      if (normal.dot(vertex) > farthest - rounding)
        face.push_back(vertex);
    const Vector3d centre = normal * (farthest / normal.squaredNorm());
    const Vector3d first = face.front() - centre, across = normal.normalized().cross(first);
    const auto angle = [&](const Vector3d& vertex) {
      const double found = std::atan2(across.dot(vertex - centre), first.dot(vertex - centre));
      return found < -rounding ? found + 2 * std::numbers::pi : found;
    };
    std::sort(face.begin(), face.end(),
              [&](const Vector3d& a, const Vector3d& b) { return angle(a) < angle(b); });
    for (std::size_t k = 2; k < face.size(); ++k)
      triangles.push_back({face[0], face[k - 1], face[k]});
  }
  return triangles;
}

/// Makes a polyhedron whose shortest distance of two vertices, its edge, is 1.
Solid solid(const std::string& name, std::vector<Vector3d> vertices, const std::vector<Vector3d>& normals,
            std::optional<double> published) {
  double edge = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      edge = std::min(edge, (vertices[i] - vertices[k]).norm());
  for (Vector3d& vertex : vertices)
    vertex /= edge;
  return {name, triangles_of(vertices, normals), published};
}

}  // namespace

std::vector<TimedScene> timed_scenes() {
  return {{"two plates of 10 cm, 4 cm apart", two_plates(), 1e-3},
          {"sensor 2 mm before a housing, hand", before_housing(), 1e-3},
          {"the same, cylinder 1 mm beside the housing", beside_cylinder(), 1e-2},
          {"sensor on an arm of eight meshes that overlap, 4,608 triangles, hand", robot_arm(), 1e-2},
          {"X-ray arm with eight sensors, 60 s at most", load_scene(FRINGE_X_RAY_ARM), 1e-2, 60}};
}

std::vector<Solid> regular_polyhedra() {
  constexpr double golden = std::numbers::phi;
  const std::vector<Vector3d> tetrahedron{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  std::vector<Vector3d> opposite, octahedron, icosahedron;
  for (const Vector3d& vertex : tetrahedron)
    opposite.push_back(-vertex);
  const std::vector<Vector3d> cube = with_all_signs({1, 1, 1});
  std::vector<Vector3d> dodecahedron = cube;
  add_turned({1, 0, 0}, octahedron);
  add_turned({0, 1, golden}, icosahedron);
  add_turned({0, golden, 1 / golden}, dodecahedron);
  // Helsing and Perfekt, "On the polarizability and capacitance of the cube", 2013.
  constexpr double of_cube = 0.66067815409957;
  return {solid("tetrahedron", tetrahedron, opposite, {}), solid("cube", cube, octahedron, of_cube),
          solid("octahedron", octahedron, cube, {}), solid("dodecahedron", dodecahedron, icosahedron, {}),
          solid("icosahedron", icosahedron, dodecahedron, {})};
}

std::vector<Triangle> geodesic_sphere(int parts) {
  const Solid icosahedron = regular_polyhedra().back();
  std::vector<Triangle> triangles;
  for (const Triangle& face : icosahedron.triangles) {
    const auto at = [&](int i, int k) {
      return Vector3d((parts - i - k) * face[0] + i * face[1] + k * face[2]).normalized();
    };
    for (int i = 0; i < parts; ++i)
      for (int k = 0; i + k < parts; ++k) {
        triangles.push_back({at(i, k), at(i + 1, k), at(i, k + 1)});
        if (i + k + 1 < parts)
          triangles.push_back({at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)});
      }
  }
  return triangles;
}

Scene isolated(const Shape& shape) {
  Scene scene;
  scene.objects.push_back(grounded("body", shape, Vector3d::Zero()));
  scene.objects.back().role = Electrode{};
  return scene;
}

}  // namespace fringe::benchmarks
