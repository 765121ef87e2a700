#include "fringe/convex_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "collision/convex_shape_data.hpp"
#include "fringe/error.hpp"

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
  // A square of a sphere's hull lists about fifteen vertices with this resolution.
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

namespace fringe {
namespace {

using detail::ConvexShapeData;
using detail::ShapeKind;
using Eigen::Vector3d;

/// Factor that compensates the rounding of a length computed from coordinates.
constexpr double rounded_up = 1 + 0x1p-50;

void check_length(double length, std::string_view name) {
  if (!std::isfinite(length) || length < 0)
    throw InputError(fmt::format("{} must be finite and not negative, not {}", name, length));
}

/// Refuses a radius that is zero, too: a point on a surface without volume cannot be moved inwards.
void check_radius(double length, std::string_view name) {
  if (!std::isfinite(length) || length <= 0)
    throw InputError(fmt::format("{} must be finite and greater than zero, not {}", name, length));
}

/// Creates the data of a shape that its kind and sizes describe completely.
std::shared_ptr<ConvexShapeData> sized(ShapeKind kind, const Vector3d& size, double bounding_radius) {
  auto data = std::make_shared<ConvexShapeData>();
  data->support = {};
  data->support.kind = kind;
  std::copy(size.begin(), size.end(), data->support.size);
  data->support.bounding_radius = bounding_radius * rounded_up;
  return data;
}

/// Returns the mean of the vertices that are extreme along the coordinate axes.
Vector3d centre_of(std::span<const Vector3d> vertices) {
  Vector3d sum = Vector3d::Zero();
  constexpr double extremes = 6;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto [low, high] =
        std::minmax_element(vertices.begin(), vertices.end(),
                            [=](const Vector3d& p, const Vector3d& q) { return p[axis] < q[axis]; });
    sum += *low / extremes + *high / extremes;
  }
  return sum;
}

}  // namespace

ConvexShape ConvexShape::hull(std::span<const Vector3d> vertices) {
  if (vertices.empty())
    throw InputError("a convex hull needs at least one vertex");
  auto data = std::make_shared<ConvexShapeData>();
  double radius = 0;
  for (const Vector3d& vertex : vertices) {
    if (!vertex.allFinite())
      throw InputError(
          fmt::format("vertex {} is not finite", static_cast<std::size_t>(&vertex - vertices.data())));
    radius = std::max(radius, vertex.stableNorm());
    data->coordinates.push_back(vertex);
  }
  data->coordinates.fill_block();
  data->vertices.assign(vertices.begin(), vertices.end());
  data->cells = detail::direction_cells(vertices, radius);
  detail::SupportShape& support = data->support;
  support = {};
  support.kind = ShapeKind::hull;
  support.bounding_radius = radius * rounded_up;
  const Vector3d centre = centre_of(vertices);
  std::copy(centre.begin(), centre.end(), support.centre);
  support.vertices = data->coordinates.blocks();
  support.cells = {data->cells.resolution, data->cells.starts.data(), data->cells.coordinates.blocks(),
                   data->cells.indices.data()};
  return ConvexShape(std::move(data));
}

ConvexShape ConvexShape::cuboid(const Vector3d& sides) {
  for (const double side : sides)
    check_length(side, "a side of a cuboid");
  const Vector3d half = sides / 2;
  auto data = sized(ShapeKind::box, half, half.stableNorm());
  for (unsigned corner = 0; corner < 8; ++corner)
    data->vertices.emplace_back((corner & 1U) != 0 ? half.x() : -half.x(),
                                (corner & 2U) != 0 ? half.y() : -half.y(),
                                (corner & 4U) != 0 ? half.z() : -half.z());
  return ConvexShape(std::move(data));
}

ConvexShape ConvexShape::ball(double radius) {
  check_length(radius, "the radius of a ball");
  return ConvexShape(sized(ShapeKind::ball, {radius, 0, 0}, radius));
}

ConvexShape ConvexShape::cylinder(double radius, double height) {
  check_length(radius, "the radius of a cylinder");
  check_length(height, "the height of a cylinder");
  return ConvexShape(sized(ShapeKind::cylinder, {radius, height / 2, 0}, std::hypot(radius, height / 2)));
}

ConvexShape ConvexShape::cone(double radius, double height) {
  check_length(radius, "the radius of a cone");
  check_length(height, "the height of a cone");
  return ConvexShape(sized(ShapeKind::cone, {radius, height / 2, 0}, std::hypot(radius, height / 2)));
}

ConvexShape ConvexShape::rounded_cuboid(const Vector3d& core, double radius) {
  for (const double side : core)
    check_length(side, "a side of a rounded cuboid");
  check_radius(radius, "the radius of a rounded cuboid");
  const Vector3d half = core / 2;
  auto data = sized(ShapeKind::rounded_box, half, half.stableNorm() + radius);
  data->support.ends[0] = radius;
  return ConvexShape(std::move(data));
}

ConvexShape ConvexShape::ellipsoid(const Vector3d& semi_axes) {
  for (const double length : semi_axes)
    check_radius(length, "a semi-axis of an ellipsoid");
  const double largest = semi_axes.maxCoeff();
  auto data = sized(ShapeKind::ellipsoid, semi_axes, largest);
  for (Eigen::Index i = 0; i < 3; ++i)
    data->support.ends[i] = semi_axes[i] / largest;
  return ConvexShape(std::move(data));
}

ConvexShape ConvexShape::arc_piece(double inner_radius, double outer_radius, double height, double degrees) {
  check_length(inner_radius, "the inner radius of an arc");
  check_length(outer_radius, "the outer radius of an arc");
  check_length(height, "the height of an arc");
  if (inner_radius > outer_radius)
    throw InputError("the inner radius of an arc must not be above the outer one");
  constexpr double half_turn = 180;
  if (!(degrees > 0 && degrees < half_turn))
    throw InputError(fmt::format(
        "a convex piece of an arc must span more than 0 and less than 180 degrees, not {}", degrees));
  auto data = sized(ShapeKind::sector, {outer_radius, height / 2, inner_radius},
                    std::hypot(outer_radius, height / 2));
  const double angle = degrees / 2 * std::numbers::pi / half_turn;
  const double x = std::cos(angle), y = std::sin(angle);
  detail::SupportShape& support = data->support;
  support.ends[0] = support.ends[2] = x;
  support.ends[1] = -y;
  support.ends[3] = y;
  support.centre[0] = (inner_radius + outer_radius) / 2 * x;
  return ConvexShape(std::move(data));
}

bool ConvexShape::is_round() const {
  return data_->support.kind != ShapeKind::hull && data_->support.kind != ShapeKind::box;
}

}  // namespace fringe
