#include "fringe/remarks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "geometry/surface_mesh.hpp"

namespace fringe {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Longest plate of a sensor without a remark, in metres: the electrodes of proximity sensors are centimetres
/// long, so that those written in millimetres seem to be more than 10 m.
constexpr double longest_plate = 10;
/// Longest object without a remark, in metres: rooms in which such sensors work are shorter, and a finger
/// written in millimetres seems to be longer.
constexpr double longest_object = 20;
/// Shortest scene without a remark, in metres: one of a metre, read as if it were in millimetres.
constexpr double shortest_scene = 1e-3;
/// Narrowest gap without a remark, in metres: some atoms.
constexpr double narrowest_gap = 1e-9;
/// Number of an object's vertices that are looked for inside another object.
constexpr std::size_t most_vertices = 8;

/// An object's surface.
struct Body {
  const Object* object;
  double length;                    ///< m, the longest side of its box along the axes of its own frame
  std::vector<Triangle> triangles;  ///< in the world
  AlignedBox3d box;                 ///< in the world
};

std::vector<Body> bodies_of(const Scene& scene) {
  const std::vector<Eigen::Isometry3d> links = world_poses(scene.links);
  std::vector<Body> bodies;
  for (const Object& object : scene.objects) {
    Body body{&object, 0, triangulate(object.shape), {}};
    body.length = axis_aligned_box(body.triangles).sizes().maxCoeff();
    const Eigen::Isometry3d pose = attachment_pose(links, object.link) * object.pose;
    for (Triangle& triangle : body.triangles)
      triangle = transformed(triangle, pose);
    body.box = axis_aligned_box(body.triangles);
    bodies.push_back(std::move(body));
  }
  return bodies;
}

AlignedBox3d box_of(const Sensor& sensor, const std::vector<Eigen::Isometry3d>& links) {
  AlignedBox3d box;
  for (const Rectangle& plate : sensor.plates) {
    const auto& [corner, u, v] = transformed(plate, attachment_pose(links, sensor.link));
    for (const Vector3d& point :
         {corner, Vector3d(corner + u), Vector3d(corner + v), Vector3d(corner + u + v)})
      box.extend(point);
  }
  return box;
}

/// Lists up to three names in quotation marks, and counts the others.
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most = 3;
  std::vector<std::string> quoted;
  for (std::size_t k = 0; k < std::min(names.size(), most); ++k)
    quoted.push_back(fmt::format("\"{}\"", names[k]));
  if (names.size() > most)
    return fmt::format("{} and {} more", fmt::join(quoted, ", "), names.size() - most);
  if (quoted.size() < 2)
    return quoted.front();
  const std::string last = std::move(quoted.back());
  quoted.pop_back();
  return fmt::format("{} and {}", fmt::join(quoted, ", "), last);
}

/// Remarks on the longest plate and the longest object, if they are too long, and on a scene that is tiny.
void remark_on_sizes(const Scene& scene, const std::vector<Body>& bodies, std::vector<std::string>& found) {
  constexpr const char* question = "is it in millimetres? Then write units = \"mm\" at the top of the scene";
  const std::vector<Eigen::Isometry3d> links = world_poses(scene.links);
  AlignedBox3d all;
  double longest = longest_plate;
  std::string plate_remark;
  for (const Sensor& sensor : scene.sensors) {
    all.extend(box_of(sensor, links));
    for (std::size_t k = 0; k < sensor.plates.size(); ++k) {
      const double length = std::max(sensor.plates[k].edge_u.norm(), sensor.plates[k].edge_v.norm());
      if (length > longest)
        plate_remark = fmt::format("sensor \"{}\": plates[{}] is {:.3g} m long: {}", sensor.name, k,
                                   longest = length, question);
    }
  }
  if (!plate_remark.empty())
    found.push_back(std::move(plate_remark));
  longest = longest_object;
  std::string object_remark;
  for (const Body& body : bodies) {
    all.extend(body.box);
    const auto* mesh = std::get_if<Mesh>(&body.object->shape);
    if (body.length > longest)
      object_remark = fmt::format(
          "object \"{}\" is {:.3g} m long: {}{}", body.object->name, longest = body.length, question,
          mesh != nullptr && !mesh->file.empty() ? ", or scale = 0.001 in the object's shape" : "");
  }
  if (!object_remark.empty())
    found.push_back(std::move(object_remark));
  if (all.sizes().maxCoeff() < shortest_scene)
    found.push_back(
        fmt::format("all of the scene is {:.3g} m long: are its lengths in other units than it says "
                    "by units and scale?",
                    all.sizes().maxCoeff()));
}

