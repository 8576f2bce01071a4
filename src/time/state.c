/* SPDX-License-Identifier: MIT
 * Names of the bounds of the time step, and the times of the phases of a step. */
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

double phase_add(struct simulation *sim, enum phase phase, double since)
{
    if (!phase_runs(phase, sim->effects)) return since; /* what there is goes to the next one */
    const double now = wall_clock();
    sim->phase_seconds[phase] += now - since;
    if (phase == PHASE_solid && sim->effects & FX_CONTACT) {
        /* Its forces are computed during the solid's sub-steps. */
        sim->phase_seconds[PHASE_solid] -= sim->contact.seconds;
        sim->phase_seconds[PHASE_contact] += sim->contact.seconds;
        sim->contact.seconds = 0;
    }
    return now;
}
