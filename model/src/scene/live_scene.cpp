#include "fringe/live_scene.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "bem/insulators.hpp"
#include "correction/insulated_readings.hpp"
#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/reduced_capacitance.hpp"
#include "fringe/scene_evaluator.hpp"
#include "geometry/link_motion.hpp"
#include "io/prepared_files.hpp"
#include "numeric/time_limit.hpp"
#include "scene/readings_of_objects.hpp"
#include "scene/recommended_method.hpp"

namespace fringe {
namespace {

bool same(const CapacitanceOptions& a, const CapacitanceOptions& b) {
  return to_string(a.method) == to_string(b.method) && a.plates == b.plates && a.faces == b.faces &&
         a.tolerance == b.tolerance && a.correction == b.correction;
}

}  // namespace

class LiveScene::Implementation {
 public:
  explicit Implementation(Scene scene)
      : scene_(std::move(scene)), poses_(std::make_shared<detail::LinkPoses>(scene_.links)),
        readings_of_objects_(scene_), company_(poses_),
        knows_company_(detail::InsulatedReadings::knows(scene_)) {}

  const Scene& scene() const { return scene_; }

  void set_pose(std::string_view link, const Eigen::Isometry3d& pose) {
    poses_->set_pose(link, pose);
    fringe::set_pose(scene_, link, pose);
  }

  const Evaluation& evaluate(const EvaluationOptions& options) {
    uninterrupted([&] { choose_method(options); });
    return answer_;
  }

