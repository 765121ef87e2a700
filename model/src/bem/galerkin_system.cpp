#include "bem/galerkin_system.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "bem/face_self_interaction.hpp"
#include "bem/single_layer_faces.hpp"
#include "numeric/cholesky.hpp"
#include "numeric/interruption.hpp"
#include "readings/maxwell_matrix.hpp"
#include "readings/readings.hpp"

namespace fringe::detail {

/// The rows of the faces' functions in a system. Over all faces, those of the coarse space come first.
struct FaceNumbering {
  std::vector<std::vector<Eigen::Index>> places;  ///< for each face's functions; empty for other faces
  Eigen::Index coarse = 0;
  Eigen::Index total = 0;
};

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

FaceNumbering number(const std::vector<FaceFunctions>& functions, std::span<const std::size_t> faces) {
  FaceNumbering numbering;
  numbering.places.resize(functions.size());
  for (const std::size_t face : faces)
    numbering.places[face].resize(static_cast<std::size_t>(functions[face].count()));
  for (const bool coarse : {true, false}) {
    for (const std::size_t face : faces)
      for (int k = 0; k < functions[face].count(); ++k)
        if (is_coarse(functions[face], k) == coarse)
          numbering.places[face][static_cast<std::size_t>(k)] = numbering.total++;
    if (coarse)
      numbering.coarse = numbering.total;
  }
  return numbering;
}

}  // namespace

struct GalerkinSystem::Solved {
  FaceNumbering numbering;
  MatrixXd charges;
  NestedMatrix matrix;
  bool positive_definite = true;
};

bool is_coarse(FaceFunctions functions, int function) {
  return function / functions.v < coarse_functions(functions.u) &&
         function % functions.v < coarse_functions(functions.v);
}

MatrixXd norms_of_faces(const std::vector<MatrixXd>& charges) {
  MatrixXd norms(static_cast<Index>(charges.size()), charges.empty() ? 0 : charges.front().cols());
  for (std::size_t face = 0; face < charges.size(); ++face)
    norms.row(static_cast<Index>(face)) = charges[face].colwise().norm();
  return norms;
}

int coarse_functions(int functions) {
  // Odd, as the number of functions is, so that symmetric functions are treated like antisymmetric ones.
  const int part = 18 * functions / 25;
  return part % 2 == 0 ? part - 1 : part;
}

GalerkinSystem::GalerkinSystem(const ChargedBodies& bodies) : bodies_(bodies) {
  for (std::size_t body = 0; body < bodies.bodies.size(); ++body) {
    first_face_.push_back(faces_.size());
    for (const ChargedFace& face : faces_of(bodies.bodies[body].surface)) {
      faces_.push_back(face);
      body_of_.push_back(body);
    }
  }
  functions_.assign(faces_.size(), {0, 0});
  blocks_.resize(faces_.size() * faces_.size());
}

void GalerkinSystem::refine(const std::vector<FaceFunctions>& functions, double tolerance) {
  functions_ = functions;
  for (std::size_t body = 0; body < bodies_.bodies.size(); ++body)
    refine_body(body);
  for (std::size_t a = 0; a < faces_.size(); ++a)
    for (std::size_t b = a + 1; b < faces_.size(); ++b)
      if (body_of_[a] != body_of_[b])
        refine_pair(a, b, tolerance);
}

void GalerkinSystem::refine_body(std::size_t body) {
  const BodySurface& surface = bodies_.bodies[body].surface;
  const std::size_t first = first_face_[body], count = faces_of(surface).size();
  const auto unchanged = [&](std::size_t face) {
    return blocks_[pair(face, face)].first == functions_[face];
  };
  bool known = true;
  for (std::size_t face = first; face < first + count; ++face)
    known = known && unchanged(face);
  if (known)
    return;
  const auto* box = std::get_if<BoxSurface>(&surface);
  if (box == nullptr) {
    blocks_[pair(first, first)] = {functions_[first], functions_[first], 0,
                                   face_self_interaction(faces_[first], functions_[first])};
    return;
  }
  std::array<FaceFunctions, box_faces> functions{};
  std::copy_n(functions_.begin() + static_cast<std::ptrdiff_t>(first), box_faces, functions.begin());
  const MatrixXd matrix = box_self_interaction(box->half_sides, functions);
  Index row = 0;
  for (std::size_t a = first; a < first + count; ++a) {
    Index column = row;
    for (std::size_t b = a; b < first + count; ++b) {
      blocks_[pair(a, b)] = {functions_[a], functions_[b], 0,
                             matrix.block(row, column, functions_[a].count(), functions_[b].count())};
      column += functions_[b].count();
    }
    row += functions_[a].count();
  }
}

