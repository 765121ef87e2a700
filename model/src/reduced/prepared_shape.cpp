#include "reduced/prepared_shape.hpp"

#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include <Eigen/Cholesky>

#include "bem/box_self_interaction.hpp"
#include "bem/face_self_interaction.hpp"
#include "bem/jacobi_basis.hpp"
#include "reduced/node_kernels.hpp"
#include "reduced/prepared_mesh.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Numbers of functions of the levels along each direction.
constexpr std::array<int, PreparedShape::levels> level_functions{5, 7, 11, most_reduced_functions};

/// Number of parts of an edge between its points.
constexpr int edge_parts = 8;

/// Step between the places of a cluster that give a point of the surface: every fourth.
constexpr std::ptrdiff_t surface_step = 4;

void add_outline(const ChargedFace& face, std::vector<std::array<Vector3d, 2>>& edges) {
  const std::array<Vector3d, 4> corners = corners_of(face);
  for (std::size_t k = 0; k < 4; ++k)
    edges.push_back({corners[k], corners[(k + 1) % 4]});
}

std::vector<std::array<Vector3d, 2>> edges_of(const FlatPlate& plate) {
  std::vector<std::array<Vector3d, 2>> edges;
  add_outline(plate.face, edges);
  return edges;
}

std::vector<std::array<Vector3d, 2>> edges_of(const BoxSurface& box) {
  std::vector<std::array<Vector3d, 2>> edges;
  // The outlines of the faces −z and +z, and the edges between them.
  add_outline(box.faces[4], edges);
  add_outline(box.faces[5], edges);
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      edges.push_back(
          {box.half_sides.cwiseProduct(Vector3d(x, y, -1)), box.half_sides.cwiseProduct(Vector3d(x, y, 1))});
  return edges;
}

Vector3d half_sides_of(const FlatPlate& plate) {
  return {plate.face.half_u, plate.face.half_v, 0};
}

Vector3d half_sides_of(const BoxSurface& box) {
  return box.half_sides;
}

MatrixXd self_interaction(const FlatPlate& plate, int functions) {
  const ChargedFace& face = plate.face;
  return face_self_interaction(face, {functions, functions});
}

MatrixXd self_interaction(const BoxSurface& box, int functions) {
  std::array<FaceFunctions, box_faces> all{};
  all.fill({functions, functions});
  return box_self_interaction(box.half_sides, all);
}

PreparedLevel prepare(const MatrixXd& self, EdgeKind edge, int functions) {
  const Index count = self.rows();
  const MatrixXd inverse = self.llt().solve(MatrixXd::Identity(count, count));
  VectorXd net = VectorXd::Zero(count);
  const double net_charge = weighted_polynomials(edge).net_charge();
  std::vector<int> highest;
  const int kept = coarse_functions(functions);
  for (Index k = 0; k < count; ++k) {
    const int in_face = static_cast<int>(k) % (functions * functions);
    if (in_face == 0)
      net[k] = net_charge * net_charge;
    if (in_face / functions >= kept || in_face % functions >= kept)
      highest.push_back(static_cast<int>(k));
  }
  const VectorXd charge = inverse * net;
  const double root = std::sqrt(net.dot(charge));
  const auto high = static_cast<Index>(highest.size());
  MatrixXd block(high, high);
  for (Index row = 0; row < high; ++row)
    for (Index column = 0; column < high; ++column)
      block(row, column) =
          inverse(highest[static_cast<std::size_t>(row)], highest[static_cast<std::size_t>(column)]);
  return PreparedLevel{functions,
                       count,
                       whole_blocks(count),
                       stored(inverse),
                       stored(net),
                       stored(charge / root),
                       stored(net / root),
                       root,
                       highest,
                       stored(block.llt().solve(MatrixXd::Identity(high, high))),
                       {},
                       {},
                       {}};
}

}  // namespace

