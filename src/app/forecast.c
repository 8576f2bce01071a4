/* SPDX-License-Identifier: MIT */
#include "app/forecast.h"
#include "output/probes.h"
#include "output/series.h"
#include "output/snapshot.h"
#include "time/energy.h"
#include "time/timestep.h"

#include <stdlib.h>

enum { FIRST_STEPS = 20, EVALUATIONS_MEASURED = 5 };
/* CPU time of this thread, s: of the first steps, which are not measured, at most; of all measured
 * steps; of steps with rows of a file. */
static const double first_seconds = 0.1, measured_seconds = 0.2, row_seconds = 0.05;

/* --- measurement --- */

/* Whether trial steps go on: not for long, nor beyond the end, nor where less than half of the
 * fluid of the start is left, since what falls out of the domain costs nothing. */
static bool goes_on(const struct simulation *sim, double begin, double seconds)
{
    const int64_t n_start = sim->scene->points[KIND_FLUID].n;
    return sim->state.time < sim->scene->top.end_time && thread_clock() - begin < seconds &&
           2 * sim->kind[KIND_FLUID].n >= n_start;
}

/* A guard that stops the run after its first steps is not reported: the run will do it. */
static enum err try_step(struct simulation *sim, struct diag *d)
{
    struct diag ignored = {.code = ERR_OK};
    const enum err e = simulation_step(sim, (double)INFINITY, &ignored);
    return e && e != ERR_GUARD ? diag_fail(d, e, "%s", ignored.text) : e;
}

/* Means over the steps, because some of what they do comes back after some of them only: sorting,
 * gradients of the density, tests. Steps on trial with another number of threads, of which a run
 * has fewer, are left out. Shares of phases are by the wall clock. Beside other programs a team of
 * threads waits for each other, so that only an idle machine gives its time. */
static enum err measure_steps(struct unit_costs *c, struct simulation *sim, struct diag *d)
{
    const double n_fluid = (double)sim->kind[KIND_FLUID].n;
    const double n_solid = (double)sim->kind[KIND_SOLID].n;
    /* The first steps include the first touch of memory and the first sort, and find the bounds of
     * the time step. A guard that stops the run in them is reported. */
    double begin = thread_clock(), seconds = 0, counted = 0, phase[PHASE_COUNT], all = 0;
    int first = 0;
    do {
        TRY(simulation_step(sim, (double)INFINITY, d));
    } while (++first <= FIRST_STEPS && goes_on(sim, begin, first_seconds));
    const struct state before = sim->state;
    memcpy(phase, sim->phase_seconds, sizeof phase);
    enum err e = ERR_OK;
    begin = thread_clock();
    while (!e && goes_on(sim, begin, measured_seconds)) {
        const bool usual = sim->team.now == sim->team.chosen;
        const double start = thread_clock(), from = (double)sim->state.steps;
        e = try_step(sim, d);
        if (!usual) continue;
        seconds += thread_clock() - start;
        counted += (double)sim->state.steps - from;
    }
    if ((e && e != ERR_GUARD) || counted == 0) return e == ERR_GUARD ? ERR_OK : e;
    for (int k = 0; k < PHASE_COUNT; k++) all += sim->phase_seconds[k] - phase[k];
    for (int k = 0; k < PHASE_COUNT && all > 0; k++)
        c->phase_fraction[k] = (sim->phase_seconds[k] - phase[k]) / all;
    const double of_solid = c->phase_fraction[PHASE_solid] + c->phase_fraction[PHASE_contact],
                 each = seconds / counted, solid = n_fluid > 0 ? each * of_solid : each,
                 steps = (double)(sim->state.steps - before.steps),
                 substeps = (double)(sim->state.solid_substeps - before.solid_substeps);
    c->evaluations = (double)(sim->state.evaluations - before.evaluations) / steps;
    if (n_solid > 0 && substeps > 0) c->solid = solid * steps / substeps / n_solid;
    if (n_fluid > 0) c->fluid = (each - solid) / c->evaluations / n_fluid;
    return ERR_OK;
}

/* Of pairs that approach, and of the fastest particle. In the five shipped flows its mean was 0.6
 * to 0.9 of `max_speed`. Without `max_speed` the largest value so far is used. */
static double expected_speed(const struct simulation *sim, double so_far)
{
    double speed = 0;
    for (int k = 0; k < sim->scene->n_fluid; k++)
        speed = max2(speed, sim->scene->fluid[k].max_speed);
    return max2(0.75 * speed, so_far);
}

/* The step of Eq. 28b. */
static double expected_step(const struct simulation *sim)
{
    const double limit = timestep_longest(sim);
    if (!(sim->effects & FX_FLUID) || sim->scene->numerics.fixed_step > 0) return limit;
    const double approach = expected_speed(sim, sim->fluid.extremes.approach);
    const double dt = limit * sim->fluid.k.c0 / (sim->fluid.k.c0 + approach);
    const bool single_rate = sim->effects & FX_SOLID && !(sim->effects & FX_MULTIRATE);
    return single_rate ? min2(dt, sim->dt_solid) : dt;
}

