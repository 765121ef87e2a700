#include "numeric/interruption.hpp"

#include <algorithm>
#include <utility>

#include "fringe/interruption.hpp"

namespace fringe {
namespace {

/// The question of the innermost scope of this thread and those around it; null without a scope.
thread_local const std::function<bool()>* question = nullptr;

}  // namespace

Interrupted::Interrupted() : std::runtime_error("interrupted before there was an answer") {}

InterruptionScope::InterruptionScope(std::function<bool()> is_to_end)
    : is_to_end_([own = std::move(is_to_end), outer = question] {
        return own() || (outer != nullptr && (*outer)());
      }),
      outer_(std::exchange(question, &is_to_end_)) {}

InterruptionScope::~InterruptionScope() {
  question = outer_;
}

void detail::check_interruption() {
  if (question != nullptr && (*question)())
    throw Interrupted();
}

detail::TimeLimit::TimeLimit(double seconds)
    : start_(std::chrono::steady_clock::now()), seconds_(seconds), scope_([this] { return is_over(); }) {}

double detail::TimeLimit::seconds_left() const {
  return seconds_ - std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void detail::TimeLimit::grant(double seconds) {
  seconds_ += std::max(seconds - seconds_left(), 0.0);
}

}  // namespace fringe
