#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fringe/scene.hpp"

/// The formats of robots and models that are imported. Each reader makes a scene of a file.
namespace fringe::cli {

/// Returns a file's extension in small letters, with its dot.
std::string extension_of(const std::filesystem::path& path);

/// Returns the content of a file. Throws InputError with the reason if it is not there.
std::string content_of(const std::filesystem::path& path);

/// Returns whether a file is COLLADA (.dae), OBJ or 3MF, by its extension.
bool is_model_file(const std::filesystem::path& path);

/// Reads the nodes of a COLLADA, OBJ or 3MF file as links and their triangles as meshes in metres.
/// The upward axis of COLLADA becomes z. Appends remarks to `warnings`. Throws
/// InputError with file, element and reason.
Scene read_model(const std::filesystem::path& path, std::vector<std::string>& warnings);

/// Reads all triangles of such a file in metres, in the file's own axes. Throws InputError with file and
/// reason.
std::vector<Triangle> read_model_triangles(const std::filesystem::path& path,
                                           std::vector<std::string>& warnings);

/// The geometry that is imported from a link.
enum class UrdfGeometry { collision, visual };

/// Reads "collision" or "visual"; throws InputError for anything else.
UrdfGeometry parse_urdf_geometry(const std::string& name);

/// Tells whether a robot with a mesh that is missing or cannot be read is refused, or imported without it.
enum class MissingMesh { refuse, leave_out };

/// Reads "refuse" or "leave-out"; throws InputError for anything else.
MissingMesh parse_missing_mesh(const std::string& name);

/// The part of a robot to import, and the positions of its joints.
struct UrdfRequest {
  UrdfGeometry geometry = UrdfGeometry::collision;
  MissingMesh missing = MissingMesh::refuse;
  std::vector<std::filesystem::path> package_paths;  ///< searched first for packages
  std::map<std::string, double> joints;              ///< positions by name, rad or m; 0 for all others
};

/// Reads the links, joints and bodies of a robot. Joints that mimic others follow them. Meshes are in metres.
/// A file in `package://NAME/…` is searched as NAME/… first in each folder of `package_paths`, then in the
/// folders that contain the URDF file, where the package's folder may also have another name. What is missing
/// but not needed, what has no size, and positions beyond the limits, are appended to `warnings` with file
/// and element. Throws InputError with file, element and reason.
Scene read_urdf(const std::filesystem::path& path, const UrdfRequest& request,
                std::vector<std::string>& warnings);

/// Reads the nodes of a glTF 2.0 model (.gltf, .glb) as links and their triangles as meshes in metres; the
/// axes are the file's, where y points up. Links are rigid: scaling and shear of the nodes are applied to the
/// meshes. Throws InputError with file, element and reason.
Scene read_gltf(const std::filesystem::path& path);

/// Reads the nodes of a COLLADA file with this content as links and their triangles as meshes in metres, by
/// Assimp; `upright`: what is up in the file becomes z. Appends remarks to `warnings`. Throws InputError with
/// element and reason.
Scene read_collada(const std::filesystem::path& path, const std::string& content, bool upright,
                   std::vector<std::string>& warnings);

/// Reads a 3MF file with this content: the items of its build and their components are links, and their
/// meshes bodies in metres. Components may be in other models of the archive. What supports the print, or is
/// there for something else, is left out, which is appended to `warnings`. Throws InputError with element and
/// reason.
Scene read_three_mf(const std::filesystem::path& path, std::string content,
                    std::vector<std::string>& warnings);

/// The triangles of a STEP file, and how far they are from its surfaces.
struct StepImport {
  Scene scene;
  double deflection;  ///< m, the distance that was asked for
  double error;       ///< m, the largest distance measured: at the middle of every edge and triangle
};

/// The part of the diagonal of the bounding box that is asked for as deflection where nothing else is asked
/// for.
constexpr double default_deflection = 1e-3;

/// Reads a STEP file by OpenCASCADE: assemblies and parts are links, solids are meshes in metres with the
/// names that the file gives them. Faces with names are meshes of their own, one for all faces of a part with
/// the same name. `deflection` (m) is the distance that triangles may have from the surface. Throws
/// InputError with file and reason.
StepImport read_step(const std::filesystem::path& path, std::optional<double> deflection);

/// Reads a list of FastCap or FasterCap, or a single file of panels: every conductor becomes an electrode, a
/// mesh in metres in the frame of the world. Conductors have the names of the list; where several groups have
/// a conductor of one name, the name of the group follows, as FastCap prints it: `1%GROUP2`. Dielectric
/// interfaces are left out, with a warning that names file and line. Throws InputError with file, line and
/// reason.
Scene read_panel_list(const std::filesystem::path& path, std::vector<std::string>& warnings);

}  // namespace fringe::cli
