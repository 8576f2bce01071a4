/* SPDX-License-Identifier: MIT
 * From a case file to a scene: defaults, values in the order of the file, checks. */
#include "base/files.h"
#include "case/case.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>

/* --- sections --- */

static void set_defaults(void *section, enum section_id id, int index)
{
    struct scene_section_common *const common = section;
    common->section = (int)id;
    common->index = index;
    for (int k = 0; k < PARAM_COUNT; k++)
        if (param_table[k].section == id) param_set_default(&param_table[k], section);
}

static void *section_of(const struct reader *r, const struct case_section *s)
{
    return section_at(r->scene, (enum section_id)s->id, s->index);
}

static enum err allocate_sections(struct reader *r)
{
    struct scene *const scene = r->scene;
    int count[SECTION_COUNT + 1] = {0};
    for (int k = 0; k < r->n_sections; k++) count[r->sections[k].id]++;
    count[SECTION_wall] += count[SECTION_rigid] + count[SECTION_beam];
    count[SECTION_motion] += count[SECTION_rigid];
    for (int id = 0; id < SECTION_COUNT; id++) {
        const struct section_info *const info = &section_table[id];
        if (info->named) {
            void *const array =
                arena_alloc(&scene->arena, (size_t)count[id], info->size, "sections", r->diag);
            if (!array) return ERR_MEMORY;
            memcpy((char *)scene + info->offset, &array, sizeof array);
            memcpy((char *)scene + info->count_offset, &count[id], sizeof count[id]);
        }
        for (int k = 0; k < section_count(scene, (enum section_id)id); k++)
            set_defaults(section_at(scene, (enum section_id)id, k), (enum section_id)id, k);
    }
    set_defaults(&scene->contact_default, SECTION_contact, 0);
    for (int k = 0; k < r->n_sections; k++) {
        if (r->sections[k].id == SECTION_constants) continue;
        struct scene_section_common *const common = section_of(r, &r->sections[k]);
        snprintf(common->name, sizeof common->name, "%s", r->sections[k].name);
        common->line = r->sections[k].line;
    }
    return ERR_OK;
}

/* --- `like` --- */

/* `like = NAME`: values of an earlier section become the defaults, but not regions and points. */
static enum err inherit(struct reader *r, const struct param *like, struct scene_section_common *to)
{
    char *const target = (void *)to;
    char name[SCENE_TEXT] = "";
    TRY(case_value(r, like, target));
    snprintf(name, sizeof name, "%s", target + like->offset);
    struct nearest near = {0};
    for (int k = 0; k < to->index; k++) {
        const struct scene_section_common *const from = section_at(r->scene, like->section, k);
        nearest_offer(&near, name, from->name);
        if (strcmp(from->name, name) != 0) continue;
        memcpy(to + 1, from + 1, section_table[like->section].size - sizeof *to);
        memcpy(target + like->offset, name, sizeof name);
        for (int p = 0; p < PARAM_COUNT; p++) {
            const struct param *const own = &param_table[p];
            const bool point = own->type == PARAM_VECTOR && strcmp(own->unit, "m") == 0;
            if (own->section == like->section && (point || param_repeats(own)))
                param_set_default(own, target);
        }
        return ERR_OK;
    }
    if (r->incomplete) return ERR_INPUT; /* it may be defined in an invalid line */
    return bad_value(r, "there is no earlier [%s] of that name%s",
                     section_table[like->section].word, nearest_hint(&near));
}

/* Drops inherited values that a given one replaces or determines, and those of hinges and clamps
 * unless such a point is given. */
static void drop_inherited(const struct reader *r, int section, void *target)
{
    static const struct {
        const char *key;
        bool given; /* drop if one of the others is given, or if none is */
        const char *other[2];
    } drops[] = {{"surface", true, {"pressure", "pressure"}},
                 {"pressure", true, {"surface", "surface"}},
                 {"density", true, {"mass", "mass"}},
                 {"mass", true, {"density", "density"}},
                 {"inertia", true, {"density", "mass"}},
                 {"axial_stiffness", true, {"young", "thickness"}},
                 {"bending_stiffness", true, {"young", "thickness"}},
                 {"shear_stiffness", true, {"young", "thickness"}},
                 {"hinge_stiffness", false, {"hinge", "hinge"}},
                 {"hinge_damping", false, {"hinge", "hinge"}},
                 {"hinge_friction", false, {"hinge", "hinge"}},
                 {"hinge_motion", false, {"hinge", "hinge"}},
                 {"clamp_motion", false, {"clamp", "clamp"}},
                 {"motion", false, {"clamp", "hinge"}}};
    for (size_t k = 0; k < COUNT_OF(drops); k++) {
        const struct param *const param =
            param_find((enum section_id)r->sections[section].id, drops[k].key);
        const bool given =
            case_entry(r, section, drops[k].other[0]) || case_entry(r, section, drops[k].other[1]);
        if (param && given == drops[k].given) param_set_default(param, target);
    }
}

/* --- keys --- */

static enum err unknown_key(struct reader *r, int id)
{
    char title[SCENE_NAME];
    struct nearest near = {0};
    snprintf(title, sizeof title, "in [%s]", section_table[id].word);
    r->incomplete = true;
    return bad_entry(r, "unknown key `%s` %s%s", r->entry->key,
                     id == SECTION_top ? "at the top of the file" : title,
                     param_hint((enum section_id)id, r->entry->key, &near));
}

