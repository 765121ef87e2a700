#pragma once

#include <string>
#include <vector>

#include "fringe/evaluation.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene_collision.hpp"
#include "fringe/scene_info.hpp"
#include "fringe/scene_sensing.hpp"

/// Formats the answers as tables for people: capacitances in pF, distances in mm.
namespace fringe::cli {

/// Lists what each object adds to each sensor; for evaluations without a Maxwell matrix.
std::string capacitance_table(const Evaluation& evaluation, const EvaluationOptions& options, double seconds);

std::string readings_table(const std::vector<DistanceReading>& readings);

std::string collision_table(const SceneCollision& answer, const Scene& scene);

/// The roles of the objects and the readings are listed where the scene says more than the defaults.
std::string info_table(const SceneInfo& info, const Scene& scene);

/// Formats the Maxwell matrix of an evaluation that has one as a table in pF.
std::string maxwell_table(const Evaluation& answer, const EvaluationOptions& options, double seconds);

/// Formats readings as a table for people, in pF. What a method does not know is a dash.
std::string reading_table(const std::vector<ReadingAnswer>& readings);

}  // namespace fringe::cli
