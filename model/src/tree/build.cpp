#include "build.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "compression.hpp"
#include "moments.hpp"
#include "partition.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

SymmetricMatrix outer_product(const Vector3d& v, double factor) {
  return {{factor * v.x() * v.x(), factor * v.y() * v.y(), factor * v.z() * v.z(), factor * v.y() * v.z(),
           factor * v.z() * v.x(), factor * v.x() * v.y()}};
}

void add(SymmetricMatrix& sum, const SymmetricMatrix& term) {
  for (std::size_t i = 0; i < sum.entries.size(); ++i)
    sum.entries[i] += term.entries[i];
}

/// The integral of δδᵀ from the moments, in m⁴.
SymmetricMatrix second_moment(const Moments& moments, double scale) {
  const double squared = scale * scale;
  const auto moment = [&](int a, int b, int c) { return squared * moments[monomial_index(a, b, c)]; };
  return {
      {moment(2, 0, 0), moment(0, 2, 0), moment(0, 0, 2), moment(0, 1, 1), moment(1, 0, 1), moment(1, 1, 0)}};
}

Eigen::Matrix3d matrix(const SymmetricMatrix& symmetric) {
  const auto& [xx, yy, zz, yz, zx, xy] = symmetric.entries;
  Eigen::Matrix3d result;
  result << xx, xy, zx, xy, yy, yz, zx, yz, zz;
  return result;
}

/// Four points of equal weight with the area, the centroid and the second moments of the surface: a regular
/// tetrahedron stretched along the principal axes.
std::vector<WeightedPoint> tetrahedron_rule(const Vector3d& centre, double area, const Eigen::Matrix3d& axes,
                                            const Vector3d& variances) {
  const Eigen::Matrix3d stretch = axes * variances.cwiseMax(0).cwiseSqrt().asDiagonal();
  std::vector<WeightedPoint> points;
  for (const Vector3d& corner :
       {Vector3d(1, 1, 1), Vector3d(1, -1, -1), Vector3d(-1, 1, -1), Vector3d(-1, -1, 1)})
    points.push_back({centre + stretch * corner, area / 4});
  return points;
}

/// |δ|^(degree + 1) for the degree of each quadrature.
using RemainderMoments = std::array<double, quadrature_degrees.size()>;

RemainderMoments remainder_powers(double squared_distance) {
  static_assert(quadrature_degrees == std::array{2, 3, 5});
  const double fourth_power = squared_distance * squared_distance;
  return {squared_distance * std::sqrt(squared_distance), fourth_power, fourth_power * squared_distance};
}

class Builder {
 public:
  explicit Builder(std::span<const Triangle> triangles) : tree_(partition(triangles)) {}

  SurfaceNodes build() && {
    areas_.reserve(tree_.triangles.size());
    for (const Triangle& triangle : tree_.triangles)
      areas_.push_back(twice_area(triangle) / 2);
    moments_.resize(tree_.nodes.size());
    frames_.resize(tree_.nodes.size());
    rules_.resize(tree_.nodes.size());
    for (std::size_t i = tree_.nodes.size(); i-- > 0;) {
      Node& node = tree_.nodes[i];
      set_size(node);
      set_normals(node);
      set_moments(i);
      set_quadratures(i);
      if (node.first_child == no_child)
        set_trianglewise(node);
    }
    return {std::move(tree_.nodes), TriangleBatch(tree_.triangles), std::move(points_)};
  }

 private:
  void set_size(Node& node) {
    const auto& [first, count] = node.triangles;
    Vector3d weighted = Vector3d::Zero();
    for (std::size_t i = first; i < first + count; ++i) {
      const auto& [a, b, c] = tree_.triangles[i];
      node.area += areas_[i];
      weighted += areas_[i] * (a / 3 + b / 3 + c / 3);
    }
    node.centre = weighted / node.area;
    double squared = 0;
    for (std::size_t i = first; i < first + count; ++i)
      for (const Vector3d& vertex : tree_.triangles[i])
        squared = std::max(squared, (vertex - node.centre).squaredNorm());
    node.radius = std::sqrt(squared);
  }

  void set_normals(Node& node) {
    const auto& [first, count] = node.triangles;
    Vector3d sum = Vector3d::Zero();
    const auto doubled_normal = [&](std::size_t i) -> Vector3d {
      const auto& [a, b, c] = tree_.triangles[i];
      return (b - a).cross(c - a);
    };
    for (std::size_t i = first; i < first + count; ++i)
      sum += doubled_normal(i);
    if (!(sum.norm() > 0))
      return;
    node.normals.axis = sum.normalized();
    double cosine = 1;
    for (std::size_t i = first; i < first + count; ++i) {
      const Vector3d normal = doubled_normal(i);
      cosine = std::min(cosine, normal.norm() > 0 ? node.normals.axis.dot(normal.normalized()) : -1.0);
    }
    node.normals.cosine = cosine;
  }

  void set_moments(std::size_t index) {
    const Node& node = tree_.nodes[index];
    frames_[index] = {node.centre, node.radius};
    moments_[index] = {};
    if (node.first_child != no_child) {
      for (const std::size_t child : {node.first_child, node.first_child + 1})
        add_translated(moments_[child], frames_[child], frames_[index], moments_[index]);
      return;
    }
    add_points(rule_points(node), frames_[index], moments_[index]);
  }

  /// The points of a rule of degree 5 on each triangle of a leaf.
  std::vector<WeightedPoint> rule_points(const Node& node) const {
    std::vector<WeightedPoint> points;
    for (std::size_t i = node.triangles.first; i < node.triangles.first + node.triangles.count; ++i)
      append_rule(tree_.triangles[i], areas_[i], points);
    return points;
  }

