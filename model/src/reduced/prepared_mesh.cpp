#include "reduced/prepared_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include <Eigen/Eigenvalues>

#include "numeric/interruption.hpp"
#include "reduced/insulated_body.hpp"
#include "reduced/outside_charges.hpp"
#include "reduced/single_body_system.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Numbers of functions of the levels.
constexpr std::array<int, PreparedShape::levels> mesh_functions{16, 36, 72, 128};

RowVectorXd potentials_at(const Vector3d& point, const std::vector<OutsideCharge>& charges) {
  RowVectorXd potentials(static_cast<Index>(charges.size()));
  for (std::size_t k = 0; k < charges.size(); ++k)
    potentials[static_cast<Index>(k)] = charges[k].charge / (point - charges[k].point).norm();
  return potentials;
}

/// Computes the mean potentials on panels, by their quarters' centres.
MatrixXd potentials_on(const std::vector<Panel>& panels, const std::vector<OutsideCharge>& charges) {
  MatrixXd potentials = MatrixXd::Zero(static_cast<Index>(panels.size()), static_cast<Index>(charges.size()));
  for (std::size_t k = 0; k < panels.size(); ++k) {
    check_interruption();
    for (const auto& [a, b, c] : quarters(panels[k].corners))
      potentials.row(static_cast<Index>(k)) += potentials_at((a + b + c) / 3, charges) / 4;
  }
  return potentials;
}

/// Computes the combinations of a constant and of other potentials (rows) to which a body's responses are
/// orthonormal in the energy: first the constant, if it has an energy, then the principal ones of the others.
/// For a body that answers nothing, as one of the medium's permittivity, it is one that is zero.
/// @param own the energy of the response to the constant
/// @param common what each of the others has of the constant
/// @param others the energies of the rest of these
/// @param least_energy least eigenvalue, relative to the largest: smaller ones are rounding noise or less
/// than the panels' errors
MatrixXd principal_loads(double own, const RowVectorXd& common, const MatrixXd& others, Index most,
                         double least_energy) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(others);
  const Index sources = others.rows(), first = own > 0 ? 1 : 0;
  const double largest = solver.eigenvalues().tail(1)[0];
  Index count = first;
  while (count < std::min(most, sources + first) &&
         solver.eigenvalues()[sources - 1 - count + first] > least_energy * largest)
    ++count;
  MatrixXd loads = MatrixXd::Zero(sources + 1, std::max(count, Index{1}));
  if (own > 0)
    loads(0, 0) = 1 / std::sqrt(own);
  for (Index k = first; k < count; ++k) {
    const Index at = sources - 1 - k + first;
    loads.col(k).tail(sources) = solver.eigenvectors().col(at) / std::sqrt(solver.eigenvalues()[at]);
    loads(0, k) = -common.dot(loads.col(k).tail(sources));
  }
  return loads;
}

/// Computes them for panels of conductors and other potentials there (columns).
MatrixXd principal_loads(const SingleBodySystem& panels, const MatrixXd& potentials, Index most) {
  const VectorXd alone = panels.factor.solve_lower(VectorXd::Ones(potentials.rows()));
  const MatrixXd all = panels.factor.solve_lower(potentials);
  const RowVectorXd common = alone.transpose() * all / alone.squaredNorm();
  const MatrixXd others = all - alone * common;
  constexpr double least_energy = 1e-11;
  return principal_loads(alone.squaredNorm(), common, others.transpose() * others, most, least_energy);
}

/// Computes them by the energies of a constant (first) and of the other potentials.
MatrixXd principal_loads(const MatrixXd& energies, Index most) {
  const Index sources = energies.rows() - 1;
  const double own = energies(0, 0);
  RowVectorXd common = RowVectorXd::Zero(sources);
  if (own > 0)
    common = energies.row(0).tail(sources) / own;
  constexpr double least_energy = 1e-6;
  return principal_loads(own, common,
                         energies.bottomRightCorner(sources, sources) - own * common.transpose() * common,
                         most, least_energy);
}

/// Returns a symmetric matrix with its eigenvalues' magnitudes.
MatrixXd absolute(const MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(matrix);
  return solver.eigenvectors() * solver.eigenvalues().cwiseAbs().asDiagonal() *
         solver.eigenvectors().transpose();
}

std::vector<TriangleSurface> surfaces_of(const InsulatedBodies& bodies) {
  std::vector<TriangleSurface> surfaces;
  for (const ChargedBody& body : bodies.conductors.bodies)
    surfaces.push_back(std::get<TriangleSurface>(body.surface));
  for (const Insulator& insulator : bodies.insulators)
    surfaces.push_back({insulator.surface, insulator.round});
  return surfaces;
}

std::vector<Vector3d> corners_of(const std::vector<TriangleSurface>& surfaces) {
  std::vector<Vector3d> corners;
  for (const TriangleSurface& surface : surfaces)
    for (const Triangle& triangle : surface.triangles)
      corners.insert(corners.end(), triangle.begin(), triangle.end());
  return corners;
}

bool is_any_closed(const std::vector<TriangleSurface>& surfaces) {
  return std::any_of(surfaces.begin(), surfaces.end(),
                     [](const TriangleSurface& surface) { return is_closed(surface.triangles); });
}

/// Returns what the facets of round shapes may add to the energies of the panels' charges, between all
/// columns.
MatrixXd facet_effects(const std::vector<TriangleSurface>& surfaces, const PanelMesh& mesh,
                       const MatrixXd& charges) {
  MatrixXd result = MatrixXd::Zero(charges.cols(), charges.cols());
  for (const PanelGroup& group : mesh.groups()) {
    const std::optional<RoundShape>& round = surfaces[group.body].round;
    for (std::size_t k = group.first; round && k < group.first + group.count; ++k)
      result += round->lack_per_squared_charge(mesh.panels()[k]) *
                charges.row(static_cast<Index>(k)).transpose() * charges.row(static_cast<Index>(k));
  }
  return result;
}

}  // namespace

