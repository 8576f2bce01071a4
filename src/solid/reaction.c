/* SPDX-License-Identifier: MIT
 * Accelerations and the forces of clamps, for output. */
#include <string.h>

#include "solid/contact.h"
#include "solid/loads.h"
#include "solid/solid.h"

/* All forces but those of clamps, as accelerations into sx, sy, with every particle free. */
static void forces_without_clamps(struct solid *s, struct particles *p, double time)
{
    struct contact *const contact = s->contact;
    const double power = contact ? contact->power : 0, seconds = contact ? contact->seconds : 0;
    const double at = s->time;
    for (int64_t i = 0; i < p->n; i++) p->free[i] = 1;
    if (s->loads) s->loads->released = true;
    s->time = time;
    solid_forces(s, p);
    s->time = at;
    if (s->loads) s->loads->released = false;
    if (contact) contact->power = power, contact->seconds = seconds;
}

/* What a clamp gives particle i: its prescribed acceleration, and the force that this takes
 * beside the others (T-74). */
static void hold(const struct solid *s, const struct particles *p, int64_t i, const double to[2])
{
    double *const *const now = s->scratch;
    const double mass = s->body[p->body[i]].mass;
    now[2][i] = mass * (to[0] - now[0][i]);
    now[3][i] = mass * (to[1] - now[1][i]);
    now[0][i] = to[0];
    now[1][i] = to[1];
}

static void hold_moving(const struct solid *s, const struct particles *p, double time)
{
    const struct loads *const v = s->loads;
    struct motion_state motion = {0};
    int body = -1;
    for (int64_t k = 0; k < v->n_held; k++) {
        const int32_t i = v->held[k];
        if (p->body[i] != body) {
            body = p->body[i];
            motion =
                motion_at(v->scene, scene_find_motion(v->scene, v->scene->solid[body].clamp_motion),
                          time);
        }
        hold(s, p, i, motion_of_point(&motion, p->X[i], p->Y[i]).a);
    }
}

struct solid_forces_now solid_forces_now(struct solid *s, struct particles *p, double time)
{
    static const double rest[2] = {0, 0};
    const size_t bytes = (size_t)p->n * sizeof *p->sx;
    double *const *const now = s->scratch;
    memcpy(now[2], p->free, bytes);
    memcpy(now[4], p->sx, bytes);
    memcpy(now[5], p->sy, bytes);
    forces_without_clamps(s, p, time);
    memcpy(now[0], p->sx, bytes);
    memcpy(now[1], p->sy, bytes);
    memcpy(p->free, now[2], bytes);
    memcpy(p->sx, now[4], bytes);
    memcpy(p->sy, now[5], bytes);
    memset(now[2], 0, bytes);
    memset(now[3], 0, bytes);
    for (int64_t i = 0; i < p->n; i++)
        if (p->free[i] == 0) hold(s, p, i, rest);
    if (s->loads) hold_moving(s, p, time);
    return (struct solid_forces_now){now[0], now[1], now[2], now[3]};
}