/* The time of all rows of the run. A row lies between two states, and a state serves all rows
 * beside it. The evaluation that a reading needs is that of the next step. */
static enum err measure_rows(struct unit_costs *c, struct simulation *sim, struct diag *d)
{
    const double end = sim->scene->top.end_time, dt = expected_step(sim);
    double row[SERIES_MAX_COLUMNS], rate[SERIES_MAX_COLUMNS];
    struct probes probes;
    TRY(probes_create(&probes, sim, &sim->arena, d));
    for (int file = -1; file < probes.n_files; file++) {
        const double interval =
            file < 0 ? sim->scene->output.ledger_interval : probes.file[file].interval;
        const double readings = min2(2 * end / interval, end / dt), begin = thread_clock();
        double seconds = 0;
        int n = 0;
        enum err e;
        do {
            simulation_refresh(sim);
            const double start = thread_clock();
            if (file < 0)
                simulation_ledger(sim);
            else
                probes_sample(&probes, sim, file, false, row, rate);
            seconds += thread_clock() - start;
            n++;
            e = try_step(sim, d);
        } while (!e && goes_on(sim, begin, row_seconds));
        if (e && e != ERR_GUARD) return e;
        c->rows += seconds / n * readings;
    }
    return ERR_OK;
}

/* Each particle somewhere in its own square of dp: the R2 sequence (Roberts 2018) has no order that
 * a lattice has. */
static void disorder(struct simulation *sim)
{
    struct particles *const particles = &sim->kind[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++) {
        const double u = 0.7548776662466927 * (double)i, v = 0.5698402909980532 * (double)i;
        particles->x[i] += sim->fluid.k.dp * (u - floor(u) - 0.5);
        particles->y[i] += sim->fluid.k.dp * (v - floor(v) - 0.5);
    }
}

static struct box2 box_of(int64_t n, const double *x, const double *y)
{
    struct box2 box = box2_empty();
    for (int64_t i = 0; i < n; i++) box2_include(&box, x[i], y[i]);
    return box;
}

/* By how much the water has become wider or higher since the start. */
static double widened(const struct simulation *sim)
{
    const struct scene_points *const start = &sim->scene->points[KIND_FLUID];
    const struct particles *const fluid = &sim->kind[KIND_FLUID];
    const struct box2 then = box_of(start->n, start->x, start->y),
                      now = box_of(fluid->n, fluid->x, fluid->y);
    return max2(now.high[0] - now.low[0] - (then.high[0] - then.low[0]),
                now.high[1] - now.low[1] - (then.high[1] - then.low[1]));
}

/* A body of water with a free surface fills the breadth between the outermost walls, less deep by
 * as much. Returns by how much it becomes wider. */
static double spread(struct simulation *sim)
{
    const struct particles *const fluid = &sim->kind[KIND_FLUID], *const wall =
                                                                      &sim->kind[KIND_WALL];
    const double *const g = sim->scene->top.gravity, reach = KERNEL_REACH * sim->fluid.k.h;
    const int up = fabs(g[0]) < fabs(g[1]), across = !up;
    const struct box2 water = box_of(fluid->n, fluid->x, fluid->y),
                      walls = box_of(wall->n, wall->x, wall->y);
    const double now = water.high[across] - water.low[across],
                 then = walls.high[across] - walls.low[across] - 2 * reach;
    if (!(then > now) || g[up] == 0 || sim->effects & (FX_OPEN | FX_PERIODIC)) return 0;
    const double bottom = (g[up] < 0 ? water.low : water.high)[up];
    double *const x[2] = {fluid->x, fluid->y};
    for (int64_t i = 0; i < fluid->n; i++) {
        const double share = (x[across][i] - water.low[across]) / now;
        x[across][i] = walls.low[across] + reach + share * then;
        x[up][i] = bottom + (x[up][i] - bottom) * now / then;
    }
    return then - now;
}

/* The part of the run after a way that grows as the square of time and is `moved` now. */
static double part_after(const struct simulation *sim, double moved, double way)
{
    if (!(moved > 0)) return 0;
    return max2(0, 1 - sim->state.time * sqrt(way / moved) / sim->scene->top.end_time);
}

static double evaluation_seconds(struct simulation *sim)
{
    double least = HUGE_VAL, phases[PHASE_COUNT] = {0};
    for (int m = 0; m < EVALUATIONS_MEASURED; m++) {
        const double begin = thread_clock();
        fluid_evaluate(&sim->fluid, sim->kind, &sim->cells, phases);
        coupling_find_forces(&sim->coupling, sim->kind, &sim->cells);
        least = min2(least, thread_clock() - begin);
    }
    return least;
}

