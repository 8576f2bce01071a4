/* SPDX-License-Identifier: MIT */
#include "params.h"

#include <math.h>
#include <string.h>

#define WHERE_0(section) offsetof(struct scene, section), 0
#define WHERE_1(section) offsetof(struct scene, section), offsetof(struct scene, n_##section)

const struct section_info section_table[SECTION_COUNT] = {
#define SECTION(section, named) {#section, named, WHERE_##named(section), sizeof(struct scene_##section)},
#include "params.def"
};

/* In the table a bound is its value; whether it is open shows in how it is spelled. */
#define NEEDED NAN
#define OVER(v) (v)
#define UNDER(v) (v)
#define ROW(section_, type_, key_, meaning_)                                              \
    .section = SECTION_##section_, .type = PARAM_##type_, .key = #key_, .meaning = meaning_, \
    .offset = offsetof(struct scene_##section_, key_)

const struct param param_table[] = {
#define REAL(section, key, def, lo, hi, unit_, meaning)                                       \
    {ROW(section, REAL, key, meaning), .unit = unit_, .number_default = {def}, .low = lo,     \
     .high = hi, .needed = sizeof #def == sizeof "NEEDED" && #def[0] == 'N', .low_open = #lo[0] == 'O', \
     .high_open = #hi[0] == 'U'},
#define INTEGER(section, key, def, lo, hi, meaning) \
    {ROW(section, INTEGER, key, meaning), .number_default = {def}, .low = lo, .high = hi},
#define CHOICE(section, key, def, names, meaning) \
    {ROW(section, CHOICE, key, meaning), .choices = names, .number_default = {def}},
#define TEXT(section, key, def, meaning) {ROW(section, TEXT, key, meaning), .text_default = def},
#define VECTOR(section, key, dx, dy, unit_, meaning) \
    {ROW(section, VECTOR, key, meaning), .unit = unit_, .number_default = {dx, dy}},
#define FIELD_EXPR(section, key, count_, unit_, meaning) \
    {ROW(section, FIELD_EXPR, key, meaning), .unit = unit_, .count = count_},
#define SHAPES(section, key, meaning) {ROW(section, SHAPES, key, meaning), .unit = "m"},
#define NUMBERS(section, key, unit_, meaning) {ROW(section, NUMBERS, key, meaning), .unit = unit_},
#include "params.def"
};
const int param_count = COUNT_OF(param_table);
