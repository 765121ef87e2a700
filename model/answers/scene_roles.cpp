#include "answers/scene_roles.hpp"

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "fringe/reading.hpp"

namespace fringe::answers {
namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(const std::optional<double>& number) {
  return number ? Json(*number) : Json();
}

/// Describes what a role adds to an object.
struct DescribeRole {
  Json operator()(const Grounded& /*grounded*/) const { return {{"potential", "grounded"}}; }
  Json operator()(const Electrode& /*electrode*/) const { return {{"potential", "electrode"}}; }
  Json operator()(const Floating& floating) const {
    Json described{{"potential", "floating"}};
    if (floating.to_ground > 0)
      described["to_ground"] = floating.to_ground;
    return described;
  }
  Json operator()(const Dielectric& dielectric) const {
    return {{"potential", "dielectric"}, {"relative_permittivity", dielectric.relative_permittivity}};
  }
};

}  // namespace

Json scene_roles(const Scene& scene) {
  Json objects = Json::object(), described_readings = Json::object();
  const std::vector<bool> is_target = targets(scene);
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    const Object& object = scene.objects[k];
    Json described{{"potential", nullptr},
                   {"relative_permittivity", nullptr},
                   {"conductor", object.conductor.value_or(object.name)},
                   {"to_ground", nullptr},
                   {"target", static_cast<bool>(is_target[k])}};
    described.update(std::visit(DescribeRole{}, object.role));
    objects[object.name] = std::move(described);
  }
  for (const Reading& reading : readings(scene))
    described_readings[reading.name] = {{"sense", reading.sense},
                                        {"drive", reading.drive},
                                        {"noise", number_or_null(reading.noise)},
                                        {"threshold", number_or_null(reading.threshold)}};
  return {{"objects", std::move(objects)}, {"readings", std::move(described_readings)}};
}

}  // namespace fringe::answers
