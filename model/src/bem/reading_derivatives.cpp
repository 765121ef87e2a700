#include "bem/reading_derivatives.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/wrench.hpp"
#include "integral/batch/kernels.hpp"
#include "numeric/parallel.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// Error of a derivative, relative to it, per relative error of the change: the error of the change may vary
/// faster with the pose than the change.
constexpr double error_per_error = 10;

/// Error of the nodes' forces, and of what the change does not tell, relative.
constexpr double node_error = 4e-3;

/// Error of a torque relative to the force times its farthest distance, which is left where the torques of a
/// body's parts cancel: a ball about its centre showed a quarter of it.
constexpr double moment_error = 1e-3;

/// Returns a ball around the one of two sets of points that needs the smaller one.
BodyBall smaller_ball(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  const auto ball = [](const Eigen::Matrix3Xd& points) -> BodyBall {
    const Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
    return {(low + high) / 2, (high - low).norm() / 2};
  };
  const BodyBall first = ball(a), second = ball(b);
  return first.radius < second.radius ? first : second;
}

/// Computes for every reading the force and torque between two sets of point charges: the derivatives of the
/// change as the first moves.
std::vector<Wrench> wrenches_between(const LinkCharges& a, const LinkCharges& b, const FormColumns& columns,
                                     std::size_t readings, std::size_t threads) {
  constexpr Index rows_together = 64;
  const Index count = b.points.cols();
  const auto padding = static_cast<Index>(TriangleArrays::padding);
  const Index stride = (count + padding - 1) / padding * padding;
  // Points beyond the last one carry no charge, and are far from all others.
  MatrixXd coordinates = MatrixXd::Constant(stride, 3, 1e30);
  coordinates.topRows(count) = b.points.transpose();
  const MatrixXd charges_a = a.charges * columns.combination;
  const Index forms = columns.combination.cols();
  // The charges, and these times each coordinate.
  MatrixXd sources = MatrixXd::Zero(stride, 4 * forms);
  sources.topLeftCorner(count, forms) = b.charges * columns.combination;
  for (Index axis = 0; axis < 3; ++axis)
    sources.block(0, (axis + 1) * forms, count, forms) =
        sources.topLeftCorner(count, forms).array().colwise() * b.points.row(axis).transpose().array();

  const auto blocks = static_cast<std::size_t>((a.points.cols() + rows_together - 1) / rows_together);
  std::vector<std::vector<Wrench>> parts(blocks, std::vector<Wrench>(readings));
  parallel_for(blocks, threads, [&](std::size_t block) {
    const Index first = index_of(block) * rows_together,
                rows = std::min(rows_together, a.points.cols() - first);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> inverse(rows, stride);
    const Eigen::Matrix3Xd points = a.points.middleCols(first, rows);
    best_kernels<BatchKernels>().soft_inverse_distances(
        {coordinates.col(0).data(), coordinates.col(1).data(), coordinates.col(2).data()},
        static_cast<std::size_t>(stride), points.data(), static_cast<std::size_t>(rows), 0, inverse.data());
    inverse = inverse.array().cube();
    const MatrixXd sums = inverse * sources;
    for (std::size_t form = 0; form < columns.readings.size(); ++form)
      for (Index row = 0; row < rows; ++row) {
        const Index one = 2 * index_of(form), other = one + 1;
        const Vector3d point = points.col(row);
        const auto field = [&](Index column) -> Vector3d {
          return point * sums(row, column) - Vector3d(sums(row, forms + column),
                                                      sums(row, 2 * forms + column),
                                                      sums(row, 3 * forms + column));
        };
        const Vector3d force =
            charges_a(first + row, one) * field(other) + charges_a(first + row, other) * field(one);
        parts[block][columns.readings[form]] += {force, point.cross(force)};
      }
  });
  std::vector<Wrench> result(readings);
  for (const std::vector<Wrench>& part : parts)
    for (std::size_t k = 0; k < readings; ++k)
      result[k] += part[k];
  return result;
}

}  // namespace

FormColumns form_columns(const std::vector<ChargedReading>& readings) {
  const auto count = index_of(readings.size());
  FormColumns result{{}, MatrixXd::Zero(4 * count, 4 * count)};
  Index columns = 0;
  for (Index k = 0; k < count; ++k) {
    const ChargedReading& reading = readings[static_cast<std::size_t>(k)];
    const Index sense = k, sense_change = count + k, drive = 2 * count + k, drive_change = 3 * count + k;
    const auto add_form = [&] {
      result.readings.push_back(static_cast<std::size_t>(k));
      columns += 2;
    };
    if (reading.sense == reading.drive) {
      result.combination(sense_change, columns) = 1;
      result.combination(sense, columns + 1) = 2;
      result.combination(sense_change, columns + 1) = 1;
      add_form();
      continue;
    }
    result.combination(sense_change, columns) = 1;
    result.combination(drive, columns + 1) = 1;
    result.combination(drive_change, columns + 1) = 1;
    add_form();
    result.combination(sense, columns) = 1;
    result.combination(drive_change, columns + 1) = 1;
    add_form();
  }
  result.combination.conservativeResize(4 * count, columns);
  return result;
}

void write_link_derivatives(const LinkPoses& poses, std::span<const PairWrench> pairs,
                            ReadingAnswer& answer) {
  answer.derivatives.clear();
  if (!answer.change.value || !std::isfinite(*answer.change.value) || !answer.change.error)
    return;
  answer.derivatives = derivatives_by_link(poses, pairs);
  const std::vector<double> moments = moments_by_link(poses, pairs);
  const double relative =
      error_per_error * *answer.change.error / std::abs(*answer.change.value) + node_error;
  // Those of a kind have the same error.
  for (std::size_t k = 0; k < moments.size(); ++k) {
    auto& [name, derivatives, errors] = answer.derivatives[k];
    errors.emplace() << Vector3d::Constant(relative * derivatives.head<3>().norm()),
        Vector3d::Constant(relative * derivatives.tail<3>().norm() + moment_error * moments[k]);
  }
}

PairWrench unknown_wrench(std::optional<std::size_t> link, std::optional<std::size_t> other) {
  const Vector3d unknown = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  return {link, other, {unknown, unknown}};
}

void write_derivatives(const ChargeNodes& nodes, const ChargedBodies& bodies, const LinkPoses& poses,
                       std::size_t threads, std::vector<ReadingAnswer>& answers) {
  const std::size_t readings = bodies.readings.size();
  const FormColumns columns = form_columns(bodies.readings);
  std::vector<std::vector<PairWrench>> pairs(readings);
  for (std::size_t a = 0; a < nodes.links.size(); ++a)
    for (std::size_t b = a + 1; b < nodes.links.size(); ++b) {
      const std::vector<Wrench> found =
          wrenches_between(nodes.links[a], nodes.links[b], columns, readings, threads);
      const BodyBall smaller = smaller_ball(nodes.links[a].points, nodes.links[b].points);
      for (std::size_t k = 0; k < readings; ++k)
        pairs[k].push_back({nodes.links[a].link, nodes.links[b].link, found[k], smaller});
    }
  for (const auto& [a, b] : nodes.too_close)
    for (std::vector<PairWrench>& of_reading : pairs)
      of_reading.push_back(unknown_wrench(nodes.links[a].link, nodes.links[b].link));
  for (std::size_t k = 0; k < readings; ++k)
    write_link_derivatives(poses, pairs[k], answers[k]);
}

}  // namespace fringe::detail
