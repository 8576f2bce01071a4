/* SPDX-License-Identifier: MIT
 * The functions of include/sphfsi.h. */
#include "app/budget.h"
#include "app/explain.h"
#include "base/files.h"
#include "app/forecast.h"
#include "app/inspect.h"
#include "app/manual.h"
#include "case/params.h"
#include "app/preview.h"
#include "output/probes.h"
#include "app/refine.h"
#include "app/run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)SPHFSI_INTERRUPT == (int)ERR_INTERRUPT && (int)SPHFSI_INPUT == (int)ERR_INPUT &&
                   (int)SPHFSI_MEMORY == (int)ERR_MEMORY && (int)SPHFSI_IO == (int)ERR_IO &&
                   (int)SPHFSI_GUARD == (int)ERR_GUARD,
               "the public results are the rows of errors.def");
_Static_assert((int)SPHFSI_PROBE_COLUMNS == (int)PROBE_MAX_COLUMNS, "values of a probe");
_Static_assert((int)SPHFSI_FLUID == (int)KIND_FLUID && (int)SPHFSI_WALL == (int)KIND_WALL &&
                   (int)SPHFSI_SOLID == (int)KIND_SOLID,
               "the public kinds are those of particles.h");

/* A force that the calling program has set. */
struct user_force {
    sphfsi_force *force;
    void *context;
};

struct sphfsi_simulation {
    struct session session;
    struct probes probes;
    struct user_force force[KIND_COUNT];
    bool stopped; /* by a guard */
};

static _Thread_local char last_error[sizeof((struct diag *)0)->text];
static _Thread_local char more_errors[sizeof((struct diag *)0)->more];

static enum sphfsi_status result(const struct diag *d, enum err e)
{
    if (e) snprintf(last_error, sizeof last_error, "%s", d->text);
    if (e) snprintf(more_errors, sizeof more_errors, "%s", d->more);
    return (enum sphfsi_status)e;
}

const char *sphfsi_version(void) { return SPHFSI_VERSION; }

const char *sphfsi_error(void) { return last_error; }

const char *sphfsi_more_errors(void) { return more_errors; }

int sphfsi_exit_status(enum sphfsi_status status, int signal_number)
{
    if (status == SPHFSI_INTERRUPT && signal_number > 0) return 128 + signal_number;
    return err_status((enum err)status);
}

const char *sphfsi_nearest(const char *word, const char *const *names, int n)
{
    struct nearest best = {0};
    for (int k = 0; k < n; k++) nearest_offer(&best, word, names[k]);
    return best.name;
}

enum sphfsi_status sphfsi_create(struct sphfsi_simulation **result_,
                                 const struct sphfsi_options *options)
{
    struct diag d = session_diag(options);
    *result_ = NULL;
    struct sphfsi_simulation *s = calloc(1, sizeof *s);
    if (!s)
        return result(&d,
                      diag_fail(&d, ERR_MEMORY, "simulation: no memory for %zu bytes", sizeof *s));
    enum err e = session_open(&s->session, options, &d);
    if (!e) {
        struct simulation *const sim = &s->session.simulation;
        e = probes_create(&s->probes, sim, &sim->arena, &d);
        if (e) session_close(&s->session);
    }
    if (e)
        free(s);
    else
        *result_ = s;
    return result(&d, e);
}

void sphfsi_free(struct sphfsi_simulation *s)
{
    if (!s) return;
    session_close(&s->session);
    free(s);
}

enum sphfsi_status sphfsi_step(struct sphfsi_simulation *s, double limit)
{
    struct diag d = {.code = ERR_OK};
    struct simulation *const sim = &s->session.simulation;
    if (s->stopped)
        return result(&d, diag_fail(&d, ERR_GUARD,
                                    "step: a guard has stopped this simulation; create a new one"));
    if (!(limit > sim->state.time))
        return result(&d, diag_fail(&d, ERR_INPUT,
                                    "step: the limit %.17g s is not later than the "
                                    "simulated time %.17g s",
                                    limit, sim->state.time));
    const enum err e = simulation_step(sim, limit, &d);
    s->stopped = e == ERR_GUARD;
    return result(&d, e);
}

enum sphfsi_status sphfsi_advance(struct sphfsi_simulation *s, double time)
{
    do {
        const enum sphfsi_status status = sphfsi_step(s, time);
        if (status) return status;
    } while (sphfsi_time(s) < time);
    return SPHFSI_OK;
}

double sphfsi_time(const struct sphfsi_simulation *s) { return s->session.simulation.state.time; }

double sphfsi_end_time(const struct sphfsi_simulation *s) { return s->session.scene.top.end_time; }

double sphfsi_time_step(const struct sphfsi_simulation *s)
{
    return s->session.simulation.state.dt;
}

int64_t sphfsi_steps(const struct sphfsi_simulation *s)
{
    return s->session.simulation.state.steps;
}

int64_t sphfsi_count(const struct sphfsi_simulation *s, enum sphfsi_kind kind)
{
    return (unsigned)kind < KIND_COUNT ? s->session.simulation.kind[kind].n : 0;
}

