#pragma once

#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"
#include "integral/tree/compression.hpp"
#include "integral/tree/monomials.hpp"

/// Moments of a surface about a centre: the integrals over the surface of the monomials in (p −
/// centre)/scale, in m².
namespace fringe::detail {

/// Centre and unit of length (m) of moments.
struct MomentFrame {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double scale = 1;
};

using Moments = MonomialValues;

/// Appends the points of a rule on the triangle that is exact up to highest_degree.
void append_rule(const Triangle& triangle, double area, std::vector<WeightedPoint>& points);

/// Computes the moments of weighted points.
Moments moments_of(const std::vector<WeightedPoint>& points, const MomentFrame& frame);

/// Adds the moments of a part of the surface, translated and rescaled from the part's own frame.
void add_translated(const Moments& part, const MomentFrame& part_frame, const MomentFrame& frame,
                    Moments& moments);

}  // namespace fringe::detail
