#include <algorithm>
#include <array>
#include <cmath>

#include "collision/convex_shape_data.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Ratio of the square root of the number of vertices to the number of squares along a side of the cube. With
/// more squares a query would at times visit one block of vertices less, but the table would outgrow the
/// processor's fast memory.
constexpr double vertices_per_square_root = 4.5;

/// Limit of squares times vertices, over the whole cube; this much work takes a fraction of a second.
constexpr double most_work = 2e7;

/// Length by which the borders of a square are moved outwards (the cube's side is 2), so that rounding of a
/// direction's position does not matter.
constexpr double cell_border = 1e-9;

/// Returns the direction through the point (u, v) of a face of the cube [−1, 1]³.
Vector3d direction_through(int face, double u, double v) {
  const double main = face % 2 == 0 ? 1 : -1;
  const int axis = face / 2;
  Vector3d direction;
  direction[axis] = main;
  direction[(axis + 1) % 3] = u;
  direction[(axis + 2) % 3] = v;
  return direction;
}

/// Returns the vertices that may be the support point for a direction between the corners. A vertex is
/// dropped if another one exceeds it along all four corners, and therefore along every direction between
/// them.
std::vector<std::uint32_t> candidates(std::span<const Vector3d> vertices,
                                      const std::array<Vector3d, 4>& corners, double margin) {
  using Products = Eigen::Array4d;
  const auto products_of = [&](const Vector3d& vertex) -> Products {
    return {corners[0].dot(vertex), corners[1].dot(vertex), corners[2].dot(vertex), corners[3].dot(vertex)};
  };
  std::vector<Products> products(vertices.size());
  std::transform(vertices.begin(), vertices.end(), products.begin(), products_of);
  // The support points along the corners and along their mean exceed nearly all vertices that can be dropped.
  std::array<std::size_t, 5> leaders{};
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    for (Eigen::Index corner = 0; corner < 4; ++corner)
      if (products[i][corner] > products[leaders[static_cast<std::size_t>(corner)]][corner])
        leaders[static_cast<std::size_t>(corner)] = i;
    if (products[i].sum() > products[leaders[4]].sum())
      leaders[4] = i;
  }
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (std::none_of(leaders.begin(), leaders.end(),
                     [&](std::size_t leader) { return (products[leader] > products[i] + margin).all(); }))
      kept.push_back(static_cast<std::uint32_t>(i));
  return kept;
}

}  // namespace

void CoordinateBlocks::push_back(const Vector3d& point) {
  constexpr std::size_t block = VertexBlocks::size;
  const std::size_t lane = size_ % block;
  if (lane == 0)
    coordinates_.resize(coordinates_.size() + 3 * block);
  double* const begin = coordinates_.data() + size_ / block * 3 * block;
  for (std::size_t k = 0; k < 3; ++k)
    begin[k * block + lane] = point[static_cast<Eigen::Index>(k)];
  ++size_;
}

void CoordinateBlocks::fill_block() {
  constexpr std::size_t block = VertexBlocks::size;
  const double* const last = coordinates_.data() + (size_ - 1) / block * 3 * block + (size_ - 1) % block;
  const Vector3d point(last[0], last[block], last[2 * block]);
  last_ = size_ - 1;
  while (size_ % block != 0)
    push_back(point);
}

CellLists direction_cells(std::span<const Vector3d> vertices, double bounding_radius) {
  CellLists cells;
  if (vertices.size() <= SupportShape::few_vertices)
    return cells;
  // With this resolution a square of a sphere's hull lists about fifteen vertices.
  const double wished = std::sqrt(static_cast<double>(vertices.size())) / vertices_per_square_root;
  const double affordable = std::sqrt(most_work / (6 * static_cast<double>(vertices.size())));
  cells.resolution = std::max(2, static_cast<int>(std::lround(std::min(wished, affordable))));
  // Twice the error bound of a vertex's product with a corner, whose components are at most 1.
  const double margin = 0x1p-48 * bounding_radius;
  const double side = 2.0 / cells.resolution;
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i < cells.resolution; ++i)
      for (int j = 0; j < cells.resolution; ++j) {
        const double u0 = -1 + i * side - cell_border, u1 = -1 + (i + 1) * side + cell_border;
        const double v0 = -1 + j * side - cell_border, v1 = -1 + (j + 1) * side + cell_border;
        const std::array<Vector3d, 4> corners{
            direction_through(face, u0, v0), direction_through(face, u1, v0), direction_through(face, u0, v1),
            direction_through(face, u1, v1)};
        cells.starts.push_back(static_cast<std::uint32_t>(cells.indices.size()));
        for (const std::uint32_t index : candidates(vertices, corners, margin)) {
          cells.coordinates.push_back(vertices[index]);
          cells.indices.push_back(index);
        }
        cells.coordinates.fill_block();
        cells.indices.resize(cells.coordinates.size(), cells.indices.back());
      }
  cells.starts.push_back(static_cast<std::uint32_t>(cells.indices.size()));
  return cells;
}

}  // namespace fringe::detail
