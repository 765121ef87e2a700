#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/scene.hpp"

namespace fringe {

/// A frame of a motion.
struct Frame {
  std::string name;                      ///< need not be unique
  std::vector<Eigen::Isometry3d> poses;  ///< of every link of the scene relative to its parent
};

/// Reads a motion file as geometries/SCENE.md describes it. Every frame begins with the poses of the frame
/// before it, the first one with those of the scene. Throws InputError with "FILE:LINE: KEY: REASON" for
/// everything that SCENE.md calls an error.
std::vector<Frame> load_motion(const std::filesystem::path& path, const Scene& scene);

/// Returns the index of the frame of this name, or else of this number, from 1 on. Throws InputError when
/// there is none, or when several frames have the name.
std::size_t find_frame(const std::vector<Frame>& motion, const std::string& name_or_number);

}  // namespace fringe
