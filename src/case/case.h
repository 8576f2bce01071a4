/* SPDX-License-Identifier: MIT
 * Inside of the reader of case files: what its files share. Others use case/scene.h.
 *
 * The format. Lines of `key = value`, `[section]` or `[section NAME]`, and comments from # to the
 * end of the line. Keys before the first section are the top of the file. [constants] names free
 * numbers; a constant may use others, in any order, and the numbers at the top. Which keys there
 * are, their units, ranges and defaults: case/params.def. Values by type:
 *
 *   number       arithmetic with units, functions, constants: expr/expr.h
 *   vector       two numbers with a comma between them
 *   choice       one of the names of case/params.def
 *   text         as it is; between double quotes it may hold # or be empty
 *   expressions  one or two, with a comma between them; in x and y (metres), evaluated per particle
 *   shape        box, circle, polygon, polyline: case/shapes.c; the key may be repeated, the shapes
 *                unite (`minus` regions are taken out of all of them)
 *
 * `like = NAME` takes the values, but not the regions, of an earlier section of the same kind as
 * defaults. --set key=value and --set section.key=value replace an entry, or add it, before
 * anything is evaluated; the section is NAME, `kind NAME`, or the word of an unnamed section. */
#pragma once

#include "case/params.h"

enum {
    CASE_MAX_BYTES = 4 << 20,
    CASE_MAX_LINES = 20000,
    CASE_MAX_CONSTANTS = 512,
    CASE_MAX_POINTS = 4096, /* of a polygon */
    CASE_MAX_PROBLEMS = 20, /* reported once per case */
    PROBLEM_TEXT = 1024,
};

/* One `key = value`. */
struct entry {
    int section;     /* index into reader.sections */
    int line;        /* 0 if it came from --set */
    const char *set; /* the --set argument, or NULL */
    const char *key, *value;
};

struct case_section {
    int id; /* enum section_id or SECTION_constants */
    const char *name;
    int line;
    int index; /* its number among the sections of its kind */
};

struct constant {
    const struct entry *entry;
    enum { CONSTANT_TEXT, CONSTANT_BUSY, CONSTANT_DONE } state;
    struct quantity q;
};

struct problem {
    int line; /* 0: from --set */
    char text[PROBLEM_TEXT];
};

struct reader {
    struct scene *scene;
    struct diag *diag;
    struct arena temp; /* valid until the scene is read */
    int n_entries, n_sections, n_constants;
    struct entry *entries;
    struct case_section *sections; /* the first one is the top of the file */
    struct constant *constants;    /* and the numbers at the top, which can be used as names */
    const struct entry *entry;     /* being read; problems name it */
    const void *section;           /* being checked, likewise */
    int depth;                     /* of constants that depend on constants */
    bool cause_named;              /* the message names the invalid constant */
    bool in_unknown_section;       /* after a section header that is invalid */
    bool incomplete;               /* invalid lines, sections or keys are skipped */
    int n_problems;                /* those beyond the array are only counted */
    struct problem problems[CASE_MAX_PROBLEMS];
};

/* --- case/messages.c: problems are stored, so that all of them are reported --- */

/* Where a problem is: a line, an entry, or a section, there the line of `key` if it is not NULL.
 * The macros name what the reader is at. The message begins with FILE:LINE or --set, then [section]
 * or, with `value`, key = value. */
struct problem_place {
    int line;
    const struct entry *entry;
    const void *section;
    const char *key, *value;
};
/* Stores a problem; returns ERR_INPUT. */
enum err problem(struct reader *r, struct problem_place at, const char *format, ...)
    SPHFSI_PRINTF(3, 4);
#define bad_line(r, n, ...) problem(r, (struct problem_place){.line = (n)}, __VA_ARGS__)
#define bad_entry(r, ...) problem(r, (struct problem_place){.entry = (r)->entry}, __VA_ARGS__)
#define bad_value(r, ...) \
    problem(r, (struct problem_place){.entry = (r)->entry, .value = (r)->entry->value}, __VA_ARGS__)
#define bad_section(r, ...) problem(r, (struct problem_place){.section = (r)->section}, __VA_ARGS__)
#define bad_key(r, k, v, ...)                                                             \
    problem(r, (struct problem_place){.section = (r)->section, .key = (k), .value = (v)}, \
            __VA_ARGS__)

