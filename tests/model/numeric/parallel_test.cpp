/// Tests that work shared by threads is all done, that an interruption or an error ends it, and that none is
/// lost.

#include "numeric/parallel.hpp"

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/interruption.hpp"
#include "numeric/interruption.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::parallel_for;

TEST(ParallelFor, CallsEveryTaskOnce) {
  for (const std::size_t threads : {0U, 1U, 2U})
    for (const std::size_t count : {0U, 1U, 3U, 1000U}) {
      std::vector<std::atomic<int>> calls(count);
      parallel_for(count, threads, [&](std::size_t k) { ++calls[k]; });
      for (const std::atomic<int>& number : calls)
        EXPECT_EQ(number, 1);
    }
}

TEST(ParallelFor, ThrowsWhatATaskThrows) {
  for (const std::size_t threads : {1U, 2U})
    EXPECT_THROW(parallel_for(100, threads,
                              [](std::size_t k) {
                                if (k == 7)
                                  throw std::domain_error("seven");
                              }),
                 std::domain_error);
}

TEST(ParallelFor, EndsWhenTheCallingThreadIsInterrupted) {
  std::atomic<int> calls = 0;
  const InterruptionScope scope([&] { return calls > 10; });
  EXPECT_THROW(parallel_for(1'000'000, 2, [&](std::size_t) { ++calls; }), Interrupted);
  EXPECT_LT(calls, 1'000'000);
}

TEST(ParallelFor, EndsTheTasksOfOtherThreadsWhenTheCallingOneIsInterrupted) {
  if (std::thread::hardware_concurrency() < 2)
    GTEST_SKIP() << "one processor";
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<bool> is_other_busy = false;
  // Once another thread is at work, the calling one has nothing to do but to wait for it.
  const InterruptionScope scope([&] { return is_other_busy.load(); });
  EXPECT_THROW(parallel_for(2, 2,
                            [&](std::size_t) {
                              while (std::this_thread::get_id() == caller && !is_other_busy)
                                std::this_thread::yield();
                              while (std::this_thread::get_id() != caller) {
                                is_other_busy = true;
                                detail::check_interruption();
                              }
                            }),
               Interrupted);
}

TEST(ParallelFor, AsksTheScopesAroundTheInnermostOne) {
  const InterruptionScope outer([] { return true; });
  const InterruptionScope inner([] { return false; });
  EXPECT_THROW(detail::check_interruption(), Interrupted);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
