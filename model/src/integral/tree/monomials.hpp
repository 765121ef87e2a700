#pragma once

#include <array>
#include <cstddef>

/// The monomials xᵃyᵇzᶜ up to degree 6, ordered by degree, so that those up to degree p are the first
/// monomial_count(p).
namespace fringe::detail {

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

}  // namespace fringe::detail
