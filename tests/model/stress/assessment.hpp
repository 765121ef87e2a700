#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "triangle_classes.hpp"
#include "truth.hpp"

/// The methods held against the truth.
namespace fringe::stress {

/// An error of `limit` times what one unit in the last place of one input number changes is the most that is
/// allowed.
constexpr double limit = 16;

/// No result can be expected to be closer than its own rounding, 2^−53, with a little for the truth's.
constexpr double smallest_conditioning = 1.2e-16;

/// In well-behaved classes: twenty units in the last place.
constexpr double largest_well_behaved_error = 4e-15;

enum class Judged { exact, thesis, split };
constexpr std::array<Judged, 3> judged{Judged::exact, Judged::thesis, Judged::split};

/// Largest relative errors that batches are asked for.
constexpr std::array<double, 4> tolerances{1e-12, 1e-9, 1e-6, 1e-3};

/// As the report names it.
std::string name_of(Judged method);

/// A triangle, its truth, and what the methods say.
struct Specimen {
  Triangle triangle;
  Rectangle plate;
  Truth truth;
  double conditioning = smallest_conditioning;      ///< at least that
  double batched = 0;                               ///< exact, in one call with its whole group
  double single = 0;                                ///< exact, alone
  std::array<double, tolerances.size()> bounded{};  ///< batched, to each tolerance
  double split = 0;
  std::optional<double> thesis;  ///< for triangles in region I
};

/// |value − truth|/truth; 0 where both are zero or infinite, infinite where only one is or the value is not a
/// number.
double relative_error(double value, const Truth& truth);

/// The error of a method, the worse of the batched and the single one for `exact`; nothing where the method
/// does not apply.
std::optional<double> error_of(const Specimen& specimen, Judged method);

/// The error of the value for a tolerance over what it may be: the tolerance, and rounding as for `exact`.
double error_over_allowed(const Specimen& specimen, std::size_t tolerance);

/// Whether all of those are at most 1.
bool keeps_tolerances(const Specimen& specimen);

/// Whether the exact method is as good as it must be, the tolerances are kept, and the truth is one.
bool passes(const Specimen& specimen, const TriangleClass& of_class);

struct Assessment {
  TriangleClass of_class;
  std::vector<Specimen> specimens;
};

/// All of that for the triangles of a class, on so many threads.
Assessment assess(const TriangleClass& of_class, const std::vector<Group>& groups, unsigned threads);

/// The truth alone, on so many threads.
std::vector<Specimen> with_truth(const std::vector<Group>& groups, unsigned threads);

}  // namespace fringe::stress
