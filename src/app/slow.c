/* SPDX-License-Identifier: MIT */
#include "app/slow.h"
#include "coupling/bounds.h"

#include "case/params.h"
#include "time/timestep.h"

#include <math.h>
#include <stdio.h>

enum { PLACE_TEXT = LOCATION_TEXT + 16 };

static void place_of(const struct scene *s, enum section_id section, int index, const char *key,
                     char place[PLACE_TEXT])
{
    char at[LOCATION_TEXT];
    scene_location(s, scene_line(s, section, index, key), at);
    snprintf(place, PLACE_TEXT, "%s: ", at);
}

static void warn_of_interval(const struct simulation *s, enum section_id section, int index,
                             const char *key, double interval, double step, struct diag *d)
{
    char place[PLACE_TEXT];
    if (!(interval > 0 && interval < 0.5 * step)) return;
    const bool given = scene_given(s->scene, section, index, key) != NULL;
    place_of(s->scene, section, index, key, place);
    diag_warn(d,
              "%s%s%s = %g s is shorter than the time step of %.3g s. Every output ends a step, so "
              "the run needs about %.3g times as many steps; use a longer interval",
              place, given ? "" : "the default of output.", key, interval, step, step / interval);
}

static void warn_of_damping(const struct simulation *s, struct diag *d)
{
    char place[PLACE_TEXT];
    const double free = solid_step_of(square(s->solid.omega_max), 0);
    if (s->kind[KIND_SOLID].n == 0 || !(s->solid.stable_step < 0.5 * free)) return;
    for (int k = 0; k < s->scene->n_solid; k++) {
        const struct scene_solid *const body = &s->scene->solid[k];
        if (!(body->damping_time > 0)) continue;
        place_of(s->scene, SECTION_solid, k, "damping_time", place);
        diag_warn(d,
                  "%s[solid %s] damping_time = %g s makes the steps of the solid %.3g times "
                  "shorter; a shorter damping_time allows longer steps",
                  place, body->common.name, body->damping_time, free / s->solid.stable_step);
    }
}

static void warn_of_bound(const struct simulation *s, struct diag *d)
{
    static const struct {
        enum bound bound;
        enum section_id section;
        const char *key, *change;
    } owner[] = {{BOUND_diffusion, SECTION_fluid, "density_diffusion", "smaller"},
                 {BOUND_artificial, SECTION_fluid, "artificial_viscosity", "smaller"},
                 {BOUND_repulsion, SECTION_fluid, "wall_repulsion", "smaller"},
                 {BOUND_viscous, SECTION_fluid, "laminar_viscosity", "smaller"},
                 {BOUND_fixed, SECTION_numerics, "fixed_step", "larger"}};
    char place[PLACE_TEXT];
    const double acoustic = s->scene->numerics.cfl * s->fluid.k.h / s->fluid.k.c0;
    for (size_t k = 0; k < COUNT_OF(owner); k++) {
        const double bound = s->dt_bound[owner[k].bound];
        if (!(bound > 0 && bound < 0.1 * acoustic)) continue;
        place_of(s->scene, owner[k].section, 0, owner[k].key, place);
        diag_warn(d,
                  "%s%s limits the time step to %.3g s, while sound waves would allow %.3g times "
                  "as much. The run takes that many times longer; a %s %s may help",
                  place, owner[k].key, bound, acoustic / bound, owner[k].change, owner[k].key);
    }
}

/* Bodies that limit the step of the fluid: one that is light, or one that steps together with the fluid. */
static void warn_of_bodies(const struct simulation *s, struct diag *d)
{
    char place[PLACE_TEXT];
    const double acoustic = s->scene->numerics.cfl * s->fluid.k.h / s->fluid.k.c0;
    const double added = s->dt_bound[BOUND_added_mass], solid = s->dt_bound[BOUND_solid];
    if (s->effects & FX_COUPLING && added < 0.1 * acoustic) {
        int lightest;
        coupling_added_mass_step(&s->coupling, &lightest);
        const struct scene_solid *const body = &s->scene->solid[lightest];
        place_of(s->scene, SECTION_solid, lightest, "density", place);
        diag_warn(d,
                  "%s[solid %s] is %.3g times as dense as the fluid. So light a body limits the "
                  "time step to %.3g s, while sound waves would allow %.3g times as much. The run "
                  "takes that many times longer; a denser body allows longer steps",
                  place, body->common.name, body->density / s->scene->rho0, added,
                  acoustic / added);
    }
    if (s->effects & FX_SOLID && !(s->effects & FX_MULTIRATE) && solid < 0.1 * acoustic &&
        s->scene->numerics.multirate == MULTIRATE_OFF) {
        place_of(s->scene, SECTION_numerics, 0, "multirate", place);
        diag_warn(d,
                  "%sthe solid limits the time step of the fluid to %.3g s, while sound waves "
                  "would allow "
                  "%.3g times as much. The run takes up to that many times longer; "
                  "numerics.multirate = auto gives the solid steps of its own",
                  place, solid, acoustic / solid);
    }
}

void slow_warn(const struct simulation *s, struct diag *d)
{
    const struct scene *const c = s->scene;
    const bool fluid = s->effects & FX_FLUID;
    const double step = fluid ? timestep_fluid_limit(s) : s->dt_solid;
    const struct scene_output *const out = &c->output;
    if (c->n_probe > 0)
        warn_of_interval(s, SECTION_output, 0, "probe_interval", out->probe_interval, step, d);
    warn_of_interval(s, SECTION_output, 0, "ledger_interval", out->ledger_interval, step, d);
    warn_of_interval(s, SECTION_output, 0, "snapshot_interval", out->snapshot_interval, step, d);
    for (int k = 0; k < c->n_probe; k++)
        warn_of_interval(s, SECTION_probe, k, "interval", c->probe[k].interval, step, d);
    warn_of_damping(s, d);
    if (fluid) warn_of_bound(s, d);
    if (fluid) warn_of_bodies(s, d);
}
