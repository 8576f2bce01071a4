/* SPDX-License-Identifier: MIT
 * The last lines of a run. */
#include "app/actions.h"

#include "time/timestep.h"

/* What the user would otherwise have to look up: whether anything got lost. */
void closing_say(const struct sphfsi_options *o, const struct simulation *sim,
                 const struct record *r)
{
    const int64_t lost = sim->state.lost, left = sim->kind[KIND_FLUID].n;
    char text[1024];
    if (sim->state.particle_steps > r->start_particle_steps)
        session_say(o, "%.3g million particle steps a second", 1e-6 * report_rate(sim, r));
    if (sim->effects & FX_ENERGY_ACCOUNT)
        session_say(o, "energy gained: at most %.3g J/m, %.2g %% of the available energy",
                    sim->state.gain, 100 * sim->state.gain_share);
    if (sim->effects & FX_FLUID)
        session_say(o,
                    "fluid particles lost: %lld; largest number inside walls and solids at the "
                    "same time: %lld",
                    (long long)lost, (long long)sim->state.entered);
    if (lost > 0) {
        struct diag d = session_diag(o);
        diag_warn(&d,
                  "%lld of %lld fluid particles have left the domain: their mass and pressure are "
                  "missing; a [wall] that holds them or a larger [domain] keeps them",
                  (long long)lost, (long long)(lost + left));
    }
    for (int k = 0; r->references->scored && k < r->references->n; k++) {
        reference_line(&r->references->item[k], text, sizeof text);
        session_say(o, "%s", text);
    }
}

void closing_say_next(const struct sphfsi_options *o, const struct simulation *sim,
                      const char *checkpoint, bool guard)
{
    const struct scene *const scene = sim->scene;
    const bool fast = sim->effects & FX_FLUID && scene->given_speed > SPEED_WARNING * scene->c0;
    double half;
    const char *const key = timestep_shorter(sim, &half);
    if (!guard)
        session_result(o, "to go on: the same command with --restart%s",
                       o->fork ? " instead of --fork" : "");
    else if (fast || (sim->state.steps <= 1 && scene->numerics.fixed_step == 0))
        /* A checkpoint keeps its speed of sound and its state. */
        session_result(o, "change the case, then start again: the same command with another --out");
    else if (sim->guard.case_at_fault)
        session_result(o,
                       "change the case, then go on: the same command with --fork %s and another "
                       "--out",
                       checkpoint);
    else
        session_result(o,
                       "to go on: the same command with --fork %s --set numerics.%s=%.4g and "
                       "another --out",
                       checkpoint, key, half);
}
