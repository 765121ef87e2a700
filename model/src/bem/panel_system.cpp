#include "bem/panel_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

#include "bem/group_densities.hpp"
#include "bem/proximity_refinement.hpp"
#include "bem/single_layer_panels.hpp"
#include "numeric/parallel.hpp"
#include "readings/asked_error.hpp"
#include "readings/maxwell_matrix.hpp"
#include "readings/readings.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Ratio of the panels' quadrature tolerance to the faces'. The panels' quadratures are much better than
/// their tolerance: between a plate and a cube at a fifth of its size, at any of four levels, they changed no
/// capacitance by more than a fiftieth of it; of nine robot arms none by more than a twentieth.
constexpr double panel_tolerances = 25;

/// Stands for a matrix that has to be evaluated.
constexpr double unknown_tolerance = std::numeric_limits<double>::infinity();

void require_positive_definite(bool is_positive_definite) {
  if (!is_positive_definite)
    throw std::runtime_error("the matrix of the boundary elements is not positive definite");
}

}  // namespace

PanelSystem::PanelSystem(const ChargedBodies& bodies, const PanelGrading& grading, std::size_t threads)
    : bodies_(bodies), threads_(threads), faces_(bodies),
      mesh_(std::make_shared<const HiddenSurface>(bodies)), panel_tolerance_(unknown_tolerance),
      coupling_tolerance_(unknown_tolerance) {
  for (std::size_t body = 0; body < bodies.bodies.size(); ++body)
    if (const auto* surface = std::get_if<TriangleSurface>(&bodies.bodies[body].surface))
      mesh_.add(body, surface->triangles, grading, surface->round ? &*surface->round : nullptr, threads);
  refine_by_proximity(mesh_, bodies, grading.most_panels);
}

void PanelSystem::refine_groups(const std::vector<int>& steps, const MatrixXd& charges) {
  // After two refinements without a matrix between them, the places are not those of the matrix.
  if (is_refined_)
    panel_tolerance_ = coupling_tolerance_ = unknown_tolerance;
  const Index panels = index_of(mesh_.panels().size()), columns = last_charges_.cols();
  MatrixXd last(panels, columns + last_background_.cols());
  if (columns > 0)
    last.leftCols(columns) = last_charges_.bottomRows(panels);
  if (last_background_.cols() > 0)
    last.rightCols(last_background_.cols()) = last_background_.bottomRows(panels);
  const MatrixXd carried = mesh_.refine(steps, charges, last);
  const auto carry = [&](MatrixXd& all, const auto& of_panels) {
    if (all.size() == 0)
      return;
    const Index functions = all.rows() - panels;
    all.conservativeResize(functions + of_panels.rows(), Eigen::NoChange);
    all.bottomRows(of_panels.rows()) = of_panels;
  };
  carry(last_charges_, carried.leftCols(columns));
  carry(last_background_, carried.rightCols(last_background_.cols()));
  is_refined_ = true;
}

/// Returns the charges by which an iteration begins, from those of the last solution: functions of faces that
/// are new have none.
MatrixXd PanelSystem::begun(const MatrixXd& last, Index functions) const {
  if (last.size() == 0)
    return {};
  const Index panels = index_of(mesh_.panels().size());
  MatrixXd result = MatrixXd::Zero(functions + panels, last.cols());
  result.bottomRows(panels) = last.bottomRows(panels);
  Index to = 0, from = 0;
  for (std::size_t face = 0; face < faces(); ++face) {
    const FaceFunctions now = faces_.functions(face), before = last_functions_[face];
    for (Index u = 0; u < std::min(now.u, before.u); ++u)
      for (Index v = 0; v < std::min(now.v, before.v); ++v)
        result.row(to + u * now.v + v) = last.row(from + u * before.v + v);
    to += now.count();
    from += before.count();
  }
  return result;
}

void PanelSystem::refine(const std::vector<FaceFunctions>& functions, double tolerance) {
  faces_.refine(functions, tolerance);
  if (mesh_.panels().empty())
    return;
  if (panel_tolerance_ > panel_tolerances * tolerance || is_refined_) {
    const bool is_finer = panel_tolerance_ > panel_tolerances * tolerance;
    panel_tolerance_ = std::min(panel_tolerance_, panel_tolerances * tolerance);
    panels_ = std::make_unique<PanelOperator>(mesh_, panel_tolerance_, is_finer ? nullptr : panels_.get(),
                                              threads_);
    // Panels that coincide still do after a refinement.
    set_ridge(is_finer ? 0 : std::exchange(ridge_, 0));
  }
  refine_coupling(functions, tolerance);
  is_refined_ = false;
}

