#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

/// Moments of a surface about a centre: the integrals over the surface of the monomials in (p −
/// centre)/scale, in m². The monomials xᵃyᵇzᶜ up to degree 6 are ordered by degree, so that those up to
/// degree p are the first monomial_count(p).
namespace fringe::detail {

struct WeightedPoint {
  Eigen::Vector3d position;
  double weight;
};

/// Highest degree to which a node's quadrature is exact. One more degree would need fewer nodes, but the
/// number of points per node grows as the third power of the degree: beyond 5 the sum over a scene no longer
/// gets cheaper.
constexpr int highest_degree = 5;

/// Highest degree of the moments that are computed: one above the quadratures' degree, so that the leading
/// term of their error is measured instead of bounded.
constexpr int moment_degree = highest_degree + 1;

constexpr std::size_t monomial_count(int degree) {
  return static_cast<std::size_t>((degree + 1) * (degree + 2) * (degree + 3) / 6);
}

constexpr std::size_t all_monomials = monomial_count(moment_degree);

struct Monomial {
  std::array<int, 3> exponents{};
  int degree = 0;
  std::size_t factor = 0;  ///< index of the monomial of one degree less that divides this one
  int axis = 0;            ///< the coordinate by which that monomial is multiplied
  double multinomial = 1;  ///< coefficient of the monomial in (x + y + z)^degree
};

using MonomialTable = std::array<Monomial, all_monomials>;
using MonomialValues = std::array<double, all_monomials>;

constexpr MonomialTable make_monomials() {
  MonomialTable table{};
  std::size_t next = 1;
  for (std::size_t previous = 0; next < all_monomials; ++previous) {
    const Monomial& base = table[previous];
    // The highest axis with a positive exponent: multiplying by it and later axes only makes each product
    // once.
    int first_axis = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (base.exponents[static_cast<std::size_t>(axis)] > 0)
        first_axis = axis;
    for (int axis = first_axis; axis < 3 && next < all_monomials; ++axis) {
      Monomial product = base;
      ++product.degree;
      const int exponent = ++product.exponents[static_cast<std::size_t>(axis)];
      product.factor = previous;
      product.axis = axis;
      product.multinomial = base.multinomial * product.degree / exponent;
      table[next++] = product;
    }
  }
  return table;
}

inline constexpr MonomialTable monomials = make_monomials();

/// Returns the index of xᵃyᵇzᶜ in the table.
constexpr std::size_t monomial_index(int a, int b, int c) {
  const int degree = a + b + c;
  std::size_t index = degree == 0 ? 0 : monomial_count(degree - 1);
  while (monomials[index].exponents != std::array<int, 3>{a, b, c})
    ++index;
  return index;
}

/// The values of monomials at many points: one row per monomial, one element per point.
class MonomialRows {
 public:
  enum class Factor { one, weight };

  /// Evaluates the monomials up to a degree in to_frame·(p − centre), multiplied by one or by the point's
  /// weight.
  MonomialRows(std::span<const WeightedPoint> points, const Eigen::Vector3d& centre,
               const Eigen::Matrix3d& to_frame, int degree, Factor factor);

  std::size_t row_count() const { return row_count_; }

  /// Returns a monomial's values at all points, padded with zeros.
  const double* row(std::size_t monomial) const { return rows_.get() + monomial * stride_; }

  /// Adds the sum of each row to `sums`.
  void add_up(MonomialValues& sums) const;

 private:
  std::size_t row_count_;
  std::size_t stride_;
  std::unique_ptr<double[]> rows_;  ///< an array, because a vector would initialise its elements
};

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
