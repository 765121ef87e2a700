#include "reduced/outside_potentials.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "bem/panel_pair.hpp"
#include "numeric/parallel.hpp"
#include "numeric/progress.hpp"
#include "numeric/quadrature_rules.hpp"
#include "simd/dispatch.hpp"
#include "surface/panel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::Vector3d;

/// Largest ratios of a part's radius to its distance at which the points of each level from `first_level` on
/// suffice, though charges of both signs nearly cancel; closer parts are panels.
constexpr std::size_t most_levels = 3;
constexpr std::array<double, most_levels> largest_part_ratios{0.02, 0.08, 0.3};
constexpr std::size_t first_level = ChargeFunctions::first_with_moments;

/// Distance from a panel's centre, over its radius, beyond which it counts as a point.
constexpr double far = 10;

/// The same for quadrature rules of two degrees; closer panels are integrated in closed form. The error is
/// 1e-3 of the panel's potential at most (the rules' bounds: model/NUMERICS.md, section 12).
constexpr std::array<std::pair<double, int>, 2> rules_from{{{2.5, 5}, {6, 2}}};

/// Number of groups of points from which on it is worth showing how far they are: some seconds.
constexpr std::size_t groups_with_progress = 40;

/// Bits of a coordinate's number in the Z-order, three of which fill a word.
constexpr unsigned order_bits = 21;

}  // namespace

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

FunctionCharges::FunctionCharges(const MatrixXf& charges)
    : values(static_cast<std::size_t>(charges.rows() * whole_blocks(charges.cols())), 0.0F),
      count(charges.cols()), stride(whole_blocks(charges.cols())) {
  for (Index function = 0; function < charges.rows(); ++function)
    for (Index k = 0; k < count; ++k)
      values[static_cast<std::size_t>(function * stride + k)] = charges(function, k);
}

OutsidePotentials::OutsidePotentials(const ChargeFunctions& functions) : functions_(functions) {
  for (const Triangle& corners : functions.panels().corners) {
    const Panel panel = make_panel(corners);
    panels_.push_back({panel.centre, panel.radius});
  }
  for (std::size_t level = first_level; level < first_level + most_levels; ++level)
    add_sources(functions.points(level));
  const FunctionPanels& own = functions.panels();
  FunctionPoints centres{own.first, {}, own.shares, own.given};
  for (const PanelPoint& panel : panels_)
    centres.at.emplace_back(panel.centre.cast<float>());
  add_sources(centres);
  for (const auto& [from, degree] : rules_from)
    add_rule(from, degree);
}

void OutsidePotentials::add_rule(double from, int degree) {
  const TriangleRule& rule = triangle_rule(degree);
  const std::span nodes(rule.nodes, static_cast<std::size_t>(rule.points));
  PanelRule& added = rules_.emplace_back();
  added.from = from;
  for (const TriangleNode& node : nodes)
    added.weights.push_back(static_cast<float>(node.weight));
  for (const Triangle& corners : functions_.panels().corners)
    for (const TriangleNode& node : nodes) {
      const Vector3d at = point_of(corners, node);
      added.x.push_back(static_cast<float>(at.x()));
      added.y.push_back(static_cast<float>(at.y()));
      added.z.push_back(static_cast<float>(at.z()));
    }
}

void OutsidePotentials::add_sources(const FunctionPoints& points) {
  Sources& sources = levels_.emplace_back();
  sources.first = points.first;
  for (std::size_t k = 0; k < points.at.size(); ++k) {
    sources.x.push_back(points.at[k].x());
    sources.y.push_back(points.at[k].y());
    sources.z.push_back(points.at[k].z());
    sources.charges.push_back(points.shares[k]);
    for (Index given = 0; given < points.given.cols(); ++given)
      sources.charges.push_back(points.given(index_of(k), given));
  }
}

double OutsidePotentials::clearance(const Vector3d& point) const {
  const std::vector<Triangle>& corners = functions_.panels().corners;
  // A panel is no nearer than the sphere around it.
  std::vector<double> least;
  least.reserve(panels_.size());
  for (const PanelPoint& panel : panels_)
    least.push_back((panel.centre - point).norm() - panel.radius);
  const auto nearest = static_cast<std::size_t>(std::ranges::min_element(least) - least.begin());
  double distance = triangle_distance(corners[nearest], point);
  for (std::size_t panel = 0; panel < panels_.size(); ++panel)
    if (least[panel] < distance)
      distance = std::min(distance, triangle_distance(corners[panel], point));
  return distance;
}

