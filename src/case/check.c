/* SPDX-License-Identifier: MIT
 * Conditions on a scene beyond the range of each value: names that must exist, values that must
 * agree. */
#include "case/case.h"

#include "case/effects.h"
#include "case/expr.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- fluid --- */

/* c0 as given, or by Eq. 3. */
static enum err sound_speed(struct reader *r, const struct scene_fluid *f, double *c0)
{
    const double least = 10 * max2(f->max_speed, sqrt(f->max_pressure / f->density));
    const int line = f->common.line;
    *c0 = f->sound_speed > 0 ? f->sound_speed : r->scene->numerics.sound_factor / 10 * least;
    if (*c0 == 0)
        return bad_line(r, line,
                        "[fluid %s] needs `sound_speed`, or `max_speed` and `max_pressure` "
                        "for Eq. 3",
                        f->common.name);
    if (*c0 > 1e7)
        return bad_line(r, line,
                        "[fluid %s] Eq. 3 gives a speed of sound of %g m/s, above the limit of "
                        "1e7; reduce `max_speed` or `max_pressure`",
                        f->common.name, *c0);
    if (f->pressure.e[0] && !isnan(f->surface))
        return bad_line(r, line, "[fluid %s] has both `surface` and `pressure`; leave one out",
                        f->common.name);
    return ERR_OK;
}

/* All fluid has the same properties. */
static enum err differ(struct reader *r, const struct scene_fluid *f, const char *key, double mine,
                       double its)
{
    const struct param *const param = param_find(SECTION_fluid, key);
    char mine_text[SCENE_NAME], its_text[SCENE_NAME];
    if (param->type == PARAM_CHOICE) {
        param_choice_name(param, (int)mine, mine_text);
        param_choice_name(param, (int)its, its_text);
    } else {
        snprintf(mine_text, sizeof mine_text, "%g", mine);
        snprintf(its_text, sizeof its_text, "%g", its);
    }
    return bad_line(
        r, f->common.line,
        "[fluid %s] and [fluid %s] differ in `%s`: %s and %s; all fluid must have the same value",
        f->common.name, r->scene->fluid[0].common.name, key, mine_text, its_text);
}

/* Compares a fluid with the first one: in all numbers but those of its place and of Eq. 3. */
static enum err check_fluid(struct reader *r, const struct scene_fluid *f, double c0)
{
    static const char own[] = " max_speed max_pressure particle_mass surface ";
    const struct scene *const scene = r->scene;
    for (int k = 0; k < PARAM_COUNT; k++) {
        const struct param *const param = &param_table[k];
        const bool number = param->type == PARAM_REAL || param->type == PARAM_CHOICE;
        char word[SCENE_NAME];
        snprintf(word, sizeof word, " %s ", param->key);
        if (param->section != SECTION_fluid || !number || strstr(own, word)) continue;
        double value[2] = {c0, scene->c0}; /* of sound_speed: that of Eq. 3 if it is not given */
        for (int n = 0; n < 2 && strcmp(param->key, "sound_speed") != 0; n++) {
            const char *const at = (const char *)(n ? &scene->fluid[0] : f) + param->offset;
            value[n] = param->type == PARAM_REAL ? *(const double *)(const void *)at
                                                 : *(const int *)(const void *)at;
        }
        if (fabs(value[0] - value[1]) > 1e-12 * fabs(value[1]))
            TRY(case_go_on(r, differ(r, f, param->key, value[0], value[1])));
    }
    return ERR_OK;
}

static enum err check_fluids(struct reader *r)
{
    struct scene *scene = r->scene;
    double c0;
    if (scene->n_fluid == 0) return ERR_OK;
    TRY(sound_speed(r, &scene->fluid[0], &scene->c0));
    scene->rho0 = scene->fluid[0].density;
    for (int k = 1; k < scene->n_fluid; k++) {
        const enum err err = sound_speed(r, &scene->fluid[k], &c0);
        TRY(case_go_on(r, err ? err : check_fluid(r, &scene->fluid[k], c0)));
    }
    return ERR_OK;
}

/* --- references between sections --- */

