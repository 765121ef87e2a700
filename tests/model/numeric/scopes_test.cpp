/// The scopes of a thread that end its computations or show how far these are, and values computed once.

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/interruption.hpp"
#include "fringe/progress.hpp"
#include "numeric/interruption.hpp"
#include "numeric/lazy_array.hpp"
#include "numeric/progress.hpp"
#include "numeric/time_limit.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

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
