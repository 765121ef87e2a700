#pragma once

#include <sleef.h>
#include <xsimd/xsimd.hpp>

namespace fringe::detail {

/// Four doubles: AVX2 with fused multiplication and addition.
struct LanesAvx2 {
  using Vector = xsimd::batch<double, xsimd::fma3<xsimd::avx2>>;
  using Mask = Vector::batch_bool_type;
  static constexpr int width = 4;
  static constexpr bool fused = true;

  static unsigned bits(const Mask& mask) { return static_cast<unsigned>(_mm256_movemask_pd(mask)); }
  static Vector log(const Vector& x) { return Sleef_logd4_u10avx2(x); }
  static Vector atan2(const Vector& y, const Vector& x) { return Sleef_atan2d4_u10avx2(y, x); }
  static constexpr bool has_estimate = false;
};

}  // namespace fringe::detail
