/* SPDX-License-Identifier: MIT
 * The fluid's force on structures with pair arithmetic in double. */
#include "base/real_double.h"
#include "coupling/force.h"
