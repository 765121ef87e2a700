#include <algorithm>
#include <chrono>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "fringe/capacitance.hpp"
#include "fringe/conductors.hpp"
#include "fringe/error.hpp"
#include "fringe/plate_integral.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene_info.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/version.hpp"

namespace py = pybind11;

namespace {

using namespace fringe;
using namespace pybind11::literals;

/// Any array of numbers; its shape is checked by hand, so that a wrong one is a ValueError.
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

static_assert(sizeof(Triangle) == 9 * sizeof(double), "triangles lie in memory like an (n, 3, 3) array");

Eigen::Vector3d vector3(const Array& array, const char* name) {
  if (array.ndim() != 1 || array.shape(0) != 3)
    throw InputError(fmt::format("{} must have shape (3,)", name));
  return Eigen::Vector3d(array.data());
}

std::vector<Triangle> triangles_of(const Array& array) {
  if (array.ndim() != 3 || array.shape(1) != 3 || array.shape(2) != 3)
    throw InputError("triangles must have shape (n, 3, 3)");
  std::vector<Triangle> triangles(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t j = 0; j < 3; ++j)
      triangles[i][j] = Eigen::Vector3d(array.data() + 9 * i + 3 * j);
  return triangles;
}

Array array_of(const std::vector<Triangle>& triangles) {
  Array array({static_cast<py::ssize_t>(triangles.size()), py::ssize_t{3}, py::ssize_t{3}});
  double* target = array.mutable_data();
  for (const Triangle& triangle : triangles)
    for (const Eigen::Vector3d& vertex : triangle)
      target = std::copy(vertex.begin(), vertex.end(), target);
  return array;
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

py::dict dictionary(const SensorCapacitance& sensor) {
  py::list objects;
  for (const ObjectCapacitance& object : sensor.objects)
    objects.append(py::dict("name"_a = object.name, "capacitance"_a = object.capacitance,
                            "bound"_a = object.bound, "skipped"_a = object.skipped));
  return py::dict("name"_a = sensor.name, "total"_a = sensor.total, "voltage"_a = sensor.voltage,
                  "delta_voltage"_a = sensor.delta_voltage, "contact"_a = sensor.contact,
                  "objects"_a = objects);
}

py::dict capacitance_of(const Scene& scene, const std::string& method) {
  const CapacitanceOptions options{parse_method(method)};
  std::vector<SensorCapacitance> answer;
  std::chrono::duration<double> elapsed{};
  {
    const py::gil_scoped_release unlocked;
    const auto start = std::chrono::steady_clock::now();
    answer = capacitance(scene, options);
    elapsed = std::chrono::steady_clock::now() - start;
  }
  py::list sensors;
  for (const SensorCapacitance& sensor : answer)
    sensors.append(dictionary(sensor));
  return py::dict("options"_a = py::dict("method"_a = to_string(options.method)),
                  "seconds"_a = elapsed.count(), "sensors"_a = sensors);
}

py::dict conductors_of(const Scene& scene) {
  std::vector<Conductor> surfaces;
  {
    const py::gil_scoped_release unlocked;
    surfaces = conductors(scene);
  }
  py::dict result;
  for (const auto& [name, triangles] : surfaces)
    result[py::str(name)] = array_of(triangles);
  return result;
}

py::dict info_of(const Scene& scene) {
  SceneInfo info;
  {
    const py::gil_scoped_release unlocked;
    info = scene_info(scene);
  }
  py::list objects;
  for (const ObjectInfo& object : info.objects)
    objects.append(py::dict("name"_a = object.name, "triangles"_a = object.triangles, "area"_a = object.area,
                            "volume"_a = object.volume,
                            "aabb"_a = py::dict("minimum"_a = Eigen::Vector3d(object.bounding_box.min()),
                                                "maximum"_a = Eigen::Vector3d(object.bounding_box.max()))));
  return py::dict("counts"_a = py::dict("links"_a = info.links, "sensors"_a = info.sensors,
                                        "distance_sensors"_a = info.distance_sensors,
                                        "objects"_a = info.objects.size(), "triangles"_a = info.triangles),
                  "objects"_a = objects);
}

void set_link_pose(Scene& scene, const std::string& link, const Array& translation, const Array& rotation) {
  const Eigen::Vector3d t = vector3(translation, "translation");
  if (rotation.ndim() == 2 && rotation.shape(0) == 3 && rotation.shape(1) == 3) {
    const Eigen::Matrix3d matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>(rotation.data());
    set_pose(scene, link, pose_from_matrix(matrix, t));
    return;
  }
  if (rotation.ndim() != 1 || rotation.shape(0) != 4)
    throw InputError("rotation must be a matrix of shape (3, 3) or a quaternion (w, x, y, z) of shape (4,)");
  const double* wxyz = rotation.data();
  const Eigen::Quaterniond quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!quaternion.coeffs().allFinite() || !t.allFinite())
    throw InputError("a pose must be finite");
  if (quaternion.coeffs().isZero(0))
    throw InputError("a quaternion must not be zero");
  set_pose(scene, link, pose_from_quaternion(quaternion, t));
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

  py::class_<Scene>(module, "Scene", "A scene of links, sensors and objects (geometries/SCENE.md).")
      .def_static("load", &load_scene, "path"_a, py::call_guard<py::gil_scoped_release>(),
                  "Reads a scene file and the mesh files it names. Raises InputError for a wrong one.")
      .def("capacitance", &capacitance_of, "method"_a = "exact",
           "What every sensor feels, as the dictionary that `fringe capacitance --json` prints; F and V.")
      .def("conductors", &conductors_of,
           "Name to (n, 3, 3) triangles in the world frame, the sensors first, each in the file's order.")
      .def("set_pose", &set_link_pose, "link"_a, "translation"_a, "rotation"_a,
           "Replaces a link's pose relative to its parent. rotation: a (3, 3) rotation matrix or a "
           "quaternion (w, x, y, z) "
           "of any length but zero. Raises InputError for an unknown link or a pose that is none.")
      .def("info", &info_of,
           "Counts, areas (m2), volumes (m3, None for open surfaces) and bounding boxes (m).");
}
