/// Charges of two groups of bodies that move against each other: their potentials on each other, and the
/// forces, against Coulomb's law and differences.

#include "reduced/link_couplings.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "bem/conductors_at_rest.hpp"
#include "fringe/pose.hpp"
#include "geometry.hpp"
#include "geometry/link_motion.hpp"
#include "reduced/charge_functions.hpp"
#include "scenes.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::Vector3d;

ChargeFunctions functions_of(const Shape& shape, std::size_t most) {
  Scene scene;
  scene.objects = {test::object("body", shape, test::at(0, 0, 0))};
  const ConductorsAtRest conductors(charged_bodies(scene), 0.1, 600, 2 * most);
  return {conductors, conductors.charges(),
          [](const ChargeFunctions::Part& part) { return part.box.diagonal().norm(); }, most};
}

class LinkCouplings : public testing::Test {
 protected:
  MatrixXf couple(const Isometry3d& relative) {
    MatrixXf result;
    coupler.couple(box, plate, relative, result);
    return result;
  }

  const ChargeFunctions box = functions_of(Cuboid{0.05, 0.08, 0.03}, 24),
                        plate = functions_of(Plate{0.1, 0.06}, 16);
  const Isometry3d pose = pose_from_axis({1, 2, 3}, 40, {0.03, 0.02, 0.15});
  LinkCoupler coupler;
};

// Functions have unit charge; all of them together carry the charge of the body at unit potential.
TEST_F(LinkCouplings, FunctionsAreChargesOnTheirBodies) {
  for (const ChargeFunctions* functions : {&box, &plate}) {
    const MatrixXd& energies = functions->energies();
    EXPECT_LT((energies - energies.transpose()).norm(), 1e-12 * energies.norm());
    EXPECT_EQ(energies.llt().info(), Eigen::Success);
    EXPECT_TRUE((functions->net(1).array() - 1).abs().maxCoeff() < 1e-12);
    for (std::size_t level = 0; level < ChargeFunctions::points_per_function.size(); ++level) {
      const FunctionPoints& points = functions->points(level);
      for (std::size_t function = 0; function < functions->count(); ++function) {
        double sum = 0;
        for (std::size_t k = points.first[function]; k < points.first[function + 1]; ++k) {
          sum += points.shares[k];
          EXPECT_LE((points.at[k].cast<double>() - functions->centre(function)).norm(),
                    functions->radius(function) * (1 + 1e-5));
        }
        EXPECT_NEAR(sum, 1, 1e-5);
      }
      // The given charges are those of the body at 1 V, whose total is its capacitance.
      EXPECT_NEAR(points.given.sum(), functions->panels().given.sum(), 1e-4 * points.given.sum());
    }
  }
}

TEST_F(LinkCouplings, AreThoseOfPointChargesFarAway) {
  const MatrixXf found = couple(test::at(3, 4, 0));
  ASSERT_EQ(found.rows(), static_cast<Index>(plate.count()));
  ASSERT_EQ(found.cols(), static_cast<Index>(box.count()));
  for (Index of_plate = 0; of_plate < found.rows(); ++of_plate)
    for (Index of_box = 0; of_box < found.cols(); ++of_box) {
      const auto on_box = static_cast<std::size_t>(of_box), on_plate = static_cast<std::size_t>(of_plate);
      const double distance = (Vector3d(3, 4, 0) + box.centre(on_box) - plate.centre(on_plate)).norm();
      // The charges are within the radii of the centres.
      EXPECT_NEAR(found(of_plate, of_box) * distance, 1,
                  (box.radius(on_box) + plate.radius(on_plate)) / distance);
    }
}

TEST_F(LinkCouplings, AreTheSameBothWays) {
  const MatrixXf found = couple(pose);
  MatrixXf other;
  coupler.couple(plate, box, pose.inverse(), other);
  EXPECT_LT((found - other.transpose()).cwiseAbs().maxCoeff(), 2e-3 * found.maxCoeff());
  EXPECT_TRUE(are_equal(pose, pose));
  EXPECT_FALSE(are_equal(pose, test::at(0, 0, 1e-6) * pose));
}

// The points of a group are the finer the nearer the other group is.
TEST_F(LinkCouplings, TakeMorePointsForWhatIsNear) {
  std::size_t before = ChargeFunctions::points_per_function.size() - 1;
  for (const double height : {0.001, 0.05, 0.2, 10.0}) {
    const std::size_t level = plate.level(0, test::at(0, 0, height), box.boxes());
    EXPECT_LE(level, before);
    before = level;
  }
  EXPECT_EQ(before, 0U);
}

TEST_F(LinkCouplings, HaveForcesThatAreTheDerivativesOfTheirPotentials) {
  const auto fields = static_cast<Index>(plate.count());
  Forces forces;
  coupler.find_forces(box, plate, pose, MatrixXf::Identity(fields, fields), forces);
  ASSERT_EQ(forces.rows(), 6 * static_cast<Index>(box.count()));
  // Much longer than the jumps between levels of points need.
  constexpr double step = 5e-3;
  for (int coordinate = 0; coordinate < 6; ++coordinate) {
    const Vector3d axis = Vector3d::Unit(coordinate % 3);
    MatrixXd difference = MatrixXd::Zero(fields, static_cast<Index>(box.count()));
    for (const double sign : {1.0, -1.0}) {
      const Isometry3d moved = coordinate < 3 ? Isometry3d(Eigen::Translation3d(sign * step * axis)) * pose
                                              : Isometry3d(Eigen::AngleAxisd(sign * step, axis)) * pose;
      difference += sign * couple(moved).cast<double>() / (2 * step);
    }
    MatrixXd found(fields, static_cast<Index>(box.count()));
    for (Index function = 0; function < found.cols(); ++function)
      found.col(function) = forces.row(6 * function + coordinate).transpose();
    // Forces may count for or against the potential, but for all in the same way.
    EXPECT_LT(std::min((found - difference).norm(), (found + difference).norm()), 0.01 * difference.norm())
        << coordinate;
  }
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
