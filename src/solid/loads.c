/* SPDX-License-Identifier: MIT
 * Loads on solids and the motion of their clamps, with their work. */
#include "solid/loads.h"
#include "geometry/sampling.h"

/* --- start --- */

static int moving_clamp(const struct scene *scene, int body)
{
    return scene_find(scene, SECTION_motion, scene->solid[body].clamp_motion);
}

static enum err find_held(struct loads *loads, struct arena *a, const struct particles *particles,
                          struct diag *d)
{
    for (int64_t i = 0; i < particles->n; i++)
        loads->n_held +=
            particles->free[i] == 0 && moving_clamp(loads->scene, particles->body[i]) >= 0;
    TRY(arena_array(a, &loads->held, loads->n_held, "moving clamps", d));
    TRY(arena_array(a, &loads->held_power, loads->n_held, "moving clamps", d));
    TRY(arena_array(a, &loads->held_rise, loads->n_held, "moving clamps", d));
    TRY(arena_array(a, &loads->motion, loads->scene->n_solid, "moving clamps", d));
    loads->n_held = 0;
    for (int64_t i = 0; i < particles->n; i++)
        if (particles->free[i] == 0 && moving_clamp(loads->scene, particles->body[i]) >= 0)
            loads->held[loads->n_held++] = (int32_t)i;
    return ERR_OK;
}

/* Appends the particles of a load. A centre on an edge counts as in the sampling of bodies. */
static enum err find_loaded(struct loads *loads, struct load_region *load,
                            const struct particles *particles, struct arena *temp, struct diag *d)
{
    const struct scene_load *const from = &loads->scene->load[load->section];
    const int body = scene_find(loads->scene, SECTION_solid, from->body);
    struct outlines o;
    TRY(outlines_of(&o, loads->scene, &from->shape, temp, d));
    load->first = loads->n_loaded;
    const double dp = loads->scene->top.dp;
    for (int64_t i = 0; i < particles->n; i++) {
        const bool inside =
            particles->body[i] == body &&
            outlines_find(&o, particles->X[i] + NUDGE_X * dp, particles->Y[i] + NUDGE_Y * dp) >= 0;
        if (inside) loads->loaded[loads->n_loaded++].particle = (int32_t)i;
    }
    load->end = loads->n_loaded;
    if (load->end == load->first)
        return fail_at(d, loads->scene, from->common.line,
                       "[load %s] contains no particle of [solid %s]; move or enlarge its `shape`",
                       from->common.name, from->body);
    return ERR_OK;
}

/* The length of surface of each particle of a row: the spacing along the row's longer axis. */
static double row_spacing(const struct loads *loads, const struct load_region *load, int body,
                          const struct particles *particles)
{
    const struct scene_lattice *const l = &loads->scene->solid_lattice[body];
    struct box2 row = box2_empty();
    for (int64_t k = load->first; k < load->end; k++) {
        double at[2];
        const int32_t i = loads->loaded[k].particle;
        lattice_place(l, particles->X[i], particles->Y[i], at);
        box2_include(&row, at[0], at[1]);
    }
    return l->spacing[row.high[1] - row.low[1] > row.high[0] - row.low[0]];
}

/* Each particle's part of the force, or the traction times its length of surface. */
static void set_forces(struct loads *loads, const struct load_region *load,
                       const struct particles *particles, double time)
{
    const struct scene_load *const from = &loads->scene->load[load->section];
    const struct scene_expr *const value = from->traction.e[0] ? &from->traction : &from->force;
    for (int64_t k = load->first; k < load->end; k++) {
        struct loaded *const at = &loads->loaded[k];
        for (int c = 0; c < 2; c++)
            at->f[c] = load->share * expr_at_time(value->e[c], particles->X[at->particle],
                                                  particles->Y[at->particle], time);
    }
}

static void begin_load(struct loads *loads, struct load_region *load,
                       const struct particles *particles)
{
    const struct scene_load *const from = &loads->scene->load[load->section];
    const bool traction = from->traction.e[0] != NULL;
    const struct scene_expr *const value = traction ? &from->traction : &from->force;
    load->share = traction
                      ? row_spacing(loads, load,
                                    scene_find(loads->scene, SECTION_solid, from->body), particles)
                      : 1 / (double)(load->end - load->first);
    load->varies = expr_varies(value->e[0]) || expr_varies(value->e[1]);
    set_forces(loads, load, particles, 0);
}

