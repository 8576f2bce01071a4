/* SPDX-License-Identifier: MIT
 * Conditions on a probe: its section exists, and its keys fit its quantity. */
#include "case/case.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static enum err no_section(struct reader *r, const struct scene_probe *p, const char *key,
                           const char *name, bool walls_too)
{
    const int line = scene_line(r->scene, SECTION_probe, (int)(p - r->scene->probe), key);
    return case_no_section(r, line, key, name, SECTION_solid,
                           walls_too ? SECTION_wall : SECTION_solid);
}

static bool is_section(const struct scene *s, const char *name, bool walls_too)
{
    return scene_find_solid(s, name) >= 0 || (walls_too && scene_find_wall(s, name) >= 0);
}

static enum err check_body(struct reader *r, const struct scene_probe *p)
{
    if (!*p->body)
        return bad_line(r, p->common.line, "[probe %s] needs `body`, the solid that is measured",
                        p->common.name);
    if (is_section(r->scene, p->body, false)) return ERR_OK;
    return no_section(r, p, "body", p->body, false);
}

/* Each once: a force that counts twice is a mistake. */
static enum err check_bodies(struct reader *r, const struct scene_probe *p)
{
    char name[SCENE_TEXT], other[SCENE_TEXT];
    if (!*p->body)
        return bad_line(r, p->common.line,
                        "[probe %s] needs `body`, the solids or walls that are measured",
                        p->common.name);
    for (int k = 0; scene_listed(p->body, k, name); k++) {
        if (!is_section(r->scene, name, true)) return no_section(r, p, "body", name, true);
        for (int n = 0; n < k && scene_listed(p->body, n, other); n++)
            if (strcmp(name, other) == 0)
                return bad_line(r, p->common.line, "body = %.60s: %.60s is listed twice", p->body,
                                name);
    }
    return ERR_OK;
}

static enum err check_on(struct reader *r, const struct scene_probe *p)
{
    if (!*p->on) return ERR_OK;
    const bool face = p->quantity == PROBE_SURFACE_PRESSURE;
    if (scene_probe_target(p) != TARGET_FLUID_POINT && !face)
        return bad_line(r, p->common.line,
                        "[probe %s] on = %.60s is only for pressure, level, velocity and surface "
                        "pressure of the fluid; leave it out",
                        p->common.name, p->on);
    if (face && scene_find_solid(r->scene, p->on) >= 0)
        return bad_line(r, p->common.line,
                        "[probe %s] on = %.60s is a solid, which bends; a line moves with walls "
                        "only. quantity = force measures the fluid's force on the solid",
                        p->common.name, p->on);
    if (is_section(r->scene, p->on, true)) return ERR_OK;
    return no_section(r, p, "on", p->on, true);
}

/* A row then needs no more than the steps since the row before. */
static enum err check_average(struct reader *r, const struct scene_probe *p)
{
    const struct scene_output *const out = &r->scene->output;
    if (!case_sound(r, SECTION_top, 0) || !case_sound(r, SECTION_output, 0)) return ERR_OK;
    const double common =
        out->probe_interval > 0 ? out->probe_interval : 1e-3 * r->scene->top.end_time;
    const double interval = p->interval > 0 ? p->interval : common;
    if (p->average <= interval * (1 + 1e-12)) return ERR_OK;
    return bad_line(r, p->common.line,
                    "[probe %s] average = %g s is longer than the interval of %g s between its "
                    "rows; set `interval` to %g s or more",
                    p->common.name, p->average, interval, p->average);
}

static enum err check_clamp(struct reader *r, const struct scene_probe *p)
{
    const int body = scene_find_solid(r->scene, p->body);
    if (p->quantity != PROBE_REACTION || !case_sound(r, SECTION_solid, body)) return ERR_OK;
    if (r->scene->solid[body].clamp.n > 0) return ERR_OK;
    return bad_line(r, p->common.line,
                    "[probe %s] measures the force of the clamps of [solid %s], which has none; "
                    "give the solid a `clamp`",
                    p->common.name, p->body);
}

static enum err check_fluid(struct reader *r, const struct scene_probe *p)
{
    char quantity[SCENE_NAME];
    param_choice_name(param_find(SECTION_probe, "quantity"), p->quantity, quantity);
    const enum probe_target target = scene_probe_target(p);
    if (*p->body && target != TARGET_BODY)
        return bad_line(r, p->common.line,
                        "[probe %s] measures %s of the fluid, at a fixed point; leave `body` out",
                        p->common.name, quantity);
    if (r->scene->n_fluid == 0)
        return bad_line(r, p->common.line, "[probe %s] measures %s, but there is no fluid",
                        p->common.name, quantity);
    if (target == TARGET_FLUID_LINE && p->point[0] == p->to[0] && p->point[1] == p->to[1])
        return bad_line(r, p->common.line,
                        "[probe %s] measures the %s the line from `point` to `to`; the "
                        "two points must differ",
                        p->common.name, p->quantity == PROBE_FLUX ? "flux through" : "pressure on");
    return ERR_OK;
}

/* Without it, a place would be the origin. For forces it is, since they need no place. */
static enum err check_place(struct reader *r, const struct scene_probe *p, const char *key)
{
    const enum probe_target target = scene_probe_target(p);
    const bool line = target == TARGET_FLUID_LINE;
    if (scene_given(r->scene, SECTION_probe, (int)(p - r->scene->probe), key)) return ERR_OK;
    if (!line &&
        (strcmp(key, "to") == 0 || (target != TARGET_FLUID_POINT && target != TARGET_SOLID_POINT)))
        return ERR_OK;
    char quantity[SCENE_NAME];
    param_choice_name(param_find(SECTION_probe, "quantity"), p->quantity, quantity);
    return bad_line(r, p->common.line, "[probe %s] lacks `%s`: quantity = %s needs %s, in metres",
                    p->common.name, key, quantity,
                    line ? "both ends of its line, `point` and `to`" : "the place, two numbers");
}

static enum err check_probe(struct reader *r, const struct scene_probe *p)
{
    TRY(case_go_on(r, check_place(r, p, "point")));
    TRY(case_go_on(r, check_place(r, p, "to")));
    TRY(check_on(r, p));
    TRY(check_average(r, p));
    switch (scene_probe_target(p)) {
    case TARGET_BODY: TRY(check_bodies(r, p)); return check_fluid(r, p);
    case TARGET_SOLID:
    case TARGET_SOLID_POINT: TRY(check_body(r, p)); return check_clamp(r, p);
    default: return check_fluid(r, p);
    }
}

enum err case_check_probes(struct reader *r)
{
    for (int k = 0; k < r->scene->n_probe; k++)
        if (case_sound(r, SECTION_probe, k))
            TRY(case_go_on(r, check_probe(r, &r->scene->probe[k])));
    return ERR_OK;
}
