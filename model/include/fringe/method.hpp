#pragma once

#include <string>
#include <string_view>
#include <variant>

namespace fringe {

/// The closed form of ∫dA/d over a triangle, region by region (model/NUMERICS.md).
struct Exact {};

/// The thesis' own method (5.3.2) for ∫dA/d: divides the triangle into 4^levels equal triangles and uses the
/// distance of each one's centroid.
struct Split {
  int levels;
};

/// A product Gauss rule of points² nodes on the whole triangle, for ∫dA/d.
struct Gauss {
  int points;
};

/// The pair formula in closed form, which takes the place of ∫dA/d (model/CORRECTIONS.md).
struct Formula {};

/// The reduced boundary element method: prepared once, then microseconds to milliseconds for each pose.
struct Reduced {};

/// Boundary elements (fringe/boundary_elements.hpp).
struct BoundaryElements {};

/// The cheapest of formula, reduced method and boundary elements that states the accuracy asked for.
struct Auto {};

/// The method that finds what the sensors of a scene feel. The first three evaluate ∫dA/d over each triangle,
/// and only they apply to triangles without a scene.
using Method = std::variant<Exact, Split, Gauss, Formula, Reduced, BoundaryElements, Auto>;

/// Largest number of levels: 4^10 is a million centroids per triangle, where rounding begins to outweigh what
/// a further level gains.
constexpr int most_split_levels = 10;

/// Largest number of points per direction, 64² nodes: a product rule does not suit a triangle that needs
/// more.
constexpr int most_gauss_points = 64;

/// Returns whether the method evaluates ∫dA/d over triangles.
bool is_integral(const Method& method);

/// Returns whether the method states errors, so that an accuracy can be asked of it.
bool states_errors(const Method& method);

/// Reads "exact", "split:N" (N from 0 to 10), "gauss:K" (K from 1 to 64), "formula", "reduced",
/// "boundary-elements" or "auto". Throws InputError for anything else; for the names that methods had before,
/// it says what to write now.
Method parse_method(std::string_view text);

/// Returns the text from which parse_method reads the method.
std::string to_string(const Method& method);

}  // namespace fringe
