/* SPDX-License-Identifier: MIT
 * Conditions on a probe: its keys fit its quantity. */
#include "case/case.h"

#include <stdio.h>
#include <string.h>

/* Each body once: a force that counts twice is a mistake. A reaction is that of clamps
 * and hinges. */
static enum err check_body(struct reader *r, const struct scene_probe *p)
{
    char name[SCENE_TEXT], other[SCENE_TEXT];
    if (!*p->body)
        return bad_section(r, p, NULL, "needs `body`, the %s measured",
                           p->quantity == PROBE_FORCE ? "solids or walls that are"
                                                      : "solid that is");
    for (int k = 0; scene_listed(p->body, k, name); k++)
        for (int n = 0; n < k && scene_listed(p->body, n, other); n++)
            if (strcmp(name, other) == 0)
                return bad_section(r, p, NULL, "body = %.60s: %.60s is listed twice", p->body,
                                   name);
    const int body = scene_find_solid(r->scene, p->body);
    if (p->quantity == PROBE_REACTION && body >= 0 &&
        r->scene->solid[body].clamp.n + r->scene->solid[body].hinge.n == 0)
        return bad_section(r, p, NULL,
                           "measures the force of the clamps and hinges of [solid %s], which has "
                           "none; give the solid a `clamp` or a `hinge`",
                           p->body);
    return ERR_OK;
}

static enum err check_on(struct reader *r, const struct scene_probe *p)
{
    const bool face = p->quantity == PROBE_SURFACE_PRESSURE;
    if (!*p->on) return ERR_OK;
    if (scene_probe_target(p) != TARGET_FLUID_POINT && !face)
        return bad_section(r, p, NULL,
                           "on = %.60s is only for pressure, level, velocity and surface pressure "
                           "of the fluid; leave it out",
                           p->on);
    if (face && scene_find_solid(r->scene, p->on) >= 0)
        return bad_section(r, p, NULL,
                           "on = %.60s is a solid, which bends; a line moves with walls only. "
                           "quantity = force measures the fluid's force on the solid",
                           p->on);
    return ERR_OK;
}

/* A row then needs no more than the steps since the row before. */
static enum err check_average(struct reader *r, const struct scene_probe *p)
{
    const double given = r->scene->output.probe_interval;
    const double common = given > 0 ? given : 1e-3 * r->scene->top.end_time;
    const double interval = p->interval > 0 ? p->interval : common;
    if (p->average <= interval * (1 + 1e-12)) return ERR_OK;
    return bad_section(r, p, NULL,
                       "average = %g s is longer than the interval of %g s between its rows; set "
                       "`interval` to %g s or more",
                       p->average, interval, p->average);
}

static enum err check_fluid_probe(struct reader *r, const struct scene_probe *p,
                                  const char *quantity)
{
    const enum probe_target target = scene_probe_target(p);
    if (*p->body && target != TARGET_BODY)
        return bad_section(r, p, NULL,
                           "measures %s of the fluid, at a fixed point; leave `body` out",
                           quantity);
    if (r->scene->n_fluid == 0)
        return bad_section(r, p, NULL, "measures %s, but there is no fluid", quantity);
    if (target == TARGET_FLUID_LINE && p->point[0] == p->to[0] && p->point[1] == p->to[1])
        return bad_section(r, p, NULL,
                           "measures the %s the line from `point` to `to`; the two points must "
                           "differ",
                           p->quantity == PROBE_FLUX ? "flux through" : "pressure on");
    return ERR_OK;
}

/* Without it, a place would be the origin. For forces it is, since they need no place. */
static enum err check_place(struct reader *r, const struct scene_probe *p, const char *key,
                            const char *quantity)
{
    const enum probe_target target = scene_probe_target(p);
    const bool line = target == TARGET_FLUID_LINE,
               point = target == TARGET_FLUID_POINT || target == TARGET_SOLID_POINT;
    if (!line && (!point || strcmp(key, "to") == 0)) return ERR_OK;
    if (scene_given(r->scene, SECTION_probe, p->common.index, key)) return ERR_OK;
    return bad_section(r, p, NULL, "lacks `%s`: quantity = %s needs %s, in metres", key, quantity,
                       line ? "both ends of its line, `point` and `to`" : "the place, two numbers");
}

enum err case_check_probe(struct reader *r, const void *section)
{
    const struct scene_probe *const p = section;
    char quantity[SCENE_NAME];
    param_choice_name(param_find(SECTION_probe, "quantity"), p->quantity, quantity);
    TRY(case_go_on(r, check_place(r, p, "point", quantity)));
    TRY(case_go_on(r, check_place(r, p, "to", quantity)));
    TRY(check_on(r, p));
    TRY(check_average(r, p));
    switch (scene_probe_target(p)) {
    case TARGET_BODY: TRY(check_body(r, p)); return check_fluid_probe(r, p, quantity);
    case TARGET_SOLID:
    case TARGET_SOLID_POINT: return check_body(r, p);
    default: return check_fluid_probe(r, p, quantity);
    }
}
