#include "reduced/reduced_capacitance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fringe/capacitance.hpp"
#include "fringe/error.hpp"
#include "fringe/reading.hpp"
#include "numeric/interruption.hpp"
#include "readings/matrix_readings.hpp"
#include "readings/maxwell_matrix.hpp"
#include "readings/readings.hpp"
#include "reduced/arrangement.hpp"
#include "reduced/reduced_derivatives.hpp"
#include "reduced/reduced_readings.hpp"
#include "reduced/reduced_system.hpp"
#include "surface/charged_readings.hpp"

namespace fringe {
namespace {

using detail::check_interruption;
using detail::PreparedShape;
using detail::ReducedSolution;
using detail::RigidBody;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double strictest_reduced_rtol = 1e-4;
constexpr double loosest_reduced_rtol = 0.5;

/// Least number of times that each body responds to the charges of the others: the accuracy that 1 and 2 of
/// them mostly have. More are taken if the error requires it.
int first_steps(double rtol) {
  return rtol >= 1e-2 ? 1 : rtol >= 1e-3 ? 2 : 3;
}

/// Estimated error per contribution of the highest functions. This contribution is estimated from each body
/// alone, and somewhat too large; in random poses the error was mostly a quarter of it, and once 1.13 times
/// it.
constexpr double error_per_discretisation = 1.25;

/// Fractions of rtol that truncation and quadratures may take.
constexpr double truncation_share = 0.3;
constexpr double quadrature_share = 0.3;

/// Fraction of rtol that the triangles' size may take of a body's energies.
constexpr double triangle_share = 0.25;

/// Returns the scene; throws InputError if it has a room.
const Scene& in_free_space(const Scene& scene) {
  if (scene.has_room)
    throw InputError("room: the reduced method computes only conductors in free space");
  return scene;
}

/// Largest number of steps. Near contact, more steps are needed than are asked for.
constexpr int most_steps = 12;

/// Largest error of a conductor's own charge, relative, that is believed: before plates of 2 and 10 cm those
/// below held, and some from 0.4 on were too small by any factor.
constexpr double most_unresolved = 0.35;

double valid_rtol(const ReducedOptions& options) {
  if (!(options.rtol >= strictest_reduced_rtol && options.rtol <= loosest_reduced_rtol))
    throw InputError(fmt::format("rtol {} must be from {} to {}", options.rtol, strictest_reduced_rtol,
                                 loosest_reduced_rtol));
  return options.rtol;
}

}  // namespace

class ReducedEvaluator::Implementation {
 public:
  /// `readings` are those whose changes are asked for.
  Implementation(const Scene& scene, const ReducedOptions& options, std::vector<Reading> readings,
                 std::shared_ptr<detail::LinkPoses> poses)
      : rtol_(valid_rtol(options)), readings_(std::move(readings)),
        bodies_(in_free_space(scene), options.contacts, triangle_share * rtol_, std::move(poses)) {
    factor_ = 4 * std::numbers::pi * vacuum_permittivity * scene.medium.relative_permittivity;
  }

  void set_pose(std::string_view link, const Eigen::Isometry3d& pose) { bodies_.set_pose(link, pose); }

  MaxwellMatrix& maxwell(bool with_derivatives) {
    bodies_.update();
    if (is_settled() && with_derivatives == with_derivatives_)
      return answer_;
    with_derivatives_ = with_derivatives;
    if (known_joinings_ != bodies_.joinings())
      begin_system();
    for (std::size_t a = 0; a < count(); ++a)
      for (std::size_t b = a + 1; b < count(); ++b)
        if (bodies_.has_moved(a, b))
          functions_[a * count() + b] = {0, 0};
    if (is_too_narrow_for_functions())
      write_no_result();
    else
      refine_until_reached();
    if (!answer_.reached)
      forget_unresolved();
    if (answer_.unknowns > 0)
      add_facet_errors(system_->solution());
    if (with_derivatives_)
      write_derivatives();
    bodies_.settle();
    return answer_;
  }

  bool covers_sensors() const { return bodies_.covers_sensors(); }

 private:
  /// Returns whether the answer is that of the present poses.
  bool is_settled() const {
    if (known_joinings_ != bodies_.joinings())
      return false;
    for (std::size_t a = 0; a < count(); ++a)
      for (std::size_t b = a + 1; b < count(); ++b)
        if (bodies_.has_moved(a, b))
          return false;
    return true;
  }

