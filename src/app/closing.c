/* SPDX-License-Identifier: MIT */
#include "app/actions.h"

#include "time/timestep.h"

#include <stdio.h>

static void say_run_cost(const struct sphfsi_options *o, const struct simulation *sim,
                         const struct record *r)
{
    char text[1024] = "";
    size_t at = 0;
    double all = 0;
    for (int k = 0; k < PHASE_COUNT; k++) all += sim->phase_seconds[k];
    for (int k = 0; k < PHASE_COUNT && all > 0; k++)
        if (sim->phase_seconds[k] >= 0.005 * all)
            at += (size_t)snprintf(text + at, sizeof text - at, "%s%s %.0f %%", at ? ", " : "",
                                   phase_table[k].name, 100 * sim->phase_seconds[k] / all);
    if (sim->state.particle_steps > r->start_particle_steps)
        session_say(o, "%.3g million particle steps a second: %s", 1e-6 * report_rate(sim, r),
                    text);
}

/* What the user would otherwise have to look up: whether anything got lost. */
static void say_losses(const struct sphfsi_options *o, const struct simulation *sim)
{
    const int64_t lost = sim->state.lost, left = sim->kind[KIND_FLUID].n;
    const bool bodies = sim->effects & (FX_WALL | FX_COUPLING);
    if (sim->effects & FX_ENERGY_ACCOUNT)
        session_say(o, "energy gained: at most %.3g J/m, %.2g %% of the available energy",
                    sim->state.gain, 100 * sim->state.gain_share);
    if (!(sim->effects & FX_FLUID)) return;
    if (bodies)
        session_say(o,
                    "fluid particles lost: %lld; largest number inside walls and solids at the "
                    "same time: %lld",
                    (long long)lost, (long long)sim->state.entered);
    else
        session_say(o, "fluid particles lost: %lld", (long long)lost);
    if (lost == 0) return;
    struct diag d = session_diag(o);
    diag_warn(&d,
              "%lld of %lld fluid particles have left the domain: their mass and pressure are "
              "missing; a [wall] that holds them or a larger [domain] keeps them",
              (long long)lost, (long long)(lost + left));
}

void closing_say(const struct sphfsi_options *o, const struct simulation *sim,
                 const struct record *r)
{
    char text[1024];
    say_run_cost(o, sim, r);
    say_losses(o, sim);
    for (int k = 0; r->score && k < r->references->n; k++) {
        reference_line(&r->references->item[k], &r->score[k], text, sizeof text);
        session_say(o, "%s", text);
    }
}

/* --- how a stopped run goes on --- */

/* How a run goes on that a guard has stopped. */
enum remedy {
    SHORTER_STEPS,
    OTHER_CASE, /* from the checkpoint, once the case is changed as the message says */
    OTHER_START /* the same from the start: a checkpoint keeps its speed of sound and its state */
};

static enum remedy remedy_for(const struct simulation *sim)
{
    const struct scene *const scene = sim->scene;
    const bool fast = sim->effects & FX_FLUID && scene->given_speed > SPEED_WARNING * scene->c0;
    if (fast || (sim->state.steps <= 1 && scene->numerics.fixed_step == 0)) return OTHER_START;
    return sim->guard.case_at_fault ? OTHER_CASE : SHORTER_STEPS;
}

void closing_say_next(const struct sphfsi_options *o, const struct simulation *sim,
                      const char *checkpoint, bool guard)
{
    if (!guard) {
        session_result(o, "to go on: the same command with --restart%s",
                       o->fork ? " instead of --fork" : "");
        return;
    }
    double half;
    const char *const key = timestep_shorter(sim, &half);
    switch (remedy_for(sim)) {
    case SHORTER_STEPS:
        session_result(o,
                       "to go on: the same command with --fork %s --set numerics.%s=%.4g and "
                       "another --out",
                       checkpoint, key, half);
        break;
    case OTHER_CASE:
        session_result(o,
                       "change the case, then go on: the same command with --fork %s and another "
                       "--out",
                       checkpoint);
        break;
    case OTHER_START:
        session_result(o, "change the case, then start again: the same command with another --out");
        break;
    }
}
