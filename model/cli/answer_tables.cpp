#include "answer_tables.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fringe/reading.hpp"
#include "measured.hpp"

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

namespace {

/// Width of an entry, as `entry` writes it.
constexpr std::size_t entry_width = 26;

/// Formats a value with its error (F) in `entry_width` columns.
std::string entry(double value, double error) {
  return fmt::format("{:>{}}", measured(value * picofarads_per_farad, error * picofarads_per_farad),
                     entry_width);
}

/// Returns the width of the columns: no name runs into the next one.
std::size_t column_width(const std::vector<std::string>& names, std::size_t least) {
  constexpr std::size_t between = 2;
  std::size_t width = least;
  for (const std::string& name : names)
    width = std::max(width, name.size() + between);
  return width;
}

}  // namespace

std::string maxwell_table(const Evaluation& answer, const EvaluationOptions& options, double seconds) {
  const MaxwellMatrix& matrix = answer.matrix.value();
  const std::size_t width = column_width(matrix.conductors, entry_width);
  const std::size_t names_width = column_width(matrix.conductors, 12);
  std::string text =
      fmt::format("Maxwell matrix by {}, pF: charge on the row's conductor per volt on the column's\n"
                  "rtol {} {}{}, {} unknowns, {:.3g} s\n\n{:<{}}",
                  answer.answered_by, rtol_of(options), answer.reached ? "reached" : "NOT reached",
                  options.entries == Entries::of_readings ? " in the readings" : "", matrix.unknowns, seconds,
                  "", names_width);
  for (const std::string& name : matrix.conductors)
    text += fmt::format("{:>{}}", name, width);
  text += '\n';
  for (Eigen::Index i = 0; i < matrix.values.rows(); ++i) {
    text += fmt::format("{:<{}}", matrix.conductors[static_cast<std::size_t>(i)], names_width);
    for (Eigen::Index j = 0; j < matrix.values.cols(); ++j)
      text += std::string(width - entry_width, ' ') + entry(matrix.values(i, j), matrix.errors(i, j));
    text += '\n';
  }
  text += "\ndelta_self, pF: the sensor's own entry less what it is without the objects\n";
  for (Eigen::Index s = 0; s < matrix.delta_self.size(); ++s)
    text += fmt::format("{:<{}}{}\n", matrix.conductors[static_cast<std::size_t>(s)], names_width,
                        entry(matrix.delta_self[s], matrix.delta_self_errors[s]));
  text += "The errors are estimates.";
  const bool any_bound =
      std::find(matrix.lower_bounds.begin(), matrix.lower_bounds.end(), true) != matrix.lower_bounds.end();
  for (std::size_t k = 0; k < matrix.conductors.size(); ++k)
    if (any_bound && !matrix.lower_bounds[k])
      text += fmt::format(" The diagonal entry of {} may be above the truth.", matrix.conductors[k]);
  text += any_bound ? " Entries of the diagonal are otherwise not above the truth.\n" : "\n";
  for (const std::string& name : matrix.floating)
    text += fmt::format("floating, without charge and so without a row: {}\n", name);
  return text;
}

namespace {

std::string text_of(const Estimate& estimate) {
  if (!estimate.value)
    return "-";
  const double value = *estimate.value * picofarads_per_farad;
  if (!estimate.error)
    return unmeasured(value);
  return measured(value, *estimate.error * picofarads_per_farad);
}

/// Appends blanks up to a width; "±" is one character of two bytes.
std::string padded(const std::string& text, std::size_t width) {
  const std::size_t length = text.find("±") == std::string::npos ? text.size() : text.size() - 1;
  return text + std::string(std::max(width, length + 1) - length, ' ');
}

/// Formats a derivative that is given in F/m or F/rad.
std::string text_of(double derivative, std::optional<double> error) {
  if (std::isnan(derivative))
    return "-";
  const double value = derivative * picofarads_per_farad;
  return error ? measured(value, *error * picofarads_per_farad) : unmeasured(value);
}

/// Formats the derivatives of the changes, a row for each reading and link; empty if there are none.
std::string derivative_table(const std::vector<ReadingAnswer>& readings, std::size_t names_width) {
  std::string rows;
  for (const ReadingAnswer& reading : readings)
    for (const LinkDerivatives& of_link : reading.derivatives) {
      rows += fmt::format("  {:<{}}{:<14}", reading.name, names_width, of_link.link);
      for (Eigen::Index k = 0; k < of_link.change.size(); ++k)
        rows += padded(
            text_of(of_link.change[k], of_link.error ? std::optional((*of_link.error)[k]) : std::nullopt),
            of_link.error ? 24 : 14);
      rows.erase(rows.find_last_not_of(' ') + 1);
      rows += '\n';
    }
  if (rows.empty())
    return {};
  return "\nDerivatives of the changes by the pose of each link: pF/m along x, y, z, pF/rad about x, y, z\n" +
         rows;
}

}  // namespace

std::string reading_table(const std::vector<ReadingAnswer>& readings) {
  constexpr std::size_t width = 26;
  if (readings.empty())
    return {};
  std::string text = "\nReadings, pF: value, background (without the targets) and change, their difference\n";
  std::size_t names_width = 12;
  for (const ReadingAnswer& reading : readings)
    names_width = std::max(names_width, reading.name.size() + 2);
  for (const ReadingAnswer& reading : readings)
    text += fmt::format("  {:<{}}{}{}{}\n", reading.name, names_width, padded(text_of(reading.value), width),
                        padded(text_of(reading.background), width), text_of(reading.change));
  return text + derivative_table(readings, names_width);
}

}  // namespace fringe::cli