  /// Largest digits of the quadratures (natural logarithm): more than single precision can use.
  static constexpr double most_digits = 16;

  /// Digits of the quadratures (natural logarithm) with which changes begin beyond those of the entries. Most
  /// poses need 3 to 5: a change is a small part of the entries.
  static constexpr double digits_of_changes = 4;

  /// Returns the first digits of the inner quadrature; the outer one gets half of them.
  double first_digits() const {
    return std::max(6 - 2 * std::log10(rtol_ / 1e-3), 3.0) + (looks_for_changes() ? digits_of_changes : 0);
  }

  std::size_t count() const { return bodies_.rigid().size(); }

  /// Returns whether there are targets whose changes can be found in the basis of all bodies.
  bool looks_for_changes() const {
    return !readings_.empty() && bodies_.machine_bodies().value_or(count()) < count();
  }

  /// Begins the equations of the bodies as they are joined now.
  void begin_system() {
    answer_ = detail::named_answer(bodies_.bodies());
    has_several_members_ =
        std::any_of(answer_.members.begin(), answer_.members.end(),
                    [](const std::vector<std::string>& members) { return members.size() > 1; });
    std::vector<detail::ReducedBody> reduced;
    for (const RigidBody& body : bodies_.rigid())
      reduced.push_back({body.shape, body.scale,
                         body.parts.empty() ? bodies_.bodies().conductors.size()
                                            : bodies_.bodies().bodies[body.parts.front()].conductor,
                         0});
    functions_.assign(count() * count(), {0, 0});
    charged_readings_ = detail::charged_readings(readings_, detail::drivable_conductors(bodies_.bodies()));
    system_.emplace(std::move(reduced), answer_.sensors, bodies_.bodies().conductors.size(),
                    readings_.empty() ? std::nullopt : bodies_.machine_bodies());
    known_joinings_ = bodies_.joinings();
  }

  /// Returns true if a body induces a charge on another that is narrower than any function there. Solutions
  /// with fewer and with more functions then miss it alike, and their difference says nothing about the
  /// error.
  bool is_too_narrow_for_functions() const {
    const double functions = detail::functions_of_level(PreparedShape::levels - 1);
    for (std::size_t large = 0; large < count(); ++large)
      for (std::size_t small = 0; small < count(); ++small)
        if (large != small && functions * (bodies_.rigid()[small].scale + bodies_.gap(small, large)) <
                                  bodies_.rigid()[large].scale)
          return true;
    return false;
  }

  /// Forgets the errors of charges that are hardly resolved: those opposite another body, which grow without
  /// limit as the gap closes, may be many times what is found.
  void forget_unresolved() {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    std::vector<bool> unresolved;
    for (Index k = 0; k < answer_.values.rows(); ++k)
      unresolved.push_back(answer_.errors(k, k) > most_unresolved * answer_.values(k, k));
    for (std::size_t a = 0; a < unresolved.size(); ++a)
      for (std::size_t b = 0; b < unresolved.size(); ++b)
        if (unresolved[a] && unresolved[b])
          answer_.errors(static_cast<Index>(a), static_cast<Index>(b)) = infinite;
    for (std::size_t s = 0; s < answer_.sensors; ++s)
      if (unresolved[s])
        answer_.delta_self_errors[static_cast<Index>(s)] = infinite;
    for (std::size_t k = 0; k < answer_.readings.size(); ++k) {
      const auto sensed = std::ranges::find(answer_.conductors, readings_[k].sense);
      if (unresolved[static_cast<std::size_t>(sensed - answer_.conductors.begin())])
        answer_.readings[k].value.error = answer_.readings[k].change.error = infinite;
    }
  }

  void refine_until_reached() {
    double digits = first_digits();
    int steps = first_steps(rtol_);
    choose_levels();
    while (true) {
      lay_nodes(digits);
      const detail::ReductionLimits limits{steps, most_steps, truncation_share * rtol_};
      const ReducedSolution& solution = system_->solve(limits);
      if (!solution.positive_definite) {
        if (digits >= most_digits) {
          write_no_result();
          break;
        }
        digits = most_digits;
        continue;
      }
      write_solution(solution);
      if (answer_.reached || triangles_are_too_coarse(solution))
        break;
      const double more_digits = missing_digits(solution);
      const bool tightened = more_digits > 0 && digits < most_digits;
      if (tightened)
        digits = std::min(digits + more_digits, most_digits);
      const bool stepped = in_changes_.truncation > truncation_share * rtol_ && steps < most_steps;
      if (stepped)
        ++steps;
      if (!raise_levels(solution) && !tightened && !stepped)
        break;
    }
  }

