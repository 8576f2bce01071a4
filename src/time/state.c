/* SPDX-License-Identifier: MIT
 * The table of bounds, the time in messages, the observer, and the clocks of phases. */
#include "time/state.h"

const struct bound_info bound_table[BOUND_COUNT] = {
#define FX_NONE 0u
#define BOUND(name, effect, source) {#name, source, FX_##effect},
#include "time/bounds.def"
#undef BOUND
#undef FX_NONE
};

double scene_time(const struct simulation *sim, double time)
{
    return sim->state.seeks_rest ? -(double)INFINITY : time;
}

double simulation_time(const struct simulation *sim)
{
    return max2(0, scene_time(sim, sim->state.time));
}

struct time_text time_text(const struct simulation *sim)
{
    struct time_text time;
    snprintf(time.text, sizeof time.text, "%s%.6g s",
             sim->state.seeks_rest ? "while rest is sought, after " : "t = ", sim->state.time);
    return time;
}

enum err observe(struct simulation *sim, double until, struct diag *d)
{
    struct observer *const observer = &sim->observer;
    if (!observer->context || sim->state.seeks_rest || until < observer->next) return ERR_OK;
    const double begin = phase_clock(), before = phases_so_far(sim);
    const enum err e = observer->look(observer->context, sim, until, d);
    /* Evaluations, which the coming step uses, are counted in their own phases. */
    sim->phase_seconds[PHASE_output] += phase_clock() - begin - (phases_so_far(sim) - before);
    return e;
}

double phases_so_far(const struct simulation *sim)
{
    double sum = 0;
    for (int k = 0; k < PHASE_COUNT; k++) sum += sim->phase_seconds[k];
    return sum;
}

double phase_add(struct simulation *sim, enum phase phase, double since)
{
    if (!phase_runs(phase, sim->effects)) return since; /* its time counts for the next phase */
    const double now = phase_end(&sim->phase_seconds[phase], since);
    if (phase == PHASE_solid && sim->effects & FX_CONTACT) {
        /* Its forces are computed during the solid's sub-steps. */
        sim->phase_seconds[PHASE_solid] -= sim->contact.seconds;
        sim->phase_seconds[PHASE_contact] += sim->contact.seconds;
        sim->contact.seconds = 0;
    }
    return now;
}
