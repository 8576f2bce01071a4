/* SPDX-License-Identifier: MIT */
#include "app/closing.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/shell.h"
#include "time/timestep.h"

static void say_cost(const struct sphfsi_options *o, const struct simulation *s,
                     const struct record *r)
{
    char text[1024] = "";
    size_t at = 0;
    double all = 0;
    for (int k = 0; k < PHASE_COUNT; k++) all += s->phase_seconds[k];
    for (int k = 0; k < PHASE_COUNT && all > 0; k++)
        if (s->phase_seconds[k] >= 0.005 * all)
            at += (size_t)snprintf(text + at, sizeof text - at, "%s%s %.0f %%", at ? ", " : "",
                                   phase_table[k].name, 100 * s->phase_seconds[k] / all);
    if (s->state.particle_steps > r->start_particle_steps)
        session_say(o, "%.3g million particle steps a second: %s", 1e-6 * report_rate(s, r), text);
}

/* What the user would otherwise have to look up: whether anything got lost. */
static void say_losses(const struct sphfsi_options *o, const struct simulation *s)
{
    const int64_t lost = s->state.lost, left = s->kind[KIND_FLUID].n;
    const bool bodies = s->effects & (FX_WALL | FX_COUPLING);
    session_say(o, "energy gained: at most %.3g J/m, %.2g %% of the available energy",
                s->state.gain, 100 * s->state.gain_share);
    if (!(s->effects & FX_FLUID)) return;
    if (bodies)
        session_say(o,
                    "fluid particles lost: %lld; largest number inside walls and solids at the "
                    "same time: %lld",
                    (long long)lost, (long long)s->state.entered);
    else
        session_say(o, "fluid particles lost: %lld", (long long)lost);
    if (lost == 0) return;
    struct diag d = session_diag(o);
    diag_warn(&d,
              "%lld of %lld fluid particles have left the domain: their mass and pressure are "
              "missing; a [wall] that holds them or a larger [domain] keeps them",
              (long long)lost, (long long)(lost + left));
}

void closing_say(const struct sphfsi_options *o, const struct simulation *s, const struct record *r)
{
    char text[1024];
    say_cost(o, s, r);
    say_losses(o, s);
    for (int k = 0; r->score && k < r->references->n; k++) {
        reference_line(&r->references->item[k], &r->score[k], text, sizeof text);
        session_say(o, "%s", text);
    }
}

/* --- the command that goes on --- */

/* The program as the user can call it from here; within another program, by its name. */
static void program_name(char name[PATH_BYTES])
{
    char path[PATH_BYTES], here[PATH_BYTES];
    const ssize_t n = readlink("/proc/self/exe", path, sizeof path - 1);
    snprintf(name, PATH_BYTES, "sphfsi");
    if (n <= 0) return;
    path[n] = '\0';
    char *const slash = strrchr(path, '/');
    if (!slash || strncmp(slash + 1, "sphfsi", 6) != 0) return;
    snprintf(name, PATH_BYTES, "%s", path);
    *slash = '\0';
    if (getcwd(here, sizeof here) && strcmp(here, path) == 0)
        snprintf(name, PATH_BYTES, "./%.*s", PATH_BYTES - 3, slash + 1);
}

/* A folder beside this one that does not exist yet: NAME-2, NAME-3, ... */
static void next_folder(const char *folder, char next[PATH_BYTES])
{
    struct stat info;
    for (int k = 2; k < 1000; k++) {
        snprintf(next, PATH_BYTES, "%.*s-%d", PATH_BYTES - 16, folder, k);
        if (stat(next, &info) != 0) return;
    }
}

/* A text that grows by words with a blank before each. */
struct words {
    char *text;
    size_t n, size;
};

static void add(struct words *w, const char *option, const char *operand)
{
    char quoted[QUOTED_BYTES] = "";
    if (operand) shell_quote(quoted, operand);
    if (w->n < w->size)
        w->n += (size_t)snprintf(w->text + w->n, w->size - w->n, "%s%s%s%s", w->n ? " " : "",
                                 option, *option && operand ? " " : "", quoted);
}

/* Steps half as long, as a setting. */
static void halve_steps(const struct simulation *s, char setting[64])
{
    double half;
    const char *const key = timestep_shorter(s, &half);
    snprintf(setting, 64, "numerics.%s=%.4g", key, half);
}

/* How a run goes on that a guard has stopped. */
enum remedy {
    SHORTER_STEPS,
    OTHER_CASE, /* from the checkpoint, once the case is changed as the message says */
    OTHER_START /* the same from the start: a checkpoint keeps its speed of sound and its state */
};

static enum remedy remedy_for(const struct simulation *s)
{
    const struct scene *const scene = s->scene;
    const bool fast = s->effects & FX_FLUID && scene->given_speed > SPEED_WARNING * scene->c0;
    if (fast || (s->state.steps <= 1 && scene->numerics.fixed_step == 0)) return OTHER_START;
    return s->guard.case_at_fault ? OTHER_CASE : SHORTER_STEPS;
}

void closing_command(const struct sphfsi_options *o, const struct simulation *s, const char *folder,
                     const char *checkpoint, bool guard)
{
    char name[PATH_BYTES], next[PATH_BYTES], number[32], setting[64];
    struct words w = {.size = 4 * (size_t)QUOTED_BYTES};
    if (!o->case_path || !(w.text = malloc(w.size))) return;
    program_name(name);
    next_folder(folder, next);
    add(&w, "", name);
    add(&w, "", o->case_path);
    const enum remedy remedy = guard ? remedy_for(s) : OTHER_CASE;
    if (!guard) add(&w, "--restart", NULL);
    if (guard && remedy != OTHER_START) add(&w, "--fork", checkpoint);
    for (int k = 0; k < o->n_sets; k++) add(&w, "--set", o->sets[k]);
    halve_steps(s, setting);
    if (guard && remedy == SHORTER_STEPS) add(&w, "--set", setting);
    snprintf(number, sizeof number, "%.12g", o->until); /* as session_time rounds it */
    if (o->until > 0) add(&w, "--until", number);
    snprintf(number, sizeof number, "%d", o->threads);
    if (o->threads > 0) add(&w, "--threads", number);
    if (guard || o->out || o->fork) add(&w, "--out", guard ? next : folder);
    if (w.n < w.size)
        session_result(o, "%s: %s",
                       !guard || remedy == SHORTER_STEPS ? "to go on"
                       : remedy == OTHER_CASE            ? "change the case, then go on"
                                                         : "change the case, then start again",
                       w.text);
    free(w.text);
}