static enum err read_section(struct reader *r, int section)
{
    const enum section_id id = (enum section_id)r->sections[section].id;
    const struct entry *given[PARAM_COUNT] = {NULL};
    const struct param *const like = id < SECTION_COUNT ? param_find(id, "like") : NULL;
    if (r->sections[section].id == SECTION_constants) return ERR_OK;
    void *const target = section_of(r, &r->sections[section]);
    r->entry = case_entry(r, section, "like");
    if (like && r->entry) TRY(case_go_on(r, inherit(r, like, target)));
    if (like) drop_inherited(r, section, target);
    for (int k = 0; k < r->n_entries; k++) {
        const struct entry *const e = r->entry = &r->entries[k];
        if (e->section != section) continue;
        const struct param *const param = param_find(id, e->key);
        if (!param) {
            TRY(case_go_on(r, unknown_key(r, (int)id)));
            continue;
        }
        const struct entry **const before = &given[param - param_table];
        if (*before && !param_repeats(param)) {
            TRY(case_go_on(r, bad_entry(r, "`%s` is given twice, first in line %d; leave one out",
                                        e->key, (*before)->line)));
            continue;
        }
        *before = e;
        r->scene->given[r->scene->n_given++] =
            (struct scene_given){(int)id, r->sections[section].index, param->key, e->line};
        if (param != like) TRY(case_go_on(r, case_value(r, param, target)));
    }
    return ERR_OK;
}

static enum err read_sections(struct reader *r, bool tables)
{
    for (int k = 0; k < r->n_sections; k++)
        if (tables == (r->sections[k].id == SECTION_table)) TRY(case_go_on(r, read_section(r, k)));
    return ERR_OK;
}

/* Required values that were not given. What a section is like may have an invalid one. */
static enum err check_needed(struct reader *r)
{
    for (int k = 0; k < r->n_sections * PARAM_COUNT; k++) {
        const struct case_section *const s = &r->sections[k / PARAM_COUNT];
        const struct param *const param = &param_table[k % PARAM_COUNT];
        if ((int)param->section != s->id || !param->number.needed) continue;
        if (!param_is_default(param, section_of(r, s)) ||
            scene_given(r->scene, param->section, s->index, param->key) ||
            (r->n_problems > 0 && scene_given(r->scene, param->section, s->index, "like")))
            continue;
        const bool top = param->section == SECTION_top,
                   pure = !param->unit || strcmp(param->unit, "1") == 0;
        TRY(case_go_on(r, bad_line(r, s->line, "%s%s`%s`%s: %.*s%s%s%s",
                                   top ? "" : section_title(section_of(r, s)).text,
                                   top ? "" : " lacks ", param->key,
                                   top ? " is missing at the top of the file" : "",
                                   (int)strcspn(param->meaning, ".;:"), param->meaning,
                                   pure ? "" : " (", pure ? "" : param->unit, pure ? "" : ")")));
    }
    return ERR_OK;
}

/* Problems of lines and values are reported together with names that are not found; what else
 * concerns several values is looked at when all of them are valid. */
static enum err read_all(struct reader *r, const char *text, int n_sets, const char *const *sets)
{
    struct scene *const scene = r->scene;
    TRY(case_split(r, text, n_sets, sets));
    TRY(case_collect_constants(r));
    TRY(allocate_sections(r));
    case_apply_presets(r);
    TRY(arena_array(&scene->arena, &scene->given, (size_t)r->n_entries + 1, "case file", r->diag));
    TRY(read_sections(r, true)); /* expressions of the others use them */
    TRY(case_load_functions(r));
    TRY(case_all_constants(r));
    TRY(read_sections(r, false));
    if (r->incomplete)
        return ERR_INPUT; /* a key or a name that is missing may be in an invalid line */
    const bool valid = r->n_problems == 0;
    TRY(check_needed(r));
    TRY(case_place_bodies(r));
    case_apply_defaults(scene);
    TRY(case_check_names(r));
    if (valid) TRY(case_check(r));
    return r->n_problems > 0 ? ERR_INPUT : ERR_OK;
}

/* --- from text, from a file --- */

static enum err read_file(const char *path, char **text, struct diag *d)
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
    return text_read(path, path, "a case file", text, d);
}

enum err scene_read(struct scene *scene, const char *text, const char *path, int n_sets,
                    const char *const *sets, struct diag *d)
{
    char *of_file = NULL;
    memset(scene, 0, sizeof *scene);
    if (strlen(path) >= sizeof scene->path)
        return diag_fail(d, ERR_INPUT, "the path of the case file is longer than %zu bytes",
                         sizeof scene->path - 1);
    memcpy(scene->path, path, strlen(path) + 1);
    if (!text) TRY(read_file(path, &of_file, d));
    struct reader r = {.scene = scene, .diag = d};
    enum err err = read_all(&r, text ? text : of_file, n_sets, sets);
    if (err == ERR_INPUT) case_report(&r);
    free(of_file);
    arena_free(&r.temp);
    if (err) scene_free(scene);
    return err;
}
