#pragma once

#include <string>

namespace fringe::detail {

/// Shows the thread's ProgressScope how far the named part of the work is. Without a scope it costs a
/// nanosecond, besides its text.
void show_progress(const std::string& text);

/// While it exists, what this thread shows begins with the name of the part that it works on.
class ProgressPart {
 public:
  explicit ProgressPart(std::string name);
  ~ProgressPart();
  ProgressPart(const ProgressPart&) = delete;
  ProgressPart& operator=(const ProgressPart&) = delete;

 private:
  std::string name_;
  const std::string* outer_;
};

}  // namespace fringe::detail
