/* SPDX-License-Identifier: MIT
 * Units after numbers, and their dimensions. */
#include "case/expr.h"
#include "base/elementary.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* A unit is up/down SI units. Two whole numbers, so that 140 mm is the same double as 0.14. */
static const struct unit {
    const char *symbol;
    double up, down;
    int m, kg, s;
} units[] = {
    {"m", 1, 1, 1, 0, 0},       {"km", 1e3, 1, 1, 0, 0},    {"cm", 1, 1e2, 1, 0, 0},
    {"mm", 1, 1e3, 1, 0, 0},    {"um", 1, 1e6, 1, 0, 0},    {"s", 1, 1, 0, 0, 1},
    {"min", 60, 1, 0, 0, 1},    {"ms", 1, 1e3, 0, 0, 1},    {"us", 1, 1e6, 0, 0, 1},
    {"kg", 1, 1, 0, 1, 0},      {"g", 1, 1e3, 0, 1, 0},     {"N", 1, 1, 1, 1, -2},
    {"Pa", 1, 1, -1, 1, -2},    {"kPa", 1e3, 1, -1, 1, -2}, {"MPa", 1e6, 1, -1, 1, -2},
    {"GPa", 1e9, 1, -1, 1, -2}, {"Hz", 1, 1, 0, 0, -1},     {"kHz", 1e3, 1, 0, 0, -1},
    {"rad", 1, 1, 0, 0, 0},     {"deg", PI, 180, 0, 0, 0},
};

static const struct {
    int m, kg, s;
    const char *text;
} dimension_names[] = {
    {0, 0, 0, "a pure number"},
    {1, 0, 0, "a length (m)"},
    {2, 0, 0, "an area (m^2)"},
    {0, 0, 1, "a time (s)"},
    {0, 1, 0, "a mass (kg)"},
    {1, 0, -1, "a speed (m/s)"},
    {1, 0, -2, "an acceleration (m/s^2)"},
    {-3, 1, 0, "a density (kg/m^3)"},
    {-1, 1, -2, "a pressure (Pa)"},
    {0, 0, -1, "a frequency (Hz)"},
    {1, 1, -2, "a force (N)"},
    {-1, 0, 0, "an inverse length (1/m)"},
    {0, 1, -2, "a force per length (N/m)"},
    {3, 0, 0, "a volume (m^3)"},
    {2, 0, -1, "a kinematic viscosity (m^2/s)"},
    {-1, 1, -1, "a dynamic viscosity (Pa s)"},
    {2, 1, -2, "an energy or a moment (N m)"},
    {1, 1, -1, "an impulse (N s)"},
    {2, 1, -3, "a power (N m/s)"},
    {-3, 1, -2, "a force per volume (N/m^3)"},
};

static const struct unit *find_unit(const char *name, size_t length)
{
    for (size_t k = 0; k < COUNT_OF(units); k++)
        if (strlen(units[k].symbol) == length && memcmp(units[k].symbol, name, length) == 0)
            return &units[k];
    return NULL;
}

const char *strange_character(const char *text)
{
    static const struct {
        const char *bytes, *what;
    } strange[] = {
        {"\xE2\x88\x92", "a Unicode minus; write -"},
        {"\xE2\x80\x93", "a dash; write -"},
        {"\xE2\x80\x94", "a dash; write -"},
        {"\xC2\xA0", "a no-break space; write an ordinary space"},
        {"\xE2\x80\xAF", "a narrow no-break space; write an ordinary space"},
        {"\xE2\x80\x89", "a thin space; write an ordinary space"},
        {"\xC3\x97", "a multiplication sign; write *"},
        {"\xC2\xB7", "a multiplication dot; write *"},
        {"\xE2\x8B\x85", "a multiplication dot; write *"},
        {"\xC2\xB2", "a superscript 2; write ^2"},
        {"\xC2\xB3", "a superscript 3; write ^3"},
        {"\xC2\xB5", "a micro sign; write u, as in um"},
        {"\xCE\xBC", "a Greek mu; write u, as in um"},
        {"\xC2\xB0", "a degree sign; write deg"},
    };
    const char *first = NULL, *what = NULL;
    for (size_t k = 0; k < COUNT_OF(strange); k++) {
        const char *const at = strstr(text, strange[k].bytes);
        if (!at || (first && at >= first)) continue;
        first = at;
        what = strange[k].what;
    }
    return what;
}

const char *unit_nearest(const char *name, size_t length)
{
    for (size_t k = 0; k < COUNT_OF(units); k++)
        if (strlen(units[k].symbol) == length && strncasecmp(units[k].symbol, name, length) == 0)
            return units[k].symbol;
    return NULL;
}

bool unit_known(const char *name) { return find_unit(name, strlen(name)) != NULL; }

size_t identifier_length(struct slice text)
{
    size_t n = 0;
    while (n < text.length && (text.at[n] == '_' || isalpha((unsigned char)text.at[n]) ||
                               (n > 0 && isdigit((unsigned char)text.at[n]))))
        n++;
    return n;
}

static struct slice behind(struct slice text, size_t n)
{
    return (struct slice){text.at + n, text.length - n};
}

static struct slice without_space(struct slice text)
{
    while (text.length && (*text.at == ' ' || *text.at == '\t')) text = behind(text, 1);
    return text;
}

