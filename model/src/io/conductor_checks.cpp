#include "io/conductor_checks.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <variant>

#include <fmt/format.h>

namespace fringe::detail {
namespace {

/// Most names that a message lists.
constexpr std::size_t most_names = 10;

using ObjectsByName = std::map<std::string, const Object*, std::less<>>;

/// Returns the `potential` of a conductor as a scene file names it.
std::string_view potential_name(const Object& object) {
  if (std::holds_alternative<Floating>(object.role))
    return "floating";
  return std::holds_alternative<Electrode>(object.role) ? "electrode" : "grounded";
}

double capacitance_to_ground(const Object& object) {
  const auto* floating = std::get_if<Floating>(&object.role);
  return floating ? floating->to_ground : 0;
}

Names names_of_sensors(const Scene& scene) {
  Names names;
  for (const Sensor& sensor : scene.sensors)
    names.insert(sensor.name);
  for (const DistanceSensor& sensor : scene.distance_sensors)
    names.insert(sensor.name);
  return names;
}

/// Rejects an object that differs from the first one of its conductor.
void require_alike(const Object& first, const Object& object, const TableReader& table) {
  if (potential_name(first) != potential_name(object))
    table.fail("conductor",
               fmt::format(R"(one conductor has one potential, but "{}" is {} and "{}" is {})", first.name,
                           potential_name(first), object.name, potential_name(object)));
  if (capacitance_to_ground(first) != capacitance_to_ground(object))
    table.fail("to_ground",
               fmt::format(R"(one conductor has one capacitance to ground, but "{}" and "{}" differ)",
                           first.name, object.name));
}

/// Returns what may be sensed and driven, in the file's order, each once.
std::vector<std::string> names_of_electrodes(const Scene& scene) {
  std::vector<std::string> names;
  for (const Sensor& sensor : scene.sensors)
    names.push_back(sensor.name);
  Names listed;
  for (const Object& object : scene.objects) {
    const std::string& name = object.conductor.value_or(object.name);
    if (std::holds_alternative<Electrode>(object.role) && listed.insert(name).second)
      names.push_back(name);
  }
  return names;
}

std::string described(const std::vector<std::string>& names) {
  if (names.empty())
    return "the scene has none";
  std::string text = fmt::format(R"(the scene has "{}")", names.front());
  for (std::size_t k = 1; k < std::min(names.size(), most_names); ++k)
    text += fmt::format(R"(, "{}")", names[k]);
  return names.size() > most_names ? fmt::format("{} and {} more", text, names.size() - most_names) : text;
}

}  // namespace

void require_conductors(const Scene& scene, const std::vector<TableReader>& objects) {
  const Names sensors = names_of_sensors(scene);
  ObjectsByName named, first;
  for (const Object& object : scene.objects)
    named[object.name] = &object;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    if (!object.conductor)
      continue;
    const std::string& name = *object.conductor;
    if (sensors.contains(name))
      objects[i].fail("conductor", fmt::format(R"("{}" is the name of a sensor)", name));
    if (const auto other = named.find(name); other != named.end() && other->second->conductor != name)
      objects[i].fail("conductor",
                      fmt::format(R"("{}" is the name of an object outside this conductor)", name));
    require_alike(*first.try_emplace(name, &object).first->second, object, objects[i]);
  }
}

void require_targets(const Scene& scene, const std::vector<TableReader>& objects) {
  std::map<std::size_t, const Sensor*> carried;
  for (const Sensor& sensor : scene.sensors)
    if (sensor.link)
      carried.try_emplace(*sensor.link, &sensor);
  ObjectsByName first;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    if (object.target && std::holds_alternative<Electrode>(object.role))
      objects[i].fail("target", "an electrode cannot be a target");
    if (object.target && object.link)
      if (const auto sensor = carried.find(*object.link); sensor != carried.end())
        objects[i].fail("target", fmt::format(R"(a target cannot carry a sensor, but its link carries "{}")",
                                              sensor->second->name));
    if (!object.conductor || !std::holds_alternative<Floating>(object.role))
      continue;
    const Object& other = *first.try_emplace(*object.conductor, &object).first->second;
    if (other.target != object.target)
      objects[i].fail(
          "target",
          fmt::format(
              R"(all objects of a floating conductor are targets or none is, but "{}" is and "{}" is not)",
              other.target ? other.name : object.name, other.target ? object.name : other.name));
  }
}

void require_readings(const Scene& scene, const std::vector<TableReader>& readings) {
  const std::vector<std::string> known = names_of_electrodes(scene);
  const Names electrodes(known.begin(), known.end());
  const auto require = [&](const TableReader& table, std::string_view key, const std::string& name) {
    if (!electrodes.contains(name))
      table.fail(key, fmt::format(R"("{}" is neither a sensor nor the conductor of an electrode; {})", name,
                                  described(known)));
  };
  for (std::size_t i = 0; i < scene.readings.size(); ++i) {
    require(readings[i], "sense", scene.readings[i].sense);
    for (const std::string& name : scene.readings[i].drive)
      require(readings[i], "drive", name);
  }
}

}  // namespace fringe::detail
