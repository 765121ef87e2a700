#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <pybind11/numpy.h>

#include "fringe/error.hpp"
#include "fringe/triangle.hpp"

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

}  // namespace fringe::python