/* The number behind ^, or 1 if there is no ^. */
static bool read_power(struct slice *text, double *power, char why[EXPR_WHY])
{
    *power = 1;
    struct slice rest = without_space(*text);
    if (!rest.length || *rest.at != '^') return true;
    rest = without_space(behind(rest, 1));
    char digits[16];
    size_t n = 0;
    while (n < rest.length && n < sizeof digits - 1 &&
           (isdigit((unsigned char)rest.at[n]) || rest.at[n] == '.' ||
            (n == 0 && (rest.at[n] == '-' || rest.at[n] == '+'))))
        n++;
    memcpy(digits, rest.at, n);
    digits[n] = '\0';
    char *end;
    *power = strtod(digits, &end);
    if (n == 0 || *end || end == digits || fabs(*power) > 9) {
        snprintf(why, EXPR_WHY, "the exponent of a unit must be a number from -9 to 9");
        return false;
    }
    *text = behind(rest, n);
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
    q->dim.m += power * u->m;
    q->dim.kg += power * u->kg;
    q->dim.s += power * u->s;
}

/* The unit after * or /. Not g, which alone usually means the gravitational acceleration (no other
 * unit symbol may name a constant). */
static const struct unit *next_unit(struct slice rest)
{
    const size_t length = identifier_length(rest);
    const struct unit *u = find_unit(rest.at, length);
    if (!u || length >= EXPR_NAME || strcmp(u->symbol, "g") == 0) return NULL;
    const struct slice next = without_space(behind(rest, length));
    if (next.length && *next.at == '(') return NULL; /* the function min */
    return u;
}

bool unit_read(struct slice *text, struct quantity *q, char why[EXPR_WHY])
{
    struct slice rest = without_space(*text);
    if (rest.length && *rest.at == '%') {
        q->value /= 100;
        q->dim.kind = DIM_KNOWN;
        *text = behind(rest, 1);
        return true;
    }
    size_t length = identifier_length(rest);
    const struct unit *u = find_unit(rest.at, length);
    if (!u) return false;
    double sign = 1;
    for (;;) {
        rest = behind(rest, length);
        double power;
        if (!read_power(&rest, &power, why)) return false;
        apply(q, u, sign * power);
        const struct slice next = without_space(rest);
        if (!next.length || (*next.at != '/' && *next.at != '*')) break;
        const struct slice symbol = without_space(behind(next, 1));
        u = next_unit(symbol);
        if (!u) break;
        sign = *next.at == '/' ? -1 : 1;
        length = identifier_length(symbol);
        rest = symbol;
    }
    *text = rest;
    return true;
}

/* Of a unit in the spelling of case/params.def: "m/s^2", "1/s", or "1". */
static struct dim dim_of(const char *unit)
{
    const bool inverse = strncmp(unit, "1/", 2) == 0;
    struct quantity q = {1, {DIM_KNOWN, 0, 0, 0}};
    struct slice text = {unit + (inverse ? 2 : 0), strlen(unit) - (inverse ? 2 : 0)};
    char why[EXPR_WHY];
    unit_read(&text, &q, why);
    const double sign = inverse ? -1 : 1;
    return (struct dim){DIM_KNOWN, sign * q.dim.m, sign * q.dim.kg, sign * q.dim.s};
}

bool dim_fits(const struct dim *dim, const char *unit)
{
    if (dim->kind != DIM_KNOWN || strcmp(unit, "SI") == 0) return true;
    const struct dim want = dim_of(unit);
    return fabs(want.m - dim->m) < 1e-9 && fabs(want.kg - dim->kg) < 1e-9 &&
           fabs(want.s - dim->s) < 1e-9;
}

void dim_text(const struct dim *dim, char text[DIM_TEXT])
{
    if (dim->kind != DIM_KNOWN) {
        snprintf(text, DIM_TEXT, "a plain number");
        return;
    }
    for (size_t k = 0; k < COUNT_OF(dimension_names); k++) {
        if (fabs(dimension_names[k].m - dim->m) < 1e-9 &&
            fabs(dimension_names[k].kg - dim->kg) < 1e-9 &&
            fabs(dimension_names[k].s - dim->s) < 1e-9) {
            snprintf(text, DIM_TEXT, "%s", dimension_names[k].text);
            return;
        }
    }
    const char *const symbol[] = {"kg", "m", "s"};
    const double power[] = {dim->kg, dim->m, dim->s};
    char above[DIM_TEXT] = "", below[DIM_TEXT] = "";
    int factors = 0;
    for (int k = 0; k < 3; k++) {
        if (fabs(power[k]) < 1e-9) continue;
        char *const side = power[k] > 0 ? above : below;
        const size_t used = strlen(side);
        char exponent[16] = "";
        if (fabs(power[k]) != 1) snprintf(exponent, sizeof exponent, "^%.3g", fabs(power[k]));
        snprintf(side + used, DIM_TEXT - used, "%s%s%s", used ? " " : "", symbol[k], exponent);
        factors += power[k] < 0;
    }
    const char *const open = factors > 1 ? "(" : "", *const close = factors > 1 ? ")" : "";
    snprintf(text, DIM_TEXT, "a quantity in %.30s%s%s%.30s%s", *above ? above : "1",
             factors ? "/" : "", open, below, close);
}

void unit_dim_text(const char *unit, char text[DIM_TEXT])
{
    const struct dim dim = dim_of(unit);
    dim_text(&dim, text);
}
