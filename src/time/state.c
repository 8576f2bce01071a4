/* SPDX-License-Identifier: MIT
 * Names of the bounds of the time step. */
#include "time/state.h"

const char *const bound_names[BOUND_COUNT] = {
#define BOUND(name, effect, source) #name,
#include "time/bounds.def"
#undef BOUND
};
const char *const bound_sources[BOUND_COUNT] = {
#define BOUND(name, effect, source) source,
#include "time/bounds.def"
#undef BOUND
};