void GalerkinSystem::refine_pair(std::size_t a, std::size_t b, double tolerance) {
  Block& block = blocks_[pair(a, b)];
  if (block.first == functions_[a] && block.second == functions_[b] && block.tolerance <= tolerance)
    return;
  block = {functions_[a], functions_[b], tolerance,
           single_layer_block(faces_[a], functions_[a], faces_[b], functions_[b], tolerance)};
}

double GalerkinSystem::net_charge(std::size_t face) const {
  const double net = weighted_polynomials(faces_[face].edge).net_charge();
  return net * net;
}

std::vector<std::size_t> GalerkinSystem::sensor_faces() const {
  std::vector<std::size_t> faces;
  for (std::size_t face = 0; face < faces_.size(); ++face)
    if (bodies_.role(bodies_.bodies[body_of_[face]]) == Role::sensor)
      faces.push_back(face);
  return faces;
}

GalerkinSystem::Solved GalerkinSystem::solve(std::span<const std::size_t> faces, Index conductors) const {
  Solved solved;
  solved.numbering = number(functions_, faces);
  const auto& [places, coarse_size, total] = solved.numbering;
  MatrixXd matrix(total, total);
  MatrixXd& charges = solved.charges;
  charges = MatrixXd::Zero(total, conductors);
  for (std::size_t first = 0; first < faces.size(); ++first) {
    const std::size_t a = faces[first];
    charges(places[a][0], static_cast<Index>(conductor(a))) = net_charge(a);
    for (const std::size_t b : faces.subspan(first)) {
      check_interruption();
      const MatrixXd& values = block(a, b);
      for (Index k = 0; k < values.cols(); ++k)
        for (Index i = 0; i < values.rows(); ++i) {
          const Index row = places[a][static_cast<std::size_t>(i)];
          const Index column = places[b][static_cast<std::size_t>(k)];
          matrix(std::max(row, column), std::min(row, column)) = values(i, k);
        }
    }
  }
  const Cholesky factor(std::move(matrix));
  if (!factor.is_positive_definite()) {
    solved.positive_definite = false;
    return solved;
  }
  charges = factor.solve_lower(std::move(charges));
  const auto coarse = charges.topRows(coarse_size);
  solved.matrix.coarse = coarse.transpose() * coarse;
  solved.matrix.fine = charges.transpose() * charges;
  charges = factor.solve_upper(std::move(charges));
  return solved;
}

std::vector<std::size_t> GalerkinSystem::machine_faces() const {
  std::vector<std::size_t> faces;
  for (std::size_t face = 0; face < faces_.size(); ++face)
    if (!bodies_.bodies[body_of_[face]].is_target)
      faces.push_back(face);
  return faces;
}

GalerkinSystem::Alone GalerkinSystem::solve_sensors() const {
  const Solved alone = solve(sensor_faces(), static_cast<Index>(bodies_.conductors.size()));
  if (!alone.positive_definite)
    return {false, {}};
  return {true, alone.matrix};
}

MatrixXd GalerkinSystem::quadrature_effect(const MatrixXd& norms) const {
  MatrixXd effect = MatrixXd::Zero(norms.cols(), norms.cols());
  for (std::size_t a = 0; a < faces_.size() && norms.cols() > 0; ++a)
    for (std::size_t b = a + 1; b < faces_.size(); ++b) {
      if (body_of_[a] == body_of_[b])
        continue;
      const MatrixXd product = norms.row(static_cast<Index>(a)).transpose() *
                               norms.row(static_cast<Index>(b)) * block(a, b).cwiseAbs().maxCoeff();
      effect += product + product.transpose();
    }
  return effect;
}

