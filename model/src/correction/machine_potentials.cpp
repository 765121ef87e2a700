#include "fringe/machine_potentials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "bem/panel.hpp"
#include "bem/panel_pair.hpp"
#include "correction/company.hpp"
#include "fringe/error.hpp"
#include "fringe/reading.hpp"
#include "numeric/parallel.hpp"
#include "reduced/node_kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe {
namespace {

using detail::ChargeFunctions;
using detail::FunctionPanels;
using detail::FunctionPoints;
using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::Vector3d;

/// Largest ratios of a part's radius to its distance at which the points of each level from `first_level` on
/// suffice; closer parts are panels.
constexpr std::array<double, 3> largest_ratios{0.3, 0.5, 0.7};
constexpr std::size_t first_level = ChargeFunctions::first_with_moments;

/// Distance from a panel's centre, over its radius, beyond which it counts as a point.
constexpr double far = 6;

/// Number of points that are evaluated together, with the same levels: a block of the kernels.
constexpr std::size_t together = detail::node_block;

/// Bits of a coordinate's number in the Z-order, three of which fill a word.
constexpr unsigned order_bits = 21;

/// Returns the indices of points along Morton's space-filling curve, so that neighbours in it lie close
/// together. Points of the same code stay in their order.
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

struct MachinePotentials::Machine {
  /// A panel as a point.
  struct PanelPoint {
    Vector3d centre;
    double radius;
  };

  /// The charges by which some points see a machine: a range for each part.
  struct Sources {
    std::vector<float> x, y, z, shares;
    std::vector<std::size_t> first;
    MatrixXf given;
  };

  Machine(const Scene& scene, const MachinePotentialsOptions& options)
      : rest(detail::charged_bodies(scene), fringe::readings(scene),
             {options.rtol, options.most_panels, options.functions, 0, options.threads}) {
    for (const detail::MachineAtRest::OfReading& reading : rest.readings())
      readings.push_back(
          {static_cast<std::size_t>(reading.sense), static_cast<std::size_t>(reading.drive), reading.sign});
    for (const Triangle& corners : rest.functions().panels().corners) {
      const detail::Panel panel = detail::make_panel(corners);
      panels.push_back({panel.centre, panel.radius});
    }
  }

  /// Returns the sources of points within a ball, those of close parts in the order of their panels.
  Sources sources(const Vector3d& centre, double radius, std::vector<std::size_t>& close) const {
    const ChargeFunctions& functions = rest.functions();
    std::vector<std::pair<const MatrixXf*, Index>> rows;
    Sources result;
    const auto add = [&](const Eigen::Vector3f& at, float share, const MatrixXf& given, std::size_t row) {
      result.x.push_back(at.x()), result.y.push_back(at.y()), result.z.push_back(at.z());
      result.shares.push_back(share);
      rows.emplace_back(&given, static_cast<Index>(row));
    };
    close.clear();
    for (std::size_t part = 0; part < functions.count(); ++part) {
      result.first.push_back(result.x.size());
      const double distance = (functions.centre(part) - centre).norm() - radius;
      std::size_t level = first_level;
      while (level < first_level + largest_ratios.size() &&
             functions.radius(part) > largest_ratios[level - first_level] * distance)
        ++level;
      if (level < first_level + largest_ratios.size()) {
        const FunctionPoints& points = functions.points(level);
        for (std::size_t k = points.first[part]; k < points.first[part + 1]; ++k)
          add(points.at[k], points.shares[k], points.given, k);
        continue;
      }
      close.push_back(part);
      const FunctionPanels& own = functions.panels();
      for (std::size_t k = own.first[part]; k < own.first[part + 1]; ++k)
        add(panels[k].centre.cast<float>(), own.shares[k], own.given, k);
    }
    result.first.push_back(result.x.size());
    result.given.resize(static_cast<Index>(rows.size()), rest.loads());
    for (std::size_t k = 0; k < rows.size(); ++k)
      result.given.row(static_cast<Index>(k)) = rows[k].first->row(rows[k].second);
    return result;
  }

