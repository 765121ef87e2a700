#pragma once

#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "fuzz_targets.hpp"

namespace fringe::fuzz {

/// Aborts the process unless the claim holds, so that a fuzzer keeps the input.
inline void require(bool claim, std::string_view what) {
  if (claim)
    return;
  fmt::print(stderr, "does not hold: {}\n", what);
  std::abort();
}

/// Decodes numbers from bytes; returns zeros when the bytes are used up.
class Input {
 public:
  explicit Input(Bytes bytes) : bytes_(bytes) {}

  bool empty() const { return bytes_.empty(); }
  std::uint8_t byte();

  /// Decodes a point. The input's first byte selects the kind of number: either arbitrary bits, or sixteenths
  /// of small integers times a power of two, exactly or a few units in the last place off. The latter often
  /// give contact, collinear and coplanar points.
  Eigen::Vector3d point();
  double number();

 private:
  Bytes bytes_;
  bool any_bits_ = false;
  bool beside_ = false;
  int exponent_ = 0;
  bool begun_ = false;
};

/// Returns whether all numbers are within the limit of a scene file.
bool in_a_scene(const std::vector<Eigen::Vector3d>& points);

/// Returns whether the points are in the range without overflow and denormal numbers, where properties of the
/// exact answer also hold for the rounded one.
bool ordinary(const std::vector<Eigen::Vector3d>& points);

}  // namespace fringe::fuzz
