#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "collision/box_axes.hpp"
#include "collision/box_overlap.hpp"
#include "collision/convex_pieces.hpp"
#include "collision/scaled_points.hpp"
#include "fringe/bounding_volume.hpp"
#include "fringe/convex_shape.hpp"
#include "fringe/error.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"
#include "geometry/winding_number.hpp"
#include "shape_pairs.hpp"

/// Axes of boxes, boxes with a margin, scaled points and convex pieces of shapes, against brute force.
/// Compares the overlap tests of bounding volumes of two kinds with the certified intersection test of the
/// same shapes.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::draws;
using test::Random;

/// The volume of the smallest box with these axes (rows).
double volume_of_box(const std::vector<Vector3d>& points, const Matrix3d& axes) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& point : points)
    box.extend(axes * point);
  return box.volume();
}

/// The corners of a box that is turned at random.
std::vector<Vector3d> turned_box(test::Random& random, Matrix3d& turn) {
  turn = random.rigid_motion().linear();
  std::vector<Vector3d> points;
  for (int corner = 0; corner < 8; ++corner)
    points.emplace_back(turn * Vector3d((corner & 1) != 0 ? 0.9 : -0.9, (corner & 2) != 0 ? 0.4 : -0.4,
                                        (corner & 4) != 0 ? 0.2 : -0.2));
  return points;
}

