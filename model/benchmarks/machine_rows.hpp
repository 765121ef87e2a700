#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace fringe::benchmarks {

/// Measures readings by the reduced method, at an accuracy asked for, for a hand in 500 poses before an arm
/// at rest, and compares some of the poses with boundary elements.
void measure_hand_before_arm(std::size_t compared);

/// Measures the same on the first frames of a scene's motion, which is beside it in SCENE.motion.toml
/// (python3 -m analysis measure moving --write FOLDER writes such scenes), and then with prepared
/// data that are kept in a folder, if one is named.
void measure_motion(const std::filesystem::path& file, std::size_t poses,
                    const std::optional<std::string>& folder);

}  // namespace fringe::benchmarks