/// Remarks on triangles of a mesh that do not count, and on those that face inwards.
void remark_on_triangles(const Object& object, std::vector<std::string>& found) {
  const auto* mesh = std::get_if<Mesh>(&object.shape);
  // The triangles of a person, a mesh without a file, are sound.
  if (mesh == nullptr || mesh->file.empty())
    return;
  std::vector<Triangle> sound;
  std::copy_if(mesh->triangles.begin(), mesh->triangles.end(), std::back_inserter(sound),
               [](const Triangle& triangle) { return twice_area(triangle) > 0; });
  const std::size_t without_area = mesh->triangles.size() - sound.size(), with_repeated = sound.size();
  const std::size_t repeated = with_repeated - without_duplicates(std::move(sound)).size();
  std::vector<std::string> left_out;
  if (without_area > 0)
    left_out.push_back(fmt::format("triangles without area: {}", without_area));
  if (repeated > 0)
    left_out.push_back(fmt::format("triangles that repeat others: {}", repeated));
  if (!left_out.empty())
    found.push_back(
        fmt::format("object \"{}\": {}; they are left out", object.name, fmt::join(left_out, ", ")));
  if (is_closed(mesh->triangles) && signed_volume(mesh->triangles) < 0)
    found.push_back(
        fmt::format("object \"{}\": its triangles face inwards: with faces \"facing\" its far side "
                    "counts, and the field solver wraps it; reverse the order of their vertices",
                    object.name));
}

/// Tests whether vertices of `inner`, chosen evenly, are all inside `outer`.
bool is_inside(const Body& inner, const Body& outer, std::optional<bool>& outer_is_closed) {
  // Strictly, because vertices on the surface are neither inside nor outside.
  if (!(outer.box.min().array() < inner.box.min().array()).all() ||
      !(inner.box.max().array() < outer.box.max().array()).all())
    return false;
  if (!outer_is_closed)
    outer_is_closed = is_closed(outer.triangles);
  if (!*outer_is_closed)
    return false;
  const std::size_t count = std::min(inner.triangles.size(), most_vertices);
  for (std::size_t k = 0; k < count; ++k)
    if (!detail::is_in_polyhedron(outer.triangles, inner.triangles[k * inner.triangles.size() / count][0]))
      return false;
  return count > 0;
}

/// Remarks on dielectric objects that polarise less than empty space.
void remark_on_permittivities(const Scene& scene, std::vector<std::string>& found) {
  for (const Object& object : scene.objects)
    if (const auto* dielectric = std::get_if<Dielectric>(&object.role);
        dielectric != nullptr && dielectric->relative_permittivity < 1)
      found.push_back(fmt::format(
          "object \"{}\": its relative permittivity of {:.3g} is less than that of empty space, 1; "
          "no material has it at rest",
          object.name, dielectric->relative_permittivity));
}

void remark_on_insides(const std::vector<Body>& bodies, std::vector<std::string>& found) {
  for (const Body& outer : bodies) {
    std::optional<bool> outer_is_closed;
    std::vector<std::string> inside;
    for (const Body& inner : bodies)
      if (&inner != &outer && is_inside(inner, outer, outer_is_closed))
        inside.push_back(inner.object->name);
    if (!inside.empty())
      found.push_back(fmt::format("object \"{}\" contains {}: the triangle integrals and the formula count "
                                  "what is inside as if it were "
                                  "not; the other methods take grounded objects as one, and refuse others",
                                  outer.object->name, listed(inside)));
  }
}

/// Remarks on objects that add nothing because a sensor sees only the backs of their triangles.
void remark_on_backs(const SceneCapacitance& answer, std::vector<std::string>& found) {
  for (const SensorCapacitance& sensor : answer.sensors) {
    std::vector<std::string> unseen;
    for (const ObjectCapacitance& object : sensor.objects)
      if (object.capacitance == 0 && !object.skipped)
        unseen.push_back(object.name);
    if (!unseen.empty())
      found.push_back(
          fmt::format("sensor \"{}\" sees only backs of the triangles of {}, which do not count with "
                      "faces \"facing\": their capacitance is 0",
                      sensor.name, listed(unseen)));
  }
}

/// Tests whether the straight way between two points meets a box.
bool is_between(const AlignedBox3d& box, const Vector3d& from, const Vector3d& to) {
  double first = 0, last = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double way = to[axis] - from[axis];
    double enter = box.min()[axis] - from[axis], leave = box.max()[axis] - from[axis];
    if (way == 0) {
      if (enter > 0 || leave < 0)
        return false;
      continue;
    }
    enter /= way, leave /= way;
    first = std::max(first, std::min(enter, leave));
    last = std::min(last, std::max(enter, leave));
  }
  return first <= last;
}

