#pragma once

#include <cstdint>

#include <sleef.h>
#include <xsimd/xsimd.hpp>

/// xsimd 8.1 has no fused multiply-add for AVX-512 and would round twice. Argument-dependent lookup finds
/// these overloads beside xsimd's own and prefers them because they are not templates.
namespace xsimd {

using EightDoubles = batch<double, avx512bw>;
using SixteenFloats = batch<float, avx512bw>;

inline EightDoubles fma(const EightDoubles& a, const EightDoubles& b, const EightDoubles& c) {
  return _mm512_fmadd_pd(a, b, c);
}
inline EightDoubles fms(const EightDoubles& a, const EightDoubles& b, const EightDoubles& c) {
  return _mm512_fmsub_pd(a, b, c);
}
inline EightDoubles fnma(const EightDoubles& a, const EightDoubles& b, const EightDoubles& c) {
  return _mm512_fnmadd_pd(a, b, c);
}
inline SixteenFloats fma(const SixteenFloats& a, const SixteenFloats& b, const SixteenFloats& c) {
  return _mm512_fmadd_ps(a, b, c);
}
inline SixteenFloats fnma(const SixteenFloats& a, const SixteenFloats& b, const SixteenFloats& c) {
  return _mm512_fnmadd_ps(a, b, c);
}

}  // namespace xsimd

namespace fringe::detail {

/// Eight doubles: AVX-512 (F, CD, DQ, BW).
struct LanesAvx512 {
  using Vector = xsimd::batch<double, xsimd::avx512bw>;
  using Mask = Vector::batch_bool_type;
  static constexpr int width = 8;
  static constexpr bool fused = true;

  /// Computes a·b + c of four doubles with one rounding.
  static __m256d fused_four(const __m256d& a, const __m256d& b, const __m256d& c) {
    return _mm256_fmadd_pd(a, b, c);
  }

  static unsigned bits(const Mask& mask) { return mask.data; }
  /// Loads the coordinates of points that follow one another in memory.
  static void deinterleave(const double* points, Vector& x, Vector& y, Vector& z) {
    const __m512d first = _mm512_loadu_pd(points), second = _mm512_loadu_pd(points + 8),
                  third = _mm512_loadu_pd(points + 16);
    // Numbers from 8 on name lanes of the second argument.
    const auto chosen = [](const __m512d& a, const __m512d& b, const __m512i& lanes) {
      return _mm512_permutex2var_pd(a, lanes, b);
    };
    x = chosen(chosen(first, second, _mm512_setr_epi64(0, 3, 6, 9, 12, 15, 0, 0)), third,
               _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 10, 13));
    y = chosen(chosen(first, second, _mm512_setr_epi64(1, 4, 7, 10, 13, 0, 0, 0)), third,
               _mm512_setr_epi64(0, 1, 2, 3, 4, 8, 11, 14));
    z = chosen(chosen(first, second, _mm512_setr_epi64(2, 5, 8, 11, 14, 0, 0, 0)), third,
               _mm512_setr_epi64(0, 1, 2, 3, 4, 9, 12, 15));
  }
  /// Loads numbers of single precision.
  static Vector load_singles(const float* from) { return _mm512_cvtps_pd(_mm256_loadu_ps(from)); }
  static Vector log(const Vector& x) { return Sleef_logd8_u10avx512f(x); }
  static Vector atan2(const Vector& y, const Vector& x) { return Sleef_atan2d8_u10avx512f(y, x); }

  /// Replaces the last five bits of each lane by `first` (at most 31) plus the lane's number.
  static Vector tagged(const Vector& x, std::uint32_t first) {
    const __m512i tags =
        _mm512_add_epi64(_mm512_set1_epi64(first), _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7));
    return _mm512_castsi512_pd(
        _mm512_or_si512(_mm512_and_si512(_mm512_castpd_si512(x), _mm512_set1_epi64(~31)), tags));
  }
  static std::uint32_t tag(double x) { return __builtin_bit_cast(std::uint64_t, x) & 31U; }
  static double largest(const Vector& x) { return _mm512_reduce_max_pd(x); }

  /// Estimates 1/√x with a relative error of 2^−14.
  static Vector inverse_square_root_estimate(const Vector& x) { return _mm512_rsqrt14_pd(x); }
  static constexpr bool has_estimate = true;
};

/// Sixteen floats.
struct FloatLanesAvx512 {
  using Vector = xsimd::batch<float, xsimd::avx512bw>;
  static constexpr int width = 16;

  /// Computes 1/√x to rounding: improves the processor's estimate, good to 2^−14, by one step of Newton's
  /// method.
  static Vector inverse_square_root(const Vector& x) {
    const Vector y = _mm512_rsqrt14_ps(x);
    return y * fnma(x * y * y, Vector(0.5F), Vector(1.5F));
  }
  static float sum(const Vector& x) { return _mm512_reduce_add_ps(x); }
  static float smallest(const Vector& x) { return _mm512_reduce_min_ps(x); }
};

}  // namespace fringe::detail
