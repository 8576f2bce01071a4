/* SPDX-License-Identifier: MIT
 * 2x2 tensors over an arithmetic type T, inlined by hand. The macro defines the struct and its
 * routines for double and for vectors of `real`, which is double unless the file includes
 * base/real_float.h. */
#pragma once

#ifndef real
#include "base/real_double.h"
#endif

#define TENSOR2(T, name)                                                            \
    struct name {                                                                   \
        T xx, xy, yx, yy;                                                           \
    };                                                                              \
    /* a b */                                                                       \
    SPHFSI_INLINE struct name name##_mul(struct name a, struct name b)              \
    {                                                                               \
        return (struct name){a.xx * b.xx + a.xy * b.yx, a.xx * b.xy + a.xy * b.yy,  \
                             a.yx * b.xx + a.yy * b.yx, a.yx * b.xy + a.yy * b.yy}; \
    }                                                                               \
    /* a b^T */                                                                     \
    SPHFSI_INLINE struct name name##_mul_t(struct name a, struct name b)            \
    {                                                                               \
        return (struct name){a.xx * b.xx + a.xy * b.xy, a.xx * b.yx + a.xy * b.yy,  \
                             a.yx * b.xx + a.yy * b.xy, a.yx * b.yx + a.yy * b.yy}; \
    }                                                                               \
    SPHFSI_INLINE T name##_det(struct name a) { return a.xx * a.yy - a.xy * a.yx; } \
    /* cofactor: det(a) a^-T, no division */                                        \
    SPHFSI_INLINE struct name name##_cof(struct name a)                             \
    {                                                                               \
        return (struct name){a.yy, -a.yx, -a.xy, a.xx};                             \
    }

TENSOR2(double, tensor2)
TENSOR2(vreal, vtensor2)
