/* SPDX-License-Identifier: MIT
 * The solid's sweeps with pair arithmetic in float. */
#include "real_float.h"

#include "solid_sweep.h"