/// Evaluates the elements of panels and functions that are new, or all for a finer tolerance.
void PanelSystem::refine_coupling(const std::vector<FaceFunctions>& functions, double tolerance) {
  /// Number of panels in one call.
  constexpr std::size_t together = 8;
  const bool is_finer = coupling_tolerance_ > tolerance;
  if (!is_finer && !is_refined_ && coupled_functions_ == functions)
    return;
  coupling_tolerance_ = std::min(coupling_tolerance_, tolerance);
  const std::vector<Panel>& panels = mesh_.panels();
  const Eigen::MatrixXf before = std::move(coupling_);
  Index rows = 0;
  for (const FaceFunctions& face : functions)
    rows += face.count();
  coupling_.resize(rows, index_of(panels.size()));
  std::vector<std::size_t> known, missing;
  const auto place_before = [&](std::size_t k) {
    return is_refined_ ? mesh_.places_before()[k] : index_of(k);
  };
  for (std::size_t k = 0; k < panels.size(); ++k)
    (is_finer || place_before(k) == PanelMesh::no_place ? missing : known).push_back(k);

  const auto evaluate = [&](const std::vector<std::size_t>& places, bool are_known) {
    parallel_for((places.size() + together - 1) / together, threads_, [&](std::size_t part) {
      const auto here =
          std::span(places).subspan(part * together, std::min(together, places.size() - part * together));
      std::vector<Panel> targets;
      for (const std::size_t k : here)
        targets.push_back(panels[k]);
      Index row = 0, row_before = 0;
      for (std::size_t face = 0; face < functions.size(); ++face) {
        const Index count = functions[face].count();
        if (are_known && coupled_functions_[face] == functions[face]) {
          for (const std::size_t k : here)
            coupling_.col(index_of(k)).segment(row, count) =
                before.col(place_before(k)).segment(row_before, count);
        } else {
          const MatrixXd block =
              single_layer_block(faces_.face(face), functions[face], targets, coupling_tolerance_);
          for (std::size_t k = 0; k < here.size(); ++k)
            coupling_.col(index_of(here[k])).segment(row, count) = block.col(index_of(k)).cast<float>();
        }
        row += count;
        row_before += are_known ? coupled_functions_[face].count() : 0;
      }
    });
  };
  evaluate(missing, false);
  evaluate(known, true);
  coupled_functions_ = functions;
}

/// Returns the charge on each body (rows) from the charges of all unknowns.
MatrixXd PanelSystem::body_charges(const PanelUnknowns& unknowns, const MatrixXd& charges) const {
  MatrixXd result = MatrixXd::Zero(index_of(bodies_.bodies.size()), charges.cols());
  for (std::size_t face = 0; face < faces(); ++face)
    result.row(index_of(faces_.body(face))) += faces_.net_charge(face) * charges.row(unknowns.first[face]);
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
  const MatrixXd absolute = charges.bottomRows(index_of(mesh_.panels().size())).cwiseAbs();
  if (absolute.isZero(0))
    return faces_.quadrature_effect(norms);
  MatrixXd felt = panels_->apply(absolute);
  for (std::size_t face = 0; face < faces(); ++face) {
    const Eigen::RowVectorXd largest =
        coupling_.middleRows(unknowns.first[face], faces_.functions(face).count())
            .cwiseAbs()
            .colwise()
            .maxCoeff()
            .cast<double>();
    felt += 2 * largest.transpose() * norms.row(index_of(face));
  }
  const MatrixXd effect = absolute.transpose() * felt;
  const MatrixXd of_panels = panel_tolerances / 4 * (effect + effect.transpose());
  return faces() == 0 ? of_panels : faces_.quadrature_effect(norms) + of_panels;
}

/// Returns the energies that panels which were never divided would gain from division, estimated from the
/// sampled ones, between all columns of the charges with all bodies and, after them, of those with the
/// unknowns that are present.
MatrixXd PanelSystem::gained_by_division(const SampledQuarters& sampled, const PanelUnknowns& unknowns,
                                         const MatrixXd& charges, const MatrixXd& of_present) const {
  // The conductors' own potentials are constant: charges whose sum vanishes do not see them.
  MatrixXd both(unknowns.net.rows(), charges.cols() + of_present.cols());
  if (charges.cols() > 0)
    both.leftCols(charges.cols()) = charges;
  if (of_present.cols() > 0)
    both.rightCols(of_present.cols()) = of_present;
  MatrixXd missing =
      panel_potentials(sampled.panels, mesh_.panels(), both.bottomRows(index_of(mesh_.panels().size())),
                       panel_tolerance_, threads_);
  for (std::size_t face = 0; face < faces(); ++face)
    missing +=
        single_layer_block(faces_.face(face), functions(face), sampled.panels, panel_tolerance_).transpose() *
        both.middleRows(unknowns.first[face], functions(face).count());
  for (std::size_t k = 0; k < sampled.panels.size() && of_present.cols() > 0; ++k)
    if (unknowns.present[unknowns.functions + index_of(sampled.parents[k])] == 0)
      missing.row(index_of(k)).tail(of_present.cols()).setZero();
  return energy_of_quarters(sampled, missing, panel_tolerance_);
}

