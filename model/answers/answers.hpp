#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "fringe/boundary_elements.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/evaluation.hpp"
#include "fringe/scene.hpp"
#include "fringe/scene_collision.hpp"
#include "fringe/scene_info.hpp"
#include "fringe/scene_sensing.hpp"

/// Describes every answer once: the command prints the description, and the Python module returns it.
/// geometries/schemas contains a schema of each. Units are SI; a capacitance at contact is infinite.
namespace fringe::answers {

/// A JSON value whose keys keep their order.
using Json = nlohmann::ordered_json;

/// Describes an evaluation: the sensors with their objects, the Maxwell matrix where there is one, else the
/// work done, and the readings.
Json capacitance_answer(const Evaluation& answer, const EvaluationOptions& options, double seconds);

/// Describes readings.
Json readings_answer(const std::vector<ReadingAnswer>& readings);

/// Describes a Maxwell matrix with its readings and, by sensor, `delta_self`.
Json maxwell_answer(const MaxwellMatrix& matrix, double rtol, double seconds);

/// Describes all pairs of objects that can collide, and the work done.
Json collision_answer(const SceneCollision& answer, const Scene& scene);

/// Describes the readings of the distance sensors; all values are null where nothing is in a cone.
Json sensing_answer(const std::vector<DistanceReading>& readings);

/// Adds the remarks on a scene or an evaluation to an answer.
Json with_remarks(Json answer, const std::vector<std::string>& remarks);

/// Describes the counts, the geometry and the electrical roles of a scene.
Json info_answer(const SceneInfo& info, const Scene& scene);

/// Describes "objects", by name: "potential" ("dielectric" with "relative_permittivity" for those that do not
/// conduct), "conductor", "to_ground" (F; null: not connected) and "target"; and "readings", by name:
/// "sense", "drive", "noise" and "threshold" (F or null). What the scene leaves out is filled in.
Json scene_roles(const Scene& scene);

}  // namespace fringe::answers
