#include "import/import.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "import/gltf.hpp"
#include "import/model_file.hpp"
#include "import/panel_list.hpp"
#include "import/scene_file.hpp"
#include "import/step.hpp"
#include "import/urdf.hpp"

namespace fringe::cli {
namespace {

/// Reads lists of positions, such as "a=0.3,b=-1.2".
std::map<std::string, double> positions(const std::vector<std::string>& lists) {
  std::map<std::string, double> result;
  for (const std::string& list : lists)
    for (std::size_t begin = 0; begin <= list.size();) {
      const std::size_t end = std::min(list.find(',', begin), list.size());
      const std::string item = list.substr(begin, end - begin);
      const std::size_t equals = item.rfind('=');
      const auto refuse = [&](std::string_view reason) {
        throw InputError(fmt::format("--joints: \"{}\" {}", item, reason));
      };
      if (equals == std::string::npos || equals == 0)
        refuse("is not NAME=POSITION");
      const std::string number = item.substr(equals + 1);
      std::size_t read = 0;
      double position = NAN;
      try {
        position = std::stod(number, &read);
      } catch (const std::exception&) {
        read = 0;
      }
      if (number.empty() || read != number.size() || !std::isfinite(position))
        refuse("has no finite number as position");
      if (!result.emplace(item.substr(0, equals), position).second)
        refuse("sets a joint again");
      begin = end + 1;
    }
  return result;
}

/// Refuses options that would change nothing.
void require_urdf(const ImportRequest& request, bool is_urdf) {
  if (!is_urdf &&
      (request.geometry || request.missing || !request.package_paths.empty() || !request.joints.empty()))
    throw InputError("--geometry, --missing, --package-path and --joints are options for URDF");
}

void require_step(const ImportRequest& request, bool is_step) {
  if (!is_step && request.deflection)
    throw InputError("--deflection is an option for STEP");
  if (request.deflection && (!(*request.deflection > 0) || !std::isfinite(*request.deflection)))
    throw InputError(fmt::format("--deflection: must be greater than 0, not {}", *request.deflection));
}

std::string about(const StepImport& step, bool is_default) {
  return fmt::format("; triangles up to {:.2g} m off the surface, {:.2g} m asked for{}", step.error,
                     step.deflection,
                     is_default ? fmt::format(" ({} of the diagonal)", default_deflection) : "");
}

}  // namespace

ImportReport import_scene(const ImportRequest& request) {
  const std::string extension = extension_of(request.source);
  const bool is_step = extension == ".step" || extension == ".stp";
  require_urdf(request, extension == ".urdf");
  require_step(request, is_step);
  ImportReport report;
  std::string remark;
  Scene scene;
  if (extension == ".urdf") {
    const UrdfRequest robot{parse_urdf_geometry(request.geometry.value_or("collision")),
                            parse_missing_mesh(request.missing.value_or("refuse")), request.package_paths,
                            positions(request.joints)};
    scene = read_urdf(request.source, robot, report.warnings);
  } else if (extension == ".gltf" || extension == ".glb") {
    scene = read_gltf(request.source);
  } else if (is_model_file(request.source)) {
    scene = read_model(request.source, report.warnings);
  } else if (is_step) {
    StepImport step = read_step(request.source, request.deflection);
    remark = about(step, !request.deflection);
    scene = std::move(step.scene);
  } else if (extension == ".lst" || extension == ".qui") {
    scene = read_panel_list(request.source, report.warnings);
  } else {
    throw InputError(
        fmt::format("{}: must end in .urdf, .gltf, .glb, .dae, .obj, .3mf, .step, .stp, .lst or .qui{}",
                    request.source.string(),
                    extension == ".xacro" ? "; xacro makes URDF of it: xacro FILE > robot.urdf" : ""));
  }
  const auto meshes = std::count_if(scene.objects.begin(), scene.objects.end(), [](const Object& object) {
    return std::holds_alternative<Mesh>(object.shape);
  });
  const auto joints = std::count_if(scene.links.begin(), scene.links.end(),
                                    [](const Link& link) { return link.joint.has_value(); });
  write_scene_file(scene, request.target, request.source.filename().string());
  report.written = fmt::format("{}: {} links, {}{} objects, {} of them meshes{}", request.target.string(),
                               scene.links.size(), joints > 0 ? fmt::format("{} joints, ", joints) : "",
                               scene.objects.size(), meshes, remark);
  return report;
}

}  // namespace fringe::cli