  /// Replaces 1/r by the mean over the panel where a point is close to it.
  void correct(std::span<const Vector3d> points, const Sources& sources,
               const std::vector<std::size_t>& close,
               Eigen::Ref<TrianglePotentials> inverse_distances) const {
    const FunctionPanels& own = rest.functions().panels();
    detail::PotentialSums sums;
    std::vector<double> means;
    std::vector<std::pair<Index, Index>> places;
    for (const std::size_t part : close)
      for (std::size_t k = own.first[part]; k < own.first[part + 1]; ++k)
        for (std::size_t p = 0; p < points.size(); ++p)
          if (const double limit = far * panels[k].radius;
              (points[p] - panels[k].centre).squaredNorm() < limit * limit)
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

  /// Evaluates potentials as MachinePotentials::at() does; those of the parts are multiplied by `charges`
  /// unless it is null.
  Values at(std::span<const Vector3d> points, bool with_parts, const MatrixXf* charges,
            std::size_t threads) const {
    const auto parts = static_cast<Index>(rest.functions().count());
    const auto count = static_cast<Index>(points.size());
    const Index columns = charges != nullptr ? charges->cols() : parts;
    Values values{TrianglePotentials(count, rest.loads()),
                  TrianglePotentials(count, with_parts ? columns : 0)};
    const std::vector<std::size_t> order = along_curve(points);
    constexpr std::size_t in_group = 16 * together;
    detail::parallel_for((points.size() + in_group - 1) / in_group, threads, [&](std::size_t group) {
      const std::span<const std::size_t> indices =
          std::span(order).subspan(group * in_group, std::min(in_group, points.size() - group * in_group));
      const auto size = static_cast<Index>(indices.size());
      TrianglePotentials of_loads(size, rest.loads()), of_parts(size, with_parts ? parts : 0);
      for (std::size_t begin = 0; begin < indices.size(); begin += together)
        evaluate(points, indices.subspan(begin, std::min(together, indices.size() - begin)),
                 static_cast<Index>(begin), of_loads, of_parts);
      if (charges != nullptr)
        of_parts = (of_parts * *charges).eval();
      for (Index p = 0; p < size; ++p) {
        const auto index = static_cast<Index>(indices[static_cast<std::size_t>(p)]);
        values.of_loads.row(index) = of_loads.row(p);
        values.of_parts.row(index) = of_parts.row(p);
      }
    });
    return values;
  }

  /// Evaluates one block of points, given by their indices, into the rows from `first` on; the parts' only if
  /// `of_parts` has columns.
  void evaluate(std::span<const Vector3d> points, std::span<const std::size_t> indices, Index first,
                TrianglePotentials& of_loads, TrianglePotentials& of_parts) const {
    std::vector<Vector3d> some;
    Eigen::AlignedBox3d box;
    std::array<std::array<float, together>, 3> at{};
    for (std::array<float, together>& coordinates : at)
      coordinates.fill(detail::padded_coordinate);
    for (const std::size_t index : indices) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        at[axis][some.size()] = static_cast<float>(points[index][static_cast<Index>(axis)]);
      some.push_back(points[index]);
      box.extend(points[index]);
    }
    std::vector<std::size_t> close;
    const Sources charges = sources(box.center(), box.diagonal().norm() / 2, close);
    const auto size = static_cast<Index>(some.size());
    TrianglePotentials inverse_distances(charges.given.rows(), static_cast<Index>(together));
    detail::best_kernels<detail::NodeKernels>().fill(
        {charges.x.data(), charges.y.data(), charges.z.data(), charges.given.rows()},
        {at[0].data(), at[1].data(), at[2].data(), size}, inverse_distances.data());
    correct(some, charges, close, inverse_distances);
    of_loads.middleRows(first, size) = inverse_distances.leftCols(size).transpose() * charges.given;
    for (Index part = 0; part < of_parts.cols(); ++part) {
      std::array<float, together> sums{};
      for (std::size_t k = charges.first[static_cast<std::size_t>(part)];
           k < charges.first[static_cast<std::size_t>(part) + 1]; ++k) {
        const float* row = inverse_distances.row(static_cast<Index>(k)).data();
        for (std::size_t p = 0; p < together; ++p)
          sums[p] += row[p] * charges.shares[k];
      }
      for (Index p = 0; p < size; ++p)
        of_parts(first + p, part) = sums[static_cast<std::size_t>(p)];
    }
  }

  detail::MachineAtRest rest;
  std::vector<OfReading> readings;
  std::vector<PanelPoint> panels;
};

MachinePotentials::MachinePotentials(const Scene& scene, const MachinePotentialsOptions& options) {
  if (!(options.rtol >= 1e-4 && options.rtol <= 0.5))
    throw InputError(fmt::format("rtol {} must be from 0.0001 to 0.5", options.rtol));
  if (options.functions == 0)
    throw InputError("functions must be at least 1");
  if (scene.has_room)
    throw InputError("room: boundary elements compute only conductors in free space");
  if (fringe::readings(scene).empty())
    throw InputError("a machine without sensors or electrodes has no readings");
  machine_ = std::make_shared<const Machine>(scene, options);
}

const std::vector<MachinePotentials::OfReading>& MachinePotentials::readings() const {
  return machine_->readings;
}

Eigen::MatrixXd MachinePotentials::answers() const {
  const auto count = static_cast<Index>(machine_->rest.functions().count());
  const Eigen::Map<const MatrixXf> stored(machine_->rest.answers().data(), detail::whole_blocks(count),
                                          count);
  return stored.topRows(count).cast<double>();
}

double MachinePotentials::error() const {
  return machine_->rest.error();
}

std::size_t MachinePotentials::panels() const {
  return machine_->panels.size();
}

MachinePotentials::Values MachinePotentials::at(std::span<const Vector3d> points, bool with_parts,
                                                std::size_t threads) const {
  return machine_->at(points, with_parts, nullptr, threads);
}

MachinePotentials::Values MachinePotentials::at(std::span<const Vector3d> points, const MatrixXf& charges,
                                                std::size_t threads) const {
  if (const std::size_t parts = machine_->rest.functions().count();
      static_cast<std::size_t>(charges.rows()) != parts)
    throw InputError(fmt::format("charges have {} rows, but there are {} parts", charges.rows(), parts));
  return machine_->at(points, true, &charges, threads);
}

}  // namespace fringe
