#include "integral/tree/build.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "geometry/box_tree.hpp"
#include "integral/tree/compression.hpp"
#include "integral/tree/moments.hpp"

namespace fringe::detail {
namespace {

struct Centroid {
  Eigen::Vector3d position;
  std::uint32_t triangle;
};

}  // namespace

Partition partition(std::span<const Triangle> triangles) {
  Partition tree;
  std::vector<Centroid> centroids;
  centroids.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (twice_area(triangles[i]) > 0)
      centroids.push_back(
          {triangles[i][0] / 3 + triangles[i][1] / 3 + triangles[i][2] / 3, static_cast<std::uint32_t>(i)});
  if (centroids.empty())
    return tree;
  tree.nodes.push_back({.triangles = {0, centroids.size()}});
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const Range range = tree.nodes[i].triangles;
    if (range.count <= most_triangles_in_leaf)
      continue;
    const std::size_t half = range.count / 2;
    split_at_median(
        std::span(centroids).subspan(range.first, range.count), half,
        [](const Centroid& centroid) -> const Eigen::Vector3d& { return centroid.position; },
        [](const Centroid& centroid) { return centroid.triangle; });
    tree.nodes[i].first_child = tree.nodes.size();
    tree.nodes.push_back({.triangles = {range.first, half}});
    tree.nodes.push_back({.triangles = {range.first + half, range.count - half}});
  }
  tree.triangles.reserve(centroids.size());
  for (const Centroid& centroid : centroids)
    tree.triangles.push_back(triangles[centroid.triangle]);
  return tree;
}

namespace {

using Eigen::Vector3d;

/// Computes the Frobenius norms of the homogeneous forms in the Taylor expansion of 1/distance, as symmetric
/// tensors: √((2k − 1)!!/k!) for degree k (model/NUMERICS.md, section 11).
std::array<double, moment_degree + 1> form_norms() {
  std::array<double, moment_degree + 1> norms{};
  double squared = 1;
  for (std::size_t k = 0; k < norms.size(); ++k) {
    norms[k] = std::sqrt(squared);
    squared *= static_cast<double>(2 * k + 1) / static_cast<double>(k + 1);
  }
  return norms;
}

/// Extracts the second moments ∫δδᵀ from all moments.
SymmetricMatrix second_moment(const Moments& moments) {
  const auto moment = [&](int a, int b, int c) { return moments[monomial_index(a, b, c)]; };
  return {
      {moment(2, 0, 0), moment(0, 2, 0), moment(0, 0, 2), moment(0, 1, 1), moment(1, 0, 1), moment(1, 1, 0)}};
}

/// Computes ∫|δ|⁶ from the moments.
double sixth_power(const Moments& moments) {
  double sum = 0;
  for (int a = 0; a <= 3; ++a)
    for (int b = 0; a + b <= 3; ++b) {
      constexpr std::array<double, 4> factorial{1, 1, 2, 6};
      const int c = 3 - a - b;
      sum += 6 /
             (factorial[static_cast<std::size_t>(a)] * factorial[static_cast<std::size_t>(b)] *
              factorial[static_cast<std::size_t>(c)]) *
             moments[monomial_index(2 * a, 2 * b, 2 * c)];
    }
  return sum;
}

double seventh_power(const Vector3d& offset) {
  static_assert(moment_degree + 1 == 7);
  const double squared = offset.squaredNorm();
  return squared * squared * squared * std::sqrt(squared);
}

Eigen::Matrix3d matrix(const SymmetricMatrix& symmetric) {
  const auto& [xx, yy, zz, yz, zx, xy] = symmetric.entries;
  Eigen::Matrix3d result;
  result << xx, xy, zx, xy, yy, yz, zx, yz, zz;
  return result;
}

/// Returns four points of equal weight with the area, the centroid and the second moments of the surface: a
/// regular tetrahedron stretched along the principal axes.
std::vector<WeightedPoint> tetrahedron_rule(const Vector3d& centre, double area, const Eigen::Matrix3d& axes,
                                            const Vector3d& variances) {
  const Eigen::Matrix3d stretch = axes * variances.cwiseMax(0).cwiseSqrt().asDiagonal();
  std::vector<WeightedPoint> points;
  for (const Vector3d& corner :
       {Vector3d(1, 1, 1), Vector3d(1, -1, -1), Vector3d(-1, 1, -1), Vector3d(-1, -1, 1)})
    points.push_back({centre + stretch * corner, area / 4});
  return points;
}

void append(const std::vector<WeightedPoint>& points, PointArrays& arrays) {
  for (const auto& [position, weight] : points) {
    arrays.x.push_back(position.x());
    arrays.y.push_back(position.y());
    arrays.z.push_back(position.z());
    arrays.weight.push_back(weight);
  }
}

/// Bounds the difference between two means of the expansion's form of degree 3: over a triangle, and over the
/// points halfway from its centroid to its corners. With aᵢ the vectors from the centroid to the corners, the
/// tensors differ by Σaᵢ⊗aᵢ⊗aᵢ/120; `products` are aᵢ·aⱼ.
double cubic_mismatch(const Eigen::Array33d& products) {
  return std::sqrt(2.5 * std::max(products.cube().sum(), 0.0)) / 120;
}

/// Computes the sum of two means of |δ|⁴: over the triangle, and over the points.
double fourth_powers(const Eigen::Array33d& products) {
  const Eigen::Array3d squares = products.matrix().diagonal().array();
  return (squares.sum() * squares.sum() + 2 * products.square().sum()) / 180 + squares.square().sum() / 48;
}

/// The data of a node that its parent needs.
struct Part {
  MomentFrame frame;
  Moments moments{};                ///< moments, computed by the rule of degree 5 on every triangle
  double sixth_error = 0;           ///< m²; bound of the error of the moments of degree 6, as a tensor norm
  std::vector<WeightedPoint> rule;  ///< the node's quadrature of the highest degree
};

class Builder {
 public:
  explicit Builder(std::span<const Triangle> triangles) : tree_(partition(triangles)) {}

