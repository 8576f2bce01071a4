/* SPDX-License-Identifier: MIT */
#include "app/forecast.h"

#include "implicit/implicit.h"
#include "output/probes.h"
#include "output/series.h"
#include "output/snapshot.h"
#include "time/advance.h"
#include "time/energy.h"
#include "time/timestep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_STEPS = 20, EVALUATIONS_MEASURED = 5 };
/* CPU time of this thread, s: of the first steps, which are not measured, at most; of all measured
 * steps; of steps with rows of a file; of one repeat. Repeats are short, so that other work on the
 * machine does not disturb all of them. */
static const double first_seconds = 0.1, measured_seconds = 0.2, row_seconds = 0.05,
                    repeat_seconds = 0.005;

/* --- measurement --- */

/* Trial steps: the least time per step (of this thread on its core) and per phase (by the wall
 * clock) of all repeats, since other work on the machine can only add to it. Not every repeat
 * sorts, so sorting counts with its mean, limited to 5 % of a step. */
struct trial {
    double step, phase[PHASE_COUNT], sort_mean;
    int64_t steps, substeps, evaluations, calls;
    int64_t n_start;             /* fluid particles */
    const struct probes *probes; /* whose rows are read before each call; NULL: none */
    int file;                    /* of these; -1: the ledger */
};

/* Whether half of the fluid of the start is still there: what falls out of the domain costs
 * nothing. */
static bool has_fluid_of_start(const struct simulation *sim, int64_t n_start)
{
    return 2 * sim->kind[KIND_FLUID].n >= n_start;
}

static void read_row(const struct trial *trial, struct simulation *sim)
{
    double row[SERIES_MAX_COLUMNS], rate[SERIES_MAX_COLUMNS];
    if (trial->probes && trial->file < 0)
        simulation_ledger(sim);
    else if (trial->probes)
        probes_sample(trial->probes, sim, trial->file, false, row, rate);
}

static enum err take_steps(struct trial *trial, struct simulation *sim, struct diag *d)
{
    const double end = sim->scene->top.end_time, begin = thread_clock();
    const struct state before = sim->state;
    double phase[PHASE_COUNT], now;
    memcpy(phase, sim->phase_seconds, sizeof phase);
    do {
        read_row(trial, sim);
        TRY(simulation_step(sim, (double)INFINITY, d));
        trial->calls++;
        now = thread_clock();
    } while (sim->state.time < end && now - begin < repeat_seconds &&
             has_fluid_of_start(sim, trial->n_start));
    const double steps = (double)(sim->state.steps - before.steps);
    const double each = (now - begin) / steps;
    trial->step = trial->steps ? min2(trial->step, each) : each;
    for (int k = 0; k < PHASE_COUNT; k++) {
        const double seconds = (sim->phase_seconds[k] - phase[k]) / steps;
        trial->phase[k] = trial->steps ? min2(trial->phase[k], seconds) : seconds;
    }
    trial->sort_mean += sim->phase_seconds[PHASE_sort] - phase[PHASE_sort];
    trial->steps += sim->state.steps - before.steps;
    trial->substeps += sim->state.solid_substeps - before.solid_substeps;
    trial->evaluations += sim->state.evaluations - before.evaluations;
    return ERR_OK;
}

static void set_costs(struct unit_costs *c, struct trial *trial, const struct simulation *sim)
{
    const double n_fluid = (double)sim->kind[KIND_FLUID].n;
    const double n_solid = (double)sim->kind[KIND_SOLID].n, steps = (double)trial->steps;
    double all = 0;
    trial->phase[PHASE_sort] = 0;
    for (int k = 0; k < PHASE_COUNT; k++) all += trial->phase[k];
    trial->phase[PHASE_sort] = min2(trial->sort_mean / steps, 0.05 * all);
    all += trial->phase[PHASE_sort];
    for (int k = 0; k < PHASE_COUNT; k++)
        c->phase_fraction[k] = all > 0 ? trial->phase[k] / all : 0;
    all = min2(all, trial->step);
    const double solid =
        n_fluid > 0 ? all * (c->phase_fraction[PHASE_solid] + c->phase_fraction[PHASE_contact])
                    : all;
    c->evaluations = (double)trial->evaluations / steps;
    if (n_solid > 0 && trial->substeps > 0)
        c->solid = solid * steps / (double)trial->substeps / n_solid;
    if (n_fluid > 0) c->fluid = (all - solid) / c->evaluations / n_fluid;
}

/* Repeats for some seconds. A guard that stops the run in them is not reported: the run will do
 * it. */
static enum err repeat_steps(struct trial *trial, struct simulation *sim, double seconds,
                             struct diag *d)
{
    const double begin = thread_clock();
    struct diag ignored = {.code = ERR_OK};
    enum err e;
    do {
        e = take_steps(trial, sim, &ignored);
    } while (!e && sim->state.time < sim->scene->top.end_time && thread_clock() - begin < seconds &&
             has_fluid_of_start(sim, trial->n_start));
    return e && e != ERR_GUARD ? diag_fail(d, e, "%s", ignored.text) : ERR_OK;
}

