/* SPDX-License-Identifier: MIT
 * Queries on a scene: sections by name, places for messages, files relative to the case. */
#include "base/elementary.h"
#include "case/params.h"

void scene_free(struct scene *scene)
{
    arena_free(&scene->arena);
    memset(scene, 0, sizeof *scene);
}

int scene_find(const struct scene *scene, enum section_id id, const char *name)
{
    for (int k = 0; k < section_count(scene, id); k++) {
        const struct scene_section_common *const common = section_at(scene, id, k);
        if (strcmp(common->name, name) == 0) return k;
    }
    return -1;
}

int scene_wall_motion(const struct scene *scene, int wall)
{
    return wall < 0 ? -1 : scene_find(scene, SECTION_motion, scene->wall[wall].motion);
}

int scene_beam_parts(const struct scene *scene, const struct scene_beam *beam, const double a[2],
                     const double b[2])
{
    const double size = beam->element > 0 ? beam->element : scene->top.dp;
    const double parts = whole_parts(elementary_hypot(b[0] - a[0], b[1] - a[1]) / size);
    return (int)max2(1, min2(parts, 1e6));
}

double scene_solid_h(const struct scene *scene, int solid)
{
    const double own = scene->numerics.solid_h_over_dp;
    return (own > 0 ? own : scene->numerics.h_over_dp) * scene_solid_dp(scene, solid);
}

double scene_solid_dp(const struct scene *scene, int solid)
{
    if (scene->solid_lattice) return scene->solid_lattice[solid].dp;
    return scene->solid[solid].dp > 0 ? scene->solid[solid].dp : scene->top.dp;
}

void scene_bonds(const struct scene *scene, int bond[SCENE_MAX_SECTIONS])
{
    for (int k = 0; k < scene->n_solid; k++) bond[k] = k;
    for (int k = 0; k < scene->n_solid; k++) {
        const int to = scene_find(scene, SECTION_solid, scene->solid[k].joined);
        if (to < 0) continue;
        const int a = bond[k], b = bond[to];
        for (int j = 0; j < scene->n_solid; j++)
            if (bond[j] == a || bond[j] == b) bond[j] = a < b ? a : b;
    }
}

bool scene_is_bonded(const struct scene *scene, int solid)
{
    int bond[SCENE_MAX_SECTIONS], n = 0;
    scene_bonds(scene, bond);
    for (int k = 0; k < scene->n_solid; k++) n += bond[k] == bond[solid];
    return n > 1;
}

/* Whether a section applies to two bodies, walls after solids; one without names applies to all. */
static bool is_between(const struct scene *scene, const struct scene_contact *c, int a, int b)
{
    char name[2][SCENE_TEXT];
    int number[2];
    if (!scene_pair(c->between, name)) return c->between[0] == '\0';
    for (int k = 0; k < 2; k++) {
        const int solid = scene_find(scene, SECTION_solid, name[k]);
        number[k] = solid >= 0 ? solid : scene->n_solid + scene_find(scene, SECTION_wall, name[k]);
    }
    return (number[0] == a && number[1] == b) || (number[0] == b && number[1] == a);
}

/* Sections without names come first: named ones override them. */
const struct scene_contact *scene_contact_of(const struct scene *scene, int a, int b)
{
    if (scene->n_contact == 0 && scene->domain.periodic != PERIODIC_NONE) return NULL;
    const struct scene_contact *found = &scene->contact_default;
    for (int named = 0; named < 2; named++)
        for (int k = 0; k < scene->n_contact; k++)
            if ((scene->contact[k].between[0] != '\0') == named &&
                is_between(scene, &scene->contact[k], a, b))
                found = &scene->contact[k];
    return found->enabled ? found : NULL;
}

double scene_contact_gap(const struct scene *scene, const struct scene_contact *c)
{
    const bool given = c != &scene->contact_default &&
                       scene_given(scene, SECTION_contact, (int)(c - scene->contact), "gap");
    const bool layer = scene->n_fluid > 0 && scene->top.scheme == SCHEME_STANDARD;
    return given || c->gap > 0 || !layer ? c->gap : scene->top.dp;
}

bool scene_listed(const char *list, int k, char name[SCENE_TEXT])
{
    struct slice rest = slice_of(list), piece = rest;
    for (; k >= 0; k--)
        if (!slice_next(&rest, ',', &piece)) return false;
    snprintf(name, SCENE_TEXT, "%.*s", (int)piece.length, piece.at);
    return true;
}

bool scene_word(const char *list, int k, char word[SCENE_TEXT])
{
    static const char blanks[] = " \t,";
    list += strspn(list, blanks);
    for (; k > 0; k--) list += strcspn(list, blanks), list += strspn(list, blanks);
    snprintf(word, SCENE_TEXT, "%.*s", (int)strcspn(list, blanks), list);
    return *word;
}

bool scene_pair(const char *text, char name[2][SCENE_TEXT])
{
    char more[SCENE_TEXT];
    return scene_listed(text, 0, name[0]) && scene_listed(text, 1, name[1]) &&
           !scene_listed(text, 2, more) && *name[0] && *name[1];
}

/* --- probes and snapshots --- */

const struct quantity_info quantity_table[PROBE_QUANTITIES] = {
#define QUANTITY(NAME, name, target, needs, columns, meaning) \
    {#name, columns, meaning, TARGET_##target},
#include "case/quantities.def"
};

enum probe_target scene_probe_target(const struct scene_probe *probe)
{
    const enum probe_target target = quantity_table[probe->quantity].target;
    if (target != TARGET_ANY_POINT) return target;
    return probe->body[0] ? TARGET_SOLID_POINT : TARGET_FLUID_POINT;
}

bool scene_snapshot_has(const struct scene *scene, const char *field)
{
    const char *const fields = scene->output.snapshot_fields;
    char word[SCENE_TEXT];
    bool has = strcmp(fields, "all") == 0;
    for (int k = 0; !has && scene_word(fields, k, word); k++) has = strcmp(word, field) == 0;
    return has;
}

/* --- places and files --- */

struct scene_place scene_place(const struct scene *scene, int line)
{
    struct scene_place place = {"--set"};
    if (line == 0) return place;
    const size_t length = strlen(scene->path), max_shown = 270;
    const bool cut = length > max_shown;
    const int n = snprintf(place.text, sizeof place.text, "%s%.270s", cut ? "..." : "",
                           scene->path + (cut ? length - max_shown : 0));
    if (line != LINE_NONE) snprintf(place.text + n, sizeof place.text - (size_t)n, ":%d", line);
    return place;
}

bool scene_file(const struct scene *scene, const char *name, char *path, size_t size)
{
    const char *slash = strrchr(scene->path, '/');
    const int folder = name[0] == '/' || !slash ? 0 : (int)(slash - scene->path) + 1;
    const int n = snprintf(path, size, "%.*s%s", folder, scene->path, name);
    return n >= 0 && (size_t)n < size;
}