const std::vector<Face> faces_of_turned_box{{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                            {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};

TEST(BoxAxes, AreThoseOfABoxHoweverItIsTurned) {
  test::Random random(1);
  for (int i = 0; i < 30; ++i) {
    Matrix3d turn;
    const std::vector<Vector3d> points = turned_box(random, turn);
    for (const Matrix3d& axes : {axes_of_vertices(points), axes_of_triangles(points, faces_of_turned_box),
                                 tight_axes(points, faces_of_turned_box), tight_axes(points, {})}) {
      EXPECT_LT((axes * axes.transpose() - Matrix3d::Identity()).norm(), 1e-14);
      EXPECT_NEAR(volume_of_box(points, axes), 1.8 * 0.8 * 0.4, 1e-12);
    }
  }
}

TEST(BoxAxes, TightOnesGiveNoLargerBoxThanTheOthers) {
  test::Random random(2);
  for (int i = 0; i < 30; ++i) {
    std::vector<Vector3d> points;
    for (int k = 0; k < 12; ++k)
      points.push_back(random.in_box({-1, -0.5, -0.2}, {1, 0.5, 0.2}));
    const double tight = volume_of_box(points, tight_axes(points, {}));
    EXPECT_LE(tight, volume_of_box(points, axes_of_vertices(points)) * (1 + 1e-12));
    EXPECT_LE(tight, volume_of_box(points, Matrix3d::Identity()) * (1 + 1e-12));
  }
}

TEST(BoxOverlap, IsNeverDeniedToBoxesWithACommonPoint) {
  test::Random random(3);
  int apart = 0;
  for (int i = 0; i < 500; ++i) {
    const auto any_box = [&] {
      return OrientedBox{random.in_box({-1, -1, -1}, {1, 1, 1}), random.rigid_motion().linear(),
                         random.in_box({0, 0, 0}, {0.6, 0.6, 0.6})};
    };
    const OrientedBox a = any_box(), b = any_box();
    bool have_common_point = false;
    for (int k = 0; k < 200 && !have_common_point; ++k) {
      const Vector3d point =
          a.centre + a.axes.transpose() * a.half_widths.cwiseProduct(random.in_box({-1, -1, -1}, {1, 1, 1}));
      have_common_point = ((b.axes * (point - b.centre)).cwiseAbs().array() <= b.half_widths.array()).all();
    }
    if (have_common_point) {
      EXPECT_TRUE(overlap_within(a, b, 1e-9));
    }
    // Boxes whose balls are apart by more than any margin are apart.
    const double gap = (a.centre - b.centre).norm() - a.half_widths.norm() - b.half_widths.norm();
    if (gap > 0.1) {
      ++apart;
      EXPECT_FALSE(overlap_within(a, b, 1e-9));
    }
  }
  EXPECT_GT(apart, 10);
}

TEST(ScaledPoints, AreWithinOneAndGiveBackThePoints) {
  test::Random random(4);
  for (const double size : {1e-300, 1e-3, 1.0, 1e300}) {
    std::vector<Vector3d> points;
    for (int k = 0; k < 5; ++k)
      points.push_back(size * random.in_box({-1, -1, -1}, {1, 1, 1}));
    const ScaledPoints scaled = scaled_points(points);
    double largest = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(std::ldexp(scaled.points[k][axis], scaled.exponent), points[k][axis]);
      largest = std::max(largest, scaled.points[k].cwiseAbs().maxCoeff());
    }
    EXPECT_LE(largest, 1);
    EXPECT_GT(largest, 0.25);
    EXPECT_LE(scaled.middle.cwiseAbs().maxCoeff(), 1);
  }
  EXPECT_THROW(scaled_points({}), InputError);
  EXPECT_THROW(scaled_points(std::vector{Vector3d(0, NAN, 0)}), InputError);
}

/// Tells whether a point is in a piece of a shape.
bool is_in_pieces(const ConvexPieces& pieces, const Vector3d& point) {
  const ConvexShape one_point = ConvexShape::hull(std::vector{point});
  for (const ConvexPiece& piece : pieces.pieces)
    if (intersect(piece.shape, piece.pose, one_point, Eigen::Isometry3d::Identity()))
      return true;
  return false;
}

// The pieces are truly round, the triangles inscribed: points inside these are in a piece, and none outside
// of the box is.
TEST(ConvexPieces, ContainTheShapeAndLieInItsBox) {
  test::Random random(5);
  const std::vector<Shape> shapes{Cuboid{1, 0.5, 0.2},
                                  Cylinder{0.5, 0.4, 24},
                                  Cone{0.5, 0.8, 24},
                                  Arc{0.3, 0.5, 0.2, 300, 24},
                                  Sphere{0.5, 16},
                                  Capsule{0.2, 0.4, 16},
                                  Ellipsoid{0.5, 0.3, 0.2, 16},
                                  RoundedCuboid{1, 0.6, 0.4, 0.1, 8}};
  for (const Shape& shape : shapes) {
    const ConvexPieces pieces = convex_pieces(shape);
    const OrientedBox box = enclosing_box(shape);
    const std::vector<Triangle> surface = triangulate(shape);
    int inside = 0;
    for (int k = 0; k < 200; ++k) {
      const Vector3d point = random.in_box({-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6});
      const bool is_in_shape = is_in_polyhedron(surface, point), is_in_piece = is_in_pieces(pieces, point);
      inside += is_in_shape ? 1 : 0;
      EXPECT_TRUE(is_in_piece || !is_in_shape) << shape.index() << ": " << point.transpose();
      EXPECT_TRUE(!is_in_piece ||
                  ((box.axes * (point - box.centre)).cwiseAbs().array() <= box.half_widths.array()).all())
          << shape.index() << ": " << point.transpose();
    }
    EXPECT_GT(inside, 0) << shape.index();
  }
}

constexpr int pairs = draws(20000);

OrientedBox any_box(Random& random) {
  const Isometry3d motion = random.rigid_motion();
  return {random.in_box({-1, -1, -1}, {1, 1, 1}), motion.linear().transpose(),
          random.in_box({0, 0, 0}, {0.8, 0.8, 0.8})};
}

AlignedBox3d any_aligned_box(Random& random) {
  const Vector3d low = random.in_box({-1.5, -1.5, -1.5}, {1, 1, 1});
  return {low, low + random.in_box({0, 0, 0}, {1.2, 1.2, 1.2})};
}

BoundingSphere any_sphere(Random& random) {
  return {random.in_box({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}), random.uniform(0, 1)};
}

Isometry3d pose_of(const OrientedBox& box) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = box.axes.transpose();
  pose.translation() = box.centre;
  return pose;
}

ConvexShape shape_of(const OrientedBox& box) {
  return ConvexShape::cuboid(2 * box.half_widths);
}

