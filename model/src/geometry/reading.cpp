#include "fringe/reading.hpp"

#include <algorithm>
#include <variant>

namespace fringe {
namespace {

/// Threshold of a reading, in standard deviations of its noise.
constexpr double deviations_noticed = 5;

}  // namespace

std::vector<Reading> readings(const Scene& scene) {
  std::vector<Reading> result = scene.readings;
  if (result.empty())
    for (const Sensor& sensor : scene.sensors)
      result.push_back({sensor.name, sensor.name, {sensor.name}});
  for (Reading& reading : result)
    if (reading.noise && !reading.threshold)
      reading.threshold = deviations_noticed * *reading.noise;
  return result;
}

std::vector<bool> targets(const Scene& scene) {
  const bool some_are_marked = std::ranges::any_of(scene.objects, &Object::target);
  std::vector<bool> result;
  for (const Object& object : scene.objects)
    result.push_back(some_are_marked ? object.target
                                     : !std::holds_alternative<Electrode>(object.role) && !is_cover(object));
  return result;
}

bool asks_for_changes(const Scene& scene) {
  return !scene.readings.empty() || std::ranges::any_of(scene.objects, &Object::target) ||
         std::ranges::count(targets(scene), false) > 0;
}

}  // namespace fringe
