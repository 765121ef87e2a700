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

  /// a·b + c of four doubles, rounded once.
  static __m256d fused_four(const __m256d& a, const __m256d& b, const __m256d& c) {
    return _mm256_fmadd_pd(a, b, c);
  }

  static unsigned bits(const Mask& mask) { return static_cast<unsigned>(_mm256_movemask_pd(mask)); }
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

}  // namespace fringe::detail
