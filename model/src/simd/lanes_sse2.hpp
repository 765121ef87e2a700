#pragma once

#include <cstdint>

#include <sleef.h>
#include <xsimd/xsimd.hpp>

namespace fringe::detail {

/// Two doubles: SSE2, which every x86-64 processor has.
struct LanesSse2 {
  using Vector = xsimd::batch<double, xsimd::sse2>;
  using Mask = Vector::batch_bool_type;
  static constexpr int width = 2;
  static constexpr bool fused = false;

  static unsigned bits(const Mask& mask) { return static_cast<unsigned>(_mm_movemask_pd(mask)); }
  /// Loads the coordinates of points that follow one another in memory.
  static void deinterleave(const double* points, Vector& x, Vector& y, Vector& z) {
    const __m128d first = _mm_loadu_pd(points), second = _mm_loadu_pd(points + 2),
                  third = _mm_loadu_pd(points + 4);
    x = _mm_shuffle_pd(first, second, 0b10);
    y = _mm_shuffle_pd(first, third, 0b01);
    z = _mm_shuffle_pd(second, third, 0b10);
  }
  /// Loads numbers of single precision.
  static Vector load_singles(const float* from) {
    return _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from))));
  }
  static Vector log(const Vector& x) { return Sleef_logd2_u10sse2(x); }
  static Vector atan2(const Vector& y, const Vector& x) { return Sleef_atan2d2_u10sse2(y, x); }
  /// Replaces the last five bits of each lane by `first` (at most 31) plus the lane's number.
  static Vector tagged(const Vector& x, std::uint32_t first) {
    const __m128i tags = _mm_set_epi64x(first + 1, first);
    return _mm_castsi128_pd(_mm_or_si128(_mm_and_si128(_mm_castpd_si128(x), _mm_set1_epi64x(~31)), tags));
  }
  static std::uint32_t tag(double x) { return __builtin_bit_cast(std::uint64_t, x) & 31U; }
  static double largest(const Vector& x) { return _mm_cvtsd_f64(_mm_max_sd(x, _mm_unpackhi_pd(x, x))); }
  static constexpr bool has_estimate = false;
};

/// Four floats.
struct FloatLanesSse2 {
  using Vector = xsimd::batch<float, xsimd::sse2>;
  static constexpr int width = 4;

  static Vector inverse_square_root(const Vector& x) { return Vector(1) / sqrt(x); }
  static float sum(const Vector& x) {
    const __m128 halves = _mm_add_ps(x, _mm_movehl_ps(x, x));
    return _mm_cvtss_f32(_mm_add_ss(halves, _mm_shuffle_ps(halves, halves, 1)));
  }
  static float smallest(const Vector& x) {
    const __m128 halves = _mm_min_ps(x, _mm_movehl_ps(x, x));
    return _mm_cvtss_f32(_mm_min_ss(halves, _mm_shuffle_ps(halves, halves, 1)));
  }
};

}  // namespace fringe::detail
