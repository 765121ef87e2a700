#include "fringe/reduced_capacitance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bem/bodies.hpp"
#include "bem/contact.hpp"
#include "bem/maxwell_matrix.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/error.hpp"
#include "geometry/link_motion.hpp"
#include "reduced/body_gap.hpp"
#include "reduced/reduced_system.hpp"
#include "reduced/rigid_bodies.hpp"

namespace fringe {
namespace {

using detail::BodySmoothness;
using detail::ChargedBodies;
using detail::PlacedBody;
using detail::PreparedShape;
using detail::ReducedSolution;
using detail::RigidBody;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double strictest_reduced_rtol = 1e-4;
constexpr double loosest_reduced_rtol = 0.5;

/// Default rtol for 1 to most_reduced_steps steps, relative.
constexpr std::array<double, most_reduced_steps> rtols{1e-2, 1e-3, 3e-4};

/// Estimated error per contribution of the highest functions. This contribution is estimated from each body
/// alone, and somewhat too large; in random poses the error was mostly a quarter of it, and once 1.13 times
/// it.
constexpr double error_per_discretisation = 1.25;

/// Fractions of rtol that truncation and quadratures may take.
constexpr double truncation_share = 0.3;
constexpr double quadrature_share = 0.3;

/// Fraction of rtol that the triangles' size may take of a body's energies.
constexpr double triangle_share = 0.25;

/// Largest number of steps. Near contact, more steps are needed than are asked for.
constexpr int most_steps = 12;

double rtol_or_default(const ReducedOptions& options) {
  return options.rtol.value_or(rtols[static_cast<std::size_t>(options.steps - 1)]);
}

void validate_options(const ReducedOptions& options) {
  if (options.steps < 1 || options.steps > most_reduced_steps)
    throw InputError(fmt::format("{} reduced steps must be from 1 to {}", options.steps, most_reduced_steps));
  const double rtol = rtol_or_default(options);
  if (!(rtol >= strictest_reduced_rtol && rtol <= loosest_reduced_rtol))
    throw InputError(
        fmt::format("rtol {} must be from {} to {}", rtol, strictest_reduced_rtol, loosest_reduced_rtol));
}

}  // namespace

double rtol_of(const ReducedOptions& options) {
  validate_options(options);
  return rtol_or_default(options);
}

class ReducedEvaluator::Implementation {
 public:
  Implementation(const Scene& scene, const ReducedOptions& options, std::shared_ptr<detail::LinkPoses> poses)
      : options_(options), rtol_(rtol_of(options)), motion_(std::move(poses)) {
    if (scene.has_room)
      throw InputError("room: the reduced method computes only conductors in free space");
    bodies_ = detail::bodies_on_links(scene);
    answer_ = detail::named_answer(bodies_);
    factor_ = 4 * std::numbers::pi * vacuum_permittivity * scene.medium.relative_permittivity;

    rigid_ = detail::rigid_bodies(scene, bodies_, triangle_share * rtol_, shapes_);
    double largest = 0;
    for (const RigidBody& body : rigid_)
      largest = std::max(largest, body.scale);
    // A power of two: scaling by it does not round.
    unit_ = std::exp2(std::ilogb(largest));
    std::vector<detail::ReducedBody> reduced;
    for (std::size_t k = 0; k < rigid_.size(); ++k) {
      rigid_[k].scale /= unit_;
      reduced.push_back({rigid_[k].shape, rigid_[k].scale, bodies_.bodies[k].conductor, 0});
    }
    const std::size_t count = rigid_.size();
    placed_.resize(count);
    smoothness_.resize(count * count);
    gaps_.resize(count * count);
    functions_.resize(count * count, {0, 0});
    system_.emplace(std::move(reduced), answer_.sensors, bodies_.conductors.size());
  }

  void set_pose(std::string_view link, const Eigen::Isometry3d& pose) { motion_.set_pose(link, pose); }

  const MaxwellMatrix& maxwell() {
    motion_.update();
    place();
    if (is_too_narrow_for_functions())
      write_no_result();
    else
      refine_until_reached();
    motion_.settle();
    known_ = true;
    return answer_;
  }

 private:
  /// Largest digits of the quadratures (natural logarithm): more than single precision can use.
  static constexpr double most_digits = 16;

  /// Returns the first digits of the inner quadrature; the outer one gets half of them.
  double first_digits() const { return std::max(6 - 2 * std::log10(rtol_ / 1e-3), 3.0); }

  bool moved(std::size_t a, std::size_t b) const {
    return !known_ || !motion_.rigid(bodies_.bodies[a].link, bodies_.bodies[b].link);
  }

  /// Returns true if a body induces a charge on another that is narrower than any function there. Solutions
  /// with fewer and with more functions then miss it alike, and their difference says nothing about the
  /// error.
  bool is_too_narrow_for_functions() const {
    const double functions = detail::functions_of_level(PreparedShape::levels - 1);
    for (std::size_t large = 0; large < rigid_.size(); ++large)
      for (std::size_t small = 0; small < rigid_.size(); ++small)
        if (large != small &&
            functions * (rigid_[small].scale + gaps_[pair(small, large)]) < rigid_[large].scale)
          return true;
    return false;
  }

