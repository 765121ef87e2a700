#include "node_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "node_rules.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Beyond any distance that counts; its square is finite.
constexpr float far_away = 1e15F;

/// The sum of the semi-axes of an ellipse by the sum of the distances of one of its points from the foci ±1.
double log_parameter(double sum) {
  return std::log((sum + std::sqrt(std::max(sum * sum - 4, 0.0))) / 2);
}

/// Collects the narrowest ellipses about a face's directions through the singularities that points make.
class Ellipses {
 public:
  Ellipses(const PlacedShape3& body, const Face& face)
      : half_u_(face.half_u * body.scale), half_v_(face.half_v * body.scale),
        centre_(body.centre + body.axes * (body.scale * face.centre)), axis_u_(body.axes * face.axis_u),
        axis_v_(body.axes * face.axis_v), normal_(axis_u_.cross(axis_v_)) {}

  void add(const Vector3d& point) {
    const Vector3d offset = point - centre_;
    const double x = offset.dot(axis_u_), y = offset.dot(axis_v_), z = offset.dot(normal_);
    const double beside_u = std::max(std::abs(x) - half_u_, 0.0);
    const double beside_v = std::max(std::abs(y) - half_v_, 0.0);
    const auto sum = [](double at, double square) {
      return std::sqrt((at - 1) * (at - 1) + square) + std::sqrt((at + 1) * (at + 1) + square);
    };
    least_u_ = std::min(least_u_, sum(x / half_u_, (z * z + beside_v * beside_v) / (half_u_ * half_u_)));
    least_v_ = std::min(least_v_, sum(y / half_v_, (z * z + beside_u * beside_u) / (half_v_ * half_v_)));
  }

  FaceSmoothness smoothness() const { return {log_parameter(least_u_), log_parameter(least_v_)}; }

 private:
  double half_u_;
  double half_v_;
  Vector3d centre_;
  Vector3d axis_u_;
  Vector3d axis_v_;
  Vector3d normal_;
  double least_u_ = std::numeric_limits<double>::max();
  double least_v_ = std::numeric_limits<double>::max();
};

/// The points that win so many digits, of a rule for so many functions.
int points_for(double smoothness, double digits, int functions, double& missing) {
  const double more = digits / (2 * std::max(smoothness, 1e-9));
  const double wanted = 1 + 0.5 * functions + more;
  if (wanted > most_node_points)
    missing = std::max(missing, digits * (wanted - most_node_points) / more);
  return std::min(static_cast<int>(std::ceil(std::min(wanted, 1e6))), most_node_points);
}

}  // namespace

BodySmoothness smoothness(const PlacedShape3& body, const PlacedShape3& other) {
  BodySmoothness result{};
  for (std::size_t k = 0; k < body.shape->faces().size(); ++k) {
    Ellipses ellipses(body, body.shape->faces()[k]);
    for (const Vector3d& point : other.shape->edge_points())
      ellipses.add(other.centre + other.axes * (other.scale * point));
    result[k] = ellipses.smoothness();
  }
  return result;
}

double least(const BodySmoothness& smoothness, std::size_t faces) {
  double least = smoothness[0].u;
  for (std::size_t k = 0; k < faces; ++k)
    least = std::min({least, smoothness[k].u, smoothness[k].v});
  return least;
}

void NodePair::lay(Side& side, const PlacedShape3& body, const Vector3d& origin) {
  side.count = 0;
  for (const NodeGrid& grid : side.grids)
    side.count += grid.u.points * grid.v.points;
  const auto room = static_cast<std::size_t>(whole_blocks(side.count) + 2 * node_block);
  if (side.x.size() < room)
    for (std::vector<float>* array : {&side.x, &side.y, &side.z, &side.charges, &side.potentials})
      array->resize(room);
  std::size_t at = 0;
  for (std::size_t k = 0; k < side.grids.size(); ++k) {
    const NodeGrid& grid = side.grids[k];
    const Face& face = body.shape->faces()[k];
    const Eigen::VectorXd& along_u = stored_rule(face.edge, grid.u.points).nodes;
    const Eigen::VectorXd& along_v = stored_rule(face.edge, grid.v.points).nodes;
    const Vector3d centre = body.centre + body.axes * (body.scale * face.centre) - origin;
    const Vector3d u = body.axes * (body.scale * face.half_u * face.axis_u);
    const Vector3d v = body.axes * (body.scale * face.half_v * face.axis_v);
    for (int i = 0; i < grid.u.points; ++i) {
      const Vector3d line = centre + along_u[i] * u;
      for (int j = 0; j < grid.v.points; ++j, ++at) {
        side.x[at] = static_cast<float>(line.x() + along_v[j] * v.x());
        side.y[at] = static_cast<float>(line.y() + along_v[j] * v.y());
        side.z[at] = static_cast<float>(line.z() + along_v[j] * v.z());
      }
    }
  }
  for (; at < room; ++at) {
    side.x[at] = far_away;
    side.y[at] = side.z[at] = 0;
  }
}