/// Remarks on objects that shield others from a sensor: those between, and those closer to it than it is
/// wide. What an object hides is estimated by boxes.
void remark_on_shields(const Scene& scene, const std::vector<Body>& bodies, const Evaluation& answer,
                       std::vector<std::string>& found) {
  const std::vector<Eigen::Isometry3d> links = world_poses(scene.links);
  for (const SensorCapacitance& evaluated : answer.capacitance.sensors) {
    const auto sensor = std::ranges::find(scene.sensors, evaluated.name, &Sensor::name);
    const AlignedBox3d box = box_of(*sensor, links);
    std::vector<std::string> hidden, shields;
    for (const ObjectCapacitance& object : evaluated.objects) {
      if (object.error)
        continue;
      const auto target =
          std::ranges::find_if(bodies, [&](const Body& body) { return body.object->name == object.name; });
      const double distance = box.exteriorDistance(target->box);
      bool is_hidden = false;
      for (const Body& body : bodies) {
        const double nearer = box.exteriorDistance(body.box);
        if (&body == &*target || std::holds_alternative<Dielectric>(body.object->role) ||
            nearer >= distance ||
            (nearer >= box.diagonal().norm() && !is_between(body.box, box.center(), target->box.center())))
          continue;
        is_hidden = true;
        if (std::ranges::find(shields, body.object->name) == shields.end())
          shields.push_back(body.object->name);
      }
      if (is_hidden)
        hidden.push_back(object.name);
    }
    if (!hidden.empty())
      found.push_back(
          fmt::format("sensor \"{}\": {} close to it or in between, and the method {} knows nothing of "
                      "shielding: what it says "
                      "of {} may be several times too much; compare with auto",
                      evaluated.name, listed(shields) + (shields.size() == 1 ? " is" : " are"),
                      answer.answered_by, listed(hidden)));
  }
}

/// Remarks on objects so close to a sensor that they all but touch it.
void remark_on_narrow_gaps(const Scene& scene, const std::vector<Body>& bodies, const Evaluation& answer,
                           std::vector<std::string>& found) {
  for (const SensorCapacitance& evaluated : answer.capacitance.sensors) {
    double area = 0;
    for (const Rectangle& plate : std::ranges::find(scene.sensors, evaluated.name, &Sensor::name)->plates)
      area += plate.edge_u.norm() * plate.edge_v.norm();
    std::vector<std::string> near;
    for (const ObjectCapacitance& object : evaluated.objects) {
      const auto body =
          std::ranges::find_if(bodies, [&](const Body& one) { return one.object->name == object.name; });
      double own_area = 0;
      for (const Triangle& triangle : body->triangles)
        own_area += twice_area(triangle) / 2;
      const double facing = std::min(area, own_area);
      // The charge of what is smaller than the gap does not tell how near it is.
      if (std::isfinite(object.capacitance) && std::sqrt(facing) > narrowest_gap &&
          object.capacitance * narrowest_gap >
              vacuum_permittivity * scene.medium.relative_permittivity * facing)
        near.push_back(object.name);
    }
    if (!near.empty())
      found.push_back(
          fmt::format("sensor \"{}\": less than {:g} m from {}, which is contact to anything but arithmetic: "
                      "boundary-elements and reduced cannot tell such a change",
                      evaluated.name, narrowest_gap, listed(near)));
  }
}

/// Remarks on what the triangle integrals and the formula take in the place of covers and dielectric targets.
void remark_on_insulators(const Scene& scene, const Evaluation& answer, const std::string& method,
                          std::vector<std::string>& found) {
  std::vector<std::string> covered, enclosed;
  for (const Sensor& sensor : scene.sensors)
    if (std::ranges::any_of(scene.objects, [&](const Object& object) {
          return is_cover(object) && object.conductor == sensor.name;
        }))
      covered.push_back(sensor.name);
  for (const Object& object : scene.objects)
    if (std::holds_alternative<Dielectric>(object.role) && !is_cover(object))
      enclosed.push_back(object.name);
  if (!covered.empty())
    found.push_back(fmt::format(
        "sensor {}: the method {} takes the cover by the layer rule, as a plate nearer by t(1 - 1/e); "
        "compare with boundary-elements",
        listed(covered), method));
  if (enclosed.empty())
    return;
  const bool is_known = std::ranges::all_of(
      answer.readings, [](const ReadingAnswer& reading) { return reading.change.value.has_value(); });
  found.push_back(
      is_known
          ? fmt::format(
                "object {}: dielectric, of which the method {} only knows between which conductors' changes "
                "its change lies; the error says so. Compare with boundary-elements",
                listed(enclosed), method)
          : fmt::format("object {}: dielectric, of which the method {} knows no change here; "
                        "boundary-elements does",
                        listed(enclosed), method));
}

