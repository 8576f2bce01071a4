/* SPDX-License-Identifier: MIT
 * Problems of a case file: one sentence each, which begins with the place, sorted by line. */
#include "case/case.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Stores a problem, whose text begins with the place, once: numbers at the top are also read as
 * constants. */
static enum err note(struct reader *r, int line, const char *text)
{
    for (int k = 0; k < r->n_problems && k < CASE_MAX_PROBLEMS; k++)
        if (strcmp(r->problems[k].text, text) == 0) return ERR_INPUT;
    if (r->n_problems < CASE_MAX_PROBLEMS) {
        struct problem *const p = &r->problems[r->n_problems];
        p->line = line;
        snprintf(p->text, sizeof p->text, "%s", text);
    }
    r->n_problems++;
    return ERR_INPUT;
}

enum err bad_line(struct reader *r, int line, const char *format, ...)
{
    char text[700], place[LOCATION_TEXT], all[PROBLEM_TEXT];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    scene_location(r->scene, line, place);
    snprintf(all, sizeof all, "%s: %s", place, text);
    return note(r, line, all);
}

enum err bad_entry(struct reader *r, const struct entry *e, const char *format, ...)
{
    char text[700], all[PROBLEM_TEXT];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (!e->set) return bad_line(r, e->line, "%s", text);
    snprintf(all, sizeof all, "--set %.100s: %s", e->set, text);
    return note(r, 0, all);
}

enum err bad_value(struct reader *r, const struct entry *e, const char *format, ...)
{
    char text[600];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    const bool cut = strlen(e->value) > 60;
    return bad_entry(r, e, "%s = %.60s%s: %s", e->key, e->value, cut ? "..." : "", text);
}

enum err case_go_on(const struct reader *r, enum err e)
{
    return e == ERR_INPUT && r->n_problems > 0 && r->n_problems < CASE_MAX_PROBLEMS ? ERR_OK : e;
}

bool case_sound(const struct reader *r, enum section_id id, int index)
{
    for (int k = 0; k < r->n_sections; k++)
        if (r->sections[k].id == (int)id && r->sections[k].index == index)
            return !r->sections[k].invalid;
    return true;
}

bool case_all_sound(const struct reader *r, enum section_id id)
{
    for (int k = 0; k < section_count(r->scene, id); k++)
        if (!case_sound(r, id, k)) return false;
    return true;
}

/* By line; problems of the same line stay in the order in which they were found. */
static void sort_problems(struct reader *r, int n)
{
    for (int k = 1; k < n; k++) {
        const struct problem p = r->problems[k];
        int j = k;
        for (; j > 0 && r->problems[j - 1].line > p.line; j--) r->problems[j] = r->problems[j - 1];
        r->problems[j] = p;
    }
}

static void offer_names(const struct reader *r, enum section_id kind, const char *given,
                        struct nearest *near)
{
    for (int k = 0; k < section_count(r->scene, kind); k++) {
        const struct scene_section_common *c = section_at(r->scene, kind, k);
        nearest_offer(near, given, c->name);
    }
}

enum err case_no_section(struct reader *r, int line, const char *what, const char *given,
                         enum section_id kind, enum section_id also)
{
    struct nearest near = {0};
    offer_names(r, kind, given, &near);
    offer_names(r, also, given, &near);
    char word[2 * SCENE_NAME];
    snprintf(word, sizeof word, also == kind ? "%s" : "%s] or [%s", section_table[kind].word,
             section_table[also].word);
    if (near.name)
        return bad_line(r, line, "%s = %.60s: there is no [%s] of that name; did you mean `%s`?",
                        what, given, word, near.name);
    return bad_line(r, line, "%s = %.60s: there is no [%s] of that name", what, given, word);
}

void case_report(struct reader *r)
{
    const int n = r->n_problems < CASE_MAX_PROBLEMS ? r->n_problems : CASE_MAX_PROBLEMS;
    if (n == 0) return;
    sort_problems(r, n);
    diag_fail(r->diag, ERR_INPUT, "%s", r->problems[0].text);
    for (int k = 1; k < n; k++) diag_more(r->diag, r->problems[k].text);
    if (n == CASE_MAX_PROBLEMS) {
        char text[PROBLEM_TEXT];
        snprintf(text, sizeof text, "%.900s: reading stopped after %d problems; there may be more",
                 r->scene->path, n);
        diag_more(r->diag, text);
    }
}