  SurfaceNodes build() && {
    prepare_triangles();
    if (!tree_.nodes.empty())
      build_part(0);
    return {std::move(tree_.nodes), TriangleBatch(tree_.triangles), std::move(points_),
            std::move(triangle_points_)};
  }

 private:
  void prepare_triangles() {
    areas_.reserve(tree_.triangles.size());
    centroids_.reserve(tree_.triangles.size());
    normals_.reserve(tree_.triangles.size());
    for (const Triangle& triangle : tree_.triangles) {
      const auto& [a, b, c] = triangle;
      areas_.push_back(twice_area(triangle) / 2);
      centroids_.emplace_back(a / 3 + b / 3 + c / 3);
      normals_.emplace_back((b - a).cross(c - a).stableNormalized());
      std::vector<WeightedPoint> points;
      for (const Vector3d& vertex : triangle)
        points.push_back({(centroids_.back() + vertex) / 2, areas_.back() / 3});
      append(points, triangle_points_);
    }
  }

  Part build_part(std::size_t index) {
    set_size(tree_.nodes[index]);
    set_normals(tree_.nodes[index]);
    return tree_.nodes[index].first_child == no_child ? build_leaf(tree_.nodes[index])
                                                      : build_inner(tree_.nodes[index]);
  }

  /// Sets the quadratures of a leaf, whose moments come from a rule on each triangle.
  Part build_leaf(Node& leaf) {
    Part part;
    part.frame = {leaf.centre, leaf.radius};
    std::vector<WeightedPoint> candidates = rule_points(leaf);
    part.moments = moments_of(candidates, part.frame);
    for (std::size_t i = leaf.triangles.first; i < leaf.triangles.first + leaf.triangles.count; ++i) {
      double squared = 0;
      for (const Vector3d& vertex : tree_.triangles[i])
        squared = std::max(squared, ((vertex - centroids_[i]) / leaf.radius).squaredNorm());
      // The rule of degree 5 has positive weights and points inside the triangle. For a form bounded by |δ|⁶,
      // both its sum and the integral are therefore at most the largest |δ|⁶ times the area.
      part.sixth_error += 2 * areas_[i] * squared * squared * squared;
    }
    finish(leaf, std::move(candidates), part);
    set_trianglewise(leaf);
    return part;
  }