OrientedBox oriented(const AlignedBox3d& box) {
  return {box.center(), Eigen::Matrix3d::Identity(), box.sizes() / 2};
}

bool meets(const BoundingSphere& sphere, const OrientedBox& box) {
  Isometry3d place = Isometry3d::Identity();
  place.translation() = sphere.centre;
  return intersect(ConvexShape::ball(sphere.radius), place, shape_of(box), pose_of(box));
}

/// Checks that both tests agree on random pairs, and that neither answer is rare. Random pairs are never so
/// close that rounding decides.
template <class Make>
void expect_agreement(const Make& make) {
  Random random(1);
  int meeting = 0;
  for (int i = 0; i < pairs; ++i) {
    const auto [answer, truth] = make(random);
    ASSERT_EQ(answer, truth) << i;
    meeting += truth ? 1 : 0;
  }
  EXPECT_GT(meeting, pairs / 10);
  EXPECT_LT(meeting, pairs * 9 / 10);
}

TEST(MixedOverlap, OfSphereAndAlignedBoxAgreesWithGjk) {
  expect_agreement([](Random& random) {
    const BoundingSphere sphere = any_sphere(random);
    const AlignedBox3d box = any_aligned_box(random);
    return std::pair(overlap(sphere, box), meets(sphere, oriented(box)));
  });
}

TEST(MixedOverlap, OfSphereAndOrientedBoxAgreesWithGjk) {
  expect_agreement([](Random& random) {
    const BoundingSphere sphere = any_sphere(random);
    const OrientedBox box = any_box(random);
    return std::pair(overlap(sphere, box), meets(sphere, box));
  });
}

TEST(MixedOverlap, OfAlignedAndOrientedBoxAgreesWithGjk) {
  expect_agreement([](Random& random) {
    const AlignedBox3d a = any_aligned_box(random);
    const OrientedBox own = oriented(a), b = any_box(random);
    return std::pair(overlap(a, b), intersect(shape_of(own), pose_of(own), shape_of(b), pose_of(b)));
  });
}

/// Checks that the bounding volumes of shapes that touch or almost touch, some of them a kilometre away, are
/// never reported as disjoint.
TEST(MixedOverlap, IsNeverDeniedWhenAVertexIsShared) {
  Random random(2);
  for (const test::PairClass& pair_class : test::pair_classes())
    for (int i = 0; i < 100; ++i) {
      test::ShapePair pair = pair_class.make(random);
      // A common vertex lies in the volumes around both, whatever the class.
      pair.b.push_back(pair.a.back());
      const BoundingSphere sphere = bounding_sphere(pair.a);
      const AlignedBox3d aligned = axis_aligned_box(pair.b);
      const OrientedBox box = oriented_box(pair.b, {}, BoxMethod::vertices);
      ASSERT_TRUE(overlap(sphere, aligned)) << pair_class.name;
      ASSERT_TRUE(overlap(sphere, box)) << pair_class.name;
      ASSERT_TRUE(overlap(axis_aligned_box(pair.a), box)) << pair_class.name;
    }
}

TEST(MixedOverlap, IsTrueForTouchingVolumes) {
  const AlignedBox3d unit{Vector3d(0, 0, 0), Vector3d(1, 1, 1)};
  EXPECT_TRUE(overlap(BoundingSphere{{3, 0.5, 0.5}, 2}, unit));
  EXPECT_FALSE(overlap(BoundingSphere{{3.001, 0.5, 0.5}, 2}, unit));
  EXPECT_TRUE(overlap(BoundingSphere{{0.5, 0.5, 0.5}, 0}, unit));
  EXPECT_TRUE(overlap(AlignedBox3d{Vector3d(1, 1, 1), Vector3d(2, 2, 2)}, oriented(unit)));
  EXPECT_FALSE(overlap(AlignedBox3d{Vector3d(1.001, 1, 1), Vector3d(2, 2, 2)}, oriented(unit)));
  EXPECT_FALSE(overlap(AlignedBox3d(), oriented(unit)));
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
