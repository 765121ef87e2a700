#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace fringe::detail {

/// The outcome of a comparison, with the operations of a mask of lanes.
struct SingleMask {
  bool value;
};

inline SingleMask operator&(SingleMask a, SingleMask b) {
  return {a.value && b.value};
}
inline SingleMask operator|(SingleMask a, SingleMask b) {
  return {a.value || b.value};
}
inline SingleMask operator!(SingleMask a) {
  return {!a.value};
}
inline bool any(SingleMask mask) {
  return mask.value;
}
inline bool all(SingleMask mask) {
  return mask.value;
}

/// A double with the operations of a register, so that the same source builds for any processor.
struct Single {
  double value;

  Single() = default;
  Single(double number) : value(number) {}  // NOLINT(google-explicit-constructor): as xsimd::batch does

  static Single load_unaligned(const double* from) { return *from; }
  void store_unaligned(double* to) const { *to = value; }
};

inline Single operator+(Single a, Single b) {
  return a.value + b.value;
}
inline Single operator-(Single a, Single b) {
  return a.value - b.value;
}
inline Single operator*(Single a, Single b) {
  return a.value * b.value;
}
inline Single operator/(Single a, Single b) {
  return a.value / b.value;
}
inline SingleMask operator<(Single a, Single b) {
  return {a.value < b.value};
}
inline SingleMask operator<=(Single a, Single b) {
  return {a.value <= b.value};
}
inline SingleMask operator>(Single a, Single b) {
  return {a.value > b.value};
}
inline SingleMask operator>=(Single a, Single b) {
  return {a.value >= b.value};
}
inline SingleMask operator==(Single a, Single b) {
  return {a.value == b.value};
}
inline Single min(Single a, Single b) {
  return b.value < a.value ? b : a;
}
inline Single max(Single a, Single b) {
  return a.value < b.value ? b : a;
}
inline Single abs(Single a) {
  return std::abs(a.value);
}
inline Single sqrt(Single a) {
  return std::sqrt(a.value);
}
inline Single fma(Single a, Single b, Single c) {
  return a.value * b.value + c.value;
}
inline Single select(SingleMask condition, Single a, Single b) {
  return condition.value ? a : b;
}
inline double hadd(Single a) {
  return a.value;
}

/// One double, without any instruction beyond the language.
struct LanesScalar {
  using Vector = Single;
  using Mask = SingleMask;
  static constexpr int width = 1;
  static constexpr bool fused = false;

  static unsigned bits(Mask mask) { return mask.value ? 1U : 0U; }
  static Vector log(Vector x) { return std::log(x.value); }
  static Vector atan2(Vector y, Vector x) { return std::atan2(y.value, x.value); }
  /// Replaces the last five bits by the number, at most 31.
  static Vector tagged(Vector x, std::uint32_t number) {
    return std::bit_cast<double>((std::bit_cast<std::uint64_t>(x.value) & ~std::uint64_t{31}) | number);
  }
  static std::uint32_t tag(double x) { return std::bit_cast<std::uint64_t>(x) & 31U; }
  static double largest(Vector x) { return x.value; }
  static constexpr bool has_estimate = false;
};

}  // namespace fringe::detail