  /// Sets the quadratures of an inner node, whose moments come from those of its children by translation.
  Part build_inner(Node& node) {
    Part part;
    part.frame = {node.centre, node.radius};
    std::vector<WeightedPoint> candidates;
    for (const std::size_t child : {node.first_child, node.first_child + 1}) {
      const Part below = build_part(child);
      add_translated(below.moments, below.frame, part.frame, part.moments);
      part.sixth_error += below.sixth_error * std::pow(below.frame.scale / part.frame.scale, 6);
      candidates.insert(candidates.end(), below.rule.begin(), below.rule.end());
    }
    finish(node, std::move(candidates), part);
    return part;
  }

  /// Sets the node's area, centroid and radius.
  void set_size(Node& node) const {
    const auto& [first, count] = node.triangles;
    Vector3d weighted = Vector3d::Zero();
    for (std::size_t i = first; i < first + count; ++i) {
      node.area += areas_[i];
      weighted += areas_[i] * centroids_[i];
    }
    node.centre = weighted / node.area;
    double squared = 0;
    for (std::size_t i = first; i < first + count; ++i)
      for (const Vector3d& vertex : tree_.triangles[i])
        squared = std::max(squared, (vertex - node.centre).squaredNorm());
    node.radius = std::sqrt(squared);
  }

  /// Sets the cone of the node's normals.
  void set_normals(Node& node) const {
    const auto& [first, count] = node.triangles;
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = first; i < first + count; ++i)
      sum += areas_[i] / node.area * normals_[i];
    if (!(sum.norm() > 0))
      return;
    node.normals.axis = sum.normalized();
    double cosine = 1;
    for (std::size_t i = first; i < first + count; ++i)
      cosine = std::min(cosine, normals_[i].isZero(0) ? -1.0 : node.normals.axis.dot(normals_[i]));
    node.normals.cosine = cosine;
  }

  /// Returns the points of a rule of degree 5 on each triangle of a leaf.
  std::vector<WeightedPoint> rule_points(const Node& leaf) const {
    std::vector<WeightedPoint> points;
    for (std::size_t i = leaf.triangles.first; i < leaf.triangles.first + leaf.triangles.count; ++i)
      append_rule(tree_.triangles[i], areas_[i], points);
    return points;
  }

  /// Sets the quadratures of a node whose moments are known.
  void finish(Node& node, std::vector<WeightedPoint> candidates, Part& part) {
    const SymmetricMatrix squares = second_moment(part.moments);
    for (std::size_t i = 0; i < squares.entries.size(); ++i)
      node.second_moment.entries[i] = squares.entries[i] / node.area;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(matrix(node.second_moment));
    const CompressionFrame frame{node.centre, principal.eigenvectors(), node.radius};
    static_assert(quadrature_degrees == std::array{1, 2, 3, highest_degree});
    set_quadrature(node, part, 0, {{node.centre, node.area}});
    set_quadrature(node, part, 1,
                   tetrahedron_rule(node.centre, node.area, frame.axes,
                                    node.radius * node.radius * principal.eigenvalues()));
    if (node.first_child == no_child && tree_.nodes.size() > 1) {
      // A leaf gets no quadratures of degree 3 and higher: the points of its triangles cost hardly more, and
      // compressing them would take half of the time of building.
      for (const std::size_t step : {2U, 3U})
        node.errors.remainder[step] = std::numeric_limits<double>::infinity();
      part.rule = std::move(candidates);
      return;
    }
    part.rule = compress(candidates, frame, highest_degree);
    set_quadrature(node, part, 2, compress(part.rule, frame, 3));
    set_quadrature(node, part, 3, part.rule);
  }

