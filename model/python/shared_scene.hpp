#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "collision_answers.hpp"
#include "fringe/interruption.hpp"
#include "fringe/live_scene.hpp"
#include "interruption.hpp"

namespace fringe::python {

/// A scene that several Python threads may ask: one answer is computed at a time. It remembers its text, so
/// that it can be pickled, and objects can be hidden, shown and added.
class SharedScene {
 public:
  /// Reads the text of a scene file; mesh files are looked for in the folder.
  SharedScene(const std::string& text, const std::filesystem::path& folder);
  /// Reads a scene file.
  static std::unique_ptr<SharedScene> load(const std::filesystem::path& path);

  /// All that is needed to make a scene again: its text, its folder, its hidden objects and its poses.
  struct State {
    std::string text;
    std::filesystem::path folder;
    std::set<std::string> hidden;
    std::vector<Eigen::Isometry3d> poses;  ///< of the links
  };
  State state();
  static std::unique_ptr<SharedScene> from(const State& state);
  std::unique_ptr<SharedScene> copy();

  /// Hides an object, which is then as if it were not there, or shows it again.
  /// @throws InputError when no object has the name, for an electrode, which readings need, and when neither
  /// sensors nor objects would be left.
  void set_hidden(const std::string& object, bool is_hidden);

  /// Adds what the text of a scene file describes: objects, sensors, links, readings. Links stay where they
  /// are.
  /// @throws InputError as for a scene file that ends with this text.
  void add(const std::string& text);

  /// Runs an action on the scene while no other thread does, and other Python threads run on. Ctrl-C ends it
  /// with KeyboardInterrupt.
  template <typename Action>
  auto locked(const Action& action) {
    const pybind11::gil_scoped_release unlocked;
    const std::lock_guard lock(mutex_);
    const InterruptionScope scope(signal_handling());
    return action(live_);
  }

  /// Counts how often the scene began again, since objects were hidden, shown or added; call it while locked.
  std::uint64_t beginning() const { return beginning_; }

  /// What makes the answers about collisions, or null; call it only with Python's lock.
  std::shared_ptr<CollisionAnswers> collision_answers;

  /// Returns the remarks of the first answer of this kind, which `find` looks for; call it while locked. To
  /// look for them in every pose may take longer than the answer.
  template <typename Find>
  const std::vector<std::string>& remarks_once(const std::string& kind, const Find& find) {
    const auto known = remarks_.find(kind);
    return known != remarks_.end() ? known->second : remarks_.emplace(kind, find()).first->second;
  }

 private:
  SharedScene(std::string text, const std::filesystem::path& folder, Scene scene);
  void begin_again(Scene whole, const std::set<std::string>& hidden);

  std::string text_;
  std::filesystem::path folder_;
  Scene whole_;  ///< with the hidden objects
  std::set<std::string> hidden_;
  LiveScene live_;
  std::uint64_t beginning_ = 0;
  std::map<std::string, std::vector<std::string>> remarks_;  ///< by the kind of answer
  std::mutex mutex_;
};

}  // namespace fringe::python
