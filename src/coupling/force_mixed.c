/* SPDX-License-Identifier: MIT
 * The fluid's force on structures with pair arithmetic in float. */
#include "base/real_float.h"
#include "coupling/force.h"
