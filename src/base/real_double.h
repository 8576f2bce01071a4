/* SPDX-License-Identifier: MIT
 * Names of the arithmetic in sweeps and pair laws that are compiled for double precision. A file
 * includes this header or base/real_float.h. */
#pragma once

#include "base/simd.h"

#define real double
#define vreal vdouble
#define vmask vlong
#define four_real four_double_at
#define LANES LANES_DOUBLE
#define GROUPS GROUPS_DOUBLE
#define SWEEP(name) name##_double
#define SWEEP_LABEL "double"
#define vset vset_double
#define vload vload_double
#define vstore vstore_double
#define vfma vfma_double
#define vmin vmin_double
#define vmax vmax_double
#define vsqrt vsqrt_double
#define vabs vabs_double
#define vfour vfour_double
#define vspread vspread_double
#define vsum_four vsum_four_double
#define vtop vtop_double
#define four_widen four_widen_double
#define vput vput_double
#define vwiden vwiden_double
