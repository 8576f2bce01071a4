/* SPDX-License-Identifier: MIT
 * Names of the arithmetic in sweeps and pair laws that are compiled for mixed precision: pairs
 * in float. A file includes this header or base/real_double.h. */
#pragma once

#include "base/simd.h"

#define real float
#define vreal vfloat
#define vmask vint
#define four_real four_float_at
#define LANES LANES_FLOAT
#define GROUPS GROUPS_FLOAT
#define SWEEP(name) name##_mixed
#define SWEEP_LABEL "mixed"
#define vset vset_float
#define vload vload_float
#define vstore vstore_float
#define vfma vfma_float
#define vmin vmin_float
#define vmax vmax_float
#define vsqrt vsqrt_float
#define vabs vabs_float
#define vfour vfour_float
#define vspread vspread_float
#define vsum_four vsum_four_float
#define vtop vtop_float
#define four_widen four_widen_float
#define vput vput_float
#define vwiden vwiden_float
