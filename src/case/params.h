/* SPDX-License-Identifier: MIT
 * case/params.def as data: one row for each section and each key, used to read, check, write or
 * list the values of a scene. */
#ifndef SPHFSI_CASE_PARAMS_H
#define SPHFSI_CASE_PARAMS_H

#include "case/scene.h"

enum section_id {
#define SECTION(section, named) SECTION_##section,
#define END
#include "case/params.def"
    SECTION_COUNT
};

struct section_info {
    const char *word;
    bool named;          /* an array of them in struct scene, with its count */
    size_t offset;       /* in struct scene: of the struct, or of the pointer to the array */
    size_t count_offset; /* in struct scene: of the count (named only) */
    size_t size;         /* of one struct */
};
extern const struct section_info section_table[SECTION_COUNT];

/* Line of a key given in a section, or NULL. */
const struct scene_given *scene_given(const struct scene *scene, enum section_id section, int index,
                                      const char *key);
/* The line of a key; without it, that of its section; LINE_NONE: neither is given. 0: by --set. */
int scene_line(const struct scene *scene, enum section_id section, int index, const char *key);

enum param_type {
    PARAM_REAL,
    PARAM_INTEGER,
    PARAM_CHOICE,
    PARAM_TEXT,
    PARAM_VECTOR,
    PARAM_TIME_VECTOR,
    PARAM_FIELD_EXPR,
    PARAM_TIME_EXPR,
    PARAM_FLOW_EXPR,
    PARAM_SHAPES,
    PARAM_NUMBERS
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
    int count;                    /* expressions of an expression or a TIME_VECTOR */
    size_t offset;                /* offset in the section's struct */
    size_t expr_offset;           /* of the expressions of a TIME_VECTOR */
};
/* The number of all keys. */
enum {
#define PARAM(section, key, ...) PARAM_##section##_##key,
#include "case/params.def"
    PARAM_COUNT
};
extern const struct param param_table[PARAM_COUNT];

/* Number of sections of a kind in the scene; the index-th struct of them. */
int section_count(const struct scene *scene, enum section_id id);
void *section_at(const struct scene *scene, enum section_id id, int index);

/* The row of a key, or NULL. */
const struct param *param_find(enum section_id section, const char *key);

/* The keys of a section that a word may mean, as "`a` or `b`": keys with it among their words, as
 * viscosity in artificial_viscosity, or with that textbook name; false: none. */
enum { PARAM_MEANT = 200 };
bool param_meant(enum section_id section, const char *word, char text[PARAM_MEANT]);
/* The first parameter of any section that other programs call by this word, or NULL. */
const struct param *param_called(const char *word);
/* Whether `word` is a part of a key or its usual name. */
bool param_may_be(const struct param *param, const char *word);

/* The expression of a component of a TIME_VECTOR; NULL: it is a number. */
const struct expr *param_in_time(const struct param *param, const void *section, int component);

/* Whether a section has the default value of a key. */
bool param_is_default(const struct param *param, const void *section);

/* Whether a scheme sets a key in a kind of scene, and its value. */
bool scheme_sets(enum scheme scheme, enum scene_kind kind, enum section_id section, const char *key,
                 double *value);

/* Whether the scene's `scheme` sets a key, and its value. */
bool scene_scheme_sets(const struct scene *scene, enum section_id section, const char *key,
                       double *value);

/* The name of a CHOICE's value, copied into `name`. */
void param_choice_name(const struct param *param, int value, char name[SCENE_NAME]);

/* The candidate nearest to a misspelt word, or NULL if none is near. To be called for each
 * candidate with the same `best`, which starts as {0}. */
struct nearest {
    const char *name;
    int distance;
};
void nearest_offer(struct nearest *best, const char *word, const char *candidate);

#endif
