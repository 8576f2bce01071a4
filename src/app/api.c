/* SPDX-License-Identifier: MIT
 * The functions of include/sphfsi.h on a simulation that the calling program steps. */
#include "app/session.h"
#include "output/rows.h"
#include "check/check.h"
#include "output/point_data.h"

#include <stdatomic.h>
#include <stdlib.h>

_Static_assert((int)SPHFSI_INTERRUPT == (int)ERR_INTERRUPT && (int)SPHFSI_INPUT == (int)ERR_INPUT &&
                   (int)SPHFSI_MEMORY == (int)ERR_MEMORY && (int)SPHFSI_IO == (int)ERR_IO &&
                   (int)SPHFSI_GUARD == (int)ERR_GUARD,
               "the public results are those of base/base.h");
_Static_assert((int)SPHFSI_PROBE_COLUMNS == (int)PROBE_MAX_COLUMNS, "values of a probe");
_Static_assert((int)SPHFSI_FLUID == (int)KIND_FLUID && (int)SPHFSI_WALL == (int)KIND_WALL &&
                   (int)SPHFSI_SOLID == (int)KIND_SOLID,
               "the public kinds are those of particles.h");

/* A force or a motion that the calling program has set. */
struct user_function {
    struct sphfsi_simulation *of;
    sphfsi_force *force;
    sphfsi_motion *motion;
    void *context;
};

struct sphfsi_simulation {
    struct session session;
    struct probes probes;
    struct row_files means; /* of the probes */
    struct user_function force[KIND_COUNT];
    struct user_function *motion;          /* [n_motion]; NULL: none */
    double *computed[KIND_COUNT][D_COUNT]; /* fields that are computed when they are asked for */
    char column[PROBE_COLUMN_TEXT];        /* that was asked for last */
    int threads;                           /* of its parallel regions */
    struct host host;                      /* what the call that is going on gives back */
    atomic_bool busy;                      /* a call is going on */
    bool stopped;                          /* by a guard */
};

/* --- a call --- */

/* Begins a call that takes the whole simulation; `end` ends it, unless this has failed. */
static enum err begin(struct sphfsi_simulation *handle, const char *name, struct diag *d)
{
    *d = (struct diag){.code = ERR_OK};
    if (!handle) return diag_fail(d, ERR_INPUT, "%s: the simulation is NULL", name);
    if (atomic_exchange(&handle->busy, true))
        return diag_fail(
            d, ERR_INPUT,
            "%s: this simulation is in use by another call, of another thread or of the "
            "program that invoked this callback; wait until that call has returned",
            name);
    const enum err e = host_enter(&handle->host, handle->threads, d);
    if (e) atomic_store(&handle->busy, false);
    return e;
}

static enum sphfsi_status end(struct sphfsi_simulation *handle, const struct diag *d, enum err e)
{
    host_use(handle->host);
    atomic_store(&handle->busy, false);
    return call_result(d, e);
}

static enum err open_simulation(struct sphfsi_simulation *handle, const struct sphfsi_options *o,
                                struct diag *d)
{
    TRY(session_open(&handle->session, o, d));
    struct simulation *const sim = &handle->session.simulation;
    check_simulation(sim, d);
    enum err e = probes_create(&handle->probes, sim, &sim->arena, d);
    if (!e) e = rows_create(&handle->means, &handle->probes, sim, false, &sim->arena, d);
    if (!e) rows_follow(&handle->means, sim);
    if (e) session_close(&handle->session);
    handle->threads = thread_count();
    return e;
}

enum sphfsi_status sphfsi_create(struct sphfsi_simulation **created,
                                 const struct sphfsi_options *options)
{
    struct call c;
    if (!created) return call_null_argument("create", "place of the result");
    *created = NULL;
    enum err e = call_begin(&c, "create", options);
    if (e) return call_end(&c, e);
    struct sphfsi_simulation *handle = calloc(1, sizeof *handle);
    if (!handle)
        e = diag_fail(&c.diag, ERR_MEMORY, "simulation: no memory for %zu bytes", sizeof *handle);
    else
        e = open_simulation(handle, &c.options, &c.diag);
    if (e)
        free(handle);
    else
        *created = handle;
    return call_end(&c, e);
}

