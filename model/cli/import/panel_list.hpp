#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// Reads a list of FastCap or FasterCap, or a single file of panels: every conductor becomes an electrode, a
/// mesh in metres in the frame of the world. Conductors have the names of the list; where several groups have
/// a conductor of one name, the name of the group follows, as FastCap prints it: `1%GROUP2`. Dielectric
/// interfaces are left out, with a warning that names file and line. Throws InputError with file, line and
/// reason.
Scene read_panel_list(const std::filesystem::path& path, std::vector<std::string>& warnings);

}  // namespace fringe::cli
