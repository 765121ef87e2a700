#include "fringe/live_scene.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/interruption.hpp"
#include "fringe/pose.hpp"
#include "fringe/reading.hpp"
#include "geometry/link_motion.hpp"
#include "io/prepared_files.hpp"
#include "numeric/interruption.hpp"
#include "scene/automatic.hpp"
#include "scene/expected_seconds.hpp"
#include "scene/methods.hpp"

namespace fringe {

class LiveScene::Implementation {
 public:
  explicit Implementation(Scene scene)
      : scene_(std::move(scene)), poses_(std::make_shared<detail::LinkPoses>(scene_.links)), size_(scene_),
        methods_(scene_, size_, poses_) {}

  const Scene& scene() const { return scene_; }

  void set_pose(std::string_view link, const Eigen::Isometry3d& pose) {
    poses_->set_pose(link, pose);
    fringe::set_pose(scene_, link, pose);
  }

  /// @param with_sensors whether more than the readings is asked for
  const Evaluation& evaluate(const EvaluationOptions& options, bool with_sensors) {
    validate(options);
    keep_prepared(options);
    std::optional<detail::TimeLimit> limit;
    if (options.max_seconds)
      limit.emplace(*options.max_seconds);
    const Method method = method_of(options);
    count_unknowns(method);
    if (std::holds_alternative<Auto>(method)) {
      answer_ =
          automatic_.evaluate(methods_, scene_, size_, options, with_sensors, limit ? &*limit : nullptr);
    } else {
      const double expected = expected_seconds(method, options);
      answer_by(method, options, with_sensors);
      answer_.expected_seconds = expected;
    }
    note_reached(answer_.readings, method, answer_.reached);
    return answer_;
  }

  const MaxwellMatrix& find_matrix(EvaluationOptions options) {
    if (!options.method)
      options.method = BoundaryElements{};
    const Method method = method_of(options);
    if (!states_errors(method))
      throw InputError(fmt::format("{} finds no Maxwell matrix: boundary-elements, reduced and auto do",
                                   to_string(method)));
    options.entries = Entries::all;
    evaluate(options, true);
    if (!answer_.matrix)
      throw InputError("no method reaches a Maxwell matrix in this time");
    return *answer_.matrix;
  }

  std::vector<std::vector<ReadingAnswer>> readings_of(std::size_t frames,
                                                      const std::function<void(std::size_t)>& pose,
                                                      const EvaluationOptions& options, std::size_t threads) {
    validate(options);
    keep_prepared(options);
    std::optional<detail::TimeLimit> limit;
    if (options.max_seconds)
      limit.emplace(*options.max_seconds);
    EvaluationOptions each = options;
    each.max_seconds.reset();
    std::vector<std::vector<ReadingAnswer>> answers = answers_together(frames, pose, options, threads);
    const bool is_auto = std::holds_alternative<Auto>(method_of(options));
    const double rtol = rtol_of(options);
    for (std::vector<ReadingAnswer>& frame : answers) {
      Evaluation whole;
      whole.readings = frame;
      note_reached(frame, Reduced{}, detail::stated_error(whole, scene_, Entries::of_readings) <= rtol);
    }
    std::string refused;
    bool is_any_answered = !answers.empty();
    for (std::size_t frame = 0; frame < frames; ++frame) {
      if (frame < answers.size() && (!is_auto || detail::are_within(answers[frame], rtol)))
        continue;
      pose(frame);
      try {
        const std::vector<ReadingAnswer>& found = evaluate(each, false).readings;
        is_any_answered = true;
        if (frame < answers.size())
          answers[frame] = found;
        else
          answers.push_back(found);
      } catch (const InputError& error) {
        // Boundary elements do not answer in contact, for instance; other frames have answers.
        if (refused.empty())
          refused = error.what();
        if (frame == answers.size())
          answers.push_back(without_answers());
      } catch (const Interrupted&) {
        // The frames answered by the end of the time are returned.
        if (!limit || !limit->is_over() || answers.empty())
          throw;
        break;
      }
    }
    if (!is_any_answered && !refused.empty())
      throw InputError(refused);
    return answers;
  }

  /// Returns the names of the readings with nothing known of them.
  std::vector<ReadingAnswer> without_answers() const {
    std::vector<ReadingAnswer> result;
    for (const Reading& reading : fringe::readings(scene_))
      result.push_back({reading.name, {}, {}, {}});
    return result;
  }

  const SceneCollision& collide() {
    if (!detector_)
      detector_.emplace(scene_, poses_);
    return detector_->collide();
  }

  std::vector<DistanceReading> sense(ConeMethod method) {
    if (!sensing_ || method != sensing_method_) {
      sensing_.emplace(scene_, method, poses_);
      sensing_method_ = method;
    }
    return sensing_->sense();
  }

 private:
  static void note_reached(std::vector<ReadingAnswer>& readings, const Method& method, bool reached) {
    for (ReadingAnswer& reading : readings)
      reading.reached = states_errors(method) ? std::optional(reached) : std::nullopt;
  }

  void answer_by(const Method& method, const EvaluationOptions& options, bool with_sensors) {
    if (std::holds_alternative<Formula>(method))
      methods_.combine(scene_, options, answer_);
    else if (std::holds_alternative<Reduced>(method))
      methods_.reduce(scene_, options, with_sensors, ReducedContacts::all, detail::Refinement::allowed,
                      answer_);
    else if (std::holds_alternative<BoundaryElements>(method))
      detail::Methods::solve(scene_, options, answer_);
    else
      methods_.integrate(scene_, options, answer_);
  }

