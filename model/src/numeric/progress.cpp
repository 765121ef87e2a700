#include "numeric/progress.hpp"

#include <utility>

#include "fringe/progress.hpp"

namespace fringe {
namespace {

/// Shows progress for the innermost scope of this thread; null without a scope.
thread_local const std::function<void(const std::string&)>* shown_with = nullptr;

/// The part that this thread works on; null if it has no name.
thread_local const std::string* part_of_work = nullptr;

}  // namespace

ProgressScope::ProgressScope(std::function<void(const std::string&)> show)
    : show_(std::move(show)), outer_(std::exchange(shown_with, &show_)) {}

ProgressScope::~ProgressScope() {
  shown_with = outer_;
}

void detail::show_progress(const std::string& text) {
  if (shown_with != nullptr)
    (*shown_with)(part_of_work != nullptr ? *part_of_work + ": " + text : text);
}

detail::ProgressPart::ProgressPart(std::string name)
    : name_(std::move(name)), outer_(std::exchange(part_of_work, &name_)) {}

detail::ProgressPart::~ProgressPart() {
  part_of_work = outer_;
}

}  // namespace fringe
