/* SPDX-License-Identifier: MIT
 * Lanes: compiler vector types for arithmetic (+ - * / are the language's), and the few verbs the
 * language has no word for. vfloat and vdouble fill the widest register there is: 512, 256 or 128 bits.
 * Sums over lanes follow one fixed tree and fma is explicit, so that a lane count gives the same bits
 * whatever the compiler and the instruction set (build with -ffp-contract=off); -DSPHFSI_LANES=8 asks an
 * AVX-512 machine for the 8 float lanes, and the bits, of an AVX2 one. Sweeps that give each lane a
 * particle of its own do not depend on the width at all. */
#ifndef SPHFSI_SIMD_H
#define SPHFSI_SIMD_H

#include "base.h"

#if defined __AVX2__ && defined __FMA__
#include <immintrin.h>
#define SIMD_AVX2 1
#if defined __AVX512F__ && defined __AVX512DQ__ && !(defined SPHFSI_LANES && SPHFSI_LANES == 8)
#define SIMD_AVX512 1
#define SIMD_BYTES 64
#else
#define SIMD_BYTES 32
#endif
#elif defined __aarch64__
#include <arm_neon.h>
#define SIMD_NEON 1
#define SIMD_BYTES 16
#else
#define SIMD_BYTES 16
#endif

typedef float vfloat __attribute__((vector_size(SIMD_BYTES)));
typedef double vdouble __attribute__((vector_size(SIMD_BYTES)));

enum {
    LANES_FLOAT = SIMD_BYTES / 4,
    LANES_DOUBLE = SIMD_BYTES / 8,
};

/* The same vectors at any address, and free to alias the arrays they are loaded from. */
typedef float vfloat_at __attribute__((vector_size(SIMD_BYTES), aligned(4), may_alias));
typedef double vdouble_at __attribute__((vector_size(SIMD_BYTES), aligned(8), may_alias));

SPHFSI_INLINE vfloat vload_float(const float *p) { return (vfloat) * (const vfloat_at *)p; }
SPHFSI_INLINE vdouble vload_double(const double *p) { return (vdouble) * (const vdouble_at *)p; }
SPHFSI_INLINE void vstore_float(float *p, vfloat a) { *(vfloat_at *)p = (vfloat_at)a; }
SPHFSI_INLINE void vstore_double(double *p, vdouble a) { *(vdouble_at *)p = (vdouble_at)a; }
SPHFSI_INLINE vfloat vset_float(float a) { return (vfloat){0} + a; }
SPHFSI_INLINE vdouble vset_double(double a) { return (vdouble){0} + a; }

/* vfma(a, b, c) = a b + c with one rounding; vmin(a, b) = a < b ? a : b; vmax(a, b) = a > b ? a : b. */
#ifdef SIMD_AVX2
#ifdef SIMD_AVX512
#define X86(op) _mm512_##op
#define X86_FLOAT __m512
#define X86_DOUBLE __m512d
#else
#define X86(op) _mm256_##op
#define X86_FLOAT __m256
#define X86_DOUBLE __m256d
#endif
SPHFSI_INLINE vfloat vfma_float(vfloat a, vfloat b, vfloat c)
{
    return (vfloat)X86(fmadd_ps)((X86_FLOAT)a, (X86_FLOAT)b, (X86_FLOAT)c);
}
SPHFSI_INLINE vdouble vfma_double(vdouble a, vdouble b, vdouble c)
{
    return (vdouble)X86(fmadd_pd)((X86_DOUBLE)a, (X86_DOUBLE)b, (X86_DOUBLE)c);
}
SPHFSI_INLINE vfloat vmin_float(vfloat a, vfloat b)
{
    return (vfloat)X86(min_ps)((X86_FLOAT)a, (X86_FLOAT)b);
}
SPHFSI_INLINE vfloat vmax_float(vfloat a, vfloat b)
{
    return (vfloat)X86(max_ps)((X86_FLOAT)a, (X86_FLOAT)b);
}
SPHFSI_INLINE vdouble vmin_double(vdouble a, vdouble b)
{
    return (vdouble)X86(min_pd)((X86_DOUBLE)a, (X86_DOUBLE)b);
}
SPHFSI_INLINE vdouble vmax_double(vdouble a, vdouble b)
{
    return (vdouble)X86(max_pd)((X86_DOUBLE)a, (X86_DOUBLE)b);
}
SPHFSI_INLINE vfloat vabs_float(vfloat a)
{
    return (vfloat)X86(andnot_ps)(X86(set1_ps)(-0.0f), (X86_FLOAT)a);
}
SPHFSI_INLINE vdouble vabs_double(vdouble a)
{
    return (vdouble)X86(andnot_pd)(X86(set1_pd)(-0.0), (X86_DOUBLE)a);
}
SPHFSI_INLINE vfloat vsqrt_float(vfloat a) { return (vfloat)X86(sqrt_ps)((X86_FLOAT)a); }
SPHFSI_INLINE vdouble vsqrt_double(vdouble a) { return (vdouble)X86(sqrt_pd)((X86_DOUBLE)a); }
#undef X86
#undef X86_FLOAT
#undef X86_DOUBLE
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
SPHFSI_INLINE vfloat vabs_float(vfloat a) { return (vfloat)vabsq_f32((float32x4_t)a); }
SPHFSI_INLINE vdouble vabs_double(vdouble a) { return (vdouble)vabsq_f64((float64x2_t)a); }
SPHFSI_INLINE vfloat vsqrt_float(vfloat a) { return (vfloat)vsqrtq_f32((float32x4_t)a); }
SPHFSI_INLINE vdouble vsqrt_double(vdouble a) { return (vdouble)vsqrtq_f64((float64x2_t)a); }
#else
#define SIMD_LANEWISE(type, name, lanes, value)          \
    type result = {0};                                   \
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
SPHFSI_INLINE vfloat vabs_float(vfloat a)
{
    SIMD_LANEWISE(vfloat, abs, LANES_FLOAT, __builtin_fabsf(a[l]));
}
SPHFSI_INLINE vdouble vabs_double(vdouble a)
{
    SIMD_LANEWISE(vdouble, abs, LANES_DOUBLE, __builtin_fabs(a[l]));
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

/* Sum of the lanes by halving: lane k meets lane k + n/2, until one is left. Maximum likewise. */
SPHFSI_INLINE float vsum_float(vfloat a)
{
#ifdef SIMD_AVX2
#ifdef SIMD_AVX512
    const __m256 eight =
        _mm256_add_ps(_mm512_castps512_ps256((__m512)a), _mm512_extractf32x8_ps((__m512)a, 1));
#else
    const __m256 eight = (__m256)a;
#endif
    const __m128 four = _mm_add_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps(eight, 1));
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
#ifdef SIMD_AVX512
    const __m256d four =
        _mm256_add_pd(_mm512_castpd512_pd256((__m512d)a), _mm512_extractf64x4_pd((__m512d)a, 1));
#else
    const __m256d four = (__m256d)a;
#endif
    const __m128d two = _mm_add_pd(_mm256_castpd256_pd128(four), _mm256_extractf128_pd(four, 1));
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
