/* SPDX-License-Identifier: MIT
 * Which effects a scene activates, and which of them require or exclude each other. */
#include "case/effects.h"
#include "case/case.h"

const struct effect_info effect_table[EFFECT_COUNT] = {
#define EFFECT(name, when, key, equation, groups, kind, pairs, meaning) \
    {#name, key, equation, meaning, groups, KIND_##kind},
#include "case/effects.def"
};

/* --- conditions of effects --- */

/* Stores the place of the condition if `at` is one, and returns whether it is. */
static bool enabled_by(struct effect_source *source, enum section_id section, const char *key,
                       int at)
{
    if (at < 0) return false;
    *source = (struct effect_source){section, at, key};
    return true;
}

/* Whether a section has a value above 0, a text, or the choice `choice` (below 0: any but the
 * first). */
static bool has_set(const struct scene *scene, struct effect_source *source, enum section_id id,
                    const char *key, int choice)
{
    const struct param *const param = param_find(id, key);
    for (int k = 0; k < section_count(scene, id); k++) {
        const char *const section = section_at(scene, id, k);
        const double set =
            param->type == PARAM_TEXT ? section[param->offset] : param_number(param, section);
        if (choice < 0 ? set > 0 : set == choice) return enabled_by(source, id, param->key, k);
    }
    return false;
}

/* The first two bodies in contact, the second from `first` on, walls after solids. */
static bool meets(const struct scene *scene, struct effect_source *source, int first)
{
    for (int a = 0; a < scene->n_solid; a++)
        for (int b = a > first ? a : first; b < scene->n_solid + scene->n_wall; b++) {
            const struct scene_contact *const c = scene_contact_of(scene, a, b);
            if (c == &scene->contact_default) return enabled_by(source, SECTION_solid, "", a);
            if (c) return enabled_by(source, SECTION_contact, "", (int)(c - scene->contact));
        }
    return false;
}

static bool has_gravity(const struct scene *scene, struct effect_source *source)
{
    const struct scene_expr *const e = &scene->top.gravity_in_time;
    const bool acts =
        scene->top.gravity[0] != 0 || scene->top.gravity[1] != 0 || e->e[0] || e->e[1];
    return enabled_by(source, SECTION_top, "gravity", acts ? 0 : -1);
}

/* The first probe of the force on a wall; -1: none. */
static int first_wall_force(const struct scene *scene)
{
    char name[SCENE_TEXT];
    for (int k = 0; k < scene->n_probe; k++)
        for (int n = 0;
             scene->probe[k].quantity == PROBE_FORCE && scene_listed(scene->probe[k].body, n, name);
             n++)
            if (scene_find(scene, SECTION_solid, name) < 0) return k;
    return -1;
}

static bool compressed_at_start(const struct scene *scene, struct effect_source *source)
{
    for (int k = 0; k < scene->n_fluid; k++)
        if (scene->fluid[k].particle_mass == MASS_HYDROSTATIC &&
            (!isnan(scene->fluid[k].surface) || scene->fluid[k].pressure.e[0]))
            return enabled_by(source, SECTION_fluid, "particle_mass", k);
    return false;
}

bool effect_enabled(const struct scene *scene, enum effect effect, struct effect_source *source)
{
#define SOME(section) enabled_by(source, SECTION_##section, "", scene->n_##section > 0 ? 0 : -1)
#define SET(section, key) has_set(scene, source, SECTION_##section, #key, -1)
#define CHOSEN(section, key, choice) has_set(scene, source, SECTION_##section, #key, choice)
#define COMPRESSED_AT_START compressed_at_start(scene, source)
#define MEETS meets(scene, source, 0)
#define MEETS_WALL meets(scene, source, scene->n_solid)
#define HAS_GRAVITY has_gravity(scene, source)
#define PROBES_WALL enabled_by(source, SECTION_probe, "quantity", first_wall_force(scene))
#define THIN_LINES \
    enabled_by(source, SECTION_wall, "shape", scene->n_thin > 0 ? scene->thin[0].wall : -1)
#define LATER false
#define EFFECT(name, when, ...) \
    if (effect == EFFECT_##name) return when;
#include "case/effects.def"
    return false;
}

static const effect_set effect_bits[EFFECT_COUNT] = {
#define EFFECT(name, when, key, equation, groups, kind, pairs, meaning) FX_##name,
#include "case/effects.def"
};

effect_set effects_of_scene(const struct scene *scene)
{
    effect_set effects = 0;
    struct effect_source source;
    for (int k = 0; k < EFFECT_COUNT; k++)
        if (effect_enabled(scene, (enum effect)k, &source)) effects |= effect_bits[k];
    return effects;
}

/* "[wall bed] slip", or "integrator"; "[rigid raft]", which is a wall without such a key. */
static struct section_title source_name(const struct scene *scene,
                                        const struct effect_source *source)
{
    struct section_title name;
    const bool top = source->section == SECTION_top;
    const struct scene_section_common *const of = section_at(scene, source->section, source->index);
    const bool keyed = top || param_find((enum section_id)of->section, source->key);
    snprintf(name.text, sizeof name.text, "%.90s%s%.60s", top ? "" : section_title(of).text,
             !top && keyed ? " " : "", keyed ? source->key : "");
    return name;
}

struct source_text effect_source_text(const struct scene *scene, const struct effect_source *source)
{
    const struct scene_given *const given =
        scene_given(scene, source->section, source->index, source->key);
    const struct scene_section_common *const section =
        section_at(scene, source->section, source->index);
    struct source_text to;
    char line[32];
    snprintf(line, sizeof line, "line %d", given ? given->line : section->line);
    snprintf(to.text, sizeof to.text, "%s: %s",
             given && given->line == 0                       ? "--set"
             : given || section_table[source->section].named ? line
                                                             : "default",
             source_name(scene, source).text);
    return to;
}

unsigned effects_groups(effect_set effects, enum kind kind)
{
    unsigned groups = 0;
    for (int k = 0; k < EFFECT_COUNT; k++)
        if ((effects & EFFECT_BIT(k)) && effect_table[k].kind == kind)
            groups |= effect_table[k].groups;
    return groups;
}

/* --- phases --- */

const struct phase_info phase_table[PHASE_COUNT] = {
#define PHASE(name, when, meaning) {#name, meaning, when},
    PHASES(PHASE)
#undef PHASE
};

/* --- checks --- */

/* What goes together and what does not: the one needs the other in the case, or excludes it. */
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
    {EFFECT_DAMPING_ZONE, NEEDS, EFFECT_FLUID, "it damps the fluid"},
    {EFFECT_RIGID, EXCLUDES, EFFECT_PERIODIC, "a rigid body does not pass through periodic sides"},
    {EFFECT_RIGID, EXCLUDES, EFFECT_RELAX,
     "[relax] does not find the state of rest of a rigid body; leave [relax] out"},
    {EFFECT_BEAM, EXCLUDES, EFFECT_RELAX,
     "[relax] does not find the state of rest of a beam; leave [relax] out and let `mass_damping` "
     "of the [beam] and `artificial_viscosity` bring the beam to rest"},
    {EFFECT_BEAM, EXCLUDES, EFFECT_PERIODIC,
     "a beam does not pass through periodic sides; use walls or a longer [domain] without "
     "`periodic`"},
    {EFFECT_RELAX, EXCLUDES, EFFECT_INFLOW, "flow through a boundary never comes to rest"},
    {EFFECT_RELAX, EXCLUDES, EFFECT_OUTFLOW, "flow through a boundary never comes to rest"},
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
static int line_of(const struct scene *scene, const struct effect_source *source)
{
    const int line = key_line(scene, source->section, source->index, source->key);
    return line == LINE_NONE ? 1 : line;
}

static enum err check_rule(struct reader *r, const struct rule *rule)
{
    const struct scene *const scene = r->scene;
    struct effect_source source, other;
    if (!effect_enabled(scene, rule->effect, &source)) return ERR_OK;
    if (effect_enabled(scene, rule->other, &other) != (rule->verb == EXCLUDES)) return ERR_OK;
    const struct effect_info *const effect = &effect_table[rule->effect],
                                    *const its = &effect_table[rule->other];
    const struct section_title text = source_name(scene, &source);
    if (rule->verb == NEEDS)
        return bad_line(r, line_of(scene, &source),
                        "%s enables the effect %s, which needs %s (%s): %s", text.text,
                        effect->name, its->name, its->key, rule->reason);
    return bad_line(r, line_of(scene, &source),
                    "%s enables the effect %s, which excludes %s (enabled by %s in line %d): %s",
                    text.text, effect->name, its->name, source_name(scene, &other).text,
                    line_of(scene, &other), rule->reason);
}

static enum err check_owned(struct reader *r, const struct owned *row)
{
    const struct scene *const scene = r->scene;
    const struct param *const param = param_find(row->section, row->key);
    const struct effect_info *const effect = &effect_table[row->effect];
    struct effect_source source;
    if (effect_enabled(scene, row->effect, &source)) return ERR_OK;
    for (int k = 0; k < section_count(scene, row->section); k++) {
        const void *const section = section_at(scene, row->section, k);
        double value;
        if (param_is_default(param, section) ||
            (scene_scheme_sets(scene, row->section, row->key, &value) &&
             param_number(param, section) == value))
            continue;
        source = (struct effect_source){row->section, k, row->key};
        TRY(case_go_on(r, bad_line(r, line_of(scene, &source),
                                   "%s has no effect without %s: leave it out, or enable %s by %s",
                                   source_name(scene, &source).text, effect->name, effect->name,
                                   effect->key)));
    }
    return ERR_OK;
}

enum err case_check_effects(struct reader *r)
{
    struct effect_source source;
    for (int k = 0; k < EFFECT_COUNT; k++)
        if (effect_bits[k] == 0 && effect_enabled(r->scene, (enum effect)k, &source))
            return bad_line(r, 1,
                            "the case enables the effect %s, but this program was compiled without "
                            "it; build it without -DSPHFSI_WITHOUT",
                            effect_table[k].name);
    for (size_t k = 0; k < COUNT_OF(rules); k++) TRY(case_go_on(r, check_rule(r, &rules[k])));
    for (size_t k = 0; k < COUNT_OF(owned); k++) TRY(case_go_on(r, check_owned(r, &owned[k])));
    return ERR_OK;
}
