#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "peers/peer.hpp"
#include "random.hpp"

/// Nanoseconds per boolean query of two convex shapes, beside FCL, libccd and Bullet: the median of many
/// rounds in which everybody takes turns. No query knows of an earlier one. Half of the pairs intersect, by
/// the distance of their centres; the last columns are how many answers differ from fringe's.
///
///     collision_benchmark [ROUNDS]
namespace {

using namespace fringe::benchmarks;
using Eigen::Vector3d;

constexpr std::size_t shapes_per_row = 16;
constexpr std::size_t pairs_per_row = 4000;

struct Row {
  std::string name;
  PeerShapes shapes;
};

PeerShape hull_on_ball(Random& random, std::size_t vertices) {
  PeerShape shape{PeerShape::Kind::hull};
  for (std::size_t i = 0; i < vertices; ++i)
    shape.vertices.push_back(random.direction());
  return shape;
}

std::vector<Row> rows() {
  Random random;
  const auto length = [&] { return random.uniform(0.5, 2); };
  std::vector<Row> made{{"cuboids", {}}, {"cylinder-cone", {}}};
  for (std::size_t i = 0; i < shapes_per_row; ++i) {
    made[0].shapes.push_back({PeerShape::Kind::cuboid, {length(), length(), length()}});
    // A is a shape of even index, B one of odd index.
    made[1].shapes.push_back(
        {i % 2 == 0 ? PeerShape::Kind::cylinder : PeerShape::Kind::cone, {length() / 2, length(), 0}});
  }
  for (const std::size_t vertices : {8, 32, 128, 512}) {
    Row& row = made.emplace_back(Row{fmt::format("{} vertices", vertices), {}});
    for (std::size_t i = 0; i < shapes_per_row; ++i)
      row.shapes.push_back(hull_on_ball(random, vertices));
  }
  return made;
}

/// Pairs at random distances up to `farthest` in random poses.
PeerPairs pairs_within(double farthest) {
  Random random;
  PeerPairs pairs;
  pairs.reserve(pairs_per_row);
  for (std::size_t i = 0; i < pairs_per_row; ++i) {
    PeerPair pair{2 * random.below(shapes_per_row / 2), 2 * random.below(shapes_per_row / 2) + 1,
                  random.turn(), random.turn()};
    pair.pose_a.pretranslate(random.in_cube(1));
    const double distance = farthest * std::cbrt(random.uniform(0, 1));
    pair.pose_b.pretranslate(pair.pose_a.translation() + distance * random.direction());
    pairs.push_back(pair);
  }
  return pairs;
}

/// So far apart that half of them intersect.
PeerPairs half_intersecting(const PeerShapes& shapes) {
  double low = 0, high = 10;
  constexpr int halvings = 20;
  for (int step = 0; step < halvings; ++step) {
    const double middle = (low + high) / 2;
    (2 * fringe_peer(shapes, pairs_within(middle))->count_intersecting() > pairs_per_row ? low : high) =
        middle;
  }
  return pairs_within(high);
}

double nanoseconds_per_query(const Peer& peer, std::size_t& count) {
  const auto start = std::chrono::steady_clock::now();
  count = peer.count_intersecting();
  const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - start;
  return elapsed.count() / static_cast<double>(pairs_per_row);
}

using MakePeer = std::unique_ptr<Peer> (*)(const PeerShapes&, const PeerPairs&);

void measure(const std::string& name, const PeerShapes& shapes, const std::vector<MakePeer>& makers,
             int rounds) {
  const PeerPairs pairs = half_intersecting(shapes);
  std::vector<std::unique_ptr<Peer>> peers;
  peers.reserve(makers.size());
  for (const MakePeer make : makers)
    peers.push_back(make(shapes, pairs));
  std::vector<std::vector<double>> times(peers.size());
  std::vector<std::size_t> counts(peers.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < peers.size(); ++i)
      times[i].push_back(nanoseconds_per_query(*peers[i], counts[i]));
  fmt::print("{:<14}", name);
  for (std::vector<double>& own : times) {
    std::nth_element(own.begin(), own.begin() + rounds / 2, own.end());
    fmt::print(" {:>11.1f}", own[static_cast<std::size_t>(rounds) / 2]);
  }
  fmt::print("   {:>4.1f} %", 100.0 * static_cast<double>(counts[0]) / static_cast<double>(pairs_per_row));
  for (std::size_t i = 1; i < peers.size(); ++i)
    fmt::print(" {:>+4}", static_cast<long>(counts[i]) - static_cast<long>(counts[0]));
  fmt::print("\n");
}

}  // namespace

int main(int argument_count, char** arguments) {
  constexpr int usual_rounds = 51;
  const int rounds = argument_count > 1 ? std::stoi(arguments[1]) : usual_rounds;
  fmt::print("{:<14} {:>11} {:>11} {:>11} {:>11} {:>11}   intersecting, difference of the others\n", "ns",
             "fringe", "libccd MPR", "libccd GJK", "Bullet", "FCL");
  const std::vector<Row> all = rows();
  for (const Row& row : all)
    measure(row.name, row.shapes, {fringe_peer, libccd_mpr_peer, libccd_gjk_peer, bullet_peer, fcl_peer},
            rounds);
  fmt::print("\n{:<14} {:>11} {:>11}   boxes by their separating axes alone\n", "ns", "fringe", "FCL");
  measure("boxes", all.front().shapes, {fringe_box_peer, fcl_box_peer}, rounds);
}
