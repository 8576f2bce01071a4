/* SPDX-License-Identifier: MIT
 * The solid's sweeps with pair arithmetic in float. */
#include "base/real_float.h"
#include "solid/sweep.h"
