/* SPDX-License-Identifier: MIT
 * The solid's sweeps with pair arithmetic in double. */
#include "real_double.h"

#include "solid_sweep.h"
