#pragma once

#include <cstddef>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry.hpp"

/// Pairs of convex shapes, in classes that make collision queries difficult.
namespace fringe::test {

using Points = std::vector<Eigen::Vector3d>;

struct ShapePair {
  Points a;
  Points b;
};

struct PairClass {
  std::string name;
  ShapePair (*make)(Random&);
};

/// Prints the class by its name instead of its bytes.
inline void PrintTo(const PairClass& pairs, std::ostream* out) {
  *out << pairs.name;
}

std::span<const PairClass> pair_classes();

/// Returns 1 to `most` points in the cube [−1, 1]³, or in a random plane, line or point of it.
Points any_shape(Random& random, std::size_t most);

/// Returns a random integer from 0 to limit − 1.
std::size_t below(Random& random, std::size_t limit);

/// Multiplies all points by the factor and then translates them.
ShapePair placed(const ShapePair& pair, double factor, const Eigen::Vector3d& offset);

}  // namespace fringe::test
