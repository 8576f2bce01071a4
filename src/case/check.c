/* SPDX-License-Identifier: MIT
 * Conditions on a scene beyond the range of each value: names that must exist, values that must
 * agree. */
#include "case/case.h"

/* --- names of other sections --- */

static enum err check_name(struct reader *r, const struct param *param, const char *name,
                           enum section_id also)
{
    struct nearest near = {0};
    const enum section_id kinds[] = {param->kind, also};
    for (int n = 0; n < 2; n++)
        for (int k = 0; k < section_count(r->scene, kinds[n]); k++) {
            const struct scene_section_common *const other = section_at(r->scene, kinds[n], k);
            if (strcmp(other->name, name) == 0) return ERR_OK;
            nearest_offer(&near, name, other->name);
        }
    const bool two = also != param->kind;
    if (param->section == SECTION_probe && scene_find(r->scene, SECTION_beam, name) >= 0)
        return bad_key(r, param->key, name,
                       "[beam %s] has no such quantity; a beam has displacement, velocity, "
                       "acceleration, energy, force, reaction and section_force",
                       name);
    return bad_key(r, param->key, name, "there is no [%s%s%s] of that name%s",
                   section_table[param->kind].word, two ? "] or [" : "",
                   two ? section_table[also].word : "", nearest_hint(&near));
}

/* The other kind of section that a probe of one body may name. */
static enum section_id other_kind(const struct scene *scene, const struct scene_probe *probe)
{
    switch ((enum probe_quantity)probe->quantity) {
    case PROBE_REACTION:
        if (scene_find(scene, SECTION_spring, probe->body) >= 0) return SECTION_spring;
        return scene_find(scene, SECTION_beam, probe->body) >= 0 ? SECTION_beam : SECTION_rigid;
    case PROBE_POSE: return SECTION_rigid;
    case PROBE_STRESS:
    case PROBE_STRAIN: return SECTION_solid;
    default: return SECTION_beam;
    }
}

/* All quantities but `force` are of one body. */
static enum err check_names(struct reader *r, const struct param *param, const void *section)
{
    const char *const text = (const char *)section + param->offset;
    const struct scene_probe *const probe = param->section == SECTION_probe ? section : NULL;
    const bool one = param->list && probe && probe->quantity != PROBE_FORCE;
    const struct hinge_list *const hinges = (const void *)text;
    const bool solid_hinges = param->type == PARAM_HINGES && param->section == SECTION_solid;
    char name[SCENE_TEXT];
    /* What may hold a rigid body or a beam is said where that section is checked. */
    for (int k = 0; solid_hinges && k < hinges->n; k++)
        if (*hinges->item[k].other) TRY(check_name(r, param, hinges->item[k].other, param->also));
    if (param->type == PARAM_HINGES || !*text) return ERR_OK;
    if (!param->list || one)
        return check_name(r, param, text, !one ? param->also : other_kind(r->scene, probe));
    for (int k = 0; scene_listed(text, k, name); k++) TRY(check_name(r, param, name, param->also));
    return ERR_OK;
}

enum err case_check_names(struct reader *r)
{
    for (const struct param *param = param_table; param < param_table + PARAM_COUNT; param++)
        for (int k = 0; param->kind && k < section_count(r->scene, param->section); k++) {
            r->section = section_at(r->scene, param->section, k);
            TRY(case_go_on(r, check_names(r, param, r->section)));
        }
    return ERR_OK;
}

/* --- fluid --- */

/* The largest speed of Eq. 3; 0: not known. */
static double largest_speed(const struct scene_fluid *f)
{
    return max2(f->max_speed, sqrt(f->max_pressure / f->density));
}

/* c0 as given, or by Eq. 3. */
static double sound_speed(const struct scene *scene, const struct scene_fluid *f)
{
    return f->sound_speed > 0 ? f->sound_speed : scene->numerics.sound_factor * largest_speed(f);
}