void NodePair::place(const PlacedShape3& a, const BodySmoothness& a_smoothness, int functions_a,
                     const PlacedShape3& b, const BodySmoothness& b_smoothness, int functions_b,
                     QuadratureDigits digits) {
  missing_digits_ = 0;
  const auto grids_of = [&](Side& side, const PlacedShape3& body, int functions,
                            const BodySmoothness& smooth, double wanted, double& missing) {
    side.functions = functions;
    side.grids.clear();
    int count = 0;
    for (std::size_t k = 0; k < body.shape->faces().size(); ++k) {
      const EdgeKind edge = body.shape->faces()[k].edge;
      const NodeGrid grid{functions,
                          stored_rule(edge, points_for(smooth[k].u, wanted, functions, missing)).view(),
                          stored_rule(edge, points_for(smooth[k].v, wanted, functions, missing)).view()};
      count += grid.u.points * grid.v.points;
      side.grids.push_back(grid);
    }
    return count;
  };
  double missing_a = 0, missing_b = 0;
  const int outer_a = grids_of(sides_[0], a, functions_a, a_smoothness, digits.outer, missing_a);
  const int outer_b = grids_of(sides_[1], b, functions_b, b_smoothness, digits.outer, missing_b);
  a_is_outer_ = missing_a != missing_b ? missing_a < missing_b : outer_a <= outer_b;
  if (!a_is_outer_)
    std::swap(sides_[0], sides_[1]);
  const PlacedShape3 &outer = a_is_outer_ ? a : b, &inner = a_is_outer_ ? b : a;
  missing_digits_ = std::min(missing_a, missing_b);
  lay(sides_[0], outer, inner.centre);

  BodySmoothness seen{};
  for (std::size_t k = 0; k < inner.shape->faces().size(); ++k) {
    Ellipses ellipses({inner.shape, inner.scale, Vector3d::Zero(), inner.axes}, inner.shape->faces()[k]);
    for (std::size_t node = 0; node < static_cast<std::size_t>(sides_[0].count); ++node)
      ellipses.add({sides_[0].x[node], sides_[0].y[node], sides_[0].z[node]});
    seen[k] = ellipses.smoothness();
  }
  grids_of(sides_[1], inner, a_is_outer_ ? functions_b : functions_a, seen, digits.inner, missing_digits_);
  lay(sides_[1], inner, inner.centre);
  const std::size_t size =
      static_cast<std::size_t>(sides_[0].count) * static_cast<std::size_t>(whole_blocks(sides_[1].count));
  if (matrix_.size() < size)
    matrix_.resize(size);
  const auto points = [](const Side& side) {
    return NodePoints{side.x.data(), side.y.data(), side.z.data(), side.count};
  };
  best_node_kernels().fill(points(sides_[0]), points(sides_[1]), matrix_.data());
}

void NodePair::spread(Side& side, const float* coefficients) {
  float* to = side.charges.data();
  for (const NodeGrid& grid : side.grids) {
    best_node_kernels().spread(grid, coefficients, to);
    to += grid.u.points * grid.v.points;
    coefficients += grid.functions * grid.functions;
  }
  const auto end = static_cast<std::ptrdiff_t>(side.count);
  std::fill(side.charges.begin() + end, side.charges.begin() + whole_blocks(side.count), 0.0F);
}

void NodePair::gather(const Side& side, float* moments) {
  const float* from = side.potentials.data();
  const int square = side.functions * side.functions;
  for (const NodeGrid& grid : side.grids) {
    best_node_kernels().gather(grid, from, moments);
    from += grid.u.points * grid.v.points;
    moments += square;
  }
  const int count = square * static_cast<int>(side.grids.size());
  std::fill(moments, moments + whole_blocks(count) - count, 0.0F);
}

void NodePair::potentials(const float* charges_a, const float* charges_b, float* moments_a, float* moments_b) {
  Side &outer = sides_[0], &inner = sides_[1];
  spread(outer, a_is_outer_ ? charges_a : charges_b);
  spread(inner, a_is_outer_ ? charges_b : charges_a);
  best_node_kernels().apply({matrix_.data(), outer.count, inner.count}, outer.charges.data(),
                            inner.charges.data(), outer.potentials.data(), inner.potentials.data());
  gather(outer, a_is_outer_ ? moments_a : moments_b);
  gather(inner, a_is_outer_ ? moments_b : moments_a);
}

}  // namespace fringe::detail
