#include "numeric/parallel.hpp"

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/interruption.hpp"
#include "fringe/progress.hpp"
#include "numeric/interruption.hpp"
#include "numeric/progress.hpp"

/// Tests that work shared by threads is all done, that an interruption or an error ends it, and that none
/// is lost. The scopes of a thread that end its computations or show how far these are, and values computed
/// once.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

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
                                check_interruption();
                              }
                            }),
               Interrupted);
}

TEST(Scopes, OfInterruptionCountAllOnTheirOwnThread) {
  EXPECT_NO_THROW(check_interruption());
  {
    const InterruptionScope outer([] { return false; });
    const InterruptionScope inner([] { return true; });
    EXPECT_THROW(check_interruption(), Interrupted);
  }
  const InterruptionScope outer([] { return true; });
  EXPECT_THROW(check_interruption(), Interrupted);
  {
    const InterruptionScope inner([] { return false; });
    EXPECT_THROW(check_interruption(), Interrupted);
  }
  std::jthread([] { EXPECT_NO_THROW(check_interruption()); }).join();
  const InterruptionScope throwing([]() -> bool { throw std::logic_error("mine"); });
  EXPECT_THROW(check_interruption(), std::logic_error);
}

TEST(Scopes, OfTimeEndWhatTakesLonger) {
  {
    const TimeLimit none(0);
    EXPECT_TRUE(none.is_over());
    EXPECT_THROW(check_interruption(), Interrupted);
    // A longer limit inside does not prolong the one outside.
    const TimeLimit longer(1e9);
    EXPECT_FALSE(longer.is_over());
    EXPECT_THROW(check_interruption(), Interrupted);
  }
  const TimeLimit years(1e9);
  EXPECT_GT(years.seconds_left(), 1e8);
  EXPECT_NO_THROW(check_interruption());
}

TEST(Scopes, OfProgressShowWhichPartIsWorkedOn) {
  std::vector<std::string> shown;
  show_progress("no one sees this");
  {
    const ProgressScope scope([&](const std::string& line) { shown.push_back(line); });
    const ProgressPart outer("machine");
    show_progress("1 of 2");
    {
      const ProgressPart inner("target");
      show_progress("2 of 2");
    }
    show_progress("done");
  }
  show_progress("nor this");
  ASSERT_EQ(shown.size(), 3U);
  EXPECT_EQ(shown[0], "machine: 1 of 2");
  EXPECT_NE(shown[1].find("target: 2 of 2"), std::string::npos) << shown[1];
  EXPECT_EQ(shown[2], "machine: done");
}

TEST(Scopes, ALazyArrayComputesEveryValueOnce) {
  LazyArray<std::string, 3> array;
  std::atomic<int> made = 0;
  const auto ask = [&] {
    for (const std::size_t index : {2U, 0U, 2U})
      EXPECT_EQ(array.at(index,
                         [&] {
                           ++made;
                           return std::to_string(index);
                         }),
                std::to_string(index));
  };
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 4; ++thread)
    threads.emplace_back(ask);
  threads.clear();
  EXPECT_EQ(made, 2);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
