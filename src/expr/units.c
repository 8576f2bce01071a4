/* SPDX-License-Identifier: MIT
 * Units after numbers, and their dimensions. */
#include "expr/expr.h"
#include "base/elementary.h"

#include <ctype.h>
#include <stdlib.h>

/* A unit is up/down SI units. Two whole numbers, so that 140 mm is the same double as 0.14. */
static const struct unit {
    const char *symbol;
    double up, down;
    int power[3]; /* of kg, m, s */
} units[] = {
    {"m", 1, 1, {0, 1, 0}},       {"km", 1e3, 1, {0, 1, 0}},    {"cm", 1, 1e2, {0, 1, 0}},
    {"mm", 1, 1e3, {0, 1, 0}},    {"um", 1, 1e6, {0, 1, 0}},    {"s", 1, 1, {0, 0, 1}},
    {"min", 60, 1, {0, 0, 1}},    {"ms", 1, 1e3, {0, 0, 1}},    {"us", 1, 1e6, {0, 0, 1}},
    {"kg", 1, 1, {1, 0, 0}},      {"g", 1, 1e3, {1, 0, 0}},     {"N", 1, 1, {1, 1, -2}},
    {"Pa", 1, 1, {1, -1, -2}},    {"kPa", 1e3, 1, {1, -1, -2}}, {"MPa", 1e6, 1, {1, -1, -2}},
    {"GPa", 1e9, 1, {1, -1, -2}}, {"Hz", 1, 1, {0, 0, -1}},     {"kHz", 1e3, 1, {0, 0, -1}},
    {"rad", 1, 1, {0, 0, 0}},     {"deg", PI, 180, {0, 0, 0}},
};

static const struct {
    int power[3]; /* of kg, m, s */
    const char *text;
} dimension_names[] = {
    {{0, 0, 0}, "a pure number"},
    {{0, 1, 0}, "a length (m)"},
    {{0, 2, 0}, "an area (m^2)"},
    {{0, 0, 1}, "a time (s)"},
    {{1, 0, 0}, "a mass (kg)"},
    {{0, 1, -1}, "a speed (m/s)"},
    {{0, 1, -2}, "an acceleration (m/s^2)"},
    {{1, -3, 0}, "a density (kg/m^3)"},
    {{1, -1, -2}, "a pressure (Pa)"},
    {{0, 0, -1}, "a frequency (Hz)"},
    {{1, 1, -2}, "a force (N)"},
    {{1, 0, -2}, "a force per length (N/m)"},
    {{0, 2, -1}, "a kinematic viscosity (m^2/s)"},
    {{1, 2, -2}, "an energy or a moment (N m)"},
};

static const struct unit *find_unit(struct slice name)
{
    for (size_t k = 0; k < COUNT_OF(units); k++)
        if (strlen(units[k].symbol) == name.length &&
            memcmp(units[k].symbol, name.at, name.length) == 0)
            return &units[k];
    return NULL;
}

bool unit_known(const char *name) { return find_unit(slice_of(name)) != NULL; }

/* The number after ^, or 1 if there is no ^. */
static bool read_power(struct slice *text, double *power, char why[EXPR_WHY])
{
    *power = 1;
    struct slice rest = slice_trimmed(*text);
    if (!rest.length || *rest.at != '^') return true;
    rest = slice_trimmed(slice_after(rest, 1));
    const size_t sign = rest.length && (*rest.at == '-' || *rest.at == '+');
    const size_t n = sign + number_length(slice_after(rest, sign));
    char digits[16], *end;
    snprintf(digits, sizeof digits, "%.*s", (int)n, rest.at);
    *power = strtod(digits, &end);
    if (*end || end == digits || fabs(*power) > 9) {
        snprintf(why, EXPR_WHY, "the exponent of a unit must be a number from -9 to 9");
        return false;
    }
    *text = slice_after(rest, n);
    return true;
}

