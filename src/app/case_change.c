/* SPDX-License-Identifier: MIT */
#include "app/case_change.h"

#include <stdio.h>
#include <string.h>

enum { SECTION_TEXT = 128 };

/* A position in the text of an effective case: the current line and its section. */
struct place {
    const char *next, *line;
    int length;
    char section[SECTION_TEXT];
    bool (*matters)(const struct place *p);
};

static bool in_section(const struct place *p, const char *word)
{
    const size_t n = strlen(word);
    return p->section[0] == '[' && strncmp(p->section + 1, word, n) == 0 &&
           (p->section[n + 1] == ']' || p->section[n + 1] == ' ');
}

static bool has_key(const struct place *p, const char *key)
{
    const size_t n = strlen(key);
    return strncmp(p->line, key, n) == 0 && p->line[n] == ' ';
}

/* All keys but end_time and [output]; of [output] those that define the datasets of snapshots. */
static bool matters_to_restart(const struct place *p)
{
    if (p->length == 0 || p->line[0] == '#') return false;
    if (!p->section[0]) return !has_key(p, "end_time");
    return !in_section(p, "output") || has_key(p, "snapshot_fields") ||
           has_key(p, "snapshot_precision");
}

/* Keys that the state depends on: positions and masses of particles, the kernel, the equation of
 * state, and the fields of the integrator. */
static bool matters_to_fork(const struct place *p)
{
    static const char *const kept[] = {
        "dp",        "integrator",   "h_over_dp",     "lattice_origin",  "lattice_angle",
        "shape",     "minus",        "clamp",         "density",         "sound_speed",
        "max_speed", "max_pressure", "particle_mass", "solid_h_over_dp", "hinge"};
    static const char *const free_sections[] = {"output", "probe", "reference", "motion"};
    if (p->length == 0 || p->line[0] == '#') return false;
    for (size_t k = 0; k < COUNT_OF(free_sections); k++)
        if (in_section(p, free_sections[k])) return false;
    if (p->line[0] == '[') return true;
    for (size_t k = 0; k < COUNT_OF(kept); k++)
        if (has_key(p, kept[k])) return true;
    return false;
}

/* Moves to the next line that matters; at the end the line is empty. */
static void next_line(struct place *p)
{
    do {
        p->line = p->next;
        p->length = (int)strcspn(p->line, "\n");
        p->next += p->length + (p->line[p->length] == '\n');
        if (p->line[0] == '[') snprintf(p->section, sizeof p->section, "%.*s", p->length, p->line);
    } while (!p->matters(p) && *p->next);
    if (!p->matters(p)) p->length = 0;
}

static int shown(const struct place *p) { return p->length < 200 ? p->length : 200; }

static enum err differs(const struct place *a, const struct place *b, const char *what,
                        const char *may, struct diag *d)
{
    if (has_key(a, "dp") && has_key(b, "dp") && !a->section[0])
        return diag_fail(d, ERR_INPUT,
                         "%s: the checkpoint has '%.*s', but this case '%.*s': the spacing of "
                         "particles cannot change during a run; start a new run with the other dp",
                         what, shown(a), a->line, shown(b), b->line);
    return diag_fail(d, ERR_INPUT,
                     "%s: the case has changed since the checkpoint: %s '%.*s' is now '%.*s'; %s",
                     what, a->section[0] ? a->section : "at the top", shown(a), a->line, shown(b),
                     b->line, may);
}

static enum err compare(struct place a, struct place b, const char *what, const char *may,
                        struct diag *d)
{
    do {
        next_line(&a);
        next_line(&b);
        if (a.length != b.length || memcmp(a.line, b.line, (size_t)a.length) != 0)
            return differs(&a, &b, what, may, d);
    } while (a.length > 0);
    return ERR_OK;
}

enum err change_for_restart(const char *old, const char *now, struct diag *d)
{
    return compare((struct place){.next = old, .matters = matters_to_restart},
                   (struct place){.next = now, .matters = matters_to_restart}, "restart",
                   "only end_time, [output] and the number of threads may change; --fork starts a "
                   "new run with other physics",
                   d);
}

enum err change_for_fork(const char *old, const char *now, struct diag *d)
{
    return compare((struct place){.next = old, .matters = matters_to_fork},
                   (struct place){.next = now, .matters = matters_to_fork}, "fork",
                   "shapes, densities, sound speed, kernel and integrator must stay; materials, "
                   "motions, gravity and other numerics may change",
                   d);
}