  /// Chooses the numbers of functions that the nearness of the other bodies will require. The rule need not
  /// be exact, because the estimated error decides in the end.
  void choose_levels() {
    const double asked = rtol_ > 3e-3 ? 1 : 2;
    const int first = rtol_ > 3e-3 ? 0 : 1;
    for (std::size_t a = 0; a < count(); ++a) {
      int level = first;
      if (bodies_.rigid()[a].shape->mesh() != nullptr)
        level = level_for_gap(a, std::array{0.6, 0.25, 0.1});
      // A box gets more functions on its six faces only when the error requires them, which its fewest do not
      // tell where a gap is narrow.
      if (bodies_.rigid()[a].shape->is_box())
        level = std::max(level, level_for_gap(a, std::array{0.5, 0.15}));
      const bool is_plate = bodies_.rigid()[a].shape->is_plate();
      for (std::size_t b = 0; b < count(); ++b)
        if (a != b && is_plate) {
          const double wanted =
              1 + asked / detail::least(bodies_.smoothness(a, b), bodies_.rigid()[a].shape->faces().size());
          while (level + 1 < most_levels(a) && detail::functions_of_level(level) < wanted)
            ++level;
        }
      system_->bodies()[a].level = level;
    }
  }

  /// Returns the level of a body: the nearer the others, the more functions it needs.
  /// @param gaps relative to its size, at which it needs one level more each
  template <std::size_t count_of_gaps>
  int level_for_gap(std::size_t body, const std::array<double, count_of_gaps>& gaps) const {
    double gap = std::numeric_limits<double>::infinity();
    for (std::size_t other = 0; other < count(); ++other)
      if (other != body)
        gap = std::min(gap, bodies_.gap(body, other) / bodies_.rigid()[body].scale);
    return static_cast<int>(std::count_if(gaps.begin(), gaps.end(), [&](double end) { return gap <= end; }));
  }

  /// Returns the number of levels of a body. The last one of a box takes too long to prepare.
  int most_levels(std::size_t body) const {
    return bodies_.rigid()[body].shape->is_box() ? PreparedShape::levels - 1 : PreparedShape::levels;
  }

  /// Raises the levels of bodies whose highest functions contribute too much. Returns false if there are
  /// none.
  bool raise_levels(const ReducedSolution& solution) {
    bool raised = false;
    const double share = rtol_ / (2 * error_per_discretisation * static_cast<double>(count()));
    for (std::size_t k = 0; k < count(); ++k) {
      int& level = system_->bodies()[k].level;
      const double part = std::max(solution.body_discretisation[static_cast<Index>(k)],
                                   in_changes_.body_discretisation[static_cast<Index>(k)]);
      if (part <= share || level + 1 >= most_levels(k))
        continue;
      ++level;
      raised = true;
    }
    return raised;
  }

  /// Returns true if the triangles limit the accuracy, so that more functions and nodes are in vain.
  bool triangles_are_too_coarse(const ReducedSolution& solution) const {
    const Index rows = answer_.values.rows();
    return ((error_per_discretisation * solution.coarser).topLeftCorner(rows, rows).array().abs() >
            rtol_ * solution.values.topLeftCorner(rows, rows).array().abs())
        .any();
  }

  /// Returns the digits that the quadratures lack to take no more than their share of the error.
  double missing_digits(const ReducedSolution& solution) {
    for (std::size_t a = 0; a < count(); ++a)
      for (std::size_t b = a + 1; b < count(); ++b)
        if (system_->pair(a, b).is_cut_short())
          return 0;
    const Index rows = answer_.values.rows();
    const double of_entries = (solution.quadrature.topLeftCorner(rows, rows).array() * factor_ *
                               bodies_.unit() / answer_.values.array().abs())
                                  .maxCoeff();
    // Where changes cannot become as accurate as asked, their quadratures need not either.
    const double excess =
        std::max(of_entries / rtol_, in_changes_.quadrature / std::max(rtol_, in_changes_.error)) /
        quadrature_share;
    return excess > 1 ? std::log(excess) + 0.5 : 0;
  }