  std::vector<std::vector<ReadingAnswer>> readings_of(std::size_t frames,
                                                      const std::function<void(std::size_t)>& pose,
                                                      EvaluationOptions options, std::size_t threads) {
    options.entries = Entries::of_readings;
    std::vector<std::vector<ReadingAnswer>> answers;
    if (is_integral(options.method) && knows_company(integral_options(options))) {
      company_.keep_in(files_of(options));
      uninterrupted([&] { answers = company_.write_frames(scene_, frames, pose, options.rtol, threads); });
      return answers;
    }
    for (std::size_t frame = 0; frame < frames; ++frame) {
      pose(frame);
      answers.push_back(evaluate(options).readings);
    }
    return answers;
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
  /// Ends the preparations that an exception leaves incomplete: they must not serve the next answer.
  template <typename Answer>
  void uninterrupted(const Answer& answer) {
    try {
      answer();
    } catch (const InputError&) {
      throw;
    } catch (...) {
      reduced_.reset();
      recommended_.reset();
      company_ = detail::InsulatedReadings(poses_);
      throw;
    }
  }

  bool knows_company(const CapacitanceOptions& options) const {
    return options.correction != Correction::none && knows_company_;
  }

  void choose_method(const EvaluationOptions& options) {
    std::optional<detail::TimeLimit> limit;
    if (options.max_seconds && !std::holds_alternative<Recommended>(options.method))
      limit.emplace(*options.max_seconds);
    if (is_integral(options.method))
      integrate(options);
    else if (std::holds_alternative<Recommended>(options.method))
      choose(options);
    else
      find_matrix(options);
  }

  /// Answers by a triangle-integral method or a correction.
  void integrate(const EvaluationOptions& asked) {
    const CapacitanceOptions options = integral_options(asked);
    const bool in_company = knows_company(options);
    detail::refuse_thick_covers(scene_);
    answer_.matrix.reset();
    answer_.reached = true;
    if (in_company) {
      company_.keep_in(files_of(asked));
      company_.write(scene_, answer_.readings, asked.rtol, asked.derivatives);
    }
    if (asked.rtol) {
      if (!in_company)
        throw InputError("rtol is an option of the correction formula for the changes of readings, which "
                         "this scene does not ask for");
      answer_.reached = detail::are_within(answer_.readings, *asked.rtol);
      if (asked.derivatives)
        company_.write_derivatives(answer_.readings);
    }
    if (in_company && asked.entries == Entries::of_readings) {
      answer_.answered_by = detail::CompanyReadings::name;
      answer_.capacitance = {};
      return;
    }
    if (!evaluator_ || !same(options, evaluator_options_)) {
      evaluator_.emplace(scene_, options, poses_);
      evaluator_options_ = options;
      evaluator_name_ =
          options.correction == Correction::none ? to_string(options.method) : to_string(options.correction);
    }
    answer_.answered_by = evaluator_name_;
    answer_.capacitance = evaluator_->capacitance();
    if (!in_company)
      readings_of_objects_.write(answer_.capacitance, answer_.answered_by, answer_.readings);
    if (asked.derivatives && !in_company)
      readings_of_objects_.write_derivatives(*evaluator_, *poses_, answer_.readings);
  }

  /// Answers by boundary elements or the reduced method.
  void find_matrix(const EvaluationOptions& asked) {
    const double rtol = rtol_of(asked);
    answer_.answered_by = to_string(asked.method);
    if (const auto* method = std::get_if<Reduced>(&asked.method)) {
      const ReducedOptions options{method->steps, asked.rtol};
      if (!reduced_ || options.steps != reduced_options_.steps || options.rtol != reduced_options_.rtol) {
        reduced_.emplace(scene_, options, poses_);
        reduced_options_ = options;
      }
      answer_.matrix = reduced_->maxwell(asked.derivatives);
    } else {
      answer_.matrix = maxwell(scene_, {.rtol = rtol,
                                        .entries = asked.entries,
                                        .derivatives = asked.derivatives,
                                        .before_refinement = asked.before_refinement});
    }
    answer_.capacitance = capacitance(scene_, *answer_.matrix, answer_.answered_by);
    answer_.reached = answer_.matrix->reached;
    find_readings();
  }

  /// Answers by the method `recommended`.
  void choose(const EvaluationOptions& asked) {
    const double rtol = rtol_of(asked);
    const bool goes_on = asked.rtol.has_value();
    if (!recommended_ || recommended_->rtol() != rtol || recommended_->goes_on() != goes_on)
      recommended_.emplace(rtol, goes_on, poses_);
    recommended_->keep_in(files_of(asked));
    answer_ = recommended_->evaluate(scene_, asked.max_seconds);
    if (answer_.matrix)
      find_readings();
    else if (answer_.readings.empty())
      readings_of_objects_.write(answer_.capacitance, answer_.answered_by, answer_.readings);
  }

  /// Returns the files of the folder that is asked for, if one is.
  std::shared_ptr<const detail::PreparedFiles> files_of(const EvaluationOptions& options) {
    if (!options.prepared)
      files_.reset();
    else if (!files_ || files_->folder() != *options.prepared)
      files_ = std::make_shared<const detail::PreparedFiles>(*options.prepared);
    return files_;
  }

  /// Takes the readings from the matrix.
  void find_readings() {
    answer_.readings = answer_.matrix->readings;
    for (ReadingAnswer& reading : answer_.readings)
      reading.answered_by = answer_.answered_by;
  }

  Scene scene_;
  std::shared_ptr<detail::LinkPoses> poses_;
  detail::ReadingsOfObjects readings_of_objects_;
  std::optional<SceneEvaluator> evaluator_;
  CapacitanceOptions evaluator_options_;
  std::string evaluator_name_;  ///< of its method or correction
  std::optional<ReducedEvaluator> reduced_;
  ReducedOptions reduced_options_;
  std::optional<detail::RecommendedMethod> recommended_;
  detail::InsulatedReadings company_;
  bool knows_company_;
  std::shared_ptr<const detail::PreparedFiles> files_;
  std::optional<CollisionDetector> detector_;
  std::optional<SceneSensing> sensing_;
  ConeMethod sensing_method_ = ConeMethod::field_of_view;
  Evaluation answer_;
};

bool formula_takes_rtol(const Scene& scene) {
  return detail::InsulatedReadings::takes_rtol(scene);
}

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
  return implementation_->evaluate(options);
}

std::vector<std::vector<ReadingAnswer>> LiveScene::readings_of(const std::vector<Frame>& motion,
                                                               const EvaluationOptions& options,
                                                               std::size_t threads) {
  return implementation_->readings_of(
      motion.size(), [&](std::size_t frame) { set_poses(motion[frame].poses); }, options, threads);
}

const SceneCollision& LiveScene::collide() {
  return implementation_->collide();
}

std::vector<DistanceReading> LiveScene::sense(ConeMethod method) {
  return implementation_->sense(method);
}

}  // namespace fringe
