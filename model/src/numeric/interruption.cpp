#include "numeric/interruption.hpp"

#include <utility>

#include "fringe/interruption.hpp"

namespace fringe {
namespace {

/// The question of the innermost scope of this thread; null without a scope.
thread_local const std::function<bool()>* question = nullptr;

}  // namespace

Interrupted::Interrupted() : std::runtime_error("interrupted before there was an answer") {}

InterruptionScope::InterruptionScope(std::function<bool()> is_to_end)
    : is_to_end_(std::move(is_to_end)), outer_(std::exchange(question, &is_to_end_)) {}

InterruptionScope::~InterruptionScope() {
  question = outer_;
}

void detail::check_interruption() {
  if (question != nullptr && (*question)())
    throw Interrupted();
}

}  // namespace fringe
