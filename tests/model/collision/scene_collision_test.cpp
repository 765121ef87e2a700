#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/bounding_volume.hpp"
#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene_collision.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"
#include "shape_pairs.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::at;
using test::Random;
using testing::IsEmpty;
using testing::SizeIs;

const Shape cube = Cuboid{1, 1, 1};

Object object(const std::string& name, const Shape& shape, const Isometry3d& pose = Isometry3d::Identity()) {
  return test::object(name, shape, pose);
}

PairStatus status_of(const Shape& a, const Shape& b, const Isometry3d& pose_b) {
  Scene scene;
  scene.objects = {object("a", a), object("b", b, pose_b)};
  return all_pairs(collide(scene), scene).at(0).status;
}

TEST(Collide, DistinguishesClearBoundsAndCollision) {
  EXPECT_EQ(status_of(cube, cube, at(2, 0, 0)), PairStatus::clear);
  EXPECT_EQ(status_of(cube, cube, at(0.9, 0, 0)), PairStatus::collision);
  // The balls' boxes overlap at their corners, the balls do not.
  EXPECT_EQ(status_of(Sphere{1, 12}, Sphere{1, 12}, at(1.9, 1.9, 0)), PairStatus::bounds);
}

TEST(Collide, CountsTouchingAsCollision) {
  EXPECT_EQ(status_of(cube, cube, at(1, 0.25, 0)), PairStatus::collision);
  EXPECT_EQ(status_of(cube, cube, at(std::nextafter(1.0, 2.0), 0.25, 0)), PairStatus::bounds);
  EXPECT_EQ(status_of(cube, Plate{1, 1}, at(0, 0, 0.5)), PairStatus::collision);
}

TEST(Collide, TreatsRoundShapesAsTrulyRound) {
  // A prism of six segments reaches 0.87 of the radius midway between its corners; the cylinder itself
  // reaches the whole radius.
  const Isometry3d half_a_segment = pose_from_axis({0, 0, 1}, 30, {1.98, 0, 0});
  for (const Shape& shape :
       {Shape(Cylinder{1, 1, 6}), Shape(Disc{1, 6}), Shape(Capsule{1, 1, 4}), Shape(Ellipsoid{1, 1, 2, 6})})
    EXPECT_EQ(status_of(shape, shape, half_a_segment), PairStatus::collision) << shape.index();
  EXPECT_EQ(status_of(Ellipsoid{1, 1, 2, 6}, Ellipsoid{1, 1, 2, 6}, at(1.5, 0, 2.7)), PairStatus::bounds);
  // Beyond the corner at 45 degrees the rounding takes away 1.414 - 1 of its radius.
  const Shape rounded = RoundedCuboid{2, 2, 1, 0.5, 4}, thin = Cuboid{0.01, 4, 0.2};
  const auto beside_corner = [](double gap) {
    const double away = 0.5 * std::sqrt(2) + 0.5 + gap + 0.005;
    return pose_from_axis({0, 0, 1}, 45, {away * std::sqrt(0.5), away * std::sqrt(0.5), 0});
  };
  EXPECT_EQ(status_of(rounded, thin, beside_corner(1e-9)), PairStatus::bounds);
  EXPECT_EQ(status_of(rounded, thin, beside_corner(-1e-9)), PairStatus::collision);
}

TEST(Collide, FindsNoCollisionInTheHollowOfAPolygon) {
  const Shape l_shape = Polygon{{{0, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 1}, {0, 1}}};
  EXPECT_EQ(status_of(l_shape, Sphere{0.4, 12}, at(0.5, 1.5, 0)), PairStatus::bounds);
  EXPECT_EQ(status_of(l_shape, Sphere{0.6, 12}, at(0.5, 1.5, 0)), PairStatus::collision);
  EXPECT_EQ(status_of(l_shape, Sphere{0.4, 12}, at(1.5, 1.5, 0.3)), PairStatus::collision);
}

TEST(Collide, FindsNoCollisionInTheHollowOfAConcaveShapeOrMesh) {
  const Shape arc = Arc{1, 1.2, 1, 270, 27}, mesh = Mesh{"", 1, triangulate(arc)};
  for (const Shape& shape : {arc, mesh}) {
    EXPECT_EQ(status_of(shape, Sphere{0.9, 12}, Isometry3d::Identity()), PairStatus::bounds);
    EXPECT_EQ(status_of(shape, Sphere{0.9, 12}, at(0.15, 0, 0)), PairStatus::collision);
    EXPECT_EQ(status_of(shape, Sphere{0.6, 12}, at(-1, 0, 0)), PairStatus::bounds) << "in the gap of the arc";
  }
  EXPECT_EQ(status_of(mesh, mesh, at(0, 0, 1.01)), PairStatus::clear);
  EXPECT_EQ(status_of(mesh, mesh, at(0, 0, 0.99)), PairStatus::collision);
}