  /// Returns the number of functions along every direction of a face, or of all functions of a body of
  /// triangles.
  int functions_of(std::size_t body) {
    const int level = system_->bodies()[body].level;
    return bodies_.rigid()[body].shape->mesh() != nullptr
               ? static_cast<int>(bodies_.rigid()[body].shape->level(level).count)
               : detail::functions_of_level(level);
  }

  void lay_nodes(double digits) {
    for (std::size_t a = 0; a < count(); ++a)
      for (std::size_t b = a + 1; b < count(); ++b) {
        const int of_a = functions_of(a), of_b = functions_of(b);
        const std::array<int, 2> functions{of_a, of_b};
        if (functions_[a * count() + b] == functions && digits == digits_)
          continue;
        check_interruption();
        functions_[a * count() + b] = functions;
        if (b < bodies_.machine_bodies().value_or(count()))
          system_->forget_machine();
        system_->pair(a, b).place(bodies_.placed(a), bodies_.smoothness(a, b), of_a, bodies_.placed(b),
                                  bodies_.smoothness(b, a), of_b, bodies_.gap(a, b), {digits / 2, digits});
      }
    digits_ = digits;
  }

  /// Adds the errors by the facets of round shapes, which nothing here can reduce.
  void add_facet_errors(const ReducedSolution& solution) {
    const MatrixXd at = detail::potentials(solution.values, bodies_.bodies());
    const VectorXd effects = detail::error_per_facet_effect * factor_ * bodies_.unit() *
                             (at.transpose() * solution.facets * at).diagonal().cwiseMax(0);
    const VectorXd roots = effects.cwiseSqrt();
    answer_.errors += roots * roots.transpose();
    answer_.delta_self_errors += effects.head(answer_.delta_self_errors.size());
    answer_.reached &= (answer_.errors.array() <= rtol_ * answer_.values.array().abs()).all();
    if (answer_.readings.empty())
      return;
    const double unit = detail::error_per_facet_effect * factor_ * bodies_.unit();
    for (std::size_t k = 0; k < answer_.readings.size(); ++k) {
      const auto at_reading = static_cast<Index>(k);
      *answer_.readings[k].value.error += unit * in_changes_.facets.value[at_reading];
      *answer_.readings[k].background.error += unit * in_changes_.facets.background[at_reading];
      *answer_.readings[k].change.error += unit * in_changes_.facets.change[at_reading];
    }
    answer_.reached &= (detail::errors_of_changes(answer_.readings).array() <= rtol_).all();
  }

  /// Writes the solution and its estimated errors to the answer.
  void write_solution(const ReducedSolution& solution) {
    const MatrixXd fine = detail::without_floating(solution.values, bodies_.bodies());
    const MatrixXd stepped =
        detail::without_floating(solution.values - solution.truncation, bodies_.bodies());
    const MatrixXd resolved =
        detail::without_floating(solution.values - solution.discretisation, bodies_.bodies());
    const Index rows = fine.rows(), sensors = static_cast<Index>(answer_.sensors);
    const auto quadrature = solution.quadrature.topLeftCorner(rows, rows);
    answer_.values = fine;
    answer_.charges = has_several_members_ ? member_charges(solution, fine) : fine;
    answer_.errors = solution.truncation_left * detail::changes(fine, stepped) +
                     error_per_discretisation * detail::changes(fine, resolved) + quadrature;
    answer_.reached = (answer_.errors.array() <= rtol_ * fine.array().abs()).all();
    answer_.delta_self.resize(sensors);
    answer_.delta_self_errors.resize(sensors);
    for (Index s = 0; s < sensors; ++s) {
      // The difference that is known without cancellation does not contain the effect of floating conductors.
      const double floating = solution.values(s, s) - fine(s, s);
      answer_.delta_self[s] = solution.delta_self[s] - floating;
      const double relative = solution.discretisation(s, s) / solution.values(s, s);
      answer_.delta_self_errors[s] =
          solution.truncation_left * solution.delta_truncation[s] +
          error_per_discretisation *
              (solution.delta_discretisation[s] + relative * (solution.delta_self[s] + floating)) +
          quadrature(s, s) + std::numeric_limits<float>::epsilon() * std::abs(floating);
    }
    answer_.unknowns = solution.vectors;
    answer_.values *= factor_ * bodies_.unit();
    answer_.charges *= factor_ * bodies_.unit();
    answer_.errors *= factor_ * bodies_.unit();
    answer_.delta_self *= factor_ * bodies_.unit();
    answer_.delta_self_errors *= factor_ * bodies_.unit();
    find_readings(solution);
  }

