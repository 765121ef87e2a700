#include <cmath>
#include <vector>

#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "input.hpp"

namespace fringe::fuzz {

void gjk_intersects(Bytes bytes) {
  // Largest number of vertices of a set: slightly more than a box has.
  constexpr std::size_t most_vertices = 12;
  Input input(bytes);
  std::vector<Eigen::Vector3d> a, b;
  for (std::vector<Eigen::Vector3d>* set : {&a, &b}) {
    const std::size_t count = input.byte() % (most_vertices + 1);
    for (std::size_t i = 0; i < count; ++i)
      set->push_back(input.point());
  }
  try {
    const GjkAnswer answer = fringe::gjk_intersects(a, b);
    require(proves(answer, a, b), "the certificate proves the answer");
    require(fringe::gjk_intersects(b, a).intersects == answer.intersects, "the order does not matter");
    const GjkDistance distance = gjk_distance(a, b);
    require((distance.distance == 0) == answer.intersects || !ordinary(a) || !ordinary(b),
            "the distance is zero when they intersect, and only then");
    require(distance.distance >= 0, "the distance is a number, and not below zero");
  } catch (const InputError&) {
    // A set is empty or not finite.
  }
}

}  // namespace fringe::fuzz
