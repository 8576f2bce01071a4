/* SPDX-License-Identifier: MIT */
#include "case/effects.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const struct effect_info effect_table[EFFECT_COUNT] = {
#define EFFECT(name, when, key, equation, groups, kind, pairs, meaning) \
    {#name, key, equation, meaning, groups, KIND_##kind},
#include "case/effects.def"
#undef EFFECT
};

/* --- conditions of effects --- */

/* Stores the place of the condition if `at` is one, and returns whether it is. */
static bool called_by(struct effect_caller *by, enum section_id section, const char *key, int at)
{
    if (at < 0) return false;
    *by = (struct effect_caller){section, at, key};
    return true;
}

/* Whether a section has a value above 0, a choice other than its first, or a text; with `choice` at
 * least 0: that choice. */
static bool has_set(const struct scene *s, struct effect_caller *by, enum section_id id,
                    const char *key, int choice)
{
    const struct param *const p = param_find(id, key);
    for (int k = 0; k < section_count(s, id); k++) {
        const void *const value = (const char *)section_at(s, id, k) + p->offset;
        const double set = p->type == PARAM_REAL   ? *(const double *)value
                           : p->type == PARAM_TEXT ? *(const char *)value
                                                   : *(const int *)value;
        if (choice < 0 ? set > 0 : set == choice) return called_by(by, id, p->key, k);
    }
    return false;
}

/* The first two bodies in contact, the second from `first` on, walls after solids. */
static bool meets(const struct scene *s, struct effect_caller *by, int first)
{
    for (int a = 0; a < s->n_solid; a++)
        for (int b = a > first ? a : first; b < s->n_solid + s->n_wall; b++) {
            const struct scene_contact *const c = scene_contact_of(s, a, b);
            if (c == &s->contact_default) return called_by(by, SECTION_solid, "", a);
            if (c) return called_by(by, SECTION_contact, "", (int)(c - s->contact));
        }
    return false;
}

static bool has_gravity(const struct scene *s, struct effect_caller *by)
{
    const struct scene_expr *const e = &s->top.gravity_in_time;
    const bool table = *s->top.gravity_file;
    const bool acts = s->top.gravity[0] != 0 || s->top.gravity[1] != 0 || e->e[0] || e->e[1];
    return called_by(by, SECTION_top, table ? "gravity_file" : "gravity", table || acts ? 0 : -1);
}

/* The first probe of the force on a wall; -1: none. */
static int first_wall_force(const struct scene *s)
{
    char name[SCENE_TEXT];
    for (int k = 0; k < s->n_probe; k++)
        for (int n = 0;
             s->probe[k].quantity == PROBE_FORCE && scene_listed(s->probe[k].body, n, name); n++)
            if (scene_find_solid(s, name) < 0) return k;
    return -1;
}

static bool compressed_at_start(const struct scene *s, struct effect_caller *by)
{
    for (int k = 0; k < s->n_fluid; k++)
        if (s->fluid[k].particle_mass == MASS_HYDROSTATIC &&
            (!isnan(s->fluid[k].surface) || s->fluid[k].pressure.e[0]))
            return called_by(by, SECTION_fluid, "particle_mass", k);
    return false;
}

bool effect_called(const struct scene *s, enum effect effect, struct effect_caller *by)
{
#define SOME(section) called_by(by, SECTION_##section, "", s->n_##section > 0 ? 0 : -1)
#define SET(section, key) has_set(s, by, SECTION_##section, #key, -1)
#define CHOSEN(section, key, choice) has_set(s, by, SECTION_##section, #key, choice)
#define COMPRESSED_AT_START compressed_at_start(s, by)
#define MEETS meets(s, by, 0)
#define MEETS_WALL meets(s, by, s->n_solid)
#define HAS_GRAVITY has_gravity(s, by)
#define PROBES_WALL called_by(by, SECTION_probe, "quantity", first_wall_force(s))
#define LATER false
    switch (effect) {
#define EFFECT(name, when, key, equation, groups, kind, pairs, meaning) \
    case EFFECT_##name:                                                 \
        return when;
#include "case/effects.def"
#undef EFFECT
    case EFFECT_COUNT: break;
    }
    return false;
}

static const effect_set effect_bits[EFFECT_COUNT] = {
#define EFFECT(name, when, key, equation, groups, kind, pairs, meaning) FX_##name,
#include "case/effects.def"
#undef EFFECT
};

effect_set effects_of_scene(const struct scene *s)
{
    effect_set fx = 0;
    struct effect_caller by;
    for (int k = 0; k < EFFECT_COUNT; k++)
        if (effect_called(s, (enum effect)k, &by)) fx |= effect_bits[k];
    return fx;
}

void effect_caller_text(const struct scene *s, const struct effect_caller *by,
                        char text[EFFECT_CALLER_TEXT])
{
    const struct section_info *const info = &section_table[by->section];
    const struct scene_section_common *const section = section_at(s, by->section, by->index);
    const struct scene_given *const given = scene_given(s, by->section, by->index, by->key);
    char where[32], name[2 * SCENE_NAME] = "";
    snprintf(where, sizeof where, "line %d", given ? given->line : section->line);
    if (given && given->line == 0) strcpy(where, "--set");
    if (!given && !info->named) strcpy(where, "default");
    if (by->section != SECTION_top)
        snprintf(name, sizeof name, "[%s%s%s]%s", info->word, info->named ? " " : "", section->name,
                 *by->key ? " " : "");
    snprintf(text, EFFECT_CALLER_TEXT, "%s: %s%s", where, name, by->key);
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
    [PHASE_sort] = {"sort", "sorting particles into cells", FX_FLUID},
    [PHASE_open] = {"open", "buffers of open boundaries", FX_OPEN},
    [PHASE_packed] = {"packed", "equation of state and packed copies of the fields", FX_FLUID},
    [PHASE_slope] = {"slope", "gradients of the density", FX_ANTUONO},
    [PHASE_wall] = {"wall", "pressure and velocity of walls and structures for the fluid",
                    FX_WALL | FX_COUPLING},
    [PHASE_fluid] = {"fluid", "forces on fluid particles", FX_FLUID},
    [PHASE_shift] = {"shift", "particle shifting", FX_SHIFTING},
    [PHASE_solid] = {"solid", "deformation, stress and forces of the solid", FX_SOLID},
    [PHASE_contact] = {"contact", "search for contact and contact forces", FX_CONTACT},
    [PHASE_update] = {"update", "time integration, bounds, guards", FX_ALWAYS},
    [PHASE_output] = {"output", "probes, ledger, snapshots, checkpoints", FX_ALWAYS},
};

const char *effect_left_out(const struct scene *s)
{
    struct effect_caller by;
    for (int k = 0; k < EFFECT_COUNT; k++)
        if (effect_bits[k] == 0 && effect_called(s, (enum effect)k, &by))
            return effect_table[k].name;
    return NULL;
}
