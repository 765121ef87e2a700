#include "correction/company.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <utility>

#include <Eigen/Eigenvalues>

#include "bem/maxwell_matrix.hpp"
#include "bem/readings.hpp"
#include "correction/company_parts.hpp"
#include "numeric/cholesky.hpp"
#include "reduced/node_kernels.hpp"
#include "reduced/prepared_shape.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Returns the inverse of a single-layer matrix. Functions that coincide up to rounding share their charge.
MatrixXd inverse(const MatrixXd& energies) {
  /// Part of the diagonal that is added, growing until the matrix is positive definite.
  double ridge = 1e-9;
  while (true) {
    MatrixXd matrix = energies;
    matrix.diagonal() *= 1 + ridge;
    const Cholesky factor(std::move(matrix));
    if (factor.is_positive_definite())
      return factor.solve(MatrixXd::Identity(energies.rows(), energies.cols()));
    ridge *= 10;
  }
}

/// Finds the rows of a matrix, which belong to functions, weighted and added up to the sums of functions.
template <typename Matrix>
void sum(const CoarseFunctions& functions, const Matrix& rows, Matrix& sums) {
  sums.setZero(functions.count, rows.cols());
  // Without conductors that float there are no columns, and of an empty matrix no row can be taken.
  for (Index column = 0; column < rows.cols(); ++column)
    for (Index k = 0; k < rows.rows(); ++k)
      sums(functions.of[static_cast<std::size_t>(k)], column) +=
          static_cast<typename Matrix::Scalar>(functions.shares[k]) * rows(k, column);
}

template <typename Matrix>
Matrix summed(const CoarseFunctions& functions, const Matrix& rows) {
  Matrix sums;
  sum(functions, rows, sums);
  return sums;
}

/// Returns the charges by their potentials, with floating conductors: `net` has the net charges on them.
MatrixXd inverse(const MatrixXd& energies, const MatrixXd& net, const VectorXd& to_ground) {
  MatrixXd answers = inverse(energies);
  if (net.cols() > 0) {
    const MatrixXd responses = answers * net;
    MatrixXd block = net.transpose() * responses;
    block.diagonal() += to_ground;
    answers -= responses * block.llt().solve(responses.transpose());
  }
  return answers;
}

}  // namespace

VectorXd to_ground_of(const ChargedBodies& bodies) {
  const std::size_t count = count_of(bodies, Role::floating);
  VectorXd result(index_of(count));
  for (std::size_t k = 0; k < count; ++k)
    result[index_of(k)] = bodies.conductors[bodies.conductors.size() - count + k].to_ground;
  return result;
}

MatrixXd net_on_floating(const ChargeFunctions& functions, const ChargedBodies& bodies) {
  return functions.net(bodies.conductors.size()).rightCols(index_of(count_of(bodies, Role::floating)));
}

namespace {

/// Returns a box around a body.
PlacedBox placed_box(std::span<const Triangle> triangles) {
  const Triangle& first = triangles.front();
  const Vector3d u = (first[1] - first[0]).stableNormalized(),
                 normal = u.cross(first[2] - first[0]).stableNormalized();
  PlacedBox result{Isometry3d::Identity(), {}};
  if (normal.norm() > 0.5) {
    result.to_box.linear().row(0) = u;
    result.to_box.linear().row(1) = normal.cross(u);
    result.to_box.linear().row(2) = normal;
  }
  for (const Triangle& triangle : triangles)
    for (const Vector3d& corner : triangle)
      result.box.extend(result.to_box * corner);
  return result;
}

}  // namespace

std::vector<PlacedBox> boxes_of_used(const ChargedBodies& bodies,
                                     const std::vector<ChargedReading>& readings) {
  std::vector<PlacedBox> boxes;
  for (const ChargedBody& body : bodies.bodies) {
    const auto conductor = static_cast<Index>(body.conductor);
    if (std::none_of(readings.begin(), readings.end(), [&](const ChargedReading& reading) {
          return reading.sense[conductor] != 0 || reading.drive[conductor] != 0;
        }))
      continue;
    boxes.push_back(placed_box(triangulated(body.surface).triangles));
  }
  return boxes;
}

namespace {

/// Distance from a body, relative to its size, within which parts are to be equal in size.
constexpr double softness = 0.2;

}  // namespace

double relative_size(const AlignedBox3d& part, const std::vector<PlacedBox>& used) {
  const double size = part.diagonal().norm();
  double largest = 0;
  for (const PlacedBox& box : used) {
    const AlignedBox3d around = moved_box(box.box, box.to_box.inverse(Eigen::Isometry));
    largest =
        std::max(largest, size / (part.exteriorDistance(around) + softness * box.box.diagonal().norm()));
  }
  return largest;
}

