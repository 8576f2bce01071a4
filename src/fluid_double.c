/* SPDX-License-Identifier: MIT
 * The fluid's sweeps with pair arithmetic in double. */
#include "real_double.h"

#include "fluid_sweep.h"
