/* SPDX-License-Identifier: MIT
 * Arithmetic of case files: numbers with units, named constants, functions, and, where a value may
 * vary, the coordinates x and y in metres, the time t in seconds or the elongation e in metres.
 *
 *   sum     = product { (+|-) product }
 *   product = factor { (*|/) factor }
 *   factor  = (+|-) factor | primary [ ^ factor ]
 *   primary = number [ unit ] | unit | name | function ( sum [, sum] ) | ( sum )
 *   unit    = symbol [ ^ number ] { (*|/) symbol [ ^ number ] } | %
 *
 * A unit belongs to the number before it: 1/2 m is 1/(2 m). Symbols: m km cm mm um, s min ms us,
 * kg g (after a number), N, Pa kPa MPa GPa, Hz kHz, rad deg. Functions: sqrt sin cos tan sinh cosh
 * tanh exp log abs min max round, and tables; pi is a name.
 *
 * Dimensions are carried along. A plain number, written without a unit, may stand for any dimension
 * (it is SI); in a product with a number that has a unit it is a pure number. */
#pragma once

#include "base/base.h"

enum dim_kind {
    DIM_PLAIN, /* no unit given: compatible with all */
    DIM_KNOWN, /* powers of metre, kilogram, second */
    DIM_ANY    /* depends on x, y, t or e: not tracked, compatible with all */
};

struct dim {
    enum dim_kind kind;
    double power[3]; /* of kg, m, s */
};

struct quantity {
    double value; /* in SI units */
    struct dim dim;
};

/* A part of the case file's text. */
struct slice {
    const char *at;
    size_t length;
};

enum { EXPR_WHY = 320, EXPR_NAME = 64 };

/* Coordinates that can be used, as bits: none; x and y; t; these three; e. */
enum expr_scope {
    EXPR_FIXED,
    EXPR_IN_SPACE = 1,
    EXPR_IN_TIME = 2,
    EXPR_IN_BOTH = EXPR_IN_SPACE | EXPR_IN_TIME,
    EXPR_IN_ELONGATION = 4
};

/* A function by n rows of an argument x, which increases, and a value y. */
struct expr_table {
    int n;
    double *x, *y;
    double *slope; /* at the rows, of a smooth one; NULL: linear between the rows */
};
void expr_table_smooth(struct expr_table *table);

/* Resolves names: `find` returns true and the quantity, `table` a function, or false and NULL. Then
 * they have written the reason, or nothing if the name is unknown. */
struct expr_names {
    void *context;
    bool (*find)(void *context, const char *name, struct quantity *q, char why[EXPR_WHY]);
    enum expr_scope scope; /* coordinates that can be used */
    const struct expr_table *(*table)(void *context, const char *name, char why[EXPR_WHY]);
};

/* Compiled: evaluated at many points. */
struct expr;

/* The value of an expression without x and y; false: `why` has the error. */
bool expr_value(struct slice text, const struct expr_names *names, struct quantity *result,
                char why[EXPR_WHY]);

/* Compiles for the functions below. ERR_INPUT: `why` has the error; ERR_MEMORY: in d. */
enum err expr_compile(struct expr **result, struct slice text, const struct expr_names *names,
                      struct dim *dim, struct arena *a, char why[EXPR_WHY], struct diag *d)
    SPHFSI_CHECKED;

/* Value of an expression at a point; of one in t or e alone, which is x here. */
double expr_at(const struct expr *e, double x, double y);
double expr_at_arg(const struct expr *e, double x);
/* Value of an expression in x, y and t. */
double expr_at_time(const struct expr *e, double x, double y, double t);

/* The value of an expression in t or e alone with two derivatives; at a kink those after it. */
struct expr_jet {
    double value, d1, d2;
};
struct expr_jet expr_jet_at(const struct expr *e, double t);
/* The integral of one in t or e alone, in parts between the rows of tables of this coordinate. The
 * relative error is about 1e-10 for each other kink, and round-off for polynomials of order 3. A
 * feature between the five points of a part is missed. */
double expr_integral(const struct expr *e, double from, double to);

/* Whether its value jumps by more than `size` between two times, or has no value, at time `at`. The
 * interval is halved as long as the slopes do not explain the change. So a smooth function, however
 * steep, is never reported; a jump may be missed in an interval with many other changes. */
bool expr_jumps(const struct expr *e, double from, double to, double size, double *at);

/* Whether the value of one in x, y and t depends on t. */
bool expr_varies(const struct expr *e);

/* A copy with operations of its own. */
enum err expr_copy(struct expr **copy, const struct expr *e, struct arena *a, struct diag *d)
    SPHFSI_CHECKED;
/* What is left of e at a time, in a copy: parts without x and y become numbers. */
void expr_fix_time(struct expr *fixed, const struct expr *e, double t);

/* The last row of the table of t alone in it that ends first and whose value still changes there;
 * infinite: there is none. A cubic ends at rest. `scope`: EXPR_IN_TIME or EXPR_IN_BOTH. */
double expr_table_end(const struct expr *e, enum expr_scope scope);

/* Whether it is a constant number. */
bool expr_is_number(const struct expr *e);

/* The text it was compiled from. */
const char *expr_source(const struct expr *e);

/* The existing meaning of a name that cannot be redefined, or NULL. */
const char *expr_reserved(const char *name);

/* --- expr/units.c --- */

/* Reads a unit ("kg/m^3") from the front of the text and applies it to q; false: no unit there, or
 * a wrong one, then `why` is written. */
bool unit_read(struct slice *text, struct quantity *q, char why[EXPR_WHY]);
bool unit_known(const char *name);
/* Dimension of a unit of case/params.def. */
struct dim unit_dim(const char *unit);

bool dim_same(const struct dim *a, const struct dim *b);
/* Whether a dimension fits a unit of case/params.def ("SI": any). */
bool dim_fits(const struct dim *dim, const char *unit);
/* "a pressure (Pa)". */
struct dim_text {
    char text[96];
};
struct dim_text dim_text(const struct dim *dim);

/* --- expr/text.c --- */

struct slice slice_of(const char *text);
/* A slice without its first n characters; one without blanks at both ends. */
struct slice slice_after(struct slice s, size_t n);
struct slice slice_trimmed(struct slice s);
/* Cuts a trimmed piece off the front of `rest` at a separator outside parentheses; false: none. */
bool slice_next(struct slice *rest, char separator, struct slice *piece);
int slice_count(struct slice text, char separator);
/* The identifier at the front, which may be empty; the length of the number there. */
struct slice slice_identifier(struct slice s);
size_t number_length(struct slice s);
/* Hint for a message on the count of numbers if a comma stands between digits; otherwise "". */
const char *comma_hint(const char *value);
