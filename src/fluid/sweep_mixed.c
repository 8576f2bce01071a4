/* SPDX-License-Identifier: MIT
 * The fluid's sweeps with pair arithmetic in float. */
#include "base/real_float.h"
#include "fluid/sweep.h"
