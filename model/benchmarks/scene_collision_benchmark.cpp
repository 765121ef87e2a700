#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fringe/convex_shape.hpp"
#include "fringe/scene_collision.hpp"
#include "peers/peer.hpp"
#include "random.hpp"

/// Measures the milliseconds per frame of a scene in which every object moves: fringe's detector, all pairs
/// by the same test of two shapes, and FCL's dynamic tree. Times are medians of rounds in which the three
/// take turns. The density of objects is the same in every row, so that contacts grow with their number and
/// pairs with its square.
///
///     scene_collision_benchmark [ROUNDS [FILE.json]]
namespace {

using namespace fringe;
using namespace fringe::benchmarks;
using Eigen::Isometry3d;
using Eigen::Vector3d;

struct MovingObjects {
  PeerShapes shapes;
  std::vector<Vector3d> places;
  double half_side;

  explicit MovingObjects(std::size_t count) : half_side(std::cbrt(static_cast<double>(count))) {
    Random random;
    const auto length = [&] { return random.uniform(0.4, 1.2); };
    for (std::size_t i = 0; i < count; ++i) {
      const auto kind = static_cast<PeerShape::Kind>(random.below(3));
      const Vector3d sides(length(), length(), length());
      shapes.push_back({kind, kind == PeerShape::Kind::cuboid ? sides : Vector3d(sides[0] / 2, sides[1], 0)});
      places.push_back(random.in_cube(half_side));
    }
  }

  /// Moves every object by a small step and turns it.
  std::vector<Isometry3d> next_poses(Random& random) {
    constexpr double step = 0.05;
    std::vector<Isometry3d> poses;
    for (Vector3d& place : places) {
      place += random.in_cube(step);
      poses.push_back(random.turn());
      poses.back().pretranslate(place);
    }
    return poses;
  }
};

Shape scene_shape(const PeerShape& shape) {
  // The number of segments does not affect collisions.
  constexpr int segments = 12;
  switch (shape.kind) {
  case PeerShape::Kind::cylinder:
    return Cylinder{shape.size[0], shape.size[1], segments};
  case PeerShape::Kind::cone:
    return Cone{shape.size[0], shape.size[1], segments};
  default:
    return Cuboid{shape.size[0], shape.size[1], shape.size[2]};
  }
}

ConvexShape convex_shape(const PeerShape& shape) {
  switch (shape.kind) {
  case PeerShape::Kind::cylinder:
    return ConvexShape::cylinder(shape.size[0], shape.size[1]);
  case PeerShape::Kind::cone:
    return ConvexShape::cone(shape.size[0], shape.size[1]);
  default:
    return ConvexShape::cuboid(shape.size);
  }
}

Scene scene_of(const MovingObjects& objects) {
  Scene scene;
  for (std::size_t i = 0; i < objects.shapes.size(); ++i) {
    scene.links.push_back({fmt::format("link {}", i), std::nullopt});
    scene.objects.push_back(
        {.name = fmt::format("object {}", i), .link = i, .shape = scene_shape(objects.shapes[i])});
  }
  return scene;
}

std::size_t collide_by_detector(CollisionDetector& detector, const Scene& scene,
                                const std::vector<Isometry3d>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i)
    detector.set_pose(scene.links[i].name, poses[i]);
  const std::vector<ObjectPair>& marked = detector.collide().marked;
  return static_cast<std::size_t>(std::count_if(marked.begin(), marked.end(), [](const ObjectPair& pair) {
    return pair.status == PairStatus::collision;
  }));
}

std::size_t collide_all_pairs(const std::vector<ConvexShape>& shapes, const std::vector<Isometry3d>& poses) {
  std::size_t count = 0;
  for (std::size_t a = 0; a < shapes.size(); ++a)
    for (std::size_t b = a + 1; b < shapes.size(); ++b)
      count += intersect(shapes[a], poses[a], shapes[b], poses[b]) ? 1U : 0U;
  return count;
}

/// Measures one number of objects; returns a JSON object for the report.
std::string measure(std::size_t object_count, int rounds) {
  MovingObjects objects(object_count);
  const Scene scene = scene_of(objects);
  CollisionDetector detector(scene);
  FclScene fcl_scene(objects.shapes);
  std::vector<ConvexShape> shapes;
  for (const PeerShape& shape : objects.shapes)
    shapes.push_back(convex_shape(shape));
  Random random;
  std::vector<std::vector<double>> times(3);
  std::vector<std::size_t> collisions(3);
  for (int round = 0; round < rounds; ++round) {
    const std::vector<Isometry3d> poses = objects.next_poses(random);
    const std::vector<std::function<std::size_t()>> ways{
        [&] { return collide_by_detector(detector, scene, poses); },
        [&] { return collide_all_pairs(shapes, poses); }, [&] { return fcl_scene.collide(poses); }};
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      collisions[i] = ways[i]();
      const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
      times[i].push_back(elapsed.count());
    }
  }
  std::string json = fmt::format("{{\"objects\": {}, \"ways\": [", object_count);
  const std::array<const char*, 3> names{"fringe", "all pairs", "FCL"};
  fmt::print("{:>7} {:>9}", object_count, object_count * (object_count - 1) / 2);
  for (const std::size_t count : collisions)
    fmt::print(" {:>6}", count);
  for (std::size_t i = 0; i < times.size(); ++i) {
    std::vector<double>& own = times[i];
    std::nth_element(own.begin(), own.begin() + rounds / 2, own.end());
    const double median = own[static_cast<std::size_t>(rounds) / 2];
    fmt::print(" {:>10.3f}", median);
    json += fmt::format("{}{{\"name\": \"{}\", \"milliseconds\": {}, \"collisions\": {}}}",
                        i == 0 ? "" : ", ", names[i], median, collisions[i]);
  }
  fmt::print("\n");
  return json + "]}";
}

}  // namespace

int main(int argument_count, char** arguments) {
  constexpr int usual_rounds = 15;
  const int rounds = argument_count > 1 ? std::stoi(arguments[1]) : usual_rounds;
  fmt::print("                  collisions found by  milliseconds per frame\n");
  fmt::print("objects     pairs fringe    all    FCL     fringe  all pairs        FCL\n");
  std::string json;
  for (const std::size_t objects : {250, 1000, 4000})
    json += (json.empty() ? "" : ",\n  ") + measure(objects, rounds);
  if (argument_count > 2)
    std::ofstream(arguments[2]) << "{\"scenes\": [\n  " << json << "\n]}\n";
}
