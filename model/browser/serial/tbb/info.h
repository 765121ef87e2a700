#pragma once

/// The part of TBB that the library uses, on the one thread that a page has.
namespace tbb::info {

inline int default_concurrency() {
  return 1;
}

}  // namespace tbb::info