namespace {

/// Returns the importance of dividing a part of a target.
double importance_for(const ChargeFunctions::Part& part, const std::optional<Approach>& approach) {
  if (!approach)
    return part.box.diagonal().squaredNorm() * part.density * part.density_of_body;
  const double size = approach->relative_size(part.box);
  return size * size * part.density / part.density_of_body;
}

}  // namespace

std::pair<MatrixXd, std::vector<MachineAtRest::OfReading>>
loads_of(const std::vector<ChargedReading>& readings, Index conductors) {
  std::vector<VectorXd> loads;
  const auto place = [&](const VectorXd& load) {
    auto known = std::find(loads.begin(), loads.end(), load);
    if (known == loads.end())
      known = loads.insert(loads.end(), load);
    return known - loads.begin();
  };
  std::vector<MachineAtRest::OfReading> places;
  for (const ChargedReading& reading : readings) {
    const double sign = reading.sense.sum() > 0 ? 1 : -1;
    const Index sense = place(sign * reading.sense), drive = place(reading.drive);
    places.push_back({sense, drive, sign});
  }
  MatrixXd matrix(conductors, static_cast<Index>(loads.size()));
  for (std::size_t k = 0; k < loads.size(); ++k)
    matrix.col(static_cast<Index>(k)) = loads[k];
  return {matrix, places};
}

namespace {

ChargeFunctions functions_of_machine(const ConductorsAtRest& conductors, const std::vector<PlacedBox>& used,
                                     const MatrixXd& loads, const CompanyResolution& resolution) {
  const MatrixXd all = potentials(conductors.matrix(), conductors.bodies());
  const MatrixXd potentials_of_loads = all * loads.topRows(all.cols());
  MatrixXd given = conductors.charges() * potentials_of_loads;
  if (resolution.is_estimated) {
    given.conservativeResize(Eigen::NoChange, 2 * loads.cols());
    given.rightCols(loads.cols()) =
        given.leftCols(loads.cols()) - conductors.coarse_charges() * potentials_of_loads;
  }
  return {conductors, given, [&](const ChargeFunctions::Part& part) { return relative_size(part.box, used); },
          resolution.functions};
}

}  // namespace

AlignedBox3d moved_box(const AlignedBox3d& box, const Isometry3d& pose) {
  AlignedBox3d result;
  for (int corner = 0; corner < 8; ++corner)
    result.extend(pose * box.corner(static_cast<AlignedBox3d::CornerType>(corner)));
  return result;
}

CoarseCharges::CoarseCharges(const ChargeFunctions& functions, const MatrixXd& net, const VectorXd& to_ground)
    : functions_(functions.coarse()) {
  MatrixXd energies = MatrixXd::Zero(functions_.count, functions_.count);
  const auto count = index_of(functions_.of.size());
  for (Index a = 0; a < count; ++a)
    for (Index b = 0; b < count; ++b)
      energies(functions_.of[static_cast<std::size_t>(a)], functions_.of[static_cast<std::size_t>(b)]) +=
          functions_.shares[a] * functions_.shares[b] * functions.energies()(a, b);
  inverse_ = inverse(energies, summed(functions_, net), to_ground).cast<float>();
}

MatrixXd CoarseCharges::defects(const Eigen::MatrixXf& charges, const Eigen::MatrixXf& potentials) const {
  Workspace workspace;
  find_defects(charges, potentials, workspace);
  return std::move(workspace.defects);
}

void CoarseCharges::find_defects(const Eigen::MatrixXf& charges, const Eigen::MatrixXf& potentials,
                                 Workspace& workspace) const {
  sum(functions_, potentials, workspace.sums);
  workspace.answers.noalias() = inverse_ * workspace.sums;
  workspace.energies.noalias() = charges.transpose() * potentials;
  workspace.of_sums.noalias() = workspace.sums.transpose() * workspace.answers;
  workspace.defects = (workspace.energies - workspace.of_sums).cast<double>();
}

