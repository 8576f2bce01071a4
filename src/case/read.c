/* SPDX-License-Identifier: MIT
 * From a case file to a scene: defaults, values in the order of the file, checks. */
#include "base/files.h"
#include "case/case.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* --- sections --- */

static void set_defaults(void *section, enum section_id id)
{
    for (int k = 0; k < PARAM_COUNT; k++) {
        const struct param *param = &param_table[k];
        if (param->section != id) continue;
        char *const place = (char *)section + param->offset;
        switch (param->type) {
        case PARAM_REAL: memcpy(place, &param->number.value, sizeof(double)); break;
        case PARAM_VECTOR:
        case PARAM_TIME_VECTOR: memcpy(place, param->vector_default, 2 * sizeof(double)); break;
        case PARAM_INTEGER:
        case PARAM_CHOICE: *(int *)(void *)place = (int)param->number.value; break;
        case PARAM_TEXT: snprintf(place, SCENE_TEXT, "%s", param->text_default); break;
        case PARAM_FIELD_EXPR:
        case PARAM_TIME_EXPR:
        case PARAM_FLOW_EXPR:
        case PARAM_SHAPES:
        case PARAM_NUMBERS: break; /* absent */
        }
    }
}

static enum err allocate_sections(struct reader *r)
{
    struct scene *scene = r->scene;
    int count[SECTION_COUNT] = {0};
    for (int k = 0; k < r->n_sections; k++)
        if (r->sections[k].id < SECTION_COUNT) count[r->sections[k].id]++;
    for (int id = 0; id < SECTION_COUNT; id++) {
        const struct section_info *info = &section_table[id];
        if (info->named) {
            void *array =
                arena_alloc(&scene->arena, (size_t)count[id], info->size, "sections", r->diag);
            if (!array) return ERR_MEMORY;
            memcpy((char *)scene + info->offset, &array, sizeof array);
            memcpy((char *)scene + info->count_offset, &count[id], sizeof count[id]);
        }
        for (int k = 0; k < section_count(scene, (enum section_id)id); k++)
            set_defaults(section_at(scene, (enum section_id)id, k), (enum section_id)id);
    }
    set_defaults(&scene->contact_default, SECTION_contact);
    for (int k = 0; k < r->n_sections; k++) {
        const struct case_section *from = &r->sections[k];
        if (from->id == SECTION_constants) continue;
        struct scene_section_common *common =
            section_at(scene, (enum section_id)from->id, from->index);
        snprintf(common->name, sizeof common->name, "%s", from->name);
        common->line = from->line;
    }
    return ERR_OK;
}

/* `like = NAME`: the values of an earlier section of the kind become the defaults. Its regions do
 * not, since two bodies cannot be in the same place. */
static enum err inherit(struct reader *r, int section)
{
    struct case_section *to = &r->sections[section];
    const struct param *like = param_find((enum section_id)to->id, "like");
    const struct entry *e = NULL;
    for (int k = 0; like && k < r->n_entries; k++)
        if (r->entries[k].section == section && strcmp(r->entries[k].key, "like") == 0)
            e = &r->entries[k];
    if (!e) return ERR_OK;
    char *const target = section_at(r->scene, (enum section_id)to->id, to->index);
    TRY(case_value(r, e, like, target));
    struct nearest near = {0};
    for (int k = 0; k < to->index; k++) {
        const char *source = section_at(r->scene, (enum section_id)to->id, k);
        const struct scene_section_common *common = (const void *)source;
        nearest_offer(&near, target + like->offset, common->name);
        if (strcmp(common->name, target + like->offset) != 0) continue;
        const size_t head = sizeof(struct scene_section_common);
        memcpy(target + head, source + head, section_table[to->id].size - head);
        memset(target + like->offset, 0, SCENE_TEXT);
        for (int n = 0; n < section; n++) /* what that section lacks is told of it alone */
            to->incomplete |= r->sections[n].id == to->id && r->sections[n].index == k &&
                              (r->sections[n].incomplete || r->sections[n].invalid);
        for (int p = 0; p < PARAM_COUNT; p++)
            if ((int)param_table[p].section == to->id && param_table[p].type == PARAM_SHAPES)
                memset(target + param_table[p].offset, 0, sizeof(struct shape_list));
        return ERR_OK;
    }
    if (r->lost) return ERR_INPUT; /* it may be defined in an invalid line */
    if (near.name)
        return bad_value(r, e, "there is no earlier [%s] of that name; did you mean `%s`?",
                         section_table[to->id].word, near.name);
    return bad_value(r, e, "there is no earlier [%s] of that name", section_table[to->id].word);
}

