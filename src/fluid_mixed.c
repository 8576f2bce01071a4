/* SPDX-License-Identifier: MIT
 * The fluid's sweeps with pair arithmetic in float. */
#include "real_float.h"

#include "fluid_sweep.h"