/* Two sections that must have one value of a key; sound_speed: of Eq. 3 if it is not given. */
static enum err same_value(struct reader *r, const void *its, const char *key, const char *all)
{
    const struct scene_section_common *const common = its;
    const void *const section[] = {r->section, its};
    const struct param *const param = param_find((enum section_id)common->section, key);
    double value[2];
    char text[2][SCENE_NAME];
    for (int k = 0; k < 2; k++) {
        value[k] = param_number(param, section[k]);
        if (strcmp(key, "sound_speed") == 0) value[k] = sound_speed(r->scene, section[k]);
        snprintf(text[k], SCENE_NAME, "%g", value[k]);
        if (param->type == PARAM_CHOICE)
            snprintf(text[k], SCENE_NAME, "%s", param_choice(param, (int)value[k]).text);
    }
    if (!(fabs(value[0] - value[1]) > 1e-12 * fabs(value[1]))) return ERR_OK;
    return bad_section(r, "and %s differ in `%s`: %s and %s; all %s must have the same value",
                       section_title(common).text, key, text[0], text[1], all);
}

/* All fluid has the same numbers, but those of its place and of Eq. 3. */
static enum err check_fluid(struct reader *r, const void *section)
{
    static const char own[] = " max_speed max_pressure particle_mass surface ";
    const struct scene_fluid *const f = section;
    struct scene *const scene = r->scene;
    const double c0 = sound_speed(scene, f);
    if (c0 == 0)
        return bad_section(r, "needs `sound_speed`, or `max_speed` and `max_pressure` for Eq. 3");
    if (c0 > 1e7)
        return bad_section(r,
                           "Eq. 3 gives a speed of sound of %g m/s, above the limit of 1e7; reduce "
                           "`max_speed` or `max_pressure`",
                           c0);
    if (f->pressure.e[0] && !isnan(f->surface))
        return bad_section(r, "has both `surface` and `pressure`; leave one out");
    if (f == scene->fluid) {
        scene->c0 = c0;
        scene->rho0 = f->density;
    }
    const double c_u = min2(c0, largest_speed(f) > 0 ? 10 * largest_speed(f) : c0);
    scene->c_u = max2(scene->c_u, c_u);
    for (int k = 0; k < PARAM_COUNT; k++) {
        const struct param *const param = &param_table[k];
        const bool number = param->type == PARAM_REAL || param->type == PARAM_CHOICE;
        char word[SCENE_NAME + 2];
        snprintf(word, sizeof word, " %s ", param->key);
        if (param->section == SECTION_fluid && number && !strstr(own, word))
            TRY(case_go_on(r, same_value(r, scene->fluid, param->key, "fluid")));
    }
    return ERR_OK;
}

/* --- solids, contact, loads --- */

static enum err check_solid(struct reader *r, const void *section)
{
    /* Keys with one common value for a pair across a bond. */
    static const char *const same[] = {"dp", "hourglass", "hourglass_form", "viscosity_form"};
    const struct scene *const scene = r->scene;
    const struct scene_solid *const a = section;
    if (*a->clamp_motion && a->clamp.n == 0)
        return bad_section(r, "has a `clamp_motion` but no `clamp`");
    /* A cell holds a limited number of particles. */
    const double ratio = a->dp > 0 ? scene->top.dp / a->dp : 1;
    if (ratio < 1 - 1e-9 || (ratio > 4 + 1e-9 && scene->n_fluid > 0))
        return bad_section(
            r, "dp = %g m must be between a quarter of the dp at the top, %g m, and that dp%s",
            a->dp, scene->top.dp, scene->n_fluid ? "" : "; without fluid it may be finer");
    for (int k = 0; k < a->hinge.n; k++) {
        const char *const to = a->hinge.item[k].other;
        if (strcmp(to, a->common.name) == 0)
            return bad_section(r,
                               "hinge = X, Y, %s: a body cannot be hinged to itself; name another "
                               "[solid] or a [wall]",
                               to);
    }
    if (!*a->joined) return ERR_OK;
    const int other = scene_find(scene, SECTION_solid, a->joined);
    if (other < 0) return ERR_OK; /* case_check_names reports it */
    const struct scene_solid *const b = &scene->solid[other];
    if (a == b)
        return bad_section(r, "joined = %s: a body cannot be joined to itself; name another",
                           a->joined);
    for (size_t k = 0; k < COUNT_OF(same); k++) TRY(same_value(r, b, same[k], "joined bodies"));
    return ERR_OK;
}

