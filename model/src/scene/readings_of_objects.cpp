#include "scene/readings_of_objects.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "fringe/reading.hpp"

namespace fringe::detail {

std::vector<bool> have_capacitances(const Scene& scene) {
  std::vector<bool> result;
  for (const Object& object : scene.objects)
    result.push_back(!std::holds_alternative<Electrode>(object.role) &&
                     !(std::holds_alternative<Floating>(object.role) && asks_for_changes(scene)));
  return result;
}

ReadingsOfObjects::ReadingsOfObjects(const Scene& scene) {
  const std::vector<bool> are_targets = targets(scene), are_known = have_capacitances(scene);
  bool all_are_known = true;
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    all_are_known = all_are_known && (are_known[k] || !are_targets[k]);
    if (are_known[k])
      targets_.push_back(are_targets[k]);
  }
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
    if (!changes_[k].sensor)
      continue;
    const std::vector<ObjectCapacitance>& objects = capacitance.sensors[*changes_[k].sensor].objects;
    double change = 0;
    std::optional<double> error = 0;
    for (std::size_t object = 0; object < objects.size(); ++object) {
      if (!targets_[object])
        continue;
      change += objects[object].capacitance;
      error = error && objects[object].error ? std::optional(*error + *objects[object].error) : std::nullopt;
    }
    answer.change = {change, error};
  }
}

}  // namespace fringe::detail
