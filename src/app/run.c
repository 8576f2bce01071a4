/* SPDX-License-Identifier: MIT
 * A run of a case: its folder and files, the time loop, restart and fork, and what it says at its
 * end. */
#include "app/session.h"
#include "check/check.h"
#include "output/checkpoint.h"
#include "output/report.h"
#include "output/rows.h"
#include "output/snapshot.h"
#include "time/timestep.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

enum output { OUT_SNAPSHOT, OUT_CHECKPOINT, OUT_COUNT };

struct run {
    const struct sphfsi_options *options;
    struct diag *diag;
    struct session session;
    struct simulation *sim; /* of the session */
    struct run_dir dir;
    struct arena arena;
    struct probes probes;
    struct row_files rows;
    struct references references;
    struct snapshots snapshots;
    struct checkpoint recent; /* of a sound state, in case a guard stops the run */
    char *case_text;          /* effective case */
    char restarted_from[PATH_BYTES], checkpoint[PATH_BYTES];
    struct due due[OUT_COUNT];
    double written[OUT_COUNT]; /* s: time of the last one; -1: none */
    struct record record;
    double wall_start, wall_progress, wall_checkpoint, wall_capture, capture_cost;
};

/* Most of the run time that copies of the state in memory may cost. */
static const double capture_fraction = 0.0025;
static const double progress_seconds = 0.25;

/* --- output --- */

/* Whether a restart continues files of rows: a run stopped while it seeks rest has none. */
static bool continues_rows(const struct run *r)
{
    return r->options->restart && !r->sim->state.seeks_rest;
}

/* Compares the probes with their references; a failure is only a warning. */
static void score_references(struct run *r)
{
    struct diag why = session_diag(r->options);
    r->references.scored = r->references.n > 0;
    for (int k = 0; k < r->references.n && r->references.scored; k++) {
        struct reference *const reference = &r->references.item[k];
        const char *const path = r->rows.file[reference->file].series.path;
        r->references.scored = reference_score(reference, path, &why) == ERR_OK;
    }
    if (why.code) diag_warn(&why, "the references were not compared: %s", why.text);
}

static enum err write_summary(struct run *r, const char *exit_reason, const char *message,
                              struct diag *d)
{
    r->record.exit_reason = exit_reason;
    r->record.message = message;
    r->record.snapshots_missed = r->recent.snapshots_missed;
    r->record.wall_seconds = wall_clock() - r->wall_start;
    r->record.last = simulation_ledger(r->sim);
    return report_summary(r->dir.path, r->sim, &r->record, d);
}

static enum err capture(struct run *r, struct diag *d)
{
    const double begin = wall_clock();
    TRY(checkpoint_capture(&r->recent, r->sim, r->case_text, SPHFSI_VERSION, d));
    r->wall_capture = wall_clock();
    r->capture_cost = r->wall_capture - begin;
    return ERR_OK;
}

/* Rows are synced first: after a power failure a checkpoint must not be newer than the rows. */
static enum err store(struct run *r, struct diag *d)
{
    TRY(rows_sync(&r->rows, d));
    return checkpoint_store(&r->recent, r->dir.path, r->checkpoint, d);
}

/* The next snapshot is tried unless snapshot_failure = stop; the file keeps the earlier ones. */
static enum err write_snapshot(struct run *r)
{
    struct diag why = session_diag(r->options);
    const enum err e = snapshots_write(&r->snapshots, r->sim, &why);
    if (e != ERR_IO || r->session.scene.output.snapshot_failure == SNAPSHOT_FAILURE_STOP)
        return e ? diag_fail(r->diag, e, "%s", why.text) : ERR_OK;
    r->recent.snapshots_missed++;
    diag_warn(&why, "the snapshot at %.6g s is missing, the run continues: %s", r->sim->state.time,
              why.text);
    return ERR_OK;
}

static enum err write_checkpoint(struct run *r)
{
    r->wall_checkpoint = wall_clock();
    TRY(capture(r, r->diag));
    TRY(store(r, r->diag));
    return write_summary(r, "running", "", r->diag);
}

/* Writes what is due at the first state at or after its time; at the end of the run, all that was
 * not written of this state. The checkpoint is the last: a restart relies on all others. */
