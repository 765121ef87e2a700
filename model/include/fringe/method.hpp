#pragma once

#include <string>
#include <string_view>
#include <variant>

namespace fringe {

/// The closed form, region by region (model/NUMERICS.md).
struct Exact {};

/// The thesis' own method (5.3.2): divides the triangle into 4^levels equal triangles and uses the distance
/// of each one's centroid.
struct Split {
  int levels;
};

/// A product Gauss rule of points² nodes on the whole triangle.
struct Gauss {
  int points;
};

/// The method that evaluates ∫dA/d over one triangle.
using Method = std::variant<Exact, Split, Gauss>;

/// Largest number of levels: 4^10 is a million centroids per triangle, where rounding begins to outweigh what
/// a further level gains.
constexpr int most_split_levels = 10;

/// Largest number of points per direction, 64² nodes: a product rule does not suit a triangle that needs
/// more.
constexpr int most_gauss_points = 64;

/// Reads "exact", "split:N" (N from 0 to 10) or "gauss:K" (K from 1 to 64). Throws InputError for anything
/// else.
Method parse_method(std::string_view text);

/// Returns the text from which parse_method reads the method.
std::string to_string(const Method& method);

}  // namespace fringe