PreparedMesh::PreparedMesh(std::vector<TriangleSurface> surfaces, double accuracy)
    : surfaces_(std::move(surfaces)), is_closed_(is_any_closed(surfaces_)),
      box_(box_around(corners_of(surfaces_))) {
  const SingleBodySystem panels = solve_single_body(surfaces_, accuracy, most_mesh_panels);
  const std::vector<Panel>& all = panels.mesh.panels();
  const std::vector<OutsideCharge> charges = outside_charges(surfaces_, all);
  const MatrixXd outside = potentials_on(all, charges);
  const MatrixXd loads = principal_loads(panels, outside, mesh_functions.back());
  const auto of_charges = loads.bottomRows(outside.cols());
  MatrixXd potentials = outside * of_charges;
  potentials.rowwise() += loads.row(0);
  const MatrixXd responses = panels.factor.solve(potentials);
  missing_ = missing_energies(panels, potentials, responses, [&](const Vector3d& point) -> RowVectorXd {
    return potentials_at(point, charges) * of_charges + loads.row(0);
  });
  facets_ = facet_effects(surfaces_, panels.mesh, responses);
  root_ = responses.col(0).sum();
  if (surfaces_.size() > 1)
    net_ = net_charges(panels.mesh, responses, surfaces_.size());

  set_functions(all, responses);
}

PreparedMesh::PreparedMesh(const InsulatedBodies& bodies, double accuracy)
    : surfaces_(surfaces_of(bodies)), is_closed_(is_any_closed(surfaces_)),
      box_(box_around(corners_of(surfaces_))) {
  for (const Insulator& insulator : bodies.insulators)
    ratios_.push_back(insulator.ratio);
  const InsulatedBody solved =
      solve_insulated_body(bodies, accuracy, most_mesh_panels, [&](const std::vector<Panel>& panels) {
        return potentials_on(panels, outside_charges(surfaces_, panels));
      });
  const MatrixXd loads = principal_loads(solved.energies, mesh_functions.back());
  const MatrixXd responses = solved.responses * loads;
  missing_ = absolute(loads.transpose() * (solved.energies - solved.coarse_energies) * loads);
  facets_ = loads.transpose() * solved.facet_effects * loads;
  if (!bodies.conductors.bodies.empty())
    root_ = responses.col(0).sum();
  if (bodies.conductors.bodies.size() > 1)
    net_ = solved.free_charges * loads;
  set_functions(solved.panels, responses);
}

void PreparedMesh::set_functions(const std::vector<Panel>& panels, const MatrixXd& responses) {
  charged_.panels = cluster_panels(panels);
  const auto count = static_cast<std::size_t>(responses.cols());
  const std::vector<std::size_t>& panel_at = charged_.panels.panels;
  charged_.charges.assign((count + 1) * panel_at.size(), 0.0F);
  for (std::size_t function = 0; function < count; ++function)
    for (std::size_t place = 0; place < panel_at.size(); ++place)
      if (!charged_.panels.is_repeated[place])
        charged_.charges[function * panel_at.size() + place] =
            static_cast<float>(responses(static_cast<Index>(panel_at[place]), static_cast<Index>(function)));
}

const ChargeSkeleton* PreparedMesh::skeleton(double distance, std::ptrdiff_t functions, double error) const {
  const auto beyond = static_cast<std::size_t>(
      std::upper_bound(skeleton_distances.begin(), skeleton_distances.end(), distance) -
      skeleton_distances.begin());
  if (beyond == 0)
    return nullptr;
  const auto coarser = static_cast<std::size_t>(
      std::upper_bound(skeleton_accuracies.begin(), skeleton_accuracies.end(), error) -
      skeleton_accuracies.begin());
  if (coarser == 0)
    return nullptr;
  const double of = skeleton_distances[beyond - 1], to = skeleton_accuracies[coarser - 1];
  const auto [at, is_new] = skeletons_.try_emplace({functions, of, to});
  if (is_new)
    at->second = charge_skeleton(charged_, functions, surfaces_, of, to);
  return at->second ? &*at->second : nullptr;
}

Vector3d PreparedMesh::point(std::ptrdiff_t place) const {
  const auto at = static_cast<std::size_t>(place);
  const auto& points = charged_.panels.points[0];
  return {points[0][at], points[1][at], points[2][at]};
}

PreparedLevel PreparedMesh::level(int index) const {
  const Index count = std::min(Index{mesh_functions[static_cast<std::size_t>(index)]}, missing_.rows());
  VectorXd first = VectorXd::Zero(count);
  first[0] = 1;
  PreparedLevel level{};
  level.count = count;
  level.padded = whole_blocks(count);
  level.inverse = stored(MatrixXd::Identity(count, count));
  level.net = stored(root_ * first);
  level.equilibrium = stored(first);
  level.potential = stored(first);
  level.root = root_;
  // The last third of the functions tells whether more are needed.
  const Index kept = count - count / 3;
  for (Index k = kept; k < count; ++k)
    level.highest.push_back(static_cast<int>(k));
  level.stiffness = stored(MatrixXd::Identity(count - kept, count - kept));
  level.missing = stored(missing_.topLeftCorner(count, count));
  if (!facets_.isZero(0))
    level.facets = stored(facets_.topLeftCorner(count, count));
  for (Index surface = 0; surface < net_.rows(); ++surface)
    level.surface_nets.push_back(stored(net_.row(surface).head(count).transpose()));
  return level;
}

}  // namespace fringe::detail