MachineAtRest::MachineAtRest(ChargedBodies bodies, const std::vector<Reading>& readings,
                             const CompanyResolution& resolution)
    : MachineAtRest(
          [&] {
            const std::vector<ChargedReading> charged =
                charged_readings(readings, drivable_conductors(bodies));
            for (std::size_t k = 0; k < bodies.conductors.size(); ++k) {
              ChargedConductor& conductor = bodies.conductors[k];
              const auto at = static_cast<Index>(k);
              conductor.is_asked =
                  conductor.role == Role::floating ||
                  std::any_of(charged.begin(), charged.end(), [&](const ChargedReading& reading) {
                    return reading.sense[at] != 0 || reading.drive[at] != 0;
                  });
            }
            const std::vector<PlacedBox> used = boxes_of_used(bodies, charged);
            std::function<double(const AlignedBox3d&)> importance;
            if (resolution.least_panels > 0)
              importance = [&](const AlignedBox3d& box) { return relative_size(box, used); };
            return ConductorsAtRest(std::move(bodies), resolution.rtol, resolution.most_panels,
                                    resolution.least_panels, resolution.threads, importance);
          }(),
          readings, resolution) {}

MachineAtRest::MachineAtRest(const ConductorsAtRest& conductors, const std::vector<Reading>& readings,
                             const CompanyResolution& resolution)
    : error_(conductors.error()), excess_(error_ / resolution.rtol), functions_([&] {
        const ChargedBodies& bodies = conductors.bodies();
        const std::vector<ChargedReading> charged = charged_readings(readings, drivable_conductors(bodies));
        auto [loads, places] = loads_of(charged, static_cast<Index>(bodies.conductors.size()));
        readings_ = std::move(places);
        loads_ = loads.cols();
        used_ = boxes_of_used(bodies, charged);
        return functions_of_machine(conductors, used_, loads, resolution);
      }()),
      coarse_(functions_, net_on_floating(functions_, conductors.bodies()),
              to_ground_of(conductors.bodies())),
      answers_(stored(inverse(functions_.energies(), net_on_floating(functions_, conductors.bodies()),
                              to_ground_of(conductors.bodies())))) {
  find_backgrounds(conductors, charged_readings(readings, drivable_conductors(conductors.bodies())));
}

void MachineAtRest::find_backgrounds(const ConductorsAtRest& conductors,
                                     const std::vector<ChargedReading>& charged) {
  const MatrixXd matrix = without_floating(conductors.matrix(), conductors.bodies());
  const auto product = [&](const VectorXd& a, const VectorXd& b) {
    return a.head(matrix.rows()).dot(matrix * b.head(matrix.rows()));
  };
  const double relative = error_ + functions_.facet_effect_of_given();
  for (const auto& [name, sense, drive] : charged)
    backgrounds_.push_back(
        {product(sense, drive), relative * std::sqrt(product(sense, sense) * product(drive, drive))});
}

namespace {

/// Ratio of the stated error to the parts that are not found by less than half as many functions: these lose
/// more than what functions lack (model/CORRECTIONS.md, section 8).
constexpr double stated_per_estimate = 2;

/// Largest stated error, relative to the change, that an estimate can be trusted to find: beyond it, the next
/// finer functions may change more than these.
constexpr double most_known = 0.75;

/// Largest ratio of a function's radius to its distance from what is sensed or driven at which its points
/// see the gap.
constexpr double most_nearness = 4;

}  // namespace

double Approach::relative_size(const AlignedBox3d& part) const {
  const double size = part.diagonal().norm();
  double largest = 0;
  for (const Isometry3d& pose : poses) {
    const Vector3d centre = pose * part.center();
    for (const PlacedBox& box : boxes)
      largest = std::max(largest, size / (std::max(box.distance(centre) - size / 2, 0.0) +
                                          softness * box.box.diagonal().norm()));
  }
  return largest;
}

TargetAtRest::TargetAtRest(ChargedBodies bodies, const CompanyResolution& resolution,
                           const std::optional<Approach>& approach)
    : TargetAtRest(ConductorsAtRest(std::move(bodies), resolution.rtol, resolution.most_panels,
                                    (approach ? 4 : 2) * resolution.functions, resolution.threads,
                                    approach ? std::bind_front(&Approach::relative_size, &*approach)
                                             : std::function<double(const AlignedBox3d&)>()),
                   resolution, approach) {}

