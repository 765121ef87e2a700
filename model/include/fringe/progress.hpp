#pragma once

#include <functional>
#include <string>

namespace fringe {

/// While it exists, what takes long to prepare for the correction `formula` at an accuracy, on the thread
/// that made it, shows a function how far it is, in a line such as "machine: 12000 panels, error 0.03 of
/// 0.005 asked for". The innermost scope counts.
class ProgressScope {
 public:
  explicit ProgressScope(std::function<void(const std::string&)> show);
  ~ProgressScope();
  ProgressScope(const ProgressScope&) = delete;
  ProgressScope& operator=(const ProgressScope&) = delete;

 private:
  std::function<void(const std::string&)> show_;
  const std::function<void(const std::string&)>* outer_;
};

}  // namespace fringe
