#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace fringe::detail {

/// The result of a comparison, with the operations of a mask of lanes.
struct OneMask {
  bool value;
};

inline OneMask operator&(OneMask a, OneMask b) {
  return {a.value && b.value};
}
inline OneMask operator|(OneMask a, OneMask b) {
  return {a.value || b.value};
}
inline OneMask operator!(OneMask a) {
  return {!a.value};
}
inline bool any(OneMask mask) {
  return mask.value;
}
inline bool all(OneMask mask) {
  return mask.value;
}

/// A number with the operations of a vector register, so that the same source builds for any processor.
template <class Number>
struct OneLane {
  Number value;

  OneLane() = default;
  OneLane(Number number) : value(number) {}  // NOLINT(google-explicit-constructor): as xsimd::batch does

  static OneLane load_unaligned(const Number* from) { return *from; }
  void store_unaligned(Number* to) const { *to = value; }

  friend OneLane operator+(OneLane a, OneLane b) { return a.value + b.value; }
  friend OneLane operator-(OneLane a, OneLane b) { return a.value - b.value; }
  friend OneLane operator*(OneLane a, OneLane b) { return a.value * b.value; }
  friend OneLane operator/(OneLane a, OneLane b) { return a.value / b.value; }
  friend OneMask operator<(OneLane a, OneLane b) { return {a.value < b.value}; }
  friend OneMask operator<=(OneLane a, OneLane b) { return {a.value <= b.value}; }
  friend OneMask operator>(OneLane a, OneLane b) { return {a.value > b.value}; }
  friend OneMask operator>=(OneLane a, OneLane b) { return {a.value >= b.value}; }
  friend OneMask operator==(OneLane a, OneLane b) { return {a.value == b.value}; }
  friend OneLane min(OneLane a, OneLane b) { return b.value < a.value ? b : a; }
  friend OneLane max(OneLane a, OneLane b) { return a.value < b.value ? b : a; }
  friend OneLane abs(OneLane a) { return std::abs(a.value); }
  friend OneLane sqrt(OneLane a) { return std::sqrt(a.value); }
  friend OneLane fma(OneLane a, OneLane b, OneLane c) { return a.value * b.value + c.value; }
  friend OneLane select(OneMask condition, OneLane a, OneLane b) { return condition.value ? a : b; }
  friend Number hadd(OneLane a) { return a.value; }
};

/// One double, in standard C++ only.
struct LanesScalar {
  using Vector = OneLane<double>;
  using Mask = OneMask;
  static constexpr int width = 1;
  static constexpr bool fused = false;

  static unsigned bits(Mask mask) { return mask.value ? 1U : 0U; }
  /// Loads the coordinates of points that follow one another in memory.
  static void deinterleave(const double* points, Vector& x, Vector& y, Vector& z) {
    x = points[0], y = points[1], z = points[2];
  }
  /// Loads numbers of single precision.
  static Vector load_singles(const float* from) { return static_cast<double>(*from); }
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

/// One float, in standard C++ only.
struct FloatLanesScalar {
  using Vector = OneLane<float>;
  static constexpr int width = 1;

  static Vector inverse_square_root(Vector x) { return Vector(1) / sqrt(x); }
  static float sum(Vector x) { return x.value; }
  static float smallest(Vector x) { return x.value; }
};

}  // namespace fringe::detail