/* Replaces the error of a stored problem by ERR_OK, as long as more can be stored. */
enum err case_go_on(const struct reader *r, enum err e) SPHFSI_CHECKED;
/* The problems stored so far, sorted by line, as the failure in the diag. */
void case_report(struct reader *r);

/* case/lines.c: text and --set arguments to sections and entries; the entry of a key, or NULL. */
enum err case_split(struct reader *r, const char *text, int n_sets, const char *const *sets)
    SPHFSI_CHECKED;
const struct entry *case_entry(const struct reader *r, int section, const char *key);

/* case/numbers.c: finds the names of constants and numbers at the top; then evaluates all. */
enum err case_collect_constants(struct reader *r) SPHFSI_CHECKED;
enum err case_all_constants(struct reader *r) SPHFSI_CHECKED;
/* The constant of a name: `find` of struct expr_names; `context` is the reader. */
bool case_name(void *context, const char *name, struct quantity *q, char why[EXPR_WHY]);
/* All names of a case, with a scope. */
struct expr_names case_names(struct reader *r, enum expr_scope scope);
/* Stores why an expression has no value, unless that follows from a problem already stored. */
enum err case_bad_expression(struct reader *r, const char *why);
/* A number of the dimension `unit` from a piece of the entry's value. */
enum err case_number(struct reader *r, struct slice text, const char *unit, double *value)
    SPHFSI_CHECKED;
enum err case_check_dim(struct reader *r, const struct dim *dim, const char *unit) SPHFSI_CHECKED;

/* case/values.c: an entry's text to its value; case/shapes.c: adds a shape or a hinge. */
enum err case_value(struct reader *r, const struct param *param, void *section) SPHFSI_CHECKED;
enum err case_shape(struct reader *r, struct shape_list *list) SPHFSI_CHECKED;
enum err case_hinge(struct reader *r, struct hinge_list *list) SPHFSI_CHECKED;
extern const char *const shape_words[];

/* case/presets.c: what `scheme` and `accuracy` choose stands in for the defaults, so that a key of
 * the case wins; and defaults that depend on other values. */
void case_apply_presets(struct reader *r);
void case_apply_defaults(struct scene *scene);

/* case/spring.c */
enum err case_check_spring(struct reader *r, const void *section) SPHFSI_CHECKED;

/* case/rigid.c: rigid bodies as walls with a motion, beams as walls; sections without these. */
enum err case_place_bodies(struct reader *r) SPHFSI_CHECKED;
int case_given_count(const struct scene *scene, enum section_id id);

/* case/check.c: names of other sections; then conditions on a valid scene, on each section by a
 * function of its own, on open boundaries (case/open.c) and on effects (case/effects.c). */
enum err case_check_names(struct reader *r) SPHFSI_CHECKED;
enum err case_check(struct reader *r) SPHFSI_CHECKED;
enum err case_check_rigid(struct reader *r, const void *section) SPHFSI_CHECKED;
/* Whether a first wall other than `held` has the name; else `near` has the nearest of theirs. */
bool case_may_hold(const struct scene *scene, const struct scene_section_common *held, int walls,
                   const char *name, struct nearest *near);
/* The thin line of a beam's wall: its points are the beam's nodes (case/beam.c). */
enum err case_draw_beam(struct reader *r, int beam) SPHFSI_CHECKED;
enum err case_check_beam(struct reader *r, const void *section) SPHFSI_CHECKED;
enum err case_check_open(struct reader *r, const void *section) SPHFSI_CHECKED;
enum err case_check_effects(struct reader *r) SPHFSI_CHECKED;

/* case/tables.c: opens the text table of a name, which is relative to the case. Messages go to the
 * diag of `csv`; the caller closes it, also after a failure. */
struct csv;
enum err table_open(const struct scene *scene, struct csv *csv, const char *name) SPHFSI_CHECKED;
/* The functions of all [table] sections. Then one by its name: `table` of struct expr_names. */
enum err case_load_functions(struct reader *r) SPHFSI_CHECKED;
const struct expr_table *case_function(void *context, const char *name, char why[EXPR_WHY]);