void PanelSystem::set_ridge(double ridge) {
  panels_->scale_diagonal((1 + ridge) / (1 + ridge_));
  ridge_ = ridge;
}

/// Returns the energy that the ridge takes from charges of the panels, all counted as positive. What it
/// changes is that in first order.
MatrixXd PanelSystem::ridge_effect(const MatrixXd& charges) const {
  MatrixXd effect = MatrixXd::Zero(charges.cols(), charges.cols());
  if (ridge_ == 0)
    return effect;
  VectorXd weights(charges.rows());
  for (Index k = 0; k < weights.size(); ++k)
    weights[k] = ridge_ / (1 + ridge_) * panels_->self(static_cast<std::size_t>(k));
  return charges.cwiseAbs().transpose() * weights.asDiagonal() * charges.cwiseAbs();
}

PanelSolution PanelSystem::solve(double accuracy, double most_ridge, double change_part) {
  /// Ratio of the ridges that are tried. One that is just large enough for a positive definite matrix leaves
  /// panels that nearly coincide large charges of both signs.
  constexpr double step = 10;
  constexpr int steps = 2;
  PanelSolution solution = solve_once(accuracy, change_part);
  if (mesh_.panels().empty())
    return solution;
  double ridge = most_ridge * std::pow(step, -(steps - 1));
  for (int k = 0; k < steps && !solution.positive_definite && most_ridge > 0; ++k, ridge *= step)
    if (ridge > ridge_) {
      set_ridge(ridge);
      solution = solve_once(accuracy, change_part);
    }
  if (!solution.positive_definite)
    set_ridge(0);
  return solution;
}

