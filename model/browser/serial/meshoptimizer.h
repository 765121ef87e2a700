#pragma once

#include <algorithm>
#include <cstddef>

/// The part of meshoptimizer that the library uses, in a form that keeps every triangle: pages have small
/// meshes, and a surface that is not simplified has no error by it.

inline constexpr unsigned int meshopt_SimplifyLockBorder = 1;

inline float meshopt_simplifyScale(const float* /*positions*/, std::size_t /*count*/,
                                   std::size_t /*stride*/) {
  return 1;
}

/// Copies the indices of the triangles, and returns their number.
inline std::size_t meshopt_simplify(unsigned int* destination, const unsigned int* indices, std::size_t count,
                                    const float* /*positions*/, std::size_t /*vertices*/,
                                    std::size_t /*stride*/, std::size_t /*target*/, float /*error*/,
                                    unsigned int /*options*/, float* /*result*/) {
  std::copy(indices, indices + count, destination);
  return count;
}
