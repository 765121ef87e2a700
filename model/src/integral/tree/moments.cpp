#include "integral/tree/moments.hpp"

#include <algorithm>
#include <span>

#include "integral/tree/kernels.hpp"
#include "numeric/quadrature_rules.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
MonomialRows::MonomialRows(std::span<const WeightedPoint> points, const Eigen::Vector3d& centre,
                           const Eigen::Matrix3d& to_frame, int degree, Factor factor)
    : row_count_(monomial_count(degree)),
      stride_((points.size() + array_padding - 1) / array_padding * array_padding),
      rows_(new double[(row_count_ + 3) * stride_]) {
  double* const coordinates = rows_.get() + row_count_ * stride_;
  for (std::size_t j = 0; j < points.size(); ++j) {
    const Eigen::Vector3d point = to_frame * (points[j].position - centre);
    for (std::size_t axis = 0; axis < 3; ++axis)
      coordinates[axis * stride_ + j] = point[static_cast<Eigen::Index>(axis)];
    rows_[j] = factor == Factor::one ? 1 : points[j].weight;
  }
  for (std::size_t j = points.size(); j < stride_; ++j)
    for (double* const row : {rows_.get(), coordinates, coordinates + stride_, coordinates + 2 * stride_})
      row[j] = 0;
  const auto& kernels = best_kernels<TreeKernels>();
  for (std::size_t i = 1; i < row_count_; ++i)
    kernels.multiply(row(monomials[i].factor),
                     coordinates + static_cast<std::size_t>(monomials[i].axis) * stride_, stride_,
                     rows_.get() + i * stride_);
}

void MonomialRows::add_up(MonomialValues& sums) const {
  const auto& kernels = best_kernels<TreeKernels>();
  for (std::size_t i = 0; i < row_count_; ++i)
    sums[i] += kernels.sum(row(i), stride_);
}

namespace {

constexpr std::size_t powers = moment_degree + 1;

/// Indices of all monomials by their exponents, and the binomial coefficients.
struct Tables {
  std::array<std::array<std::array<std::size_t, powers>, powers>, powers> index{};
  std::array<std::array<double, powers>, powers> binomial{};
};

constexpr Tables make_tables() {
  Tables tables{};
  for (int a = 0; a <= moment_degree; ++a)
    for (int b = 0; a + b <= moment_degree; ++b)
      for (int c = 0; a + b + c <= moment_degree; ++c)
        tables.index[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)][static_cast<std::size_t>(c)] =
            monomial_index(a, b, c);
  for (std::size_t n = 0; n < powers; ++n) {
    tables.binomial[n][0] = 1;
    for (std::size_t k = 1; k <= n; ++k)
      tables.binomial[n][k] = tables.binomial[n - 1][k - 1] + (k < n ? tables.binomial[n - 1][k] : 0);
  }
  return tables;
}

constexpr Tables tables = make_tables();

/// Replaces moments by those of the same measure with every point translated by `shift` along the axis.
void shift_along(std::size_t axis, double shift, Moments& moments) {
  std::array<double, powers> shift_to{1};
  for (std::size_t k = 1; k < powers; ++k)
    shift_to[k] = shift_to[k - 1] * shift;
  // From high to low degree, so that the lower moments in each sum are still those of the untranslated
  // measure.
  for (std::size_t i = all_monomials; i-- > 0;) {
    std::array<std::size_t, 3> exponents{};
    for (std::size_t k = 0; k < 3; ++k)
      exponents[k] = static_cast<std::size_t>(monomials[i].exponents[k]);
    const std::size_t order = exponents[axis];
    double sum = 0;
    for (std::size_t k = 0; k <= order; ++k) {
      exponents[axis] = k;
      const double unshifted = moments[tables.index[exponents[0]][exponents[1]][exponents[2]]];
      sum += tables.binomial[order][k] * shift_to[order - k] * unshifted;
    }
    moments[i] = sum;
  }
}

}  // namespace

void append_rule(const Triangle& triangle, double area, std::vector<WeightedPoint>& points) {
  static const TriangleRule& rule = triangle_rule(highest_degree);
  for (const TriangleNode& node : std::span(rule.nodes, static_cast<std::size_t>(rule.points)))
    points.push_back({point_of(triangle, node), area * node.weight});
}

Moments moments_of(const std::vector<WeightedPoint>& points, const MomentFrame& frame) {
  // Number of points whose monomials fit into the fastest cache.
  constexpr std::size_t block = 48;
  Moments moments{};
  for (std::size_t first = 0; first < points.size(); first += block) {
    const std::span part = std::span(points).subspan(first, std::min(block, points.size() - first));
    MonomialRows(part, frame.centre, Eigen::Matrix3d::Identity() / frame.scale, moment_degree,
                 MonomialRows::Factor::weight)
        .add_up(moments);
  }
  return moments;
}

void add_translated(const Moments& part, const MomentFrame& part_frame, const MomentFrame& frame,
                    Moments& moments) {
  const double ratio = part_frame.scale / frame.scale;
  const Eigen::Vector3d shift = (part_frame.centre - frame.centre) / frame.scale;
  std::array<double, powers> ratio_to{1};
  for (std::size_t k = 1; k < powers; ++k)
    ratio_to[k] = ratio_to[k - 1] * ratio;
  Moments moved{};
  for (std::size_t i = 0; i < all_monomials; ++i)
    moved[i] = part[i] * ratio_to[static_cast<std::size_t>(monomials[i].degree)];
  for (std::size_t axis = 0; axis < 3; ++axis)
    shift_along(axis, shift[static_cast<Eigen::Index>(axis)], moved);
  for (std::size_t i = 0; i < all_monomials; ++i)
    moments[i] += moved[i];
}

}  // namespace fringe::detail
