#include "correction/outside_potentials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "bem/panel.hpp"
#include "bem/panel_pair.hpp"
#include "numeric/parallel.hpp"
#include "reduced/node_kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::Vector3d;

/// Largest ratios of a part's radius to its distance at which the points of each level from `first_level` on
/// suffice, usually and where charges nearly cancel; closer parts are panels.
using PartRatios = std::array<double, 3>;
constexpr std::array<PartRatios, 2> largest_part_ratios{PartRatios{0.3, 0.5, 0.7},
                                                        PartRatios{0.01, 0.04, 0.25}};
constexpr std::size_t first_level = ChargeFunctions::first_with_moments;

/// Distance from a panel's centre, over its radius, beyond which it counts as a point.
constexpr double far = 6;

/// Number of points that are evaluated points_together, with the same levels: a block of the kernels.
constexpr std::size_t points_together = node_block;

/// Bits of a coordinate's number in the Z-order, three of which fill a word.
constexpr unsigned order_bits = 21;

/// Returns the indices of points along Morton's space-filling curve, so that neighbours in it lie close
/// points_together. Points of the same code stay in their order.
std::vector<std::size_t> along_curve(std::span<const Vector3d> points) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& point : points)
    box.extend(point);
  const double side = points.empty() ? 0 : box.sizes().maxCoeff();
  const double scale = side > 0 ? static_cast<double>((1U << order_bits) - 1) / side : 0;
  std::vector<std::pair<std::uint64_t, std::size_t>> codes;
  codes.reserve(points.size());
  for (const Vector3d& point : points) {
    const Vector3d steps = (point - box.min()) * scale;
    std::uint64_t code = 0;
    for (Index axis = 0; axis < 3; ++axis) {
      const auto number = static_cast<std::uint64_t>(steps[axis]);
      for (unsigned bit = 0; bit < order_bits; ++bit)
        code |= (number >> bit & 1U) << (3 * bit + static_cast<unsigned>(axis));
    }
    codes.emplace_back(code, codes.size());
  }
  std::sort(codes.begin(), codes.end());
  std::vector<std::size_t> order;
  order.reserve(codes.size());
  for (const auto& [code, index] : codes)
    order.push_back(index);
  return order;
}

}  // namespace

OutsidePotentials::OutsidePotentials(const ChargeFunctions& functions, bool is_fine)
    : functions_(functions), is_fine_(is_fine) {
  for (const Triangle& corners : functions.panels().corners) {
    const Panel panel = make_panel(corners);
    panels_.push_back({panel.centre, panel.radius});
  }
}

double OutsidePotentials::clearance(const Vector3d& point) const {
  double least = std::numeric_limits<double>::infinity();
  for (const PanelPoint& panel : panels_)
    least = std::min(least, (panel.centre - point).norm() - panel.radius);
  return std::max(least, 0.0);
}

/// Returns the sources of points within a ball, those of close parts in the order of their panels.
OutsidePotentials::Sources OutsidePotentials::sources(const Vector3d& centre, double radius,
                                                      std::vector<std::size_t>& close) const {
  const PartRatios& largest_ratios = largest_part_ratios[is_fine_ ? 1 : 0];
  std::vector<std::pair<const MatrixXf*, Index>> rows;
  Sources result;
  const auto add = [&](const Eigen::Vector3f& at, float share, const MatrixXf& given, std::size_t row) {
    result.x.push_back(at.x()), result.y.push_back(at.y()), result.z.push_back(at.z());
    result.shares.push_back(share);
    rows.emplace_back(&given, static_cast<Index>(row));
  };
  close.clear();
  for (std::size_t part = 0; part < functions_.count(); ++part) {
    result.first.push_back(result.x.size());
    const double distance = (functions_.centre(part) - centre).norm() - radius;
    std::size_t level = first_level;
    while (level < first_level + largest_ratios.size() &&
           functions_.radius(part) > largest_ratios[level - first_level] * distance)
      ++level;
    if (level < first_level + largest_ratios.size()) {
      const FunctionPoints& points = functions_.points(level);
      for (std::size_t k = points.first[part]; k < points.first[part + 1]; ++k)
        add(points.at[k], points.shares[k], points.given, k);
      continue;
    }
    close.push_back(part);
    const FunctionPanels& own = functions_.panels();
    for (std::size_t k = own.first[part]; k < own.first[part + 1]; ++k)
      add(panels_[k].centre.cast<float>(), own.shares[k], own.given, k);
  }
  result.first.push_back(result.x.size());
  result.given.resize(static_cast<Index>(rows.size()), functions_.panels().given.cols());
  for (std::size_t k = 0; k < rows.size(); ++k)
    result.given.row(static_cast<Index>(k)) = rows[k].first->row(rows[k].second);
  return result;
}

