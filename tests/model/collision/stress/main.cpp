#include <array>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <limits>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "collision/convex_pair.hpp"
#include "collision/convex_shape_data.hpp"
#include "collision/gjk_filter.hpp"
#include "collision/shape_pairs.hpp"
#include "fringe/convex_shape.hpp"
#include "fringe/gjk.hpp"
#include "fringe/thesis.hpp"
#include "simd/dispatch.hpp"

/// The stress program of collision queries: compares random pairs of every class, in units of length from
/// 2^−150 to 2^150, with linear programming in integers. It tests every query function and checks every
/// certificate.
namespace fringe::test {
namespace {

using Eigen::Isometry3d;

struct Tally {
  std::size_t pairs = 0;
  std::size_t intersecting = 0;
  std::size_t wrong = 0;     ///< wrong answers of any query function
  std::size_t unproven = 0;  ///< certificates that do not prove the answer
  std::size_t close = 0;     ///< pairs that the filter left to exact arithmetic
  std::size_t thesis_wrong = 0;
  std::size_t thesis_endless = 0;
};

/// Returns a pair of a class in a random unit of length.
ShapePair in_some_unit(const PairClass& pair_class, Random& random) {
  const ShapePair pair = pair_class.make(random);
  constexpr std::size_t largest_exponent = 150;
  const int exponent = below(random, 2) == 0 ? 0
                                             : static_cast<int>(below(random, 2 * largest_exponent + 1)) -
                                                   static_cast<int>(largest_exponent);
  return placed(pair, std::ldexp(1.0, exponent), Eigen::Vector3d::Zero());
}

bool is_right(const GjkDistance& found, double truth) {
  constexpr double promised = detail::DistanceAnswer::most_doubt;
  return std::abs(found.distance - truth) <= promised * truth && found.lower_bound <= truth &&
         found.distance - found.lower_bound <= promised * found.distance;
}

/// Counts wrong distances, by the whole query and by what floating point alone says with every instruction
/// set.
void count_distances(const ConvexShape& a, const ConvexShape& b, double truth, Tally& tally) {
  const Isometry3d here = Isometry3d::Identity();
  tally.wrong += is_right(gjk_distance(a, here, b, here), truth) ? 0U : 1U;
  const detail::PlacedShape placed_a{&a.data().support, here.data()},
      placed_b{&b.data().support, here.data()};
  for (const detail::InstructionSet set : detail::available_instruction_sets()) {
    const detail::GjkFilter& filter = detail::kernels<detail::GjkFilter>(set);
    detail::DistanceAnswer answer;
    filter.approach(placed_a, placed_b, answer);
    if (answer.end == detail::DistanceEnd::open)
      filter.refine(placed_a, placed_b, answer);
    if (answer.end == detail::DistanceEnd::intersecting)
      tally.wrong += truth == 0 ? 0U : 1U;
    else if (answer.end == detail::DistanceEnd::converged)
      tally.wrong += is_right({answer.length, answer.lower_bound, {}, {}, {}, false}, truth) ? 0U : 1U;
  }
}

void count_hulls(const ShapePair& pair, bool truth, Tally& tally) {
  const ConvexShape a = ConvexShape::hull(pair.a), b = ConvexShape::hull(pair.b);
  const Isometry3d here = Isometry3d::Identity();
  const GjkAnswer answer = gjk_intersects(a, here, b, here);
  tally.wrong += answer.intersects != truth || intersect(a, here, b, here) != truth ? 1U : 0U;
  tally.unproven += proves(answer, a, here, b, here) ? 0U : 1U;
  count_distances(a, b, gjk_distance(pair.a, pair.b).distance, tally);
  for (const detail::InstructionSet set : detail::available_instruction_sets()) {
    const detail::GjkFilter& filter = detail::kernels<detail::GjkFilter>(set);
    const detail::Verdict verdict =
        filter.decide({&a.data().support, here.data()}, {&b.data().support, here.data()});
    if (verdict == detail::Verdict::undecided)
      tally.close += &filter == &detail::best_kernels<detail::GjkFilter>() ? 1U : 0U;
    else
      tally.wrong += (verdict == detail::Verdict::intersecting) != truth ? 1U : 0U;
  }
}

/// Counts wrong distances of hulls of vertices, by the whole query and by what twice the precision is certain
/// of with every instruction set.
void count_hull_distances(const ShapePair& pair, Tally& tally) {
  const detail::PassingHulls hulls(pair.a, pair.b);
  const double truth = exact_distance(pair.a, pair.b).distance;
  const auto count = [&](double distance) {
    constexpr double three_units = 3 * std::numeric_limits<double>::epsilon();
    tally.wrong += std::abs(distance - truth) <= three_units * truth ? 0U : 1U;
  };
  count(gjk_distance(pair.a, pair.b).distance);
  for (const detail::InstructionSet set : detail::available_instruction_sets()) {
    detail::HullDistance found;
    detail::kernels<detail::GjkFilter>(set).hull_distance(hulls.a().given(), hulls.b().given(), found);
    if (found.is_certain)
      count(found.distance);
  }
}

/// Counts failures for posed hulls. Their vertices are not representable in doubles, so linear programming
/// cannot check the answer, but its certificate can.
void count_moved_hulls(const ShapePair& pair, Random& random, Tally& tally) {
  const ConvexShape a = ConvexShape::hull(pair.a), b = ConvexShape::hull(pair.b);
  const Isometry3d pose_a = random.rigid_motion(), pose_b = random.rigid_motion();
  const GjkAnswer answer = gjk_intersects(a, pose_a, b, pose_b);
  tally.wrong += intersect(a, pose_a, b, pose_b) != answer.intersects ? 1U : 0U;
  tally.unproven += proves(answer, a, pose_a, b, pose_b) ? 0U : 1U;
}

Tally run(const PairClass& pair_class, std::size_t pairs, std::uint64_t seed) {
  Random random(seed);
  Tally tally;
  for (; tally.pairs < pairs; ++tally.pairs) {
    const ShapePair pair = in_some_unit(pair_class, random);
    const bool truth = hulls_intersect(pair.a, pair.b);
    const GjkAnswer answer = gjk_intersects(pair.a, pair.b);
    tally.intersecting += truth ? 1U : 0U;
    tally.wrong += answer.intersects != truth || gjk_intersects(pair.b, pair.a).intersects != truth ? 1U : 0U;
    tally.unproven += proves(answer, pair.a, pair.b) ? 0U : 1U;
    count_hulls(pair, truth, tally);
    // One pair in ten is tested with rotations and by its exact distance, because rational and exact
    // arithmetic are slow.
    constexpr std::size_t share_of_slow = 10;
    if (tally.pairs % share_of_slow == 0) {
      count_moved_hulls(pair, random, tally);
      count_hull_distances(pair, tally);
    }
    const std::optional<bool> thesis = thesis_gjk_intersects(pair.a, pair.b, 200);
    tally.thesis_endless += thesis ? 0U : 1U;
    tally.thesis_wrong += thesis && *thesis != truth ? 1U : 0U;
  }
  return tally;
}

/// The counts under the names that the report knows, and how wide they are printed.
struct Column {
  const char* name;
  int width;
  std::size_t Tally::*count;
};

constexpr std::array<Column, 7> columns{{{"pairs", 9, &Tally::pairs},
                                         {"intersecting", 12, &Tally::intersecting},
                                         {"wrong", 6, &Tally::wrong},
                                         {"unproven", 9, &Tally::unproven},
                                         {"exact", 9, &Tally::close},
                                         {"thesis_wrong", 12, &Tally::thesis_wrong},
                                         {"thesis_endless", 14, &Tally::thesis_endless}}};

int run_all(std::size_t count, std::uint64_t seed, const std::string& json) {
  nlohmann::ordered_json classes = nlohmann::ordered_json::array();
  fmt::print("{:<20}", "class");
  for (const Column& column : columns)
    fmt::print(" {:>{}}", column.name, column.width);
  std::size_t failures = 0;
  for (const PairClass& pair_class : pair_classes()) {
    const Tally tally = run(pair_class, count / pair_classes().size(), seed++);
    fmt::print("\n{:<20}", pair_class.name);
    nlohmann::ordered_json entry{{"name", pair_class.name}};
    for (const Column& column : columns) {
      fmt::print(" {:>{}}", tally.*column.count, column.width);
      entry[column.name] = tally.*column.count;
    }
    std::fflush(stdout);
    classes.push_back(entry);
    failures += tally.wrong + tally.unproven;
  }
  fmt::print("\n");
  if (!json.empty())
    std::ofstream(json) << nlohmann::ordered_json{{"classes", classes}}.dump(4) << '\n';
  return failures == 0 ? 0 : 1;
}

}  // namespace
}  // namespace fringe::test

int main(int argument_count, char** arguments) {
  CLI::App program("Random pairs of convex shapes against exact arithmetic");
  std::size_t count = 1'000'000;
  std::uint64_t seed = 1;
  std::string json;
  program.add_option("--count", count, "How many pairs, all classes together")->capture_default_str();
  program.add_option("--seed", seed)->capture_default_str();
  program.add_option("--json", json, "A file for the counts");
  CLI11_PARSE(program, argument_count, arguments);
  try {
    return fringe::test::run_all(count, seed, json);
  } catch (const std::exception& error) {
    fmt::print(stderr, "collision_stress: {}\n", error.what());
    return 1;
  }
}
