/* SPDX-License-Identifier: MIT
 * SIMD: compiler vector types (+ - * / are C operators on them) and the few operations that C
 * lacks. vfloat and vdouble fill the widest register: 512, 256 or 128 bits. Sums over lanes
 * follow one fixed tree and fma is explicit, so the bits do not depend on compiler or
 * instruction set (-ffp-contract=off). -DSPHFSI_LANES=8 gives an AVX-512 machine the 8 float
 * lanes of AVX2. */
#pragma once

#include "base/base.h"

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
#elif defined __wasm_relaxed_simd__
#include <wasm_simd128.h>
#define SIMD_WASM 1
#define SIMD_BYTES 16
#else
#define SIMD_BYTES 16
#endif

typedef float vfloat __attribute__((vector_size(SIMD_BYTES)));
typedef double vdouble __attribute__((vector_size(SIMD_BYTES)));
typedef int32_t vint __attribute__((vector_size(SIMD_BYTES)));             /* lanes of vfloat */
typedef int64_t vlong __attribute__((vector_size(SIMD_BYTES), may_alias)); /* of vdouble */

/* Groups of four lanes. In a sweep each lane of a group is another neighbour j, and each group
 * another particle i. So sums over j do not depend on the width of a vector. A vector of two
 * doubles is half a group. */
enum {
    LANES_FLOAT = SIMD_BYTES / 4,
    LANES_DOUBLE = SIMD_BYTES / 8,
    GROUP = 4,
    GROUPS_FLOAT = LANES_FLOAT / GROUP,
    GROUPS_DOUBLE = LANES_DOUBLE < GROUP ? 1 : LANES_DOUBLE / GROUP,
};

/* Four doubles or floats (the particles of a group) and eight floats or words, on any register
 * width. Types that end in _at may be at any address and alias the arrays that they load from. */
typedef double four_double __attribute__((vector_size(32)));
typedef int64_t four_long __attribute__((vector_size(32))); /* its comparisons */
typedef float four_float __attribute__((vector_size(16)));
typedef double four_double_at __attribute__((vector_size(32), aligned(8), may_alias));
typedef float four_float_at __attribute__((vector_size(16), aligned(4), may_alias));
#define FOUR(field, i) ((four_double) * (const four_double_at *)&(field)[i])
typedef float eight_float_at __attribute__((vector_size(32), aligned(4), may_alias));
typedef uint32_t eight_word __attribute__((vector_size(32)));
typedef uint32_t eight_word_at __attribute__((vector_size(32), aligned(4), may_alias));

typedef float vfloat_at __attribute__((vector_size(SIMD_BYTES), aligned(4), may_alias));
typedef double vdouble_at __attribute__((vector_size(SIMD_BYTES), aligned(8), may_alias));

SPHFSI_INLINE vfloat vload_float(const float *p) { return (vfloat) * (const vfloat_at *)p; }
SPHFSI_INLINE vdouble vload_double(const double *p) { return (vdouble) * (const vdouble_at *)p; }
SPHFSI_INLINE void vstore_float(float *p, vfloat a) { *(vfloat_at *)p = (vfloat_at)a; }
SPHFSI_INLINE void vstore_double(double *p, vdouble a) { *(vdouble_at *)p = (vdouble_at)a; }
SPHFSI_INLINE vfloat vset_float(float a) { return (vfloat){0} + a; }
SPHFSI_INLINE vdouble vset_double(double a) { return (vdouble){0} + a; }

/* Keeps a loaded vector in a register, on machines with 32 of them. gcc would repeat the load at
 * each use, and unaligned loads limit the solid's loops. */
#if defined SIMD_AVX512
#define vhold(a) __asm__("" : "+v"(a))
#elif defined SIMD_NEON
#define vhold(a) __asm__("" : "+w"(a))
#else
#define vhold(a) ((void)0)
#endif

/* vput(p, a, n): stores the first n lanes. vwiden(p, a, n): the same, converted to double. */
SPHFSI_INLINE void vput_float(float *p, vfloat a, int n)
{
    if (n == LANES_FLOAT)
        vstore_float(p, a);
    else
        for (int l = 0; l < n; l++) p[l] = a[l];
}
SPHFSI_INLINE void vput_double(double *p, vdouble a, int n)
{
    if (n == LANES_DOUBLE)
        vstore_double(p, a);
    else
        for (int l = 0; l < n; l++) p[l] = a[l];
}
SPHFSI_INLINE void vwiden_double(double *p, vdouble a, int n) { vput_double(p, a, n); }
SPHFSI_INLINE void vwiden_float(double *p, vfloat a, int n)
{
    typedef float half_float __attribute__((vector_size(SIMD_BYTES / 2)));
    half_float half[2];
    memcpy(half, &a, sizeof a);
    for (int k = 0; k < 2 && n > 0; k++, p += LANES_DOUBLE, n -= LANES_DOUBLE)
        vput_double(p, __builtin_convertvector(half[k], vdouble),
                    n < LANES_DOUBLE ? n : LANES_DOUBLE);
}

