#include "answers/answers.hpp"

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "fringe/reading.hpp"

namespace fringe::answers {
namespace {

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

namespace {

Json numbers(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Json rows(const Eigen::MatrixXd& matrix) {
  Json result = Json::array();
  for (const auto& row : matrix.rowwise())
    result.push_back(std::vector<double>(row.begin(), row.end()));
  return result;
}

Json description(const ObjectCapacitance& object) {
  return {{"name", object.name},
          {"capacitance", object.capacitance},
          {"error", object.error ? Json(*object.error) : Json()},
          {"answered_by", object.answered_by},
          {"bound", object.bound},
          {"skipped", object.skipped}};
}

/// Describes a sensor; `more` keys about it, which precede its objects, are described already.
Json description(const SensorCapacitance& sensor, const Json& more = Json::object()) {
  Json result{{"name", sensor.name},
              {"total", sensor.total},
              {"voltage", sensor.voltage},
              {"delta_voltage", sensor.delta_voltage},
              {"contact", sensor.contact}};
  result.update(more);
  Json& objects = result["objects"] = Json::array();
  for (const ObjectCapacitance& object : sensor.objects)
    objects.push_back(description(object));
  return result;
}

/// Describes what was asked for: the method as it is written, and the accuracy where one was asked for.
Json description(const EvaluationOptions& options) {
  const Method method = method_of(options);
  Json result{{"method", method_text(options)}};
  if (is_integral(method))
    result["tolerance"] = options.tolerance;
  else if (!std::holds_alternative<Formula>(method))
    result["rtol"] = rtol_of(options);
  if (options.entries != Entries::of_readings)
    result["entries"] = true;
  return result;
}

Json description(const EvaluationCounts& counts) {
  return {{"triangles_evaluated", counts.triangles_evaluated},
          {"triangles_lumped", counts.triangles_lumped},
          {"triangles_skipped", counts.triangles_skipped},
          {"triangles_reused", counts.triangles_reused},
          {"nodes_lumped", counts.nodes_lumped},
          {"objects_evaluated", counts.objects_evaluated},
          {"objects_skipped", counts.objects_skipped},
          {"objects_reused", counts.objects_reused}};
}

/// Describes the charge on each member of each conductor, per volt on each conductor.
Json charges(const MaxwellMatrix& matrix) {
  Json result = Json::array();
  Eigen::Index row = 0;
  for (const std::vector<std::string>& members : matrix.members) {
    const auto count = static_cast<Eigen::Index>(members.size());
    result.push_back(rows(matrix.charges.middleRows(row, count)));
    row += count;
  }
  return result;
}

/// Describes a Maxwell matrix, as every answer that contains one does.
Json description(const MaxwellMatrix& matrix) {
  return {
      {"reached", matrix.reached},  {"unknowns", matrix.unknowns},  {"conductors", matrix.conductors},
      {"members", matrix.members},  {"floating", matrix.floating},  {"maxwell", rows(matrix.values)},
      {"charges", charges(matrix)}, {"error", rows(matrix.errors)}, {"lower_bounds", matrix.lower_bounds}};
}

/// Describes a sensor with its entries in the row of the Maxwell matrix, and their errors.
Json description(const SensorCapacitance& sensor, const MaxwellMatrix& matrix, Eigen::Index row) {
  return description(sensor, {{"self", matrix.values(row, row)},
                              {"self_error", matrix.errors(row, row)},
                              {"delta_self", matrix.delta_self[row]},
                              {"delta_self_error", matrix.delta_self_errors[row]}});
}

/// Returns descriptions by name as a list, each with its name.
Json listed(const Json& by_name) {
  Json result = Json::array();
  for (const auto& [name, described] : by_name.items())
    result.emplace_back(Json{{"name", name}}).update(described);
  return result;
}

Json known(const std::optional<double>& number) {
  return number ? Json(*number) : Json();
}

/// Describes derivatives with respect to the pose of each link, by the links' names: those of the change, or
/// their errors.
template <typename Part>
Json by_link(const std::vector<LinkDerivatives>& derivatives, const Part& part) {
  Json result = Json::object();
  for (const LinkDerivatives& of_link : derivatives) {
    const std::optional<PoseDerivatives> numbers = part(of_link);
    result[of_link.link] = numbers ? Json(std::vector<double>(numbers->begin(), numbers->end())) : Json();
  }
  return result;
}

/// Describes the readings; bounds are there only if one is proven, derivatives if they were asked for.
Json description(const std::vector<ReadingAnswer>& readings) {
  Json result = Json::array();
  for (const ReadingAnswer& reading : readings) {
    const auto all = [&](std::optional<double> Estimate::*part) {
      return Json{{"value", known(reading.value.*part)},
                  {"background", known(reading.background.*part)},
                  {"change", known(reading.change.*part)}};
    };
    Json& described = result.emplace_back(Json{{"name", reading.name}});
    described.update(all(&Estimate::value));
    described["error"] = all(&Estimate::error);
    if (reading.value.lower || reading.background.lower || reading.change.lower)
      described["lower"] = all(&Estimate::lower);
    if (reading.value.upper || reading.background.upper || reading.change.upper)
      described["upper"] = all(&Estimate::upper);
    described["answered_by"] = reading.answered_by;
    if (reading.derivatives.empty())
      continue;
    described["derivatives"] =
        by_link(reading.derivatives, [](const LinkDerivatives& of_link) { return of_link.change; });
    described["derivative_errors"] =
        by_link(reading.derivatives, [](const LinkDerivatives& of_link) { return of_link.error; });
  }
  return result;
}

Json description(const DistanceReading& reading) {
  Json result{{"name", reading.name},
              {"distance", nullptr},
              {"point", nullptr},
              {"object", nullptr},
              {"triangle", nullptr}};
  if (const std::optional<SensedPoint>& closest = reading.closest) {
    result["distance"] = closest->distance;
    result["point"] = numbers(closest->point);
    result["object"] = closest->object;
    result["triangle"] = closest->triangle;
  }
  return result;
}

Json description(const MeshDefects& defects) {
  return {{"without_area", defects.without_area},   {"duplicates", defects.duplicates},
          {"open_edges", defects.open_edges},       {"branching_edges", defects.branching_edges},
          {"flipped_edges", defects.flipped_edges}, {"t_junctions", defects.t_junctions},
          {"crossings", defects.crossings},         {"shells", defects.shells}};
}

Json description(const ObjectInfo& object) {
  return {
      {"name", object.name},
      {"triangles", object.triangles},
      {"area", object.area},
      {"volume", object.volume ? Json(*object.volume) : Json()},
      {"aabb",
       {{"minimum", numbers(object.bounding_box.min())}, {"maximum", numbers(object.bounding_box.max())}}},
      {"defects", object.defects ? description(*object.defects) : Json()}};
}

}  // namespace

Json capacitance_answer(const Evaluation& answer, const EvaluationOptions& options, double seconds) {
  Json result{{"options", description(options)},
              {"answered_by", answer.answered_by},
              {"reached", answer.reached},
              {"seconds", seconds},
              {"expected_seconds", answer.expected_seconds}};
  if (answer.matrix)
    result.update(description(*answer.matrix));
  else
    result["counts"] = description(answer.capacitance.counts);
  result["reached"] = answer.reached;
  Json& sensors = result["sensors"] = Json::array();
  Eigen::Index row = 0;
  for (const SensorCapacitance& sensor : answer.capacitance.sensors)
    sensors.push_back(answer.matrix ? description(sensor, *answer.matrix, row++) : description(sensor));
  result["readings"] = description(answer.readings);
  return result;
}

Json readings_answer(const std::vector<ReadingAnswer>& readings) {
  return description(readings);
}

Json maxwell_answer(const MaxwellMatrix& matrix, double rtol, double seconds) {
  Json changes = Json::object();
  for (std::size_t s = 0; s < matrix.sensors; ++s) {
    const auto row = static_cast<Eigen::Index>(s);
    changes[matrix.conductors[s]] = {{"value", matrix.delta_self[row]},
                                     {"error", matrix.delta_self_errors[row]}};
  }
  Json result{{"rtol", rtol}, {"seconds", seconds}};
  result.update(description(matrix));
  result["delta_self"] = std::move(changes);
  result["readings"] = description(matrix.readings);
  return result;
}

Json collision_answer(const SceneCollision& answer, const Scene& scene) {
  Json pairs = Json::array();
  for (const ObjectPair& pair : all_pairs(answer, scene))
    pairs.push_back({{"a", scene.objects[pair.a].name},
                     {"b", scene.objects[pair.b].name},
                     {"status", to_string(pair.status)}});
  return {{"tests", {{"broad", answer.tests.broad}, {"narrow", answer.tests.narrow}}},
          {"pairs", std::move(pairs)}};
}

Json sensing_answer(const std::vector<DistanceReading>& readings) {
  Json sensors = Json::array();
  for (const DistanceReading& reading : readings)
    sensors.push_back(description(reading));
  return {{"distance_sensors", std::move(sensors)}};
}

Json with_remarks(Json answer, const std::vector<std::string>& remarks) {
  answer["remarks"] = remarks;
  return answer;
}

Json info_answer(const SceneInfo& info, const Scene& scene) {
  const Json roles = scene_roles(scene);
  Json objects = Json::array();
  for (const ObjectInfo& object : info.objects)
    objects.push_back(description(object));
  return {{"counts",
           {{"links", info.links},
            {"sensors", info.sensors},
            {"distance_sensors", info.distance_sensors},
            {"objects", info.objects.size()},
            {"triangles", info.triangles}}},
          {"objects", std::move(objects)},
          {"roles", {{"objects", listed(roles["objects"])}, {"readings", listed(roles["readings"])}}}};
}

}  // namespace fringe::answers