uint64_t sphfsi_hash(struct sphfsi_simulation *s)
{
    return simulation_hash(&s->session.simulation);
}

static enum sphfsi_type type_of(const struct field_info *f)
{
    if (strcmp(f->type, "double") == 0) return SPHFSI_DOUBLE;
    return f->size == 8 ? SPHFSI_INT64 : SPHFSI_INT32;
}

enum sphfsi_status sphfsi_field(struct sphfsi_simulation *s, enum sphfsi_kind kind,
                                const char *name, struct sphfsi_view *view)
{
    struct diag d = {.code = ERR_OK};
    struct simulation *const sim = &s->session.simulation;
    const struct particles *p = (unsigned)kind < KIND_COUNT ? &sim->kind[kind] : NULL;
    if (p && (strcmp(name, "p") == 0 || strcmp(name, "ddens") == 0)) simulation_refresh(sim);
    for (int k = 0; p && k < field_count; k++) {
        const struct field_info *f = &field_table[k];
        const void *data = strcmp(f->name, name) == 0 ? field_array(p, f) : NULL;
        if (!data) continue;
        if (f->group == G_SOLID && f->keep == KEEP_DERIVED)
            solid_show(&sim->solid, &sim->kind[KIND_SOLID]);
        if (kind == SPHFSI_FLUID && data == p->p) fluid_show(&sim->fluid, &sim->kind[KIND_FLUID]);
        *view = (struct sphfsi_view){data, p->n, type_of(f), f->unit, f->meaning};
        return SPHFSI_OK;
    }
    struct nearest best = {0};
    for (int k = 0; p && k < field_count; k++)
        if (field_array(p, &field_table[k])) nearest_offer(&best, name, field_table[k].name);
    return result(&d,
                  diag_fail(&d, ERR_INPUT,
                            "field: %s particles have no field '%.60s' in this "
                            "scene%s%s",
                            p ? kind_names[kind] : "these", name,
                            best.name ? "; the nearest name is " : "", best.name ? best.name : ""));
}

enum sphfsi_status sphfsi_probe(struct sphfsi_simulation *s, const char *name,
                                double values[SPHFSI_PROBE_COLUMNS])
{
    struct diag d = {.code = ERR_OK};
    const struct scene *const scene = &s->session.scene;
    struct nearest near = {0};
    for (int k = 0; k < scene->n_probe; k++) {
        const char *const candidate = scene->probe[k].common.name;
        nearest_offer(&near, name, candidate);
        if (strcmp(candidate, name) != 0) continue;
        probes_values(&s->probes, &s->session.simulation, k, values);
        return SPHFSI_OK;
    }
    return result(&d,
                  diag_fail(&d, ERR_INPUT, "probe: the case has no [probe %.60s]%s%s", name,
                            near.name ? "; the nearest name is " : "", near.name ? near.name : ""));
}

static void add_user_force(void *context, double time, const struct particles *p, double *ax,
                           double *ay)
{
    const struct user_force *const user = context;
    const struct sphfsi_particles view = {time, p->n, p->id, p->body, p->x, p->y, p->vx, p->vy};
    user->force(user->context, &view, ax, ay);
}

enum sphfsi_status sphfsi_set_force(struct sphfsi_simulation *s, enum sphfsi_kind kind,
                                    sphfsi_force *force, void *context)
{
    struct diag d = {.code = ERR_OK};
    struct simulation *const sim = &s->session.simulation;
    if ((kind != SPHFSI_FLUID && kind != SPHFSI_SOLID) || sim->kind[kind].capacity == 0)
        return result(&d, diag_fail(&d, ERR_INPUT,
                                    "force: must act on fluid or solid of the scene, not on %s",
                                    (unsigned)kind < KIND_COUNT ? kind_names[kind] : "this"));
    s->force[kind] = (struct user_force){force, context};
    return result(&d, simulation_push(sim, (enum kind)kind, force ? add_user_force : NULL,
                                      &s->force[kind], &d));
}

enum sphfsi_status sphfsi_set_motion(struct sphfsi_simulation *s, const char *name,
                                     sphfsi_motion *motion, void *context)
{
    struct diag d = {.code = ERR_OK};
    struct scene *const scene = &s->session.scene;
    const int at = scene_find_motion(scene, name);
    struct nearest near = {0};
    for (int k = 0; k < scene->n_motion; k++)
        nearest_offer(&near, name, scene->motion[k].common.name);
    if (at < 0)
        return result(&d, diag_fail(&d, ERR_INPUT, "motion: the case has no [motion %.60s]%s%s",
                                    name, near.name ? "; the nearest name is " : "",
                                    near.name ? near.name : ""));
    if (!scene->motion_hook)
        scene->motion_hook = arena_alloc(&scene->arena, (size_t)scene->n_motion,
                                         sizeof *scene->motion_hook, "motions", &d);
    if (!scene->motion_hook) return result(&d, ERR_MEMORY);
    scene->motion_hook[at] = (struct motion_hook){motion, context};
    return SPHFSI_OK;
}

