#include "bem/adaptive.hpp"
#include "bem/proximity_refinement.hpp"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "bem/jacobi_basis.hpp"

/// Tests the loop of all boundary elements with a problem that counts what is asked of it, and which panels
/// are marked for refinement. Tests which bodies induce a charge on a face or a triangle that is too narrow
/// for its elements to resolve.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::Assessment;
using detail::PanelGroup;
using testing::ElementsAre;
using testing::IsEmpty;

/// Returns groups of quartered triangles. Refining one adds four panels.
std::vector<PanelGroup> quartered_groups(std::size_t count) {
  std::vector<PanelGroup> groups;
  for (std::size_t k = 0; k < count; ++k)
    groups.push_back({4 * k, 4, 0, true});
  return groups;
}

/// Groups of panels whose assessment stays the same.
class CountingProblem : public detail::AdaptiveProblem {
 public:
  CountingProblem(std::vector<PanelGroup> groups, Assessment assessment, int solutions, int refinements)
      : groups_(std::move(groups)), assessment_(std::move(assessment)), solutions_(solutions),
        refinements_(refinements) {}

  /// Three triangles, of which the second misses most energy.
  CountingProblem(int solutions, int refinements, std::size_t most_added = 100)
      : CountingProblem(quartered_groups(3), {false, Eigen::Vector3d(1e-6, 1, 1e-6), 0.5, most_added, 1},
                        solutions, refinements) {}

  const std::vector<PanelGroup>& groups() const override { return groups_; }
  Assessment solve() override {
    assessment_.is_last = ++solved == solutions_;
    return assessment_;
  }
  bool refine(const std::vector<int>& steps) override {
    marked.push_back(steps);
    return static_cast<int>(marked.size()) <= refinements_;
  }

  int solved = 0;
  std::vector<std::vector<int>> marked;

 private:
  std::vector<PanelGroup> groups_;
  Assessment assessment_;
  int solutions_, refinements_;
};

/// Returns the steps in which the loop refines each group after its first solution.
std::vector<int> marked(const std::vector<PanelGroup>& groups, const Eigen::VectorXd& energies,
                        double allowed, std::size_t most_added, int most_steps = 1) {
  CountingProblem problem(groups, {false, energies, allowed, most_added, most_steps}, 2, 1);
  solve_adaptively(problem);
  return problem.marked.front();
}

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
  CountingProblem problem(2, 10, 0);
  solve_adaptively(problem);
  EXPECT_THAT(problem.marked, ElementsAre(IsEmpty()));
}

using detail::ChargedBody;
using detail::ChargedFace;
using detail::EdgeKind;
using detail::InducedCharge;
using Eigen::Vector3d;

constexpr std::size_t plenty = 1000;

TEST(SolveAdaptively, TakesNoMoreGroupsThanTheErrorRequiresOrTheNumberOfPanelsAllows) {
  const auto marked_of_four = [](const Eigen::Vector4d& energies, double allowed,
                                 std::size_t most_added = plenty) {
    return marked(quartered_groups(4), energies, allowed, most_added);
  };
  EXPECT_THAT(marked_of_four({1, 8, 2, 1}, 0), ElementsAre(0, 1, 1, 0)) << "the greater part of the energy";
  EXPECT_THAT(marked_of_four({1, 8, 2, 1}, 0, 7), ElementsAre(0, 1, 0, 0));
  EXPECT_THAT(marked_of_four({1, 8, 2, 1}, 0, 3), IsEmpty());
  // Refinement leaves 3.2 of the 8, hence 7.2 of 12 in all. The others are not worth it.
  EXPECT_THAT(marked_of_four({1e-3, 8, 4, 1e-3}, 7.3), ElementsAre(0, 1, 1, 0));
  EXPECT_THAT(marked_of_four({1e-3, 8, 4, 1e-3}, 0), ElementsAre(0, 1, 1, 0));
  // Four tenths of the panels are added where that is worth it, though the second group alone would do.
  EXPECT_THAT(marked_of_four({2, 8, 1, 1}, 7.3), ElementsAre(1, 1, 0, 0));
  EXPECT_THAT(marked_of_four({3, 1, 2.999, 3}, 8), ElementsAre(1, 0, 1, 1)) << "groups of equal energy";
}

