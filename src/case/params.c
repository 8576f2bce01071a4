/* SPDX-License-Identifier: MIT */
#include "case/params.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#define WHERE_0(section) offsetof(struct scene, section), 0
#define WHERE_1(section) offsetof(struct scene, section), offsetof(struct scene, n_##section)

const struct section_info section_table[SECTION_COUNT] = {
#define SECTION(section, named) \
    {#section, named, WHERE_##named(section), sizeof(struct scene_##section)},
#define END
#include "case/params.def"
};

/* Initializers of a struct param_default and a struct param_bound. */
#define NEEDED (double)NAN, true
#define ABSENT (double)NAN
#define OVER(v) v, true
#define UNDER(v) v, true
#define PARAM(section_, key_, type_, text, ...)         \
    {.section = SECTION_##section_,                     \
     .type = PARAM_##type_,                             \
     .key = #key_,                                      \
     .meaning = text,                                   \
     .offset = offsetof(struct scene_##section_, key_), \
     __VA_ARGS__},

const struct param param_table[PARAM_COUNT] = {
#include "case/params.def"
};

int section_count(const struct scene *scene, enum section_id id)
{
    const struct section_info *info = &section_table[id];
    if (!info->named) return 1;
    return *(const int *)(const void *)((const char *)scene + info->count_offset);
}

const struct scene_given *scene_given(const struct scene *scene, enum section_id section, int index,
                                      const char *key)
{
    for (int k = 0; k < scene->n_given; k++)
        if (scene->given[k].section == (int)section && scene->given[k].index == index &&
            strcmp(scene->given[k].key, key) == 0)
            return &scene->given[k];
    return NULL;
}

int scene_line(const struct scene *scene, enum section_id section, int index, const char *key)
{
    const struct scene_given *const given = scene_given(scene, section, index, key);
    const struct scene_section_common *const common = section_at(scene, section, index);
    if (given) return given->line;
    return common->line > 0 ? common->line : LINE_NONE;
}

void *section_at(const struct scene *scene, enum section_id id, int index)
{
    const struct section_info *info = &section_table[id];
    char *const place = (char *)(uintptr_t)scene + info->offset;
    if (!info->named) return place;
    char *array;
    memcpy(&array, place, sizeof array);
    return array + (size_t)index * info->size;
}

const struct param *param_find(enum section_id section, const char *key)
{
    for (int k = 0; k < PARAM_COUNT; k++) {
        const struct param *param = &param_table[k];
        if (param->section == section && strcmp(param->key, key) == 0) return param;
    }
    return NULL;
}

/* Whether `word` is one of the words of a key, which are separated by _. */
static bool has_word(const char *key, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = key; at; at = strchr(at, '_')) {
        at += *at == '_';
        if (strncmp(at, word, length) == 0 && (at[length] == '_' || !at[length])) return true;
    }
    return false;
}

/* Whether `word` is the usual textbook name of a key. */
static bool is_called(const char *key, const char *word)
{
    static const struct {
        const char *key, *names;
    } usual[] = {
        {"young", "e modulus youngs_modulus young_modulus elastic_modulus"},
        {"poisson", "nu poisson_ratio"},
        {"density", "rho rho0"},
        {"sound_speed", "c0 speed_of_sound"},
        {"dp", "spacing particle_spacing dx resolution"},
        {"fixed_step", "dt time_step timestep"},
        {"end_time", "duration t_end tmax"},
        {"gravity", "g"},
        {"artificial_viscosity", "alpha"},
        {"density_diffusion", "delta"},
        {"laminar_viscosity", "mu"},
        {"snapshot_interval", "snapshots"},
        {"clamp", "fixed fix"},
        {"law", "material model"},
        {"surface", "water_level height"},
        {"shape", "geometry region"},
        {"motion", "movement"},
        {"point", "position location"},
        {"kind", "type"},
        {"quantity", "variable"},
        {"cfl", "courant"},
    };
    for (size_t k = 0; k < COUNT_OF(usual); k++) {
        if (strcmp(usual[k].key, key) != 0) continue;
        const size_t length = strlen(word);
        for (const char *at = usual[k].names; *at; at += strspn(at, " ")) {
            const size_t n = strcspn(at, " ");
            if (n == length && strncasecmp(at, word, n) == 0) return true;
            at += n;
        }
    }
    return false;
}

bool param_may_be(const struct param *param, const char *word)
{
    return has_word(param->key, word) || is_called(param->key, word);
}

bool param_meant(enum section_id section, const char *word, char text[PARAM_MEANT])
{
    text[0] = '\0';
    if (strlen(word) > SCENE_NAME) return false;
    for (int k = 0; k < PARAM_COUNT; k++) {
        const struct param *const param = &param_table[k];
        if (param->section != section || !param_may_be(param, word)) continue;
        const size_t used = strlen(text);
        snprintf(text + used, PARAM_MEANT - used, "%s`%s`", used ? " or " : "", param->key);
    }
    return text[0] != '\0';
}

const struct param *param_called(const char *word)
{
    for (int k = 0; k < PARAM_COUNT; k++)
        if (is_called(param_table[k].key, word)) return &param_table[k];
    return NULL;
}

void param_choice_name(const struct param *param, int value, char name[SCENE_NAME])
{
    const char *start = param->choices;
    for (int k = 0; k < value; k++) start = strchr(start, '|') + 1;
    const size_t length = strcspn(start, "|");
    memcpy(name, start, length);
    name[length] = '\0';
}

/* Edit distance: insertions, deletions and replacements that turn one word into the other. */
static int edit_distance(const char *a, size_t a_length, const char *b, size_t b_length)
{
    int row[SCENE_NAME + 1];
    for (size_t j = 0; j <= b_length; j++) row[j] = (int)j;
    for (size_t i = 1; i <= a_length; i++) {
        int diagonal = row[0];
        row[0] = (int)i;
        for (size_t j = 1; j <= b_length; j++) {
            const int replaced = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            const int shorter = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
            row[j] = replaced < shorter ? replaced : shorter;
        }
    }
    return row[b_length];
}

void nearest_offer(struct nearest *best, const char *word, const char *candidate)
{
    const size_t word_length = strlen(word), length = strlen(candidate);
    if (word_length == 0 || word_length > SCENE_NAME || length > SCENE_NAME) return;
    const int distance = edit_distance(word, word_length, candidate, length);
    const int tolerance = word_length < 3 ? 1 : word_length < 5 ? 2 : word_length < 8 ? 3 : 4;
    if (distance > tolerance || (size_t)distance >= length) return;
    if (best->name && best->distance <= distance) return;
    *best = (struct nearest){candidate, distance};
}

const struct expr *param_in_time(const struct param *param, const void *section, int component)
{
    if (param->type != PARAM_TIME_VECTOR) return NULL;
    const struct scene_expr *const in_time =
        (const void *)((const char *)section + param->expr_offset);
    return in_time->e[component];
}

bool param_is_default(const struct param *param, const void *section)
{
    const char *const value = (const char *)section + param->offset;
    double number[2];
    int choice;
    switch (param->type) {
    case PARAM_REAL:
        memcpy(number, value, sizeof *number);
        return number[0] == param->number.value || isnan(number[0]);
    case PARAM_VECTOR:
    case PARAM_TIME_VECTOR:
        memcpy(number, value, sizeof number);
        return !param_in_time(param, section, 0) && !param_in_time(param, section, 1) &&
               number[0] == param->vector_default[0] && number[1] == param->vector_default[1];
    case PARAM_INTEGER:
    case PARAM_CHOICE: return memcpy(&choice, value, sizeof choice), choice == param->number.value;
    case PARAM_TEXT: return strcmp(value, param->text_default) == 0;
    case PARAM_FIELD_EXPR:
    case PARAM_TIME_EXPR:
    case PARAM_FLOW_EXPR: return !((const struct scene_expr *)(const void *)value)->e[0];
    case PARAM_SHAPES: return ((const struct shape_list *)(const void *)value)->n == 0;
    case PARAM_NUMBERS: break;
    }
    return ((const struct number_list *)(const void *)value)->n == 0;
}
