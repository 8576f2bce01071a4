/* SPDX-License-Identifier: MIT
 * Lanes: compiler vector types for arithmetic (+ - * / are the language's), and the few verbs the
 * language has no word for. Three lane types: vfloat and vdouble fill a 256-bit register (128-bit on
 * machines without AVX2), vwide holds doubles in the widest register there is.
 * Sums over lanes follow one fixed tree and fma is explicit, so that a lane count gives the same bits
 * whatever the compiler and the instruction set (build with -ffp-contract=off). Sweeps over vwide give
 * each lane a particle of its own, so their results do not depend on its width at all. */
#ifndef SPHFSI_SIMD_H
#define SPHFSI_SIMD_H

#include "base.h"

#if defined __AVX2__ && defined __FMA__
#include <immintrin.h>
#define SIMD_AVX2 1
#define SIMD_BYTES 32
#elif defined __aarch64__
#include <arm_neon.h>
#define SIMD_NEON 1
#define SIMD_BYTES 16
#else
#define SIMD_BYTES 16
#endif
#if defined SIMD_AVX2 && defined __AVX512F__
#define SIMD_AVX512 1
#define SIMD_WIDE_BYTES 64
#else
#define SIMD_WIDE_BYTES SIMD_BYTES
#endif

typedef float vfloat __attribute__((vector_size(SIMD_BYTES)));
typedef double vdouble __attribute__((vector_size(SIMD_BYTES)));
typedef double vwide __attribute__((vector_size(SIMD_WIDE_BYTES)));

enum {
    LANES_FLOAT = SIMD_BYTES / 4,
    LANES_DOUBLE = SIMD_BYTES / 8,
    LANES_WIDE = SIMD_WIDE_BYTES / 8,
};

/* The same vectors at any address, and free to alias the arrays they are loaded from. */
typedef float vfloat_at __attribute__((vector_size(SIMD_BYTES), aligned(4), may_alias));
typedef double vdouble_at __attribute__((vector_size(SIMD_BYTES), aligned(8), may_alias));
typedef double vwide_at __attribute__((vector_size(SIMD_WIDE_BYTES), aligned(8), may_alias));

SPHFSI_INLINE vfloat vload_float(const float *p) { return (vfloat) * (const vfloat_at *)p; }
SPHFSI_INLINE vdouble vload_double(const double *p) { return (vdouble) * (const vdouble_at *)p; }
SPHFSI_INLINE vwide vload_wide(const double *p) { return (vwide) * (const vwide_at *)p; }
SPHFSI_INLINE void vstore_float(float *p, vfloat a) { *(vfloat_at *)p = (vfloat_at)a; }
SPHFSI_INLINE void vstore_double(double *p, vdouble a) { *(vdouble_at *)p = (vdouble_at)a; }
SPHFSI_INLINE void vstore_wide(double *p, vwide a) { *(vwide_at *)p = (vwide_at)a; }
SPHFSI_INLINE vfloat vset_float(float a) { return (vfloat){0} + a; }
SPHFSI_INLINE vdouble vset_double(double a) { return (vdouble){0} + a; }
SPHFSI_INLINE vwide vset_wide(double a) { return (vwide){0} + a; }

/* vfma(a, b, c) = a b + c with one rounding; vmin(a, b) = a < b ? a : b; vmax(a, b) = a > b ? a : b. */
#ifdef SIMD_AVX2
SPHFSI_INLINE vfloat vfma_float(vfloat a, vfloat b, vfloat c)
{
    return (vfloat)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
}
SPHFSI_INLINE vdouble vfma_double(vdouble a, vdouble b, vdouble c)
{
    return (vdouble)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}
SPHFSI_INLINE vfloat vmin_float(vfloat a, vfloat b)
{
    return (vfloat)_mm256_min_ps((__m256)a, (__m256)b);
}
SPHFSI_INLINE vfloat vmax_float(vfloat a, vfloat b)
{
    return (vfloat)_mm256_max_ps((__m256)a, (__m256)b);
}
SPHFSI_INLINE vdouble vmin_double(vdouble a, vdouble b)
{
    return (vdouble)_mm256_min_pd((__m256d)a, (__m256d)b);
}
SPHFSI_INLINE vdouble vmax_double(vdouble a, vdouble b)
{
    return (vdouble)_mm256_max_pd((__m256d)a, (__m256d)b);
}
SPHFSI_INLINE vfloat vsqrt_float(vfloat a) { return (vfloat)_mm256_sqrt_ps((__m256)a); }
SPHFSI_INLINE vdouble vsqrt_double(vdouble a) { return (vdouble)_mm256_sqrt_pd((__m256d)a); }
#elif defined SIMD_NEON
SPHFSI_INLINE vfloat vfma_float(vfloat a, vfloat b, vfloat c)
{
    return (vfloat)vfmaq_f32((float32x4_t)c, (float32x4_t)a, (float32x4_t)b);
}
SPHFSI_INLINE vdouble vfma_double(vdouble a, vdouble b, vdouble c)
{
    return (vdouble)vfmaq_f64((float64x2_t)c, (float64x2_t)a, (float64x2_t)b);
}
SPHFSI_INLINE vfloat vmin_float(vfloat a, vfloat b)
{
    return (vfloat)vbslq_f32(vcltq_f32((float32x4_t)a, (float32x4_t)b), (float32x4_t)a,
                             (float32x4_t)b);
}
SPHFSI_INLINE vfloat vmax_float(vfloat a, vfloat b)
{
    return (vfloat)vbslq_f32(vcgtq_f32((float32x4_t)a, (float32x4_t)b), (float32x4_t)a,
                             (float32x4_t)b);
}
SPHFSI_INLINE vdouble vmin_double(vdouble a, vdouble b)
{
    return (vdouble)vbslq_f64(vcltq_f64((float64x2_t)a, (float64x2_t)b), (float64x2_t)a,
                              (float64x2_t)b);
}
SPHFSI_INLINE vdouble vmax_double(vdouble a, vdouble b)
{
    return (vdouble)vbslq_f64(vcgtq_f64((float64x2_t)a, (float64x2_t)b), (float64x2_t)a,
                              (float64x2_t)b);
}
SPHFSI_INLINE vfloat vsqrt_float(vfloat a) { return (vfloat)vsqrtq_f32((float32x4_t)a); }
SPHFSI_INLINE vdouble vsqrt_double(vdouble a) { return (vdouble)vsqrtq_f64((float64x2_t)a); }
#else
#define SIMD_LANEWISE(type, name, lanes, value)          \
    type result;                                         \
    for (int l = 0; l < (lanes); l++) result[l] = value; \
    return result
