#pragma once

#include <cstddef>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry.hpp"

/// Pairs of convex shapes of every kind that has made a collision query fail.
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

/// Its name in messages, in the place of its bytes.
inline void PrintTo(const PairClass& pairs, std::ostream* out) {
  *out << pairs.name;
}

std::span<const PairClass> pair_classes();

/// 1 to `most` points in the cube [−1, 1]³, or in a random plane, line or point of it.
Points any_shape(Random& random, std::size_t most);

/// A whole number from 0 to below the limit.
std::size_t below(Random& random, std::size_t limit);

/// All points times the factor, then moved.
ShapePair placed(const ShapePair& pair, double factor, const Eigen::Vector3d& offset);

}  // namespace fringe::test
