#pragma once

#include <string>
#include <vector>

#include "fringe/evaluation.hpp"
#include "fringe/scene.hpp"

namespace fringe {

/// Returns remarks on a scene in its present poses, a sentence each: on what can be answered, but is probably
/// not what was meant. These are on what the reader mended (Scene::changes), implausible sizes, triangles
/// that do not count or face inwards, and objects inside others. Takes about as long as reading the scene.
std::vector<std::string> remarks(const Scene& scene);

/// Returns the remarks on a scene, then those on an evaluation of it: on a scene without sensors, objects of
/// which `facing` sees only backs, and objects close to a sensor that shield others, if the method does not
/// know it; and derivatives that were asked for and are not known.
std::vector<std::string> remarks(const Scene& scene, const EvaluationOptions& options,
                                 const Evaluation& answer);

}  // namespace fringe