/// Replaces 1/r by the mean over the panel where a point is close to it.
void OutsidePotentials::correct(std::span<const Vector3d> points, const Sources& sources,
                                const std::vector<std::size_t>& close,
                                Eigen::Ref<TrianglePotentials> inverse_distances) const {
  const FunctionPanels& own = functions_.panels();
  PotentialSums sums;
  std::vector<double> means;
  std::vector<std::pair<Index, Index>> places;
  for (const std::size_t part : close)
    for (std::size_t k = own.first[part]; k < own.first[part + 1]; ++k)
      for (std::size_t p = 0; p < points.size(); ++p)
        if (const double limit = far * panels_[k].radius;
            (points[p] - panels_[k].centre).squaredNorm() < limit * limit)
          places.emplace_back(static_cast<Index>(p),
                              static_cast<Index>(sources.first[part] + k - own.first[part]));
  means.assign(places.size(), 0);
  std::size_t at = 0;
  for (const std::size_t part : close)
    for (std::size_t k = own.first[part]; k < own.first[part + 1]; ++k) {
      const auto column = static_cast<Index>(sources.first[part] + k - own.first[part]);
      for (; at < places.size() && places[at].second == column; ++at)
        sums.add(own.corners[k], points[static_cast<std::size_t>(places[at].first)], 1, means[at]);
    }
  sums.flush();
  for (std::size_t k = 0; k < places.size(); ++k)
    inverse_distances(places[k].second, places[k].first) = static_cast<float>(means[k]);
}

OutsidePotentials::Values OutsidePotentials::at(std::span<const Vector3d> points, bool with_functions,
                                                const MatrixXf* charges, std::size_t threads) const {
  const auto parts = static_cast<Index>(functions_.count());
  const auto count = static_cast<Index>(points.size()), given = functions_.panels().given.cols();
  const Index columns = charges != nullptr ? charges->cols() : parts;
  Values values{TrianglePotentials(count, given), TrianglePotentials(count, with_functions ? columns : 0)};
  const std::vector<std::size_t> order = along_curve(points);
  constexpr std::size_t in_group = 16 * points_together;
  parallel_for((points.size() + in_group - 1) / in_group, threads, [&](std::size_t group) {
    const std::span<const std::size_t> indices =
        std::span(order).subspan(group * in_group, std::min(in_group, points.size() - group * in_group));
    const auto size = static_cast<Index>(indices.size());
    TrianglePotentials of_given(size, given), of_functions(size, with_functions ? parts : 0);
    for (std::size_t begin = 0; begin < indices.size(); begin += points_together)
      evaluate(points, indices.subspan(begin, std::min(points_together, indices.size() - begin)),
               static_cast<Index>(begin), of_given, of_functions);
    if (with_functions && charges != nullptr)
      of_functions = (of_functions * *charges).eval();
    for (Index p = 0; p < size; ++p) {
      const auto index = static_cast<Index>(indices[static_cast<std::size_t>(p)]);
      values.of_given.row(index) = of_given.row(p);
      values.of_functions.row(index) = of_functions.row(p);
    }
  });
  return values;
}

/// Evaluates one block of points, given by their indices, into the rows from `first` on; the functions' only
/// if `of_functions` has columns.
void OutsidePotentials::evaluate(std::span<const Vector3d> points, std::span<const std::size_t> indices,
                                 Index first, TrianglePotentials& of_given,
                                 TrianglePotentials& of_functions) const {
  std::vector<Vector3d> some;
  Eigen::AlignedBox3d box;
  std::array<std::array<float, points_together>, 3> at{};
  for (std::array<float, points_together>& coordinates : at)
    coordinates.fill(padded_coordinate);
  for (const std::size_t index : indices) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      at[axis][some.size()] = static_cast<float>(points[index][static_cast<Index>(axis)]);
    some.push_back(points[index]);
    box.extend(points[index]);
  }
  std::vector<std::size_t> close;
  const Sources charges = sources(box.center(), box.diagonal().norm() / 2, close);
  const auto size = static_cast<Index>(some.size());
  TrianglePotentials inverse_distances(charges.given.rows(), static_cast<Index>(points_together));
  best_kernels<NodeKernels>().fill(
      {charges.x.data(), charges.y.data(), charges.z.data(), charges.given.rows()},
      {at[0].data(), at[1].data(), at[2].data(), size}, inverse_distances.data());
  correct(some, charges, close, inverse_distances);
  of_given.middleRows(first, size) = inverse_distances.leftCols(size).transpose() * charges.given;
  for (Index part = 0; part < of_functions.cols(); ++part) {
    std::array<float, points_together> sums{};
    for (std::size_t k = charges.first[static_cast<std::size_t>(part)];
         k < charges.first[static_cast<std::size_t>(part) + 1]; ++k) {
      const float* row = inverse_distances.row(static_cast<Index>(k)).data();
      for (std::size_t p = 0; p < points_together; ++p)
        sums[p] += row[p] * charges.shares[k];
    }
    for (Index p = 0; p < size; ++p)
      of_functions(first + p, part) = sums[static_cast<std::size_t>(p)];
  }
}

}  // namespace fringe::detail
