#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>

#include <Eigen/Geometry>

#include "collision/convex_pair.hpp"
#include "numeric/precise_vector.hpp"

/// Distances of hulls of vertices in twice the precision, as accurate as those in exact numbers wherever they
/// can be certain of it (model/NUMERICS.md, section 13).
namespace fringe::detail {

/// A simplex of up to four pairs of vertices, evaluated in twice the precision.
class PreciseSimplex {
 public:
  PreciseSimplex(const Simplex& simplex, double extent) : simplex_(simplex), extent_(extent) {
    for (std::size_t i = 0; i < simplex.size; ++i) {
      points_[i] = exact_difference(simplex.pairs[i].a, simplex.pairs[i].b);
      if (i > 0)
        edges_[i - 1] = points_[i] - points_[0];
    }
  }

  /// Returns the distance if the simplex's nearest point is that of both hulls; if vertices lie beyond it,
  /// beyond() has them then.
  std::optional<GjkDistance> distance(Vertices a, Vertices b) {
    beyond_.reset();
    if (simplex_.size > 3 || !find_shares())
      return std::nullopt;
    const DoubleDouble square = dot(nearest_, nearest_);
    const double length = std::sqrt(square.high);
    // Below this the errors, of some 2^−78 of the extent, could be felt.
    if (!(length > 0x1p-20 * extent_))
      return std::nullopt;
    const Farthest of_a = farthest(a, 1, square.high), of_b = farthest(b, -1, square.high);
    if (of_a.is_beyond || of_b.is_beyond) {
      beyond_ = {of_a.vertex, of_b.vertex};
      return std::nullopt;
    }
    const std::optional<Eigen::Vector3d> on_a = point<&PointPair::a>(), on_b = point<&PointPair::b>();
    if (!on_a || !on_b)
      return std::nullopt;
    constexpr double rounded_down = 1 - 0x1p-50;
    const double distance = square_root(square).high;
    return GjkDistance{distance, distance * rounded_down, -rounded(nearest_) / length, *on_a, *on_b, true};
  }

  /// Returns the vertices that lie farthest beyond the plane of the nearest point, of a simplex without other
  /// faults.
  const std::optional<PointPair>& beyond() const { return beyond_; }

  /// Returns a common point of both hulls if the simplex contains the origin.
  std::optional<Eigen::Vector3d> common_point() {
    return simplex_.size == 4 && find_shares() ? point<&PointPair::a>() : std::nullopt;
  }

 private:
  /// Finds the coordinates of the nearest point in the basis of the edges, and the point itself. Returns
  /// false for thin simplices, and if the point may not be inside.
  bool find_shares() {
    const std::size_t count = simplex_.size - 1;
    Eigen::Matrix3d dual = Eigen::Matrix3d::Zero();
    if (!find_dual_basis(dual))
      return false;
    shares_.fill({});
    nearest_ = points_[0];
    // Every step leaves of the coordinates what rounding takes of the last one's.
    constexpr int steps = 4;
    constexpr double last = 0x1p-60;
    double largest = 1;
    for (int step = 0; step < steps && largest > last; ++step) {
      Eigen::Vector3d products = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < count; ++i)
        products[static_cast<Eigen::Index>(i)] = dot(edges_[i], nearest_).high;
      const Eigen::Vector3d coordinates = dual * (dual.transpose() * products);
      largest = coordinates.lpNorm<Eigen::Infinity>();
      for (std::size_t i = 0; i < count; ++i)
        shares_[i] = shares_[i] + DoubleDouble{-coordinates[static_cast<Eigen::Index>(i)], 0};
      nearest_ = points_[0];
      for (std::size_t i = 0; i < count; ++i)
        nearest_ = nearest_ + shares_[i] * edges_[i];
    }
    // A share that is this small could be negative.
    constexpr double least = 0x1p-40;
    double rest = 1;
    for (std::size_t i = 0; i < count; ++i) {
      rest -= shares_[i].high;
      if (!(shares_[i].high > least))
        return false;
    }
    return rest > least;
  }

  /// Computes the dual basis of the edges (rows): its products with a vector are the vector's coordinates in
  /// the basis of the edges.
  bool find_dual_basis(Eigen::Matrix3d& dual) const {
    constexpr double thinnest = 0x1p-12;
    const Eigen::Vector3d first = rounded(edges_[0]), second = rounded(edges_[1]), third = rounded(edges_[2]);
    if (simplex_.size == 2) {
      dual.row(0) = first / first.squaredNorm();
    } else if (simplex_.size == 3) {
      const Eigen::Vector3d normal = first.cross(second);
      dual.row(0) = second.cross(normal) / normal.squaredNorm();
      dual.row(1) = normal.cross(first) / normal.squaredNorm();
      return normal.norm() > thinnest * first.norm() * second.norm();
    } else if (simplex_.size == 4) {
      const double volume = first.dot(second.cross(third));
      dual.row(0) = second.cross(third) / volume;
      dual.row(1) = third.cross(first) / volume;
      dual.row(2) = first.cross(second) / volume;
      return std::abs(volume) > thinnest * first.norm() * second.norm() * third.norm();
    }
    return true;
  }

  /// The vertex of a hull that is nearest to the other hull, and whether that is so by half a unit in the
  /// last place of the distance.
  struct Farthest {
    Eigen::Vector3d vertex;
    bool is_beyond;
  };

  /// Searches the vertices of A, or of B with the sign −1; those of the simplex have the product zero.
  Farthest farthest(Vertices vertices, double sign, double square) const {
    const Eigen::Vector3d& origin = sign > 0 ? simplex_.pairs[0].a : simplex_.pairs[0].b;
    const Eigen::Vector3d direction = sign * rounded(nearest_);
    const double certain = 0x1p-48 * extent_ * direction.lpNorm<1>();
    Farthest found{origin, false};
    double least = 0;
    for (const Eigen::Vector3d& vertex : vertices) {
      if ((vertex - origin).dot(direction) > certain)
        continue;
      const double product = sign * dot(exact_difference(vertex, origin), nearest_).high;
      if (product < least) {
        least = product;
        found.vertex = vertex;
      }
      // Written so that a NaN counts as beyond.
      found.is_beyond = found.is_beyond || !(product >= -0x1p-58 * square);
    }
    return found;
  }

  /// Returns the point of a hull at the shares, each coordinate accurate to a unit in its last place.
  template <auto PointPair::*member>
  std::optional<Eigen::Vector3d> point() const {
    const Eigen::Vector3d& origin = simplex_.pairs[0].*member;
    PreciseVector sum{{origin.x(), 0}, {origin.y(), 0}, {origin.z(), 0}};
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
    for (std::size_t i = 1; i < simplex_.size; ++i) {
      sum = sum + shares_[i - 1] * exact_difference(simplex_.pairs[i].*member, origin);
      moved += (simplex_.pairs[i].*member - origin).cwiseAbs();
    }
    const Eigen::Vector3d result = rounded(sum);
    // Coordinates near zero could have lost digits, unless they are those of all vertices.
    for (Eigen::Index k = 0; k < 3; ++k)
      if (moved[k] != 0 && !(std::abs(result[k]) > 0x1p-20 * extent_))
        return std::nullopt;
    return result;
  }

  const Simplex& simplex_;
  double extent_;
  std::array<PreciseVector, 4> points_;
  std::array<PreciseVector, 3> edges_;
  std::array<DoubleDouble, 3> shares_;  ///< of the edges
  PreciseVector nearest_;
  std::optional<PointPair> beyond_;
};

}  // namespace fringe::detail
