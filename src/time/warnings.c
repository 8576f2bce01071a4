/* SPDX-License-Identifier: MIT */
#include "time/warnings.h"

#include <stdio.h>

#include "case/case.h"
#include "coupling/bounds.h"
#include "time/timestep.h"

/* The step length as given by the case. */
static void text_of_step(const struct simulation *s, char text[64])
{
    const struct scene_numerics *const n = &s->scene->numerics;
    if (n->fixed_step > 0)
        snprintf(text, 64, "numerics.fixed_step = %g s (C_CFL = %.3g)", n->fixed_step,
                 timestep_courant(s));
    else
        snprintf(text, 64, "numerics.cfl = %g", n->cfl);
}

/* Up to these, a falling column of water (tests/stability/column.cfg) was found stable; for
 * leapfrog the analysis of docs/theory.md gives the same. */
static void warn_of_cfl(const struct simulation *s, struct diag *d)
{
    const double limit = s->integrator->largest_cfl;
    char given[64];
    text_of_step(s, given);
    if (timestep_beyond(s, limit))
        diag_warn(d,
                  "%s is above %g, the stability limit of this integrator, so the fluid may become "
                  "unstable and a guard may stop the run; use a smaller value",
                  given, limit);
}

/* fixed_step is used unchanged, even if the run then becomes unstable. */
static void warn_of_fixed_step(const struct simulation *s, struct diag *d)
{
    const double fixed = s->scene->numerics.fixed_step;
    const bool shared = s->effects & FX_SOLID && !(s->effects & FX_MULTIRATE);
    if (shared && fixed > s->solid.stable_step)
        diag_warn(d,
                  "numerics.fixed_step = %g s exceeds the solid's stable step of %.4g s, so the "
                  "run will become unstable; use a smaller value, or 0 for automatic steps",
                  fixed, s->solid.stable_step);
}

static void warn_of_light_bodies(const struct simulation *s, struct diag *d)
{
    const double fixed = s->scene->numerics.fixed_step;
    if (!(s->effects & FX_COUPLING) || !(fixed > 0)) return;
    int lightest;
    const double bound = coupling_added_mass_step(&s->coupling, &lightest);
    if (fixed <= bound) return;
    const struct scene_solid *const b = &s->scene->solid[lightest];
    char place[LOCATION_TEXT];
    scene_location(s->scene, b->common.line, place);
    diag_warn(d,
              "%s: [solid %s], %.3g times as dense as the fluid, may gain energy with "
              "numerics.fixed_step = %g s; use at most %.3g s, or 0 for automatic steps",
              place, b->common.name, b->density / s->scene->rho0, fixed, bound);
}

/* T-34d. The first of the other intervals is named. */
static void warn_of_outputs(const struct simulation *s, struct diag *d)
{
    struct output_interval own, other;
    char place[LOCATION_TEXT];
    if (!s->uneven || !timestep_output(s->scene, s->uneven - 1, &own)) return;
    for (int k = 0; timestep_output(s->scene, k, &other) && !(other.interval > 0);) k++;
    scene_location(s->scene, scene_line(s->scene, own.section, own.index, own.key), place);
    diag_warn(
        d,
        "%s: outputs with %s = %g s fall between those with %s = %g s and make the steps uneven. "
        "So solids take steps half as long, and the energy account is less exact; intervals "
        "that are multiples of each other avoid that",
        place, own.key, own.interval, other.key, other.interval);
}

void simulation_warn_of_steps(const struct simulation *s, struct diag *d)
{
    warn_of_fixed_step(s, d);
    warn_of_cfl(s, d);
    warn_of_light_bodies(s, d);
    warn_of_outputs(s, d);
}
