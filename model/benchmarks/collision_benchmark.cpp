#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "peers/peer.hpp"
#include "processor_time.hpp"
#include "random.hpp"

/// Measures the nanoseconds of processor time per boolean query of two convex shapes, in comparison with FCL,
/// libccd and Bullet: the median of many rounds in which the libraries take turns. No query uses the result
/// of an earlier one. The distance of their centres is chosen so that half of the pairs intersect; the last
/// columns are the differences of the numbers of intersecting pairs from fringe's.
///
/// Pairs of cuboids whose faces touch have rows of their own, and so has the shortest distance, of prepared
/// shapes and of vertices.
///
///     collision_benchmark [ROUNDS [FILE.json]]
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
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5})
        for (const double z : {-0.5, 0.5})
          made[0].shapes.back().vertices.push_back(
              made[0].shapes.back().size.cwiseProduct(Vector3d(x, y, z)));
    // A has an even index, B an odd one.
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

/// Makes pairs in random poses at random distances up to `farthest`.
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

/// Makes pairs at distances for which half of them intersect.
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
  const double seconds = seconds_of([&] { count = peer.count_intersecting(); });
  return 1e9 * seconds / static_cast<double>(pairs_per_row);
}

using MakePeer = std::unique_ptr<Peer> (*)(const PeerShapes&, const PeerPairs&);

struct RowTimes {
  std::string name;
  std::vector<std::string> peers;
  std::vector<double> nanoseconds;  ///< medians
  std::vector<std::size_t> intersecting;
};

RowTimes measure(const std::string& name, const PeerShapes& shapes, const PeerPairs& pairs,
                 const std::vector<MakePeer>& makers, int rounds) {
  std::vector<std::unique_ptr<Peer>> peers;
  peers.reserve(makers.size());
  for (const MakePeer make : makers)
    peers.push_back(make(shapes, pairs));
  std::vector<std::vector<double>> times(peers.size());
  RowTimes row{name, {}, {}, std::vector<std::size_t>(peers.size())};
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < peers.size(); ++i)
      times[i].push_back(nanoseconds_per_query(*peers[i], row.intersecting[i]));
  fmt::print("{:<18}", name);
  for (std::size_t i = 0; i < peers.size(); ++i) {
    std::vector<double>& own = times[i];
    std::nth_element(own.begin(), own.begin() + rounds / 2, own.end());
    row.peers.push_back(peers[i]->name());
    row.nanoseconds.push_back(own[static_cast<std::size_t>(rounds) / 2]);
    fmt::print(" {:>11.1f}", row.nanoseconds.back());
  }
  const std::vector<std::size_t>& counts = row.intersecting;
  fmt::print("   {:>5.1f} %", 100.0 * static_cast<double>(counts[0]) / static_cast<double>(pairs_per_row));
  for (std::size_t i = 1; i < peers.size(); ++i)
    fmt::print(" {:>+5}", static_cast<long>(counts[i]) - static_cast<long>(counts[0]));
  fmt::print("\n");
  return row;
}

/// Makes cuboids with sides that are multiples of 1/8. Pairs of them touch with their faces: exactly, or,
/// when turned together, up to the rounding of their poses.
PeerShapes touching_cuboids() {
  Random random;
  PeerShapes shapes;
  const auto side = [&] { return static_cast<double>(4 + random.below(13)) / 8; };
  for (std::size_t i = 0; i < shapes_per_row; ++i) {
    const double x = side(), y = side();
    shapes.push_back({PeerShape::Kind::cuboid, {x, y, side()}});
  }
  return shapes;
}

PeerPairs touching_pairs(const PeerShapes& shapes, bool turned) {
  Random random;
  PeerPairs pairs;
  for (std::size_t i = 0; i < pairs_per_row; ++i) {
    PeerPair pair{2 * random.below(shapes_per_row / 2), 2 * random.below(shapes_per_row / 2) + 1,
                  Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()};
    pair.pose_b.translation() = Vector3d((shapes[pair.a].size.x() + shapes[pair.b].size.x()) / 2, 0.125, 0);
    if (turned) {
      pair.pose_a = random.turn();
      pair.pose_b = pair.pose_a * pair.pose_b;
    }
    pairs.push_back(pair);
  }
  return pairs;
}

/// Writes the rows for the report as JSON.
std::string json_of(const std::vector<RowTimes>& rows) {
  std::string text = "{\"rows\": [";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RowTimes& row = rows[i];
    text += fmt::format("{}\n  {{\"name\": \"{}\", \"pairs\": {}, \"peers\": [", i == 0 ? "" : ",", row.name,
                        pairs_per_row);
    for (std::size_t k = 0; k < row.peers.size(); ++k)
      text += fmt::format("{}{{\"name\": \"{}\", \"nanoseconds\": {}, \"intersecting\": {}}}",
                          k == 0 ? "" : ", ", row.peers[k], row.nanoseconds[k], row.intersecting[k]);
    text += "]}";
  }
  return text + "\n]}\n";
}

}  // namespace

int main(int argument_count, char** arguments) {
  constexpr int usual_rounds = 51;
  const int rounds = argument_count > 1 ? std::stoi(arguments[1]) : usual_rounds;
  const std::vector<MakePeer> everybody{fringe_peer, libccd_mpr_peer, libccd_gjk_peer, bullet_peer, fcl_peer};
  fmt::print("{:<18} {:>11} {:>11} {:>11} {:>11} {:>11}   intersecting, difference of the others\n", "ns",
             "fringe", "libccd MPR", "libccd GJK", "Bullet", "FCL");
  std::vector<RowTimes> measured;
  const std::vector<Row> all = rows();
  for (const Row& row : all)
    measured.push_back(measure(row.name, row.shapes, half_intersecting(row.shapes), everybody, rounds));
  const PeerShapes cuboids = touching_cuboids();
  // Pairs that floating point leaves undecided are solved in integers, which takes a thousand times as long.
  const int few_rounds = 1 + rounds / 10;
  measured.push_back(measure("faces touch", cuboids, touching_pairs(cuboids, false), everybody, few_rounds));
  measured.push_back(
      measure("faces touch, turned", cuboids, touching_pairs(cuboids, true), everybody, few_rounds));
  fmt::print("\n{:<18} {:>11} {:>11}   boxes by their separating axes alone\n", "ns", "fringe", "FCL");
  const PeerShapes& boxes = all.front().shapes;
  measured.push_back(
      measure("boxes", boxes, half_intersecting(boxes), {fringe_box_peer, fcl_box_peer}, rounds));
  fmt::print("\n{:<18} {:>11}   distances, fringe alone\n", "ns", "fringe");
  for (const Row& row : all)
    measured.push_back(measure("distance, " + row.name, row.shapes, half_intersecting(row.shapes),
                               {fringe_distance_peer}, few_rounds));
  for (const Row& row : all)
    if (!row.shapes.front().vertices.empty())
      measured.push_back(measure("unprepared, " + row.name, row.shapes, half_intersecting(row.shapes),
                                 {fringe_vertex_distance_peer}, few_rounds));
  if (argument_count > 2)
    std::ofstream(arguments[2]) << json_of(measured);
}
