#pragma once

#include <functional>

#include "surface/panel.hpp"

/// Quadrature over panels for potentials with singularities beside them (model/BOUNDARY_ELEMENTS.md, section
/// 9).
namespace fringe::detail {

/// Factor by which a rule's error is at least below 2·(size/distance)^(degree + 1)
/// (tests/model/bem/panel_elements_test.cpp).
constexpr double rule_caution = 50;

/// Returns the ratio of size to distance, of two panels together, below which a rule of a degree on both of
/// them suffices.
double far_ratio(double tolerance, int degree);

/// Calls `point(position, weight)` for the points of a rule over a triangle, with weights that add up to 1.
/// The rule gives the mean of a potential whose singularities are `distance(position)` away from a position.
/// Halves the triangle where that is too near for the available rules; parts of little weight may be less
/// exact.
void for_each_point(const Triangle& triangle, double tolerance,
                    const std::function<double(const Eigen::Vector3d&)>& distance,
                    const std::function<void(const Eigen::Vector3d&, double)>& point);

/// Does the same along a segment; the singularities are `distance(from, to)` away from a part of it.
void for_each_point(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double tolerance,
                    const std::function<double(const Eigen::Vector3d&, const Eigen::Vector3d&)>& distance,
                    const std::function<void(const Eigen::Vector3d&, double)>& point);

}  // namespace fringe::detail