TargetAtRest::TargetAtRest(const ConductorsAtRest& conductors, const CompanyResolution& resolution,
                           const std::optional<Approach>& approach)
    : functions_(
          conductors, MatrixXd(index_of(conductors.mesh().panels().size()), 0),
          [&](const ChargeFunctions::Part& part) { return importance_for(part, approach); },
          resolution.functions),
      coarse_(functions_, MatrixXd(index_of(functions_.count()), 0), VectorXd(0)), rtol_(resolution.rtol),
      error_(conductors.error()) {
  const FunctionPanels& panels = functions_.panels();
  for (std::size_t function = 0; function < functions_.count(); ++function)
    parts_.push_back(placed_box(
        std::span(panels.corners)
            .subspan(panels.first[function], panels.first[function + 1] - panels.first[function])));
  const ChargedBodies& bodies = conductors.bodies();
  const MatrixXd inverse = detail::inverse(functions_.energies());
  inverse_ = stored(inverse);
  // Grounded targets are one conductor here.
  std::vector<VectorXd> columns;
  const MatrixXd net = functions_.net(bodies.conductors.size());
  VectorXd grounded = VectorXd::Zero(net.rows());
  std::vector<double> to_ground;
  for (std::size_t k = 0; k < bodies.conductors.size(); ++k)
    if (bodies.conductors[k].role == Role::floating) {
      floating_.push_back(static_cast<Index>(columns.size()));
      columns.emplace_back(net.col(static_cast<Index>(k)));
      to_ground.push_back(bodies.conductors[k].to_ground);
    } else {
      grounded += net.col(static_cast<Index>(k));
    }
  if (!grounded.isZero(0))
    columns.push_back(grounded);
  MatrixXd ones(net.rows(), static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k)
    ones.col(static_cast<Index>(k)) = columns[k];
  net_ = ones;
  equilibrium_ = inverse * ones;
  own_ = ones.transpose() * equilibrium_;
  to_ground_ = Eigen::Map<const VectorXd>(to_ground.data(), static_cast<Index>(to_ground.size()));
}

double TargetAtRest::distance(std::size_t function, const PlacedBox& box, const Isometry3d& pose) const {
  /// Ratio of a function's radius to the distance of its centre below which the two distances hardly differ.
  constexpr double small = 0.3;
  double distance = box.distance(pose * functions_.centre(function));
  if (functions_.radius(function) < small * distance)
    return distance;
  const Isometry3d to_part = pose.inverse(Eigen::Isometry) * box.to_box.inverse(Eigen::Isometry);
  distance = std::min(distance, parts_[function].distance(to_part * box.box.center()));
  for (int corner = 0; corner < 8; ++corner)
    distance = std::min(
        distance,
        parts_[function].distance(to_part * box.box.corner(static_cast<AlignedBox3d::CornerType>(corner))));
  return distance;
}

const std::vector<CompanyFormula::Change>&
CompanyFormula::changes(const MachineAtRest& machine, const TargetAtRest& target, const Isometry3d& pose) {
  of_machine_ = &machine.functions();
  place(machine, target, pose);
  find_potentials(machine, target);
  find_answers(machine, target);
  combine(machine, target);
  return changes_;
}

/// Places all points and finds the distances between them.
void CompanyFormula::place(const MachineAtRest& machine, const TargetAtRest& target, const Isometry3d& pose) {
  place_target(machine, target, pose);
  place_machine(machine, target, pose);
  const auto padded = static_cast<std::size_t>(whole_blocks(static_cast<std::ptrdiff_t>(machine_.count)));
  if (distances_.size() < target_.count * padded)
    distances_.resize(target_.count * padded);
  best_kernels<NodeKernels>().fill(
      {target_.x.data(), target_.y.data(), target_.z.data(), static_cast<std::ptrdiff_t>(target_.count)},
      {machine_.x.data(), machine_.y.data(), machine_.z.data(), static_cast<std::ptrdiff_t>(machine_.count)},
      distances_.data());
}

double CompanyFormula::nearness(const MachineAtRest& machine, const TargetAtRest& target,
                                const Isometry3d& pose) {
  double nearness = 0;
  for (std::size_t function = 0; function < target.functions().count(); ++function)
    for (const PlacedBox& box : machine.used())
      nearness =
          std::max(nearness, target.functions().radius(function) / target.distance(function, box, pose));
  return nearness;
}

/// Places the target's points, finer where it is close to a body of the machine.
void CompanyFormula::place_target(const MachineAtRest& machine, const TargetAtRest& target,
                                  const Isometry3d& pose) {
  const ChargeFunctions& functions = target.functions();
  target_.levels.resize(functions.count());
  nearness_ = nearness(machine, target, pose);
  target_.x.clear(), target_.y.clear(), target_.z.clear(), target_.shares.clear();
  const Eigen::Isometry3f moved = pose.cast<float>();
  for (std::size_t function = 0; function < functions.count(); ++function) {
    const Vector3d centre = pose * functions.centre(function);
    double nearest = std::numeric_limits<double>::infinity();
    for (const AlignedBox3d& box : machine.functions().boxes())
      nearest = std::min(nearest, box.squaredExteriorDistance(centre));
    const std::size_t level = target_.levels[function] = functions.level(function, std::sqrt(nearest), false);
    const FunctionPoints& points = functions.points(level);
    for (std::size_t k = points.first[function]; k < points.first[function + 1]; ++k) {
      const Eigen::Vector3f at = moved * points.at[k];
      target_.x.push_back(at.x()), target_.y.push_back(at.y()), target_.z.push_back(at.z());
      target_.shares.push_back(points.shares[k]);
    }
  }
  target_.count = target_.x.size();
  target_.charges.resize(target_.count);
  target_.potentials.resize(target_.count);
}