/* Water that flows loses the order of its lattice: its clusters become wider and have more clusters
 * within reach, once it has moved by the kernel's reach. It is sorted as soon as its fastest
 * particle has crossed the skin, more often than at the start. And it wets more walls, in
 * proportion to time, as if it wetted all from half of that time on: a quarter of its way. Adds
 * what a step takes longer then. Leaves the particles so. */
static void measure_flow(struct unit_costs *c, struct simulation *sim)
{
    const struct particles *const fluid = &sim->kind[KIND_FLUID];
    const double n_fluid = (double)fluid->n, wider = widened(sim), dt = expected_step(sim);
    const double sorts = (double)(sim->state.sorts - 1) / (double)sim->state.steps;
    struct diag ignored = {.code = ERR_OK};
    double speed2 = 0;
    for (int64_t i = 0; i < fluid->n; i++)
        speed2 += (square(fluid->vx[i]) + square(fluid->vy[i])) / n_fluid;
    const double moved = 0.5 * sqrt(speed2) * (double)sim->state.time;
    thread_use(sim->team.chosen);
    sim->fluid.threads = sim->team.chosen;
    const double ordered = evaluation_seconds(sim);
    disorder(sim);
    const double begin = thread_clock(), fastest = sqrt(sim->extremes.speed2);
    if (sort_particles(sim, &ignored)) return;
    const double sort = thread_clock() - begin, skin = sim->sorting.skin_left,
                 way_of_step = expected_speed(sim, fastest) * dt,
                 rate = way_of_step < skin ? way_of_step / skin : 1;
    c->fluid += sort * max2(0, rate - sorts) / c->evaluations / n_fluid;
    const double disordered = evaluation_seconds(sim);
    const double part = part_after(sim, moved, KERNEL_REACH * sim->fluid.k.h);
    c->fluid += part * max2(0, disordered - ordered) / n_fluid;
    const double way = spread(sim);
    if (way == 0 || sort_particles(sim, &ignored)) return;
    const double wet = max2(0, evaluation_seconds(sim) - disordered);
    c->fluid += part_after(sim, wider, 0.25 * way) * wet / n_fluid;
}

enum err forecast_measure(struct unit_costs *c, struct simulation *sim, struct diag *d)
{
    *c = (struct unit_costs){0};
    TRY(measure_steps(c, sim, d));
    const struct fluid_extremes extremes = sim->fluid.extremes; /* for the step that is expected */
    TRY(measure_rows(c, sim, d));
    c->snapshots = snapshots_seconds(sim) *
                   (1 + floor(sim->scene->top.end_time / sim->scene->output.snapshot_interval));
    if (sim->kind[KIND_FLUID].n) measure_flow(c, sim);
    sim->fluid.extremes = extremes;
    return ERR_OK;
}

/* --- the run --- */

/* Bytes of all files: rows, two checkpoints, and uncompressed snapshots twice, as during the run.
 */
static double disk_bytes(const struct simulation *sim)
{
    enum { BYTES_OF_SNAPSHOT = 140, BYTES_OF_ROW = 18 }; /* a particle; a number */
    const struct scene_output *const out = &sim->scene->output;
    double particles = 0, state = 0;
    for (int k = 0; k < KIND_COUNT; k++) {
        particles += (double)sim->kind[k].n;
        state += (double)particles_bytes(&sim->kind[k]);
    }
    const double end = sim->scene->top.end_time;
    double rows = end / out->ledger_interval * 12;
    if (sim->scene->n_probe > 0) rows += end / out->probe_interval * (1 + 2 * sim->scene->n_probe);
    return 2 * (end / out->snapshot_interval + 1) * BYTES_OF_SNAPSHOT * particles + 2 * state +
           BYTES_OF_ROW * rows;
}

struct forecast forecast_run(const struct unit_costs *c, const struct simulation *sim)
{
    const double n_fluid = (double)sim->kind[KIND_FLUID].n;
    const double n_solid = (double)sim->kind[KIND_SOLID].n;
    const double end = sim->scene->top.end_time;
    struct forecast f = {.dt = expected_step(sim)};
    f.steps = ceil(end / f.dt);
    const bool substeps = sim->effects & FX_MULTIRATE && !implicit_is_next(&sim->solid);
    if (n_solid > 0) f.substeps = f.steps * (substeps ? max2(1, ceil(f.dt / sim->dt_solid)) : 1);
    f.evaluations = f.steps * c->evaluations;
    f.seconds = f.evaluations * n_fluid * c->fluid + f.substeps * n_solid * c->solid + c->rows +
                c->snapshots + c->opening;
    f.memory = (double)(sim->arena.bytes + sim->scene->arena.bytes);
    f.disk = disk_bytes(sim);
    return f;
}
