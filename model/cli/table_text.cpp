#include "table_text.hpp"

#include <cmath>
#include <optional>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fringe/reading.hpp"
#include "units.hpp"

namespace fringe::cli {
namespace {

constexpr double millimetres_per_metre = 1e3;

/// Returns a note on contact or on the error bound of an object's capacitance; empty if there is neither.
std::string remark(const ObjectCapacitance& object) {
  if (std::isinf(object.capacitance))
    return "  contact";
  if (object.bound == 0)
    return "";
  return fmt::format("  wrong by at most {:.2g} pF{}", object.bound * picofarads_per_farad,
                     object.skipped ? ", left out" : "");
}

/// Returns a line for each kind of defect that a mesh has, with what the methods make of it.
std::string defect_lines(const MeshDefects& defects) {
  std::string text;
  const auto line = [&](std::size_t count, const char* defect, const char* consequence) {
    if (count > 0)
      text += fmt::format("  {:<10} {} {}: {}\n", "defect", count, defect, consequence);
  };
  line(defects.duplicates, "duplicate triangles", "each triangle counts once");
  line(defects.without_area, "triangles without area", "they do not count");
  line(defects.open_edges, "open edges, of one triangle only",
       "no volume; the surface counts as far as it reaches");
  line(defects.branching_edges, "edges of more than two triangles", "every triangle counts");
  line(defects.flipped_edges, "edges between triangles with opposite outward sides",
       "no volume; only faces = \"facing\" depends on the side");
  line(defects.t_junctions, "vertices inside another triangle's edge", "every triangle counts as it is");
  line(defects.crossings, "pairs of triangles that cross or touch",
       "every triangle counts, also what lies inside");
  if (defects.shells > 1)
    line(defects.shells, "separate parts", "they are one conductor");
  return text;
}

/// Returns what a scene's object is to the readings, in words; empty for a grounded one that is not marked.
std::string role_words(const Object& object) {
  std::string words = object.target ? ", target" : "";
  if (const auto* floating = std::get_if<Floating>(&object.role))
    words += floating->to_ground > 0
                 ? fmt::format(", {:.6g} pF to ground", floating->to_ground * picofarads_per_farad)
                 : ", floating";
  if (std::holds_alternative<Electrode>(object.role))
    words += ", electrode";
  return words;
}

std::string reading_line(const Reading& reading) {
  const auto in_femtofarads = [](const std::optional<double>& value, const char* name) {
    return value ? fmt::format(", {} {:.6g} fF", name, *value * femtofarads_per_farad) : std::string();
  };
  return fmt::format("reading {}: senses {}, drives {}{}{}\n", reading.name, reading.sense,
                     fmt::join(reading.drive, " and "), in_femtofarads(reading.noise, "noise"),
                     in_femtofarads(reading.threshold, "threshold"));
}

}  // namespace

std::string capacitance_table(const Evaluation& evaluation, const EvaluationOptions& options,
                              double seconds) {
  const SceneCapacitance& answer = evaluation.capacitance;
  const bool has_tolerance = std::holds_alternative<Exact>(method_of(options));
  std::string text =
      fmt::format("What each object adds to a sensor: an estimate of mutual, the charge on the grounded "
                  "object per volt on "
                  "the sensor\n"
                  "method {}{}, {} triangles evaluated, {:.3g} s\n",
                  method_text(options), has_tolerance ? fmt::format(", tolerance {}", options.tolerance) : "",
                  answer.counts.triangles_evaluated, seconds);
  for (const SensorCapacitance& sensor : answer.sensors) {
    text += fmt::format("\nsensor {}{}\n", sensor.name, sensor.contact ? " (contact)" : "");
    for (const ObjectCapacitance& object : sensor.objects)
      text += fmt::format("  {:<24} {:>14.6g} pF{}\n", object.name, object.capacitance * picofarads_per_farad,
                          remark(object));
    text += fmt::format("  {:<24} {:>14.6g} pF\n", "total", sensor.total * picofarads_per_farad);
    text += fmt::format("  {:<24} {:>14.6g} V\n", "voltage", sensor.voltage);
    text += fmt::format("  {:<24} {:>14.6g} V\n", "delta voltage", sensor.delta_voltage);
  }
  return text;
}

std::string readings_table(const std::vector<DistanceReading>& readings) {
  if (readings.empty())
    return "the scene has no distance sensors\n";
  std::string text = "The closest point in each distance sensor's cone\n\n";
  for (const auto& [name, closest] : readings) {
    text += fmt::format("  {:<24} ", name);
    if (closest)
      text += fmt::format("{:>12.6g} mm  {}, at ({:.6g}, {:.6g}, {:.6g}) m\n",
                          closest->distance * millimetres_per_metre, closest->object, closest->point.x(),
                          closest->point.y(), closest->point.z());
    else
      text += "sees nothing\n";
  }
  return text;
}

std::string collision_table(const SceneCollision& answer, const Scene& scene) {
  const std::vector<ObjectPair> pairs = all_pairs(answer, scene);
  if (pairs.empty())
    return fmt::format("nothing to check among {} objects: not looked at are objects of one link, those of a "
                       "link and its parent "
                       "unless collides_with_parent = true, those with collides = false, and sensors\n",
                       scene.objects.size());
  std::string text =
      fmt::format("{} pairs, {} of them clear; {} tests of bounding boxes, {} of convex shapes\n",
                  pairs.size(), pairs.size() - answer.marked.size(), answer.tests.broad, answer.tests.narrow);
  for (const ObjectPair& pair : answer.marked)
    text += fmt::format("  {:<10} {} and {}\n", to_string(pair.status), scene.objects[pair.a].name,
                        scene.objects[pair.b].name);
  return text;
}

std::string info_table(const SceneInfo& info, const Scene& scene) {
  std::string text =
      fmt::format("{} links, {} sensors, {} distance sensors, {} objects, {} triangles\n", info.links,
                  info.sensors, info.distance_sensors, info.objects.size(), info.triangles);
  for (const Reading& reading : scene.readings.empty() ? std::vector<Reading>() : readings(scene))
    text += reading_line(reading);
  for (std::size_t k = 0; k < info.objects.size(); ++k) {
    const ObjectInfo& object = info.objects[k];
    const auto& low = object.bounding_box.min();
    const auto& high = object.bounding_box.max();
    text += fmt::format("\nobject {}{}\n", object.name, role_words(scene.objects[k]));
    text += fmt::format("  {:<10} {}\n", "triangles", object.triangles);
    text += fmt::format("  {:<10} {:.6g} m2\n", "area", object.area);
    text += fmt::format("  {:<10} {}\n", "volume",
                        object.volume ? fmt::format("{:.6g} m3", *object.volume) : "none: open surface");
    text += fmt::format("  {:<10} x {:.6g} to {:.6g}, y {:.6g} to {:.6g}, z {:.6g} to {:.6g} m\n", "box",
                        low.x(), high.x(), low.y(), high.y(), low.z(), high.z());
    if (object.defects)
      text += defect_lines(*object.defects);
  }
  return text;
}

}  // namespace fringe::cli
