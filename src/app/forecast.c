/* SPDX-License-Identifier: MIT
 * What a run will cost: wall time from steps on trial, memory, and the size of its files. */
#include "app/session.h"
#include "output/checkpoint.h"
#include "output/rows.h"
#include "output/snapshot.h"

#include <stdlib.h>

enum { FIRST_STEPS = 20 };
/* CPU time of this thread, s: of the first steps, which are not measured, at most; of the trial; of
 * the coarse run, which takes a fiftieth of the run between these. */
static const double first_seconds = 0.1, trial_seconds = 0.2, coarse_seconds[] = {0.5, 2};

/* --- measurement --- */

/* What a stretch of a run takes: CPU time of each phase, simulated time, s, and numbers of these;
 * time and sub-steps while surfaces of solids are near. */
enum { TIME = PHASE_COUNT, STEPS, SUBSTEPS, EVALUATIONS, NEAR_TIME, NEAR_SUBSTEPS, AMOUNTS };
struct stretch {
    double amount[AMOUNTS];
};

/* By the wall clock, since the start. */
static struct stretch so_far(const struct simulation *sim)
{
    struct stretch s = {.amount = {0}};
    for (int k = 0; k < PHASE_COUNT; k++) s.amount[k] = sim->phase_seconds[k];
    s.amount[TIME] = sim->state.time;
    s.amount[STEPS] = (double)sim->state.steps;
    s.amount[SUBSTEPS] = (double)sim->state.solid_substeps;
    s.amount[EVALUATIONS] = (double)sim->state.evaluations;
    return s;
}

static void add(struct stretch *to, const struct stretch *s, double sign)
{
    for (int k = 0; k < AMOUNTS; k++) to->amount[k] += sign * s->amount[k];
}

static double seconds_of(const struct stretch *s)
{
    double seconds = 0;
    for (int k = 0; k < PHASE_COUNT; k++) seconds += s->amount[k];
    return seconds;
}

/* The time of steps alone, without that of output. */
static double seconds_of_steps(const struct stretch *s)
{
    return seconds_of(s) - s->amount[PHASE_output];
}

/* An amount per one of another. */
static double each(const struct stretch *s, int k, int per)
{
    return s->amount[k] / s->amount[per];
}

/* Whether steps go on: not beyond a time, nor where less than half of the fluid of the start is
 * left, since what falls out of the domain costs nothing. */
static bool goes_on(const struct simulation *sim, double until)
{
    const int64_t n_start = sim->scene->points[KIND_FLUID].n;
    return sim->state.time < min2(until, sim->scene->top.end_time) &&
           2 * sim->particles[KIND_FLUID].n >= n_start;
}

/* A guard that stops the run after its first steps is not reported: the run will do it. */
static enum err try_step(struct simulation *sim, struct diag *d)
{
    struct diag ignored = {.code = ERR_OK};
    const enum err e = simulation_step(sim, (double)INFINITY, &ignored);
    return e && e != ERR_GUARD ? diag_fail(d, e, "%s", ignored.text) : e;
}

/* The first steps include the first touch of memory and the first sort, and find the bounds of the
 * time step. A guard that stops the run in them is reported. */
static enum err take_first_steps(struct simulation *sim, struct diag *d)
{
    const double start = thread_clock();
    int first = 0;
    do {
        TRY(simulation_step(sim, (double)INFINITY, d));
    } while (++first <= FIRST_STEPS && thread_clock() - start < first_seconds &&
             goes_on(sim, (double)INFINITY));
    return ERR_OK;
}

/* Steps until a time, for some seconds at most. Steps on trial with another number of threads, of
 * which a run has fewer, are left out of the time. Shares of phases are by the wall clock. Beside
 * other programs a team of threads waits for each other: only an idle machine gives its time. */
static enum err measure(struct stretch *s, struct simulation *sim, double until, double seconds,
                        struct diag *d)
{
    const double start = thread_clock();
    double clock = start, usual = 0, steps = 0;
    enum err e = ERR_OK;
    *s = (struct stretch){.amount = {0}};
    while (!e && clock - start < seconds && goes_on(sim, until)) {
        const bool counts = sim->team.now == sim->team.chosen;
        const double last = clock;
        const struct stretch before = so_far(sim);
        e = try_step(sim, d);
        clock = thread_clock();
        struct stretch step = so_far(sim);
        add(&step, &before, -1);
        if (sim->solid.contact) {
            step.amount[NEAR_TIME] = step.amount[TIME];
            step.amount[NEAR_SUBSTEPS] = step.amount[SUBSTEPS];
        }
        add(s, &step, 1);
        if (!counts) continue;
        usual += clock - last;
        steps += step.amount[STEPS];
    }
    const double all = seconds_of(s), each = steps > 0 ? usual / steps : 0;
    if (all > 0)
        for (int k = 0; k < PHASE_COUNT; k++) s->amount[k] *= each * s->amount[STEPS] / all;
    return e == ERR_GUARD ? ERR_OK : e;
}