TEST(SolveAdaptively, RepeatsStepsWhereTheChargeIsConcentrated) {
  // Of 1000 the first step leaves 400, 200 for each half, and the second 160, 40 for each quarter.
  const Eigen::Vector4d energies(1000, 50, 1, 1);
  EXPECT_THAT(marked(quartered_groups(4), energies, 200, plenty, 3), ElementsAre(2, 1, 0, 0));
  EXPECT_THAT(marked(quartered_groups(4), energies, 200, plenty), ElementsAre(1, 1, 0, 0));
}

TEST(SolveAdaptively, CountsThePanelsOfRepeatedSteps) {
  // Steps of a quartered triangle add 4, 8 and 16 panels.
  const Eigen::Vector4d energies(1000, 1e-9, 1e-9, 1e-9);
  EXPECT_THAT(marked(quartered_groups(4), energies, 0, 28, 3), ElementsAre(3, 0, 0, 0));
  EXPECT_THAT(marked(quartered_groups(4), energies, 0, 27, 3), ElementsAre(2, 0, 0, 0));
}

TEST(PanelGrowth, AddsAsManyPanelsAsTheErrorCallsFor) {
  constexpr std::size_t panels = 100'000;
  detail::PanelGrowth growth;
  growth.measure(1000, panels);
  EXPECT_EQ(growth.most_added(panels), panels / 4) << "where the error falls with them is not known yet";
  EXPECT_EQ(growth.most_added(100), 1000U) << "few cost nothing";
  // The error falls with the square of their number.
  growth.measure(1.28, 2 * panels / 3);
  growth.measure(1.28 * 4 / 9, panels);
  EXPECT_NEAR(static_cast<double>(growth.most_added(panels)), 0.1 * panels, 1) << "it is nearly small enough";
  growth.measure(1.28, 3 * panels / 2);
  EXPECT_NEAR(static_cast<double>(growth.most_added(panels)), (std::pow(1.6, 1 / 1.7) - 1) * panels, 1)
      << "it grew";
}

TEST(SolveAdaptively, QuartersTrianglesOfGroupsBeforeItHalvesThem) {
  // Three triangles are quartered by nine panels more, and halved by twelve more.
  const std::vector<PanelGroup> groups{{0, 3, 0, false}, {3, 4, 0, true}};
  EXPECT_THAT(marked(groups, Eigen::Vector2d(100, 1e-6), 0, 21, 2), ElementsAre(2, 0));
  EXPECT_THAT(marked(groups, Eigen::Vector2d(100, 1e-6), 0, 20, 2), ElementsAre(1, 0));
}

constexpr double large = 1;  ///< half a side, metres
constexpr double seen =
    large / (detail::most_functions / 2.0);  ///< width of the narrowest charge that a face so large resolves
constexpr double close = seen / 100;

/// Returns a face in the plane z = height, turned about the z axis.
ChargedFace face(double half_u, double half_v, double height, double turn = 0) {
  const Eigen::AngleAxisd turned(turn, Vector3d::UnitZ());
  return {{0, 0, height}, turned * Vector3d::UnitX(), turned * Vector3d::UnitY(), half_u, half_v,
          EdgeKind::thin};
}

InducedCharge charge_induced_by(const ChargedFace& plate) {
  return InducedCharge(ChargedBody{0, 0, detail::FlatPlate{plate}, "plate", {}});
}

