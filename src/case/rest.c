/* SPDX-License-Identifier: MIT
 * What can still be checked of a case with wrong values: shapes are sampled, so that problems of their
 * geometry are told in the same run, unless a wrong value may feed the sampling. */
#include "case/case.h"

#include <string.h>

/* Whether a value decides which shapes are sampled, and how. */
static bool shapes(const struct param *p)
{
    static const char *const keys[] = {"dp",
                                       "scheme",
                                       "accuracy",
                                       "h_over_dp",
                                       "solid_h_over_dp",
                                       "lattice_origin",
                                       "lattice_angle",
                                       "like",
                                       "joined"};
    if (p->type == PARAM_SHAPES && p->section != SECTION_load) return true;
    for (size_t k = 0; k < COUNT_OF(keys); k++)
        if (strcmp(p->key, keys[k]) == 0) return true;
    return false;
}

/* Whether it decides what lies among the shapes, or is evaluated at their particles. */
static bool places(const struct param *p)
{
    static const enum section_id sections[] = {SECTION_domain, SECTION_inflow, SECTION_outflow,
                                               SECTION_motion, SECTION_probe};
    if (p->type == PARAM_FIELD_EXPR || strcmp(p->key, "motion") == 0) return true;
    for (size_t k = 0; k < COUNT_OF(sections); k++)
        if (p->section == sections[k]) return true;
    return false;
}

void case_spoils(struct reader *r, const struct param *p)
{
    r->shapes_wrong |= shapes(p);
    r->places_wrong |= places(p);
}

void case_spoils_unknown(struct reader *r, enum section_id section, const char *word)
{
    struct nearest near = {0};
    bool known = false;
    for (int k = 0; k < PARAM_COUNT; k++) {
        const struct param *const p = &param_table[k];
        if (p->section == section) nearest_offer(&near, word, p->key);
        if (p->section != section || !param_may_be(p, word)) continue;
        case_spoils(r, p);
        known = true;
    }
    const struct param *const other = known       ? NULL
                                      : near.name ? param_find(section, near.name)
                                                  : param_called(word);
    if (other) case_spoils(r, other);
    if (!known && !other) r->shapes_wrong = true;
}

enum scene_rest case_rest(const struct reader *r)
{
    /* A misspelled key may stand for `dp`, which is then not said to be missing. */
    if (!(r->scene->top.dp > 0)) return REST_NOTHING;
    if (!r->checked || r->lost || r->shapes_wrong || r->n_problems >= CASE_MAX_PROBLEMS)
        return REST_NOTHING;
    return r->places_wrong ? REST_SHAPES : REST_PLACES;
}
