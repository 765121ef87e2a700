#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "conversion.hpp"
#include "fringe/bounding_volume.hpp"
#include "fringe/distance_sensor.hpp"
#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "fringe/plate_integral.hpp"
#include "fringe/surface_charges.hpp"
#include "fringe/thesis.hpp"
#include "fringe/version.hpp"
#include "interruption.hpp"
#include "scene_module.hpp"

namespace py = pybind11;

namespace {

using namespace fringe;
using namespace pybind11::literals;
using python::Array, python::points_of, python::vector3;

static_assert(sizeof(Triangle) == 9 * sizeof(double), "triangles lie in memory like an (n, 3, 3) array");

std::vector<Triangle> triangles_of(const Array& array) {
  if (array.ndim() != 3 || array.shape(1) != 3 || array.shape(2) != 3)
    throw InputError("triangles must have shape (n, 3, 3)");
  std::vector<Triangle> triangles(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t j = 0; j < 3; ++j)
      triangles[i][j] = Eigen::Vector3d(array.data() + 9 * i + 3 * j);
  return triangles;
}

Eigen::MatrixXd single_layer_of(const Array& array, double tolerance) {
  const std::vector<Triangle> triangles = triangles_of(array);
  const py::gil_scoped_release unlocked;
  return single_layer(triangles, tolerance);
}

TrianglePotentials triangle_potentials_of(const Array& positions, const Array& array) {
  const std::vector<Eigen::Vector3d> points = points_of(positions, "points");
  const std::vector<Triangle> triangles = triangles_of(array);
  const py::gil_scoped_release unlocked;
  return triangle_potentials(points, triangles);
}

std::vector<Face> faces_of(const py::array_t<std::int64_t, py::array::c_style>& array) {
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw InputError("faces must have shape (m, 3)");
  std::vector<Face> faces(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::int64_t vertex = array.data()[3 * i + j];
      if (vertex < 0)
        throw InputError(fmt::format("face {} names vertex {}", i, vertex));
      faces[i][j] = static_cast<std::size_t>(vertex);
    }
  return faces;
}

std::optional<bool> gjk_intersects_of(const Array& a, const Array& b, const std::string& method) {
  const std::vector<Eigen::Vector3d> hull_a = points_of(a, "a"), hull_b = points_of(b, "b");
  if (method != "exact" && method != "thesis")
    throw InputError(fmt::format(R"(method must be "exact" or "thesis", not "{}")", method));
  const py::gil_scoped_release unlocked;
  if (method == "thesis")
    return thesis_gjk_intersects(hull_a, hull_b);
  return gjk_intersects(hull_a, hull_b).intersects;
}

py::tuple gjk_distance_of(const Array& a, const Array& b) {
  const std::vector<Eigen::Vector3d> hull_a = points_of(a, "a"), hull_b = points_of(b, "b");
  GjkDistance answer;
  {
    const py::gil_scoped_release unlocked;
    answer = gjk_distance(hull_a, hull_b);
  }
  return py::make_tuple(answer.distance, answer.witness_a, answer.witness_b);
}

py::tuple bounding_sphere_of(const Array& vertices) {
  const auto [centre, radius] = bounding_sphere(points_of(vertices, "v"));
  return py::make_tuple(centre, radius);
}

py::tuple aabb_of(const Array& vertices) {
  const Eigen::AlignedBox3d box = axis_aligned_box(points_of(vertices, "v"));
  return py::make_tuple(Eigen::Vector3d(box.min()), Eigen::Vector3d(box.max()));
}

py::tuple obb_of(const Array& vertices, const py::object& faces, const std::string& method) {
  const std::vector<Eigen::Vector3d> points = points_of(vertices, "v");
  std::vector<Face> triangles;
  if (!faces.is_none())
    triangles = faces_of(faces.cast<py::array_t<std::int64_t, py::array::c_style>>());
  const BoxMethod how = parse_box_method(method);
  OrientedBox box;
  {
    const py::gil_scoped_release unlocked;
    box = oriented_box(points, triangles, how);
  }
  return py::make_tuple(box.centre, box.axes, box.half_widths);
}

py::object cone_closest_of(const Array& triangles, const Array& apex, const Array& direction,
                           double full_angle, double range, const std::string& method) {
  const std::vector<Triangle> surface = triangles_of(triangles);
  const SensingCone cone{vector3(apex, "apex"), vector3(direction, "direction"), full_angle, range};
  const ConeMethod how = parse_cone_method(method);
  std::optional<VisiblePoint> seen;
  {
    const py::gil_scoped_release unlocked;
    seen = cone_closest(surface, cone, how);
  }
  if (!seen)
    return py::none();
  return py::make_tuple(seen->distance, seen->point, seen->triangle);
}

Array plate_integral_of(const Array& triangles, const Array& corner, const Array& edge_u, const Array& edge_v,
                        const std::string& method) {
  const std::vector<Triangle> surface = triangles_of(triangles);
  const Rectangle plate{vector3(corner, "corner"), vector3(edge_u, "edge_u"), vector3(edge_v, "edge_v")};
  std::vector<double> integrals;
  {
    const py::gil_scoped_release unlocked;
    integrals = plate_integrals(surface, plate, parse_method(method));
  }
  return Array(static_cast<py::ssize_t>(integrals.size()), integrals.data());
}

Array plate_integral_derivatives_of(const Array& triangles, const Array& corner, const Array& edge_u,
                                    const Array& edge_v) {
  const std::vector<Triangle> surface = triangles_of(triangles);
  const Rectangle plate{vector3(corner, "corner"), vector3(edge_u, "edge_u"), vector3(edge_v, "edge_v")};
  Array result({static_cast<py::ssize_t>(surface.size()), py::ssize_t{6}});
  double* numbers = result.mutable_data();
  {
    const py::gil_scoped_release unlocked;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      try {
        const auto [translation, rotation] = plate_integral_derivatives(surface[i], plate);
        numbers = std::copy(translation.begin(), translation.end(), numbers);
        numbers = std::copy(rotation.begin(), rotation.end(), numbers);
      } catch (const InputError& error) {
        throw InputError(fmt::format("triangle {}: {}", i, error.what()));
      }
    }
  }
  return result;
}

}  // namespace