/* vfma(a, b, c) = a b + c with one rounding.
 * vmin(a, b) = a < b ? a : b, vmax(a, b) = a > b ? a : b. */
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
SPHFSI_INLINE vfloat vsqrt_float(vfloat a) { return (vfloat)vsqrtq_f32((float32x4_t)a); }
SPHFSI_INLINE vdouble vsqrt_double(vdouble a) { return (vdouble)vsqrtq_f64((float64x2_t)a); }
#elif defined SIMD_WASM
/* relaxed_madd rounds once or twice, as the machine does: test that before (web/exports.c). */
SPHFSI_INLINE vfloat vfma_float(vfloat a, vfloat b, vfloat c)
{
    return (vfloat)wasm_f32x4_relaxed_madd((v128_t)a, (v128_t)b, (v128_t)c);
}
SPHFSI_INLINE vdouble vfma_double(vdouble a, vdouble b, vdouble c)
{
    return (vdouble)wasm_f64x2_relaxed_madd((v128_t)a, (v128_t)b, (v128_t)c);
}
SPHFSI_INLINE vfloat vsqrt_float(vfloat a) { return (vfloat)wasm_f32x4_sqrt((v128_t)a); }
SPHFSI_INLINE vdouble vsqrt_double(vdouble a) { return (vdouble)wasm_f64x2_sqrt((v128_t)a); }
#else
SPHFSI_INLINE vfloat vfma_float(vfloat a, vfloat b, vfloat c)
{
    for (int l = 0; l < LANES_FLOAT; l++) a[l] = __builtin_fmaf(a[l], b[l], c[l]);
    return a;
}
SPHFSI_INLINE vdouble vfma_double(vdouble a, vdouble b, vdouble c)
{
    for (int l = 0; l < LANES_DOUBLE; l++) a[l] = __builtin_fma(a[l], b[l], c[l]);
    return a;
}
SPHFSI_INLINE vfloat vsqrt_float(vfloat a)
{
    for (int l = 0; l < LANES_FLOAT; l++) a[l] = __builtin_sqrtf(a[l]);
    return a;
}
SPHFSI_INLINE vdouble vsqrt_double(vdouble a)
{
    for (int l = 0; l < LANES_DOUBLE; l++) a[l] = __builtin_sqrt(a[l]);
    return a;
}
#endif

#ifndef SIMD_AVX2 /* masks of lanes, which compilers know as a selection */
SPHFSI_INLINE vfloat vmin_float(vfloat a, vfloat b)
{
    const vint less = a < b;
    return (vfloat)(((vint)a & less) | ((vint)b & ~less));
}
SPHFSI_INLINE vfloat vmax_float(vfloat a, vfloat b)
{
    const vint more = a > b;
    return (vfloat)(((vint)a & more) | ((vint)b & ~more));
}
SPHFSI_INLINE vdouble vmin_double(vdouble a, vdouble b)
{
    const vlong less = a < b;
    return (vdouble)(((vlong)a & less) | ((vlong)b & ~less));
}
SPHFSI_INLINE vdouble vmax_double(vdouble a, vdouble b)
{
    const vlong more = a > b;
    return (vdouble)(((vlong)a & more) | ((vlong)b & ~more));
}
#endif
SPHFSI_INLINE vfloat vabs_float(vfloat a) { return (vfloat)((vint)a & INT32_MAX); }
SPHFSI_INLINE vdouble vabs_double(vdouble a) { return (vdouble)((vlong)a & INT64_MAX); }

SPHFSI_INLINE four_double four_sqrt(four_double a)
{
#ifdef SIMD_AVX2
    return (four_double)_mm256_sqrt_pd((__m256d)a);
#else
    for (int l = 0; l < GROUP; l++) a[l] = __builtin_sqrt(a[l]);
    return a;
#endif
}

/* a > b ? a : b in each lane. */
SPHFSI_INLINE four_double four_max(four_double a, four_double b)
{
#ifdef SIMD_AVX2
    return (four_double)_mm256_max_pd((__m256d)a, (__m256d)b);
#else
    const four_long more = a > b;
    return (four_double)(((four_long)a & more) | ((four_long)b & ~more));
#endif
}

/* Whether any lane of a mask is set. */
SPHFSI_INLINE bool four_any(four_long mask)
{
#ifdef SIMD_AVX2
    return !_mm256_testz_si256((__m256i)mask, (__m256i)mask);
#else
    return mask[0] | mask[1] | mask[2] | mask[3];
#endif
}

/* Four numbers of a sweep's precision as doubles. gcc 12 converts four floats by way of memory. */
SPHFSI_INLINE four_double four_widen_float(four_float a)
{
#ifdef SIMD_AVX2
    return (four_double)_mm256_cvtps_pd((__m128)a);
#else
    return __builtin_convertvector(a, four_double);
#endif
}
SPHFSI_INLINE four_double four_widen_double(four_double a) { return a; }