std::vector<Eigen::Vector2d> GalerkinSystem::highest_energies(const FaceCharges& charges) const {
  std::vector<Eigen::Vector2d> highest(faces_.size(), Eigen::Vector2d::Zero());
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    const FaceFunctions functions = functions_[face];
    for (int k = 0; k < functions.count(); ++k) {
      const bool is_high_in_u = k / functions.v >= coarse_functions(functions.u);
      const bool is_high_in_v = k % functions.v >= coarse_functions(functions.v);
      if (!is_high_in_u && !is_high_in_v)
        continue;
      const auto row = charges.conductors[face].row(k);
      double part = (row.cwiseAbs2().array() / charges.own.transpose().array()).maxCoeff();
      if (charges.change_scales.size() > 0)
        part = std::max(
            part, largest_part_of_change(charges.readings[face].row(k).cwiseAbs(), charges.change_scales));
      const double energy = part * block(face, face)(k, k);
      if (is_high_in_u)
        highest[face][0] += energy;
      if (is_high_in_v)
        highest[face][1] += energy;
    }
  }
  return highest;
}

MatrixXd GalerkinSystem::detail_energies(const std::vector<MatrixXd>& charges) const {
  if (charges.empty())
    return {};
  MatrixXd energies = MatrixXd::Zero(charges.front().cols(), charges.front().cols());
  for (std::size_t face = 0; face < faces_.size(); ++face)
    for (int k = 0; k < functions_[face].count(); ++k)
      if (!is_coarse(functions_[face], k)) {
        const Eigen::RowVectorXd row = charges[face].row(k).cwiseAbs();
        energies += block(face, face)(k, k) * row.transpose() * row;
      }
  return energies;
}

std::vector<MatrixXd> GalerkinSystem::charges_of_faces(const Solved& solved) const {
  std::vector<MatrixXd> charges;
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    const std::vector<Index>& places = solved.numbering.places[face];
    if (places.empty())
      charges.emplace_back(MatrixXd::Zero(functions_[face].count(), solved.charges.cols()));
    else
      charges.emplace_back(solved.charges(places, Eigen::all));
  }
  return charges;
}

GalerkinSolution GalerkinSystem::solve() const {
  GalerkinSolution solution;
  const auto conductors = static_cast<Index>(bodies_.conductors.size());
  std::vector<std::size_t> faces(faces_.size());
  std::iota(faces.begin(), faces.end(), std::size_t{0});
  const std::vector<std::size_t> sensors = sensor_faces(), machine = machine_faces();
  const Solved all = solve(faces, conductors);
  const Solved alone = sensors.size() < faces.size() ? solve(sensors, conductors) : all;
  const Solved background = machine.size() == faces.size() ? all
                            : machine == sensors           ? alone
                                                           : solve(machine, conductors);
  solution.positive_definite =
      all.positive_definite && alone.positive_definite && background.positive_definite;
  solution.all = all.matrix;
  if (!solution.positive_definite)
    return solution;
  solution.sensors = alone.matrix;
  solution.background = background.matrix;

  FaceCharges charges{charges_of_faces(all), {}, asked_energies(solution.all.fine, bodies_), {}};
  if (!bodies_.readings.empty()) {
    const std::vector<MatrixXd> without = charges_of_faces(background);
    for (std::size_t face = 0; face < faces_.size(); ++face)
      charges.readings.push_back(reading_charges(charges.conductors[face], solution.all.fine, without[face],
                                                 solution.background.fine, bodies_)
                                     .all());
    charges.change_scales = change_scales(solution.all, solution.background, bodies_);
  }
  solution.body_charges = MatrixXd::Zero(static_cast<Index>(bodies_.bodies.size()), conductors);
  for (std::size_t face = 0; face < faces_.size(); ++face)
    solution.body_charges.row(static_cast<Index>(body_of_[face])) +=
        net_charge(face) * charges.conductors[face].row(0);
  solution.highest = highest_energies(charges);
  solution.quadrature_effect = quadrature_effect(norms_of_faces(charges.conductors));
  solution.reading_quadrature_effect = quadrature_effect(norms_of_faces(charges.readings));
  solution.reading_details = detail_energies(charges.readings);
  solution.face_reading_charges = std::move(charges.readings);
  return solution;
}

}  // namespace fringe::detail