std::vector<float> stored(const MatrixXd& matrix) {
  const auto rows = static_cast<std::size_t>(matrix.rows());
  const auto padded = static_cast<std::size_t>(whole_blocks(matrix.rows()));
  std::vector<float> result(padded * static_cast<std::size_t>(matrix.cols()) + node_block, 0.0F);
  for (std::size_t column = 0; column < static_cast<std::size_t>(matrix.cols()); ++column)
    for (std::size_t row = 0; row < rows; ++row)
      result[column * padded + row] =
          static_cast<float>(matrix(static_cast<Index>(row), static_cast<Index>(column)));
  return result;
}

int functions_of_level(int level) {
  return level_functions[static_cast<std::size_t>(level)];
}

PreparedShape::PreparedShape(const FacedSurface& surface) : levels_(levels) {
  std::visit(
      [&](const auto& faced) {
        surface_ = faced;
        half_sides_ = half_sides_of(faced);
        edges_ = edges_of(faced);
      },
      surface);
  const auto faces = faces_of(surface_);
  faces_.assign(faces.begin(), faces.end());
  std::vector<Vector3d> points;
  for (const auto& [from, to] : edges_)
    for (int k = 0; k < edge_parts; ++k)
      points.emplace_back(from + (to - from) * k / edge_parts);
  set_edge_points(std::move(points));
}

PreparedShape::PreparedShape(std::vector<TriangleSurface> surfaces, double accuracy)
    : PreparedShape(std::make_unique<PreparedMesh>(std::move(surfaces), accuracy)) {}

PreparedShape::PreparedShape(const InsulatedBodies& bodies, double accuracy)
    : PreparedShape(std::make_unique<PreparedMesh>(bodies, accuracy)) {}

PreparedShape::PreparedShape(std::unique_ptr<PreparedMesh> mesh)
    : surface_(TriangleSurface{}), half_sides_(Vector3d::Zero()), levels_(levels), mesh_(std::move(mesh)) {
  std::vector<Vector3d> points;
  for (const TriangleSurface& surface : mesh_->surfaces())
    for (const Triangle& triangle : surface.triangles)
      for (const Vector3d& corner : triangle)
        half_sides_ = half_sides_.cwiseMax(corner.cwiseAbs());
  for (const PanelCluster& cluster : mesh_->panels().clusters)
    for (std::ptrdiff_t place = 0; place < cluster.count; place += surface_step)
      points.push_back(mesh_->point(cluster.first + place));
  set_edge_points(std::move(points));
}

PreparedShape::~PreparedShape() = default;

bool PreparedShape::has_faces_of(const FacedSurface& surface) const {
  return std::visit(
      [&]<typename Surface>(const Surface& faced) {
        return std::holds_alternative<Surface>(surface_) && half_sides_of(faced) == half_sides_;
      },
      surface);
}

void PreparedShape::set_edge_points(std::vector<Vector3d> points) {
  edge_point_count_ = static_cast<std::ptrdiff_t>(points.size());
  points.resize(static_cast<std::size_t>(whole_blocks(edge_point_count_)), points.back());
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const Vector3d& point : points)
      edge_points_[axis].push_back(static_cast<float>(point[static_cast<Index>(axis)]));
}

NodePoints PreparedShape::edge_points() const {
  return {edge_points_[0].data(), edge_points_[1].data(), edge_points_[2].data(), edge_point_count_};
}

const PreparedLevel& PreparedShape::level(int index) {
  std::optional<PreparedLevel>& level = levels_[static_cast<std::size_t>(index)];
  const int functions = functions_of_level(index);
  if (!level)
    level = std::visit(
        [&]<typename Surface>(const Surface& surface) {
          if constexpr (std::is_same_v<Surface, TriangleSurface>)
            return mesh_->level(index);
          else
            return prepare(self_interaction(surface, functions), faces_.front().edge, functions);
        },
        surface_);
  return *level;
}

}  // namespace fringe::detail