  void set_quadratures(std::size_t index) {
    Node& node = tree_.nodes[index];
    node.second_moment = second_moment(moments_[index], frames_[index].scale);
    const Eigen::Matrix3d covariance = matrix(node.second_moment);
    node.squared_radius_moment = covariance.trace();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(covariance / node.area);
    const CompressionFrame frame{node.centre, principal.eigenvectors(), node.radius};
    rules_[index] = compress(node.first_child == no_child ? rule_points(node) : points_of_children(node),
                             frame, highest_degree);
    const RemainderMoments moments = remainder_moments(node);
    for (std::size_t step = 0; step < moments.size(); ++step)
      node.quadratures[step].remainder = moments[step];
    set_quadrature(index, 0, tetrahedron_rule(node.centre, node.area, frame.axes, principal.eigenvalues()));
    set_quadrature(index, 1, compress(rules_[index], frame, quadrature_degrees[1]));
    set_quadrature(index, 2, rules_[index]);
  }

  std::vector<WeightedPoint> points_of_children(const Node& node) {
    std::vector<WeightedPoint> points = std::move(rules_[node.first_child]);
    const std::vector<WeightedPoint> others = std::move(rules_[node.first_child + 1]);
    points.insert(points.end(), others.begin(), others.end());
    return points;
  }

  void set_quadrature(std::size_t index, std::size_t step, const std::vector<WeightedPoint>& points) {
    Node& node = tree_.nodes[index];
    Quadrature& quadrature = node.quadratures[step];
    quadrature.degree = quadrature_degrees[step];
    for (const WeightedPoint& point : points)
      node.radius = std::max(node.radius, (point.position - node.centre).norm());
    bound_errors(index, step, points);
    quadrature.points = store(points);
  }

  void bound_errors(std::size_t index, std::size_t step, const std::vector<WeightedPoint>& points) {
    Node& node = tree_.nodes[index];
    Quadrature& quadrature = node.quadratures[step];
    const MomentFrame& frame = frames_[index];
    const std::size_t count = monomial_count(quadrature.degree);
    Moments left = moments_[index];
    MonomialValues values{};
    for (const auto& [position, weight] : points) {
      const Vector3d offset = position - node.centre;
      evaluate_monomials(offset / frame.scale, quadrature.degree, values);
      for (std::size_t i = 0; i < count; ++i)
        left[i] -= weight * values[i];
      quadrature.remainder += std::abs(weight) * remainder_powers(offset.squaredNorm())[step];
      if (weight < 0)
        add(node.second_moment, outer_product(offset, -weight));
    }
    for (std::size_t i = 0; i < count; ++i)
      quadrature.mismatch[static_cast<std::size_t>(monomials[i].degree)] +=
          monomials[i].multinomial * std::abs(left[i]) * std::pow(frame.scale, monomials[i].degree);
    for (std::size_t i = 0; i < 3; ++i)
      node.second_moment.entries[i] += quadrature.mismatch[2];
  }

  /// For each quadrature at least ∫|δ|^(degree + 1) dA: the power of a distance is convex, so its mean over a
  /// triangle is at most that of its corners.
  RemainderMoments remainder_moments(const Node& node) const {
    RemainderMoments sums{};
    for (std::size_t i = node.triangles.first; i < node.triangles.first + node.triangles.count; ++i) {
      for (const Vector3d& vertex : tree_.triangles[i]) {
        const RemainderMoments powers = remainder_powers((vertex - node.centre).squaredNorm());
        for (std::size_t step = 0; step < sums.size(); ++step)
          sums[step] += areas_[i] / 3 * powers[step];
      }
    }
    return sums;
  }

  void set_trianglewise(Node& node) {
    TrianglewiseQuadrature& quadrature = node.trianglewise;
    std::vector<WeightedPoint> points;
    for (std::size_t i = node.triangles.first; i < node.triangles.first + node.triangles.count; ++i) {
      const Triangle& triangle = tree_.triangles[i];
      const Vector3d centroid = triangle[0] / 3 + triangle[1] / 3 + triangle[2] / 3;
      quadrature.reach = std::max(quadrature.reach, (centroid - node.centre).norm());
      for (const Vector3d& vertex : triangle) {
        // The rule of degree 2 with its points half way between centroid and corners: |δ|³ there is an eighth
        // of that at the corner, and δδᵀ a quarter. The integral of δδᵀ is the rule's own.
        const Vector3d offset = vertex - centroid;
        const double distance = offset.norm();
        points.push_back({centroid + offset / 2, areas_[i] / 3});
        quadrature.remainder += areas_[i] / 3 * (1 + 1.0 / 8) * distance * distance * distance;
        quadrature.largest_radius = std::max(quadrature.largest_radius, distance);
        add(quadrature.second_moment, outer_product(offset, areas_[i] / 12));
      }
    }
    quadrature.points = store(points);
  }

  Range store(const std::vector<WeightedPoint>& points) {
    const Range range{points_.x.size(), points.size()};
    for (const auto& [position, weight] : points) {
      points_.x.push_back(position.x());
      points_.y.push_back(position.y());
      points_.z.push_back(position.z());
      points_.weight.push_back(weight);
    }
    return range;
  }

  Partition tree_;
  PointArrays points_;
  std::vector<double> areas_;
  std::vector<Moments> moments_;
  std::vector<MomentFrame> frames_;
  std::vector<std::vector<WeightedPoint>> rules_;
};

}  // namespace

SurfaceNodes build_nodes(std::span<const Triangle> triangles) {
  return Builder(triangles).build();
}

}  // namespace fringe::detail
