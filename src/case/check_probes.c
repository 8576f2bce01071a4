/* SPDX-License-Identifier: MIT
 * What a probe must satisfy: the section it looks at, and the keys that go with its quantity. */
#include "case/case.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static enum err no_section(struct reader *r, const struct scene_probe *p, bool walls_too)
{
    struct nearest near = {0};
    for (int k = 0; k < r->scene->n_solid; k++)
        nearest_offer(&near, p->body, r->scene->solid[k].common.name);
    for (int k = 0; walls_too && k < r->scene->n_wall; k++)
        nearest_offer(&near, p->body, r->scene->wall[k].common.name);
    return bad_line(r, p->common.line, "body = %.60s: there is no [solid]%s of that name%s%s%s",
                    p->body, walls_too ? " or [wall]" : "", near.name ? "; did you mean `" : "",
                    near.name ? near.name : "", near.name ? "`?" : "");
}

static enum err check_body(struct reader *r, const struct scene_probe *p, bool walls_too)
{
    if (!*p->body)
        return bad_line(r, p->common.line, "[probe %s] needs `body`, the solid%s it belongs to",
                        p->common.name, walls_too ? " or wall" : "");
    if (scene_find_solid(r->scene, p->body) >= 0) return ERR_OK;
    if (walls_too && scene_find_wall(r->scene, p->body) >= 0) return ERR_OK;
    return no_section(r, p, walls_too);
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
                        "[probe %s] measures through a line: `point` and `to` are its ends and "
                        "must differ",
                        p->common.name);
    return ERR_OK;
}

static enum err check_probe(struct reader *r, const struct scene_probe *p)
{
    switch (scene_probe_target(p)) {
    case TARGET_BODY: TRY(check_body(r, p, true)); return check_fluid(r, p);
    case TARGET_SOLID:
    case TARGET_SOLID_POINT: return check_body(r, p, false);
    default: return check_fluid(r, p);
    }
}

enum err case_check_probes(struct reader *r)
{
    for (int k = 0; k < r->scene->n_probe; k++)
        TRY(case_go_on(r, check_probe(r, &r->scene->probe[k])));
    return ERR_OK;
}
