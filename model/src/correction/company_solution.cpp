#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "correction/company.hpp"
#include "reduced/node_kernels.hpp"
#include "simd/dispatch.hpp"

/// The formula in company with all charges that the target's functions can carry: conjugate gradients for the
/// target's matrix with the machine grounded, preconditioned by that of the target alone, for all loads at
/// once (model/CORRECTIONS.md, section 8).
namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;

/// Returns a matrix that is stored in whole blocks.
auto matrix_of(const std::vector<float>& blocks, std::size_t count) {
  const auto size = static_cast<Index>(count);
  return Eigen::Map<const MatrixXf, 0, Eigen::OuterStride<>>(
      blocks.data(), size, size, Eigen::OuterStride<>(whole_blocks(static_cast<std::ptrdiff_t>(count))));
}

/// Solves a small symmetric system, without the directions that rounding leaves of dependent ones.
MatrixXd solved_form(const MatrixXd& form, const MatrixXd& right) {
  /// Part of a direction's energy that rounding may leave.
  constexpr double rounding = 1e-6;
  const VectorXd scales =
      form.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scales.asDiagonal() * form * scales.asDiagonal());
  const VectorXd inverse_values =
      solver.eigenvalues().unaryExpr([](double value) { return value > rounding ? 1 / value : 0; });
  return scales.asDiagonal() *
         (solver.eigenvectors() * (inverse_values.asDiagonal() *
                                   (solver.eigenvectors().transpose() * (scales.asDiagonal() * right))));
}

/// Appends columns to a matrix.
void append(MatrixXf& matrix, const MatrixXf& columns) {
  const Index before = matrix.cols();
  matrix.conservativeResize(columns.rows(), before + columns.cols());
  matrix.rightCols(columns.cols()) = columns;
}

}  // namespace

/// Finds the potentials of the target's functions on the machine's, and those of the given charges.
void CompanyFormula::couple(const MachineAtRest& machine, const TargetAtRest& target) {
  const auto& kernels = best_kernels<NodeKernels>();
  const ChargeFunctions &of_target = target.functions(), &of_machine = machine.functions();
  const std::ptrdiff_t padded = whole_blocks(static_cast<std::ptrdiff_t>(machine_.count));
  coupling_.resize(index_of(of_machine.count()), index_of(of_target.count()));
  given_potentials_.resize(index_of(of_target.count()), machine.given());
  std::size_t point = 0;
  for (std::size_t function = 0; function < of_target.count(); ++function) {
    const FunctionPoints& own = of_target.points(target_.levels[function]);
    std::fill(machine_.potentials.begin(), machine_.potentials.end(), 0.0F);
    for (const std::size_t end = point + own.first[function + 1] - own.first[function]; point < end; ++point)
      kernels.add(target_.shares[point], distances_.data() + static_cast<std::ptrdiff_t>(point) * padded,
                  machine_.potentials.data(), padded);
    for (std::size_t load = 0; load < given_.size(); ++load)
      given_potentials_(index_of(function), index_of(load)) =
          kernels.dot(machine_.potentials.data(), given_[load].data(), padded);
    gather(machine_, of_machine, coupling_.col(index_of(function)).data());
  }
}