/* --- outputs of a run, without files --- */

struct outputs {
    struct probes probes;
    struct row_files rows;
};

/* From now on rows are read and formatted as in a run, after the search for rest. */
static enum err follow_rows(struct simulation *sim, struct diag *d)
{
    struct outputs *const to = arena_alloc(&sim->arena, 1, sizeof *to, "rows", d);
    if (!to) return ERR_MEMORY;
    TRY(probes_create(&to->probes, sim, &sim->arena, d));
    TRY(rows_create(&to->rows, &to->probes, sim, true, &sim->arena, d));
    sim->state.seeks_rest = false;
    rows_follow(&to->rows, sim);
    return ERR_OK;
}

/* Snapshots and checkpoints of the run, in memory. */
static enum err measure_files(struct forecast *f, struct simulation *sim, struct diag *d)
{
    const struct scene_output *const out = &sim->scene->output;
    const double end = sim->scene->top.end_time * (1 - 1e-9), begin = thread_clock();
    struct checkpoint checkpoint = {.bytes = NULL};
    TRY(checkpoint_capture(&checkpoint, sim, "", "", d));
    checkpoint_seal(&checkpoint);
    f->files = (thread_clock() - begin) *
               (out->checkpoint_interval > 0 ? ceil(end / out->checkpoint_interval) : 1);
    checkpoint_free(&checkpoint);
    f->files += snapshots_seconds(sim) * (1 + ceil(end / out->snapshot_interval));
    return ERR_OK;
}

/* --- a run of the same scene at a coarser spacing --- */

static enum err open_coarse(struct session *coarse, const struct sphfsi_options *o, double dp)
{
    struct diag ignored = {.code = ERR_OK};
    struct sphfsi_options with = *o;
    char set[40];
    const char **const sets = calloc((size_t)o->n_sets + 1, sizeof *sets);
    if (!sets) return ERR_MEMORY;
    for (int k = 0; k < o->n_sets; k++) sets[k] = o->sets[k];
    snprintf(set, sizeof set, "dp=%.17g", dp);
    sets[with.n_sets++] = set;
    with.sets = sets;
    with.message = NULL;
    with.threads = 1;
    const enum err e = session_open(coarse, &with, &ignored);
    free(sets);
    return e;
}

/* Runs the coarse scene: its first stretch, until the time of the trial and some more, then all of
 * it. Without rows where a probe does not fit the coarse particles. */
static void run_coarse(struct stretch *first, struct stretch *whole, struct simulation *sim,
                       double trial_end, double seconds)
{
    struct diag ignored = {.code = ERR_OK};
    struct stretch more;
    const enum err e = follow_rows(sim, &ignored);
    if ((e && e != ERR_INPUT) || take_first_steps(sim, &ignored)) return;
    if (measure(first, sim, trial_end, seconds, &ignored)) return;
    if (measure(&more, sim, (double)INFINITY, 0.1 * seconds - seconds_of(first), &ignored)) return;
    add(first, &more, 1);
    if (measure(whole, sim, (double)INFINITY, coarse_seconds[1], &ignored)) return;
    add(whole, first, 1);
}

/* Opens the scene at r times its spacing, or half of that until it can be sampled, and runs it. */
static double run_trial(struct stretch *first, struct stretch *whole, double r, double dp,
                        double trial_end, double seconds, const struct sphfsi_options *o)
{
    struct session *const coarse = calloc(1, sizeof *coarse);
    enum err e = coarse ? open_coarse(coarse, o, r * dp) : ERR_MEMORY;
    while (e == ERR_INPUT && r > 3) {
        r = floor(0.5 * r);
        e = open_coarse(coarse, o, r * dp);
    }
    if (!e) {
        phase_clock_use(true);
        run_coarse(first, whole, &coarse->simulation, trial_end, seconds);
        phase_clock_use(false);
        session_close(coarse);
    }
    free(coarse);
    return r;
}

/* The amounts of the run by those of the trial. A step takes longer by the factor by which it does
 * in a run of the same scene at a coarser spacing, which sees the whole of it: water that spreads,
 * bodies that touch. With r times the spacing there are 1/r^2 of the particles and 1/r of the
 * steps, so that r is the cube root of the time of the run over that of the coarse one. Sorts and
 * contact are too rare for a factor. Sorts take the part of the time that they take in the coarse
 * run; contact takes 1/r of its part of a solid's time, since a surface has 1/r of the particles.
 * The step of a solid alone is known from the trial. Springs of contact, which may come later, are
 * as stiff per depth at any spacing: 1/r of the steps are taken near surfaces. */
