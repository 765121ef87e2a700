#include <cstddef>

#include "fuzz_targets.hpp"

/// Called by libFuzzer; the build says which target it is for.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fringe::fuzz::FRINGE_FUZZ_TARGET({data, size});
  return 0;
}