enum sphfsi_status sphfsi_free(struct sphfsi_simulation *handle)
{
    struct diag d;
    if (!handle) return SPHFSI_OK;
    const enum err e = begin(handle, "free", &d);
    if (e) return call_result(&d, e);
    const enum sphfsi_status status = end(handle, &d, ERR_OK);
    session_close(&handle->session);
    free(handle);
    return status;
}

static enum err step(struct sphfsi_simulation *handle, double limit, struct diag *d)
{
    struct simulation *const sim = &handle->session.simulation;
    if (handle->stopped)
        return diag_fail(d, ERR_GUARD,
                         "step: this simulation was stopped because its state is not valid, as the "
                         "earlier error says; create a new one");
    if (!(limit > simulation_time(sim)))
        return diag_fail(d, ERR_INPUT,
                         "step: the limit of %.17g s must be later than the simulated time, %.17g "
                         "s",
                         limit, simulation_time(sim));
    enum err e = relax_to_rest(sim, d);
    if (!e) e = simulation_step(sim, limit, d);
    handle->stopped = e == ERR_GUARD;
    return e;
}

enum sphfsi_status sphfsi_step(struct sphfsi_simulation *handle, double limit)
{
    struct diag d;
    const enum err e = begin(handle, "step", &d);
    return e ? call_result(&d, e) : end(handle, &d, step(handle, limit, &d));
}

enum sphfsi_status sphfsi_advance(struct sphfsi_simulation *handle, double time)
{
    struct diag d;
    enum err e = begin(handle, "advance", &d);
    if (e) return call_result(&d, e);
    if (!isfinite(time))
        e = diag_fail(&d, ERR_INPUT, "advance: the time %g s is not a finite number", time);
    do {
        if (!e) e = step(handle, time, &d);
    } while (!e && sphfsi_time(handle) < time);
    return end(handle, &d, e);
}

double sphfsi_time(const struct sphfsi_simulation *handle)
{
    return handle ? simulation_time(&handle->session.simulation) : (double)NAN;
}

double sphfsi_end_time(const struct sphfsi_simulation *handle)
{
    return handle ? handle->session.scene.top.end_time : (double)NAN;
}

double sphfsi_time_step(const struct sphfsi_simulation *handle)
{
    return handle ? handle->session.simulation.state.dt : (double)NAN;
}

double sphfsi_next_output(const struct sphfsi_simulation *handle)
{
    if (!handle) return (double)NAN;
    const struct scene_output *const out = &handle->session.scene.output;
    const double interval[] = {out->ledger_interval, out->snapshot_interval,
                               out->checkpoint_interval};
    const double time = simulation_time(&handle->session.simulation);
    double next = handle->session.scene.top.end_time;
    for (int k = -(int)COUNT_OF(interval); k < handle->probes.n_files; k++) {
        struct due due = {k < 0 ? interval[k + (int)COUNT_OF(interval)]
                                : handle->probes.file[k].interval,
                          0};
        due_pass(&due, time);
        next = min2(next, due_time(&due));
    }
    return next;
}

int64_t sphfsi_steps(const struct sphfsi_simulation *handle)
{
    return handle ? handle->session.simulation.state.steps : 0;
}

int64_t sphfsi_count(const struct sphfsi_simulation *handle, enum sphfsi_kind kind)
{
    return handle && (unsigned)kind < KIND_COUNT ? handle->session.simulation.particles[kind].n : 0;
}

uint64_t sphfsi_hash(struct sphfsi_simulation *handle)
{
    struct diag d;
    const enum err e = begin(handle, "hash", &d);
    if (e) return call_result(&d, e), 0;
    const uint64_t hash = simulation_hash(&handle->session.simulation);
    end(handle, &d, ERR_OK);
    return hash;
}

