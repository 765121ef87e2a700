#pragma once

namespace fringe::detail {

/// One float, without any instruction beyond the language.
struct SingleLanesScalar {
  using Vector = float;
  static constexpr int width = 1;

  static Vector zero() { return 0; }
  static Vector all(float number) { return number; }
  static Vector load(const float* from) { return *from; }
  static void store(float* to, Vector a) { *to = a; }
  static Vector subtract(Vector a, Vector b) { return a - b; }
  static Vector multiply(Vector a, Vector b) { return a * b; }
  static Vector multiply_add(Vector a, Vector b, Vector c) { return a * b + c; }
  static Vector inverse_root(Vector a) { return 1 / __builtin_sqrtf(a); }
  static float sum(Vector a) { return a; }
};

}  // namespace fringe::detail
