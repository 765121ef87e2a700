#pragma once

#include <cstdint>

#include <sleef.h>
#include <xsimd/xsimd.hpp>

namespace fringe::detail {

/// Eight doubles: AVX-512 (F, CD, DQ, BW).
struct LanesAvx512 {
  using Vector = xsimd::batch<double, xsimd::avx512bw>;
  using Mask = Vector::batch_bool_type;
  static constexpr int width = 8;
  static constexpr bool fused = true;

  static unsigned bits(const Mask& mask) { return mask.data; }
  static Vector log(const Vector& x) { return Sleef_logd8_u10avx512f(x); }
  static Vector atan2(const Vector& y, const Vector& x) { return Sleef_atan2d8_u10avx512f(y, x); }

  /// 1/√x to 2^−14.
  static Vector inverse_square_root_estimate(const Vector& x) { return _mm512_rsqrt14_pd(x); }
  static constexpr bool has_estimate = true;
};

}  // namespace fringe::detail
