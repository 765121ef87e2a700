#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/pose.hpp"
#include "reduced/surrounded.hpp"
#include "scenes.hpp"

/// Memory that is allocated while something moves.

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FRINGE_COUNTS_ALLOCATIONS 1
#else
#define FRINGE_COUNTS_ALLOCATIONS 0
#endif
#ifdef __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#undef FRINGE_COUNTS_ALLOCATIONS
#define FRINGE_COUNTS_ALLOCATIONS 0
#endif
#endif

namespace {
std::atomic<std::size_t> allocations = 0;
}  // namespace

#if FRINGE_COUNTS_ALLOCATIONS
// Sanitizers have a malloc of their own. Those of the C library do the work; Eigen calls malloc, and so do
// the operators new.
// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp,readability-inconsistent-declaration-parameter-name)
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
}
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp,readability-inconsistent-declaration-parameter-name)
#endif

namespace fringe::FRINGE_TEST_FILE {
namespace {

/// A sensor on a link before a housing, and a hand.
Scene machine(const ElectricalRole& role) {
  Scene scene = test::hand_before_housing(0.09);
  scene.links.push_back({"head", {}, test::at(0, 0, 0)});
  scene.sensors[0].link = 1;
  scene.objects[1].role = role;
  return scene;
}

/// Evaluates poses of all links until they are known; then no memory is to be allocated.
void expect_none_in_known_poses(test::Surrounded& live,
                                const std::vector<std::vector<Eigen::Isometry3d>>& poses) {
  constexpr double rtol = 0.5;
  live.answers(rtol);
  std::vector<double> first(poses.size());
  // Where the hand comes nearer than before it is prepared again, also for the other poses.
  for (int round = 0; round < 2; ++round)
    for (std::size_t k = 0; k < poses.size(); ++k) {
      live.set_poses(poses[k]);
      first[k] = live.answers(rtol)[0].change.value.value();
    }
  for (std::size_t k = 0; k < poses.size(); ++k) {
    live.set_poses(poses[k]);
    const std::size_t before = allocations;
    const std::vector<ReadingAnswer>& answers = live.answers(rtol);
    EXPECT_EQ(allocations - before, 0U) << "pose " << k;
    EXPECT_NEAR(answers[0].change.value.value(), first[k], 1e-3 * first[k]);
  }
}

TEST(Allocations, ReadingsBeforeAMachineHaveNoneInPosesThatItKnowsAlsoOfItsLinks) {
  if (!FRINGE_COUNTS_ALLOCATIONS)
    GTEST_SKIP() << "memory is allocated by another library";
  for (const auto& [role, turn] :
       {std::pair(ElectricalRole(Floating{}), 0.0), std::pair(ElectricalRole(Grounded{}), 2.0)}) {
    test::Surrounded live(machine(role));
    std::vector<std::vector<Eigen::Isometry3d>> poses;
    for (int k = 0; k < 3; ++k)
      poses.push_back({pose_from_axis({1, 2, 3}, 10.0 * k, {0.01 * k, 0, 0.12 - 0.03 * k}),
                       turn == 0 ? test::at(0, 0, 0) : pose_from_axis({0, 1, 0}, turn * k, {0, 0, 0.004})});
    expect_none_in_known_poses(live, poses);
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
