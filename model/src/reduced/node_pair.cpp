#include "reduced/node_pair.hpp"

#include <algorithm>
#include <cmath>

#include "bem/patch_distance.hpp"
#include "reduced/mesh_pair.hpp"
#include "reduced/node_rules.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Coordinate of padding points: beyond any distance that counts, but its square is finite.
constexpr float far_away = 1e12F;

/// Returns the logarithm of the sum of an ellipse's semi-axes, given the sum of the distances of one of its
/// points from the foci ±1.
double log_parameter(double sum) {
  return std::log((sum + std::sqrt(std::max(sum * sum - 4, 0.0))) / 2);
}

/// Computes the smoothness on a face for singularities at origin + axes·(scale·p), where p are the points.
FaceSmoothness face_smoothness(const PlacedBody& body, const ChargedFace& face, const NodePoints& points,
                               const Vector3d& origin, const Eigen::Matrix3d& axes, double scale) {
  const double half_u = face.half_u * body.scale, half_v = face.half_v * body.scale;
  const Vector3d u = body.axes * face.axis_u, v = body.axes * face.axis_v;
  const Eigen::Matrix3d to_face{{u.x() / half_u, u.y() / half_u, u.z() / half_u},
                                {v.x() / half_v, v.y() / half_v, v.z() / half_v},
                                {(u.y() * v.z() - u.z() * v.y()) / half_u,
                                 (u.z() * v.x() - u.x() * v.z()) / half_u,
                                 (u.x() * v.y() - u.y() * v.x()) / half_u}};
  const Vector3d offset = to_face * (origin - body.centre - body.axes * (body.scale * face.centre));
  const Eigen::Matrix3d rows = scale * to_face * axes;
  FaceMap map{};
  for (Eigen::Index row = 0; row < 3; ++row) {
    map.offset[row] = static_cast<float>(offset[row]);
    for (Eigen::Index column = 0; column < 3; ++column)
      map.rows[3 * row + column] = static_cast<float>(rows(row, column));
  }
  map.ratio = static_cast<float>(half_v / half_u);
  float least[2];
  best_kernels<NodeKernels>().ellipses(points, map, least);
  return {log_parameter(least[0]), log_parameter(least[1])};
}

/// Largest number of points along a direction of the outer face. With as many as on the inner one, a pair of
/// faces would take 16 million distances.
constexpr int most_outer_points = 32;

/// Returns the number of points that a rule for so many functions needs to reach so many digits, at most
/// `most`. `missing` grows to the digits that are not reached.
int points_for(double smoothness, double digits, int functions, int most, double& missing) {
  const double more = digits / (2 * std::max(smoothness, 1e-9));
  const double wanted = 1 + 0.5 * functions + more;
  if (wanted > most)
    missing = std::max(missing, digits * (wanted - most) / more);
  return std::min(static_cast<int>(std::ceil(std::min(wanted, 1e6))), most);
}

void narrow(FaceSmoothness& smoothness, const FaceSmoothness& other) {
  smoothness.u = std::min(smoothness.u, other.u);
  smoothness.v = std::min(smoothness.v, other.v);
}

/// The points where each edge of one body is nearest to each edge of the other, relative to the centre of b.
class NearestPoints {
 public:
  NearestPoints(const PlacedBody& a, const PlacedBody& b) {
    const auto edges_a = placed_edges(a, b.centre), edges_b = placed_edges(b, b.centre);
    std::size_t at = 0;
    for (const auto& edge : edges_a)
      for (const auto& other : edges_b) {
        const auto [part_a, part_b] = nearest_parts(edge[0], edge[1], other[0], other[1]);
        add(on_a_, at, edge[0] + part_a * (edge[1] - edge[0]));
        add(on_b_, at, other[0] + part_b * (other[1] - other[0]));
        ++at;
      }
    count_ = static_cast<std::ptrdiff_t>(at);
  }

  NodePoints on_a() const { return {on_a_[0].data(), on_a_[1].data(), on_a_[2].data(), count_}; }
  NodePoints on_b() const { return {on_b_[0].data(), on_b_[1].data(), on_b_[2].data(), count_}; }

 private:
  /// Coordinates for all pairs of edges: 4 · 4, 4 · 12 or 12 · 12, whole blocks.
  using Coordinates = std::array<std::array<float, 144>, 3>;

  static void add(Coordinates& to, std::size_t at, const Vector3d& point) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      to[axis][at] = static_cast<float>(point[static_cast<Eigen::Index>(axis)]);
  }

  Coordinates on_a_;
  Coordinates on_b_;
  std::ptrdiff_t count_;
};

/// Returns a face's rules that reach so many digits.
NodeGrid grid_of(const ChargedFace& face, const FaceSmoothness& smooth, int functions, double digits,
                 int most, double& missing) {
  return {functions, stored_rule(face.edge, points_for(smooth.u, digits, functions, most, missing)).view(),
          stored_rule(face.edge, points_for(smooth.v, digits, functions, most, missing)).view()};
}

}  // namespace