/* --- fields --- */

/* The arrays of snapshots that the particles have under another name, or not at all. */
#define POINTDATA(NAME, name, item, width, choice, unit) {D_##NAME, #name, unit, width},
static const struct {
    enum data what;
    const char *name, *unit;
    int width;
} file_field[] = {
    {D_POINTS, "Points", "m", 3},
#include "case/pointdata.def"
};

static bool has_file_field(const struct simulation *sim, enum kind kind, enum data what)
{
    const struct particles *const particles = &sim->particles[kind];
    const bool solid = kind == KIND_SOLID;
    switch (what) {
    case D_POINTS:
    case D_VELOCITY: return true;
    case D_DENSITY: return solid || particles->dens;
    case D_PRESSURE: return particles->p;
    case D_STRESS:
    case D_VON_MISES:
    case D_DET_F: return solid;
    case D_DISPLACEMENT: return solid || particles->X;
    case D_THICKNESS:
    case D_AXIAL_FORCE:
    case D_SHEAR_FORCE:
    case D_MOMENT:
    case D_CURVATURE: return kind == KIND_WALL && sim->beams.n > 0;
    default: return false; /* an array of the particles has the name */
    }
}

/* The name of the k-th field of a kind, first the arrays of particles; NULL after the last. */
static const char *field_name(const struct simulation *sim, enum kind kind, int k)
{
    if (sim->particles[kind].capacity == 0) return NULL;
    for (int f = 0; f < field_count; f++)
        if (field_array(&sim->particles[kind], &field_table[f]) && k-- == 0)
            return field_table[f].name;
    for (size_t f = 0; f < COUNT_OF(file_field); f++)
        if (has_file_field(sim, kind, file_field[f].what) && k-- == 0) return file_field[f].name;
    return NULL;
}

const char *sphfsi_field_name(const struct sphfsi_simulation *handle, enum sphfsi_kind kind, int k)
{
    if (!handle || (unsigned)kind >= KIND_COUNT || k < 0) return NULL;
    return field_name(&handle->session.simulation, (enum kind)kind, k);
}

static bool view_array(struct simulation *sim, enum kind kind, const char *name,
                       struct sphfsi_view *view)
{
    const struct particles *const particles = &sim->particles[kind];
    for (int k = 0; k < field_count; k++) {
        const struct field_info *f = &field_table[k];
        if (strcmp(f->name, name) != 0 || !field_array(particles, f)) continue;
        /* What an evaluation finds and integrators then weigh or exchange. */
        if (f->keep == KEEP_DERIVED || strcmp(name, "ax") == 0 || strcmp(name, "ay") == 0)
            (kind == KIND_WALL ? simulation_wall_forces : simulation_refresh)(sim);
        const void *const data = field_array(particles, f); /* integrators exchange arrays */
        if (f->group == G_SOLID && f->keep == KEEP_DERIVED)
            solid_write_stress(&sim->solid, &sim->particles[KIND_SOLID]);
        if (kind == KIND_FLUID && data == particles->p)
            fluid_write_pressure(&sim->fluid, &sim->particles[KIND_FLUID]);
        const enum sphfsi_type type = strcmp(f->type, "double") == 0 ? SPHFSI_DOUBLE
                                      : f->size == 8                 ? SPHFSI_INT64
                                                                     : SPHFSI_INT32;
        *view = (struct sphfsi_view){data, particles->n, type, 1, f->unit, f->meaning};
        return true;
    }
    return false;
}

static enum err compute(struct sphfsi_simulation *handle, enum kind kind, const char *name,
                        enum data what, int width, struct diag *d)
{
    struct simulation *const sim = &handle->session.simulation;
    double **const to = &handle->computed[kind][what];
    const size_t capacity = (size_t)sim->particles[kind].capacity * (size_t)width;
    if (!*to) TRY(arena_array(&sim->arena, to, capacity, name, d));
    simulation_refresh(sim);
    for (int64_t i = 0; i < sim->particles[kind].n; i++)
        for (int c = 0; c < width; c++)
            (*to)[i * width + c] = snapshot_value(what, sim, kind, i, c);
    return ERR_OK;
}

