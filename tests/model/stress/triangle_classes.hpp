#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

/// Classes of random triangles for which formulas for the integral may fail.
namespace fringe::stress {

/// A plate and the triangles that are integrated in one call.
struct Group {
  Rectangle plate;
  std::vector<Triangle> triangles;
};

struct TriangleClass {
  std::string name;
  /// Whether rounding of the input matters little, so that an error of a few units in the last place is
  /// required.
  bool well_behaved;
};

/// Returns all classes in the order of the report.
std::vector<TriangleClass> triangle_classes();

/// Returns triangles of a class, which depend only on class, count and seed. Half of the plates lie at the
/// origin along the axes; the others are rotated and translated with their triangles. Where a triangle has to
/// touch the plate exactly, the rotation is by multiples of 90° and the translation is representable.
///
/// @throws InputError when there is no class of the name.
std::vector<Group> make_triangles(const std::string& name, std::size_t count, std::uint64_t seed);

}  // namespace fringe::stress