/// Returns the charge induced by the same plate as a body of two triangles.
InducedCharge charge_induced_by_triangles(const ChargedFace& plate) {
  const auto [a, b, c, d] = detail::corners_of(plate);
  return InducedCharge(ChargedBody{0, 0, detail::TriangleSurface{{{a, b, c}, {a, c, d}}}, "mesh", {}});
}

TEST(InducedCharge, OfASmallPlateIsNarrowOnAFaceUntilTheGapIsWide) {
  const ChargedFace wall = face(large, large, 0);
  for (const auto induced_by : {charge_induced_by, charge_induced_by_triangles}) {
    EXPECT_TRUE(induced_by(face(0.5 * seen, 0.4 * seen, close)).is_narrow_on(wall));
    EXPECT_TRUE(induced_by(face(0.5 * seen, 0.4 * seen, 0.4 * seen)).is_narrow_on(wall));
    EXPECT_FALSE(induced_by(face(0.5 * seen, 0.4 * seen, 0.6 * seen)).is_narrow_on(wall));
    EXPECT_FALSE(induced_by(face(1.2 * seen, 1.1 * seen, close)).is_narrow_on(wall));
  }
}

TEST(InducedCharge, OfAStripIsAsNarrowAsTheStripHoweverItIsTurned) {
  const ChargedFace wall = face(large, large, 0);
  for (const double turn : {0.0, 0.6, 1.57}) {
    EXPECT_TRUE(charge_induced_by(face(0.5 * large, 0.1 * seen, close, turn)).is_narrow_on(wall)) << turn;
    EXPECT_TRUE(charge_induced_by_triangles(face(0.5 * large, 0.1 * seen, close, turn)).is_narrow_on(wall))
        << turn;
  }
}

TEST(InducedCharge, OfAStripIsNotNarrowOnAStripBesideIt) {
  // Along the strips the induced charge is as long as they are, across them as wide.
  EXPECT_FALSE(charge_induced_by(face(large, 0.1 * seen, close)).is_narrow_on(face(large, 0.1 * seen, 0)));
  EXPECT_FALSE(
      charge_induced_by_triangles(face(large, 0.1 * seen, close)).is_narrow_on(face(large, 0.1 * seen, 0)));
  // Crossed strips induce narrow charges on each other.
  EXPECT_TRUE(charge_induced_by(face(0.1 * seen, large, close)).is_narrow_on(face(large, 0.1 * seen, 0)));
}

TEST(InducedCharge, OfAnUprightPlateIsAsWideAsItIsHigh) {
  const auto upright = [](double half_height) {
    return ChargedFace{{0, 0, half_height + close},
                       Vector3d::UnitX(),
                       Vector3d::UnitZ(),
                       large,
                       half_height,
                       EdgeKind::thin};
  };
  EXPECT_TRUE(charge_induced_by(upright(0.5 * seen)).is_narrow_on(face(large, large, 0)));
  EXPECT_FALSE(charge_induced_by(upright(1.1 * seen)).is_narrow_on(face(large, large, 0)));
}

TEST(InducedCharge, OnATriangleIsNarrowWhenHalfTheTrianglesRadiusIsMore) {
  // The distance of the centre from the corners: two thirds of the height.
  constexpr double radius = 1;
  const Triangle triangle{Vector3d{radius, 0, 0}, Vector3d{-radius / 2, std::sqrt(3) / 2 * radius, 0},
                          Vector3d{-radius / 2, -std::sqrt(3) / 2 * radius, 0}};
  for (const auto induced_by : {charge_induced_by, charge_induced_by_triangles}) {
    EXPECT_TRUE(induced_by(face(0.3, 0.1, 0.3)).is_narrow_on(triangle));
    EXPECT_FALSE(induced_by(face(0.3, 0.1, 0.45)).is_narrow_on(triangle));
    EXPECT_FALSE(induced_by(face(0.3, 0.1, 5)).is_narrow_on(triangle));
    EXPECT_FALSE(induced_by(face(0.6, 0.55, close)).is_narrow_on(triangle));
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
