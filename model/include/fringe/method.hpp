#pragma once

#include <string>
#include <string_view>
#include <variant>

namespace fringe {

/// The integral in closed form, region by region (model/NUMERICS.md).
struct Exact {};

/// The thesis' own method (5.3.2): the triangle is cut into 4^levels equal triangles, and each counts with
/// the distance of its centroid.
struct Split {
  int levels;
};

/// A product Gauss rule of points² nodes on the whole triangle.
struct Gauss {
  int points;
};

/// How ∫dA/d over one triangle is evaluated.
using Method = std::variant<Exact, Split, Gauss>;

/// 4^10 is a million centroids per triangle, where rounding begins to outweigh what a further level gains.
constexpr int most_split_levels = 10;

/// 64² nodes: beyond, a triangle that needs more is one a product rule does not suit.
constexpr int most_gauss_points = 64;

/// Reads "exact", "split:N" (N from 0 to 10) or "gauss:K" (K from 1 to 64). Throws InputError for anything
/// else.
Method parse_method(std::string_view text);

/// The text that parse_method reads back.
std::string to_string(const Method& method);

}  // namespace fringe
