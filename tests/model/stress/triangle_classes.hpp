#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

/// Random triangles, class by class, at which formulas for the integral may break.
namespace fringe::stress {

/// A plate and what is integrated over in one call.
struct Group {
  Rectangle plate;
  std::vector<Triangle> triangles;
};

struct TriangleClass {
  std::string name;
  /// Rounding of the input matters little: an error of a few units in the last place is asked for.
  bool well_behaved;
};

/// All classes, in the order of the report.
std::vector<TriangleClass> triangle_classes();

/// The triangles of a class, the same for the same class, count and seed wherever it runs. Half of the plates
/// lie at the origin along the axes, half are turned and moved with their triangles; where a triangle has to
/// touch the plate exactly, by multiples of 90° and representable distances.
///
/// @throws InputError when there is no class of the name.
std::vector<Group> make_triangles(const std::string& name, std::size_t count, std::uint64_t seed);

}  // namespace fringe::stress