/// Places the machine's points, finer where it is close to a body of the target.
void CompanyFormula::place_machine(const MachineAtRest& machine, const TargetAtRest& target,
                                   const Isometry3d& pose) {
  /// Part of the largest potential that points leave out from which on a function has more of them.
  constexpr double large_part = 0.25;
  const ChargeFunctions& functions = machine.functions();
  const Isometry3d to_target = pose.inverse(Eigen::Isometry);
  machine_.levels.resize(functions.count());
  machine_.x.clear(), machine_.y.clear(), machine_.z.clear(), machine_.shares.clear();
  given_.resize(static_cast<std::size_t>(machine.given()));
  for (std::vector<float>& charges : given_)
    charges.clear();
  // Potentials of the given charges on the target that the points leave out, for every function and load.
  std::vector<double> distances(functions.count());
  const auto missing = [&](std::size_t function) -> VectorXd {
    const auto moments = functions.points(machine_.levels[function]).missing.row(index_of(function));
    return moments.head(machine.loads()).cast<double>() / std::pow(distances[function], 3);
  };
  VectorXd most = VectorXd::Zero(machine.loads());
  for (std::size_t function = 0; function < functions.count(); ++function) {
    const Vector3d centre = to_target * functions.centre(function);
    double nearest = std::numeric_limits<double>::infinity();
    for (const AlignedBox3d& box : target.functions().boxes())
      nearest = std::min(nearest, box.squaredExteriorDistance(centre));
    // Charges of both signs nearly cancel far away, where their moments are what is left.
    machine_.levels[function] =
        std::max(functions.level(function, std::sqrt(nearest), false), ChargeFunctions::first_with_moments);
    distances[function] = std::sqrt(nearest) + functions.radius(function);
    most = most.cwiseMax(missing(function));
  }
  unresolved_.setZero(machine.loads());
  for (std::size_t function = 0; function < functions.count(); ++function) {
    if (machine_.levels[function] == ChargeFunctions::first_with_moments &&
        (missing(function).array() > large_part * most.array()).any())
      ++machine_.levels[function];
    unresolved_ += missing(function).cwiseAbs2();
    const FunctionPoints& points = functions.points(machine_.levels[function]);
    for (std::size_t k = points.first[function]; k < points.first[function + 1]; ++k) {
      machine_.x.push_back(points.at[k].x()), machine_.y.push_back(points.at[k].y());
      machine_.z.push_back(points.at[k].z());
      machine_.shares.push_back(points.shares[k]);
      for (std::size_t load = 0; load < given_.size(); ++load)
        given_[load].push_back(points.given(static_cast<Index>(k), static_cast<Index>(load)));
    }
  }
  unresolved_ = unresolved_.cwiseSqrt();
  machine_.count = machine_.x.size();
  const auto padded = static_cast<std::size_t>(whole_blocks(static_cast<std::ptrdiff_t>(machine_.count)));
  for (std::vector<float>* coordinates : {&machine_.x, &machine_.y, &machine_.z})
    coordinates->resize(padded, padded_coordinate);
  for (std::vector<float>& charges : given_)
    charges.resize(padded, 0.0F);
  machine_.charges.assign(padded, 0.0F);
  machine_.potentials.resize(padded);
}

/// Averages the potentials at the points over each function.
void CompanyFormula::gather(const Points& points, const ChargeFunctions& functions, float* of_functions) {
  std::size_t at = 0;
  for (std::size_t function = 0; function < functions.count(); ++function) {
    const FunctionPoints& own = functions.points(points.levels[function]);
    float sum = 0;
    for (const std::size_t end = at + own.first[function + 1] - own.first[function]; at < end; ++at)
      sum += points.shares[at] * points.potentials[at];
    of_functions[function] = sum;
  }
}

