#pragma once

#include <cstdint>

#include <sleef.h>
#include <xsimd/xsimd.hpp>

namespace fringe::detail {

/// Four doubles: AVX2 with fused multiplication and addition.
struct LanesAvx2 {
  using Vector = xsimd::batch<double, xsimd::fma3<xsimd::avx2>>;
  using Mask = Vector::batch_bool_type;
  static constexpr int width = 4;
  static constexpr bool fused = true;

  /// Computes a·b + c of four doubles with one rounding.
  static __m256d fused_four(const __m256d& a, const __m256d& b, const __m256d& c) {
    return _mm256_fmadd_pd(a, b, c);
  }

  static unsigned bits(const Mask& mask) { return static_cast<unsigned>(_mm256_movemask_pd(mask)); }
  /// Loads the coordinates of points that follow one another in memory.
  static void deinterleave(const double* points, Vector& x, Vector& y, Vector& z) {
    const __m256d first = _mm256_loadu_pd(points), second = _mm256_loadu_pd(points + 4),
                  third = _mm256_loadu_pd(points + 8);
    x = _mm256_permute4x64_pd(_mm256_blend_pd(_mm256_blend_pd(first, second, 0b0100), third, 0b0010), 0x6C);
    y = _mm256_permute4x64_pd(_mm256_blend_pd(_mm256_blend_pd(second, first, 0b0010), third, 0b0100), 0xB1);
    z = _mm256_permute4x64_pd(_mm256_blend_pd(_mm256_blend_pd(third, second, 0b0010), first, 0b0100), 0xC6);
  }
  /// Loads numbers of single precision.
  static Vector load_singles(const float* from) { return _mm256_cvtps_pd(_mm_loadu_ps(from)); }
  static Vector log(const Vector& x) { return Sleef_logd4_u10avx2(x); }
  static Vector atan2(const Vector& y, const Vector& x) { return Sleef_atan2d4_u10avx2(y, x); }
  /// Replaces the last five bits of each lane by `first` (at most 31) plus the lane's number.
  static Vector tagged(const Vector& x, std::uint32_t first) {
    const __m256i tags = _mm256_add_epi64(_mm256_set1_epi64x(first), _mm256_setr_epi64x(0, 1, 2, 3));
    return _mm256_castsi256_pd(
        _mm256_or_si256(_mm256_and_si256(_mm256_castpd_si256(x), _mm256_set1_epi64x(~31)), tags));
  }
  static std::uint32_t tag(double x) { return __builtin_bit_cast(std::uint64_t, x) & 31U; }
  static double largest(const Vector& x) {
    const __m128d pairs = _mm_max_pd(_mm256_castpd256_pd128(x), _mm256_extractf128_pd(x, 1));
    return _mm_cvtsd_f64(_mm_max_sd(pairs, _mm_unpackhi_pd(pairs, pairs)));
  }
  static constexpr bool has_estimate = false;
};

/// Eight floats.
struct FloatLanesAvx2 {
  using Vector = xsimd::batch<float, xsimd::fma3<xsimd::avx2>>;
  static constexpr int width = 8;

  /// Computes 1/√x to 3e-7: improves the processor's estimate, good to 2^−11, by one step of Newton's method.
  static Vector inverse_square_root(const Vector& x) {
    const Vector y = _mm256_rsqrt_ps(x);
    return y * fnma(x * y * y, Vector(0.5F), Vector(1.5F));
  }
  static float sum(const Vector& x) {
    const __m128 four = _mm_add_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps(x, 1));
    const __m128 halves = _mm_add_ps(four, _mm_movehl_ps(four, four));
    return _mm_cvtss_f32(_mm_add_ss(halves, _mm_shuffle_ps(halves, halves, 1)));
  }
  static float smallest(const Vector& x) {
    const __m128 four = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps(x, 1));
    const __m128 halves = _mm_min_ps(four, _mm_movehl_ps(four, four));
    return _mm_cvtss_f32(_mm_min_ss(halves, _mm_shuffle_ps(halves, halves, 1)));
  }
};

}  // namespace fringe::detail
