#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace fringe::detail {

/// The vectors of WebAssembly, 16 bytes, by the vector extension of clang. A comparison has all bits of a
/// lane set where it holds.
template <class Number, class Bits>
struct Simd128 {
  using Raw [[gnu::vector_size(16)]] = Number;
  using RawBits [[gnu::vector_size(16)]] = Bits;
  static constexpr int width = 16 / sizeof(Number);

  struct Mask {
    RawBits value;
    friend Mask operator&(Mask a, Mask b) { return {a.value & b.value}; }
    friend Mask operator|(Mask a, Mask b) { return {a.value | b.value}; }
    friend Mask operator!(Mask a) { return {~a.value}; }
    friend bool any(Mask mask) {
      bool found = false;
      for (int k = 0; k < width; ++k)
        found = found || mask.value[k] != 0;
      return found;
    }
    friend bool all(Mask mask) { return !any(!mask); }
  };

  Raw value;

  Simd128() = default;
  Simd128(Raw raw) : value(raw) {}  // NOLINT(google-explicit-constructor): as xsimd::batch does
  Simd128(Number number) : value(Raw{} + not_loaded(number)) {}  // NOLINT(google-explicit-constructor)

  /// Returns the number, hiding from the compiler that it was loaded from memory: LLVM 14 folds the load of a
  /// number and its copying to all lanes into an instruction that it moves behind later stores.
  static Number not_loaded(Number number) {
    if (!__builtin_constant_p(number))
      asm("" : "+r"(number));
    return number;
  }

  static Simd128 load_unaligned(const Number* from) {
    Raw raw;
    __builtin_memcpy(&raw, from, sizeof raw);
    return raw;
  }
  void store_unaligned(Number* to) const { __builtin_memcpy(to, &value, sizeof value); }

  friend Simd128 operator+(Simd128 a, Simd128 b) { return a.value + b.value; }
  friend Simd128 operator-(Simd128 a, Simd128 b) { return a.value - b.value; }
  friend Simd128 operator*(Simd128 a, Simd128 b) { return a.value * b.value; }
  friend Simd128 operator/(Simd128 a, Simd128 b) { return a.value / b.value; }
  friend Mask operator<(Simd128 a, Simd128 b) { return {a.value < b.value}; }
  friend Mask operator<=(Simd128 a, Simd128 b) { return {a.value <= b.value}; }
  friend Mask operator>(Simd128 a, Simd128 b) { return {a.value > b.value}; }
  friend Mask operator>=(Simd128 a, Simd128 b) { return {a.value >= b.value}; }
  friend Mask operator==(Simd128 a, Simd128 b) { return {a.value == b.value}; }
  friend Simd128 select(Mask condition, Simd128 a, Simd128 b) {
    return std::bit_cast<Raw>((condition.value & std::bit_cast<RawBits>(a.value)) |
                              (~condition.value & std::bit_cast<RawBits>(b.value)));
  }
  friend Simd128 min(Simd128 a, Simd128 b) { return select(b < a, b, a); }
  friend Simd128 max(Simd128 a, Simd128 b) { return select(a < b, b, a); }
  friend Simd128 abs(Simd128 a) { return __builtin_elementwise_abs(a.value); }
  friend Simd128 sqrt(Simd128 a) {
    Raw root;
    for (int k = 0; k < width; ++k)
      root[k] = std::sqrt(a.value[k]);
    return root;
  }
  friend Simd128 fma(Simd128 a, Simd128 b, Simd128 c) { return a.value * b.value + c.value; }
  friend Number hadd(Simd128 a) {
    Number sum = a.value[0];
    for (int k = 1; k < width; ++k)
      sum += a.value[k];
    return sum;
  }
};

/// Two doubles.
struct LanesSimd128 {
  using Vector = Simd128<double, std::int64_t>;
  using Mask = Vector::Mask;
  static constexpr int width = Vector::width;
  static constexpr bool fused = false;

  static unsigned bits(Mask mask) { return (mask.value[0] != 0 ? 1U : 0U) | (mask.value[1] != 0 ? 2U : 0U); }
  /// Loads the coordinates of points that follow one another in memory.
  static void deinterleave(const double* points, Vector& x, Vector& y, Vector& z) {
    x = Vector::Raw{points[0], points[3]};
    y = Vector::Raw{points[1], points[4]};
    z = Vector::Raw{points[2], points[5]};
  }
  /// Loads numbers of single precision.
  static Vector load_singles(const float* from) {
    return Vector::Raw{static_cast<double>(from[0]), static_cast<double>(from[1])};
  }
  static Vector log(Vector x) { return Vector::Raw{std::log(x.value[0]), std::log(x.value[1])}; }
  static Vector atan2(Vector y, Vector x) {
    return Vector::Raw{std::atan2(y.value[0], x.value[0]), std::atan2(y.value[1], x.value[1])};
  }
  /// Replaces the last five bits of each lane by `first` (at most 31) plus the lane's number.
  static Vector tagged(Vector x, std::uint32_t first) {
    const Vector::RawBits tags{static_cast<std::int64_t>(first), static_cast<std::int64_t>(first) + 1};
    return std::bit_cast<Vector::Raw>((std::bit_cast<Vector::RawBits>(x.value) & ~std::int64_t{31}) | tags);
  }
  static std::uint32_t tag(double x) { return std::bit_cast<std::uint64_t>(x) & 31U; }
  static double largest(Vector x) { return x.value[0] < x.value[1] ? x.value[1] : x.value[0]; }
  static constexpr bool has_estimate = false;
};

/// Four floats.
struct FloatLanesSimd128 {
  using Vector = Simd128<float, std::int32_t>;
  static constexpr int width = Vector::width;

  static Vector inverse_square_root(Vector x) { return Vector(1) / sqrt(x); }
  static float sum(Vector x) { return hadd(x); }
  static float smallest(Vector x) {
    float least = x.value[0];
    for (int k = 1; k < width; ++k)
      least = x.value[k] < least ? x.value[k] : least;
    return least;
  }
};

}  // namespace fringe::detail