SPHFSI_INLINE vfloat vfma_float(vfloat a, vfloat b, vfloat c)
{
    SIMD_LANEWISE(vfloat, fma, LANES_FLOAT, __builtin_fmaf(a[l], b[l], c[l]));
}
SPHFSI_INLINE vdouble vfma_double(vdouble a, vdouble b, vdouble c)
{
    SIMD_LANEWISE(vdouble, fma, LANES_DOUBLE, __builtin_fma(a[l], b[l], c[l]));
}
SPHFSI_INLINE vfloat vmin_float(vfloat a, vfloat b)
{
    SIMD_LANEWISE(vfloat, min, LANES_FLOAT, a[l] < b[l] ? a[l] : b[l]);
}
SPHFSI_INLINE vfloat vmax_float(vfloat a, vfloat b)
{
    SIMD_LANEWISE(vfloat, max, LANES_FLOAT, a[l] > b[l] ? a[l] : b[l]);
}
SPHFSI_INLINE vdouble vmin_double(vdouble a, vdouble b)
{
    SIMD_LANEWISE(vdouble, min, LANES_DOUBLE, a[l] < b[l] ? a[l] : b[l]);
}
SPHFSI_INLINE vdouble vmax_double(vdouble a, vdouble b)
{
    SIMD_LANEWISE(vdouble, max, LANES_DOUBLE, a[l] > b[l] ? a[l] : b[l]);
}
SPHFSI_INLINE vfloat vsqrt_float(vfloat a)
{
    SIMD_LANEWISE(vfloat, sqrt, LANES_FLOAT, __builtin_sqrtf(a[l]));
}
SPHFSI_INLINE vdouble vsqrt_double(vdouble a)
{
    SIMD_LANEWISE(vdouble, sqrt, LANES_DOUBLE, __builtin_sqrt(a[l]));
}
#undef SIMD_LANEWISE
#endif

#ifdef SIMD_AVX512
SPHFSI_INLINE vwide vfma_wide(vwide a, vwide b, vwide c)
{
    return (vwide)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}
SPHFSI_INLINE vwide vmin_wide(vwide a, vwide b)
{
    return (vwide)_mm512_min_pd((__m512d)a, (__m512d)b);
}
SPHFSI_INLINE vwide vsqrt_wide(vwide a) { return (vwide)_mm512_sqrt_pd((__m512d)a); }
#else
SPHFSI_INLINE vwide vfma_wide(vwide a, vwide b, vwide c)
{
    return (vwide)vfma_double((vdouble)a, (vdouble)b, (vdouble)c);
}
SPHFSI_INLINE vwide vmin_wide(vwide a, vwide b)
{
    return (vwide)vmin_double((vdouble)a, (vdouble)b);
}
SPHFSI_INLINE vwide vsqrt_wide(vwide a) { return (vwide)vsqrt_double((vdouble)a); }
#endif

/* Sum of the lanes by halving: lane k meets lane k + n/2, until one is left. Maximum likewise. */
SPHFSI_INLINE float vsum_float(vfloat a)
{
#ifdef SIMD_AVX2
    const __m128 four =
        _mm_add_ps(_mm256_castps256_ps128((__m256)a), _mm256_extractf128_ps((__m256)a, 1));
    const __m128 two = _mm_add_ps(four, _mm_movehl_ps(four, four));
    return _mm_cvtss_f32(_mm_add_ss(two, _mm_movehdup_ps(two)));
#else
    for (int half = LANES_FLOAT / 2; half > 0; half /= 2)
        for (int l = 0; l < half; l++) a[l] += a[l + half];
    return a[0];
#endif
}
SPHFSI_INLINE double vsum_double(vdouble a)
{
#ifdef SIMD_AVX2
    const __m128d two =
        _mm_add_pd(_mm256_castpd256_pd128((__m256d)a), _mm256_extractf128_pd((__m256d)a, 1));
    return _mm_cvtsd_f64(_mm_add_sd(two, _mm_unpackhi_pd(two, two)));
#else
    for (int half = LANES_DOUBLE / 2; half > 0; half /= 2)
        for (int l = 0; l < half; l++) a[l] += a[l + half];
    return a[0];
#endif
}
SPHFSI_INLINE float vtop_float(vfloat a)
{
    float top = a[0];
    for (int l = 1; l < LANES_FLOAT; l++) top = a[l] > top ? a[l] : top;
    return top;
}
SPHFSI_INLINE double vtop_double(vdouble a)
{
    double top = a[0];
    for (int l = 1; l < LANES_DOUBLE; l++) top = a[l] > top ? a[l] : top;
    return top;
}

#endif
