#include "reduced/single_body_system.hpp"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "bem/adaptive.hpp"
#include "bem/error_indicators.hpp"
#include "bem/group_densities.hpp"
#include "bem/single_layer_panels.hpp"
#include "fringe/error.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Ratio of the matrix elements' quadrature tolerance to the accuracy of the energies: the elements are much
/// more accurate.
constexpr double tolerance_per_accuracy = 0.2;

/// Returns the energies of the charges in the coarse space, which has one density on each group.
MatrixXd coarse_energies(const SingleBodySystem& panels, const VectorXd& shares, const MatrixXd& potentials) {
  const MatrixXd reached = Cholesky(group_matrix(panels.mesh, shares, panels.matrix))
                               .solve_lower(group_means(panels.mesh, shares, potentials));
  return reached.transpose() * reached;
}

/// Factorises the matrix. Returns false if it is not positive definite, or only by errors of its elements.
bool factorise_as_it_is(SingleBodySystem& panels) {
  /// Least energy that a panel adds to earlier ones, relative to its own: of a panel between others it is
  /// about the ratio of the gap to the panel. Less means that panels coincide.
  constexpr double least_energy = 1e-6;
  panels.factor = Cholesky(panels.matrix.transpose());
  return panels.factor.is_positive_definite() &&
         (panels.factor.factor().diagonal().array().square() >
          std::max(least_energy, panels.tolerance) * panels.matrix.diagonal().array())
             .all();
}

/// Adds a ridge to the matrix and factorises it. Coincident panels then share their charge, and errors of the
/// potentials on them cause no large opposite charges. Energies change by a few per cent of the ridge: the
/// part that panels have in them by themselves. Returns false if the matrix still is not positive definite,
/// and takes the ridge back.
bool factorise_with_ridge(SingleBodySystem& panels, double ridge) {
  panels.ridge = ridge;
  panels.matrix.diagonal() *= 1 + panels.ridge;
  panels.factor = Cholesky(panels.matrix.transpose());
  if (panels.factor.is_positive_definite())
    return true;
  panels.matrix.diagonal() /= 1 + panels.ridge;
  panels.ridge = 0;
  return false;
}

/// Factorises the matrix; refines the quadrature if it is not positive definite, and adds a ridge if finer
/// quadratures do not help.
void factorise(SingleBodySystem& panels, double ridge) {
  /// Tolerance of the quadratures above which a matrix that is not positive definite calls for better ones.
  constexpr double sufficient = 1e-5;
  /// Finest relative tolerance of the quadratures. Below it, rounding errors dominate the matrix elements.
  constexpr double finest_tolerance = 1e-13;
  while (!factorise_as_it_is(panels)) {
    if (panels.tolerance <= sufficient && factorise_with_ridge(panels, ridge))
      return;
    if (panels.tolerance < finest_tolerance)
      throw InputError("its triangles overlap");
    panels.tolerance /= 100;
    panels.matrix = single_layer_matrix(panels.mesh.panels(), panels.tolerance);
  }
}

/// The charges that potentials of degree 0 and 1 induce on a body.
class SingleBodyProblem : public AdaptiveProblem {
 public:
  SingleBodyProblem(std::span<const TriangleSurface> surfaces, double accuracy, std::size_t most_panels)
      : accuracy_(accuracy), most_panels_(most_panels) {
    panels_.tolerance = tolerance_per_accuracy * accuracy;
    panels_.mesh = panels_of(surfaces);
    panels_.matrix = single_layer_matrix(panels_.mesh.panels(), panels_.tolerance);
  }

  const std::vector<PanelGroup>& groups() const override { return panels_.mesh.groups(); }

