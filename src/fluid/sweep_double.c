/* SPDX-License-Identifier: MIT
 * The fluid's sweeps with pair arithmetic in double. */
#include "base/real_double.h"
#include "fluid/sweep.h"
