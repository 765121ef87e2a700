#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "fringe/evaluation.hpp"
#include "fringe/motion.hpp"
#include "fringe/scene.hpp"
#include "method_options.hpp"

namespace fringe::cli {

/// Tells whether the change of a reading exceeds its threshold.
enum class Noticed { no, yes, unsure, not_known };

/// The rows of one frame and one method.
struct FrameRows {
  std::string text;              ///< a line for every reading
  std::vector<Noticed> noticed;  ///< for every reading
  bool reached = true;           ///< whether the error asked for was reached
  std::string refused = {};      ///< why there is no answer; empty if there is one
};

/// The first line of the table of a sweep. `key` is a hash of all that the row depends on.
extern const char* const sweep_header;

/// Returns the rows of a method's answer in a frame, whose number counts from 1.
FrameRows answered_rows(const Scene& scene, std::size_t number, const std::string& frame,
                        const std::string& method, const Evaluation& answer, const std::string& key);

/// Returns the rows of a method that has no answer in a frame: nothing but their names.
FrameRows refused_rows(const Scene& scene, std::size_t number, const std::string& frame,
                       const std::string& method);

/// The rows of a sweep that a file holds already.
class EarlierRows {
 public:
  EarlierRows() = default;

  /// Reads a file; one that does not exist, or is a table of another version, holds no rows. Throws
  /// InputError for a file that is no table of a sweep.
  explicit EarlierRows(const std::filesystem::path& file);

  bool empty() const { return lines_.empty(); }

  /// Returns the rows of a frame and a method if all of them are there under this very key.
  std::optional<FrameRows> find(const Scene& scene, std::size_t number, const std::string& frame,
                                const std::string& method, const std::string& key) const;

 private:
  std::set<std::string> lines_;
};

/// The identity of a sweep's rows: a hash of the scene's file, its triangles, the poses of a frame, the
/// method with its options, and the version of this program.
class SweepKey {
 public:
  SweepKey(const std::filesystem::path& file, const Scene& scene);

  std::string of(const Frame& frame, const MethodRequest& request) const;

 private:
  std::uint64_t scene_;
};

}  // namespace fringe::cli
