#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "correction/insulated_readings.hpp"
#include "fringe/evaluation.hpp"
#include "fringe/reduced_capacitance.hpp"
#include "fringe/scene_evaluator.hpp"
#include "geometry/link_motion.hpp"
#include "numeric/time_limit.hpp"

namespace fringe::detail {

/// The method `recommended` for a scene whose links move (fringe/evaluation.hpp).
class RecommendedMethod {
 public:
  /// Prepares nothing yet: each of the methods is prepared when it is first needed.
  /// @param goes_on whether an accuracy is worth minutes: where what takes seconds does not reach it, the
  /// formula in company with this accuracy and then all unknowns of boundary elements are tried
  RecommendedMethod(double rtol, bool goes_on, std::shared_ptr<LinkPoses> poses);

  double rtol() const { return rtol_; }
  bool goes_on() const { return goes_on_; }

  /// Keeps what is prepared for an accuracy in files from now on; null: in none.
  void keep_in(const std::shared_ptr<const PreparedFiles>& files) {
    files_ = files;
    accurate_.keep_in(files);
  }

  /// Evaluates every sensor of the scene, which must be the same in every call, except for its poses.
  /// @param max_seconds time after which the best answer so far is to do
  /// @throws InputError for scenes that all methods refuse.
  Evaluation evaluate(const Scene& scene, std::optional<double> max_seconds = {});

 private:
  /// The matrix of one method, and what it states of its errors.
  struct Candidate {
    MaxwellMatrix matrix;
    std::string method;
    double error;  ///< largest one that matters to a sensor, relative
  };

  double seconds_of_reduced_method(const Scene& scene) const;
  double seconds_of_accurate_formula(const Scene& scene) const;
  std::optional<Candidate> by_reduced_method(const Scene& scene);
  std::optional<Candidate> by_boundary_elements(const Scene& scene, std::size_t most_unknowns);
  void try_all_unknowns(const Scene& scene, std::optional<Candidate>& best, bool is_answered,
                        const TimeLimit* limit);
  std::optional<Evaluation> by_formula(const Scene& scene, TimeLimit* limit);
  Evaluation by_formula(const Scene& scene);
  std::optional<Evaluation> by_accurate_formula(const Scene& scene, const Evaluation& in_closed_form);
  std::optional<Evaluation> by_going_on(const Scene& scene, std::optional<Candidate>& best, TimeLimit* limit);
  std::string refusal(const std::string& of_formula, double seconds) const;
  Evaluation answer_of(const Scene& scene, Candidate candidate) const;

  double rtol_;
  bool goes_on_;
  std::shared_ptr<LinkPoses> poses_;
  std::optional<ReducedEvaluator> reduced_;
  bool reduced_refuses_ = false;  ///< in every pose
  std::string refusal_;           ///< why a method that finds a matrix last refused
  std::optional<SceneEvaluator> formula_;
  InsulatedReadings company_;
  InsulatedReadings accurate_;  ///< prepared for an accuracy
  bool is_accurate_prepared_ = false;
  std::shared_ptr<const PreparedFiles> files_;
};

}  // namespace fringe::detail