std::vector<std::array<Vector3d, 2>> placed_edges(const PlacedBody& body, const Vector3d& origin) {
  std::vector<std::array<Vector3d, 2>> edges = body.shape->edges();
  for (std::array<Vector3d, 2>& edge : edges)
    for (Vector3d& end : edge)
      end = body.centre - origin + body.axes * (body.scale * end);
  return edges;
}

PairSmoothness smoothness(const PlacedBody& a, const PlacedBody& b, double gap) {
  PairSmoothness result{};
  for (std::size_t k = 0; k < a.shape->faces().size(); ++k)
    result.a[k] = face_smoothness(a, a.shape->faces()[k], b.shape->edge_points(), b.centre, b.axes, b.scale);
  for (std::size_t k = 0; k < b.shape->faces().size(); ++k)
    result.b[k] = face_smoothness(b, b.shape->faces()[k], a.shape->edge_points(), a.centre, a.axes, a.scale);
  // Distance between the points on an edge, in scales of the body. Where edges pass each other more closely,
  // the points where they are nearest count, too.
  constexpr double points_apart = 0.25;
  if (gap < 1.5 * points_apart * std::max(a.scale, b.scale)) {
    const NearestPoints nearest(a, b);
    for (std::size_t k = 0; k < a.shape->faces().size(); ++k)
      narrow(result.a[k], face_smoothness(a, a.shape->faces()[k], nearest.on_b(), b.centre,
                                          Eigen::Matrix3d::Identity(), 1));
    for (std::size_t k = 0; k < b.shape->faces().size(); ++k)
      narrow(result.b[k], face_smoothness(b, b.shape->faces()[k], nearest.on_a(), b.centre,
                                          Eigen::Matrix3d::Identity(), 1));
  }
  return result;
}

double least(const BodySmoothness& smoothness, std::size_t faces) {
  double least = smoothness[0].u;
  for (std::size_t k = 0; k < faces; ++k)
    least = std::min({least, smoothness[k].u, smoothness[k].v});
  return least;
}

double error_left(double inner_digits) {
  /// Ratio of the potentials' error to what the digits promise, as measured in random poses.
  constexpr double share = 0.02;
  /// Relative rounding error of single precision.
  constexpr double rounding = 1e-6;
  return share * std::exp(-inner_digits) + rounding;
}

BodySmoothness smoothness_at(const PlacedBody& body, std::span<const NodePoints> points,
                             const Vector3d& origin) {
  BodySmoothness result{};
  for (std::size_t k = 0; k < body.shape->faces().size(); ++k) {
    const ChargedFace& face = body.shape->faces()[k];
    result[k] = face_smoothness(body, face, points[0], origin, Eigen::Matrix3d::Identity(), 1);
    for (const NodePoints& more : points.subspan(1))
      narrow(result[k], face_smoothness(body, face, more, origin, Eigen::Matrix3d::Identity(), 1));
  }
  return result;
}

std::ptrdiff_t NodeSide::choose_grids(const PlacedBody& body, int functions_along,
                                      const BodySmoothness& smooth, double digits, int most,
                                      double& missing) {
  functions = functions_along;
  grids.clear();
  std::ptrdiff_t nodes = 0;
  for (std::size_t k = 0; k < body.shape->faces().size(); ++k) {
    const NodeGrid& grid = grids.emplace_back(
        grid_of(body.shape->faces()[k], smooth[k], functions_along, digits, most, missing));
    nodes += grid.u.points * grid.v.points;
  }
  return nodes;
}

void NodeSide::lay(const PlacedBody& body, const Vector3d& origin) {
  count = 0;
  for (const NodeGrid& grid : grids)
    count += grid.u.points * grid.v.points;
  const auto room = static_cast<std::size_t>(whole_blocks(count) + 2 * node_block);
  if (x.size() < room)
    for (std::vector<float>* array : {&x, &y, &z, &charges, &potentials})
      array->resize(room);
  std::ptrdiff_t at = 0;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    const NodeGrid& grid = grids[k];
    const ChargedFace& face = body.shape->faces()[k];
    const Vector3d centre = body.centre + body.axes * (body.scale * face.centre) - origin;
    const Vector3d u = body.axes * (body.scale * face.half_u * face.axis_u);
    const Vector3d v = body.axes * (body.scale * face.half_v * face.axis_v);
    NodeFace placed{};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      placed.centre[axis] = static_cast<float>(centre[axis]);
      placed.u[axis] = static_cast<float>(u[axis]);
      placed.v[axis] = static_cast<float>(v[axis]);
    }
    best_kernels<NodeKernels>().lay(grid, placed, x.data() + at, y.data() + at, z.data() + at);
    at += grid.u.points * grid.v.points;
  }
  for (std::vector<float>* array : {&x, &y, &z})
    std::fill(array->begin() + count, array->begin() + whole_blocks(count), far_away);
}

