/* SPDX-License-Identifier: MIT
 * Looks up sections and keys, and sets, compares and suggests their values. */
#include "case/params.h"

#define WHERE_0(section) offsetof(struct scene, section), 0
#define WHERE_1(section) offsetof(struct scene, section), offsetof(struct scene, n_##section)

const struct section_info section_table[SECTION_COUNT + 1] = {
    [SECTION_constants] = {.word = "constants"},
#define SECTION(section, named, text)                                     \
    [SECTION_##section] = {#section, text, named, WHERE_##named(section), \
                           sizeof(struct scene_##section)},
#define END
#include "case/params.def"
};

/* Initializers of a struct param_default and a struct param_bound. */
#define NEEDED (double)NAN, true
#define ABSENT (double)NAN
#define OVER(v) v, true
#define UNDER(v) v, true
#define PARAM(section_, key_, type_, text, ...)            \
    {.section = SECTION_##section_,                        \
     .type = PARAM_##type_,                                \
     .key = #key_,                                         \
     .meaning = text,                                      \
     .offset = offsetof(struct scene_##section_, key_),    \
     .size = sizeof(((struct scene_##section_ *)0)->key_), \
     __VA_ARGS__},

const struct param param_table[PARAM_COUNT] = {
#include "case/params.def"
};

/* --- sections --- */

int section_count(const struct scene *scene, enum section_id id)
{
    const struct section_info *info = &section_table[id];
    if (!info->named) return 1;
    return *(const int *)(const void *)((const char *)scene + info->count_offset);
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

struct section_title section_title(const struct scene_section_common *section)
{
    const struct section_info *const info = &section_table[section->section];
    struct section_title title;
    snprintf(title.text, sizeof title.text, "[%s%s%s]", info->word, info->named ? " " : "",
             section->name);
    return title;
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

int key_line(const struct scene *scene, enum section_id section, int index, const char *key)
{
    const struct scene_given *const given = scene_given(scene, section, index, key);
    const struct scene_section_common *const common = section_at(scene, section, index);
    if (given) return given->line;
    return common->line > 0 ? common->line : LINE_NONE;
}

/* --- values --- */

const struct param *param_find(enum section_id section, const char *key)
{
    for (int k = 0; k < PARAM_COUNT; k++)
        if (param_table[k].section == section && strcmp(param_table[k].key, key) == 0)
            return &param_table[k];
    return NULL;
}

struct choice_name param_choice(const struct param *param, int value)
{
    struct choice_name name = {""};
    const char *start = param->choices;
    for (int k = 0; start && k < value; k++) start = strchr(start + (k > 0), '|');
    if (start) start += value > 0;
    if (start) snprintf(name.text, SCENE_NAME, "%.*s", (int)strcspn(start, "|"), start);
    return name;
}

double param_number(const struct param *param, const void *section)
{
    const void *const value = (const char *)section + param->offset;
    return param->type == PARAM_REAL ? *(const double *)value : *(const int *)value;
}

static void put_number(const struct param *param, void *value, double number)
{
    if (param->type == PARAM_REAL)
        *(double *)value = number;
    else
        *(int *)value = (int)number;
}

void param_set_number(const struct param *param, void *section, double number)
{
    put_number(param, (char *)section + param->offset, number);
}

const struct expr *param_expr(const struct param *param, const void *section, int component)
{
    const size_t offset = param->type == PARAM_EXPR ? param->offset : param->expr_offset;
    const void *const field = (const char *)section + offset;
    return offset ? ((const struct scene_expr *)field)->e[component] : NULL;
}

/* Size of a value, with the expressions of a TIME_VECTOR, which follow its numbers. */
static size_t size_of(const struct param *param)
{
    return param->size + (param->expr_offset ? sizeof(struct scene_expr) : 0);
}

/* Lists and expressions are absent by default: zero. */
static void put_default(const struct param *param, void *value)
{
    memset(value, 0, size_of(param));
    if (param->type <= PARAM_CHOICE) put_number(param, value, param->number.value);
    if (param->type == PARAM_TEXT) snprintf(value, SCENE_TEXT, "%s", param->text_default);
    if (param->type == PARAM_VECTOR) memcpy(value, param->vector_default, sizeof(double[2]));
}

void param_set_default(const struct param *param, void *section)
{
    put_default(param, (char *)section + param->offset);
}

bool param_is_default(const struct param *param, const void *section)
{
    _Alignas(double) char standard[SCENE_TEXT];
    put_default(param, standard);
    return memcmp((const char *)section + param->offset, standard, size_of(param)) == 0;
}

/* --- hints for misspelt words --- */

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
    best->name = candidate;
    best->distance = distance;
}

const char *nearest_hint(struct nearest *near)
{
    near->hint[0] = '\0';
    if (near->name) snprintf(near->hint, sizeof near->hint, "; did you mean `%s`?", near->name);
    return near->hint;
}

const char *param_hint(enum section_id section, const char *word, struct nearest *near)
{
    const struct param *other = NULL;
    for (int k = 0; k < PARAM_COUNT; k++) {
        if (param_table[k].section == section) nearest_offer(near, word, param_table[k].key);
        if (!other && strcmp(param_table[k].key, word) == 0) other = &param_table[k];
    }
    if (!other) return nearest_hint(near);
    const bool top = other->section == SECTION_top;
    snprintf(near->hint, sizeof near->hint, "; it belongs %s%s%s",
             top ? "at the top of the file" : "in [", top ? "" : section_table[other->section].word,
             top ? "" : "]");
    return near->hint;
}
