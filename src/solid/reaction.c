/* SPDX-License-Identifier: MIT
 * Accelerations and the forces of clamps and hinges, for output. */
#include "solid/contact.h"
#include "solid/hinges.h"
#include "solid/loads.h"

/* All forces but those of clamps and hinges, as accelerations in sx, sy; all particles free. */
static void forces_without_clamps(struct solid *solid, struct particles *particles, double time)
{
    struct contact *const contact = solid->contact;
    const double power = contact ? contact->power : 0, seconds = contact ? contact->seconds : 0;
    const double at = solid->time;
    for (int64_t i = 0; i < particles->n; i++) particles->free[i] = 1;
    if (solid->loads) solid->loads->released = true;
    if (solid->hinges) solid->hinges->released = true;
    solid->time = time;
    solid_forces(solid, particles);
    solid->time = at;
    if (solid->loads) solid->loads->released = false;
    if (solid->hinges) solid->hinges->released = false;
    if (contact) contact->power = power, contact->seconds = seconds;
}

/* What a clamp gives particle i: its prescribed acceleration, and the force that this takes
 * besides the others (T-74). */
static void hold(const struct solid *solid, const struct particles *particles, int64_t i,
                 const double to[2])
{
    double *const *const now = solid->scratch;
    const double mass = solid->body[particles->body[i]].mass;
    now[2][i] = mass * (to[0] - now[0][i]);
    now[3][i] = mass * (to[1] - now[1][i]);
    now[0][i] = to[0];
    now[1][i] = to[1];
}

struct held_forces solid_held_forces(struct solid *solid, struct particles *particles, double time)
{
    static const double rest[2] = {0, 0};
    const size_t bytes = (size_t)particles->n * sizeof *particles->sx;
    double *const *const now = solid->scratch;
    memcpy(now[2], particles->free, bytes);
    memcpy(now[4], particles->sx, bytes);
    memcpy(now[5], particles->sy, bytes);
    forces_without_clamps(solid, particles, time);
    memcpy(now[0], particles->sx, bytes);
    memcpy(now[1], particles->sy, bytes);
    memcpy(particles->free, now[2], bytes);
    memcpy(particles->sx, now[4], bytes);
    memcpy(particles->sy, now[5], bytes);
    memset(now[2], 0, bytes);
    memset(now[3], 0, bytes);
    for (int64_t i = 0; i < particles->n; i++)
        if (particles->free[i] == 0) hold(solid, particles, i, rest);
    if (solid->loads) loads_move(solid->loads, time);
    for (int64_t k = 0; solid->loads && k < solid->loads->n_held; k++) {
        const int32_t i = solid->loads->held[k];
        hold(solid, particles, i, loads_motion(solid->loads, particles, i).a);
    }
    if (solid->hinges) hinges_hold(solid->hinges, now, &now[2], time);
    return (struct held_forces){now[0], now[1], now[2], now[3]};
}
