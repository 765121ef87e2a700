#pragma once

#include <functional>

#include "bem/panel.hpp"

/// Quadrature over panels of potentials that are singular somewhere beside them (model/BOUNDARY_ELEMENTS.md,
/// section 9).
namespace fringe::detail {

/// How much better a rule is than twice the power of its ratio of size to distance says, at least
/// (tests/model/bem/panel_elements_test.cpp).
constexpr double rule_caution = 50;

/// The ratio of size to distance, of two panels together, below which three points on both of them do.
double far_ratio(double tolerance);

/// Calls `point(position, weight)` for the points of a rule over a triangle, the weights adding up to 1, for
/// the mean of a potential that is singular at `distance(position)` from a position. Where that is too near
/// for the rules at hand, the triangle is halved; parts of little weight need be less exact.
void for_each_point(const Triangle& triangle, double tolerance,
                    const std::function<double(const Eigen::Vector3d&)>& distance,
                    const std::function<void(const Eigen::Vector3d&, double)>& point);

/// The same along a segment, singular at `distance(from, to)` from a part of it.
void for_each_point(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double tolerance,
                    const std::function<double(const Eigen::Vector3d&, const Eigen::Vector3d&)>& distance,
                    const std::function<void(const Eigen::Vector3d&, double)>& point);

}  // namespace fringe::detail
