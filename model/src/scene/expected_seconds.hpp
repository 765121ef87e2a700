#pragma once

#include "fringe/method.hpp"
#include "fringe/scene.hpp"

namespace fringe::detail {

/// How many unknowns boundary elements begin with.
struct FirstUnknowns {
  double functions = 0;        ///< on plates and boxes, one for each length over which the charge changes
  double finer_functions = 0;  ///< the same with two
  double panels = 0;           ///< on surfaces of triangles
  double surfaces = 0;         ///< how many these are; bodies that touch at one potential share one
};

/// What of a scene decides how long its methods take.
struct SceneSize {
  explicit SceneSize(const Scene& scene);

  /// Counts the unknowns, which takes longer than the rest, if that has not been done.
  void count_unknowns(const Scene& scene);

  double triangles = 0;           ///< of all objects
  double prepared_triangles = 0;  ///< of those that are neither plates nor boxes
  double curved = 0;              ///< how many these are
  double boxes = 0;
  double plates = 0;  ///< those of sensors, too
  double sensors = 0;
  bool has_insulators = false;
  bool has_curved_insulators = false;  ///< whether one is no box

  FirstUnknowns unknowns;  ///< none before they are counted
  bool are_counted = false;

  double bodies() const { return curved + boxes + plates; }
};

/// What of a question decides how long its answer takes.
struct Effort {
  double rtol;
  bool is_prepared = false;  ///< whether the method has answered before
  bool is_by_matrix = true;  ///< whether the reduced method answers by a matrix
  bool is_rough = false;     ///< whether it prepares a machine roughly
};

/// Estimates how long a method takes for an answer, on two cores of 2020; Auto is none of them.
double expected_seconds(const Method& method, const SceneSize& size, const Effort& effort);

}  // namespace fringe::detail
