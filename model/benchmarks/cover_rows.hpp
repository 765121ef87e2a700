#pragma once

#include <cstddef>

namespace fringe::benchmarks {

/// Measures readings by the reduced method of sensors under covers before a hand and, in the same poses,
/// without the covers; compares them with boundary elements.
void measure_covers(std::size_t poses);

}  // namespace fringe::benchmarks
