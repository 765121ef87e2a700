#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "triangle_classes.hpp"
#include "truth.hpp"

/// Assessment of the methods by comparison with the truth.
namespace fringe::stress {

/// Largest error of the exact method, as a multiple of the conditioning: the change caused by one unit in the
/// last place of an input number.
constexpr double limit = 16;

/// Lower bound of the conditioning (relative): the rounding of the result, 2^−53, and a little for the
/// rounding of the truth.
constexpr double smallest_conditioning = 1.2e-16;

/// Largest relative error in well-behaved classes: about twenty units in the last place.
constexpr double largest_well_behaved_error = 4e-15;

enum class Judged { exact, thesis, split };

/// The methods with their names in the report.
constexpr std::array<std::pair<Judged, const char*>, 3> judged{
    {{Judged::exact, "exact"}, {Judged::thesis, "thesis"}, {Judged::split, "split:4"}}};

/// Relative tolerances with which batches are tested.
constexpr std::array<double, 4> tolerances{1e-12, 1e-9, 1e-6, 1e-3};

/// A triangle, its true integral, and the results of the methods.
struct Specimen {
  Triangle triangle;
  Rectangle plate;
  Truth truth;
  double conditioning = smallest_conditioning;      ///< relative, at least smallest_conditioning
  double batched = 0;                               ///< by the exact method, in one call for its whole group
  double single = 0;                                ///< by the exact method, alone
  std::array<double, tolerances.size()> bounded{};  ///< in a batch, for each tolerance
  double split = 0;
  std::optional<double> thesis;  ///< for triangles in region I
};

/// Computes |value − truth|/truth: 0 where both are zero or infinite, infinite where only one is or the value
/// is not a number.
double relative_error(double value, const Truth& truth);

/// Returns the relative error of a method: for `exact` the larger of the errors in a batch and alone. Returns
/// nothing where the method does not apply.
std::optional<double> error_of(const Specimen& specimen, Judged method);

/// Computes the ratio of the error for a tolerance to the allowed error: the tolerance, and rounding as for
/// `exact`.
double error_over_allowed(const Specimen& specimen, std::size_t tolerance);

/// Returns whether these ratios are at most 1 for all tolerances.
bool keeps_tolerances(const Specimen& specimen);

/// Returns whether the exact method is as accurate as required, the tolerances are kept, and the quadrature
/// of the truth converged.
bool passes(const Specimen& specimen, const TriangleClass& of_class);

struct Assessment {
  TriangleClass of_class;
  std::vector<Specimen> specimens;
};

/// Assesses the triangles of a class, with the given number of threads.
Assessment assess(const TriangleClass& of_class, const std::vector<Group>& groups, unsigned threads);

}  // namespace fringe::stress
