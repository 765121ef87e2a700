/// Tests what one density on each group of panels can hold.

#include "bem/group_densities.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "bem/single_layer_panels.hpp"
#include "fringe/triangulation.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::PanelGroup;
using detail::PanelMesh;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns a mesh of a ball of panels in groups of about four, and a box of quartered triangles.
PanelMesh ball_and_box() {
  PanelMesh mesh;
  mesh.add(0, triangulate(Sphere{0.02, 24}));
  std::vector<Triangle> box = triangulate(Cuboid{0.03, 0.02, 0.01});
  for (Triangle& triangle : box)
    for (Eigen::Vector3d& corner : triangle)
      corner.z() += 0.05;
  mesh.add(1, box);
  return mesh;
}

/// Returns the panels' charges (rows) if one group (column) has unit charge.
MatrixXd charges_of_groups(const PanelMesh& mesh) {
  MatrixXd charges =
      MatrixXd::Zero(static_cast<Index>(mesh.panels().size()), static_cast<Index>(mesh.groups().size()));
  for (std::size_t g = 0; g < mesh.groups().size(); ++g) {
    const PanelGroup& group = mesh.groups()[g];
    double area = 0;
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      area += mesh.panels()[k].area;
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      charges(static_cast<Index>(k), static_cast<Index>(g)) = mesh.panels()[k].area / area;
  }
  return charges;
}

TEST(GroupDensities, SpreadAChargeEvenlyOverTheGroup) {
  const PanelMesh mesh = ball_and_box();
  const MatrixXd charges = charges_of_groups(mesh);
  const VectorXd shares = detail::area_shares(mesh);
  EXPECT_LT((charges.rowwise().sum() - shares).cwiseAbs().maxCoeff(), 1e-15);
  const MatrixXd values = MatrixXd::Random(charges.rows(), 3);
  EXPECT_LT((detail::group_means(mesh, shares, values) - charges.transpose() * values).norm(), 1e-13);
}

TEST(GroupDensities, InteractAsTheirPanelsDoTogether) {
  const PanelMesh mesh = ball_and_box();
  const MatrixXd panels = detail::single_layer_matrix(mesh.panels(), 1e-3);
  const MatrixXd charges = charges_of_groups(mesh);
  const MatrixXd wanted = charges.transpose() * (panels.selfadjointView<Eigen::Upper>() * charges);
  const MatrixXd found = detail::group_matrix(mesh, detail::area_shares(mesh), panels);
  EXPECT_LT((found - wanted).triangularView<Eigen::Lower>().toDenseMatrix().norm(), 1e-13 * wanted.norm());
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