  /// Counts what decides how long solutions and preparations take, if there may be any.
  void count_unknowns(const Method& method) {
    if (states_errors(method))
      size_.count_unknowns(scene_);
  }

  double expected_seconds(const Method& method, const EvaluationOptions& options) const {
    const double rtol = rtol_of(options);
    const bool is_reduced = std::holds_alternative<Reduced>(method);
    return detail::expected_seconds(
        method, size_,
        {.rtol = rtol,
         .is_prepared = is_reduced && methods_.is_reduction_prepared(rtol, options.entries),
         .is_by_matrix = methods_.reduces_to_matrix(options.entries),
         .is_rough = is_reduced && methods_.may_be_rough(rtol, options.entries)});
  }

  /// Returns the answers of all frames by the reduced method, which is prepared for all of them; none by
  /// others, or where it does not answer many at once.
  std::vector<std::vector<ReadingAnswer>> answers_together(std::size_t frames,
                                                           const std::function<void(std::size_t)>& pose,
                                                           const EvaluationOptions& options,
                                                           std::size_t threads) {
    const Method method = method_of(options);
    const bool is_auto = std::holds_alternative<Auto>(method);
    count_unknowns(method);
    const bool refines = std::holds_alternative<Reduced>(method) ||
                         (is_auto && automatic_.prefers_reduction(methods_, size_, options, frames));
    const double rtol = rtol_of(options);
    if (!refines && !(is_auto && methods_.may_be_rough(rtol, options.entries)))
      return {};
    try {
      return methods_
          .readings_of(scene_, frames, pose, rtol,
                       refines ? detail::Refinement::allowed : detail::Refinement::none, threads)
          .value_or(std::vector<std::vector<ReadingAnswer>>());
    } catch (const InputError&) {
      if (!is_auto)
        throw;
      return {};
    }
  }

  /// Keeps what is prepared in the folder that is asked for, if one is.
  void keep_prepared(const EvaluationOptions& options) {
    if (!options.prepared)
      files_.reset();
    else if (!files_ || files_->folder() != *options.prepared)
      files_ = std::make_shared<const detail::PreparedFiles>(*options.prepared);
    methods_.keep_in(files_);
  }

  Scene scene_;
  std::shared_ptr<detail::LinkPoses> poses_;
  detail::SceneSize size_;
  detail::Methods methods_;
  detail::Automatic automatic_;
  std::shared_ptr<const detail::PreparedFiles> files_;
  std::optional<CollisionDetector> detector_;
  std::optional<SceneSensing> sensing_;
  ConeMethod sensing_method_ = ConeMethod::field_of_view;
  Evaluation answer_;
};

LiveScene::LiveScene(Scene scene) : implementation_(std::make_unique<Implementation>(std::move(scene))) {}
LiveScene::~LiveScene() = default;
LiveScene::LiveScene(LiveScene&&) noexcept = default;
LiveScene& LiveScene::operator=(LiveScene&&) noexcept = default;

const Scene& LiveScene::scene() const {
  return implementation_->scene();
}

void LiveScene::set_pose(std::string_view link, const Eigen::Isometry3d& pose) {
  implementation_->set_pose(link, pose);
}

void LiveScene::set_poses(const std::vector<Eigen::Isometry3d>& poses) {
  const std::vector<Link>& links = scene().links;
  if (poses.size() != links.size())
    throw InputError(fmt::format("{} poses were given for {} links", poses.size(), links.size()));
  for (std::size_t k = 0; k < links.size(); ++k)
    if (links[k].pose.matrix() != poses[k].matrix())
      set_pose(links[k].name, poses[k]);
}

void LiveScene::set_joint(std::string_view joint, double position) {
  for (const auto& [link, pose] : joint_poses(scene().links, joint, position))
    set_pose(scene().links[link].name, pose);
}

const Evaluation& LiveScene::evaluate(const EvaluationOptions& options) {
  return implementation_->evaluate(options, true);
}

const std::vector<ReadingAnswer>& LiveScene::readings(const EvaluationOptions& options) {
  return implementation_->evaluate(options, false).readings;
}

const SceneCapacitance& LiveScene::capacitance(const EvaluationOptions& options) {
  return implementation_->evaluate(options, true).capacitance;
}

const MaxwellMatrix& LiveScene::maxwell(const EvaluationOptions& options) {
  return implementation_->find_matrix(options);
}

std::vector<std::vector<ReadingAnswer>> LiveScene::readings_of(const std::vector<Frame>& motion,
                                                               const EvaluationOptions& options,
                                                               std::size_t threads) {
  std::vector<Eigen::Isometry3d> present;
  for (const Link& link : scene().links)
    present.push_back(link.pose);
  std::vector<std::vector<ReadingAnswer>> answers;
  try {
    answers = implementation_->readings_of(
        motion.size(), [&](std::size_t frame) { set_poses(motion[frame].poses); }, options, threads);
  } catch (...) {
    set_poses(present);
    throw;
  }
  set_poses(present);
  return answers;
}

const SceneCollision& LiveScene::collide() {
  return implementation_->collide();
}

std::vector<DistanceReading> LiveScene::sense(ConeMethod method) {
  return implementation_->sense(method);
}

}  // namespace fringe
