#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "fringe/boundary_elements.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/evaluation.hpp"
#include "fringe/scene_collision.hpp"
#include "fringe/scene_info.hpp"
#include "fringe/scene_sensing.hpp"

/// Describes every answer once: the command prints the description, and the Python module returns it.
/// geometries/schemas contains a schema of each. Units are SI; a capacitance at contact is infinite.
namespace fringe::answers {

/// A JSON value whose keys keep their order.
using Json = nlohmann::ordered_json;

/// The method and the accuracy that were requested for a Maxwell matrix.
struct MaxwellRequest {
  std::string method;  ///< "boundary-elements", "reduced:K" or "recommended"
  double rtol;
  bool only_readings = false;  ///< whether rtol is asked of the readings and of no entry for itself
};

/// Returns the options of the triangle-integral model with which an evaluation without a Maxwell matrix was
/// computed. The method `recommended` computes the correction `formula` then.
CapacitanceOptions used_options(const EvaluationOptions& options);

/// Describes an evaluation: the sensors with their objects, either the Maxwell matrix or the work done, and
/// the readings.
Json capacitance_answer(const Evaluation& answer, const EvaluationOptions& options, double seconds);

/// Describes the readings of an evaluation.
Json readings_answer(const Evaluation& answer);

/// Describes the Maxwell matrix of an evaluation that has one, the readings and, by sensor, `delta_self`.
Json maxwell_answer(const Evaluation& answer, double rtol, double seconds);

/// Describes all pairs of objects that can collide, and the work done.
Json collision_answer(const SceneCollision& answer, const Scene& scene);

/// Describes the readings of the distance sensors; all values are null where nothing is in a cone.
Json sensing_answer(const std::vector<DistanceReading>& readings);

/// Adds the remarks on a scene or an evaluation to an answer.
Json with_remarks(Json answer, const std::vector<std::string>& remarks);

/// Describes the counts, the geometry and the electrical roles of a scene.
Json info_answer(const SceneInfo& info, const Scene& scene);

}  // namespace fringe::answers
