#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <nlohmann/json_fwd.hpp>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "fringe/error.hpp"
#include "fringe/triangle.hpp"

/// Conversion of arguments from Python, and of results to it.
namespace fringe::python {

/// Any array of numbers. Its shape is checked here, so that a wrong one raises ValueError.
using Array = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

inline Eigen::Vector3d vector3(const Array& array, const char* name) {
  if (array.ndim() != 1 || array.shape(0) != 3)
    throw InputError(fmt::format("{} must have shape (3,)", name));
  return Eigen::Vector3d(array.data());
}

inline std::vector<Eigen::Vector3d> points_of(const Array& array, const char* name) {
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw InputError(fmt::format("{} must have shape (n, 3)", name));
  std::vector<Eigen::Vector3d> points(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t k = 0; k < points.size(); ++k)
    points[k] = Eigen::Vector3d(array.data() + 3 * k);
  return points;
}

inline Array array_of(const std::vector<Triangle>& triangles) {
  Array array({static_cast<pybind11::ssize_t>(triangles.size()), pybind11::ssize_t{3}, pybind11::ssize_t{3}});
  double* target = array.mutable_data();
  for (const Triangle& triangle : triangles)
    for (const Eigen::Vector3d& vertex : triangle)
      target = std::copy(vertex.begin(), vertex.end(), target);
  return array;
}

/// Converts a JSON value to Python's types, and arrays of doubles, or of equally long arrays of doubles, to
/// NumPy arrays.
pybind11::object python_object(const nlohmann::ordered_json& value);

/// Returns the text of a scene file: a text as it is, or that of a dictionary with the keys of the format,
/// whose lists of dictionaries are its arrays of tables. NumPy's arrays and numbers stand for lists and
/// numbers.
/// @throws InputError for a value of another type, with its key.
std::string scene_text(const pybind11::handle& description);

}  // namespace fringe::python
