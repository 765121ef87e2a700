#include "fringe/evaluation.hpp"

#include "scene/scene_evaluator.hpp"
#include "surface/insulators.hpp"

namespace fringe {

EvaluationCounts& EvaluationCounts::operator+=(const EvaluationCounts& other) {
  triangles_evaluated += other.triangles_evaluated;
  triangles_lumped += other.triangles_lumped;
  triangles_skipped += other.triangles_skipped;
  triangles_reused += other.triangles_reused;
  nodes_lumped += other.nodes_lumped;
  objects_evaluated += other.objects_evaluated;
  objects_skipped += other.objects_skipped;
  objects_reused += other.objects_reused;
  return *this;
}

double divider_voltage(const Sensor& sensor, double total) {
  return sensor.coupling_capacitance / (sensor.coupling_capacitance + total) * sensor.input_voltage;
}

SceneCapacitance capacitance(const Scene& scene, const EvaluationOptions& options) {
  detail::refuse_thick_covers(scene);
  return SceneEvaluator(scene, options).capacitance();
}

}  // namespace fringe