PYBIND11_MODULE(fringe, module) {
  module.doc() =
      "Capacitance of proximity sensors by integrating over the triangles of a scene. SI units, float64.";
  module.attr("__version__") = version();

  py::register_exception<InputError>(module, "InputError", PyExc_ValueError).doc() =
      "What the caller gave is wrong; the message says which element and why.";

  module.def("plate_integral", &plate_integral_of, "triangles"_a, "corner"_a, "edge_u"_a, "edge_v"_a,
             "method"_a = "exact",
             R"(The integral of 1/d over each triangle, d the shortest distance to a rectangular plate.

triangles: (n, 3, 3) array of vertices in metres.
corner, edge_u, edge_v: (3,) arrays; the plate is corner + a*edge_u + b*edge_v with a and b in [0, 1].
method: "exact", "split:N" (4**N equal triangles, centroid rule) or "gauss:K" (K*K product rule).

Returns an (n,) array in metres: 0 for a triangle without area, +inf where the triangle meets the plate so that the
integral diverges. Raises InputError (a ValueError) for values that are not finite, wrong shapes, a plate that is not a
rectangle and an unknown method.)");

  module.def(
      "plate_integral_derivatives", &plate_integral_derivatives_of, "triangles"_a, "corner"_a, "edge_u"_a,
      "edge_v"_a,
      R"(The derivatives of plate_integral, "exact", as each triangle moves rigidly and the plate stays.

Arguments as for plate_integral. Returns an (n, 6) array: along the axes (m/m), then about the axes through the origin
(m/rad); NaN for a triangle that touches the plate. Their error is at most about 1e-8 of the integral of 1/d**2.)");

  module.def(
      "gjk_intersects", &gjk_intersects_of, "a"_a, "b"_a, "method"_a = "exact",
      R"(Whether the convex hulls of two vertex arrays, (n, 3) and (m, 3), have a point in common; touching counts.

method: "exact", right for the coordinates given, always; or "thesis", Algorithm 2.1 as printed, which is often wrong
where hulls touch, and None when it has not ended after 1000 rounds.

Raises InputError (a ValueError) for wrong shapes, no vertices, vertices that are not finite and an unknown method.)");
  module.def("gjk_distance", &gjk_distance_of, "a"_a, "b"_a,
             R"(The shortest distance between the convex hulls of two vertex arrays, (n, 3) and (m, 3).

Returns (distance, nearest point of a, nearest point of b); 0 and a common point twice when the hulls intersect.
Raises InputError (a ValueError) as gjk_intersects does.)");
  module.def("bounding_sphere", &bounding_sphere_of, "v"_a,
             "The smallest sphere around the vertices (n, 3), all strictly inside: (centre, radius).");
  module.def(
      "aabb", &aabb_of, "v"_a,
      "The smallest box with sides along the axes that holds the vertices (n, 3): (minimum, maximum).");
  module.def(
      "obb", &obb_of, "v"_a, "faces"_a = py::none(), "method"_a = "tight",
      R"(A box around the vertices (n, 3), all strictly inside: (centre (3,), axes (3, 3), half_widths (3,)).

The rows of axes are orthonormal and right-handed. faces: (m, 3) vertex indices, or None.
method: "vertices" or "triangles", along the eigenvectors of the covariance of the vertices or of the surface; "tight",
searched for the smallest volume.

Raises InputError (a ValueError) for wrong shapes, indices out of range, no vertices and vertices that are not finite.)");

  module.def("cone_closest", &cone_closest_of, "triangles"_a, "apex"_a, "direction"_a, "full_angle"_a,
             "range"_a, "method"_a = "field_of_view",
             R"(The point of the triangles (n, 3, 3) nearest to the apex of a cone, among those in the cone.

The cone is what lies within full_angle / 2 (radians, full_angle in (0, pi]) of the direction, a (3,) array of any length
but zero, and within the range of the apex; the boundary counts as inside.
method: "field_of_view" or "cone_equation", two ways to the same answer (thesis 4.2.2 and 4.2.1).

Returns (distance, point (3,), index of the triangle), or None when nothing is in the cone. An apex on a triangle has the
distance 0. Raises InputError (a ValueError) for wrong shapes, values that are not finite or out of range and an unknown
method.)");

  module.def("single_layer", &single_layer_of, "triangles"_a, "tolerance"_a = 1e-4,
             R"(The mean of 1/r between every pair of triangles (n, 3, 3): an (n, n) array in 1/m.

It is the matrix of boundary elements with a charge spread evenly on each triangle. tolerance: the relative error aimed at
for each element.)");
  module.def(
      "triangle_potentials", &triangle_potentials_of, "points"_a, "triangles"_a,
      R"(The mean of 1/r over each triangle (m, 3, 3) at points (n, 3): an (n, m) array of single precision in 1/m.

A triangle farther away than ten times its radius counts as a point. With the charges of Scene.surface_charges it gives
the potential: fringe.triangle_potentials(points, panels) @ charges.)");

  python::add_interruption(module);
  python::add_scene(module);
}