/* The sections that name a motion. */
static enum err check_moved(struct reader *r)
{
    const struct scene *scene = r->scene;
    for (int k = 0; k < scene->n_wall; k++)
        if (case_sound(r, SECTION_wall, k) && *scene->wall[k].motion &&
            scene_find_motion(scene, scene->wall[k].motion) < 0)
            TRY(case_go_on(r, case_no_section(r, scene_line(r->scene, SECTION_wall, k, "motion"),
                                              "motion", scene->wall[k].motion, SECTION_motion,
                                              SECTION_motion)));
    for (int k = 0; k < scene->n_solid; k++) {
        const struct scene_solid *b = &scene->solid[k];
        if (!*b->clamp_motion || !case_sound(r, SECTION_solid, k)) continue;
        if (scene_find_motion(scene, b->clamp_motion) < 0)
            TRY(case_go_on(r,
                           case_no_section(r,
                                           scene_line(r->scene, SECTION_solid, k, "clamp_motion"),
                                           "clamp_motion", b->clamp_motion, SECTION_motion,
                                           SECTION_motion)));
        else if (b->clamp.n == 0)
            TRY(case_go_on(r, bad_line(r, b->common.line,
                                       "[solid %s] has a `clamp_motion` but no `clamp`",
                                       b->common.name)));
    }
    return ERR_OK;
}

/* Keys with one common value for a pair across a bond. */
static enum err check_joint(struct reader *r, const struct scene_solid *a,
                            const struct scene_solid *b)
{
    const struct {
        const char *key;
        double mine, its;
    } same[] = {
        {"dp", a->dp, b->dp},
        {"hourglass", a->hourglass, b->hourglass},
        {"hourglass_form", a->hourglass_form, b->hourglass_form},
        {"viscosity_form", a->viscosity_form, b->viscosity_form},
    };
    for (size_t k = 0; k < COUNT_OF(same); k++)
        if (same[k].mine != same[k].its)
            return bad_line(r, a->common.line,
                            "[solid %s] is joined to [solid %s] and differs in `%s`; joined "
                            "bodies need the same value",
                            a->common.name, b->common.name, same[k].key);
    return ERR_OK;
}

/* A cell holds a limited number of particles. */
static enum err check_spacing(struct reader *r, int solid)
{
    const struct scene *scene = r->scene;
    const double ratio = scene->top.dp / scene_solid_dp(scene, solid);
    if (ratio >= 1 - 1e-9 && (ratio <= 3 + 1e-9 || scene->n_fluid == 0)) return ERR_OK;
    return bad_line(
        r, scene->solid[solid].common.line,
        "[solid %s] dp = %g m must be between a third of the dp at the top, %g m, and that dp%s",
        scene->solid[solid].common.name, scene->solid[solid].dp, scene->top.dp,
        scene->n_fluid ? "" : "; without fluid it may be finer");
}

static enum err check_joined(struct reader *r, int solid)
{
    const struct scene *scene = r->scene;
    const struct scene_solid *const a = &scene->solid[solid];
    TRY(check_spacing(r, solid));
    if (!*a->joined) return ERR_OK;
    const int other = scene_find_solid(scene, a->joined);
    if (other < 0)
        return case_no_section(r, scene_line(r->scene, SECTION_solid, solid, "joined"), "joined",
                               a->joined, SECTION_solid, SECTION_solid);
    if (other == solid)
        return bad_line(r, a->common.line,
                        "[solid %s] joined = %s: a body cannot be joined to itself; name another",
                        a->common.name, a->joined);
    return check_joint(r, a, &scene->solid[other]);
}

/* A larger gap contains fluid particles of its own. */
static enum err check_gap(struct reader *r, const struct scene_contact *c)
{
    const double most = 4;
    double dp = r->scene->top.dp;
    for (int k = 0; k < r->scene->n_solid; k++) dp = min2(dp, scene_solid_dp(r->scene, k));
    if (c->gap <= most * dp * (1 + 1e-9)) return ERR_OK;
    return bad_line(
        r, c->common.line,
        "[contact %s] gap = %g m is more than %g particle spacings of %g m; use at most %g m",
        c->common.name, c->gap, most, dp, most * dp);
}