/// Gives the points the charges of the functions.
void CompanyFormula::spread(const ChargeFunctions& functions, const float* of_functions, Points& points) {
  std::size_t at = 0;
  for (std::size_t function = 0; function < functions.count(); ++function) {
    const FunctionPoints& own = functions.points(points.levels[function]);
    for (const std::size_t end = at + own.first[function + 1] - own.first[function]; at < end; ++at)
      points.charges[at] = points.shares[at] * of_functions[function];
  }
}

/// Finds the potentials of the given charges on the target, and at the same time those of the target's own
/// charges on the machine.
void CompanyFormula::find_potentials(const MachineAtRest& machine, const TargetAtRest& target) {
  const auto& kernels = best_kernels<NodeKernels>();
  const auto loads = static_cast<std::size_t>(machine.loads()),
             conductors = static_cast<std::size_t>(target.conductors());
  const ChargeFunctions &of_target = target.functions(), &of_machine = machine.functions();
  const auto padded_target =
                 static_cast<std::size_t>(whole_blocks(static_cast<std::ptrdiff_t>(of_target.count()))),
             padded_machine =
                 static_cast<std::size_t>(whole_blocks(static_cast<std::ptrdiff_t>(of_machine.count())));
  by_given_.resize(loads);
  charges_.resize(loads + conductors);
  on_machine_.resize(loads + conductors);
  for (std::vector<float>& charges : charges_)
    charges.assign(padded_target, 0.0F);
  for (std::vector<float>& values : on_machine_)
    values.assign(padded_machine, 0.0F);
  const NodeMatrix matrix{distances_.data(), static_cast<std::ptrdiff_t>(target_.count),
                          static_cast<std::ptrdiff_t>(machine_.count)};
  for (std::size_t k = 0; k < std::max(loads, conductors); ++k) {
    if (k < conductors)
      for (std::size_t function = 0; function < of_target.count(); ++function)
        charges_[loads + k][function] =
            static_cast<float>(target.equilibrium()(static_cast<Index>(function), static_cast<Index>(k)));
    spread(of_target, charges_[k < conductors ? loads + k : 0].data(), target_);
    kernels.apply(matrix, target_.charges.data(), k < loads ? given_[k].data() : machine_.charges.data(),
                  target_.potentials.data(), machine_.potentials.data());
    if (k < conductors)
      gather(machine_, of_machine, on_machine_[loads + k].data());
    if (k < loads) {
      by_given_[k].assign(padded_target, 0.0F);
      gather(target_, of_target, by_given_[k].data());
    }
  }
}

/// Finds the charges that the given ones displace on the target, and their potentials on the machine; then
/// the energies of all directions, less that of the machine's answers.
void CompanyFormula::find_answers(const MachineAtRest& machine, const TargetAtRest& target) {
  const auto& kernels = best_kernels<NodeKernels>();
  const Index loads = machine.loads(), conductors = target.conductors(), directions = loads + conductors;
  const ChargeFunctions &of_target = target.functions(), &of_machine = machine.functions();
  const auto count = static_cast<std::ptrdiff_t>(of_target.count());
  const NodeMatrix matrix{distances_.data(), static_cast<std::ptrdiff_t>(target_.count),
                          static_cast<std::ptrdiff_t>(machine_.count)};
  form_ = MatrixXd::Zero(directions, directions);
  own_.resize(count, directions);
  own_.rightCols(conductors) = target.net().cast<float>();
  lacking_.resize(count, loads);
  answers_.resize(index_of(of_machine.count()), directions);
  std::vector<float> lacking(static_cast<std::size_t>(whole_blocks(count)));
  potentials_ = MatrixXd::Zero(directions, loads);
  net_ = MatrixXd::Zero(directions, conductors);
  net_.bottomRows(conductors) = target.own();
  form_.bottomRightCorner(conductors, conductors) = target.own();
  const auto as_vector = [&](const std::vector<float>& values) {
    return Eigen::Map<const Eigen::VectorXf>(values.data(), static_cast<Index>(count)).cast<double>();
  };
  MatrixXd by_given(count, loads), displaced(count, loads);
  for (Index load = 0; load < loads; ++load)
    by_given.col(load) = as_vector(by_given_[static_cast<std::size_t>(load)]);
  // The part of a potential that makes a conductor's own charge is left to that direction.
  const MatrixXd net_charges = target.equilibrium().transpose() * by_given;
  const MatrixXd means = target.own().llt().solve(net_charges);
  for (Index load = 0; load < loads; ++load) {
    std::vector<float>& charges = charges_[static_cast<std::size_t>(load)];
    kernels.multiply(target.inverse().data(), count, by_given_[static_cast<std::size_t>(load)].data(),
                     charges.data());
    displaced.col(load) = as_vector(charges) - target.equilibrium() * means.col(load);
    Eigen::Map<Eigen::VectorXf>(charges.data(), static_cast<Index>(count)) =
        displaced.col(load).cast<float>();
    own_.col(load) = (by_given.col(load) - target.net() * means.col(load)).cast<float>();
    spread(of_target, charges.data(), target_);
    kernels.apply(matrix, target_.charges.data(), given_[static_cast<std::size_t>(loads + load)].data(),
                  target_.potentials.data(), machine_.potentials.data());
    gather(machine_, of_machine, on_machine_[static_cast<std::size_t>(load)].data());
    gather(target_, of_target, lacking.data());
    lacking_.col(load) = Eigen::Map<const Eigen::VectorXf>(lacking.data(), static_cast<Index>(count));
  }
  form_.topLeftCorner(loads, loads) = displaced.transpose() * by_given;
  potentials_.topRows(loads) = displaced.transpose() * by_given;
  potentials_.bottomRows(conductors) = net_charges;
  std::vector<float> answer(on_machine_.front().size());
  const auto padded = static_cast<std::ptrdiff_t>(answer.size());
  for (Index a = 0; a < directions; ++a) {
    kernels.multiply(machine.answers().data(), static_cast<std::ptrdiff_t>(of_machine.count()),
                     on_machine_[static_cast<std::size_t>(a)].data(), answer.data());
    answers_.col(a) = Eigen::Map<const Eigen::VectorXf>(answer.data(), answers_.rows());
    for (Index b = a; b < directions; ++b) {
      const double energy =
          kernels.dot(answer.data(), on_machine_[static_cast<std::size_t>(b)].data(), padded);
      form_(a, b) -= energy;
      if (a != b)
        form_(b, a) -= energy;
    }
  }
}

