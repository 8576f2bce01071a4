/* SPDX-License-Identifier: MIT
 * Conditions on a probe: its section exists, and its keys fit its quantity. */
#include "case/case.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static enum err no_section(struct reader *r, const struct scene_probe *probe, const char *key,
                           const char *name, bool walls_too)
{
    const int line = scene_line(r->scene, SECTION_probe, (int)(probe - r->scene->probe), key);
    return case_no_section(r, line, key, name, SECTION_solid,
                           walls_too ? SECTION_wall : SECTION_solid);
}

static bool is_section(const struct scene *scene, const char *name, bool walls_too)
{
    return scene_find_solid(scene, name) >= 0 || (walls_too && scene_find_wall(scene, name) >= 0);
}

static enum err check_body(struct reader *r, const struct scene_probe *probe)
{
    if (!*probe->body)
        return bad_line(r, probe->common.line,
                        "[probe %s] needs `body`, the solid that is measured", probe->common.name);
    if (is_section(r->scene, probe->body, false)) return ERR_OK;
    return no_section(r, probe, "body", probe->body, false);
}

/* Each once: a force that counts twice is a mistake. */
static enum err check_bodies(struct reader *r, const struct scene_probe *probe)
{
    char name[SCENE_TEXT], other[SCENE_TEXT];
    if (!*probe->body)
        return bad_line(r, probe->common.line,
                        "[probe %s] needs `body`, the solids or walls that are measured",
                        probe->common.name);
    for (int k = 0; scene_listed(probe->body, k, name); k++) {
        if (!is_section(r->scene, name, true)) return no_section(r, probe, "body", name, true);
        for (int n = 0; n < k && scene_listed(probe->body, n, other); n++)
            if (strcmp(name, other) == 0)
                return bad_line(r, probe->common.line, "body = %.60s: %.60s is listed twice",
                                probe->body, name);
    }
    return ERR_OK;
}

static enum err check_on(struct reader *r, const struct scene_probe *probe)
{
    if (!*probe->on) return ERR_OK;
    const bool face = probe->quantity == PROBE_SURFACE_PRESSURE;
    if (scene_probe_target(probe) != TARGET_FLUID_POINT && !face)
        return bad_line(r, probe->common.line,
                        "[probe %s] on = %.60s is only for pressure, level, velocity and surface "
                        "pressure of the fluid; leave it out",
                        probe->common.name, probe->on);
    if (face && scene_find_solid(r->scene, probe->on) >= 0)
        return bad_line(r, probe->common.line,
                        "[probe %s] on = %.60s is a solid, which bends; a line moves with walls "
                        "only. quantity = force measures the fluid's force on the solid",
                        probe->common.name, probe->on);
    if (is_section(r->scene, probe->on, true)) return ERR_OK;
    return no_section(r, probe, "on", probe->on, true);
}

/* A row then needs no more than the steps since the row before. */
static enum err check_average(struct reader *r, const struct scene_probe *probe)
{
    const struct scene_output *const out = &r->scene->output;
    if (!case_sound(r, SECTION_top, 0) || !case_sound(r, SECTION_output, 0)) return ERR_OK;
    const double common =
        out->probe_interval > 0 ? out->probe_interval : 1e-3 * r->scene->top.end_time;
    const double interval = probe->interval > 0 ? probe->interval : common;
    if (probe->average <= interval * (1 + 1e-12)) return ERR_OK;
    return bad_line(r, probe->common.line,
                    "[probe %s] average = %g s is longer than the interval of %g s between its "
                    "rows; set `interval` to %g s or more",
                    probe->common.name, probe->average, interval, probe->average);
}

static enum err check_clamp(struct reader *r, const struct scene_probe *probe)
{
    const int body = scene_find_solid(r->scene, probe->body);
    if (probe->quantity != PROBE_REACTION || !case_sound(r, SECTION_solid, body)) return ERR_OK;
    if (r->scene->solid[body].clamp.n > 0) return ERR_OK;
    return bad_line(r, probe->common.line,
                    "[probe %s] measures the force of the clamps of [solid %s], which has none; "
                    "give the solid a `clamp`",
                    probe->common.name, probe->body);
}

static enum err check_fluid_probe(struct reader *r, const struct scene_probe *probe)
{
    char quantity[SCENE_NAME];
    param_choice_name(param_find(SECTION_probe, "quantity"), probe->quantity, quantity);
    const enum probe_target target = scene_probe_target(probe);
    if (*probe->body && target != TARGET_BODY)
        return bad_line(r, probe->common.line,
                        "[probe %s] measures %s of the fluid, at a fixed point; leave `body` out",
                        probe->common.name, quantity);
    if (r->scene->n_fluid == 0)
        return bad_line(r, probe->common.line, "[probe %s] measures %s, but there is no fluid",
                        probe->common.name, quantity);
    if (target == TARGET_FLUID_LINE && probe->point[0] == probe->to[0] &&
        probe->point[1] == probe->to[1])
        return bad_line(r, probe->common.line,
                        "[probe %s] measures the %s the line from `point` to `to`; the "
                        "two points must differ",
                        probe->common.name,
                        probe->quantity == PROBE_FLUX ? "flux through" : "pressure on");
    return ERR_OK;
}

/* Without it, a place would be the origin. For forces it is, since they need no place. */
static enum err check_place(struct reader *r, const struct scene_probe *probe, const char *key)
{
    const enum probe_target target = scene_probe_target(probe);
    const bool line = target == TARGET_FLUID_LINE;
    if (scene_given(r->scene, SECTION_probe, (int)(probe - r->scene->probe), key)) return ERR_OK;
    if (!line &&
        (strcmp(key, "to") == 0 || (target != TARGET_FLUID_POINT && target != TARGET_SOLID_POINT)))
        return ERR_OK;
    char quantity[SCENE_NAME];
    param_choice_name(param_find(SECTION_probe, "quantity"), probe->quantity, quantity);
    return bad_line(r, probe->common.line,
                    "[probe %s] lacks `%s`: quantity = %s needs %s, in metres", probe->common.name,
                    key, quantity,
                    line ? "both ends of its line, `point` and `to`" : "the place, two numbers");
}

static enum err check_probe(struct reader *r, const struct scene_probe *probe)
{
    TRY(case_go_on(r, check_place(r, probe, "point")));
    TRY(case_go_on(r, check_place(r, probe, "to")));
    TRY(check_on(r, probe));
    TRY(check_average(r, probe));
    switch (scene_probe_target(probe)) {
    case TARGET_BODY: TRY(check_bodies(r, probe)); return check_fluid_probe(r, probe);
    case TARGET_SOLID:
    case TARGET_SOLID_POINT: TRY(check_body(r, probe)); return check_clamp(r, probe);
    default: return check_fluid_probe(r, probe);
    }
}

enum err case_check_probes(struct reader *r)
{
    for (int k = 0; k < r->scene->n_probe; k++)
        if (case_sound(r, SECTION_probe, k))
            TRY(case_go_on(r, check_probe(r, &r->scene->probe[k])));
    return ERR_OK;
}
