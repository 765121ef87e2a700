#include "bem/galerkin_system.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "bem/face_self_interaction.hpp"
#include "bem/single_layer_faces.hpp"

namespace fringe::detail {

/// The rows of the faces' functions in a system. Over all faces, those of the coarse space come first.
struct FaceNumbering {
  std::vector<std::vector<Eigen::Index>> places;  ///< for each face's functions
  Eigen::Index coarse = 0;
  Eigen::Index total = 0;
};

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

FaceNumbering number(const std::vector<FaceFunctions>& functions, std::size_t faces) {
  FaceNumbering numbering;
  numbering.places.resize(faces);
  for (std::size_t face = 0; face < faces; ++face)
    numbering.places[face].resize(static_cast<std::size_t>(functions[face].count()));
  for (const bool coarse : {true, false}) {
    for (std::size_t face = 0; face < faces; ++face)
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
    for (const ChargedFace& face : bodies.bodies[body].faces) {
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
  const std::size_t first = first_face_[body], count = bodies_.bodies[body].faces.size();
  const auto unchanged = [&](std::size_t face) {
    return blocks_[pair(face, face)].first == functions_[face];
  };
  bool known = true;
  for (std::size_t face = first; face < first + count; ++face)
    known = known && unchanged(face);
  if (known)
    return;
  if (count == 1) {
    const auto [u, v] = functions_[first];
    const ChargedFace& face = faces_[first];
    blocks_[pair(first, first)] = {
        functions_[first], functions_[first], 0,
        self_table(face.edge, std::max(u, v)).matrix(u, v, face.half_u, face.half_v)};
    return;
  }
  std::array<FaceFunctions, box_faces> functions{};
  std::copy_n(functions_.begin() + static_cast<std::ptrdiff_t>(first), box_faces, functions.begin());
  const MatrixXd matrix = box_matrix(bodies_.bodies[body].half_sides, functions);
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
           mutual_matrix(faces_[a], functions_[a], faces_[b], functions_[b], tolerance)};
}

double GalerkinSystem::net_charge(std::size_t face) const {
  const double net = weighted_polynomials(faces_[face].edge).net_charge();
  return net * net;
}

std::size_t GalerkinSystem::sensor_faces() const {
  std::size_t faces = 0;
  while (faces < faces_.size() && conductor(faces) < bodies_.sensors)
    ++faces;
  return faces;
}

GalerkinSystem::Solved GalerkinSystem::solve(std::size_t faces, Index columns) const {
  Solved solved;
  solved.numbering = number(functions_, faces);
  const auto& [places, coarse_size, total] = solved.numbering;
  MatrixXd matrix(total, total);
  MatrixXd& charges = solved.charges;
  charges = MatrixXd::Zero(total, columns);
  for (std::size_t a = 0; a < faces; ++a) {
    charges(places[a][0], static_cast<Index>(conductor(a))) = net_charge(a);
    for (std::size_t b = a; b < faces; ++b) {
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
  return solve(sensor_faces(), static_cast<Index>(bodies_.sensors)).matrix;
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
  const auto conductors = static_cast<Index>(bodies_.names.size());
  const Solved all = solve(faces_.size(), conductors);
  solution.positive_definite = all.positive_definite;
  solution.all = all.matrix;
  solution.sensors = all.matrix;
  if (sensor_faces() < faces_.size()) {
    const Solved sensors = solve(sensor_faces(), static_cast<Index>(bodies_.sensors));
    solution.positive_definite &= sensors.positive_definite;
    solution.sensors = sensors.matrix;
  }
  if (!solution.positive_definite)
    return solution;
  std::vector<MatrixXd> charges;
  for (std::size_t face = 0; face < faces_.size(); ++face)
    charges.emplace_back(all.charges(all.numbering.places[face], Eigen::all));
  const FaceEnergies found = energies(charges, solution.all.fine.diagonal());
  solution.highest = found.highest;
  solution.quadrature_effect = quadrature_effect(found.norms);
  return solution;
}

}  // namespace fringe::detail