/// Minimises the energy in the directions, with the net charges that floating targets may have.
void CompanyFormula::combine(const MachineAtRest& machine, const TargetAtRest& target) {
  /// Part of a direction's energy that rounding may leave.
  constexpr double rounding = 1e-6;
  const Index loads = machine.loads(), conductors = target.conductors();
  changes_.clear();
  for (const MachineAtRest::OfReading& reading : machine.readings()) {
    std::vector<Index> chosen{reading.sense};
    if (reading.drive != reading.sense)
      chosen.push_back(reading.drive);
    for (Index k = 0; k < conductors; ++k)
      chosen.push_back(loads + k);
    MatrixXd form = form_(chosen, chosen);
    form = (form + form.transpose()).eval() / 2;
    const VectorXd scales =
        form.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scales.asDiagonal() * form * scales.asDiagonal());
    const VectorXd inverse_values =
        solver.eigenvalues().unaryExpr([](double value) { return value > rounding ? 1 / value : 0; });
    const auto solve = [&](const MatrixXd& right) -> MatrixXd {
      return scales.asDiagonal() *
             (solver.eigenvectors() * (inverse_values.asDiagonal() *
                                       (solver.eigenvectors().transpose() * (scales.asDiagonal() * right))));
    };
    const VectorXd sense = potentials_.col(reading.sense)(chosen);
    Charged charged{chosen, solve(sense), solve(potentials_.col(reading.drive)(chosen))};
    if (!target.floating().empty()) {
      const MatrixXd net = net_(chosen, target.floating());
      const MatrixXd responses = solve(net);
      MatrixXd block = net.transpose() * responses;
      block.diagonal() += target.to_ground();
      const Eigen::LLT<MatrixXd> factor(block);
      for (VectorXd* coefficients : {&charged.sensed, &charged.driven})
        *coefficients -= responses * factor.solve(net.transpose() * *coefficients);
    }
    const double change = sense.dot(charged.driven);
    changes_.push_back({reading.sign * change, error(machine, target, reading, charged, change)});
  }
}

