/* SPDX-License-Identifier: MIT
 * Headers of the C library that nearly every file uses, compiler attributes, ASSERT, and a few
 * functions of scalars that the library lacks. */
#pragma once

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define SPHFSI_INLINE static inline __attribute__((always_inline))
#define SPHFSI_PRINTF(fmt_index, args_index) __attribute__((format(printf, fmt_index, args_index)))
#define SPHFSI_CHECKED __attribute__((warn_unused_result))
#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

/* An invariant that no input can break. Checked in debug, sanitizer and thread builds; the
 * release build (NDEBUG) does not evaluate it. */
#ifdef NDEBUG
#define ASSERT(condition) ((void)sizeof(condition))
#else
#define ASSERT(condition) assert(condition)
#endif

#define PI 3.14159265358979323846

SPHFSI_INLINE double min2(double a, double b) { return a < b ? a : b; }
SPHFSI_INLINE double max2(double a, double b) { return a > b ? a : b; }
SPHFSI_INLINE double square(double a) { return a * a; }