PanelSolution PanelSystem::solve_once(double accuracy, double change_part) {
  PanelSolution solution;
  const PanelUnknowns unknowns = number_unknowns();
  const bool has_readings = !bodies_.readings.empty();
  const Spaces spaces = this->spaces();
  if (count_of(bodies_, Role::sensor) > 0 && !sensors_have_panels(bodies_)) {
    solution.sensors = solve_sensors(spaces, accuracy);
    solution.positive_definite = solution.sensors.positive_definite;
    if (!solution.positive_definite)
      return solution;
  }
  Solved background;
  PanelUnknowns machine = unknowns;
  MatrixXd start = begun(last_charges_, unknowns.functions);
  if (has_readings) {
    machine = unknowns_of(unknowns, [](const ChargedBody& body) { return !body.is_target; });
    const MatrixXd begun_background = begun(last_background_, unknowns.functions);
    background = solve_equations(machine, spaces, accuracy * change_part, begun_background, nullptr);
    solution.positive_definite = background.positive_definite();
    if (!solution.positive_definite)
      return solution;
    if (start.size() > 0)
      start -= begun_background;
  }
  const Solved solved =
      solve_equations(unknowns, spaces, accuracy, start, has_readings ? &background : nullptr);
  solution.positive_definite = solved.positive_definite();
  if (!solution.positive_definite)
    return solution;
  solution.all = {solved.fine.matrix, solved.coarse.matrix};
  solution.iteration_error = solved.fine.iteration_error();
  solution.charges = solved.charges.bottomRows(index_of(mesh_.panels().size()));
  solution.coarse_charges = solved.coarse_charges;
  solution.body_charges = body_charges(unknowns, solved.charges);
  const MatrixXd at = potentials(solution.all.fine, bodies_);
  const MatrixXd kept_charges = solution.charges * at;
  solution.ridge_effect = ridge_effect(kept_charges);
  const VectorXd own = asked_energies(solution.all.fine, bodies_);
  const VectorXd shares = area_shares(mesh_);
  std::vector<MatrixXd> blocks;
  for (const PanelGroup& group : mesh_.groups())
    blocks.push_back(panels_->block_of_group(group));
  Eigen::ArrayXXd scales_of_entries = error_scales((solution.all.fine * at).topRows(at.cols()), bodies_);
  scales_of_entries.matrix().diagonal() =
      scales_of_entries.matrix().diagonal().cwiseMin(own.head(scales_of_entries.rows()));
  // Floating conductors have no entries, but their energies may be asked for.
  solution.error_indicators =
      largest_parts(detail_energies(mesh_, blocks, shares, solution.charges), own) +
      facet_indicators(mesh_, bodies_, kept_charges, scales_of_entries)
          .cwiseMax(largest_parts(facet_energies(mesh_, bodies_, solution.charges), own));
  VectorXd scales;
  if (has_readings) {
    solution.background = {background.fine.matrix, background.coarse.matrix};
    solution.background_iteration_error = background.fine.iteration_error();
    solution.change_iteration_error = solved.fine.iteration_error_of_change();
    const MatrixXd reading_charges =
        detail::reading_charges(solved.charges, solution.all.fine, background.charges,
                                solution.background.fine, bodies_)
            .all();
    solution.reading_charges = reading_charges.bottomRows(index_of(mesh_.panels().size()));
    solution.reading_ridge_effect = ridge_effect(solution.reading_charges);
    solution.face_reading_charges = charges_of_faces(unknowns, reading_charges);
    solution.reading_quadrature_effect = quadrature_effect(unknowns, reading_charges);
    const MatrixXd details = detail_energies(mesh_, blocks, shares, solution.reading_charges);
    solution.reading_details = energies_of_pairs(details);
    if (faces() > 0)
      solution.reading_details += faces_.detail_energies(solution.face_reading_charges);
    scales = change_scales(solution.all, solution.background, bodies_);
    solution.error_indicators = solution.error_indicators.cwiseMax(
        largest_parts_of_change(details, scales) +
        largest_parts_of_change(facet_energies(mesh_, bodies_, solution.reading_charges), scales));
  }
  solution.highest = faces_.highest_energies(
      {charges_of_faces(unknowns, solved.charges), solution.face_reading_charges, own, scales});
  if (const SampledQuarters sampled = sampled_quarters(mesh_); !sampled.panels.empty()) {
    const Index columns = solved.charges.cols(), without = background.charges.cols();
    const MatrixXd gained = gained_by_division(sampled, machine, solved.charges, background.charges);
    solution.all.coarse -= gained.topLeftCorner(columns, columns);
    if (without > 0)
      solution.background.coarse -= gained.bottomRightCorner(without, without);
    solution.error_indicators +=
        unrefined_indicators(mesh_, blocks, solution.charges, own,
                             (gained.diagonal().head(columns).array() / own.array()).maxCoeff());
  }
  solution.quadrature_effect = quadrature_effect(unknowns, solved.charges);
  last_charges_ = solved.charges;
  last_background_ = std::move(background.charges);
  last_functions_.clear();
  for (std::size_t face = 0; face < faces(); ++face)
    last_functions_.push_back(functions(face));
  return solution;
}

PanelSolution PanelSystem::solve_definite(const std::vector<FaceFunctions>& functions, double& tolerance,
                                          double accuracy, double most_ridge, double change_part) {
  /// Finest relative tolerance of the quadratures. Below it, rounding errors dominate the matrix elements.
  constexpr double finest_tolerance = 1e-13;
  while (true) {
    refine(functions, tolerance);
    PanelSolution found = solve(accuracy, most_ridge, change_part);
    if (found.positive_definite)
      return found;
    if (tolerance < finest_tolerance)
      require_positive_definite(false);
    tolerance /= 100;
  }
}

SensorsAlone PanelSystem::solve_sensors(double accuracy) const {
  SensorsAlone result = solve_sensors(spaces(), accuracy);
  require_positive_definite(result.positive_definite);
  return result;
}

SensorsAlone PanelSystem::solve_sensors(const Spaces& spaces, double accuracy) const {
  const PanelUnknowns unknowns = unknowns_of(
      number_unknowns(), [&](const ChargedBody& body) { return bodies_.role(body) == Role::sensor; });
  const Solved solved = solve_equations(unknowns, spaces, accuracy, {}, nullptr);
  SensorsAlone result;
  result.positive_definite = solved.positive_definite();
  if (!result.positive_definite)
    return result;
  result.matrix = {solved.fine.matrix, solved.coarse.matrix};
  if (const SampledQuarters sampled = sampled_quarters(mesh_);
      !sampled.panels.empty() && sensors_have_panels(bodies_))
    result.matrix.coarse -= gained_by_division(sampled, unknowns, {}, solved.charges);
  result.quadrature_effect = quadrature_effect(unknowns, solved.charges);
  result.iteration_error = solved.fine.iteration_error();
  return result;
}

}  // namespace fringe::detail
