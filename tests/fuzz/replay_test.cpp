#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fuzz_targets.hpp"

namespace fringe::fuzz {
namespace {

using Target = void (*)(Bytes);
using Content = std::vector<std::uint8_t>;

struct Named {
  const char* name;
  Target target;
  std::size_t mutations;
};

/// Lets lists of tests show a target by its name.
void PrintTo(const Named& target, std::ostream* out) {
  *out << target.name;
}

/// Runs a target on every seed and on the given number of random mutations; a violated property aborts the
/// process. tests/fuzz/run continues from the seeds with the real fuzzers.
class Fuzz : public testing::TestWithParam<Named> {};

std::vector<Content> seeds(const std::string& name) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(FRINGE_FUZZ_SEEDS) / name))
    paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<Content> contents;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    contents.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return contents;
}

/// Mutates the content: sets, removes or inserts bytes, or repeats a stretch of them.
Content mutated(Content content, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return end == 0 ? 0 : random() % end; };
  for (std::size_t change = 0; change <= below(6); ++change) {
    const auto at = content.begin() + static_cast<std::ptrdiff_t>(below(content.size() + 1));
    switch (below(4)) {
    case 0:
      if (at != content.end())
        *at = static_cast<std::uint8_t>(random());
      break;
    case 1:
      content.erase(
          at, at + std::min<std::ptrdiff_t>(content.end() - at, 1 + static_cast<std::ptrdiff_t>(below(8))));
      break;
    case 2:
      content.insert(at, static_cast<std::uint8_t>(random()));
      break;
    default: {
      const Content stretch(at, at + std::min<std::ptrdiff_t>(content.end() - at, 16));
      content.insert(content.begin() + static_cast<std::ptrdiff_t>(below(content.size() + 1)),
                     stretch.begin(), stretch.end());
    }
    }
  }
  return content;
}

TEST_P(Fuzz, HoldsForTheSeedsAndForThousandsOfTheirMutations) {
  const std::vector<Content> contents = seeds(GetParam().name);
  ASSERT_FALSE(contents.empty());
  for (const Content& content : contents)
    GetParam().target(content);
  std::mt19937 random(1);
  for (std::size_t i = 0; i < GetParam().mutations; ++i)
    GetParam().target(mutated(contents[i % contents.size()], random));
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz,
                         testing::Values(Named{"scene_reader", scene_reader, 3000},
                                         Named{"mesh_reader", mesh_reader, 20'000},
                                         Named{"plate_integral", plate_integral, 20'000},
                                         Named{"gjk_intersects", gjk_intersects, 300},
                                         Named{"cone_closest", cone_closest, 3000}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace fringe::fuzz
