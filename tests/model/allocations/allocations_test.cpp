#include <atomic>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/pose.hpp"
#include "reduced/surrounded.hpp"

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

Eigen::Isometry3d at(double x, double y, double z) {
  return pose_from_axis({0, 0, 1}, 0, {x, y, z});
}

/// A sensor on a link before a housing, and a hand.
Scene machine(const ElectricalRole& role) {
  Scene scene;
  scene.links = {{"head", std::nullopt, at(0, 0, 0)}, {"hand", std::nullopt, at(0, 0, 0.1)}};
  Sensor sensor;
  sensor.name = "sensor";
  sensor.link = 0;
  sensor.plates = {{{-0.03, -0.04, 0}, {0.06, 0, 0}, {0, 0.08, 0}}};
  scene.sensors = {sensor};
  scene.objects = {{"housing", std::nullopt, Cuboid{0.2, 0.12, 0.05}, at(0, 0, -0.03), Grounded{}, true},
                   {"hand", 1, Cuboid{0.05, 0.09, 0.02}, at(0, 0, 0), role, true}};
  scene.objects.back().target = true;
  return scene;
}

Eigen::Isometry3d hand_pose(int number) {
  return pose_from_axis({1, 2, 3}, 10.0 * number, {0.01 * number, 0, 0.12 - 0.015 * number});
}

/// Evaluates poses of all links until they are known; then no memory is to be allocated.
void expect_none_in_known_poses(test::Surrounded& live,
                                const std::vector<std::vector<Eigen::Isometry3d>>& poses) {
  constexpr double rtol = 0.2;
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

class Allocations : public testing::TestWithParam<ElectricalRole> {};

TEST_P(Allocations, ReadingsBeforeAMachineHaveNoneAfterThePosesThatItKnows) {
  if (!FRINGE_COUNTS_ALLOCATIONS)
    GTEST_SKIP() << "memory is allocated by another library";
  test::Surrounded live(machine(GetParam()));
  std::vector<std::vector<Eigen::Isometry3d>> poses;
  for (int k = 0; k < 5; ++k)
    poses.push_back({Eigen::Isometry3d::Identity(), hand_pose(k)});
  expect_none_in_known_poses(live, poses);
}

TEST_P(Allocations, ReadingsBeforeAMachineHaveNoneOnLinksThatMove) {
  if (!FRINGE_COUNTS_ALLOCATIONS)
    GTEST_SKIP() << "memory is allocated by another library";
  test::Surrounded live(machine(GetParam()));
  std::vector<std::vector<Eigen::Isometry3d>> poses;
  for (int k = 0; k < 5; ++k)
    poses.push_back({pose_from_axis({0, 1, 0}, 2.0 * k, {0, 0, 0.004}), hand_pose(k)});
  expect_none_in_known_poses(live, poses);
}

INSTANTIATE_TEST_SUITE_P(GroundedAndFloating, Allocations,
                         testing::Values(ElectricalRole(Grounded{}), ElectricalRole(Floating{})));

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