static enum err find_loads(struct loads *loads, struct arena *a, const struct particles *particles,
                           struct arena *temp, struct diag *d)
{
    const struct scene *const scene = loads->scene;
    TRY(arena_array(a, &loads->load, scene->n_load, "loads", d));
    const size_t most = (size_t)scene->n_load * (size_t)particles->n;
    TRY(arena_array(temp, &loads->loaded, most, "loads", d));
    for (int k = 0; k < scene->n_load; k++) {
        if (scene_find(scene, SECTION_solid, scene->load[k].body) < 0) continue; /* of a beam */
        loads->load[loads->n_loads].section = k;
        TRY(find_loaded(loads, &loads->load[loads->n_loads++], particles, temp, d));
    }
    const struct loaded *const found = loads->loaded;
    TRY(arena_array(a, &loads->loaded, loads->n_loaded, "loads", d));
    for (int64_t k = 0; k < loads->n_loaded; k++) loads->loaded[k] = found[k];
    for (int k = 0; k < loads->n_loads; k++) begin_load(loads, &loads->load[k], particles);
    return ERR_OK;
}

enum err loads_create(struct solid *solid, struct arena *a, const struct scene *scene,
                      struct particles *particles, struct diag *d)
{
    struct loads *const loads = arena_alloc(a, 1, sizeof *loads, "loads", d);
    if (!loads) return ERR_MEMORY;
    solid->loads = loads;
    *loads = (struct loads){.scene = scene};
    TRY(find_held(loads, a, particles, d));
    struct arena temp = {.limit = a->limit};
    const enum err e = find_loads(loads, a, particles, &temp, d);
    arena_free(&temp);
    if (e) return e;
    for (int64_t k = 0; k < loads->n_held; k++) particles->free[loads->held[k]] = 1;
    loads_place_clamps(loads, particles, 0);
    return ERR_OK;
}

/* --- during the run --- */

void loads_move(struct loads *loads, double time)
{
    if (loads->n_held == 0) return;
    for (int b = 0; b < loads->scene->n_solid; b++)
        loads->motion[b] = motion_at(loads->scene, moving_clamp(loads->scene, b), time);
}

void loads_place_clamps(struct loads *loads, struct particles *particles, double time)
{
    loads_move(loads, time);
    for (int64_t k = 0; k < loads->n_held; k++) {
        const int32_t i = loads->held[k];
        const struct motion_point at = loads_motion(loads, particles, i);
        particles->ux[i] = at.x[0] - particles->X[i];
        particles->uy[i] = at.x[1] - particles->Y[i];
        particles->vx[i] = at.v[0];
        particles->vy[i] = at.v[1];
    }
}

/* Dead loads: their direction is constant and does not follow the surface. */
void loads_forces(struct loads *loads, const struct solid *solid, struct particles *particles,
                  double time)
{
    for (int n = 0; n < loads->n_loads; n++) {
        struct load_region *const load = &loads->load[n];
        const struct expr *const history = loads->scene->load[load->section].history.e[0];
        load->factor = history ? expr_at_arg(history, max2(time, 0)) : 1;
        if (load->varies) set_forces(loads, load, particles, max2(time, 0));
        for (int64_t k = load->first; k < load->end; k++) {
            const int32_t i = loads->loaded[k].particle;
            const double per_mass =
                load->factor * particles->free[i] / solid->body[particles->body[i]].mass;
            if (!isfinite(load->factor * (loads->loaded[k].f[0] + loads->loaded[k].f[1])))
                loads->infinite = load->section + 1;
            particles->sx[i] += loads->loaded[k].f[0] * per_mass;
            particles->sy[i] += loads->loaded[k].f[1] * per_mass;
        }
    }
    if (loads->released) return;
    loads_move(loads, time);
    for (int64_t k = 0; k < loads->n_held; k++) {
        const int32_t i = loads->held[k];
        const struct motion_point at = loads_motion(loads, particles, i);
        const double mass = solid->body[particles->body[i]].mass;
        const double fx = mass * (at.a[0] - particles->sx[i]),
                     fy = mass * (at.a[1] - particles->sy[i]);
        loads->held_power[k] = fx * at.v[0] + fy * at.v[1];
        loads->held_rise[k] = fx * at.a[0] + fy * at.a[1];
        particles->sx[i] = at.a[0];
        particles->sy[i] = at.a[1];
    }
}

double loads_work(const struct loads *loads, const struct particles *particles, const double *vx,
                  const double *vy, double dt, double *on)
{
    double work = 0;
    for (int n = 0; n < loads->n_loads; n++)
        for (int64_t k = loads->load[n].first; k < loads->load[n].end; k++) {
            const int32_t i = loads->loaded[k].particle;
            const double *const f = loads->loaded[k].f;
            const double done = loads->load[n].factor * particles->free[i] * dt *
                                (f[0] * (vx[i] + 0.5 * dt * particles->sx[i]) +
                                 f[1] * (vy[i] + 0.5 * dt * particles->sy[i]));
            work += done;
            on[particles->body[i]] += done;
        }
    for (int64_t k = 0; k < loads->n_held; k++) {
        const double done = dt * (loads->held_power[k] + 0.5 * dt * loads->held_rise[k]);
        work += done;
        on[particles->body[loads->held[k]]] += done;
    }
    return work;
}