static enum err write_due(struct run *r)
{
    const bool at_end = r->sim->state.time >= r->session.scene.top.end_time;
    const double begin = wall_clock(), before = phases_so_far(r->sim), time = r->sim->state.time;
    for (int k = 0; k < OUT_COUNT; k++) {
        const bool due = due_time(&r->due[k]) <= time, of_end = at_end && r->written[k] < time;
        if (k == OUT_SNAPSHOT) r->recent.snapshot_of_end = of_end && !due;
        if (!due && !of_end) continue;
        TRY(k == OUT_SNAPSHOT ? write_snapshot(r) : write_checkpoint(r));
        r->written[k] = time;
        due_pass(&r->due[k], time);
    }
    if (!at_end && capture_fraction * (wall_clock() - r->wall_capture) > r->capture_cost)
        TRY(capture(r, r->diag));
    /* Evaluations, which the next step uses, are counted in their own phases. */
    r->sim->phase_seconds[PHASE_output] += wall_clock() - begin - (phases_so_far(r->sim) - before);
    return ERR_OK;
}

/* --- time loop --- */

/* Seconds since a mark, which follows when the clock of a virtual machine steps back. */
static double since(double *mark)
{
    const double now = wall_clock();
    if (now < *mark) *mark = now;
    return now - *mark;
}

/* While rest is sought no simulated time passes. */
static void show_search(struct run *r)
{
    enum { EVERY = 10 }; /* s of wall time */
    char text[RELAX_TEXT];
    if (since(&r->wall_progress) < EVERY) return;
    r->wall_progress = wall_clock();
    relax_progress(r->sim, text);
    session_say(r->options, "%s", text);
}

static void show_progress(struct run *r, bool finished)
{
    const struct sphfsi_options *o = r->options;
    const double interval = o->progress_interval > 0 ? o->progress_interval : progress_seconds;
    if (!o->progress || (!finished && since(&r->wall_progress) < interval)) return;
    const double end = r->session.scene.top.end_time, now = wall_clock();
    r->wall_progress = now;
    r->record.wall_seconds = now - r->wall_start;
    const struct state *st = &r->sim->state;
    const double done = st->time - r->record.start_time, left = max2(0, end - st->time);
    const struct sphfsi_progress p = {
        .time = st->time,
        .end_time = end,
        .start_time = r->record.start_time,
        .dt = st->dt,
        .bound = bound_table[timestep_binding(r->sim)].name,
        .particle_steps_per_second = report_rate(r->sim, &r->record),
        .wall_seconds = r->record.wall_seconds,
        .seconds_left = done > 0 ? r->record.wall_seconds * left / done : -1,
        .steps = st->steps,
        .finished = finished,
    };
    o->progress(o->context, &p);
}

/* Requests of the user and checkpoints by wall time; neither changes a step. */
static enum err between_steps(struct run *r)
{
    struct sphfsi_requests *request = r->options->requests;
    const double minutes = r->session.scene.output.checkpoint_minutes;
    const bool by_clock = minutes > 0 && since(&r->wall_checkpoint) > 60 * minutes;
    if (by_clock || (request && request->checkpoint)) {
        if (request) request->checkpoint = 0;
        const double begin = wall_clock();
        TRY(write_checkpoint(r));
        r->sim->phase_seconds[PHASE_output] += wall_clock() - begin;
    }
    if (r->sim->state.seeks_rest)
        show_search(r);
    else
        show_progress(r, false);
    if (!request || !request->stop) return ERR_OK;
    TRY(write_checkpoint(r));
    return diag_fail(r->diag, ERR_INTERRUPT,
                     "stopped by signal %d at %.6g s; --restart continues from %s",
                     (int)request->stop, simulation_time(r->sim), r->checkpoint);
}

/* T-78. The rows begin with the state that is found. */
static enum err relax(struct run *r)
{
    char found[RELAX_TEXT];
    if (!r->sim->state.seeks_rest) return ERR_OK;
    session_say(r->options, "seeking a state of rest before t = 0");
    while (r->sim->state.seeks_rest) {
        TRY(relax_step(r->sim, r->diag));
        TRY(between_steps(r));
    }
    relax_text(r->sim, found);
    session_say(r->options, "%s", found);
    r->record.first = simulation_ledger(r->sim);
    return ERR_OK;
}

/* A run ends with the first step at or after its end: no output moves a step. */
static enum err advance(struct run *r)
{
    TRY(relax(r));
    rows_follow(&r->rows, r->sim);
    TRY(observe(r->sim, r->sim->state.time, r->diag));
    for (;;) {
        TRY(write_due(r));
        TRY(between_steps(r));
        if (r->sim->state.time >= r->session.scene.top.end_time) return ERR_OK;
        TRY(simulation_step(r->sim, (double)INFINITY, r->diag));
    }
}

