#include "collision/rational_vector.hpp"

#include <algorithm>
#include <cstddef>

namespace fringe::detail {
namespace {

RationalVector cross_product(const RationalVector& a, const RationalVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

using Rows = std::array<std::array<Rational, 5>, 4>;

/// Tests by Gauss-Jordan elimination whether the linear system (the last column is its right-hand side) has
/// exactly one solution and no component of it is negative.
bool solved_by_non_negative(Rows rows, std::size_t unknowns) {
  for (std::size_t column = 0; column < unknowns; ++column) {
    std::size_t pivot = column;
    while (pivot < rows.size() && rows[pivot][column].is_zero())
      ++pivot;
    if (pivot == rows.size())
      return false;
    std::swap(rows[pivot], rows[column]);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (row == column)
        continue;
      const Rational factor = rows[row][column] / rows[column][column];
      for (std::size_t k = 0; k < rows[row].size(); ++k)
        rows[row][k] -= factor * rows[column][k];
    }
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const Rational& right = rows[row].back();
    if (row < unknowns ? right / rows[row][row] < 0 : !right.is_zero())
      return false;
  }
  return true;
}

}  // namespace

RationalVector rational(const Eigen::Vector3d& point) {
  return {Rational(point.x()), Rational(point.y()), Rational(point.z())};
}

Rational product(const RationalVector& a, const RationalVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

RationalVector plus(const RationalVector& a, const RationalVector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

RationalVector minus(const RationalVector& a, const RationalVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

RationalVector times(const Rational& factor, const RationalVector& vector) {
  return {factor * vector[0], factor * vector[1], factor * vector[2]};
}

RationalVector towards_nearest(const std::vector<RationalVector>& points) {
  const RationalVector& p = points[0];
  if (points.size() == 1)
    return p;
  const RationalVector along = minus(points[1], p);
  if (points.size() == 2)
    return minus(times(product(along, along), p), times(product(p, along), along));
  const RationalVector normal = cross_product(along, minus(points[2], p));
  return times(product(p, normal), normal);
}

bool hull_holds_origin(const std::vector<RationalVector>& points) {
  for (unsigned subset = 1; subset < (1U << points.size()); ++subset) {
    Rows rows;
    std::size_t unknowns = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (((subset >> i) & 1U) == 0)
        continue;
      for (std::size_t k = 0; k < 3; ++k)
        rows[k][unknowns] = points[i][k];
      rows[3][unknowns++] = 1;
    }
    rows[3].back() = 1;
    if (solved_by_non_negative(rows, unknowns))
      return true;
  }
  return false;
}

Rational squared_distance_to_origin(const std::vector<RationalVector>& points) {
  if (hull_holds_origin(points))
    return 0;
  Rational least = product(points[0], points[0]);
  for (unsigned subset = 1; subset < (1U << points.size()); ++subset) {
    std::vector<RationalVector> face;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (((subset >> i) & 1U) != 0)
        face.push_back(points[i]);
    constexpr std::size_t most = 3;
    if (face.size() > most)
      continue;
    const RationalVector along = towards_nearest(face);
    const Rational square = product(along, along);
    if (square.is_zero())
      continue;
    const RationalVector foot = times(product(face[0], along) / square, along);
    for (RationalVector& point : face)
      point = minus(point, foot);
    const Rational squared_distance = product(foot, foot);
    if (squared_distance < least && hull_holds_origin(face))
      least = squared_distance;
  }
  return least;
}

}  // namespace fringe::detail
