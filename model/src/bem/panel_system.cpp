#include "bem/panel_system.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <utility>

#include "bem/conjugate_gradients.hpp"
#include "bem/error_indicators.hpp"
#include "bem/maxwell_matrix.hpp"
#include "bem/panel_equations.hpp"
#include "bem/proximity_refinement.hpp"
#include "bem/readings.hpp"
#include "bem/single_layer_panels.hpp"
#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Ratio of the panels' quadrature tolerance to the faces'. The panels' quadratures are much better than
/// their tolerance: between a plate and a cube at a fifth of its size, at any of four levels, they changed no
/// capacitance by more than a fiftieth of it.
constexpr double panel_tolerances = 10;

/// Stands for a matrix that has to be evaluated.
constexpr double unknown_tolerance = std::numeric_limits<double>::infinity();

ChargedBodies with_faces(const ChargedBodies& bodies) {
  ChargedBodies result = bodies;
  std::erase_if(result.bodies, [](const ChargedBody& body) {
    return std::holds_alternative<TriangleSurface>(body.surface);
  });
  return result;
}

/// Returns the sensors alone, as grounded conductors: there is nothing else to measure beside them.
ChargedBodies sensors_of(const ChargedBodies& bodies) {
  ChargedBodies sensors;
  for (const ChargedConductor& conductor : bodies.conductors)
    if (conductor.role == Role::sensor)
      sensors.conductors.push_back({conductor.name, Role::grounded, conductor.members});
  std::copy_if(bodies.bodies.begin(), bodies.bodies.end(), std::back_inserter(sensors.bodies),
               [&](const ChargedBody& body) { return bodies.role(body) == Role::sensor; });
  return sensors;
}

}  // namespace

PanelSystem::PanelSystem(const ChargedBodies& bodies, const PanelGrading& grading)
    : bodies_(bodies), bodies_of_faces_(with_faces(bodies)), faces_(bodies_of_faces_),
      mesh_(std::make_shared<const HiddenSurface>(bodies)), panel_tolerance_(unknown_tolerance),
      coupling_tolerance_(unknown_tolerance) {
  for (std::size_t body = 0; body < bodies.bodies.size(); ++body)
    if (const auto* surface = std::get_if<TriangleSurface>(&bodies.bodies[body].surface))
      mesh_.add(body, surface->triangles, grading);
  refine_by_proximity(grading.most_panels);
}

PanelSystem::PanelSystem(const ChargedBodies& bodies, PanelMesh mesh)
    : bodies_(bodies), bodies_of_faces_(with_faces(bodies)), faces_(bodies_of_faces_), mesh_(std::move(mesh)),
      panel_tolerance_(unknown_tolerance), coupling_tolerance_(unknown_tolerance) {}

void PanelSystem::refine_by_proximity(std::size_t most_panels) {
  if (mesh_.panels().empty())
    return;
  const std::vector<InducedCharge> charges = induced_charges(bodies_);
  const auto is_too_large = [&](const PanelGroup& group) {
    const std::vector<Triangle> triangles = mesh_.triangles(group);
    for (std::size_t body = 0; body < charges.size(); ++body)
      if (body != group.body)
        for (const Triangle& triangle : triangles)
          if (charges[body].is_narrow_on(triangle))
            return true;
    return false;
  };
  while (mesh_.panels().size() < most_panels) {
    std::vector<bool> marked;
    for (const PanelGroup& group : mesh_.groups()) {
      check_interruption();
      marked.push_back(is_too_large(group));
    }
    if (std::find(marked.begin(), marked.end(), true) == marked.end())
      break;
    // With equal charges, triangles are halved across their longest sides.
    mesh_.refine(marked, MatrixXd::Ones(index_of(mesh_.panels().size()), 1));
  }
}

void PanelSystem::refine_groups(const std::vector<bool>& marked, const MatrixXd& charges) {
  // After two refinements without a matrix between them, the places are not those of the matrix.
  if (is_refined_)
    panel_tolerance_ = unknown_tolerance;
  mesh_.refine(marked, charges);
  is_refined_ = true;
  coupling_tolerance_ = unknown_tolerance;
}

void PanelSystem::refine(const std::vector<FaceFunctions>& functions, double tolerance) {
  faces_.refine(functions, tolerance);
  if (mesh_.panels().empty())
    return;
  if (panel_tolerance_ > panel_tolerances * tolerance) {
    panel_tolerance_ = panel_tolerances * tolerance;
    panels_ = single_layer_matrix(mesh_.panels(), panel_tolerance_);
  } else if (is_refined_) {
    const MatrixXd before = std::move(panels_);
    panels_ = single_layer_matrix(mesh_.panels(), panel_tolerance_, {before, mesh_.places_before()});
  }
  is_refined_ = false;
  if (coupling_tolerance_ > tolerance || coupled_functions_ != functions)
    refine_coupling(functions, tolerance);
}

