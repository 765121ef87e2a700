#pragma once

#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "fuzz_targets.hpp"

namespace fringe::fuzz {

/// Ends the process, so that a fuzzer keeps the input, unless the claim holds.
inline void require(bool claim, std::string_view what) {
  if (claim)
    return;
  fmt::print(stderr, "does not hold: {}\n", what);
  std::abort();
}

/// Takes numbers off the bytes; zeros when they are used up.
class Input {
 public:
  explicit Input(Bytes bytes) : bytes_(bytes) {}

  bool empty() const { return bytes_.empty(); }
  std::uint8_t byte();

  /// A point of three numbers: by the input's first byte either any bits at all, or sixteenths of small whole
  /// numbers, among which contact, lines and planes are frequent, times a power of two; exactly, or units in
  /// the last place beside.
  Eigen::Vector3d point();
  double number();

 private:
  Bytes bytes_;
  bool any_bits_ = false;
  bool beside_ = false;
  int exponent_ = 0;
  bool begun_ = false;
};

/// Whether a scene may hold such numbers.
bool in_a_scene(const std::vector<Eigen::Vector3d>& points);

/// Where nothing overflows and nothing is denormal: what holds of the exact answer holds of a rounded one.
bool ordinary(const std::vector<Eigen::Vector3d>& points);

}  // namespace fringe::fuzz
