#pragma once

#include <cstddef>

namespace fringe::detail {

/// One float, without any instruction beyond the language.
struct SingleLanesScalar {
  using Vector = float;
  static constexpr std::ptrdiff_t width = 1;

  static Vector zero() { return 0; }
  static Vector all(float number) { return number; }
  static Vector load(const float* from) { return *from; }
  static void store(float* to, Vector a) { *to = a; }
  static Vector add(Vector a, Vector b) { return a + b; }
  static Vector root(Vector a) { return __builtin_sqrtf(a); }
  static Vector absolute(Vector a) { return a < 0 ? -a : a; }
  static Vector larger(Vector a, Vector b) { return a < b ? b : a; }
  static Vector smaller(Vector a, Vector b) { return b < a ? b : a; }
  static float least(Vector a) { return a; }
  static Vector subtract(Vector a, Vector b) { return a - b; }
  static Vector multiply(Vector a, Vector b) { return a * b; }
  static Vector multiply_add(Vector a, Vector b, Vector c) { return a * b + c; }
  static Vector inverse_root(Vector a) { return 1 / __builtin_sqrtf(a); }
  static float sum(Vector a) { return a; }
};

}  // namespace fringe::detail