OutsidePotentials::Values OutsidePotentials::at(std::span<const Vector3d> points, bool with_functions,
                                                const MatrixXf* charges, std::size_t threads) const {
  const auto count = static_cast<Index>(points.size());
  const std::optional<FunctionCharges> combined =
      with_functions && charges != nullptr ? std::optional<FunctionCharges>(*charges) : std::nullopt;
  const Index columns = combined ? combined->count : with_functions ? index_of(functions_.count()) : 0;
  Values values{TrianglePotentials(count, given()), TrianglePotentials(count, columns)};
  const std::vector<std::size_t> order = along_curve(points);
  constexpr std::size_t in_group = 16 * block;
  const std::size_t groups = (points.size() + in_group - 1) / in_group;
  std::atomic<std::size_t> begun = 0;
  parallel_for(groups, threads, [&](std::size_t group) {
    if (groups >= groups_with_progress)
      show_progress(fmt::format("{} of {} points", in_group * begun++, points.size()));
    Scratch scratch;
    std::vector<Vector3d> some;
    const std::size_t end = std::min(points.size(), (group + 1) * in_group);
    for (std::size_t begin = group * in_group; begin < end; begin += block) {
      const auto indices = std::span(order).subspan(begin, std::min(block, end - begin));
      some.clear();
      for (const std::size_t index : indices)
        some.push_back(points[index]);
      evaluate(some, with_functions, combined ? &*combined : nullptr, scratch);
      const std::vector<float>& of_functions = combined ? scratch.of_charges : scratch.of_functions;
      for (std::size_t p = 0; p < indices.size(); ++p) {
        const Index row = index_of(indices[p]);
        for (Index k = 0; k < given(); ++k)
          values.of_given(row, k) = scratch.of_given[static_cast<std::size_t>(k) * block + p];
        for (Index k = 0; k < columns; ++k)
          values.of_functions(row, k) = of_functions[static_cast<std::size_t>(k) * block + p];
      }
    }
  });
  return values;
}

void OutsidePotentials::evaluate(std::span<const Vector3d> points, bool with_functions,
                                 const FunctionCharges* charges, Scratch& scratch) const {
  const auto& kernels = best_kernels<NodeKernels>();
  Eigen::AlignedBox3d box;
  Coordinates at{};
  for (std::array<float, block>& coordinates : at)
    coordinates.fill(padded_coordinate);
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      at[axis][p] = static_cast<float>(points[p][static_cast<Index>(axis)]);
    box.extend(points[p]);
  }
  const NodePoints columns{at[0].data(), at[1].data(), at[2].data(), index_of(points.size())};
  const auto fill = [&](const Sources& sources, std::size_t function, float* inverse_distances) {
    const std::size_t first = sources.first[function];
    kernels.fill({sources.x.data() + first, sources.y.data() + first, sources.z.data() + first,
                  index_of(sources.first[function + 1] - first)},
                 columns, inverse_distances);
  };
  const Vector3d centre = box.center();
  const double radius = box.diagonal().norm() / 2;
  scratch.of_given.assign(static_cast<std::size_t>(given()) * block, 0.0F);
  scratch.of_functions.resize(with_functions ? functions_.count() * block : 0);
  scratch.close.clear();
  std::size_t close_panels = 0;
  const std::vector<std::size_t>& panels = levels_.back().first;
  for (std::size_t function = 0; function < functions_.count(); ++function) {
    const double distance = (functions_.centre(function) - centre).norm() - radius;
    std::size_t level = 0;
    while (level < most_levels && functions_.radius(function) > largest_part_ratios[level] * distance)
      ++level;
    if (level == most_levels) {
      scratch.close.push_back(function);
      close_panels += panels[function + 1] - panels[function];
      continue;
    }
    const Sources& sources = levels_[level];
    scratch.inverse_distances.resize(std::max(
        scratch.inverse_distances.size(), (sources.first[function + 1] - sources.first[function]) * block));
    fill(sources, function, scratch.inverse_distances.data());
    add_potentials(sources, function, scratch.inverse_distances.data(), with_functions, scratch);
  }
  scratch.inverse_distances.resize(std::max(scratch.inverse_distances.size(), close_panels * block));
  float* values = scratch.inverse_distances.data();
  for (const std::size_t function : scratch.close) {
    fill(levels_.back(), function, values);
    values += (panels[function + 1] - panels[function]) * block;
  }
  correct(points, at, scratch);
  values = scratch.inverse_distances.data();
  for (const std::size_t function : scratch.close) {
    add_potentials(levels_.back(), function, values, with_functions, scratch);
    values += (panels[function + 1] - panels[function]) * block;
  }
  if (charges != nullptr) {
    scratch.of_charges.resize(static_cast<std::size_t>(charges->count) * block);
    kernels.combine({scratch.of_functions.data(), index_of(functions_.count())},
                    {charges->values.data(), charges->stride, charges->count}, scratch.of_charges.data());
  }
}