static enum err unknown_key(struct reader *r, const struct entry *e, int id)
{
    struct nearest near = {0};
    for (int k = 0; k < PARAM_COUNT; k++)
        if ((int)param_table[k].section == id) nearest_offer(&near, e->key, param_table[k].key);
    const char *word = id == SECTION_top ? "at the top of the file" : section_table[id].word;
    char place[80];
    snprintf(place, sizeof place, id == SECTION_top ? "%s" : "in [%s]", word);
    char meant[PARAM_MEANT];
    if (param_meant((enum section_id)id, e->key, meant))
        return bad_entry(r, e, "unknown key `%s` %s; did you mean %s?", e->key, place, meant);
    const struct param *const called = param_called(e->key);
    if (called)
        return bad_entry(r, e, "unknown key `%s` %s; did you mean `%s` %s%s%s?", e->key, place,
                         called->key, called->section == SECTION_top ? "at the top" : "in [",
                         called->section == SECTION_top ? "" : section_table[called->section].word,
                         called->section == SECTION_top ? "" : "]");
    for (int k = 0; k < PARAM_COUNT; k++)
        if (strcmp(param_table[k].key, e->key) == 0) {
            const bool top = param_table[k].section == SECTION_top;
            return bad_entry(r, e, "unknown key `%s` %s; it belongs %s%s%s", e->key, place,
                             top ? "at the top of the file" : "in [",
                             top ? "" : section_table[param_table[k].section].word, top ? "" : "]");
        }
    if (near.name)
        return bad_entry(r, e, "unknown key `%s` %s; did you mean `%s`?", e->key, place, near.name);
    return bad_entry(r, e, "unknown key `%s` %s", e->key, place);
}

/* A given surface replaces an inherited pressure, and a given pressure an inherited surface. */
static void drop_rivals(struct reader *r, int section)
{
    const struct case_section *cs = &r->sections[section];
    if (cs->id != SECTION_fluid) return;
    struct scene_fluid *f = &r->scene->fluid[cs->index];
    for (int k = 0; k < r->n_entries; k++) {
        if (r->entries[k].section != section) continue;
        if (strcmp(r->entries[k].key, "surface") == 0) f->pressure.e[0] = NULL;
        if (strcmp(r->entries[k].key, "pressure") == 0) f->surface = (double)NAN;
    }
}

/* `like` copies no regions: a copy of a clamped body that has neither a clamp of its own nor a bond
 * moves freely. */
static void warn_of_lost_clamp(struct reader *r, int section, const struct entry *like)
{
    const struct case_section *cs = &r->sections[section];
    if (cs->id != SECTION_solid || !like) return;
    const struct scene_solid *const copy = &r->scene->solid[cs->index];
    if (copy->joined[0]) return;
    for (int k = 0; k < cs->index; k++) {
        const struct scene_solid *const from = &r->scene->solid[k];
        if (strcmp(from->common.name, like->value) == 0 && from->clamp.n > 0 && copy->clamp.n == 0)
            warn_at(r->diag, r->scene, cs->line,
                    "[solid %s] is like [solid %s] but has no `clamp`, because `like` does "
                    "not copy regions, so it moves freely; give it a `clamp`",
                    copy->common.name, from->common.name);
    }
}

static enum err read_section(struct reader *r, int section)
{
    const struct case_section *cs = &r->sections[section];
    if (cs->id == SECTION_constants) return ERR_OK;
    const enum err inherited_well = inherit(r, section);
    TRY(case_go_on(r, inherited_well));
    if (inherited_well) r->sections[section].incomplete = r->sections[section].invalid = true;
    drop_rivals(r, section);
    const bool inherited = cs->id == SECTION_fluid || cs->id == SECTION_solid;
    void *const target = section_at(r->scene, (enum section_id)cs->id, cs->index);
    const struct entry *given[PARAM_COUNT] = {NULL};
    for (int k = 0; k < r->n_entries; k++) {
        const struct entry *e = &r->entries[k];
        if (e->section != section) continue;
        const struct param *param = param_find((enum section_id)cs->id, e->key);
        if (!param) {
            r->sections[section].incomplete = r->sections[section].invalid = true;
            TRY(case_go_on(r, unknown_key(r, e, cs->id)));
            continue;
        }
        const struct entry **before = &given[param - param_table];
        if (*before && param->type != PARAM_SHAPES) {
            r->sections[section].invalid = true;
            TRY(case_go_on(r,
                           bad_entry(r, e, "`%s` is given twice, first in line %d; leave one out",
                                     e->key, (*before)->line)));
            continue;
        }
        *before = e;
        r->scene->given[r->scene->n_given++] =
            (struct scene_given){cs->id, cs->index, param->key, e->line};
        if (inherited && strcmp(e->key, "like") == 0) continue;
        const enum err read = case_value(r, e, param, target);
        if (read) r->sections[section].invalid = true;
        TRY(case_go_on(r, read));
    }
    const struct param *const like = param_find((enum section_id)cs->id, "like");
    if (like) warn_of_lost_clamp(r, section, given[like - param_table]);
    return ERR_OK;
}

