#include "geometry/polygon.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::defect_of_polygon;
using detail::triangles_of_polygon;
using Eigen::Vector3d;
using Vertices = std::vector<Eigen::Vector2d>;

const Vertices l_shape{{0, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 1}, {0, 1}};

TEST(Polygons, AreDividedByClippingEarsInTheOrderOfTheFormat) {
  const std::vector<Triangle> triangles = triangles_of_polygon(l_shape);
  const std::vector<Triangle> expected{{Vector3d{0, 1, 0}, {0, 0, 0}, {2, 0, 0}},
                                       {Vector3d{2, 0, 0}, {2, 2, 0}, {1, 2, 0}},
                                       {Vector3d{2, 0, 0}, {1, 2, 0}, {1, 1, 0}},
                                       {Vector3d{0, 1, 0}, {2, 0, 0}, {1, 1, 0}}};
  EXPECT_EQ(triangles, expected);
}

TEST(Polygons, HaveTheirNormalsAlongZInEitherOrder) {
  const Vertices clockwise(l_shape.rbegin(), l_shape.rend());
  EXPECT_EQ(triangles_of_polygon(clockwise).size(), 4U);
  for (const auto& [a, b, c] : triangles_of_polygon(clockwise))
    EXPECT_GT((b - a).cross(c - a).z(), 0);
}

TEST(Polygons, WithVerticesInTheMiddleOfSidesHaveNoTriangleWithoutArea) {
  const Vertices square{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  const std::vector<Triangle> triangles = triangles_of_polygon(square);
  EXPECT_EQ(triangles.size(), 6U);
  for (const Triangle& triangle : triangles)
    EXPECT_GT(area(std::vector{triangle}), 0.4);
  EXPECT_DOUBLE_EQ(area(triangles), 4);
}

// The messages are tested in tests/end_to_end/test_scene_readers_agree.py, for both readers.
TEST(Polygons, ThatAreNotSimpleAreRefused) {
  EXPECT_EQ(defect_of_polygon(l_shape), std::nullopt);
  EXPECT_THROW(triangles_of_polygon(Vertices{{0, 0}, {1, 1}, {1, 0}, {0, 1}}), InputError);
}

/// A vertex one unit in the last place to either side of a line; the products round to the same number.
TEST(Polygons, AreJudgedExactly) {
  const double on = 0.1 + 0.2;
  for (const double y : {std::nextafter(on, 0.0), on, std::nextafter(on, 1.0)}) {
    const Vertices vertices{{0, 0}, {3 * on, 3 * on}, {-1, 1}, {on, y}};
    EXPECT_EQ(defect_of_polygon(vertices).has_value(), y <= on) << y;
  }
}

using detail::remarks_on_faces;
using testing::ElementsAre;
using Outline = std::vector<Vector3d>;

struct Divided {
  std::vector<Triangle> triangles;
  detail::FaceDefects defects;
};

Divided divided(const Outline& outline) {
  Divided result;
  detail::append_face(result.triangles, outline, result.defects);
  return result;
}

const Vector3d o(0, 0, 0);
const Outline dart{{2, 0, 0}, {1, 0.2, 0}, {1, 2, 0}, o};
const Outline comb{o, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 3, 0}, {3, 3, 0}, {3, 1, 0}, {0, 1, 0}};
/// A square around another one, whose outline goes to the hole and back from its first corner.
const Outline hole{o,         {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, o,
                   {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
/// A square less a quadrilateral that touches its first corner from within.
const Outline touching{o, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, o, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}};

TEST(Faces, ThatAreConvexAreFansFromTheirFirstCorner) {
  const Vector3d a(0, 0, 1), b(2, 0, 1), c(2, 2, 1), d(1, 3, 1), e(0, 2, 1);
  EXPECT_THAT(divided({a, b, c, d, e}).triangles,
              ElementsAre(Triangle{a, b, c}, Triangle{a, c, d}, Triangle{a, d, e}));
  EXPECT_THAT(divided({e, d, c, b, a}).triangles,
              ElementsAre(Triangle{e, d, c}, Triangle{e, c, b}, Triangle{e, b, a}));
}

TEST(Faces, ThatAreNotConvexAreDividedByClippingEars) {
  EXPECT_THAT(divided(dart).triangles,
              ElementsAre(Triangle{dart[3], dart[0], dart[1]}, Triangle{dart[3], dart[1], dart[2]}));
}

TEST(Faces, AreCoveredOnceFromEachCornerOnAndInEveryPlane) {
  for (const auto& [outline, expected] : {std::pair(dart, 1.1), {comb, 10.}, {hole, 12.}, {touching, 14.}})
    for (std::size_t first = 0; first < outline.size(); ++first)
      for (const Eigen::Index axis : {0, 1, 2}) {
        Outline turned;
        for (std::size_t k = 0; k < outline.size(); ++k) {
          const Vector3d& corner = outline[(first + k) % outline.size()];
          Vector3d& added = turned.emplace_back(0, 0, 0);
          added[axis] = corner.x();
          added[(axis + 1) % 3] = corner.y();
        }
        const Divided found = divided(turned);
        EXPECT_EQ(found.triangles.size(), outline.size() - 2);
        EXPECT_NEAR(area(found.triangles), expected, 1e-12);
        EXPECT_THAT(remarks_on_faces(found.defects, 1), ElementsAre());
      }
}

TEST(Faces, ThatBoundNoOneSurfaceAreCounted) {
  const Divided bow_tie = divided({o, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(bow_tie.triangles.size(), 2U);
  EXPECT_THAT(
      remarks_on_faces(bow_tie.defects, 1),
      ElementsAre("faces whose outline crosses itself: 1; triangles would say which surface is meant"));
  // The corners are by turns 0.02 above and below the middle plane.
  const Divided bent = divided({o, {1, 0, 0.04}, {1, 1, 0}, {0, 1, 0.04}});
  EXPECT_THAT(
      remarks_on_faces(bent.defects, 1e-3),
      ElementsAre("faces whose corners are not in one plane: 1, by up to 4e-05 m; triangles would say "
                  "which surface is meant"));
  EXPECT_EQ(divided({o, {1, 0, 0.0005}, {1, 1, 0}, {0, 1, 0.0005}}).defects.bent, 0U);
}

TEST(Faces, WithoutAreaStay) {
  EXPECT_EQ(divided({o, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}).triangles.size(), 2U);
  const Divided repeated = divided({o, o, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  EXPECT_EQ(repeated.triangles.size(), 3U);
  EXPECT_DOUBLE_EQ(area(repeated.triangles), 1);
  EXPECT_EQ(repeated.defects.crossing, 0U);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
