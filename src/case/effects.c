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

/* --- conditions of effects: the words of case/effects.def --- */

/* Stores the place of the condition if `at` is one, and returns whether it is. */
static bool called_by(struct effect_caller *by, enum section_id section, const char *key, int at)
{
    if (at < 0) return false;
    *by = (struct effect_caller){section, at, key};
    return true;
}

#define SOME(section) called_by(by, SECTION_##section, "", s->n_##section > 0 ? 0 : -1)
#define ONE(section, key, test) called_by(by, SECTION_##section, #key, s->section.key test ? 0 : -1)
#define ANY(section, key, test)                                      \
    called_by(by, SECTION_##section, #key, __extension__({           \
                  int at = -1;                                       \
                  for (int k = 0; k < s->n_##section && at < 0; k++) \
                      if (s->section[k].key test) at = k;            \
                  at;                                                \
              }))
#define LATER false
#define MEETS meets(s, by, 0)
#define MEETS_WALL meets(s, by, s->n_solid)
#define HAS_GRAVITY                                                               \
    called_by(by, SECTION_top, *s->top.gravity_file ? "gravity_file" : "gravity", \
              has_gravity(s) ? 0 : -1)
#define PROBES_WALL called_by(by, SECTION_probe, "quantity", first_wall_force(s))

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

static bool has_gravity(const struct scene *s)
{
    const struct scene_expr *const e = &s->top.gravity_in_time;
    return s->top.gravity[0] != 0 || s->top.gravity[1] != 0 || e->e[0] || e->e[1] ||
           *s->top.gravity_file;
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

#define EFFECT(name, when, key, equation, groups, kind, pairs, meaning)           \
    static bool calls_for_##name(const struct scene *s, struct effect_caller *by) \
    {                                                                             \
        (void)s, (void)by;                                                        \
        return when;                                                              \
    }
#include "case/effects.def"
#undef EFFECT

bool effect_called(const struct scene *s, enum effect effect, struct effect_caller *by)
{
    static bool (*const calls[EFFECT_COUNT])(const struct scene *, struct effect_caller *) = {
#define EFFECT(name, when, key, equation, groups, kind, pairs, meaning) calls_for_##name,
#include "case/effects.def"
#undef EFFECT
    };
    return calls[effect](s, by);
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
#define PHASE(name, when, meaning) {#name, meaning, when},
#include "case/phases.def"
#undef PHASE
};

const char *effect_left_out(const struct scene *s)
{
    struct effect_caller by;
    for (int k = 0; k < EFFECT_COUNT; k++)
        if (effect_bits[k] == 0 && effect_called(s, (enum effect)k, &by))
            return effect_table[k].name;
    return NULL;
}