static enum err view_computed(struct sphfsi_simulation *handle, enum kind kind, const char *name,
                              struct sphfsi_view *view, struct diag *d)
{
    const struct simulation *const sim = &handle->session.simulation;
    for (size_t k = 0; k < COUNT_OF(file_field); k++) {
        const enum data what = file_field[k].what;
        if (strcmp(file_field[k].name, name) != 0 || !has_file_field(sim, kind, what)) continue;
        const int width = file_field[k].width;
        TRY(compute(handle, kind, name, what, width, d));
        *view = (struct sphfsi_view){
            handle->computed[kind][what], sim->particles[kind].n, SPHFSI_DOUBLE, width,
            file_field[k].unit,           "as in fields.vtkhdf"};
        return ERR_OK;
    }
    struct nearest best = {0};
    const char *known;
    for (int k = 0; (known = field_name(sim, kind, k)); k++) nearest_offer(&best, name, known);
    return diag_fail(d, ERR_INPUT, "field: %s particles have no field '%.60s' in this scene%s",
                     kind_names[kind], name, nearest_hint(&best));
}

static enum err find_field(struct sphfsi_simulation *handle, enum sphfsi_kind kind,
                           const char *name, struct sphfsi_view *view, struct diag *d)
{
    if (!name || !view)
        return diag_fail(d, ERR_INPUT, "field: the %s is NULL", name ? "view" : "name");
    if ((unsigned)kind >= KIND_COUNT)
        return diag_fail(d, ERR_INPUT, "field: kind = %d is not a kind of particles; use 0 to %d",
                         (int)kind, KIND_COUNT - 1);
    if (view_array(&handle->session.simulation, (enum kind)kind, name, view)) return ERR_OK;
    return view_computed(handle, (enum kind)kind, name, view, d);
}

enum sphfsi_status sphfsi_field(struct sphfsi_simulation *handle, enum sphfsi_kind kind,
                                const char *name, struct sphfsi_view *view)
{
    struct diag d;
    const enum err e = begin(handle, "field", &d);
    return e ? call_result(&d, e) : end(handle, &d, find_field(handle, kind, name, view, &d));
}

/* --- probes --- */

static enum err find_probe(struct sphfsi_simulation *handle, const char *name, double *values,
                           struct diag *d)
{
    const struct scene *const scene = &handle->session.scene;
    struct nearest near = {0};
    if (!name || !values)
        return diag_fail(d, ERR_INPUT, "probe: the %s NULL", name ? "values are" : "name is");
    for (int k = 0; k < scene->n_probe; k++) {
        const char *const candidate = scene->probe[k].common.name;
        nearest_offer(&near, name, candidate);
        if (strcmp(candidate, name) != 0) continue;
        probes_values(&handle->probes, &handle->session.simulation, k, values);
        return ERR_OK;
    }
    return diag_fail(d, ERR_INPUT, "probe: the case has no [probe %.60s]%s", name,
                     nearest_hint(&near));
}

enum sphfsi_status sphfsi_probe(struct sphfsi_simulation *handle, const char *name,
                                double values[SPHFSI_PROBE_COLUMNS])
{
    struct diag d;
    const enum err e = begin(handle, "probe", &d);
    return e ? call_result(&d, e) : end(handle, &d, find_probe(handle, name, values, &d));
}

const char *sphfsi_probe_name(const struct sphfsi_simulation *handle, int k)
{
    if (!handle || k < 0 || k >= handle->session.scene.n_probe) return NULL;
    return handle->session.scene.probe[k].common.name;
}

