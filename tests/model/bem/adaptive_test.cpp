/// Tests the loop of all boundary elements with a problem that counts what is asked of it.

#include "bem/adaptive.hpp"

#include <vector>

#include <gmock/gmock.h>

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::Assessment;
using detail::PanelGroup;
using testing::ElementsAre;
using testing::IsEmpty;

/// Three triangles, of which the second misses most energy.
class CountingProblem : public detail::AdaptiveProblem {
 public:
  CountingProblem(int solutions, int refinements) : solutions_(solutions), refinements_(refinements) {}

  const std::vector<PanelGroup>& groups() const override { return groups_; }
  Assessment solve() override {
    ++solved;
    return {solved == solutions_, Eigen::Vector3d(1e-6, 1, 1e-6), 0.5, most_added, 1};
  }
  bool refine(const std::vector<int>& steps) override {
    marked.push_back(steps);
    return static_cast<int>(marked.size()) <= refinements_;
  }

  int solved = 0;
  std::size_t most_added = 100;
  std::vector<std::vector<int>> marked;

 private:
  std::vector<PanelGroup> groups_{{0, 4, 0, true}, {4, 4, 0, true}, {8, 4, 0, true}};
  int solutions_, refinements_;
};

TEST(SolveAdaptively, RefinesWhereEnergyIsMissingUntilTheLastSolution) {
  CountingProblem problem(3, 10);
  solve_adaptively(problem);
  EXPECT_EQ(problem.solved, 3);
  EXPECT_THAT(problem.marked, ElementsAre(ElementsAre(0, 1, 0), ElementsAre(0, 1, 0)));
}

TEST(SolveAdaptively, EndsWhereNothingIsLeftToRefine) {
  CountingProblem problem(10, 1);
  solve_adaptively(problem);
  EXPECT_EQ(problem.solved, 2);
  EXPECT_EQ(problem.marked.size(), 2U);
}

TEST(SolveAdaptively, AsksForRefinementWithoutMarksWhereNoPanelsMayBeAdded) {
  CountingProblem problem(2, 10);
  problem.most_added = 0;
  solve_adaptively(problem);
  EXPECT_THAT(problem.marked, ElementsAre(IsEmpty()));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