static bool moves_freely(const struct scene *scene, const char *name)
{
    const int wall = scene_find(scene, SECTION_wall, name);
    return wall < 0 || wall >= scene_rigid_wall(scene, 0);
}

/* Two bodies, of which one is no wall; a larger gap has fluid particles of its own. */
static enum err check_contact(struct reader *r, const void *section)
{
    const struct scene *const scene = r->scene;
    const struct scene_contact *const c = section;
    const double max_gap = 4;
    double dp = scene->top.dp;
    char name[2][SCENE_TEXT];
    if (scene->n_solid + scene->n_rigid + scene->n_beam == 0)
        return bad_section(r, "needs a [solid], a [rigid] or a [beam]");
    if (scene->n_rigid == 0 && c->restitution > 0)
        return bad_section(r, "has a `restitution`, which only a [rigid] uses; the rebound of a "
                              "[solid] follows from its stiffness");
    for (int k = 0; k < scene->n_solid; k++) dp = min2(dp, scene_solid_dp(scene, k));
    if (c->gap > max_gap * dp * (1 + 1e-9))
        return bad_section(r,
                           "gap = %g m is more than %g particle spacings of %g m; use at most %g m",
                           c->gap, max_gap, dp, max_gap * dp);
    if (*c->between && !scene_pair(c->between, name))
        return bad_key(r, "between", c->between, "two names are expected, separated by a comma");
    if (*c->between && !moves_freely(scene, name[0]) && !moves_freely(scene, name[1]))
        return bad_key(
            r, "between", c->between,
            "one of the two must be a [solid], [rigid] or [beam], because walls do not interact");
    return ERR_OK;
}

static enum err check_load(struct reader *r, const void *section)
{
    const struct scene_load *const l = section;
    if (l->moment.e[0] && scene_find(r->scene, SECTION_beam, l->body) < 0)
        return bad_section(r, "has a `moment`, which acts on a [beam]; %s is none", l->body);
    if (!l->force.e[0] != !l->traction.e[0]) return ERR_OK;
    if (!l->force.e[0] && l->moment.e[0]) return ERR_OK;
    return bad_section(r, "needs either `force` or `traction`, and has %s",
                       l->force.e[0] ? "both" : "neither");
}

/* Times that expressions are looked at, from the start to the end. */
enum { TIMES = 1000 };

/* --- motions --- */

/* Finite with its derivatives. */
static enum err check_finite(struct reader *r, const struct expr *e, double length)
{
    for (int n = 0; n <= TIMES; n++) {
        const struct expr_jet at = expr_jet_at(e, length * n / TIMES);
        if (!isfinite(at.value) || !isfinite(at.d1) || !isfinite(at.d2))
            return bad_section(r,
                               "%.200s: displacement, velocity or acceleration is not finite %g s "
                               "after `start`; change the expression",
                               expr_source(e), length * n / TIMES);
    }
    return ERR_OK;
}

/* A jump would move a body without a velocity. */
static enum err check_jumps(struct reader *r, const char *key, const struct expr *e, double length)
{
    double size = 0, at;
    for (int n = 0; n <= TIMES; n++)
        size = max2(size, 1e-6 * fabs(expr_jet_at(e, length * n / TIMES).value));
    for (int n = 0; n < TIMES; n++)
        if (expr_jumps(e, length * n / TIMES, length * (n + 1) / TIMES, size, &at))
            return bad_key(r, key, NULL,
                           "%s = %.200s jumps or is not finite %g s after `start`, so the velocity "
                           "is undefined; use a continuous expression",
                           key, expr_source(e), at);
    return ERR_OK;
}

static enum err check_motion(struct reader *r, const void *section)
{
    const struct scene_motion *const m = section;
    const struct expr *const each[] = {m->x.e[0], m->y.e[0], m->turn.e[0]};
    static const char *const keys[] = {"x", "y", "turn"};
    const double length = fmax(fmin(r->scene->top.end_time, m->stop) - m->start, 0);
    if (!(m->start < m->stop))
        return bad_section(r, "start = %g s must come before stop = %g s", m->start, m->stop);
    for (size_t k = 0; k < COUNT_OF(each); k++) {
        if (!each[k]) continue;
        TRY(check_finite(r, each[k], length));
        TRY(check_jumps(r, keys[k], each[k], length));
    }
    return ERR_OK;
}

