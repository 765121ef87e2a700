#include "bem/face_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "bem/box_self_interaction.hpp"
#include "bem/face_self_interaction.hpp"
#include "bem/single_layer_faces.hpp"
#include "readings/readings.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd norms_of_faces(const std::vector<MatrixXd>& charges) {
  MatrixXd norms(static_cast<Index>(charges.size()), charges.empty() ? 0 : charges.front().cols());
  for (std::size_t face = 0; face < charges.size(); ++face)
    norms.row(static_cast<Index>(face)) = charges[face].colwise().norm();
  return norms;
}

FaceBlocks::FaceBlocks(const ChargedBodies& bodies) : bodies_(bodies) {
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

void FaceBlocks::refine(const std::vector<FaceFunctions>& functions, double tolerance) {
  functions_ = functions;
  for (std::size_t body = 0; body < bodies_.bodies.size(); ++body)
    refine_body(body);
  for (std::size_t a = 0; a < faces_.size(); ++a)
    for (std::size_t b = a + 1; b < faces_.size(); ++b)
      if (body_of_[a] != body_of_[b])
        refine_pair(a, b, tolerance);
}

void FaceBlocks::refine_body(std::size_t body) {
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

void FaceBlocks::refine_pair(std::size_t a, std::size_t b, double tolerance) {
  Block& block = blocks_[pair(a, b)];
  if (block.first == functions_[a] && block.second == functions_[b] && block.tolerance <= tolerance)
    return;
  block = {functions_[a], functions_[b], tolerance,
           single_layer_block(faces_[a], functions_[a], faces_[b], functions_[b], tolerance)};
}

double FaceBlocks::net_charge(std::size_t face) const {
  const double net = weighted_polynomials(faces_[face].edge).net_charge();
  return net * net;
}

MatrixXd FaceBlocks::quadrature_effect(const MatrixXd& norms) const {
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

std::vector<Eigen::Vector2d> FaceBlocks::highest_energies(const FaceCharges& charges) const {
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

MatrixXd FaceBlocks::detail_energies(const std::vector<MatrixXd>& charges) const {
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

}  // namespace fringe::detail