static void extend(struct forecast *f, struct stretch *run, const struct stretch *trial,
                   const struct session *session, const struct sphfsi_options *o)
{
    const double end = session->scene.top.end_time, dp = session->scene.top.dp,
                 longer = end / trial->amount[TIME], rough = seconds_of(trial) * longer,
                 seconds = min2(max2(coarse_seconds[0], 0.02 * rough), coarse_seconds[1]);
    struct stretch first = {0}, whole = {0};
    const double r = run_trial(&first, &whole, ceil(cbrt(rough / seconds)), dp,
                               session->simulation.state.time, seconds, o);
    *run = *trial;
    add(run, trial, longer - 1);
    if (!(whole.amount[TIME] > 0)) return;
    f->coarse_dp = r * dp;
    const bool fluid = session->simulation.effects & FX_FLUID;
    const double steps = each(&whole, STEPS, TIME) / each(&first, STEPS, TIME);
    double near = 1;
    if (whole.amount[NEAR_TIME] > 0)
        near +=
            each(&whole, NEAR_TIME, TIME) *
            max2(0, r * each(&whole, NEAR_SUBSTEPS, NEAR_TIME) / each(trial, SUBSTEPS, TIME) - 1);
    run->amount[STEPS] *= fluid ? steps : near;
    run->amount[SUBSTEPS] = run->amount[STEPS] * each(trial, SUBSTEPS, STEPS) * (fluid ? near : 1);
    run->amount[EVALUATIONS] = run->amount[STEPS] * each(trial, EVALUATIONS, STEPS);
    for (int k = 0; k < PHASE_COUNT; k++) {
        const int per = k == PHASE_solid ? SUBSTEPS : k == PHASE_output ? TIME : STEPS;
        if (first.amount[k] > 0)
            run->amount[k] = run->amount[per] * each(trial, k, per) * each(&whole, k, per) /
                             each(&first, k, per);
    }
    if (!(trial->amount[PHASE_output] > 0)) /* rows rarer than the trial is long */
        run->amount[PHASE_output] = run->amount[TIME] * each(&whole, PHASE_output, TIME);
    run->amount[PHASE_contact] = 0;
    if (whole.amount[PHASE_solid] > 0)
        run->amount[PHASE_contact] =
            run->amount[PHASE_solid] * each(&whole, PHASE_contact, PHASE_solid) / r;
    const double sorts = whole.amount[PHASE_sort], others = seconds_of_steps(&whole) - sorts;
    run->amount[PHASE_sort] = 0;
    if (others > 0) run->amount[PHASE_sort] = seconds_of_steps(run) * sorts / others;
}

/* --- the run --- */

/* Bytes of rows, two checkpoints, and uncompressed snapshots twice, as during the run. */
static double disk_bytes(const struct simulation *sim)
{
    enum { BYTES_OF_SNAPSHOT = 140, BYTES_OF_ROW = 18 }; /* a particle; a number */
    const struct scene_output *const out = &sim->scene->output;
    double particles = 0, state = 0;
    for (int k = 0; k < KIND_COUNT; k++) {
        particles += (double)sim->particles[k].n;
        state += (double)particles_bytes(&sim->particles[k]);
    }
    const double end = sim->scene->top.end_time;
    double rows = end / out->ledger_interval * 12;
    if (sim->scene->n_probe > 0) rows += end / out->probe_interval * (1 + 2 * sim->scene->n_probe);
    return 2 * (end / out->snapshot_interval + 1) * BYTES_OF_SNAPSHOT * particles + 2 * state +
           BYTES_OF_ROW * rows;
}

enum err forecast_run(struct forecast *f, struct session *session, const struct sphfsi_options *o,
                      struct diag *d)
{
    struct simulation *const sim = &session->simulation;
    const double end = sim->scene->top.end_time;
    struct stretch trial, run;
    *f = (struct forecast){0};
    TRY(follow_rows(sim, d));
    TRY(take_first_steps(sim, d));
    TRY(measure(&trial, sim, end, trial_seconds, d));
    const double n_fluid = (double)sim->particles[KIND_FLUID].n,
                 n_solid = (double)sim->particles[KIND_SOLID].n;
    if (trial.amount[TIME] == 0) trial = so_far(sim); /* the first steps were the run */
    const int threads = thread_count();
    extend(f, &run, &trial, session, o);
    thread_use(threads);
    f->dt = end / run.amount[STEPS];
    f->steps = whole_parts(run.amount[STEPS]);
    f->substeps = n_solid > 0 ? max2(f->steps, run.amount[SUBSTEPS]) : 0;
    f->rows = run.amount[PHASE_output];
    TRY(measure_files(f, sim, d));
    f->evaluations = run.amount[EVALUATIONS];
    const double all = seconds_of_steps(&run),
                 solid = run.amount[PHASE_solid] + run.amount[PHASE_contact];
    for (int k = 0; k < PHASE_COUNT; k++) f->phase_fraction[k] = run.amount[k] / all;
    if (n_fluid > 0) f->fluid = (all - solid) / f->evaluations / n_fluid;
    if (n_solid > 0) f->solid = (n_fluid > 0 ? solid : all) / f->substeps / n_solid;
    f->seconds = all + f->rows + f->files + session->opening;
    f->memory = (double)(sim->arena.bytes + sim->scene->arena.bytes);
    f->disk = disk_bytes(sim);
    return ERR_OK;
}
