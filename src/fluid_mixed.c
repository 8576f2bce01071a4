/* SPDX-License-Identifier: MIT
 * The fluid's sweeps with pair arithmetic in float. */
#include "simd.h"

#define real float
#define vreal vfloat
#define LANES LANES_FLOAT
#define SWEEP(name) name##_mixed
#define SWEEP_LABEL "mixed"
#define vload vload_float
#define vstore vstore_float
#define vset vset_float
#define vfma vfma_float
#define vmin vmin_float
#define vmax vmax_float
#define vsqrt vsqrt_float
#define vabs vabs_float
#define vsum vsum_float
#define vtop vtop_float

#include "fluid_sweep.h"