  /// Finds the readings, if the bodies of the machine are not joined with the targets.
  void find_readings(const ReducedSolution& solution) {
    answer_.readings.clear();
    in_changes_ = {{}, VectorXd::Zero(static_cast<Index>(count())), 0, 0, 0, {}, {}};
    if (!solution.change)
      return;
    in_changes_ =
        detail::reduced_readings(charged_readings_, solution, error_per_discretisation, bodies_.bodies());
    answer_.readings = in_changes_.answers;
    for (ReadingAnswer& reading : answer_.readings)
      detail::scale(reading, factor_ * bodies_.unit());
    if ((detail::errors_of_changes(answer_.readings).array() > rtol_).any())
      answer_.reached = false;
  }

  /// Writes the derivatives of the changes, whose errors follow from those of the changes with all their
  /// parts.
  void write_derivatives() {
    const double unit = factor_ * bodies_.unit();
    for (std::size_t k = 0; k < answer_.readings.size(); ++k)
      in_changes_.answers[k].change.error = *answer_.readings[k].change.error / unit;
    if (!answer_.readings.empty())
      detail::write_derivatives(*system_, bodies_, charged_readings_, in_changes_);
    for (std::size_t k = 0; k < answer_.readings.size(); ++k) {
      detail::scale(in_changes_.answers[k], unit);
      answer_.readings[k].derivatives = in_changes_.answers[k].derivatives;
    }
  }

  /// Returns the charges of the conductors' members. What they lack of their conductor's entry in `fine` is
  /// distributed over them in proportion to their magnitudes.
  MatrixXd member_charges(const ReducedSolution& solution, const MatrixXd& fine) {
    const MatrixXd of_surfaces = system_->surface_charges();
    MatrixXd of_bodies(static_cast<Index>(bodies_.bodies().bodies.size()), of_surfaces.cols());
    Index row = 0;
    for (const RigidBody& body : bodies_.rigid()) {
      for (const std::size_t part : body.parts)
        of_bodies.row(static_cast<Index>(part)) = of_surfaces.row(row++);
      // Dielectric bodies alone have a row, too, and no charge.
      row += body.parts.empty() ? 1 : 0;
    }
    MatrixXd charges = detail::member_charges(solution.values, of_bodies, bodies_.bodies());
    Index first = 0;
    for (Index conductor = 0; conductor < fine.rows(); ++conductor) {
      const auto members = static_cast<Index>(answer_.members[static_cast<std::size_t>(conductor)].size());
      auto own = charges.middleRows(first, members);
      first += members;
      if (members == 1) {
        own = fine.row(conductor);
        continue;
      }
      const Eigen::RowVectorXd missing = fine.row(conductor) - own.colwise().sum();
      const Eigen::RowVectorXd total = own.cwiseAbs().colwise().sum();
      const MatrixXd shares = own.cwiseAbs() * total.cwiseInverse().asDiagonal();
      own += shares * missing.asDiagonal();
    }
    return charges;
  }

  /// Fills the answer with zeros and infinite errors: no result.
  void write_no_result() {
    const auto rows = static_cast<Index>(answer_.conductors.size());
    const auto sensors = static_cast<Index>(answer_.sensors);
    constexpr double infinite = std::numeric_limits<double>::infinity();
    answer_.values = MatrixXd::Zero(rows, rows);
    Index members = 0;
    for (const std::vector<std::string>& names : answer_.members)
      members += static_cast<Index>(names.size());
    answer_.charges = MatrixXd::Zero(members, rows);
    answer_.errors = MatrixXd::Constant(rows, rows, infinite);
    answer_.delta_self = VectorXd::Zero(sensors);
    answer_.delta_self_errors = VectorXd::Constant(sensors, infinite);
    answer_.readings.clear();
    answer_.reached = false;
    answer_.unknowns = 0;
  }