TEST(Collide, FindsObjectsInsideAClosedMesh) {
  std::vector<Triangle> triangles = triangulate(cube);
  const Shape closed = Mesh{"", 1, triangles};
  triangles.pop_back();
  const Shape open = Mesh{"", 1, triangles};
  const Shape small = Mesh{"", 1, triangulate(Sphere{0.1, 8})};
  EXPECT_EQ(status_of(closed, Sphere{0.1, 8}, at(0.2, 0, 0)), PairStatus::collision);
  EXPECT_EQ(status_of(small, closed, at(0.2, 0, 0)), PairStatus::collision);
  EXPECT_EQ(status_of(open, Sphere{0.1, 8}, at(0.2, 0, 0)), PairStatus::bounds);
}

/// Returns a scene with one cube on each of two links and one in the world, all in the same place.
Scene three_cubes() {
  Scene scene;
  scene.links = {{"left", std::nullopt}, {"right", std::nullopt}};
  scene.objects = {test::on_link(0, object("a", cube)), test::on_link(1, object("b", cube)),
                   object("c", cube)};
  return scene;
}

TEST(Collide, IgnoresObjectsOfOneLinkAndObjectsThatDoNotCollide) {
  Scene scene = three_cubes();
  EXPECT_THAT(collide(scene).marked, SizeIs(3));
  scene.objects[1].link = 0;
  EXPECT_THAT(collide(scene).marked, SizeIs(2));
  scene.objects[2].collides = false;
  EXPECT_THAT(all_pairs(collide(scene), scene), IsEmpty());
}

TEST(Collide, IgnoresObjectsOfALinkAndItsParentUnlessTheLowerOneAsks) {
  Scene scene = three_cubes();
  scene.links[1].parent = 0;
  EXPECT_THAT(collide(scene).marked, SizeIs(2)) << "the cube in the world stays";
  scene.objects[0].collides_with_parent = true;
  EXPECT_THAT(collide(scene).marked, SizeIs(2)) << "the upper one has no parent";
  scene.objects[1].collides_with_parent = true;
  EXPECT_THAT(collide(scene).marked, SizeIs(3));
}

TEST(Collide, ChecksObjectsOfALinkAndTheParentOfItsParent) {
  Scene scene = three_cubes();
  scene.links = {{"left", std::nullopt}, {"right", 2}, {"between", 0}};
  scene.objects.pop_back();
  EXPECT_THAT(collide(scene).marked, SizeIs(1));
}

/// Computes the tight box of a mesh of two triangles.
OrientedBox tight_box(const Mesh& mesh, const Isometry3d& pose) {
  std::vector<Vector3d> corners;
  for (const Triangle& triangle : mesh.triangles)
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  const OrientedBox box = oriented_box(corners, std::vector<Face>{{0, 1, 2}, {3, 4, 5}}, BoxMethod::tight);
  return {pose * box.centre, box.axes * pose.linear().transpose(), box.half_widths};
}

TEST(Collide, BoundsAMeshByItsTightBox) {
  Random random(9);
  const auto any_mesh = [&] {
    const Vector3d low(-0.5, -0.5, -0.1), high(0.5, 0.5, 0.1);
    const Triangle first = random.triangle_in_box(low, high);
    return Mesh{"", 1, {first, random.triangle_in_box(low, high)}};
  };
  int clear = 0, near = 0;
  for (int k = 0; k < 400; ++k) {
    const Mesh a = any_mesh(), b = any_mesh();
    Isometry3d pose = random.rigid_motion();
    pose.translation() *= 0.7;
    const bool meet = overlap(tight_box(a, Isometry3d::Identity()), tight_box(b, pose));
    ASSERT_EQ(status_of(a, b, pose) != PairStatus::clear, meet) << k;
    ++(meet ? near : clear);
  }
  EXPECT_GT(clear, 100);
  EXPECT_GT(near, 50);
}

/// A shape that has a box, from 0.85 to 1 along x, but cannot be divided into convex pieces, because its
/// inner radius is the larger one: it is refused as soon as it is divided.
const Shape without_pieces = Arc{1.2, 1, 1, 90, 3};

TEST(CollisionDetector, DividesAnObjectIntoPiecesOnlyWhenABoxMeetsItsOwn) {
  Scene scene;
  scene.links = {{"arm", std::nullopt, at(9, 0, 0)}};
  scene.objects = {test::on_link(0, object("a", cube)), object("b", without_pieces)};
  CollisionDetector detector(scene);
  EXPECT_THAT(detector.collide().marked, IsEmpty());
  detector.set_pose("arm", at(1, 0, 0));
  EXPECT_THROW(detector.collide(), InputError);
  detector.set_pose("arm", at(9, 0, 0));
  EXPECT_THAT(detector.collide().marked, IsEmpty()) << "and what was refused is forgotten";
}

