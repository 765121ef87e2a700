#pragma once

#include <array>
#include <cstddef>

/// The monomials xᵃyᵇzᶜ up to degree 6, in an order in which a lower degree comes before a higher one, so
/// that those up to degree p are the first monomial_count(p).
namespace fringe::detail {

/// The highest degree to which a node's quadrature is exact. With one more degree fewer nodes are needed, but
/// the number of points per node grows as its third power: beyond 5 the sum over a scene no longer gets
/// cheaper.
constexpr int highest_degree = 5;

/// The highest degree of the moments that are known. One more than the quadratures keep, so that what they
/// are off first is measured instead of bounded.
constexpr int moment_degree = highest_degree + 1;

constexpr std::size_t monomial_count(int degree) {
  return static_cast<std::size_t>((degree + 1) * (degree + 2) * (degree + 3) / 6);
}

constexpr std::size_t all_monomials = monomial_count(moment_degree);

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

}  // namespace fringe::detail