  /// Stores a quadrature of a node with the bounds of its error.
  void set_quadrature(Node& node, const Part& part, std::size_t step,
                      const std::vector<WeightedPoint>& points) {
    static const std::array<double, moment_degree + 1> norms = form_norms();
    // If the rule reproduces a moment exactly, the difference is rounding noise.
    const Moments moments = moments_of(points, part.frame);
    std::array<double, moment_degree + 1> squared{};
    for (std::size_t i = 0; i < all_monomials; ++i) {
      const double difference = (part.moments[i] - moments[i]) / node.area;
      squared[static_cast<std::size_t>(monomials[i].degree)] +=
          monomials[i].multinomial * difference * difference;
    }
    for (std::size_t k = 0; k <= moment_degree; ++k)
      node.errors.mismatch[k][step] = norms[k] * std::sqrt(squared[k]);
    node.errors.mismatch[moment_degree][step] += part.sixth_error / node.area;
    double remainder = sixth_power(part.moments) + part.sixth_error;
    for (const auto& [position, weight] : points) {
      const Vector3d offset = (position - node.centre) / node.radius;
      remainder += std::abs(weight) * seventh_power(offset);
      if (weight < 0)
        subtract_product(node.second_moment, offset, weight / node.area);
    }
    node.errors.remainder[step] = remainder / node.area;
    node.smallest_remainder = step == 0 ? node.errors.remainder[step]
                                        : std::min(node.smallest_remainder, node.errors.remainder[step]);
    // Adds the Frobenius norm of the mismatch M of degree 2, which bounds nᵀMn. The rule of degree 1, the
    // centre alone, has no second moment.
    if (step > 0)
      for (std::size_t i = 0; i < 3; ++i)
        node.second_moment.entries[i] += std::sqrt(squared[2]);
    node.quadratures[step] = {points_.x.size(), points.size()};
    append(points, points_);
  }

  static void subtract_product(SymmetricMatrix& sum, const Vector3d& v, double factor) {
    const std::array<double, 6> product{v.x() * v.x(), v.y() * v.y(), v.z() * v.z(),
                                        v.y() * v.z(), v.z() * v.x(), v.x() * v.y()};
    for (std::size_t i = 0; i < product.size(); ++i)
      sum.entries[i] -= factor * product[i];
  }

  /// Sets the bounds of the errors of the triangles' quadratures.
  void set_trianglewise(Node& leaf) const {
    TrianglewiseErrors& errors = leaf.trianglewise;
    for (std::size_t i = leaf.triangles.first; i < leaf.triangles.first + leaf.triangles.count; ++i) {
      errors.reach = std::max(errors.reach, (centroids_[i] - leaf.centre).norm());
      Eigen::Matrix3d offsets;
      for (Eigen::Index k = 0; k < 3; ++k)
        offsets.col(k) = (tree_.triangles[i][static_cast<std::size_t>(k)] - centroids_[i]) / leaf.radius;
      const Eigen::Array33d products = offsets.transpose() * offsets;
      const double share = areas_[i] / leaf.area;
      errors.largest_radius =
          std::max(errors.largest_radius, leaf.radius * std::sqrt(products.matrix().diagonal().maxCoeff()));
      errors.mismatch += share * cubic_mismatch(products);
      errors.remainder += share * fourth_powers(products);
    }
  }

  Partition tree_;
  PointArrays points_, triangle_points_;
  std::vector<double> areas_;
  std::vector<Vector3d> centroids_;
  std::vector<Vector3d> normals_;  ///< unit vectors, or 0 for a triangle whose normal is unknown
};

}  // namespace

SurfaceNodes build_nodes(std::span<const Triangle> triangles) {
  return Builder(triangles).build();
}

}  // namespace fringe::detail
