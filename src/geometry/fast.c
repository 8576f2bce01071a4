/* SPDX-License-Identifier: MIT
 * Speeds at the start that the materials cannot follow: of fluid near its speed of sound, of bodies
 * beyond that of their material. Mostly units are wrong. */
#include "geometry/sampling.h"
#include "base/elementary.h"

#include "case/case.h"

#include <math.h>

/* The largest of the initial velocities at the particles of a section, m/s. */
static double start_speed(const struct scene *s, enum kind kind, int body,
                          const struct scene_expr *velocity)
{
    const struct scene_points *const p = &s->points[kind];
    double most = 0;
    for (int64_t k = 0; k < p->n && velocity->e[0]; k++) {
        if (p->body[k] != body) continue;
        double v[2];
        for (int c = 0; c < 2; c++)
            v[c] = velocity->e[c] ? scene_expr_at(velocity->e[c], p->x[k], p->y[k]) : 0;
        most = max2(most, elementary_hypot(v[0], v[1]));
    }
    return most;
}

static void warn_of_fast_fluid(struct sampler *g)
{
    struct scene *const s = g->scene;
    for (int k = 0; k < s->n_fluid; k++) {
        const double speed = start_speed(s, KIND_FLUID, k, &s->fluid[k].velocity);
        s->given_speed = max2(s->given_speed, speed);
        if (!(speed > SPEED_WARNING * s->c0)) continue;
        char place[LOCATION_TEXT];
        scene_location(s, scene_line(s, SECTION_fluid, k, "velocity"), place);
        diag_warn(g->diag,
                  "%s: [fluid %s] begins with up to %.4g m/s, above %g of the speed of sound, %.4g "
                  "m/s, so it is not weakly compressible and may become unstable; use sound_speed "
                  "= %.3g or more",
                  place, s->fluid[k].common.name, speed, SPEED_WARNING, s->c0, 10 * speed);
    }
}

/* Where such a body meets another, no wave carries the load away: it is crushed at the point of contact. */
static void warn_of_fast_bodies(struct sampler *g)
{
    const struct scene *const s = g->scene;
    for (int k = 0; k < s->n_solid; k++) {
        const struct scene_solid *const b = &s->solid[k];
        const double speed = start_speed(s, KIND_SOLID, k, &b->velocity);
        const double sound = sqrt(b->young / b->density);
        if (!(speed > sound)) continue;
        char place[LOCATION_TEXT];
        scene_location(s, scene_line(s, SECTION_solid, k, "velocity"), place);
        diag_warn(g->diag,
                  "%s: [solid %s] begins with up to %.4g m/s, faster than waves in it, "
                  "sqrt(young/density) = %.3g m/s: an impact crushes it and a guard stops the run; "
                  "check the units of `velocity`, `young` and `density`",
                  place, b->common.name, speed, sound);
    }
}

void geometry_warn_of_speeds(struct sampler *g)
{
    warn_of_fast_fluid(g);
    warn_of_fast_bodies(g);
}
