#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include <Eigen/Geometry>

namespace fringe::detail {

/// Reorders items so that the first `half` of them lie below the others along the longest side of the box
/// around their points. Items with equal coordinates are ordered by their numbers, so that the result does
/// not depend on the standard library.
///
/// @param point_of returns the point of an item
/// @param number_of returns the number of an item, which differs between items
template <class Item, class PointOf, class NumberOf>
void split_at_median(std::span<Item> items, std::size_t half, const PointOf& point_of,
                     const NumberOf& number_of) {
  Eigen::AlignedBox3d box;
  for (const Item& item : items)
    box.extend(point_of(item));
  Eigen::Index axis = 0;
  // Half of each side, which cannot overflow.
  (box.max() / 2 - box.min() / 2).maxCoeff(&axis);
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                   [&](const Item& a, const Item& b) {
                     const double at_a = point_of(a)[axis], at_b = point_of(b)[axis];
                     return at_a < at_b || (at_a == at_b && number_of(a) < number_of(b));
                   });
}

/// Does the same for items that are numbers themselves.
template <class Number, class PointOf>
void split_at_median(std::span<Number> numbers, std::size_t half, const PointOf& point_of) {
  split_at_median(numbers, half, point_of, [](Number number) { return number; });
}

}  // namespace fringe::detail