TEST(CollisionDetector, ComputesNoBoxOfAnObjectThatCannotCollide) {
  const double infinite = std::numeric_limits<double>::infinity();
  const Shape without_box = Mesh{"", 1, {{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, infinite, 0)}}};
  Scene scene = three_cubes();
  scene.objects[0].shape = without_box;
  EXPECT_THROW(collide(scene), InputError);
  scene.objects[1].link = 0;
  scene.objects[2].collides = false;
  EXPECT_THAT(collide(scene).marked, IsEmpty()) << "its only neighbour is on the same link";
  scene.objects.resize(1);
  EXPECT_THAT(collide(scene).marked, IsEmpty());
  scene.objects = {object("a", without_box), object("b", cube)};
  scene.objects[0].collides = false;
  EXPECT_THAT(collide(scene).marked, IsEmpty());
}

TEST(CollisionDetector, TestsOnlyPairsThatHaveMoved) {
  const Scene scene = three_cubes();
  CollisionDetector detector(scene);
  EXPECT_EQ(detector.collide().tests.narrow, 3U);
  EXPECT_EQ(detector.collide().tests.broad, 0U);
  detector.set_pose("left", at(0.5, 0, 0));
  EXPECT_EQ(detector.collide().tests.narrow, 2U);
  EXPECT_THAT(detector.collide().marked, SizeIs(3));
  detector.set_pose("left", at(5, 0, 0));
  EXPECT_EQ(detector.collide().tests.narrow, 0U);
  EXPECT_THAT(detector.collide().marked, SizeIs(1));
  EXPECT_THROW(detector.set_pose("middle", at(0, 0, 0)), InputError);
}

/// Returns a shape without round surfaces, for which testing all pairs of triangles decides whether shapes
/// intersect.
Shape any_flat_shape(Random& random) {
  const auto size = [&] { return random.uniform(0.1, 0.6); };
  if (test::below(random, 3) == 0)
    return Plate{size(), size()};
  if (test::below(random, 2) == 0)
    return Cuboid{size(), size(), size()};
  return Mesh{"", 1, triangulate(Cone{size(), size(), 5})};
}

bool solid(const Shape& shape) {
  return !std::holds_alternative<Plate>(shape);
}

/// Decides whether two objects intersect from all triangles of plates and the hulls of all vertices of the
/// other shapes, which are convex and solid.
bool surfaces_meet(const Object& a, const Isometry3d& pose_a, const Object& b, const Isometry3d& pose_b) {
  std::array<std::vector<std::vector<Vector3d>>, 2> parts;
  std::size_t side = 0;
  for (const auto& [form, pose] : {std::pair(&a, pose_a), std::pair(&b, pose_b)}) {
    std::vector<Vector3d> all;
    for (const Triangle& triangle : triangulate(form->shape)) {
      std::vector<Vector3d> corners;
      for (const Vector3d& corner : triangle)
        corners.emplace_back(pose * corner);
      all.insert(all.end(), corners.begin(), corners.end());
      if (!solid(form->shape))
        parts[side].push_back(corners);
    }
    if (solid(form->shape))
      parts[side].push_back(all);
    ++side;
  }
  for (const auto& on_a : parts[0])
    for (const auto& on_b : parts[1])
      if (gjk_intersects(on_a, on_b).intersects)
        return true;
  return false;
}

TEST(CollisionDetector, AgreesWithAllPairsOfTrianglesWhileLinksMove) {
  Random random(5);
  constexpr std::size_t link_count = 30, objects_per_link = 2;
  Scene scene;
  for (std::size_t i = 0; i < link_count; ++i) {
    std::optional<std::size_t> parent;
    if (i > 0 && test::below(random, 3) == 0)
      parent = test::below(random, i);
    scene.links.push_back({"link " + std::to_string(i), parent, random.rigid_motion()});
    for (std::size_t k = 0; k < objects_per_link; ++k) {
      const std::string name = std::to_string(i) + "," + std::to_string(k);
      const Isometry3d pose = random.rigid_motion();
      scene.objects.push_back(test::on_link(i, object(name, any_flat_shape(random), pose)));
    }
  }
  CollisionDetector detector(scene);
  int collisions = 0, bounds = 0;
  for (int frame = 0; frame < 6; ++frame) {
    const SceneCollision answer = detector.collide();
    std::map<std::pair<std::size_t, std::size_t>, PairStatus> found;
    for (const ObjectPair& pair : all_pairs(answer, scene))
      found[{pair.a, pair.b}] = pair.status;
    const std::vector<Isometry3d> links = world_poses(scene.links);
    for (const auto& [pair, status] : found) {
      const Object& a = scene.objects[pair.first];
      const Object& b = scene.objects[pair.second];
      const bool meet = surfaces_meet(a, attachment_pose(links, a.link) * a.pose, b,
                                      attachment_pose(links, b.link) * b.pose);
      ASSERT_EQ(status == PairStatus::collision, meet) << frame << ": " << a.name << " and " << b.name;
      collisions += meet;
      bounds += status == PairStatus::bounds;
    }
    for (int moves = 0; moves < 4; ++moves) {
      const std::string& link = scene.links[test::below(random, link_count)].name;
      const Isometry3d pose = random.rigid_motion();
      set_pose(scene, link, pose);
      detector.set_pose(link, pose);
    }
  }
  EXPECT_GT(collisions, 100);
  EXPECT_GT(bounds, 50);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