/// Adds a function's share of the given charges' potentials, and writes that of its own charge.
void OutsidePotentials::add_potentials(const Sources& sources, std::size_t function,
                                       const float* inverse_distances, bool with_functions,
                                       Scratch& scratch) const {
  const auto& kernels = best_kernels<NodeKernels>();
  const std::size_t first = sources.first[function];
  const std::ptrdiff_t stride = given() + 1, sets = with_functions ? stride : given();
  const float* charges = sources.charges.data() + first * static_cast<std::size_t>(stride) +
                         static_cast<std::size_t>(stride - sets);
  scratch.sums.resize(static_cast<std::size_t>(stride) * block);
  float* sums = scratch.sums.data() + static_cast<std::size_t>(stride - sets) * block;
  kernels.combine({inverse_distances, index_of(sources.first[function + 1] - first)}, {charges, stride, sets},
                  sums);
  kernels.add(1, scratch.sums.data() + block, scratch.of_given.data(), index_of(scratch.of_given.size()));
  if (with_functions)
    std::copy_n(scratch.sums.begin(), block,
                scratch.of_functions.begin() + static_cast<std::ptrdiff_t>(function * block));
}

/// Replaces 1/r by the mean over the panel where a point is close to it.
void OutsidePotentials::correct(std::span<const Vector3d> points, const Coordinates& at,
                                Scratch& scratch) const {
  const auto& kernels = best_kernels<NodeKernels>();
  const NodePoints columns{at[0].data(), at[1].data(), at[2].data(), index_of(points.size())};
  const FunctionPanels& own = functions_.panels();
  PotentialSums sums;
  Eigen::AlignedBox3d box;
  for (const Vector3d& point : points)
    box.extend(point);
  const Vector3d centre = box.center();
  const double radius = box.diagonal().norm() / 2;
  scratch.near.clear();
  std::size_t row = 0;
  for (const std::size_t function : scratch.close)
    for (std::size_t panel = own.first[function]; panel < own.first[function + 1]; ++panel, ++row) {
      const PanelPoint& place = panels_[panel];
      const double distance = (centre - place.centre).norm() - radius;
      if (distance >= far * place.radius)
        continue;
      // The whole block takes the rule of its nearest point, and of the first rule if that is nearer still.
      std::size_t used = rules_.size() - 1;
      while (used > 0 && distance < rules_[used].from * place.radius)
        --used;
      const PanelRule& rule = rules_[used];
      const std::size_t count = rule.weights.size(), first = panel * count;
      scratch.of_rule.resize(count * block);
      kernels.fill({rule.x.data() + first, rule.y.data() + first, rule.z.data() + first, index_of(count)},
                   columns, scratch.of_rule.data());
      kernels.combine({scratch.of_rule.data(), index_of(count)}, {rule.weights.data(), 1, 1},
                      scratch.inverse_distances.data() + row * block);
      const double limit = rules_.front().from * place.radius;
      if (distance >= limit)
        continue;
      for (std::size_t p = 0; p < points.size(); ++p)
        if ((points[p] - place.centre).squaredNorm() < limit * limit)
          scratch.near.push_back({panel, row * block + p});
    }
  scratch.means.assign(scratch.near.size(), 0);
  for (std::size_t k = 0; k < scratch.near.size(); ++k) {
    const auto [panel, place] = scratch.near[k];
    sums.add(own.corners[panel], points[place % block], 1, scratch.means[k]);
  }
  sums.flush();
  for (std::size_t k = 0; k < scratch.near.size(); ++k)
    scratch.inverse_distances[scratch.near[k][1]] = static_cast<float>(scratch.means[k]);
}

}  // namespace fringe::detail