void NodePair::place(const PlacedBody& a, const BodySmoothness& a_smoothness, int functions_a,
                     const PlacedBody& b, const BodySmoothness& b_smoothness, int functions_b, double gap,
                     QuadratureDigits digits) {
  if (a.shape->mesh() != nullptr || b.shape->mesh() != nullptr) {
    if (!mesh_)
      mesh_ = std::make_unique<MeshPair>();
    mesh_->place(a, functions_a, b, functions_b, gap,
                 a.shape->mesh() == nullptr ? a_smoothness : b_smoothness, digits);
    relative_error_ = mesh_->relative_error();
    is_cut_short_ = mesh_->is_cut_short();
    return;
  }
  double missing_a = 0, missing_b = 0;
  const std::ptrdiff_t outer_a =
      sides_[0].choose_grids(a, functions_a, a_smoothness, digits.outer, most_outer_points, missing_a);
  const std::ptrdiff_t outer_b =
      sides_[1].choose_grids(b, functions_b, b_smoothness, digits.outer, most_outer_points, missing_b);
  a_is_outer_ = missing_a != missing_b ? missing_a < missing_b : outer_a <= outer_b;
  if (!a_is_outer_)
    std::swap(sides_[0], sides_[1]);
  const PlacedBody &outer = a_is_outer_ ? a : b, &inner = a_is_outer_ ? b : a;
  centre_ = inner.centre;
  sides_[0].lay(outer, centre_);

  double missing_inner = 0;
  const NodePoints outer_points = sides_[0].points();
  sides_[1].choose_grids(inner, a_is_outer_ ? functions_b : functions_a,
                         smoothness_at(inner, {&outer_points, 1}, centre_), digits.inner, most_node_points,
                         missing_inner);
  const double missing_outer = std::min(missing_a, missing_b);
  relative_error_ = error_left(std::min(2 * (digits.outer - missing_outer), digits.inner - missing_inner));
  is_cut_short_ = missing_outer > 0 || missing_inner > 0;
  sides_[1].lay(inner, centre_);
  const std::size_t size =
      static_cast<std::size_t>(sides_[0].count) * static_cast<std::size_t>(whole_blocks(sides_[1].count));
  if (matrix_.size() < size)
    matrix_.resize(size);
  best_kernels<NodeKernels>().fill(sides_[0].points(), sides_[1].points(), matrix_.data());
}

void NodeSide::spread(const float* coefficients) {
  float* to = charges.data();
  for (const NodeGrid& grid : grids) {
    best_kernels<NodeKernels>().spread(grid, coefficients, to);
    to += grid.u.points * grid.v.points;
    coefficients += grid.functions * grid.functions;
  }
  std::fill(charges.begin() + count, charges.begin() + whole_blocks(count), 0.0F);
}

ChargedNodes NodeSide::charged(const Eigen::MatrixXf& coefficients) {
  ChargedNodes result{points(), Eigen::MatrixXf(count, coefficients.cols())};
  for (Eigen::Index column = 0; column < coefficients.cols(); ++column) {
    spread(coefficients.col(column).data());
    result.charges.col(column) = Eigen::Map<const Eigen::VectorXf>(charges.data(), count);
  }
  return result;
}

void NodeSide::gather(float* moments) const {
  const float* from = potentials.data();
  const std::ptrdiff_t square = functions * functions;
  for (const NodeGrid& grid : grids) {
    best_kernels<NodeKernels>().gather(grid, from, moments);
    from += grid.u.points * grid.v.points;
    moments += square;
  }
  const std::ptrdiff_t all = square * static_cast<std::ptrdiff_t>(grids.size());
  std::fill(moments, moments + whole_blocks(all) - all, 0.0F);
}

NodePair::NodePair() = default;
NodePair::~NodePair() = default;
NodePair::NodePair(NodePair&&) noexcept = default;
NodePair& NodePair::operator=(NodePair&&) noexcept = default;

void NodePair::potentials(const float* charges_a, const float* charges_b, float* moments_a,
                          float* moments_b) {
  if (mesh_) {
    mesh_->potentials(charges_a, charges_b, moments_a, moments_b);
    return;
  }
  NodeSide &outer = sides_[0], &inner = sides_[1];
  outer.spread(a_is_outer_ ? charges_a : charges_b);
  inner.spread(a_is_outer_ ? charges_b : charges_a);
  best_kernels<NodeKernels>().apply({matrix_.data(), outer.count, inner.count}, outer.charges.data(),
                                    inner.charges.data(), outer.potentials.data(), inner.potentials.data());
  outer.gather(a_is_outer_ ? moments_a : moments_b);
  inner.gather(a_is_outer_ ? moments_b : moments_a);
}

std::vector<Wrench> NodePair::forces(const Eigen::MatrixXf& charges_a, const Eigen::MatrixXf& charges_b) {
  if (mesh_)
    return mesh_->forces(charges_a, charges_b);
  NodeSide &outer = sides_[0], &inner = sides_[1];
  std::vector<Wrench> result = node_forces({matrix_.data(), outer.count, inner.count},
                                           outer.charged(a_is_outer_ ? charges_a : charges_b),
                                           inner.charged(a_is_outer_ ? charges_b : charges_a));
  for (Wrench& wrench : result)
    wrench =
        in_outer_frame((a_is_outer_ ? 1.0 : -1.0) * wrench, Eigen::Isometry3d(Eigen::Translation3d(centre_)));
  return result;
}

}  // namespace fringe::detail
