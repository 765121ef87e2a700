#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include <Eigen/Core>

/// The monomials xᵃyᵇzᶜ up to degree 5, in an order in which a lower degree comes before a higher one, so
/// that those up to degree p are the first monomial_count(p).
namespace fringe::detail {

/// The highest degree to which a node's quadrature is exact. With one more degree fewer nodes are needed, but
/// the number of points per node grows as its third power: beyond 5 the sum over a scene no longer gets
/// cheaper.
constexpr int highest_degree = 5;

constexpr std::size_t monomial_count(int degree) {
  return static_cast<std::size_t>((degree + 1) * (degree + 2) * (degree + 3) / 6);
}

constexpr std::size_t all_monomials = monomial_count(highest_degree);

struct Monomial {
  std::array<int, 3> exponents{};
  int degree = 0;
  std::size_t factor = 0;  ///< the monomial of one degree less that this one is a multiple of
  int axis = 0;            ///< the coordinate it is multiplied by
  double multinomial = 1;  ///< how often the monomial occurs in (x + y + z) to its degree
};

using MonomialTable = std::array<Monomial, all_monomials>;
using MonomialValues = std::array<double, all_monomials>;

constexpr MonomialTable make_monomials() {
  MonomialTable table{};
  std::size_t next = 1;
  for (std::size_t previous = 0; next < all_monomials; ++previous) {
    const Monomial& base = table[previous];
    int first_axis =
        0;  // the highest axis in use: multiplying only by it and those after it meets each product once
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

/// The place of xᵃyᵇzᶜ in the table.
constexpr std::size_t monomial_index(int a, int b, int c) {
  const int degree = a + b + c;
  std::size_t index = degree == 0 ? 0 : monomial_count(degree - 1);
  while (monomials[index].exponents != std::array<int, 3>{a, b, c})
    ++index;
  return index;
}

/// The monomials up to a degree at a point.
template <int degree>
void evaluate_monomials(const Eigen::Vector3d& point, MonomialValues& values) {
  values[0] = 1;
  // Written out by the compiler, so that the table is not read at run time.
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    ((values[i + 1] = values[monomials[i + 1].factor] * point[monomials[i + 1].axis]), ...);
  }
  (std::make_index_sequence<monomial_count(degree) - 1>{});
}

inline void evaluate_monomials(const Eigen::Vector3d& point, int degree, MonomialValues& values) {
  if (degree <= 2)
    evaluate_monomials<2>(point, values);
  else if (degree == 3)
    evaluate_monomials<3>(point, values);
  else
    evaluate_monomials<highest_degree>(point, values);
}

}  // namespace fringe::detail