void PanelSystem::refine_coupling(const std::vector<FaceFunctions>& functions, double tolerance) {
  Index rows = 0;
  for (const FaceFunctions& face : functions)
    rows += face.count();
  coupling_.resize(rows, index_of(mesh_.panels().size()));
  Index row = 0;
  for (std::size_t face = 0; face < functions.size(); ++face) {
    coupling_.middleRows(row, functions[face].count()) =
        single_layer_block(faces_.face(face), functions[face], mesh_.panels(), tolerance);
    row += functions[face].count();
  }
  coupled_functions_ = functions;
  coupling_tolerance_ = tolerance;
}

MatrixXd PanelSystem::face_matrix(const PanelUnknowns& unknowns) const {
  MatrixXd matrix(unknowns.functions, unknowns.functions);
  for (std::size_t a = 0; a < faces(); ++a)
    for (std::size_t b = a; b < faces(); ++b) {
      const MatrixXd& block = faces_.block(a, b);
      matrix.block(unknowns.first[a], unknowns.first[b], block.rows(), block.cols()) = block;
      matrix.block(unknowns.first[b], unknowns.first[a], block.cols(), block.rows()) = block.transpose();
    }
  return matrix;
}

/// Returns the charge on each body (rows) from the charges of all unknowns.
MatrixXd PanelSystem::body_charges(const PanelUnknowns& unknowns, const MatrixXd& charges) const {
  MatrixXd result = MatrixXd::Zero(index_of(bodies_.bodies.size()), charges.cols());
  std::size_t face = 0;
  for (std::size_t body = 0; body < bodies_.bodies.size(); ++body)
    for (std::size_t k = 0; k < faces_of(bodies_.bodies[body].surface).size(); ++k, ++face)
      result.row(index_of(body)) += faces_.net_charge(face) * charges.row(unknowns.first[face]);
  for (const PanelGroup& group : mesh_.groups())
    result.row(index_of(group.body)) +=
        charges.middleRows(unknowns.functions + index_of(group.first), index_of(group.count)).colwise().sum();
  return result;
}

std::vector<MatrixXd> PanelSystem::charges_of_faces(const PanelUnknowns& unknowns,
                                                    const MatrixXd& charges) const {
  std::vector<MatrixXd> of_faces;
  if (charges.size() == 0)
    return of_faces;
  for (std::size_t face = 0; face < faces(); ++face)
    of_faces.emplace_back(charges.middleRows(unknowns.first[face], faces_.functions(face).count()));
  return of_faces;
}

/// Returns the possible change of the capacitances for quadrature errors of all blocks, relative to their
/// tolerances. `charges` are those of all unknowns.
MatrixXd PanelSystem::quadrature_effect(const PanelUnknowns& unknowns, const MatrixXd& charges) const {
  const MatrixXd norms = norms_of_faces(charges_of_faces(unknowns, charges));
  const auto panels = index_of(mesh_.panels().size());
  const MatrixXd absolute = charges.bottomRows(panels).cwiseAbs();
  MatrixXd felt(panels, charges.cols());
  for (Index c = 0; c < charges.cols(); ++c)
    felt.col(c) = panels_.selfadjointView<Eigen::Upper>() * absolute.col(c);
  for (std::size_t face = 0; face < faces(); ++face) {
    const Eigen::RowVectorXd largest =
        coupling_.middleRows(unknowns.first[face], faces_.functions(face).count())
            .cwiseAbs()
            .colwise()
            .maxCoeff();
    felt += 2 * largest.transpose() * norms.row(index_of(face));
  }
  const MatrixXd effect = absolute.transpose() * felt;
  const MatrixXd of_panels = panel_tolerances / 4 * (effect + effect.transpose());
  return faces() == 0 ? of_panels : faces_.quadrature_effect(norms) + of_panels;
}

PanelSystem::Background PanelSystem::solve_without_targets(const PanelEquations& equations,
                                                           double accuracy) const {
  Background result;
  const auto is_machine = [&](const ChargedBody& body) {
    return !body.is_target && bodies_.role(body) != Role::sensor;
  };
  const Index conductors = index_of(bodies_.conductors.size());
  const bool has_sensors = count_of(bodies_, Role::sensor) > 0;
  if (std::none_of(bodies_.bodies.begin(), bodies_.bodies.end(), is_machine) && has_sensors &&
      !sensors_have_panels(bodies_)) {
    const GalerkinSystem::Alone alone = faces_.solve_sensors();
    result.positive_definite = alone.positive_definite;
    if (!alone.positive_definite)
      return result;
    result.matrix = alone.matrix;
    result.charges = MatrixXd::Zero(equations.unknowns.net.rows(), conductors);
    for (std::size_t face = 0; face < faces(); ++face)
      result.charges.middleRows(equations.unknowns.first[face], faces_.functions(face).count()) =
          alone.charges[face];
    result.iteration_error = MatrixXd::Zero(conductors, conductors);
    return result;
  }
  const PanelUnknowns unknowns = without_targets(equations.unknowns, bodies_, faces_, mesh_);
  const PanelEquations present{equations.face_system, equations.mesh,   unknowns,
                               equations.faces,       equations.panels, equations.coupling};
  const TwoLevelPreconditioner preconditioner(present, panel_tolerance_);
  result.positive_definite = preconditioner.is_positive_definite();
  if (!result.positive_definite)
    return result;
  ConjugateGradientSolution solved = solve_by_conjugate_gradients(present, preconditioner, accuracy);
  result.positive_definite = solved.positive_definite;
  if (result.positive_definite) {
    result.matrix = {solved.energies(unknowns.net), solved.energy_roots.transpose() * solved.energy_roots};
    result.iteration_error = solved.iteration_error();
    result.charges = std::move(solved.charges);
  }
  return result;
}