static enum err check_damping(struct reader *r, const void *section)
{
    const struct scene_damping *const zone = section;
    if (zone->from[0] == zone->to[0] && zone->from[1] == zone->to[1])
        return bad_section(r, "has no length, because `from` and `to` are the same point");
    return ERR_OK;
}

/* --- probes --- */

/* Whether a body has a clamp, a hinge or a guide, or is itself a spring. */
static bool is_held(const struct scene *scene, const char *name)
{
    const int solid = scene_find(scene, SECTION_solid, name),
              beam = scene_find(scene, SECTION_beam, name),
              rigid = scene_find(scene, SECTION_wall, name) - scene_rigid_wall(scene, 0);
    if (solid >= 0) return scene->solid[solid].clamp.n + scene->solid[solid].hinge.n > 0;
    if (beam >= 0) return scene->beam[beam].clamp.n + scene->beam[beam].hinge.n > 0;
    if (rigid < 0) return true;
    const struct scene_rigid *const of = &scene->rigid[rigid];
    return of->hinge.n > 0 || of->guide[0] != 0 || of->guide[1] != 0 || !of->turns;
}

/* Each body once: a force that counts twice is a mistake. Clamps and hinges react. */
static enum err check_body(struct reader *r, const struct scene_probe *p)
{
    char name[SCENE_TEXT], other[SCENE_TEXT];
    if (!*p->body)
        return bad_section(r, "needs `body`, the %s measured",
                           p->quantity == PROBE_FORCE ? "solids or walls that are"
                                                      : "body that is");
    for (int k = 0; scene_listed(p->body, k, name); k++)
        for (int n = 0; n < k && scene_listed(p->body, n, other); n++)
            if (strcmp(name, other) == 0)
                return bad_section(r, "body = %.60s: %.60s is listed twice", p->body, name);
    if (p->quantity == PROBE_SECTION_FORCE && scene_find(r->scene, SECTION_beam, p->body) < 0)
        return bad_section(r, "measures the force in a cross-section of a [beam]; %s is none",
                           p->body);
    if (p->quantity == PROBE_REACTION && !is_held(r->scene, p->body))
        return bad_section(r,
                           "measures the force that holds %s, but nothing does; give it a `clamp`, "
                           "a `hinge` or a `guide`, or measure a [spring]",
                           p->body);
    return ERR_OK;
}

