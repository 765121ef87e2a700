#pragma once

namespace fringe::detail {

/// Throws Interrupted if the thread's InterruptionScope says so. Loops that may take more than some
/// milliseconds call it between their steps; without a scope it costs a nanosecond.
void check_interruption();

}  // namespace fringe::detail
