#include "scene/readings_of_objects.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

#include "fringe/reading.hpp"
#include "geometry/wrench.hpp"
#include "reduced/machine_readings.hpp"

namespace fringe::detail {

std::vector<bool> have_capacitances(const Scene& scene) {
  const std::vector<bool> enclosed = are_enclosed(scene);
  std::vector<bool> result;
  for (const Object& object : scene.objects)
    result.push_back(!std::holds_alternative<Electrode>(object.role) && !is_cover(object) &&
                     !(std::holds_alternative<Floating>(object.role) && asks_for_changes(scene)) &&
                     !enclosed[result.size()]);
  return result;
}

ReadingsOfObjects::ReadingsOfObjects(const Scene& scene) {
  const std::vector<bool> are_targets = targets(scene), are_known = have_capacitances(scene);
  bool all_are_known = true;
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    all_are_known = all_are_known && (are_known[k] || !are_targets[k]);
    if (!are_known[k])
      continue;
    targets_.push_back(are_targets[k]);
    links_of_objects_.push_back(scene.objects[k].link);
  }
  for (const Sensor& sensor : scene.sensors)
    links_of_sensors_.push_back(sensor.link);
  for (const Reading& reading : readings(scene)) {
    Change change{reading.name, std::nullopt};
    const auto sensed = std::find_if(scene.sensors.begin(), scene.sensors.end(),
                                     [&](const Sensor& sensor) { return sensor.name == reading.sense; });
    const bool is_driven =
        std::find(reading.drive.begin(), reading.drive.end(), reading.sense) != reading.drive.end();
    if (sensed != scene.sensors.end() && is_driven && all_are_known)
      change.sensor = static_cast<std::size_t>(sensed - scene.sensors.begin());
    changes_.push_back(std::move(change));
  }
}

void ReadingsOfObjects::write(const SceneCapacitance& capacitance, std::string_view answered_by,
                              std::vector<ReadingAnswer>& answers) const {
  answers.resize(changes_.size());
  for (std::size_t k = 0; k < changes_.size(); ++k) {
    ReadingAnswer& answer = answers[k];
    answer.name = changes_[k].name;
    answer.answered_by = answered_by;
    answer.value = answer.background = answer.change = {};
    answer.derivatives.clear();
    if (!changes_[k].sensor)
      continue;
    const std::vector<ObjectCapacitance>& objects = capacitance.sensors[*changes_[k].sensor].objects;
    double change = 0;
    std::optional<double> error = 0;
    bool is_certain = false;  // that a target in contact changes a reading without limit
    for (std::size_t object = 0; object < objects.size(); ++object) {
      if (!targets_[object])
        continue;
      change += objects[object].capacitance;
      error = error && objects[object].error ? std::optional(*error + *objects[object].error) : std::nullopt;
      is_certain = is_certain || (std::isinf(objects[object].capacitance) && objects[object].error);
    }
    answer.change = {change, is_certain ? std::optional(0.0) : error};
  }
}

void ReadingsOfObjects::write_derivatives(SceneEvaluator& evaluator, const LinkPoses& poses,
                                          std::vector<ReadingAnswer>& answers) const {
  std::vector<PairWrench> pairs;
  for (std::size_t k = 0; k < changes_.size(); ++k) {
    const std::optional<std::size_t> sensor = changes_[k].sensor;
    if (!sensor)
      continue;
    pairs.clear();
    for (std::size_t object = 0; object < targets_.size(); ++object) {
      // Bodies on the same link keep their relative pose.
      if (!targets_[object] || links_of_objects_[object] == links_of_sensors_[*sensor])
        continue;
      const PoseDerivatives derivatives = evaluator.derivatives(*sensor, object);
      pairs.push_back({links_of_objects_[object],
                       links_of_sensors_[*sensor],
                       {derivatives.head<3>(), derivatives.tail<3>()}});
    }
    answers[k].derivatives = derivatives_by_link(poses, pairs);
  }
}

}  // namespace fringe::detail