enum sphfsi_status sphfsi_run(const struct sphfsi_options *options)
{
    struct diag d = session_diag(options);
    return result(&d, run_case(options, &d));
}

enum sphfsi_status sphfsi_refine(const struct sphfsi_options *options, int runs, double ratio)
{
    struct diag d = session_diag(options);
    return result(&d, refine_case(options, runs, ratio, &d));
}

enum sphfsi_status sphfsi_budget(const struct sphfsi_options *options, double seconds)
{
    struct diag d = session_diag(options);
    if (!(seconds > 0 && seconds <= 1e9))
        return result(&d, diag_fail(&d, ERR_INPUT,
                                    "budget = %g s: from above 0 to 1e9 are possible", seconds));
    struct session *x = calloc(1, sizeof *x);
    if (!x)
        return result(&d, diag_fail(&d, ERR_MEMORY, "budget: no memory for %zu bytes", sizeof *x));
    int threads;
    enum err e = forecast_open(x, options, &threads, &d);
    if (!e) {
        e = budget_session(x, threads, seconds, options, &d);
        forecast_close(x, threads);
    }
    free(x);
    return result(&d, e);
}

enum sphfsi_status sphfsi_explain(const struct sphfsi_options *options)
{
    struct diag d = session_diag(options);
    struct session *x = calloc(1, sizeof *x);
    if (!x)
        return result(&d, diag_fail(&d, ERR_MEMORY, "explain: no memory for %zu bytes", sizeof *x));
    int threads;
    enum err e = forecast_open(x, options, &threads, &d);
    if (!e) {
        e = explain_session(x, threads, options, &d);
        forecast_close(x, threads);
    }
    free(x);
    return result(&d, e);
}

enum sphfsi_status sphfsi_effective(const struct sphfsi_options *options, const char *path)
{
    struct diag d = session_diag(options);
    struct session *x = calloc(1, sizeof *x);
    if (!x)
        return result(&d, diag_fail(&d, ERR_MEMORY, "case: no memory for %zu bytes", sizeof *x));
    enum err e = session_read(x, options, &d);
    if (!e) {
        e = scene_write(&x->scene, path, &d);
        scene_free(&x->scene);
    }
    free(x);
    return result(&d, e);
}

enum sphfsi_status sphfsi_inspect(const char *file, const struct sphfsi_options *options)
{
    struct diag d = session_diag(options);
    return result(&d, inspect_file(file, options, &d));
}

static void preview_path(const struct sphfsi_options *o, char path[PATH_BYTES])
{
    const char *name = o->case_path ? o->case_path : "case";
    if (strrchr(name, '/')) name = strrchr(name, '/') + 1;
    const size_t length = strlen(name);
    const bool cfg = length > 4 && strcmp(name + length - 4, ".cfg") == 0;
    if (o->out)
        snprintf(path, PATH_BYTES, "%s", o->out);
    else
        snprintf(path, PATH_BYTES, "preview-%.*s.svg", (int)(cfg ? length - 4 : length), name);
}

enum sphfsi_status sphfsi_preview(const struct sphfsi_options *options)
{
    struct diag d = session_diag(options);
    char path[PATH_BYTES];
    struct session *x = calloc(1, sizeof *x);
    if (!x)
        return result(&d, diag_fail(&d, ERR_MEMORY, "preview: no memory for %zu bytes", sizeof *x));
    enum err e = session_read(x, options, &d);
    if (!e) {
        preview_path(options, path);
        e = preview_draw(&x->scene, path, &d);
        if (!e) session_say(options, "%s: the scene as it would start; any browser shows it", path);
        scene_free(&x->scene);
    }
    free(x);
    return result(&d, e);
}

enum sphfsi_status sphfsi_cite(const struct sphfsi_options *options)
{
    struct diag d = session_diag(options);
    struct session *x = calloc(1, sizeof *x);
    if (!x)
        return result(&d, diag_fail(&d, ERR_MEMORY, "cite: no memory for %zu bytes", sizeof *x));
    const enum err e = session_read(x, options, &d);
    if (!e) {
        manual_cite(&x->scene, effects_of_scene(&x->scene), options);
        scene_free(&x->scene);
    }
    free(x);
    return result(&d, e);
}

void sphfsi_keys(const struct sphfsi_options *options) { manual_keys(options); }

const char *sphfsi_template_name(int k) { return manual_template_name(k); }

const char *sphfsi_template(const char *name)
{
    struct diag d = {.code = ERR_OK};
    struct nearest near = {0};
    char list[256] = "";
    const char *const text = manual_template(name);
    if (text) return text;
    for (int k = 0; manual_template_name(k); k++) {
        const size_t at = strlen(list);
        snprintf(list + at, sizeof list - at, "%s%s", k ? ", " : "", manual_template_name(k));
        nearest_offer(&near, name, manual_template_name(k));
    }
    result(&d,
           diag_fail(&d, ERR_INPUT, "there is no template '%.60s'%s%s; known: %s", name,
                     near.name ? "; the nearest name is " : "", near.name ? near.name : "", list));
    return NULL;
}
