#include "fringe/machine_potentials.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/reading.hpp"
#include "numeric/parallel.hpp"
#include "reduced/answer_modes.hpp"
#include "reduced/linked_machine.hpp"
#include "reduced/node_kernels.hpp"
#include "reduced/outside_potentials.hpp"
#include "simd/dispatch.hpp"

namespace fringe {

using detail::index_of;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::Vector3d;

namespace {

/// Number of points that a thread takes at once, about.
constexpr std::size_t points_together = 1024;

/// Largest number of answers. Half as many leave changes by a hand or a finger before `x_ray_arm` a half less
/// accurate.
constexpr Eigen::Index most_answers = 256;

/// Returns the products of rows with each other, in blocks.
MatrixXd products_of_rows(const Eigen::Ref<const TrianglePotentials>& rows) {
  using detail::node_block;
  const auto& kernels = detail::best_kernels<detail::NodeKernels>();
  const Index count = rows.rows(), padded = detail::whole_blocks(count), of_block = rows.cols() * node_block;
  // The values of a block's rows follow each other, column by column.
  std::vector<float> blocks(static_cast<std::size_t>(padded * rows.cols()), 0.0F);
  Eigen::Map<MatrixXf> columns(blocks.data(), node_block, padded / node_block * rows.cols());
  for (Index row = 0; row < count; ++row)
    columns.row(row % node_block).segment(row / node_block * rows.cols(), rows.cols()) = rows.row(row);
  Eigen::Matrix<float, node_block, node_block> products;
  MatrixXd found(padded, padded);
  for (Index i = 0; i < padded; i += node_block)
    for (Index j = 0; j <= i; j += node_block) {
      kernels.combine({blocks.data() + j / node_block * of_block, rows.cols()},
                      {blocks.data() + i / node_block * of_block, node_block, node_block}, products.data());
      found.block<node_block, node_block>(j, i) = products.cast<double>();
      found.block<node_block, node_block>(i, j) = products.transpose().cast<double>();
    }
  return found.topLeftCorner(count, count);
}

}  // namespace

struct MachinePotentials::Machine {
  Machine(const Scene& scene, const MachinePotentialsOptions& options)
      : machine({detail::charged_bodies(scene)}, fringe::readings(scene), {}, {},
                {{options.rtol, options.most_panels, options.functions}, {}}, options.threads),
        potentials(link().functions()) {
    for (const detail::OfReading& reading : machine.readings())
      readings.push_back(
          {static_cast<std::size_t>(reading.sense), static_cast<std::size_t>(reading.drive), reading.sign});
  }

  /// Finds the changes of the readings, over 4πε, by a body in one pose.
  /// @param loads potentials of the given charges (columns) at the body's points
  /// @param matrix its potential coefficients with the machine there
  /// @param to_ground as in MachinePotentials::changes()
  /// @return false if the matrix is not positive definite, as within the machine
  bool find_changes(const MatrixXd& loads, const MatrixXd& matrix, std::optional<double> to_ground,
                    Eigen::Ref<Eigen::RowVectorXd> changes) const {
    const Eigen::LLT<MatrixXd> factor(matrix);
    if (factor.info() != Eigen::Success)
      return false;
    MatrixXd charges = factor.solve(loads);
    if (to_ground) {
      const Eigen::VectorXd ones = Eigen::VectorXd::Ones(matrix.rows());
      detail::FloatingCharges().take(ones, factor.solve(ones), Eigen::VectorXd::Constant(1, *to_ground),
                                     charges);
    }
    for (std::size_t k = 0; k < readings.size(); ++k) {
      const Index sense = index_of(readings[k].sense), drive = index_of(readings[k].drive);
      changes[index_of(k)] = readings[k].sign * loads.col(sense).dot(charges.col(drive));
    }
    return true;
  }

  const detail::MachineLink& link() const { return machine.links().front(); }

  detail::LinkedMachine machine;
  detail::OutsidePotentials potentials;
  std::vector<OfReading> readings;
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

double MachinePotentials::error() const {
  return machine_->link().error();
}

std::size_t MachinePotentials::panels() const {
  return machine_->potentials.panels();
}

TrianglePotentials MachinePotentials::at(std::span<const Vector3d> points, std::size_t threads) const {
  return machine_->potentials.at(points, false, nullptr, threads)
      .of_given.leftCols(machine_->machine.loads());
}

MatrixXf MachinePotentials::answers(std::span<const Vector3d> places, std::size_t threads) const {
  return detail::answer_modes(machine_->link(), detail::root_of_answers(machine_->link()),
                              machine_->potentials, places, most_answers, threads)
      .charges;
}

MachinePotentials::Changes MachinePotentials::changes(const Body& body,
                                                      std::span<const Eigen::Isometry3d> poses,
                                                      const MatrixXf& answers,
                                                      std::optional<double> to_ground,
                                                      std::size_t threads) const {
  const Index count = index_of(body.points.size());
  if (body.potentials.rows() != count || body.potentials.cols() != count || count == 0)
    throw InputError(fmt::format("potentials: {} × {} values for {} points", body.potentials.rows(),
                                 body.potentials.cols(), count));
  if (const std::size_t parts = machine_->link().functions().count();
      static_cast<std::size_t>(answers.rows()) != parts)
    throw InputError(fmt::format("answers have {} rows, but there are {} parts", answers.rows(), parts));
  std::vector<Vector3d> positions;
  positions.reserve(poses.size());
  for (const Eigen::Isometry3d& pose : poses)
    positions.emplace_back(pose.translation());
  const std::vector<std::size_t> order = detail::along_curve(positions);
  Changes result{MatrixXd::Zero(index_of(poses.size()), index_of(machine_->readings.size())),
                 std::vector<bool>(poses.size())};
  // Threads cannot write single bits.
  std::vector<char> clears(poses.size());
  const std::size_t together = std::max(std::size_t{1}, points_together / body.points.size());
  detail::parallel_for((poses.size() + together - 1) / together, threads, [&](std::size_t group) {
    const auto indices =
        std::span(order).subspan(group * together, std::min(together, poses.size() - group * together));
    std::vector<Vector3d> points;
    for (const std::size_t index : indices)
      for (const Vector3d& point : body.points)
        points.emplace_back(poses[index] * point);
    const detail::OutsidePotentials::Values values =
        machine_->potentials.at(points, answers.cols() > 0, &answers, 1);
    Eigen::RowVectorXd changes(result.values.cols());
    for (std::size_t k = 0; k < indices.size(); ++k) {
      const Index first = index_of(k) * count;
      const MatrixXd matrix =
          body.potentials - products_of_rows(values.of_functions.middleRows(first, count));
      const MatrixXd loads = values.of_given.middleRows(first, count).cast<double>();
      clears[indices[k]] = machine_->find_changes(loads, matrix, to_ground, changes) ? 1 : 0;
      if (clears[indices[k]] != 0)
        result.values.row(index_of(indices[k])) = changes;
    }
  });
  std::copy(clears.begin(), clears.end(), result.clears.begin());
  return result;
}

}  // namespace fringe
