/* SPDX-License-Identifier: MIT
 * Which effects require or exclude each other. */
#include "case/case.h"
#include "case/effects.h"

#include <stdio.h>

/* What goes together and what does not: the one calls for the other, which the case must name, or
 * not both. */
static const struct rule {
    enum effect effect;
    enum { NEEDS, EXCLUDES } verb;
    enum effect other;
    const char *reason;
} rules[] = {
    {EFFECT_NO_SLIP, NEEDS, EFFECT_LAMINAR, "fluid sticks to surfaces by its laminar viscosity"},
    {EFFECT_CONTACT, EXCLUDES, EFFECT_PERIODIC, "contact is not computed through periodic sides"},
    {EFFECT_PERIODIC, NEEDS, EFFECT_FLUID, "only fluid can pass through periodic sides"},
    {EFFECT_LAMINAR, EXCLUDES, EFFECT_VERLET,
     "two-step Verlet is unstable with laminar viscosity; use integrator = leapfrog or symplectic"},
    {EFFECT_CONTACT, NEEDS, EFFECT_SOLID, "walls do not interact with each other"},
    {EFFECT_INFLOW, NEEDS, EFFECT_FLUID, "fluid enters through it"},
    {EFFECT_OUTFLOW, NEEDS, EFFECT_FLUID, "fluid leaves through it"},
    {EFFECT_LOAD, NEEDS, EFFECT_SOLID, "a load acts on a body"},
    {EFFECT_RIGID, EXCLUDES, EFFECT_PERIODIC, "a rigid body does not pass through periodic sides"},
    {EFFECT_RIGID, EXCLUDES, EFFECT_RELAX, "a rigid body moves while rest is sought"},
    {EFFECT_RELAX, EXCLUDES, EFFECT_INFLOW, "flow through a boundary is no state of rest"},
    {EFFECT_RELAX, EXCLUDES, EFFECT_OUTFLOW, "flow through a boundary is no state of rest"},
};

/* A key that means nothing without its effect: refused where the effect is off and the key has a
 * value other than its default, unless the scheme gave it. */
static const struct owned {
    enum section_id section;
    const char *key;
    enum effect effect;
} owned[] = {
    {SECTION_relax, "limit", EFFECT_RELAX},
    {SECTION_fluid, "diffusion_form", EFFECT_DIFFUSION},
    {SECTION_fluid, "diffusion_limiter", EFFECT_DIFFUSION},
    {SECTION_fluid, "wall_damping", EFFECT_REPULSION},
    {SECTION_fluid, "shifting_speed", EFFECT_SHIFTING},
    {SECTION_solid, "hourglass_form", EFFECT_HOURGLASS},
    {SECTION_solid, "viscosity_form", EFFECT_SOLID_VISCOSITY},
};

/* The line of the key that activates an effect; for a default, that of the start of the file. */
static int line_of(const struct scene *scene, const struct effect_caller *by)
{
    const int line = scene_line(scene, by->section, by->index, by->key);
    return line == LINE_NONE ? 1 : line;
}

static enum err check_rule(struct reader *r, const struct rule *rule)
{
    const struct scene *const scene = r->scene;
    struct effect_caller by, other;
    if (!effect_called(scene, rule->effect, &by)) return ERR_OK;
    if (effect_called(scene, rule->other, &other) != (rule->verb == EXCLUDES)) return ERR_OK;
    const struct effect_info *const effect = &effect_table[rule->effect],
                                    *const its = &effect_table[rule->other];
    char text[TITLE_TEXT], its_text[TITLE_TEXT];
    effect_caller_name(scene, &by, text);
    if (rule->verb == NEEDS)
        return bad_line(r, line_of(scene, &by), "%s enables the effect %s, which needs %s (%s): %s",
                        text, effect->name, its->name, its->key, rule->reason);
    return bad_line(r, line_of(scene, &by),
                    "%s enables the effect %s, which excludes %s (enabled by %s in line %d): %s",
                    text, effect->name, its->name, effect_caller_name(scene, &other, its_text),
                    line_of(scene, &other), rule->reason);
}

static enum err check_owned(struct reader *r, const struct owned *row)
{
    const struct scene *const scene = r->scene;
    const struct param *const param = param_find(row->section, row->key);
    const struct effect_info *const effect = &effect_table[row->effect];
    struct effect_caller by;
    if (effect_called(scene, row->effect, &by)) return ERR_OK;
    for (int k = 0; k < section_count(scene, row->section); k++) {
        const void *const section = section_at(scene, row->section, k);
        char text[TITLE_TEXT];
        double value;
        if (param_is_default(param, section) ||
            (scene_scheme_sets(scene, row->section, row->key, &value) &&
             param_number(param, section) == value))
            continue;
        by = (struct effect_caller){row->section, k, row->key};
        effect_caller_name(scene, &by, text);
        TRY(case_go_on(r, bad_line(r, line_of(scene, &by),
                                   "%s has no effect without %s: leave it out, or enable %s by %s",
                                   text, effect->name, effect->name, effect->key)));
    }
    return ERR_OK;
}

enum err case_check_effects(struct reader *r)
{
    const char *const left_out = effect_left_out(r->scene);
    if (left_out)
        return bad_line(r, 1,
                        "the case enables the effect %s, but this program was compiled without it; "
                        "build it without -DSPHFSI_WITHOUT",
                        left_out);
    for (size_t k = 0; k < COUNT_OF(rules); k++) TRY(case_go_on(r, check_rule(r, &rules[k])));
    for (size_t k = 0; k < COUNT_OF(owned); k++) TRY(case_go_on(r, check_owned(r, &owned[k])));
    return ERR_OK;
}