/* --- end --- */

/* Speed, energy gained, particles lost, and errors against references. */
static void say_end(const struct sphfsi_options *o, const struct simulation *sim,
                    const struct record *r)
{
    char text[1024];
    if (sim->state.particle_steps > r->start_particle_steps)
        session_say(o, "%.3g million particle steps a second", 1e-6 * report_rate(sim, r));
    if (sim->effects & FX_ENERGY_ACCOUNT) {
        const double told = sim->guard.warned_gain;
        (told > 0 && sim->state.gain_share > told
             ? session_result
             : session_say)(o, "energy gained: at most %.3g J/m, %.2g %% of the available energy",
                            sim->state.gain, 100 * sim->state.gain_share);
    }
    if (sim->effects & FX_FLUID)
        session_say(o,
                    "fluid particles lost: %lld; largest number inside walls and solids at the "
                    "same time: %lld",
                    (long long)sim->state.lost, (long long)sim->state.entered);
    for (int k = 0; r->references->scored && k < r->references->n; k++) {
        reference_line(&r->references->item[k], text, sizeof text);
        session_say(o, "%s", text);
    }
}

/* Says how a stopped run continues: by a restart; after a guard, by a fork with steps half as long.
 * Where these would stop it again, the case must be changed first. */
static void say_next(const struct sphfsi_options *o, const struct simulation *sim,
                     const char *checkpoint, bool guard)
{
    const struct scene *const scene = sim->scene;
    const bool fast = sim->effects & FX_FLUID && scene->given_speed > SPEED_WARNING * scene->c0;
    double half;
    const char *const key = timestep_key_to_halve(sim, &half);
    if (!guard)
        session_result(o, "to go on: the same command with --restart%s",
                       o->fork ? " instead of --fork" : "");
    else if (fast || sim->guard.soft_beam ||
             (sim->state.steps <= 1 && scene->numerics.fixed_step == 0))
        /* A checkpoint keeps its speed of sound and its state. */
        session_result(o, "change the case, then start again: the same command with another --out");
    else if (sim->guard.case_at_fault)
        session_result(o,
                       "change the case, then go on: the same command with --fork %s and another "
                       "--out",
                       checkpoint);
    else
        session_result(o,
                       "to go on: the same command with --fork %s --set numerics.%s=%.4g and "
                       "another --out",
                       checkpoint, key, half);
}

/* After a failure: saves what can be saved. The message remains that of the failure. */
static void save_last_state(struct run *r, enum err why)
{
    struct diag second = session_diag(r->options);
    if (why != ERR_INTERRUPT && r->recent.size > 0 && store(r, &second))
        diag_warn(&second, "the last valid state could not be saved: %s", second.text);
    second.code = ERR_OK;
    if (why == ERR_GUARD && snapshots_write(&r->snapshots, r->sim, &second))
        diag_warn(&second, "the state at the stop could not be saved: %s", second.text);
    second.code = ERR_OK;
    const char *reason = why == ERR_GUARD       ? "guard"
                         : why == ERR_INTERRUPT ? "interrupted"
                         : why == ERR_MEMORY    ? "memory"
                                                : "input_output";
    if (write_summary(r, reason, r->diag->text, &second))
        diag_warn(&second, "summary.json could not be written: %s", second.text);
    if (why == ERR_GUARD && r->checkpoint[0])
        session_say(r->options, "last valid state, for a restart: %s; state at the stop: %s",
                    r->checkpoint, r->snapshots.path);
    if (r->checkpoint[0] && (why == ERR_GUARD || why == ERR_INTERRUPT))
        say_next(r->options, r->sim, r->checkpoint, why == ERR_GUARD);
}

/* --- start --- */

static enum err run_dir_of_case(const struct sphfsi_options *o, char path[PATH_BYTES],
                                struct diag *d)
{
    int length;
    const char *const name = session_name(o, &length);
    /* A name of dots would be a folder outside of runs/. */
    if ((int)strspn(name, ".") >= length)
        return diag_fail(
            d, ERR_INPUT,
            "%s: '%.*s' cannot be the name of the folder of results; choose one with --out",
            o->case_path, length, name);
    snprintf(path, PATH_BYTES, "runs/%.*s%s", length, name, o->fork ? "-fork" : "");
    return ERR_OK;
}

