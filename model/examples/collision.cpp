// Collisions and distances of convex shapes.
//
// gjk_intersects() decides whether two convex shapes have a point in common. Between flat shapes the decision
// is exact for the numbers given, and its certificate proves it: proves() checks the certificate in rational
// arithmetic. gjk_distance() finds the shortest distance with the two nearest points.
//
// Run it:  build/examples/collision
// Expect:  two unit cubes that share a face collide, because touching counts; moved apart by the
// smallest possible step, they do not.
//
// Output:
//   centres 0.5 apart along x: collision, distance 0, proven
//   centres 1 apart along x: collision, distance 0, proven
//   centres 1.0000000000000002 apart along x: clear, distance 2.22e-16, proven
//   centres 3 apart along x: clear, distance 2, proven
//   ball before the cube's corner: distance 1.232051, nearest point of the cube (0.5, 0.5, 0.5)

#include <cmath>
#include <cstdio>

#include "fringe/convex_shape.hpp"

int main() {
  const fringe::ConvexShape cube = fringe::ConvexShape::cuboid({1, 1, 1});
  const Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  const double one_step_apart = std::nextafter(1.0, 2.0);

  for (const double x : {0.5, 1.0, one_step_apart, 3.0}) {
    const Eigen::Isometry3d moved(Eigen::Translation3d(x, 0.25, 0));
    const fringe::GjkAnswer answer = fringe::gjk_intersects(cube, origin, cube, moved);
    const fringe::GjkDistance distance = fringe::gjk_distance(cube, origin, cube, moved);
    std::printf("centres %.17g apart along x: %s, distance %.3g, %s\n", x,
                answer.intersects ? "collision" : "clear", distance.distance,
                fringe::proves(answer, cube, origin, cube, moved) ? "proven" : "not proven");
  }

  const fringe::ConvexShape ball = fringe::ConvexShape::ball(0.5);
  const Eigen::Isometry3d corner(Eigen::Translation3d(1.5, 1.5, 1.5));
  const fringe::GjkDistance distance = fringe::gjk_distance(cube, origin, ball, corner);
  std::printf("ball before the cube's corner: distance %.6f, nearest point of the cube (%.1f, %.1f, %.1f)\n",
              distance.distance, distance.witness_a.x(), distance.witness_a.y(), distance.witness_a.z());
}