const char *sphfsi_probe_column(struct sphfsi_simulation *handle, int k, int c)
{
    if (!sphfsi_probe_name(handle, k) || c < 0) return NULL;
    const struct scene_probe *const sp = &handle->session.scene.probe[k];
    return probe_column(sp, c, handle->column, sizeof handle->column) ? handle->column : NULL;
}

/* --- forces and motions of the program --- */

static void add_user_force(void *context, double time, const struct particles *particles,
                           double *ax, double *ay)
{
    const struct user_function *const user = context;
    const struct sphfsi_particles view = {time,          particles->n,
                                          particles->id, particles->body,
                                          particles->x,  particles->y,
                                          particles->vx, particles->vy};
    const struct host mine = host_use(user->of->host);
    user->force(user->context, &view, ax, ay);
    host_use(mine);
}

static enum err set_force(struct sphfsi_simulation *handle, enum sphfsi_kind kind,
                          sphfsi_force *force, void *context, struct diag *d)
{
    struct simulation *const sim = &handle->session.simulation;
    if ((kind != SPHFSI_FLUID && kind != SPHFSI_SOLID) || sim->particles[kind].capacity == 0)
        return diag_fail(d, ERR_INPUT, "force: must act on fluid or solid of the scene, not on %s",
                         (unsigned)kind < KIND_COUNT ? kind_names[kind] : "this");
    handle->force[kind] = (struct user_function){.of = handle, .force = force, .context = context};
    return simulation_set_force_hook(sim, (enum kind)kind, force ? add_user_force : NULL,
                                     &handle->force[kind], d);
}

enum sphfsi_status sphfsi_set_force(struct sphfsi_simulation *handle, enum sphfsi_kind kind,
                                    sphfsi_force *force, void *context)
{
    struct diag d;
    const enum err e = begin(handle, "force", &d);
    return e ? call_result(&d, e) : end(handle, &d, set_force(handle, kind, force, context, &d));
}

static void apply_user_motion(void *context, double time, double d[2], double v[2], double a[2])
{
    const struct user_function *const user = context;
    const struct host mine = host_use(user->of->host);
    user->motion(user->context, time, d, v, a);
    host_use(mine);
}

static enum err set_motion(struct sphfsi_simulation *handle, const char *name,
                           sphfsi_motion *motion, void *context, struct diag *d)
{
    struct scene *const scene = &handle->session.scene;
    if (!name) return diag_fail(d, ERR_INPUT, "motion: the name is NULL");
    const int at = scene_find(scene, SECTION_motion, name);
    struct nearest near = {0};
    for (int k = 0; k < scene->n_motion; k++)
        nearest_offer(&near, name, scene->motion[k].common.name);
    if (at < 0)
        return diag_fail(d, ERR_INPUT, "motion: the case has no [motion %.60s]%s", name,
                         nearest_hint(&near));
    const size_t n = (size_t)scene->n_motion;
    struct motion_hook **const hook = &scene->motion_hook;
    if (!handle->motion) TRY(arena_array(&scene->arena, &handle->motion, n, "motions", d));
    if (!*hook) TRY(arena_array(&scene->arena, hook, n, "motions", d));
    handle->motion[at] = (struct user_function){.of = handle, .motion = motion, .context = context};
    (*hook)[at] = (struct motion_hook){motion ? apply_user_motion : NULL, &handle->motion[at]};
    struct simulation *const sim = &handle->session.simulation;
    sim->evaluated = false;
    sim->solid.calls_out = false;
    for (int k = 0; k < scene->n_motion; k++) sim->solid.calls_out |= (*hook)[k].move != NULL;
    return ERR_OK;
}

enum sphfsi_status sphfsi_set_motion(struct sphfsi_simulation *handle, const char *name,
                                     sphfsi_motion *motion, void *context)
{
    struct diag d;
    const enum err e = begin(handle, "motion", &d);
    return e ? call_result(&d, e) : end(handle, &d, set_motion(handle, name, motion, context, &d));
}
