/* SPDX-License-Identifier: MIT
 * The solid's sweeps with pair arithmetic in double. */
#include "base/real_double.h"
#include "solid/sweep.h"