static void apply(struct quantity *q, const struct unit *u, double power)
{
    if (power == floor(power)) {
        const double up = power > 0 ? u->up : u->down, down = power > 0 ? u->down : u->up;
        for (int k = 0; k < (int)fabs(power); k++) q->value = q->value * up / down;
    } else {
        q->value *= elementary_pow(u->up / u->down, power);
    }
    q->dim.kind = DIM_KNOWN;
    for (int k = 0; k < 3; k++) q->dim.power[k] += power * u->power[k];
}

bool unit_read(struct slice *text, struct quantity *q, char why[EXPR_WHY])
{
    struct slice rest = slice_trimmed(*text);
    if (rest.length && *rest.at == '%') {
        q->value /= 100;
        q->dim.kind = DIM_KNOWN;
        *text = slice_after(rest, 1);
        return true;
    }
    const struct unit *u = find_unit(slice_identifier(rest));
    const bool found = u != NULL;
    for (double power, sign = 1; u;) {
        rest = slice_after(rest, strlen(u->symbol));
        if (!read_power(&rest, &power, why)) return false;
        apply(q, u, sign * power);
        *text = rest;
        rest = slice_trimmed(rest);
        if (!rest.length || (*rest.at != '/' && *rest.at != '*')) break;
        sign = *rest.at == '/' ? -1 : 1;
        rest = slice_trimmed(slice_after(rest, 1));
        u = find_unit(slice_identifier(rest));
        /* Not g, which usually means the gravitational acceleration, nor the function min. */
        const struct slice next = slice_trimmed(slice_after(rest, u ? strlen(u->symbol) : 0));
        if (u && (strcmp(u->symbol, "g") == 0 || (next.length && *next.at == '('))) break;
    }
    return found;
}

/* The dimension of a unit such as "m/s^2", "1/s" or "1". */
struct dim unit_dim(const char *unit)
{
    const bool inverse = strncmp(unit, "1/", 2) == 0;
    struct quantity q = {1, {DIM_KNOWN, {0, 0, 0}}};
    struct slice text = slice_of(unit + (inverse ? 2 : 0));
    char why[EXPR_WHY];
    unit_read(&text, &q, why);
    if (inverse)
        for (int k = 0; k < 3; k++) q.dim.power[k] *= -1;
    return q.dim;
}

bool dim_same(const struct dim *a, const struct dim *b)
{
    bool same = true;
    for (int k = 0; k < 3; k++) same &= fabs(a->power[k] - b->power[k]) < 1e-9;
    return same;
}

bool dim_fits(const struct dim *dim, const char *unit)
{
    const struct dim want = unit_dim(unit);
    return dim->kind != DIM_KNOWN || strcmp(unit, "SI") == 0 || dim_same(dim, &want);
}

struct dim_text dim_text(const struct dim *dim)
{
    struct dim_text to;
    static const char *const symbol[] = {"kg", "m", "s"};
    char above[sizeof to] = "", below[sizeof to] = "";
    int divisors = 0;
    const char *name = dim->kind == DIM_KNOWN ? NULL : "a plain number";
    for (size_t k = 0; !name && k < COUNT_OF(dimension_names); k++) {
        const int *const p = dimension_names[k].power;
        if (dim_same(&(struct dim){DIM_KNOWN, {p[0], p[1], p[2]}}, dim))
            name = dimension_names[k].text;
    }
    for (int k = 0; k < 3; k++) {
        const double power = dim->power[k];
        char *const side = power > 0 ? above : below, exponent[16] = "";
        const size_t used = strlen(side);
        if (fabs(power) < 1e-9) continue;
        if (fabs(power) != 1) snprintf(exponent, sizeof exponent, "^%.3g", fabs(power));
        snprintf(side + used, sizeof to - used, "%s%s%s", used ? " " : "", symbol[k], exponent);
        divisors += power < 0;
    }
    if (name)
        snprintf(to.text, sizeof to, "%s", name);
    else
        snprintf(to.text, sizeof to, "a quantity in %.30s%s%s%.30s%s", *above ? above : "1",
                 divisors ? "/" : "", divisors > 1 ? "(" : "", below, divisors > 1 ? ")" : "");
    return to;
}