  double rtol_;
  std::vector<Reading> readings_;
  bool with_derivatives_ = false;  ///< if the answer has them
  double factor_ = 1;
  detail::Arrangement bodies_;
  std::size_t known_joinings_ = 0;  ///< that system_ belongs to
  bool has_several_members_ = false;
  std::vector<std::array<int, 2>> functions_;  ///< for which the pairs have nodes; 0: none
  double digits_ = 0;
  std::optional<detail::ReducedSystem> system_;
  std::vector<detail::ChargedReading> charged_readings_;  ///< by the conductors as they are joined now
  detail::ReducedReadings in_changes_;                    ///< in the last solution
  MaxwellMatrix answer_;
};

ReducedEvaluator::ReducedEvaluator(const Scene& scene, const ReducedOptions& options)
    : ReducedEvaluator(scene, options, std::make_shared<detail::LinkPoses>(scene.links)) {}
ReducedEvaluator::ReducedEvaluator(const Scene& scene, const ReducedOptions& options,
                                   std::shared_ptr<detail::LinkPoses> poses)
    : options_(options), poses_(std::move(poses)), scene_(scene) {
  if (options.with_changes || asks_for_changes(scene))
    readings_ = readings(scene);
  implementation_ = std::make_unique<Implementation>(scene_, options, readings_, poses_);
}
ReducedEvaluator::~ReducedEvaluator() = default;
ReducedEvaluator::ReducedEvaluator(ReducedEvaluator&&) noexcept = default;
ReducedEvaluator& ReducedEvaluator::operator=(ReducedEvaluator&&) noexcept = default;

void ReducedEvaluator::set_pose(std::string_view link, const Eigen::Isometry3d& pose) {
  implementation_->set_pose(link, pose);
}

const MaxwellMatrix& ReducedEvaluator::maxwell(bool with_derivatives) {
  if (with_derivatives && readings_.empty()) {
    // The charges without the objects are not known of a scene that does not ask for changes.
    readings_ = readings(scene_);
    implementation_ = std::make_unique<Implementation>(scene_, options_, readings_, poses_);
  }
  MaxwellMatrix& matrix = implementation_->maxwell(with_derivatives);
  if (implementation_->covers_sensors())
    subtract_bare_sensors(matrix);
  if (readings_.empty())
    matrix.readings = detail::readings_of_sensors(matrix);
  else if (matrix.readings.empty())
    subtract_background(matrix, with_derivatives);
  return matrix;
}

/// Writes what objects, covers included, add to the sensors' own entries. Covers are prepared with the
/// sensors, so that the sensors alone are solved by themselves; that answer is kept as long as they do not
/// move.
void ReducedEvaluator::subtract_bare_sensors(MaxwellMatrix& matrix) {
  if (bare_ == nullptr) {
    Scene bare = scene_;
    bare.objects.clear();
    bare.readings.clear();
    bare_ = std::make_unique<Implementation>(bare, options_, std::vector<Reading>(), poses_);
  }
  const MaxwellMatrix& alone = bare_->maxwell(false);
  for (Index sensor = 0; sensor < static_cast<Index>(matrix.sensors); ++sensor) {
    matrix.delta_self[sensor] = matrix.values(sensor, sensor) - alone.values(sensor, sensor);
    matrix.delta_self_errors[sensor] = matrix.errors(sensor, sensor) + alone.errors(sensor, sensor);
  }
}

void ReducedEvaluator::subtract_background(MaxwellMatrix& matrix, bool with_derivatives) {
  if (background_ == nullptr)
    background_ = std::make_unique<Implementation>(detail::without_targets(scene_), options_,
                                                   std::vector<Reading>(), poses_);
  matrix.readings = detail::readings_of_matrices(readings_, matrix, background_->maxwell(false));
  if (with_derivatives)
    for (ReadingAnswer& reading : matrix.readings)
      for (const Link& link : poses_->links())
        reading.derivatives.push_back(
            {link.name, PoseDerivatives::Constant(std::numeric_limits<double>::quiet_NaN()), {}});
  if ((detail::errors_of_changes(matrix.readings).array() > options_.rtol).any())
    matrix.reached = false;
}

MaxwellMatrix reduced_capacitance(const Scene& scene, const ReducedOptions& options) {
  return ReducedEvaluator(scene, options).maxwell();
}

}  // namespace fringe