  void refine_until_reached() {
    double digits = first_digits();
    choose_levels();
    while (true) {
      lay_nodes(digits);
      const detail::ReductionLimits limits{options_.steps, most_steps, truncation_share * rtol_};
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
      if (!raise_levels(solution) && !tightened)
        break;
    }
  }

  /// Moves the bodies to their poses; throws InputError for two that touch.
  void place() {
    for (std::size_t k = 0; k < rigid_.size(); ++k) {
      const Eigen::Isometry3d pose = motion_.world_pose(bodies_.bodies[k].link) * rigid_[k].on_link;
      if (!pose.matrix().allFinite())
        throw InputError(fmt::format("{}: its pose is not finite", bodies_.bodies[k].name));
      placed_[k] = {rigid_[k].shape, rigid_[k].scale, pose.translation() / unit_, pose.linear()};
    }
    for (std::size_t a = 0; a < rigid_.size(); ++a)
      for (std::size_t b = a + 1; b < rigid_.size(); ++b) {
        if (!moved(a, b))
          continue;
        const double gap = gap_or_refusal(a, b);
        gaps_[pair(a, b)] = gaps_[pair(b, a)] = gap;
        const detail::PairSmoothness smoothness = detail::smoothness(placed_[a], placed_[b], gap);
        smoothness_[pair(a, b)] = smoothness.a;
        smoothness_[pair(b, a)] = smoothness.b;
        functions_[pair(a, b)] = {0, 0};
      }
  }

  /// Returns a lower bound of the distance between two bodies; throws InputError if they touch.
  double gap_or_refusal(std::size_t a, std::size_t b) {
    /// Gap in units of unit_ above which bodies are apart in spite of rounding; below it the exact test
    /// decides.
    constexpr double surely_apart = 1e-9;
    const double gap = detail::body_gap(placed_[a], placed_[b]);
    if (!(gap > surely_apart))
      detail::refuse_contact(detail::moved(bodies_.bodies[a], motion_.world_pose(bodies_.bodies[a].link)),
                             detail::moved(bodies_.bodies[b], motion_.world_pose(bodies_.bodies[b].link)),
                             "the reduced method needs bodies apart");
    return std::max(gap, 0.0);
  }

  std::size_t pair(std::size_t a, std::size_t b) const { return a * rigid_.size() + b; }

  /// Chooses the numbers of functions that the nearness of the other bodies will require. The rule need not
  /// be exact, because the estimated error decides in the end.
  void choose_levels() {
    const double asked = rtol_ > 3e-3 ? 1 : 2;
    const int first = rtol_ > 3e-3 ? 0 : 1;
    for (std::size_t a = 0; a < rigid_.size(); ++a) {
      int level = first;
      if (rigid_[a].shape->mesh() != nullptr)
        level = mesh_level(a);
      // A box gets more functions on its six faces only when the error requires them.
      const bool is_plate = rigid_[a].shape->is_plate();
      for (std::size_t b = 0; b < rigid_.size(); ++b)
        if (a != b && is_plate) {
          const double wanted =
              1 + asked / detail::least(smoothness_[pair(a, b)], rigid_[a].shape->faces().size());
          while (level + 1 < most_levels(a) && detail::functions_of_level(level) < wanted)
            ++level;
        }
      system_->bodies()[a].level = level;
    }
  }

  /// Returns the level of a body of triangles: the nearer the others, the more functions it needs.
  int mesh_level(std::size_t body) const {
    constexpr std::array<double, PreparedShape::levels - 1> gaps{0.6, 0.25, 0.1};
    double gap = std::numeric_limits<double>::infinity();
    for (std::size_t other = 0; other < rigid_.size(); ++other)
      if (other != body)
        gap = std::min(gap, gaps_[pair(body, other)] / rigid_[body].scale);
    return static_cast<int>(std::count_if(gaps.begin(), gaps.end(), [&](double end) { return gap <= end; }));
  }

  /// Returns the number of levels of a body. The last one of a box takes too long to prepare.
  int most_levels(std::size_t body) const {
    return rigid_[body].shape->is_box() ? PreparedShape::levels - 1 : PreparedShape::levels;
  }