static enum err measure_steps(struct unit_costs *c, struct trial *trial, struct simulation *sim,
                              struct diag *d)
{
    const double end = sim->scene->top.end_time;
    sim->state.seeks_rest = 0; /* [relax] is not measured */
    /* The first steps include the first touch of memory and the first sort, and find the bounds of
     * the time step. A guard that stops the run in them is reported. */
    const double start = thread_clock();
    int first = 0;
    do {
        TRY(simulation_step(sim, (double)INFINITY, d));
    } while (++first <= FIRST_STEPS && sim->state.time < end &&
             has_fluid_of_start(sim, trial->n_start) && thread_clock() - start < first_seconds);
    TRY(repeat_steps(trial, sim, measured_seconds, d));
    if (trial->steps > 0) set_costs(c, trial, sim);
    return ERR_OK;
}

/* The step of Eq. 28b with an estimate of the pairs' approach speed. In the five shipped flows its
 * mean was 0.6 to 0.9 of `max_speed`. Without `max_speed` the largest value so far is used. */
static double expected_step(const struct simulation *sim)
{
    const double limit = timestep_longest(sim);
    if (!(sim->effects & FX_FLUID) || sim->scene->numerics.fixed_step > 0) return limit;
    double speed = 0;
    for (int k = 0; k < sim->scene->n_fluid; k++)
        speed = max2(speed, sim->scene->fluid[k].max_speed);
    const double approach = max2(0.75 * speed, sim->fluid.extremes.approach);
    const double dt = limit * sim->fluid.k.c0 / (sim->fluid.k.c0 + approach);
    const bool single_rate = sim->effects & FX_SOLID && !(sim->effects & FX_MULTIRATE);
    return single_rate ? min2(dt, sim->dt_solid) : dt;
}

/* The time of all rows of the run: by how much steps take longer that begin with a reading of the
 * state. They use what the reading has evaluated. A row lies between two states, and a state serves
 * all rows beside it. */
static enum err measure_rows(struct unit_costs *c, const struct trial *plain,
                             struct simulation *sim, struct diag *d)
{
    const double end = sim->scene->top.end_time, dt = expected_step(sim);
    struct probes probes;
    TRY(probes_create(&probes, sim, &sim->arena, d));
    for (int file = -1; file < probes.n_files; file++) {
        struct trial trial = {.n_start = plain->n_start, .probes = &probes, .file = file};
        TRY(repeat_steps(&trial, sim, row_seconds, d));
        if (!trial.steps) continue;
        const double longer = max2(0, trial.step - plain->step), /* a step */
            per_row = longer * (double)trial.steps / (double)trial.calls;
        const double interval =
            file < 0 ? sim->scene->output.ledger_interval : probes.file[file].interval;
        c->rows += per_row * min2(2 * end / interval, end / dt);
    }
    return ERR_OK;
}

/* Each particle somewhere in its own square of dp: the R2 sequence (Roberts 2018) has no order that
 * a lattice has. */
static enum err disorder(struct simulation *sim, struct diag *d)
{
    struct particles *const particles = &sim->kind[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++) {
        const double u = 0.7548776662466927 * (double)i, v = 0.5698402909980532 * (double)i;
        particles->x[i] += sim->fluid.k.dp * (u - floor(u) - 0.5);
        particles->y[i] += sim->fluid.k.dp * (v - floor(v) - 0.5);
    }
    return sort_particles(sim, d);
}

/* Water that flows loses the order of its lattice: its clusters become wider and have more clusters
 * within reach. Adds what an evaluation takes longer then. Leaves the particles so. */
static void measure_disorder(struct unit_costs *c, struct simulation *sim)
{
    const double n_fluid = (double)sim->kind[KIND_FLUID].n;
    double least[2] = {HUGE_VAL, HUGE_VAL}, phases[PHASE_COUNT] = {0};
    struct diag ignored = {.code = ERR_OK};
    for (int k = 0; k < 2 && !(k && disorder(sim, &ignored)); k++)
        for (int m = 0; m < EVALUATIONS_MEASURED; m++) {
            const double begin = thread_clock();
            fluid_evaluate(&sim->fluid, sim->kind, &sim->cells, phases);
            least[k] = min2(least[k], thread_clock() - begin);
        }
    if (least[1] < HUGE_VAL) c->fluid += max2(0, least[1] - least[0]) / n_fluid;
}

enum err forecast_measure(struct unit_costs *c, struct simulation *sim, struct diag *d)
{
    struct trial trial = {.n_start = sim->kind[KIND_FLUID].n};
    *c = (struct unit_costs){0};
    TRY(measure_steps(c, &trial, sim, d));
    const struct fluid_extremes extremes = sim->fluid.extremes; /* for the step that is expected */
    TRY(measure_rows(c, &trial, sim, d));
    c->snapshots = snapshots_seconds(sim) *
                   (1 + floor(sim->scene->top.end_time / sim->scene->output.snapshot_interval));
    if (sim->kind[KIND_FLUID].n) measure_disorder(c, sim);
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