/* Writes case.cfg.part, and keeps its text in r->case_text. */
static enum err write_case(struct run *r, char part[PATH_BYTES])
{
    TRY(path_join(part, r->dir.path, "case.cfg.part", r->diag));
    unlink(part); /* a killed run may have left one */
    TRY(scene_write(&r->session.scene, part, r->diag));
    size_t size;
    const enum err e = file_read(part, &r->case_text, &size, r->diag);
    if (e) unlink(part);
    return e;
}

static enum err replace_case(struct run *r, const char *part)
{
    char path[PATH_BYTES];
    TRY(path_join(path, r->dir.path, "case.cfg", r->diag));
    if (rename(part, path) != 0)
        return diag_fail(r->diag, ERR_IO, "%s: cannot be replaced by %s: %s; nothing was started",
                         path, part, strerror(errno));
    return directory_sync(r->dir.path, r->diag);
}

static enum err start_fresh(struct run *r)
{
    TRY(snapshots_create(&r->snapshots, r->dir.path, &r->session.scene, SPHFSI_VERSION, r->diag));
    TRY(rows_start(&r->rows, r->dir.path, simulation_time(r->sim), r->diag));
    for (int k = 0; k < OUT_COUNT; k++) r->written[k] = -1;
    r->record.first = simulation_ledger(r->sim);
    return ERR_OK;
}

static enum err start_restart(struct run *r)
{
    const double time = r->sim->state.time;
    /* An uninterrupted run would not have the snapshot of an earlier end. */
    const double kept = r->recent.snapshot_of_end ? nextafter(time, -1) : time;
    /* First, so that a kill in between leaves no checkpoint that is newer than the rows. */
    TRY(checkpoint_remove_others(r->dir.path, r->sim->state.steps, r->diag));
    TRY(snapshots_resume(&r->snapshots, r->dir.path, &r->session.scene, SPHFSI_VERSION, kept,
                         &r->written[OUT_SNAPSHOT], r->diag));
    r->written[OUT_CHECKPOINT] = time;
    return rows_resume(&r->rows, r->dir.path, time, &r->record.first, r->diag);
}

/* Reads the checkpoint: the given one, or the newest of the run; of a fork that of a folder. */
static enum err find_checkpoint(struct run *r)
{
    const struct sphfsi_options *o = r->options;
    const char *file = o->fork ? o->fork : o->restart_file;
    if (!file) return checkpoint_newest(&r->recent, r->dir.path, r->restarted_from, r->diag);
    if (o->fork) return checkpoint_find(&r->recent, file, r->restarted_from, r->diag);
    snprintf(r->restarted_from, sizeof r->restarted_from, "%s", file);
    return checkpoint_read(&r->recent, file, r->diag);
}

static enum err load_checkpoint(struct run *r)
{
    const enum err missing = find_checkpoint(r);
    if (missing == ERR_MEMORY) return missing;
    /* A missing or damaged checkpoint is wrong input: nothing was started. */
    if (missing) return r->diag->code = ERR_INPUT;
    const struct checkpoint_info info = checkpoint_info(&r->recent);
    const bool fork = r->options->fork != NULL;
    const char *what = fork ? "fork" : "restart";
    TRY(case_change_check(info.case_text, r->case_text, fork, r->diag));
    if (strcmp(info.version, SPHFSI_VERSION) != 0)
        diag_warn(r->diag,
                  "%s was written by version %s, but this is %s: results may differ "
                  "in their last digits",
                  r->restarted_from, info.version, SPHFSI_VERSION);
    TRY(fork ? checkpoint_fork(&r->recent, r->sim, r->diag)
             : checkpoint_apply(&r->recent, r->sim, r->diag));
    /* The last step of a finished run passes its end. */
    const double last = r->sim->state.dt * simulation_batch(r->sim);
    if (simulation_time(r->sim) - last >= r->session.scene.top.end_time)
        return diag_fail(
            r->diag, ERR_INPUT,
            "%s: %s is at %.6g s, after the end at %.6g s; choose a later end_time or --until",
            what, r->restarted_from, r->sim->state.time, r->session.scene.top.end_time);
    session_say(r->options, "%s from %s at %.6g s, step %lld", what, r->restarted_from,
                simulation_time(r->sim), (long long)r->sim->state.steps);
    return ERR_OK;
}

