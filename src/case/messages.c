/* SPDX-License-Identifier: MIT
 * Problems of a case file: one sentence each, which begins with the place, sorted by line. */
#include "case/case.h"

#include <stdarg.h>

/* In the order of their lines, each once: numbers at the top are also read as constants. */
static void store(struct reader *r, const struct problem *p)
{
    int n = r->n_problems;
    for (int k = 0; k < n && k < CASE_MAX_PROBLEMS; k++)
        if (strcmp(r->problems[k].text, p->text) == 0) return;
    if (r->n_problems++ >= CASE_MAX_PROBLEMS) return;
    for (; n > 0 && r->problems[n - 1].line > p->line; n--) r->problems[n] = r->problems[n - 1];
    r->problems[n] = *p;
}

enum err problem(struct reader *r, struct problem_place at, const char *format, ...)
{
    char place[120], head[200] = "";
    const struct entry *const e = at.entry;
    const struct scene_section_common *const s = at.section;
    struct problem p = {.line = e ? e->line : s ? s->line : at.line};
    if (at.key) p.line = key_line(r->scene, (enum section_id)s->section, s->index, at.key);
    if (e && e->set) snprintf(place, sizeof place, "--set %.100s", e->set);
    if (at.value)
        snprintf(head, sizeof head, "%s = %.60s%s: ", e ? e->key : at.key, at.value,
                 strlen(at.value) > 60 ? "..." : "");
    else if (s)
        snprintf(head, sizeof head, "%s ", section_title(s).text);
    const int length = snprintf(p.text, sizeof p.text, "%s: %s",
                                e && e->set ? place : scene_place(r->scene, p.line).text, head);
    va_list args;
    va_start(args, format);
    vsnprintf(p.text + length, sizeof p.text - (size_t)length, format, args);
    va_end(args);
    store(r, &p);
    return ERR_INPUT;
}

enum err case_go_on(const struct reader *r, enum err e)
{
    return e == ERR_INPUT && r->n_problems < CASE_MAX_PROBLEMS ? ERR_OK : e;
}

void case_report(struct reader *r)
{
    const int n = r->n_problems < CASE_MAX_PROBLEMS ? r->n_problems : CASE_MAX_PROBLEMS;
    for (int k = 0; k < n; k++) diag_add(r->diag, ERR_INPUT, "%s", r->problems[k].text);
    if (n == CASE_MAX_PROBLEMS)
        diag_add(r->diag, ERR_INPUT, "%.900s: reading stopped after %d problems; there may be more",
                 r->scene->path, n);
}