/* Two bodies, one of them a solid. */
static enum err check_contact(struct reader *r, const struct scene_contact *c)
{
    const struct scene *scene = r->scene;
    char name[2][SCENE_TEXT];
    if (scene->n_solid == 0)
        return bad_line(r, c->common.line, "[contact %s] needs a [solid]", c->common.name);
    if (case_sound(r, SECTION_top, 0) && case_all_sound(r, SECTION_solid)) TRY(check_gap(r, c));
    if (!*c->between) return ERR_OK;
    const int line = scene_line(r->scene, SECTION_contact, (int)(c - scene->contact), "between");
    if (!scene_pair(c->between, name))
        return bad_line(r, line, "between = %.100s: two names are expected, separated by a comma",
                        c->between);
    bool solid = false;
    for (int j = 0; j < 2; j++) {
        solid |= scene_find_solid(scene, name[j]) >= 0;
        if (scene_find_solid(scene, name[j]) < 0 && scene_find_wall(scene, name[j]) < 0)
            return case_no_section(r, line, "between", name[j], SECTION_solid, SECTION_wall);
    }
    if (!solid)
        return bad_line(
            r, line,
            "between = %.100s: one of the two must be a [solid], because walls do not interact",
            c->between);
    return ERR_OK;
}

static enum err check_load(struct reader *r, const struct scene_load *l)
{
    const int line = l->common.line;
    if (!*l->body)
        return bad_line(r, line, "[load %s] needs `body`, the solid it acts on", l->common.name);
    if (scene_find_solid(r->scene, l->body) < 0)
        return case_no_section(r,
                               scene_line(r->scene, SECTION_load, (int)(l - r->scene->load),
                                          "body"),
                               "body", l->body, SECTION_solid, SECTION_solid);
    if (l->shape.n == 0)
        return bad_line(r, line, "[load %s] needs a `shape`, the region it acts on",
                        l->common.name);
    if (!l->force.e[0] == !l->traction.e[0])
        return bad_line(r, line, "[load %s] needs either `force` or `traction`, and has %s",
                        l->common.name, l->force.e[0] ? "both" : "neither");
    return ERR_OK;
}

/* A reference is for a column: <probe>_<quantity>_<unit>. */
static enum err check_reference(struct reader *r, const struct scene_reference *ref)
{
    const struct scene *scene = r->scene;
    const int line = ref->common.line;
    const bool formula = ref->formula.e[0] != NULL;
    const int column =
        scene_line(r->scene, SECTION_reference, (int)(ref - scene->reference), "probe");
    if (!*ref->probe || (!*ref->file && !formula))
        return bad_line(r, line, "[reference %s] needs `%s`", ref->common.name,
                        *ref->probe ? "file` or `formula" : "probe");
    if (*ref->file && formula)
        return bad_line(r, line, "[reference %s] has both `file` and `formula`; leave one out",
                        ref->common.name);
    if (!(ref->from < ref->until))
        return bad_line(r, line, "[reference %s] from = %g s must come before until = %g s",
                        ref->common.name, ref->from, ref->until);
    for (int p = 0; p < scene->n_probe; p++) {
        const char *name = scene->probe[p].common.name;
        const size_t length = strlen(name);
        if (strncmp(ref->probe, name, length) == 0 && ref->probe[length] == '_') return ERR_OK;
    }
    return bad_line(r, column,
                    "[reference %s] probe = %.80s: no probe has such a column; a column is "
                    "PROBE_QUANTITY_UNIT, such as M1_dx_m",
                    ref->common.name, ref->probe);
}

/* An expression must have a value at the start and at a thousand times until the end. */
static enum err check_gravity(struct reader *r)
{
    enum { TIMES = 1000 };
    const struct scene_top *const top = &r->scene->top;
    const int line = scene_line(r->scene, SECTION_top, 0, "gravity");
    for (int c = 0; c < 2; c++)
        for (int n = 0; top->gravity_in_time.e[c] && n <= TIMES; n++) {
            const double t = top->end_time * n / TIMES;
            if (isfinite(scene_expr_at(top->gravity_in_time.e[c], t, 0))) continue;
            const char *const text[] = {c ? "..., " : "", c ? "" : ", ..."};
            return bad_line(r, line,
                            "gravity = %s%.200s%s: component %d is not finite at t = %g s; it must "
                            "be finite at all times up to end_time",
                            text[0], expr_source(top->gravity_in_time.e[c]), text[1], c + 1, t);
        }
    return ERR_OK;
}