  /// Raises the levels of bodies whose highest functions contribute too much. Returns false if there are
  /// none.
  bool raise_levels(const ReducedSolution& solution) {
    bool raised = false;
    const double share = rtol_ / (2 * error_per_discretisation * static_cast<double>(rigid_.size()));
    for (std::size_t k = 0; k < rigid_.size(); ++k) {
      int& level = system_->bodies()[k].level;
      if (solution.body_discretisation[static_cast<Index>(k)] <= share || level + 1 >= most_levels(k))
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
    for (std::size_t a = 0; a < rigid_.size(); ++a)
      for (std::size_t b = a + 1; b < rigid_.size(); ++b)
        if (system_->pair(a, b).is_cut_short())
          return 0;
    const Index rows = answer_.values.rows();
    const double excess = (solution.quadrature.topLeftCorner(rows, rows).array() * factor_ * unit_ /
                           answer_.values.array().abs())
                              .maxCoeff() /
                          (quadrature_share * rtol_);
    return excess > 1 ? std::log(excess) + 0.5 : 0;
  }

  /// Returns the number of functions along every direction of a face, or of all functions of a body of
  /// triangles.
  int functions_of(std::size_t body) {
    const int level = system_->bodies()[body].level;
    return rigid_[body].shape->mesh() != nullptr ? static_cast<int>(rigid_[body].shape->level(level).count)
                                                 : detail::functions_of_level(level);
  }

  void lay_nodes(double digits) {
    for (std::size_t a = 0; a < rigid_.size(); ++a)
      for (std::size_t b = a + 1; b < rigid_.size(); ++b) {
        const int of_a = functions_of(a), of_b = functions_of(b);
        const std::array<int, 2> functions{of_a, of_b};
        if (functions_[pair(a, b)] == functions && digits == digits_)
          continue;
        functions_[pair(a, b)] = functions;
        system_->pair(a, b).place(placed_[a], smoothness_[pair(a, b)], of_a, placed_[b],
                                  smoothness_[pair(b, a)], of_b, {digits / 2, digits});
      }
    digits_ = digits;
  }

  /// Writes the solution and its estimated errors to the answer.
  void write_solution(const ReducedSolution& solution) {
    const MatrixXd fine = detail::without_floating(solution.values, bodies_);
    const MatrixXd stepped = detail::without_floating(solution.values - solution.truncation, bodies_);
    const MatrixXd resolved = detail::without_floating(solution.values - solution.discretisation, bodies_);
    const Index rows = fine.rows(), sensors = static_cast<Index>(answer_.sensors);
    const auto quadrature = solution.quadrature.topLeftCorner(rows, rows);
    answer_.values = fine;
    answer_.charges = fine;  // Every conductor has one member.
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
    answer_.values *= factor_ * unit_;
    answer_.charges *= factor_ * unit_;
    answer_.errors *= factor_ * unit_;
    answer_.delta_self *= factor_ * unit_;
    answer_.delta_self_errors *= factor_ * unit_;
  }

  /// Fills the answer with zeros and infinite errors: no result.
  void write_no_result() {
    const auto rows = static_cast<Index>(answer_.conductors.size());
    const auto sensors = static_cast<Index>(answer_.sensors);
    constexpr double infinite = std::numeric_limits<double>::infinity();
    answer_.values = MatrixXd::Zero(rows, rows);
    answer_.charges = MatrixXd::Zero(rows, rows);
    answer_.errors = MatrixXd::Constant(rows, rows, infinite);
    answer_.delta_self = VectorXd::Zero(sensors);
    answer_.delta_self_errors = VectorXd::Constant(sensors, infinite);
    answer_.reached = false;
    answer_.unknowns = 0;
  }

  ReducedOptions options_;
  double rtol_;
  detail::LinkMotion motion_;
  ChargedBodies bodies_;
  double unit_ = 1;  ///< of length, in metres
  double factor_ = 1;
  detail::SharedShapes shapes_;
  std::vector<RigidBody> rigid_;
  std::vector<PlacedBody> placed_;
  std::vector<BodySmoothness> smoothness_;     ///< on every body, limited by every other
  std::vector<double> gaps_;                   ///< lower bounds of the distances between any two
  std::vector<std::array<int, 2>> functions_;  ///< for which the pairs have nodes; 0: none
  double digits_ = 0;
  bool known_ = false;  ///< true if there was an answer before
  std::optional<detail::ReducedSystem> system_;
  MaxwellMatrix answer_;
};

ReducedEvaluator::ReducedEvaluator(const Scene& scene, const ReducedOptions& options)
    : ReducedEvaluator(scene, options, std::make_shared<detail::LinkPoses>(scene.links)) {}
ReducedEvaluator::ReducedEvaluator(const Scene& scene, const ReducedOptions& options,
                                   std::shared_ptr<detail::LinkPoses> poses)
    : implementation_(std::make_unique<Implementation>(scene, options, std::move(poses))) {}
ReducedEvaluator::~ReducedEvaluator() = default;
ReducedEvaluator::ReducedEvaluator(ReducedEvaluator&&) noexcept = default;
ReducedEvaluator& ReducedEvaluator::operator=(ReducedEvaluator&&) noexcept = default;

void ReducedEvaluator::set_pose(std::string_view link, const Eigen::Isometry3d& pose) {
  implementation_->set_pose(link, pose);
}

const MaxwellMatrix& ReducedEvaluator::maxwell() {
  return implementation_->maxwell();
}

MaxwellMatrix reduced_capacitance(const Scene& scene, const ReducedOptions& options) {
  return ReducedEvaluator(scene, options).maxwell();
}

}  // namespace fringe