static enum err lacks(struct reader *r, const struct case_section *cs, const struct param *param)
{
    char unit[40] = "";
    if (strcmp(param->unit, "1") != 0) snprintf(unit, sizeof unit, " (%s)", param->unit);
    if (cs->id == SECTION_top)
        return bad_line(r, 1, "`%s` is missing at the top of the file: %s%s", param->key,
                        param->meaning, unit);
    return bad_line(r, cs->line, "[%s %s] lacks `%s`: %s%s", section_table[cs->id].word, cs->name,
                    param->key, param->meaning, unit);
}

/* Required values that were not given are still NaN. */
static enum err check_needed(struct reader *r)
{
    for (int k = 0; k < r->n_sections; k++) {
        const struct case_section *cs = &r->sections[k];
        if (cs->id == SECTION_constants) continue;
        const char *section = section_at(r->scene, (enum section_id)cs->id, cs->index);
        for (int j = 0; j < PARAM_COUNT; j++) {
            const struct param *param = &param_table[j];
            if ((int)param->section != cs->id || !param->number.needed) continue;
            double value;
            memcpy(&value, section + param->offset, sizeof value);
            /* A key with an invalid value, or an unknown name that may mean it, is not missing. */
            if (!isnan(value) || cs->incomplete ||
                scene_given(r->scene, (enum section_id)cs->id, cs->index, param->key))
                continue;
            r->sections[k].invalid = true;
            TRY(case_go_on(r, lacks(r, cs, param)));
        }
    }
    return ERR_OK;
}

/* The files that a case names; problems of both kinds are reported together. */
static enum err load_tables(struct reader *r)
{
    const enum err gravity = gravity_load(r->scene, r->diag);
    if (gravity != ERR_OK && gravity != ERR_INPUT) return gravity;
    const enum err motion = motion_load(r->scene, r->diag);
    return gravity ? gravity : motion;
}

static enum err read_all(struct reader *r, const char *text, int n_sets, const char *const *sets)
{
    TRY(case_split(r, text));
    TRY(case_apply_sets(r, n_sets, sets));
    TRY(case_collect_constants(r));
    TRY(allocate_sections(r));
    case_apply_presets(r);
    TRY(case_all_constants(r));
    r->scene->given = arena_alloc(&r->scene->arena, (size_t)r->n_entries + 1,
                                  sizeof *r->scene->given, "case file", r->diag);
    if (!r->scene->given) return ERR_MEMORY;
    for (int k = 0; k < r->n_sections; k++) TRY(case_go_on(r, read_section(r, k)));
    TRY(check_needed(r));
    /* A name that is not found may be in an invalid line. */
    if (r->lost) return ERR_INPUT;
    TRY(case_check(r));
    return r->n_problems > 0 ? ERR_INPUT : load_tables(r);
}

/* --- from text, from a file --- */

enum err scene_parse(struct scene *scene, const char *text, const char *path, int n_sets,
                     const char *const *sets, struct diag *d)
{
    memset(scene, 0, sizeof *scene);
    if (strlen(path) >= sizeof scene->path)
        return diag_fail(d, ERR_INPUT, "the path of the case file is longer than %zu bytes",
                         sizeof scene->path - 1);
    memcpy(scene->path, path, strlen(path) + 1);
    struct reader r = {.scene = scene, .diag = d};
    enum err err = read_all(&r, text, n_sets, sets);
    if (err == ERR_INPUT) case_report(&r);
    arena_free(&r.temp);
    if (err) scene_free(scene);
    return err;
}

enum err scene_read(struct scene *scene, const char *path, int n_sets, const char *const *sets,
                    struct diag *d)
{
    struct stat info;
    if (stat(path, &info) != 0)
        return diag_fail(d, ERR_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
    if (!S_ISREG(info.st_mode))
        return diag_fail(d, ERR_INPUT, "%s: is %s; a case is a regular file", path,
                         S_ISDIR(info.st_mode) ? "a folder" : "a pipe or a device");
    if (info.st_size > CASE_MAX_BYTES)
        return diag_fail(d, ERR_INPUT, "%s: longer than %d bytes; is it a case file?", path,
                         CASE_MAX_BYTES);
    char *text;
    TRY(text_read(path, path, "a case file", &text, d));
    const enum err err = scene_parse(scene, text, path, n_sets, sets, d);
    free(text);
    return err;
}
