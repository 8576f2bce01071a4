/* SPDX-License-Identifier: MIT
 * case/params.def as data: one row for each section and each key, used to read, check, write or
 * list the values of a scene. */
#pragma once

#include "case/scene.h"

enum section_id {
#define SECTION(section, ...) SECTION_##section,
#define END
#include "case/params.def"
    SECTION_COUNT,
    SECTION_constants = SECTION_COUNT /* free names: no row of case/params.def */
};

struct section_info {
    const char *word, *meaning;
    bool named;          /* an array of them in struct scene, with its count */
    size_t offset;       /* in struct scene: of the struct, or of the pointer to the array */
    size_t count_offset; /* in struct scene: of the count (named only) */
    size_t size;         /* of one struct */
};
extern const struct section_info section_table[SECTION_COUNT + 1]; /* and [constants] */

/* Line of a key given in a section, or NULL. */
const struct scene_given *scene_given(const struct scene *scene, enum section_id section, int index,
                                      const char *key);
/* The line of a key; without it, that of its section; LINE_NONE: neither is given. 0: by --set. */
int key_line(const struct scene *scene, enum section_id section, int index, const char *key);

enum param_type {
    PARAM_REAL,
    PARAM_INTEGER,
    PARAM_CHOICE,
    PARAM_TEXT,
    PARAM_VECTOR,
    PARAM_TIME_VECTOR = PARAM_VECTOR,
    PARAM_EXPR,
    PARAM_SHAPES,
    PARAM_HINGES
};

struct param_default {
    double value;
    bool needed; /* none: the key is required */
};

struct param_bound {
    double value;
    bool open; /* the bound itself is excluded */
};

struct param {
    enum section_id section;
    enum param_type type;
    const char *key, *meaning;
    const char *unit;            /* NULL where the type has none */
    const char *choices;         /* "a|b|c" of a CHOICE */
    const char *text_default;    /* of a TEXT */
    struct param_default number; /* of a REAL, INTEGER, CHOICE (index) */
    double vector_default[2];
    struct param_bound low, high; /* of a REAL, INTEGER */
    enum expr_scope scope;        /* of an EXPR or a TIME_VECTOR */
    int count;                    /* of their expressions */
    enum section_id kind, also;   /* of the sections that a TEXT names; 0: it names none */
    bool list;                    /* several of them */
    size_t offset, size;          /* in the section's struct, bytes */
    size_t expr_offset;           /* of the expressions of a TIME_VECTOR; else 0 */
};
/* The number of all keys. */
enum {
#define PARAM(section, key, ...) PARAM_##section##_##key,
#include "case/params.def"
    PARAM_COUNT
};
extern const struct param param_table[PARAM_COUNT];

/* Number of sections of a kind; the index-th of them, which begins with scene_section_common. */
int section_count(const struct scene *scene, enum section_id id);
void *section_at(const struct scene *scene, enum section_id id, int index);
/* The index of a named section, or -1. */
int scene_find(const struct scene *scene, enum section_id id, const char *name);
/* "[fluid water]" or "[output]". */
struct section_title {
    char text[2 * SCENE_NAME + 32];
};
struct section_title section_title(const struct scene_section_common *section);

/* The row of a key, or NULL. */
const struct param *param_find(enum section_id section, const char *key);

/* The expression of a component of an EXPR or a TIME_VECTOR; NULL: there is none. */
const struct expr *param_expr(const struct param *param, const void *section, int component);

/* The value of a REAL, INTEGER or CHOICE. */
double param_number(const struct param *param, const void *section);
void param_set_number(const struct param *param, void *section, double number);

/* Whether a key may be given several times: the regions and points of a body. */
SPHFSI_INLINE bool param_repeats(const struct param *param)
{
    return param->type == PARAM_SHAPES || param->type == PARAM_HINGES;
}

/* Gives a section the default value of a key; whether it has that. */
void param_set_default(const struct param *param, void *section);
bool param_is_default(const struct param *param, const void *section);

/* Whether a scheme sets a key in a kind of scene, and its value. */
bool scheme_sets(enum scheme scheme, enum scene_kind kind, enum section_id section, const char *key,
                 double *value);

/* Whether the scene's `scheme` sets a key, and its value. */
bool scene_scheme_sets(const struct scene *scene, enum section_id section, const char *key,
                       double *value);

/* The name of a CHOICE's value; "": it has fewer values. */
struct choice_name {
    char text[SCENE_NAME];
};
struct choice_name param_choice(const struct param *param, int value);

/* The candidate nearest to a misspelt word, or NULL if none is near. To be called for each
 * candidate with the same `best`, which starts as {0}. */
struct nearest {
    const char *name;
    int distance;
    char hint[SCENE_NAME + 24];
};
void nearest_offer(struct nearest *best, const char *word, const char *candidate);
/* "; did you mean `name`?" or "". */
const char *nearest_hint(struct nearest *near);

/* What an unknown key of a section may mean, for the end of a message; it may be "": the section
 * that has it, or the nearest key of its own, or of those that `near` brings. */
const char *param_hint(enum section_id section, const char *word, struct nearest *near);
