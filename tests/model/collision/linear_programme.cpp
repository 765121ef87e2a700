#include "shape_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <boost/multiprecision/gmp.hpp>

namespace fringe::test {
namespace {

using Integer = boost::multiprecision::mpz_int;
using Eigen::Vector3d;

constexpr std::size_t constraints = 5;  ///< three equal coordinates, two sums of weights equal to one

/// Simplex tableau. The rows are the equations and, last, the objective (the sum of the equations'
/// residuals); the columns are the unknowns and, last, the right-hand sides. The true values are the entries
/// divided by `denominator`.
struct Tableau {
  std::array<std::vector<Integer>, constraints + 1> rows;
  std::array<std::size_t, constraints> basis;
  Integer denominator = 1;

  std::size_t unknowns() const { return rows[0].size() - 1; }
};

int smallest_exponent(std::span<const Vector3d> vertices, int at_most) {
  for (const Vector3d& vertex : vertices)
    for (const double coordinate : vertex)
      if (coordinate != 0)
        at_most = std::min(at_most, std::ilogb(coordinate));
  return at_most;
}

/// Returns coordinate·2^shift, which must be an integer.
Integer shifted(double coordinate, int shift) {
  int exponent = 0;
  const double mantissa = std::frexp(coordinate, &exponent);
  Integer integer(std::ldexp(mantissa, 53));
  if (coordinate != 0)
    integer <<= static_cast<unsigned>(exponent - 53 + shift);
  return integer;
}

Tableau tableau_of(std::span<const Vector3d> a, std::span<const Vector3d> b) {
  const int shift = 52 - smallest_exponent(a, smallest_exponent(b, 0));
  Tableau tableau;
  for (std::vector<Integer>& row : tableau.rows)
    row.resize(a.size() + b.size() + 1);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < a.size(); ++i)
      tableau.rows[k][i] = shifted(a[i][static_cast<Eigen::Index>(k)], shift);
    for (std::size_t j = 0; j < b.size(); ++j)
      tableau.rows[k][a.size() + j] = -shifted(b[j][static_cast<Eigen::Index>(k)], shift);
  }
  for (std::size_t i = 0; i < a.size(); ++i)
    tableau.rows[3][i] = 1;
  for (std::size_t j = 0; j < b.size(); ++j)
    tableau.rows[4][a.size() + j] = 1;
  tableau.rows[3].back() = tableau.rows[4].back() = 1;
  for (std::size_t row = 0; row < constraints; ++row) {
    tableau.basis[row] = tableau.unknowns() + row;
    for (std::size_t column = 0; column <= tableau.unknowns(); ++column)
      tableau.rows[constraints][column] -= tableau.rows[row][column];
  }
  return tableau;
}

std::optional<std::size_t> entering(const Tableau& tableau) {
  for (std::size_t column = 0; column < tableau.unknowns(); ++column)
    if (tableau.rows[constraints][column] < 0)
      return column;
  return std::nullopt;
}

std::size_t leaving(const Tableau& tableau, std::size_t column) {
  std::optional<std::size_t> best;
  for (std::size_t row = 0; row < constraints; ++row) {
    if (tableau.rows[row][column] <= 0)
      continue;
    if (!best) {
      best = row;
      continue;
    }
    const Integer difference = tableau.rows[row].back() * tableau.rows[*best][column] -
                               tableau.rows[*best].back() * tableau.rows[row][column];
    if (difference < 0 || (difference == 0 && tableau.basis[row] < tableau.basis[*best]))
      best = row;
  }
  // The objective is bounded below by zero, so there always is such a row.
  return best.value();
}

void pivot(Tableau& tableau, std::size_t pivot_row, std::size_t pivot_column) {
  const Integer element = tableau.rows[pivot_row][pivot_column];
  for (std::size_t row = 0; row <= constraints; ++row) {
    if (row == pivot_row)
      continue;
    const Integer factor = tableau.rows[row][pivot_column];
    for (std::size_t column = 0; column <= tableau.unknowns(); ++column)
      tableau.rows[row][column] =
          Integer(tableau.rows[row][column] * element - factor * tableau.rows[pivot_row][column]) /
          tableau.denominator;
  }
  tableau.denominator = element;
  tableau.basis[pivot_row] = pivot_column;
}

}  // namespace

bool hulls_intersect(std::span<const Vector3d> a, std::span<const Vector3d> b) {
  Tableau tableau = tableau_of(a, b);
  while (const auto column = entering(tableau))
    pivot(tableau, leaving(tableau, *column), *column);
  return tableau.rows[constraints].back() == 0;
}

}  // namespace fringe::test