/* Sum of the lanes by halving: lane k + lane k + n/2, until one remains. vtop: the largest lane. */
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

/* vfour(p): p[0..3] (or as many as there are lanes) in every group. vspread(p): p[g] in all
 * lanes of group g. vsum_four(a, out): out[g] = sum of group g by halving. */
#ifdef SIMD_AVX512
SPHFSI_INLINE vfloat vfour_float(const float *p)
{
    return (vfloat)_mm512_broadcast_f32x4(_mm_loadu_ps(p));
}
SPHFSI_INLINE vdouble vfour_double(const double *p)
{
    return (vdouble)_mm512_broadcast_f64x4(_mm256_loadu_pd(p));
}
SPHFSI_INLINE vfloat vspread_float(const float *p)
{
    const __m512i group = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
    return (vfloat)_mm512_permutexvar_ps(group, _mm512_castps128_ps512(_mm_loadu_ps(p)));
}
SPHFSI_INLINE vdouble vspread_double(const double *p)
{
    return (vdouble)_mm512_insertf64x4(_mm512_set1_pd(p[0]), _mm256_set1_pd(p[1]), 1);
}
SPHFSI_INLINE void vsum_four_float(vfloat a, float out[GROUPS_FLOAT])
{
    const __m512 two = _mm512_add_ps((__m512)a, _mm512_permute_ps((__m512)a, 0x4e));
    const __m512 one = _mm512_add_ps(two, _mm512_permute_ps(two, 0xb1));
    const __m512i first = _mm512_setr_epi32(0, 4, 8, 12, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    _mm_storeu_ps(out, _mm512_castps512_ps128(_mm512_permutexvar_ps(first, one)));
}
SPHFSI_INLINE void vsum_four_double(vdouble a, double out[GROUPS_DOUBLE])
{
    const __m512d two = _mm512_add_pd((__m512d)a, _mm512_permutex_pd((__m512d)a, 0x4e));
    const __m512d one = _mm512_add_pd(two, _mm512_permute_pd(two, 0x55));
    out[0] = _mm512_cvtsd_f64(one);
    out[1] = _mm256_cvtsd_f64(_mm512_extractf64x4_pd(one, 1));
}
#else
SPHFSI_INLINE vfloat vfour_float(const float *p)
{
#ifdef SIMD_AVX2
    return (vfloat)_mm256_broadcast_ps((const __m128 *)(const void *)p);
#else
    return vload_float(p);
#endif
}
SPHFSI_INLINE vdouble vfour_double(const double *p) { return vload_double(p); }
SPHFSI_INLINE vfloat vspread_float(const float *p)
{
#ifdef SIMD_AVX2
    return (vfloat)_mm256_setr_m128(_mm_set1_ps(p[0]), _mm_set1_ps(p[1]));
#else
    return vset_float(*p);
#endif
}
SPHFSI_INLINE vdouble vspread_double(const double *p) { return vset_double(*p); }
SPHFSI_INLINE void vsum_four_float(vfloat a, float out[GROUPS_FLOAT])
{
    for (int g = 0; g < GROUPS_FLOAT; g++, out++)
        *out = (a[4 * g] + a[4 * g + 2]) + (a[4 * g + 1] + a[4 * g + 3]);
}
SPHFSI_INLINE void vsum_four_double(vdouble a, double out[GROUPS_DOUBLE])
{
    out[0] = LANES_DOUBLE < GROUP ? a[0] + a[1]
                                  : (a[0] + a[2 % LANES_DOUBLE]) + (a[1] + a[3 % LANES_DOUBLE]);
}
#endif

/* Stores to `out` the items whose lane of a is below the limit; always writes LANES_FLOAT. */
SPHFSI_INLINE int vkeep_below(uint32_t *out, const uint32_t *item, vfloat a, float limit)
{
#ifdef SIMD_AVX512
    const __mmask16 below = _mm512_cmp_ps_mask((__m512)a, _mm512_set1_ps(limit), _CMP_LT_OQ);
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi32(below, _mm512_loadu_si512(item)));
    return __builtin_popcount(below);
#elif defined SIMD_AVX2 && defined __BMI2__
    /* Indices of the selected lanes, one byte each. */
    const unsigned below =
        (unsigned)_mm256_movemask_ps(_mm256_cmp_ps((__m256)a, _mm256_set1_ps(limit), _CMP_LT_OQ));
    const uint64_t bytes = _pdep_u64(below, 0x0101010101010101) * 0xff;
    const uint64_t lanes = _pext_u64(0x0706050403020100, bytes);
    const __m256i from = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)lanes));
    const __m256i all = _mm256_loadu_si256((const __m256i *)(const void *)item);
    _mm256_storeu_si256((__m256i *)(void *)out, _mm256_permutevar8x32_epi32(all, from));
    return __builtin_popcount(below);
#else
    int n = 0;
    for (int l = 0; l < LANES_FLOAT; l++) { /* branch-free: the condition is unpredictable */
        out[n] = item[l];
        n += a[l] < limit;
    }
    return n;
#endif
}
