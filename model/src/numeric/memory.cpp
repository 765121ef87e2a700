#include "numeric/memory.hpp"

#ifndef __EMSCRIPTEN__
#include <unistd.h>
#endif

namespace fringe::detail {

std::size_t physical_memory() {
#ifdef __EMSCRIPTEN__
  return std::size_t{1} << 30;
#else
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGE_SIZE);
  constexpr std::size_t least = std::size_t{1} << 30;
  return pages > 0 && size > 0 ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(size) : least;
#endif
}

}  // namespace fringe::detail
