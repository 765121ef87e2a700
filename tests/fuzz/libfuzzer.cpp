#include <cstddef>

#include "fuzz_targets.hpp"

/// Called by libFuzzer for every input; the build selects the target.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fringe::fuzz::FRINGE_FUZZ_TARGET({data, size});
  return 0;
}