  Assessment solve() override {
    factorise(panels_, accuracy_);
    const MatrixXd potentials = plain_potentials(panels_.mesh);
    responses_ = panels_.factor.solve(potentials);
    const VectorXd energies = potentials.cwiseProduct(responses_).colwise().sum();
    const VectorXd shares = area_shares(panels_.mesh);
    const VectorXd change = energies - coarse_energies(panels_, shares, potentials).diagonal();
    const VectorXd own = counted_energies(energies);
    const double error = error_per_panel_change * (change.array() / own.array()).maxCoeff();
    const std::size_t count = panels_.mesh.panels().size();
    Assessment found{error <= accuracy_, {}, 0, most_panels_ - std::min(most_panels_, count)};
    if (found.is_last)
      return found;
    found.indicators = largest_parts(
        detail_energies(panels_.mesh, group_blocks(panels_.mesh, panels_.matrix), shares, responses_), own);
    found.allowed = found.indicators.sum() * accuracy_ / error;
    return found;
  }

  bool refine(const std::vector<int>& steps) override {
    if (steps.empty())
      return false;
    MatrixXd before = std::move(panels_.matrix);
    before.diagonal() /= 1 + std::exchange(panels_.ridge, 0);
    panels_.mesh.refine(steps, responses_);
    panels_.matrix = single_layer_matrix(panels_.mesh.panels(), panels_.tolerance,
                                         {before, panels_.mesh.places_before()}, 1);
    return true;
  }

  SingleBodySystem take_system() { return std::move(panels_); }

 private:
  double accuracy_;
  std::size_t most_panels_;
  SingleBodySystem panels_;
  MatrixXd responses_;
};

}  // namespace

PanelMesh panels_of(std::span<const TriangleSurface> surfaces) {
  ChargedBodies bodies{{{"", Role::grounded, {}}}, {}};
  for (const TriangleSurface& surface : surfaces)
    bodies.bodies.push_back({0, bodies.bodies.size(), surface, "", {}});
  PanelMesh mesh(std::make_shared<const HiddenSurface>(bodies));
  for (std::size_t k = 0; k < surfaces.size(); ++k)
    mesh.add(k, surfaces[k].triangles);
  return mesh;
}

MatrixXd plain_potentials(const PanelMesh& mesh) {
  MatrixXd potentials(index_of(mesh.panels().size()), 4);
  for (std::size_t k = 0; k < mesh.panels().size(); ++k)
    potentials.row(index_of(k)) << 1, mesh.panels()[k].centre.transpose();
  return potentials;
}

VectorXd counted_energies(VectorXd energies) {
  constexpr double least_response = 0.1;
  energies.tail(3) = energies.tail(3).cwiseMax(least_response * energies.tail(3).maxCoeff());
  return energies;
}

MatrixXd net_charges(const PanelMesh& mesh, const MatrixXd& charges, std::size_t bodies) {
  MatrixXd net = MatrixXd::Zero(index_of(bodies), charges.cols());
  for (const PanelGroup& group : mesh.groups())
    if (group.body < bodies)
      net.row(index_of(group.body)) +=
          charges.middleRows(index_of(group.first), index_of(group.count)).colwise().sum();
  return net;
}

SingleBodySystem solve_single_body(std::span<const TriangleSurface> surfaces, double accuracy,
                                   std::size_t most_panels) {
  SingleBodyProblem problem(surfaces, accuracy, most_panels);
  solve_adaptively(problem);
  return problem.take_system();
}

MatrixXd missing_energies(const SingleBodySystem& panels, const MatrixXd& potentials,
                          const MatrixXd& responses, const std::function<RowVectorXd(const Vector3d&)>& at) {
  const MatrixXd reached = potentials.transpose() * responses;
  MatrixXd missing = reached - coarse_energies(panels, area_shares(panels.mesh), potentials);
  const SampledQuarters sampled = sampled_quarters(panels.mesh);
  if (!sampled.panels.empty()) {
    MatrixXd missing_potentials =
        panel_potentials(sampled.panels, panels.mesh.panels(), -responses, panels.tolerance, 1);
    for (std::size_t k = 0; k < sampled.panels.size(); ++k)
      missing_potentials.row(index_of(k)) += at(sampled.panels[k].centre);
    missing += energy_of_quarters(sampled, missing_potentials, panels.tolerance);
  }
  missing += panels.ridge / (1 + panels.ridge) *
             (responses.transpose() * panels.matrix.diagonal().asDiagonal() * responses);
  return (missing + missing.transpose()) / 2;
}

}  // namespace fringe::detail
