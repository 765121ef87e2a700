#include "bem/galerkin_system.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include <Eigen/Cholesky>

#include "bem/face_self_interaction.hpp"
#include "bem/maxwell_matrix.hpp"
#include "bem/single_layer_faces.hpp"

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
    const auto [u, v] = functions_[first];
    const ChargedFace& face = faces_[first];
    blocks_[pair(first, first)] = {
        functions_[first], functions_[first], 0,
        face_self_interaction(face.edge, std::max(u, v)).matrix(u, v, face.half_u, face.half_v)};
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
      const MatrixXd& values = block(a, b);
      for (Index k = 0; k < values.cols(); ++k)
        for (Index i = 0; i < values.rows(); ++i) {
          const Index row = places[a][static_cast<std::size_t>(i)];
          const Index column = places[b][static_cast<std::size_t>(k)];
          matrix(std::max(row, column), std::min(row, column)) = values(i, k);
        }
    }
  }
  const Eigen::LLT<Eigen::Ref<MatrixXd>> factor(matrix);
  if (factor.info() != Eigen::Success) {
    solved.positive_definite = false;
    return solved;
  }
  factor.matrixL().solveInPlace(charges);
  const auto coarse = charges.topRows(coarse_size);
  solved.matrix.coarse = coarse.transpose() * coarse;
  solved.matrix.fine = charges.transpose() * charges;
  factor.matrixU().solveInPlace(charges);
  return solved;
}

NestedMatrix GalerkinSystem::solve_sensors() const {
  return solve(sensor_faces(), static_cast<Index>(count_of(bodies_, Role::sensor))).matrix;
}

MatrixXd GalerkinSystem::quadrature_effect(const MatrixXd& norms) const {
  MatrixXd effect = MatrixXd::Zero(norms.cols(), norms.cols());
  for (std::size_t a = 0; a < faces_.size(); ++a)
    for (std::size_t b = a + 1; b < faces_.size(); ++b) {
      if (body_of_[a] == body_of_[b])
        continue;
      const MatrixXd product = norms.row(static_cast<Index>(a)).transpose() *
                               norms.row(static_cast<Index>(b)) * block(a, b).cwiseAbs().maxCoeff();
      effect += product + product.transpose();
    }
  return effect;
}

FaceEnergies GalerkinSystem::energies(const std::vector<MatrixXd>& charges,
                                      const Eigen::VectorXd& own) const {
  FaceEnergies result{MatrixXd::Zero(static_cast<Index>(faces_.size()), own.size()),
                      {faces_.size(), Eigen::Vector2d::Zero()}};
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    const FaceFunctions functions = functions_[face];
    for (int k = 0; k < functions.count(); ++k) {
      const auto row = charges[face].row(k);
      result.norms.row(static_cast<Index>(face)) += row.cwiseAbs2();
      const double energy =
          (row.cwiseAbs2().array() / own.transpose().array()).maxCoeff() * block(face, face)(k, k);
      if (k / functions.v >= coarse_functions(functions.u))
        result.highest[face][0] += energy;
      if (k % functions.v >= coarse_functions(functions.v))
        result.highest[face][1] += energy;
    }
  }
  result.norms = result.norms.cwiseSqrt().eval();
  return result;
}

GalerkinSolution GalerkinSystem::solve() const {
  GalerkinSolution solution;
  const auto conductors = static_cast<Index>(bodies_.conductors.size());
  std::vector<std::size_t> faces(faces_.size());
  std::iota(faces.begin(), faces.end(), std::size_t{0});
  const Solved all = solve(faces, conductors);
  solution.positive_definite = all.positive_definite;
  solution.all = all.matrix;
  solution.sensors = all.matrix;
  if (const auto sensors = sensor_faces(); sensors.size() < faces.size()) {
    const Solved alone = solve(sensors, static_cast<Index>(count_of(bodies_, Role::sensor)));
    solution.positive_definite &= alone.positive_definite;
    solution.sensors = alone.matrix;
  }
  if (!solution.positive_definite)
    return solution;
  std::vector<MatrixXd> charges;
  solution.body_charges = MatrixXd::Zero(static_cast<Index>(bodies_.bodies.size()), conductors);
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    charges.emplace_back(all.charges(all.numbering.places[face], Eigen::all));
    solution.body_charges.row(static_cast<Index>(body_of_[face])) += net_charge(face) * charges.back().row(0);
  }
  const FaceEnergies of_faces = energies(charges, asked_energies(solution.all.fine, bodies_));
  solution.highest = of_faces.highest;
  solution.quadrature_effect = quadrature_effect(of_faces.norms);
  return solution;
}

}  // namespace fringe::detail