/// Returns the energy of the charges that the potential still displaces which a load leaves on the target,
/// with no one else there: what the next step of conjugate gradients would add, at least.
///
/// @param own the potentials of the charges found on the target's functions, by themselves
/// @param answer the charges of the machine's functions that answer them
double CompanyFormula::missing_energy(const TargetAtRest& target, Index load, const Eigen::VectorXf& own,
                                      const Eigen::VectorXf& answer) {
  const auto& kernels = best_kernels<NodeKernels>();
  const ChargeFunctions& functions = target.functions();
  spread(*of_machine_, answer.data(), machine_);
  kernels.apply({distances_.data(), static_cast<std::ptrdiff_t>(target_.count),
                 static_cast<std::ptrdiff_t>(machine_.count)},
                target_.charges.data(), machine_.charges.data(), target_.potentials.data(),
                machine_.potentials.data());
  std::vector<float> left(static_cast<std::size_t>(whole_blocks(own.size()))), displaced = left;
  gather(target_, functions, left.data());
  Eigen::Map<Eigen::VectorXf> residual(left.data(), own.size());
  residual += Eigen::Map<const Eigen::VectorXf>(by_given_[static_cast<std::size_t>(load)].data(), own.size());
  residual -= own;
  // Conductors that float keep a potential of their own.
  const VectorXd means = target.own().llt().solve(target.equilibrium().transpose() * residual.cast<double>());
  residual -= (target.net() * means).cast<float>();
  kernels.multiply(target.inverse().data(), static_cast<std::ptrdiff_t>(own.size()), left.data(),
                   displaced.data());
  return std::max(0.0F, kernels.dot(left.data(), displaced.data(), whole_blocks(own.size())));
}

double facet_effect(double of_given, const TargetAtRest& target, double change,
                    const Eigen::Ref<const Eigen::VectorXf>& sensed,
                    const Eigen::Ref<const Eigen::VectorXf>& driven) {
  return target.functions().facet_effect(sensed, driven) + 2 * of_given * std::abs(change);
}

/// Estimates the error of a change; infinity where that cannot be known.
double CompanyFormula::error(const MachineAtRest& machine, const TargetAtRest& target,
                             const MachineAtRest::OfReading& reading, const Charged& charged, double change) {
  const auto functions = index_of(target.functions().count());
  const bool is_one = reading.sense == reading.drive;
  Eigen::MatrixXf coefficients(index_of(charged.directions.size()), is_one ? 1 : 2);
  coefficients.col(0) = charged.driven.cast<float>();
  if (!is_one)
    coefficients.col(1) = charged.sensed.cast<float>();
  Eigen::MatrixXf charges = Eigen::MatrixXf::Zero(functions, coefficients.cols()), own = charges,
                  answers = Eigen::MatrixXf::Zero(answers_.rows(), coefficients.cols()), seen = answers;
  for (std::size_t k = 0; k < charged.directions.size(); ++k) {
    const Index direction = charged.directions[k];
    const auto of_direction = coefficients.row(index_of(k));
    const auto as_column = [](const std::vector<float>& values, Index count) {
      return Eigen::Map<const Eigen::VectorXf>(values.data(), count);
    };
    charges += as_column(charges_[static_cast<std::size_t>(direction)], functions) * of_direction;
    own += own_.col(direction) * of_direction;
    answers += answers_.col(direction) * of_direction;
    seen += as_column(on_machine_[static_cast<std::size_t>(direction)], answers.rows()) * of_direction;
  }
  const auto part = [&](const MatrixXd& defects) {
    return std::sqrt(std::max(defects(0, 0), 0.0) * std::max(defects.bottomRightCorner(1, 1)(0, 0), 0.0));
  };
  target.coarse().find_defects(charges, own, of_target_);
  machine.coarse().find_defects(answers, seen, of_answers_);
  double missing = missing_energy(target, reading.drive, own.col(0), answers.col(0));
  if (!is_one)
    missing = std::sqrt(missing * missing_energy(target, reading.sense, own.col(1), answers.col(1)));
  const double lacking =
      std::sqrt(std::max(machine.excess(), 1.0)) *
      (std::abs(static_cast<double>(charges.rightCols(1).col(0).dot(lacking_.col(reading.drive)))) +
       std::abs(static_cast<double>(charges.col(0).dot(lacking_.col(reading.sense)))));
  const double of_target = part(of_target_.defects);
  const double of_points = unresolved_[reading.drive] * charges.rightCols(1).cwiseAbs().sum() +
                           unresolved_[reading.sense] * charges.col(0).cwiseAbs().sum();
  const double of_facets = facet_effect(machine.functions().facet_effect_of_given(), target, change,
                                        charges.rightCols(1).col(0), charges.col(0));
  const double others = of_points + target.error_of_panels(change, of_target) + missing + lacking + of_facets;
  const double stated = (of_target + part(of_answers_.defects) + stated_per_estimate * others) *
                        std::sqrt(std::max(nearness_, 1.0));
  return stated < most_known * std::abs(change) && nearness_ < most_nearness
             ? stated
             : std::numeric_limits<double>::infinity();
}

}  // namespace fringe::detail