/* A [relax] section is enough to seek rest. Motions are at rest before t = 0. */
static enum err check_relax(struct reader *r)
{
    struct scene *const scene = r->scene;
    struct scene_relax *const x = &scene->relax;
    if (x->common.line > 0 && !scene_given(scene, SECTION_relax, 0, "tolerance"))
        x->tolerance = scene->n_fluid > 0 ? 0.02 : 0.001; /* water keeps slow currents */
    for (int k = 0; x->tolerance > 0 && k < scene->n_motion; k++)
        if (scene->motion[k].start < 0)
            return bad_line(r, scene->motion[k].common.line,
                            "[motion %s] start = %g s: with [relax] no motion may begin before "
                            "t = 0",
                            scene->motion[k].common.name, scene->motion[k].start);
    return ERR_OK;
}

/* 0 stands for h_over_dp, which has the same bounds. */
static enum err check_solid_h(struct reader *r)
{
    const double value = r->scene->numerics.solid_h_over_dp;
    if (value == 0 || value >= 1.1) return ERR_OK;
    return bad_line(r, scene_line(r->scene, SECTION_numerics, 0, "solid_h_over_dp"),
                    "solid_h_over_dp = %g is too small, so particles would have too few "
                    "neighbours; use 1.1 to 2, or 0 for the value of h_over_dp",
                    value);
}

/* What sections say of each other, for each that is valid itself. */
static enum err check_sections(struct reader *r)
{
    const struct scene *const scene = r->scene;
    const bool top = case_sound(r, SECTION_top, 0);
    for (int k = 0; k < scene->n_solid; k++)
        if (top && case_all_sound(r, SECTION_solid)) TRY(case_go_on(r, check_joined(r, k)));
    TRY(check_moved(r));
    for (int k = 0; k < scene->n_motion; k++)
        if (top && case_sound(r, SECTION_motion, k))
            TRY(case_go_on(r, case_check_motion(r, &scene->motion[k])));
    if (top && case_all_sound(r, SECTION_inflow) && case_all_sound(r, SECTION_outflow) &&
        case_all_sound(r, SECTION_fluid))
        TRY(case_go_on(r, case_check_open(r)));
    TRY(case_check_probes(r));
    if (case_sound(r, SECTION_output, 0)) TRY(case_go_on(r, case_check_output(r)));
    for (int k = 0; k < scene->n_contact; k++)
        if (case_sound(r, SECTION_contact, k))
            TRY(case_go_on(r, check_contact(r, &scene->contact[k])));
    for (int k = 0; k < scene->n_load; k++)
        if (case_sound(r, SECTION_load, k)) TRY(case_go_on(r, check_load(r, &scene->load[k])));
    for (int k = 0; k < scene->n_reference; k++)
        if (case_sound(r, SECTION_reference, k))
            TRY(case_go_on(r, check_reference(r, &scene->reference[k])));
    return ERR_OK;
}

enum err case_check(struct reader *r)
{
    struct scene *const scene = r->scene;
    const bool valid = r->n_problems == 0, numerics = case_sound(r, SECTION_numerics, 0);
    if (scene->numerics.cfl == 0) /* the largest step at which the integrator is accurate */
        scene->numerics.cfl =
            scene->top.integrator == INTEGRATOR_LEAPFROG ? CFL_LEAPFROG : CFL_PAPER;
    if (valid && scene->n_fluid == 0 && scene->n_solid == 0)
        return bad_line(r, 1,
                        "nothing to simulate: the case needs a [fluid NAME] or a [solid NAME] "
                        "section");
    if (case_sound(r, SECTION_numerics, 0)) TRY(case_go_on(r, check_solid_h(r)));
    if (case_sound(r, SECTION_top, 0)) TRY(case_go_on(r, check_gravity(r)));
    if (case_sound(r, SECTION_relax, 0) && case_all_sound(r, SECTION_motion))
        TRY(case_go_on(r, check_relax(r)));
    if (numerics && case_sound(r, SECTION_top, 0) && case_all_sound(r, SECTION_fluid))
        TRY(case_go_on(r, check_fluids(r)));
    TRY(check_sections(r));
    return valid ? case_check_effects(r) : ERR_OK;
}