/* Prepares all files. A restart changes files only after its checkpoint has been checked. */
static enum err begin_run(struct run *r)
{
    char part[PATH_BYTES];
    TRY(write_case(r, part));
    const enum err e = r->options->restart || r->options->fork ? load_checkpoint(r) : ERR_OK;
    if (e) {
        unlink(part);
        run_dir_withdraw(&r->dir); /* nothing was started */
        return e;
    }
    TRY(replace_case(r, part));
    TRY(continues_rows(r) ? start_restart(r) : start_fresh(r));
    const double time = simulation_time(r->sim);
    r->due[OUT_SNAPSHOT].interval = r->session.scene.output.snapshot_interval;
    r->due[OUT_CHECKPOINT].interval = r->session.scene.output.checkpoint_interval;
    /* A run begins with a snapshot. It needs no checkpoint, since the case or the fork gives its
     * start. */
    if (continues_rows(r)) due_pass(&r->due[OUT_SNAPSHOT], time);
    due_pass(&r->due[OUT_CHECKPOINT], time);
    r->record.version = SPHFSI_VERSION;
    r->record.restarted_from = r->options->fork ? "" : r->restarted_from;
    r->record.forked_from = r->options->fork ? r->restarted_from : "";
    r->record.threads = thread_count();
    r->record.start_time = time;
    r->record.start_particle_steps = r->sim->state.particle_steps;
    r->wall_start = r->wall_checkpoint = r->wall_progress = wall_clock();
    if (scene_given(&r->session.scene, SECTION_top, 0, "accuracy"))
        evidence_say(&r->session.scene, r->options);
    return ERR_OK;
}

static enum err simulate(struct run *r)
{
    const enum err failed = advance(r);
    if (failed) {
        save_last_state(r, failed);
        return failed;
    }
    score_references(r);
    r->record.probes = &r->probes;
    TRY(write_summary(r, "finished", "", r->diag));
    show_progress(r, true);
    session_say(r->options, "%s: %.6g s simulated in %lld steps, %.1f s of wall time", r->dir.path,
                r->sim->state.time, (long long)r->sim->state.steps, r->record.wall_seconds);
    say_end(r->options, r->sim, &r->record);
    if (r->session.scene.n_probe > 0)
        session_say(r->options, "draw it with tools/plot_probes.py %s", r->dir.path);
    return ERR_OK;
}

static void end_run(struct run *r)
{
    rows_close(&r->rows);
    snapshots_close(&r->snapshots);
    checkpoint_free(&r->recent);
    arena_free(&r->arena);
    free(r->case_text);
    run_dir_close(&r->dir);
}

static enum err run_session(struct run *r, const char *path, enum run_dir_use use)
{
    TRY(probes_create(&r->probes, r->sim, &r->arena, r->diag));
    TRY(rows_create(&r->rows, &r->probes, r->sim, true, &r->arena, r->diag));
    TRY(references_open(&r->references, &r->session.scene, r->probes.n_files, r->probes.file,
                        &r->arena, r->diag));
    r->record.references = &r->references;
    if (r->options->requests) {
        r->rows.stop = &r->options->requests->stop;
        r->options->requests->begun = 1;
    }
    TRY(run_dir_open(&r->dir, path, use, r->diag));
    TRY(begin_run(r));
    return simulate(r);
}

static enum err run_case(const struct sphfsi_options *o, struct diag *d)
{
    char named[PATH_BYTES];
    const char *const path = o->out ? o->out : named;
    const enum run_dir_use use = o->restart ? RUN_DIR_CONTINUE : RUN_DIR_FRESH;
    if (o->restart && o->fork)
        return diag_fail(d, ERR_INPUT,
                         "options: a restart continues a run, a fork starts a new one; choose one");
    if (!o->out) TRY(run_dir_of_case(o, named, d));
    TRY(run_dir_check(path, use, d)); /* before the work of building the simulation */
    struct run *r = calloc(1, sizeof *r);
    if (!r) return diag_fail(d, ERR_MEMORY, "run: no memory for %zu bytes", sizeof *r);
    r->options = o;
    r->diag = d;
    r->sim = &r->session.simulation;
    r->dir.lock = -1;
    enum err e = session_open(&r->session, o, d);
    if (!e) {
        check_simulation(r->sim, d);
        e = run_session(r, path, use);
        end_run(r);
        session_close(&r->session);
    }
    free(r);
    return e;
}

enum sphfsi_status sphfsi_run(const struct sphfsi_options *options)
{
    struct call c;
    enum err e = call_begin(&c, "run", options);
    if (!e) e = run_case(&c.options, &c.diag);
    return call_end(&c, e);
}