const std::vector<CompanyFormula::Change>& CompanyFormula::solved(const MachineAtRest& machine,
                                                                  const TargetAtRest& target,
                                                                  const Isometry3d& pose, double rtol) {
  is_fine_ = true;
  place(machine, target, pose);
  couple(machine, target);
  const Index loads = machine.loads(), floating = index_of(target.floating().size());
  const auto inverse = matrix_of(target.inverse(), target.functions().count());
  const auto answers = matrix_of(machine.answers(), machine.functions().count());
  // The right sides: the potentials of the loads, and unit potentials of the conductors that float.
  MatrixXf right(given_potentials_.rows(), loads + floating);
  right.leftCols(loads) = given_potentials_.leftCols(loads);
  const MatrixXf net = target.net().cast<float>();
  for (Index k = 0; k < floating; ++k)
    right.col(loads + k) = net.col(target.floating()[static_cast<std::size_t>(k)]);

  MatrixXf directions, own, images, on_machine, charged;
  const auto add_directions = [&](const MatrixXf& charges, const MatrixXf& potentials) {
    append(directions, charges);
    append(own, potentials);
    const MatrixXf seen = coupling_ * charges, answer = answers * seen;
    append(on_machine, seen);
    append(charged, answer);
    append(images, potentials - coupling_.transpose() * answer);
  };
  add_directions(target.equilibrium().cast<float>(), net);
  add_directions(inverse * right.leftCols(loads), right.leftCols(loads));
  std::vector<double> before;
  MatrixXd coefficients;
  for (int step = 0; step < most_charge_steps; ++step) {
    MatrixXd form = (directions.transpose() * images).cast<double>();
    form = (form + form.transpose()).eval() / 2;
    const MatrixXd sides = (directions.transpose() * right).cast<double>();
    coefficients = solved_form(form, sides);
    const MatrixXf residual = right - images * coefficients.cast<float>();
    if (floating > 0) {
      // The net charge of what floats is that of its capacitance to the ground.
      MatrixXd block = sides.rightCols(floating).transpose() * coefficients.rightCols(floating);
      block.diagonal() += target.to_ground();
      coefficients.leftCols(loads) -=
          coefficients.rightCols(floating) *
          block.llt().solve(sides.rightCols(floating).transpose() * coefficients.leftCols(loads));
    }
    const MatrixXd changes = sides.leftCols(loads).transpose() * coefficients.leftCols(loads);
    solved_.clear();
    double largest = 0;
    for (const MachineAtRest::OfReading& reading : machine.readings()) {
      const double value = reading.sign * changes(reading.sense, reading.drive);
      const double step_change = step == 0 ? std::abs(value) : std::abs(value - before[solved_.size()]);
      largest = std::max(largest, step_change / std::abs(value));
      solved_.push_back({value, step_change});
    }
    if (!(largest > last_step_part * rtol))
      break;
    before.clear();
    for (const Change& change : solved_)
      before.push_back(change.value);
    if (step + 1 < most_charge_steps)
      add_directions(inverse * residual, residual);
  }
  // What the functions lack is estimated by what their sums lack.
  const MatrixXf chosen = coefficients.leftCols(loads).cast<float>();
  target_charges_ = directions * chosen;
  machine_charges_ = charged * chosen;
  const MatrixXd lacking = target.coarse().defects(target_charges_, own * chosen),
                 unanswered = machine.coarse().defects(machine_charges_, on_machine * chosen);
  // The error of the given potentials is estimated by what fewer panels lack, and more where the panels are
  // too few to tell how fast it falls.
  const MatrixXf shifts = target_charges_.transpose() * given_potentials_.rightCols(loads) *
                          static_cast<float>(std::sqrt(std::max(machine.excess(), 1.0)));
  for (std::size_t k = 0; k < solved_.size(); ++k) {
    const Index sense = machine.readings()[k].sense, drive = machine.readings()[k].drive;
    const auto part = [&](const MatrixXd& defects) {
      return std::sqrt(std::max(defects(sense, sense), 0.0) * std::max(defects(drive, drive), 0.0));
    };
    const double parts = solved_[k].error + part(lacking) + part(unanswered) +
                         std::abs(shifts(sense, drive)) + std::abs(shifts(drive, sense)) +
                         target.error() * std::abs(solved_[k].value);
    // Gaps below a function are not resolved; then the change may be wrong by as much as it is.
    solved_[k].error = std::min(stated_per_parts * parts * std::sqrt(std::max(nearness_, 1.0)),
                                std::max(stated_per_parts * parts, std::abs(solved_[k].value)));
  }
  return solved_;
}

/// Finds the forces between the point charges of target and machine: by the stationarity of the energy, the
/// charges do not change to first order.
std::vector<Wrench> CompanyFormula::wrenches(const MachineAtRest& machine, const TargetAtRest& target) {
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Index loads = machine.loads(), points = index_of(target_.count), sources = index_of(machine_.count);
  const Eigen::Map<const RowMajor, 0, Eigen::OuterStride<>> inverse_distances(
      distances_.data(), points, sources,
      Eigen::OuterStride<>(whole_blocks(static_cast<std::ptrdiff_t>(machine_.count))));
  const auto places = [](const Points& of, Index count, const Eigen::Vector3f& origin) {
    Eigen::Matrix<float, Eigen::Dynamic, 3> result(count, 3);
    result << Eigen::Map<const Eigen::VectorXf>(of.x.data(), count),
        Eigen::Map<const Eigen::VectorXf>(of.y.data(), count),
        Eigen::Map<const Eigen::VectorXf>(of.z.data(), count);
    return (result.rowwise() - origin.transpose()).eval();
  };
  // Coordinates are relative to the target: their products nearly cancel.
  const Eigen::Vector3f centre = places(target_, points, Eigen::Vector3f::Zero()).colwise().mean();
  const Eigen::Matrix<float, Eigen::Dynamic, 3> at = places(target_, points, centre),
                                                from = places(machine_, sources, centre);
  // The charges of every load, and these times each coordinate.
  MatrixXf charges(sources, 4 * loads), on_target(points, loads);
  for (Index load = 0; load < loads; ++load) {
    spread(machine.functions(), machine_charges_.col(load).data(), machine_);
    charges.col(load) =
        Eigen::Map<const Eigen::VectorXf>(machine_.charges.data(), sources) +
        Eigen::Map<const Eigen::VectorXf>(given_[static_cast<std::size_t>(load)].data(), sources);
    spread(target.functions(), target_charges_.col(load).data(), target_);
    on_target.col(load) = Eigen::Map<const Eigen::VectorXf>(target_.charges.data(), points);
    for (Index axis = 0; axis < 3; ++axis)
      charges.col((axis + 1) * loads + load) = charges.col(load).cwiseProduct(from.col(axis));
  }
  const RowMajor cubes = inverse_distances.array().cube();
  const MatrixXf sums = cubes * charges;
  const auto wrench = [&](Index a, Index b) {
    Wrench result;
    for (Index point = 0; point < points; ++point) {
      const Eigen::Vector3f place = at.row(point);
      const Eigen::Vector3f field(sums(point, loads + b), sums(point, 2 * loads + b),
                                  sums(point, 3 * loads + b));
      const Eigen::Vector3d force = (on_target(point, a) * (field - place * sums(point, b))).cast<double>();
      result += {force, (place + centre).cast<double>().cross(force)};
    }
    return result;
  };
  std::vector<Wrench> result;
  for (const auto [sense, drive, sign] : machine.readings()) {
    Wrench& sum = result.emplace_back(sign * wrench(sense, drive));
    sum += sign * wrench(drive, sense);
  }
  return result;
}

}  // namespace fringe::detail