/// Remarks on changes that auto takes from a method without a matrix, because that states a smaller error.
/// Returns that method.
std::optional<std::string> remark_on_changes_by_another_method(const Evaluation& answer,
                                                               std::vector<std::string>& found) {
  std::optional<std::string> method;
  std::vector<std::string> readings;
  for (const ReadingAnswer& reading : answer.readings)
    if (reading.answered_by != answer.answered_by) {
      method = reading.answered_by;
      readings.push_back(reading.name);
    }
  if (method)
    found.push_back(fmt::format("reading {}: the change is by {}, which states a smaller error than {}",
                                listed(readings), *method, answer.answered_by));
  return method;
}

/// Remarks on a room, of which no method of the library knows more than that it is there.
void remark_on_room(const Scene& scene, const Evaluation& answer, std::vector<std::string>& found) {
  if (scene.has_room)
    found.push_back(fmt::format("room: the method {} answers as in free space, without the grounded walls; "
                                "the field solver knows them",
                                answer.answered_by));
}

/// Remarks on changes that contact makes infinite or unknown, and on those whose errors are not known.
void remark_on_contact(const Evaluation& answer, std::vector<std::string>& found) {
  std::vector<std::string> infinite, unknown, without_error;
  for (const ReadingAnswer& reading : answer.readings)
    if (!reading.change.value)
      unknown.push_back(reading.name);
    else if (std::isinf(*reading.change.value))
      infinite.push_back(reading.name);
    else if (!reading.change.error)
      without_error.push_back(reading.name);
  if (!infinite.empty())
    found.push_back(fmt::format("reading {}: a target touches what it senses or drives, so that its change "
                                "is infinite",
                                listed(infinite)));
  if (answer.answered_by != to_string(Method(Reduced{})))
    return;
  if (!unknown.empty())
    found.push_back(fmt::format("reading {}: bodies touch that may have different potentials, or nearly so: "
                                "its change is not known",
                                listed(unknown)));
  if (!without_error.empty())
    found.push_back(fmt::format("reading {}: the gap before a target is too small to tell the error of its "
                                "change; ask for less, or boundary-elements",
                                listed(without_error)));
}

/// Remarks on derivatives that are asked for and not known.
void remark_on_derivatives(const std::vector<ReadingAnswer>& readings, std::vector<std::string>& found) {
  for (const ReadingAnswer& reading : readings)
    if (reading.derivatives.empty())
      found.push_back(fmt::format("reading \"{}\": {} does not know its change, nor its derivatives",
                                  reading.name, reading.answered_by));
    else if (std::ranges::any_of(reading.derivatives,
                                 [](const LinkDerivatives& of_link) { return of_link.change.hasNaN(); }))
      found.push_back(fmt::format("reading \"{}\": in contact its derivatives are not known", reading.name));
}

std::vector<std::string> remarks(const Scene& scene, const std::vector<Body>& bodies) {
  std::vector<std::string> found = scene.changes;
  remark_on_sizes(scene, bodies, found);
  for (const Object& object : scene.objects)
    remark_on_triangles(object, found);
  remark_on_permittivities(scene, found);
  remark_on_insides(bodies, found);
  return found;
}

}  // namespace

std::vector<std::string> remarks(const Scene& scene) {
  return remarks(scene, bodies_of(scene));
}

std::vector<std::string> remarks(const Scene& scene, const EvaluationOptions& options,
                                 const Evaluation& answer) {
  const std::vector<Body> bodies = bodies_of(scene);
  std::vector<std::string> found = remarks(scene, bodies);
  if (options.derivatives && !scene.links.empty())
    remark_on_derivatives(answer.readings, found);
  remark_on_contact(answer, found);
  const bool is_answered = std::ranges::any_of(answer.readings, [](const ReadingAnswer& reading) {
    return reading.change.value || reading.value.value;
  });
  if (answer.matrix) {
    if (const auto method = remark_on_changes_by_another_method(answer, found))
      remark_on_insulators(scene, answer, *method, found);
    return found;
  }
  if (scene.sensors.empty() && !is_answered)
    found.emplace_back(
        scene.readings.empty()
            ? "the scene has no sensor, so that there is nothing to answer: add a [[sensor]] and its plates"
            : "the scene has no sensor, and this method does not know the electrodes of its readings: "
              "boundary-elements, reduced and auto do");
  if (options.faces == FaceRule::facing)
    remark_on_backs(answer.capacitance, found);
  remark_on_room(scene, answer, found);
  remark_on_insulators(scene, answer, answer.answered_by, found);
  // The reduced method knows what is around a sensor.
  if (answer.answered_by != to_string(Method(Reduced{}))) {
    remark_on_shields(scene, bodies, answer, found);
    remark_on_narrow_gaps(scene, bodies, answer, found);
  }
  return found;
}

}  // namespace fringe