static enum err check_on(struct reader *r, const struct scene_probe *p)
{
    const bool face = p->quantity == PROBE_SURFACE_PRESSURE;
    if (!*p->on) return ERR_OK;
    if (scene_probe_target(p) != TARGET_FLUID_POINT && !face)
        return bad_section(r,
                           "on = %.60s is only for pressure, level, velocity and surface pressure "
                           "of the fluid; leave it out",
                           p->on);
    if (face && scene_find(r->scene, SECTION_solid, p->on) >= 0)
        return bad_section(r,
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
    return bad_section(r,
                       "average = %g s is longer than the interval of %g s between its rows; set "
                       "`interval` to %g s or more",
                       p->average, interval, p->average);
}

static enum err check_fluid_probe(struct reader *r, const struct scene_probe *p,
                                  const char *quantity)
{
    const enum probe_target target = scene_probe_target(p);
    if (*p->body && target != TARGET_BODY)
        return bad_section(r, "measures %s of the fluid, at a fixed point; leave `body` out",
                           quantity);
    if (r->scene->n_fluid == 0)
        return bad_section(r, "measures %s, but there is no fluid", quantity);
    if (target == TARGET_FLUID_LINE && p->point[0] == p->to[0] && p->point[1] == p->to[1])
        return bad_section(
            r, "measures the %s the line from `point` to `to`; the two points must differ",
            p->quantity == PROBE_FLUX ? "flux through" : "pressure on");
    return ERR_OK;
}

/* Refuses a probe without its point: the place would be the origin, which forces may be about. */
static enum err check_point(struct reader *r, const struct scene_probe *p, const char *key,
                            const char *quantity)
{
    const enum probe_target target = scene_probe_target(p);
    const bool line = target == TARGET_FLUID_LINE,
               point = target == TARGET_FLUID_POINT || target == TARGET_SOLID_POINT;
    if (!line && (!point || strcmp(key, "to") == 0)) return ERR_OK;
    if (scene_given(r->scene, SECTION_probe, p->common.index, key)) return ERR_OK;
    return bad_section(r, "lacks `%s`: quantity = %s needs %s, in metres", key, quantity,
                       line ? "both ends of its line, `point` and `to`" : "the place, two numbers");
}

static enum err check_probe(struct reader *r, const void *section)
{
    const struct scene_probe *const p = section;
    const char *const quantity = quantity_table[p->quantity].name;
    TRY(case_go_on(r, check_point(r, p, "point", quantity)));
    TRY(case_go_on(r, check_point(r, p, "to", quantity)));
    TRY(check_on(r, p));
    TRY(check_average(r, p));
    switch (scene_probe_target(p)) {
    case TARGET_BODY: TRY(check_body(r, p)); return check_fluid_probe(r, p, quantity);
    case TARGET_SOLID:
    case TARGET_SOLID_POINT: return check_body(r, p);
    default: return check_fluid_probe(r, p, quantity);
    }
}

/* --- unnamed sections and references --- */

/* An expression must have a value at the start and at a thousand times until the end. */
static enum err check_top(struct reader *r, const void *section)
{
    const struct scene_top *const top = section;
    for (int c = 0; c < 2; c++)
        for (int n = 0; top->gravity_in_time.e[c] && n <= TIMES; n++) {
            const double t = top->end_time * n / TIMES;
            const struct expr *const e = top->gravity_in_time.e[c];
            if (!isfinite(expr_at_arg(e, t)))
                return bad_line(r, key_line(r->scene, SECTION_top, 0, "gravity"),
                                "gravity = %s%.200s%s: component %d is not finite at t = %g s; it "
                                "must be finite at all times up to end_time",
                                c ? "..., " : "", expr_source(e), c ? "" : ", ...", c + 1, t);
        }
    return ERR_OK;
}

/* Implicit steps need an energy of the hourglass force, forces in double and, with fluid, an
 * exchange that allows the solid steps of its own. */
static enum err check_solid_steps(struct reader *r)
{
    const struct scene *const scene = r->scene;
    static const char with[] = "numerics.solid_steps = implicit";
    if (scene->numerics.solid_steps != SOLID_STEPS_IMPLICIT) return ERR_OK;
    if (scene->numerics.solid_precision == SOLID_PRECISION_SINGLE)
        return bad_line(r, key_line(scene, SECTION_numerics, 0, "solid_precision"),
                        "%s computes in double precision, but solid_precision = single; use auto",
                        with);
    if (scene->n_fluid > 0 && scene->numerics.multirate == MULTIRATE_OFF)
        return bad_line(r, key_line(scene, SECTION_numerics, 0, "multirate"),
                        "%s gives the solid steps of its own, but multirate = off; use auto", with);
    for (int k = 0; k < scene->n_solid; k++)
        if (scene->solid[k].hourglass > 0 && scene->solid[k].hourglass_form == HOURGLASS_PRINTED)
            return bad_line(r, key_line(scene, SECTION_solid, k, "hourglass_form"),
                            "[solid %s] hourglass_form = printed has no energy, which %s needs; "
                            "use variational",
                            scene->solid[k].common.name, with);
    return ERR_OK;
}

/* 0 stands for h_over_dp. */
static enum err check_numerics(struct reader *r, const void *section)
{
    const double value = ((const struct scene_numerics *)section)->solid_h_over_dp;
    if (value == 0 || value >= 1.1) return check_solid_steps(r);
    return bad_line(r, key_line(r->scene, SECTION_numerics, 0, "solid_h_over_dp"),
                    "solid_h_over_dp = %g is too small, so particles would have too few "
                    "neighbours; use 1.1 to 2, or 0 for the value of h_over_dp",
                    value);
}

static enum err check_output(struct reader *r, const void *section)
{
    static const char *const names[] = {
#define POINTDATA(NAME, name, ...) #name,
#include "case/pointdata.def"
    };
    const char *const fields = ((const struct scene_output *)section)->snapshot_fields;
    const size_t count = COUNT_OF(names);
    char word[SCENE_TEXT], known[300] = "";
    for (int n = 0; strcmp(fields, "all") != 0 && scene_word(fields, n, word); n++) {
        struct nearest near = {0};
        size_t k = 0;
        while (k < count && strcmp(names[k], word) != 0) nearest_offer(&near, word, names[k++]);
        if (k < count) continue;
        for (k = 0; k < count; k++) strcat(strcat(known, " "), names[k]);
        return bad_section(r,
                           "snapshot_fields: there is no field `%.63s`%s Allowed: all, or any of%s",
                           word, near.name ? nearest_hint(&near) : ".", known);
    }
    return ERR_OK;
}

/* Motions are at rest before t = 0. */
static enum err check_relax(struct reader *r, const void *section)
{
    const struct scene *const scene = r->scene;
    const bool sought = ((const struct scene_relax *)section)->tolerance > 0;
    for (int k = 0; sought && k < scene->n_motion; k++)
        if (scene->motion[k].start < 0)
            return problem(r, (struct problem_place){.section = &scene->motion[k]},
                           "start = %g s: with [relax] no motion may begin before t = 0",
                           scene->motion[k].start);
    return ERR_OK;
}

/* A reference is for a column: <probe>_<quantity>_<unit>. */
static enum err check_reference(struct reader *r, const void *section)
{
    const struct scene_reference *const ref = section;
    const bool formula = ref->formula.e[0] != NULL;
    if (!*ref->file == !formula)
        return bad_section(r, "needs either `file` or `formula`, and has %s",
                           formula ? "both" : "neither");
    if (!(ref->from < ref->until))
        return bad_section(r, "from = %g s must come before until = %g s", ref->from, ref->until);
    for (int p = 0; p < r->scene->n_probe; p++) {
        const char *const name = r->scene->probe[p].common.name;
        const size_t length = strlen(name);
        if (strncmp(ref->probe, name, length) == 0 && ref->probe[length] == '_') return ERR_OK;
    }
    if (!*ref->probe) return ERR_OK; /* reported as missing */
    return bad_key(r, "probe", NULL,
                   "probe = %.80s: no probe has such a column; a column is PROBE_QUANTITY_UNIT, "
                   "such as M1_dx_m",
                   ref->probe);
}

enum err case_check(struct reader *r)
{
    static const struct {
        enum section_id section;
        enum err (*check)(struct reader *r, const void *section);
    } checks[] = {
        {SECTION_top, check_top},
        {SECTION_numerics, check_numerics},
        {SECTION_output, check_output},
        {SECTION_relax, check_relax},
        {SECTION_fluid, check_fluid},
        {SECTION_solid, check_solid},
        {SECTION_rigid, case_check_rigid},
        {SECTION_spring, case_check_spring},
        {SECTION_beam, case_check_beam},
        {SECTION_damping, check_damping},
        {SECTION_motion, check_motion},
        {SECTION_inflow, case_check_open},
        {SECTION_outflow, case_check_open},
        {SECTION_probe, check_probe},
        {SECTION_contact, check_contact},
        {SECTION_load, check_load},
        {SECTION_reference, check_reference},
    };
    if (r->scene->n_fluid + r->scene->n_solid + r->scene->n_rigid + r->scene->n_beam == 0)
        return bad_line(r, 1,
                        "nothing to simulate: the case needs a [fluid NAME], a [solid NAME], a "
                        "[rigid NAME] or a [beam NAME] section");
    for (size_t n = 0; n < COUNT_OF(checks); n++)
        for (int k = 0; k < section_count(r->scene, checks[n].section); k++) {
            r->section = section_at(r->scene, checks[n].section, k);
            TRY(case_go_on(r, checks[n].check(r, r->section)));
        }
    return case_check_effects(r);
}
