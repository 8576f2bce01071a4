/* SPDX-License-Identifier: MIT
 * Defaults that follow from `scheme` and `accuracy` (case/presets.def). */
#include "case/case.h"

#include <string.h>

enum { ANY = -1 };

static enum scene_kind kind_of_scene(const struct scene *s)
{
    return s->n_fluid && s->n_solid ? SCENE_COUPLED : s->n_fluid ? SCENE_FLUID : SCENE_SOLID;
}

/* A row of case/presets.def: a value that replaces a default. */
static const struct preset {
    bool of_scheme; /* chosen by `scheme`, not by `accuracy` */
    int kind;       /* enum scene_kind; SCENE_EITHER: with fluid */
    int choice;
    int integrator; /* that the case uses; ANY: whichever */
    enum section_id section;
    const char *key;
    double value;
} presets[] = {
#define SCHEME(scene, scheme, section, key, value) \
    {true, SCENE_##scene, SCHEME_##scheme, ANY, SECTION_##section, #key, value},
#define PRESET(scene, accuracy, integrator, section, key, value) \
    {false, SCENE_##scene, ACCURACY_##accuracy, integrator, SECTION_##section, #key, value},
#include "case/presets.def"
};

static bool preset_is_for(const struct preset *row, enum scene_kind kind)
{
    return row->kind == SCENE_EITHER ? kind != SCENE_SOLID : row->kind == (int)kind;
}

bool scheme_sets(enum scheme scheme, enum scene_kind kind, enum section_id section, const char *key,
                 double *value)
{
    for (size_t k = 0; k < COUNT_OF(presets); k++) {
        const struct preset *const row = &presets[k];
        if (!row->of_scheme || row->choice != (int)scheme || row->section != section) continue;
        if (!preset_is_for(row, kind) || strcmp(row->key, key) != 0) continue;
        *value = row->value;
        return true;
    }
    return false;
}

bool scene_scheme_sets(const struct scene *s, enum section_id section, const char *key,
                       double *value)
{
    return scheme_sets((enum scheme)s->top.scheme, kind_of_scene(s), section, key, value);
}

/* The value of a choice at the top of the file, before it is read; the reader reports an invalid
 * word. */
static int top_choice(const struct reader *r, const char *key)
{
    const struct param *const p = param_find(SECTION_top, key);
    int found = (int)p->number.value;
    for (int k = 0; k < r->n_entries; k++) {
        const struct entry *const e = &r->entries[k];
        char name[SCENE_NAME];
        if (r->sections[e->section].id != SECTION_top || strcmp(e->key, key) != 0) continue;
        int last = 0;
        for (const char *at = p->choices; (at = strchr(at, '|')) != NULL; at++) last++;
        for (int c = 0; c <= last; c++) {
            param_choice_name(p, c, name);
            if (strcmp(e->value, name) == 0) found = c;
        }
    }
    return found;
}

/* A wrong word is found where the key is read. */
void case_apply_presets(struct reader *r)
{
    const int accuracy = top_choice(r, "accuracy"), integrator = top_choice(r, "integrator"),
              scheme = top_choice(r, "scheme");
    for (size_t k = 0; k < COUNT_OF(presets); k++) {
        const struct preset *const row = &presets[k];
        if (!preset_is_for(row, kind_of_scene(r->scene))) continue;
        if (row->choice != (row->of_scheme ? scheme : accuracy)) continue;
        if (row->integrator != ANY && row->integrator != integrator) continue;
        const struct param *const p = param_find(row->section, row->key);
        for (int i = 0; i < section_count(r->scene, row->section); i++) {
            char *const place = (char *)section_at(r->scene, row->section, i) + p->offset;
            if (p->type == PARAM_REAL)
                memcpy(place, &row->value, sizeof row->value);
            else
                *(int *)(void *)place = (int)row->value;
        }
    }
}
