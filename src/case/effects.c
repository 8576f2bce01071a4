/* SPDX-License-Identifier: MIT */
#include "case/effects.h"

#include <stdio.h>
#include <string.h>

const struct effect_info effect_table[EFFECT_COUNT] = {
#define EFFECT(name, when, key, equation, groups, kind, meaning) \
    {#name, key, equation, meaning, groups, KIND_##kind},
#include "case/effects.def"
#undef EFFECT
};

/* --- what calls for an effect: the words of case/effects.def --- */

/* Notes the place where `at` is one, and says whether it is. */
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
#define TOUCHES_WALL called_by(by, SECTION_contact, "", first_with_wall(s))
#define PROBES_WALL called_by(by, SECTION_probe, "quantity", first_wall_force(s))

/* The first contact that a wall takes part in; -1: none. */
static int first_with_wall(const struct scene *s)
{
    for (int k = 0; k < s->n_contact; k++) {
        char name[2][SCENE_TEXT];
        if (!scene_pair(s->contact[k].between, name)
                ? s->n_wall > 0
                : scene_find_solid(s, name[0]) < 0 || scene_find_solid(s, name[1]) < 0)
            return k;
    }
    return -1;
}

/* The first probe of the force on a wall; -1: none. */
static int first_wall_force(const struct scene *s)
{
    for (int k = 0; k < s->n_probe; k++)
        if (s->probe[k].quantity == PROBE_FORCE && scene_find_solid(s, s->probe[k].body) < 0)
            return k;
    return -1;
}

#define EFFECT(name, when, key, equation, groups, kind, meaning)                  \
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
#define EFFECT(name, when, key, equation, groups, kind, meaning) calls_for_##name,
#include "case/effects.def"
#undef EFFECT
    };
    return calls[effect](s, by);
}

static const unsigned effect_bits[EFFECT_COUNT] = {
#define EFFECT(name, when, key, equation, groups, kind, meaning) FX_##name,
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

unsigned effects_groups(effect_set effects, enum kind kind, int integrator)
{
    unsigned groups = 0;
    for (int k = 0; k < EFFECT_COUNT; k++)
        if ((effects & EFFECT_BIT(k)) && effect_table[k].kind == kind)
            groups |= effect_table[k].groups;
    if (!groups) return 0;
    if (kind == KIND_FLUID && integrator == INTEGRATOR_SYMPLECTIC)
        groups |= G_STAGE | G_STAGE_FLUID;
    if (kind == KIND_SOLID) groups |= G_STAGE;
    return groups;
}

/* --- phases --- */

const struct phase_info phase_table[PHASE_COUNT] = {
#define PHASE(name, when, meaning) {#name, meaning, when},
#include "case/phases.def"
#undef PHASE
};

/* --- rules --- */

struct rule {
    enum effect effect, other;
    bool excludes;
    const char *reason;
};

static const struct rule rules[] = {
#define NEEDS(effect, other, reason) {EFFECT_##effect, EFFECT_##other, false, reason},
#define EXCLUDES(effect, other, reason) {EFFECT_##effect, EFFECT_##other, true, reason},
#include "case/rules.def"
};

/* A key that belongs to an effect. */
struct owned {
    enum section_id section;
    const char *key;
    enum effect effect;
};

static const struct owned owned[] = {
#define OWNED(section, key, effect) {SECTION_##section, #key, EFFECT_##effect},
#include "case/rules.def"
};

static enum err check_rule(const struct scene *s, const struct rule *rule, struct diag *d)
{
    struct effect_caller by, other;
    if (!effect_called(s, rule->effect, &by)) return ERR_OK;
    if (effect_called(s, rule->other, &other) != rule->excludes) return ERR_OK;
    char text[EFFECT_CALLER_TEXT], place[EFFECT_CALLER_TEXT];
    effect_caller_text(s, &by, text);
    const char *const name = effect_table[rule->effect].name;
    const char *const its = effect_table[rule->other].name;
    if (!rule->excludes)
        return diag_fail(d, ERR_INPUT, "%s, %s calls for %s, which needs %s (%s): %s", s->path,
                         text, name, its, effect_table[rule->other].key, rule->reason);
    effect_caller_text(s, &other, place);
    return diag_fail(d, ERR_INPUT, "%s, %s calls for %s, which excludes %s, called for by %s: %s",
                     s->path, text, name, its, place, rule->reason);
}

static enum err check_owned(const struct scene *s, const struct owned *row, struct diag *d)
{
    const struct param *const p = param_find(row->section, row->key);
    struct effect_caller by;
    if (effect_called(s, row->effect, &by)) return ERR_OK;
    for (int k = 0; k < section_count(s, row->section); k++) {
        if (param_is_default(p, section_at(s, row->section, k))) continue;
        char text[EFFECT_CALLER_TEXT];
        by = (struct effect_caller){row->section, k, row->key};
        effect_caller_text(s, &by, text);
        return diag_fail(d, ERR_INPUT,
                         "%s, %s is of %s, which the scene does not have: %s calls "
                         "for it",
                         s->path, text, effect_table[row->effect].name,
                         effect_table[row->effect].key);
    }
    return ERR_OK;
}

enum err effects_check(const struct scene *s, struct diag *d)
{
    struct effect_caller by;
    for (int k = 0; k < EFFECT_COUNT; k++)
        if (effect_bits[k] == 0 && effect_called(s, (enum effect)k, &by))
            return diag_fail(d, ERR_INPUT, "%s calls for %s, which this build is without", s->path,
                             effect_table[k].name);
    for (size_t k = 0; k < COUNT_OF(rules); k++) TRY(check_rule(s, &rules[k], d));
    for (size_t k = 0; k < COUNT_OF(owned); k++) TRY(check_owned(s, &owned[k], d));
    return ERR_OK;
}
