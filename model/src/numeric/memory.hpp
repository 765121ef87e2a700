#pragma once

#include <cstddef>

namespace fringe::detail {

/// Returns the physical memory of this machine in bytes; in a browser, what a page may have.
std::size_t physical_memory();

}  // namespace fringe::detail
