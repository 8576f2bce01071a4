/* SPDX-License-Identifier: MIT
 * Which changes of a case a restart or a fork accepts. */
#include "app/session.h"

/* A line of an effective case, and the section that it is in. */
struct line {
    const char *text, *next;
    int length;
    char section[128];
};

static bool is_word(const char *text, const char *word, const char *ends)
{
    const size_t n = strlen(word);
    return strncmp(text, word, n) == 0 && text[n] && strchr(ends, text[n]);
}

static bool is_one_of(const char *text, const char *const *words, const char *ends)
{
    for (; *words; words++)
        if (is_word(text, *words, ends)) return true;
    return false;
}

/* All keys but end_time and [output]; of [output] those that define the datasets of snapshots. Of a
 * [table] its contents, which are in a comment, and not its path: a run may be moved. The curve of
 * a [reference] does not affect the run. */
static bool matters_to_restart(const struct line *line)
{
    static const char *const datasets[] = {"snapshot_fields", "snapshot_precision", NULL};
    static const char *const of_files[] = {"[table", "[reference", NULL};
    if (is_one_of(line->section, of_files, " ") && is_word(line->text, "file", " ")) return false;
    if (!line->section[0]) return !is_word(line->text, "end_time", " ");
    return !is_word(line->section, "[output", "] ") || is_one_of(line->text, datasets, " ");
}

/* Keys that the state depends on: positions and masses of particles and bodies, the kernel, the
 * equation of state, and the fields of the integrator. */
static bool matters_to_fork(const struct line *line)
{
    static const char *const kept[] = {
        "dp",        "integrator",   "h_over_dp",     "lattice_origin",  "lattice_angle",
        "shape",     "minus",        "clamp",         "density",         "sound_speed",
        "max_speed", "max_pressure", "particle_mass", "solid_h_over_dp", "hinge",
        "mass",      "inertia",      "centre",        "thickness",       "element",
        NULL};
    static const char *const free_sections[] = {"[output", "[probe", "[reference",
                                                "[motion", "[table", NULL};
    if (is_one_of(line->section, free_sections, "] ")) return false;
    return line->text[0] == '[' || is_one_of(line->text, kept, " ");
}

/* Moves to the next line that matters; at the end the line is empty. */
static void next_line(struct line *line, bool fork)
{
    bool matters;
    do {
        line->text = line->next;
        line->length = (int)strcspn(line->text, "\n");
        line->next += line->length + (line->text[line->length] == '\n');
        if (line->text[0] == '[')
            snprintf(line->section, sizeof line->section, "%.*s", line->length, line->text);
        matters = line->length > 0 &&
                  (line->text[0] != '#' || is_word(line->section, "[table", " ")) &&
                  (fork ? matters_to_fork(line) : matters_to_restart(line));
    } while (!matters && *line->next);
    if (!matters) line->length = 0;
}

static bool is_key(const struct line *line) { return line->length > 0 && line->text[0] != '['; }

enum err case_change_check(const char *old, const char *now, bool fork, struct diag *d)
{
    const char *const what = fork ? "fork" : "restart";
    struct line a = {.next = old}, b = {.next = now};
    do {
        next_line(&a, fork);
        next_line(&b, fork);
    } while (a.length > 0 && a.length == b.length && memcmp(a.text, b.text, (size_t)a.length) == 0);
    if (a.length == 0 && b.length == 0) return ERR_OK;
    /* The section of a key that only the case has; the checkpoint's line is in a later one. */
    const char *const section = is_key(&b) && !is_key(&a)    ? b.section
                                : !is_key(&a) && !is_key(&b) ? "a section:"
                                                             : a.section;
    const int shown_a = a.length < 200 ? a.length : 200, shown_b = b.length < 200 ? b.length : 200;
    return diag_fail(
        d, ERR_INPUT, "%s: the case has changed since the checkpoint: %s '%.*s' is now '%.*s'; %s",
        what, section[0] ? section : "at the top", shown_a, a.text, shown_b, b.text,
        fork ? "shapes, masses, sound speed, kernel and integrator must stay; materials, "
               "motions, gravity and other numerics may change"
             : "only end_time, [output] and the number of threads may change; --fork starts a "
               "new run with other physics");
}
