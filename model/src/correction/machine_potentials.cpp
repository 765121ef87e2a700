#include "fringe/machine_potentials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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

/// Number of points that are evaluated together, with the same levels.
constexpr std::size_t together = 16;

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
    const auto padded =
        static_cast<std::size_t>(detail::whole_blocks(static_cast<std::ptrdiff_t>(rows.size())));
    for (std::vector<float>* coordinates : {&result.x, &result.y, &result.z})
      coordinates->resize(padded, detail::padded_coordinate);
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
      inverse_distances(places[k].first, places[k].second) = static_cast<float>(means[k]);
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
  const auto parts = static_cast<Index>(machine_->rest.functions().count());
  const auto count = static_cast<Index>(points.size());
  Values values{TrianglePotentials(count, machine_->rest.loads()),
                TrianglePotentials(count, with_parts ? parts : 0)};
  detail::parallel_for((points.size() + together - 1) / together, threads, [&](std::size_t batch) {
    const std::size_t begin = batch * together;
    const std::span<const Vector3d> some = points.subspan(begin, std::min(together, points.size() - begin));
    Eigen::AlignedBox3d box;
    for (const Vector3d& point : some)
      box.extend(point);
    std::vector<std::size_t> close;
    const Machine::Sources sources = machine_->sources(box.center(), box.diagonal().norm() / 2, close);
    const auto size = static_cast<Index>(some.size()), padded = static_cast<Index>(sources.x.size());
    std::array<std::array<float, together>, 3> at{};
    for (std::size_t p = 0; p < some.size(); ++p)
      for (std::size_t axis = 0; axis < 3; ++axis)
        at[axis][p] = static_cast<float>(some[p][static_cast<Index>(axis)]);
    TrianglePotentials inverse_distances(size, padded);
    detail::best_kernels<detail::NodeKernels>().fill(
        {at[0].data(), at[1].data(), at[2].data(), size},
        {sources.x.data(), sources.y.data(), sources.z.data(), sources.given.rows()},
        inverse_distances.data());
    machine_->correct(some, sources, close, inverse_distances);
    values.of_loads.middleRows(static_cast<Index>(begin), size) =
        inverse_distances.leftCols(sources.given.rows()) * sources.given;
    if (!with_parts)
      return;
    for (Index p = 0; p < size; ++p) {
      const float* row = inverse_distances.row(p).data();
      for (Index part = 0; part < parts; ++part) {
        float sum = 0;
        for (std::size_t k = sources.first[static_cast<std::size_t>(part)];
             k < sources.first[static_cast<std::size_t>(part) + 1]; ++k)
          sum += row[k] * sources.shares[k];
        values.of_parts(static_cast<Index>(begin) + p, part) = sum;
      }
    }
  });
  return values;
}

}  // namespace fringe