PanelSolution PanelSystem::solve(double accuracy) const {
  PanelSolution solution;
  if (mesh_.panels().empty()) {
    static_cast<GalerkinSolution&>(solution) = faces_.solve();
    const Index conductors = solution.all.fine.rows();
    solution.iteration_error = solution.background_iteration_error = MatrixXd::Zero(conductors, conductors);
    return solution;
  }
  const PanelUnknowns unknowns = number_unknowns(bodies_, faces_, mesh_);
  const MatrixXd matrix = face_matrix(unknowns);
  const PanelEquations equations{faces_, mesh_, unknowns, matrix, panels_, coupling_};
  const TwoLevelPreconditioner preconditioner(equations, panel_tolerance_);
  solution.positive_definite = preconditioner.is_positive_definite();
  if (count_of(bodies_, Role::sensor) > 0 && !sensors_have_panels(bodies_)) {
    const GalerkinSystem::Alone alone = faces_.solve_sensors();
    solution.sensors = alone.matrix;
    solution.positive_definite &= alone.positive_definite;
  }
  if (!solution.positive_definite)
    return solution;
  const ConjugateGradientSolution solved = solve_by_conjugate_gradients(equations, preconditioner, accuracy);
  solution.positive_definite = solved.positive_definite;
  if (!solution.positive_definite)
    return solution;

  solution.all = {solved.energies(unknowns.net), solved.energy_roots.transpose() * solved.energy_roots};
  solution.iteration_error = solved.iteration_error();
  solution.charges = solved.charges.bottomRows(index_of(mesh_.panels().size()));
  solution.body_charges = body_charges(unknowns, solved.charges);
  const VectorXd own = asked_energies(solution.all.fine, bodies_);
  MatrixXd reading_charges, background_charges;
  VectorXd scales;
  if (!bodies_.readings.empty()) {
    Background background = solve_without_targets(equations, accuracy);
    solution.positive_definite = background.positive_definite;
    if (!solution.positive_definite)
      return solution;
    solution.background = background.matrix;
    solution.background_iteration_error = background.iteration_error;
    reading_charges = detail::reading_charges(solved.charges, solution.all.fine, background.charges,
                                              background.matrix.fine, bodies_)
                          .all();
    solution.reading_charges = reading_charges.bottomRows(index_of(mesh_.panels().size()));
    solution.reading_quadrature_effect = quadrature_effect(unknowns, reading_charges);
    solution.reading_details =
        detail_energies(mesh_, panels_, preconditioner.shares(), solution.reading_charges);
    if (faces() > 0)
      solution.reading_details += faces_.detail_energies(charges_of_faces(unknowns, reading_charges));
    scales = change_scales(solution.all, solution.background, bodies_);
    background_charges = std::move(background.charges);
  }
  solution.highest = faces_.highest_energies(
      {charges_of_faces(unknowns, solved.charges), charges_of_faces(unknowns, reading_charges), own, scales});
  solution.error_indicators =
      error_indicators(mesh_, panels_, preconditioner.shares(), solution.charges, own);
  if (scales.size() > 0)
    solution.error_indicators = solution.error_indicators.cwiseMax(
        change_indicators(mesh_, panels_, preconditioner.shares(), solution.reading_charges, scales));
  std::vector<bool> is_target;
  for (const ChargedBody& body : bodies_.bodies)
    is_target.push_back(body.is_target);
  const UnrefinedEnergy unrefined =
      unrefined_energy(equations, solved.charges, background_charges, is_target, own, panel_tolerance_);
  if (unrefined.gained.size() > 0) {
    solution.all.coarse -= unrefined.gained;
    if (unrefined.background.size() > 0)
      solution.background.coarse -= unrefined.background;
    solution.error_indicators += unrefined.groups;
  }
  solution.quadrature_effect = quadrature_effect(unknowns, solved.charges);
  return solution;
}

PanelSolution PanelSystem::solve_sensors(double accuracy) const {
  const ChargedBodies sensors = sensors_of(bodies_);
  PanelSystem alone(sensors, mesh_.of_first(sensors.bodies.size()));
  std::vector<FaceFunctions> functions;
  for (std::size_t face = 0; face < alone.faces(); ++face)
    functions.push_back(faces_.functions(face));
  alone.refine(functions, coupling_tolerance_);
  return alone.solve(accuracy);
}

}  // namespace fringe::detail
