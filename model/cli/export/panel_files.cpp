#include "export/panel_files.hpp"

#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "fringe/conductors.hpp"
#include "fringe/error.hpp"
#include "surface/bodies.hpp"
#include "unique_names.hpp"

namespace fringe::cli {
namespace {

using Eigen::Vector3d;

/// Largest number of letters of a name: FasterCap reads lines of 512 letters.
constexpr std::size_t longest_name = 60;

void require_conductors_alone(const Scene& scene) {
  if (scene.has_room)
    throw InputError("has a room, which a list of FastCap cannot have");
  for (const Object& object : scene.objects)
    if (std::holds_alternative<Dielectric>(object.role))
      throw InputError(fmt::format(
          R"(object "{}" is dielectric: only conductors are written to a list of FastCap)", object.name));
}

std::string corner_text(const Vector3d& corner) {
  // Adding 0.0 turns -0.0 into 0.0.
  return fmt::format(" {} {} {}", corner.x() + 0.0, corner.y() + 0.0, corner.z() + 0.0);
}

/// Returns whether two triangles (p q r) and (p r s) are a parallelogram.
bool are_parallelogram(const Triangle& a, const Triangle& b) {
  /// Distance of the fourth corner from where it should be, relative to the diagonal: rounding.
  constexpr double rounding = 1e-12;
  return a[0] == b[0] && a[2] == b[1] &&
         (a[0] - a[1] + a[2] - b[2]).norm() <= rounding * (a[2] - a[0]).norm();
}

/// The panels of a file, as text, and their number.
struct PanelText {
  std::string text;
  std::size_t count = 0;
};

PanelText panel_text(const std::vector<Triangle>& triangles, const std::string& conductor) {
  PanelText result;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& triangle = triangles[i];
    const bool is_quadrilateral = i + 1 < triangles.size() && are_parallelogram(triangle, triangles[i + 1]);
    result.text += fmt::format("{} {}", is_quadrilateral ? 'Q' : 'T', conductor);
    for (const Vector3d& corner : triangle)
      result.text += corner_text(corner);
    if (is_quadrilateral)
      result.text += corner_text(triangles[++i][2]);
    result.text += '\n';
    ++result.count;
  }
  return result;
}

const char* description(detail::Role role) {
  switch (role) {
  case detail::Role::sensor:
    return "sensor";
  case detail::Role::electrode:
    return "electrode";
  case detail::Role::grounded:
    return "grounded";
  case detail::Role::floating:
    return "floating";
  }
  return "";
}

/// Returns the surfaces of all sensors and objects by name. Meshes are those that boundary elements take: a
/// duplicate or a triangle without area would make the matrix of other solvers singular.
std::map<std::string, std::vector<Triangle>> surfaces_of(const Scene& scene) {
  std::map<std::string, std::vector<Triangle>> surfaces;
  for (Conductor& surface : conductors(scene))
    surfaces.emplace(surface.name, std::move(surface.triangles));
  for (const Object& object : scene.objects)
    if (std::holds_alternative<Mesh>(object.shape)) {
      std::vector<Triangle>& triangles = surfaces.at(object.name);
      triangles = detail::cleaned(fmt::format(R"(object "{}")", object.name), triangles);
    }
  return surfaces;
}

}  // namespace

PanelFiles panel_files(const Scene& scene, const std::string& stem) {
  require_conductors_alone(scene);
  const std::map<std::string, std::vector<Triangle>> surfaces = surfaces_of(scene);
  const std::string file_stem = plain_name(stem, "-").substr(0, longest_name);
  UniqueNames names("_", UniqueNames::Case::does_not_count);
  UniqueNames file_names("_", UniqueNames::Case::does_not_count);
  PanelFiles result;
  for (const detail::ChargedConductor& conductor : detail::charged_bodies(scene).conductors) {
    const std::string name = names.take(plain_name(conductor.name, "-").substr(0, longest_name));
    result.list += fmt::format("* {}: {}\n", on_one_line(conductor.name), description(conductor.role));
    for (const std::string& member : conductor.members) {
      const std::string file =
          file_names.take(fmt::format("{}_{}", file_stem, plain_name(member, "-").substr(0, longest_name))) +
          ".qui";
      const PanelText panels = panel_text(surfaces.at(member), name);
      result.files[file] = fmt::format("0 {}, in m\n{}", on_one_line(member), panels.text);
      result.list += fmt::format("C {} {} 0 0 0{}\n", file, scene.medium.relative_permittivity,
                                 &member == &conductor.members.back() ? "" : " +");
      result.panels += panels.count;
    }
    ++result.conductors;
  }
  return result;
}

}  // namespace fringe::cli
