/* SPDX-License-Identifier: MIT
 * sphfsi: two-dimensional fluid-structure interaction by smoothed particle hydrodynamics.
 *
 *     struct sphfsi_simulation *s;
 *     const struct sphfsi_options options = {.case_path = "cases/gate.cfg"};
 *     if (sphfsi_create(&s, &options)) return puts(sphfsi_error()), 1;
 *     while (sphfsi_time(s) < 0.1 && !sphfsi_step(s, INFINITY)) {}
 *     struct sphfsi_view x;
 *     if (!sphfsi_field(s, SPHFSI_FLUID, "x", &x)) printf("%g m\n", ((const double *)x.data)[0]);
 *     sphfsi_free(s);
 *
 * Units: all are SI; extensive quantities are per metre of depth. Numbers are read and written with
 * a decimal point, whatever the locale of the program.
 *
 * Errors: functions that can fail return 0 or an enum sphfsi_status; sphfsi_error() then returns
 * one sentence. The library does not print, does not exit and installs no signal handlers; notes
 * and warnings go to the message callback.
 *
 * NULL: a pointer must not be NULL unless its description allows it; the function then returns
 * SPHFSI_INPUT. Without a simulation sphfsi_time, sphfsi_end_time, sphfsi_time_step and
 * sphfsi_next_output return NaN; sphfsi_steps, sphfsi_count and sphfsi_hash return 0.
 *
 * Threads: different simulations may be used from different threads at the same time; one
 * simulation only by one thread at a time, not always the same one. A second call into a simulation
 * during a call returns SPHFSI_INPUT. A simulation uses at most the number of threads that it was
 * created with, and one where that is faster. The locale and the OpenMP settings of the calling
 * thread are the same after a call, and in callbacks, as before the call.
 *
 * Callbacks: the thread that called the library calls them, before that call returns and outside of
 * parallel regions. A callback may call the library. For the simulation or run that it serves, it
 * may only call sphfsi_time, sphfsi_end_time, sphfsi_time_step, sphfsi_steps, sphfsi_count and
 * sphfsi_field_name. It must return: neither longjmp nor a C++ exception may leave it.
 *
 * Ownership: the caller owns its arguments and may free them after the call; contexts of forces and
 * motions must exist as long as these are set. The library owns what it returns: texts are constant
 * or valid until the next call, views until the next step, advance or free. sphfsi_free frees what
 * sphfsi_create made. */
#ifndef SPHFSI_H
#define SPHFSI_H

#include <signal.h>
#include <stdint.h>

#ifndef SPHFSI_API
#define SPHFSI_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Result of a function. sphfsi_exit_status() turns it into the exit status of a program. */
enum sphfsi_status {
    SPHFSI_OK = 0,
    SPHFSI_INPUT,    /**< the case, a file it names, or an option is wrong; nothing was started */
    SPHFSI_MEMORY,   /**< not enough memory */
    SPHFSI_IO,       /**< a file could not be written or read */
    SPHFSI_GUARD,    /**< the numerical state is no longer sound */
    SPHFSI_INTERRUPT /**< stopped by sphfsi_requests.stop */
};

/** Kinds of particles. */
enum sphfsi_kind { SPHFSI_FLUID, SPHFSI_WALL, SPHFSI_SOLID };

/** Types of a field's items. */
enum sphfsi_type { SPHFSI_DOUBLE, SPHFSI_INT64, SPHFSI_INT32 };

/** What a message is. */
enum sphfsi_message {
    SPHFSI_NOTE,
    SPHFSI_WARNING,
    SPHFSI_RESULT /**< a note to show also where others are left out: a table, how to go on */
};

/** Progress of a run; valid during the callback. */
struct sphfsi_progress {
    double time, end_time; /**< s, simulated */
    double start_time;     /**< s, simulated, at which this process began */
    double dt;             /**< s, last time step */
    const char *bound;     /**< what limited dt */
    double particle_steps_per_second;
    double wall_seconds; /**< s, wall time since this process began to step */
    double seconds_left; /**< s, wall time, estimated; negative: not known yet */
    int64_t steps;
    int finished; /**< 1 at the last call */
};

/** Requests to a running sphfsi_run; may be set from a signal handler. */
struct sphfsi_requests {
    volatile sig_atomic_t stop; /**< not 0: write a checkpoint and stop */
    volatile sig_atomic_t
        checkpoint; /**< not 0: write a checkpoint and continue; reset when done */
    volatile sig_atomic_t
        begun; /**< set by the run when it begins to write files; until then a stop waits */
};

/** What to simulate and how. Zero-initialise, then set what is needed. The library does not refer
 * to it after the call. */
struct sphfsi_options {
    const char *case_path;   /**< case file; with case_text: the name in messages and the path to
                                which file names are relative; may be NULL */
    const char *case_text;   /**< the case itself, instead of a file */
    const char *const *sets; /**< "key=value" or "section.key=value", replace values of the case */
    int n_sets;
    int threads;  /**< 0: OMP_NUM_THREADS, else as many as are useful and offered by OpenMP;
                       more than are useful, or than 4 a core, are reduced with a warning */
    double until; /**< s; simulated time to end at instead of the case's end_time; 0: that */

    /* Of sphfsi_run only. */
    const char *out;          /**< folder of the run; NULL: runs/<name of the case>[-fork] */
    int restart;              /**< 1: continue the run in that folder */
    const char *restart_file; /**< checkpoint to continue from; NULL: the newest valid one */
    const char *fork; /**< checkpoint, or folder of a run, from which a new run with other physics
                           starts; NULL: none. Keys that the state depends on must not change. */
    struct sphfsi_requests *requests;                                 /**< may be NULL */
    void (*progress)(void *context, const struct sphfsi_progress *p); /**< may be NULL */
    double progress_interval; /**< s, least wall time between calls; 0: 0.25 */

    void (*message)(void *context, enum sphfsi_message kind, const char *text); /**< may be NULL */
    void *context; /**< first argument of the callbacks */
};

/** A view of a field: owned by the simulation, read only. Valid until the next step, advance or
 * free; the order of fluid particles changes between steps, their `id` stays. */
struct sphfsi_view {
    const void *data; /**< [count][components] items of the type */
    int64_t count;    /**< particles */
    enum sphfsi_type type;
    int components;   /**< 1; of a vector 3, of a stress 6, as in fields.vtkhdf */
    const char *unit; /**< such as "m/s" */
    const char *meaning;
};

struct sphfsi_simulation;

/** Version of the library, such as "0.1.0". */
SPHFSI_API const char *sphfsi_version(void);

/** Sentence of the last failure in this thread; "" before the first. Valid until the next one. */
SPHFSI_API const char *sphfsi_error(void);

/** Further sentences of that failure, each ended by a newline: a case is read to its end, and all
 * that is wrong with it is said, up to 20 problems, sorted by line. "" if there are none. */
SPHFSI_API const char *sphfsi_more_errors(void);

/** Exit status for a result: 0; 1 wrong input; 2 everything else, except INTERRUPT, which
 * is 128 plus the number of the signal. */
SPHFSI_API int sphfsi_exit_status(enum sphfsi_status status, int signal_number);

/** Builds a simulation in memory at time zero; no file is written. On success the caller frees
 * *result with sphfsi_free; on failure *result is NULL. */
SPHFSI_API enum sphfsi_status sphfsi_create(struct sphfsi_simulation **result,
                                            const struct sphfsi_options *options);
/** Frees a simulation; NULL is allowed. SPHFSI_INPUT: a callback of the simulation has called it,
 * or another thread is in a call; the simulation stays. */
SPHFSI_API enum sphfsi_status sphfsi_free(struct sphfsi_simulation *s);

/** Takes one time step; of a solid without fluid, up to 16. It ends at `limit` (s) at the latest.
 * INFINITY: the physics alone sets the step, and steps have the bits of sphfsi_run, which ends with
 * the first step at or after its end. A limit within the next two steps shortens them and so
 * changes the bits of all that follows. Limits a few steps apart make uneven steps, in which a
 * solid with sub-steps can gain energy (docs/theory.md, T-34b). SPHFSI_INPUT: `limit` is not later
 * than the time. SPHFSI_GUARD: the state is not sound; the simulation can be read and freed, but
 * not stepped. */
SPHFSI_API enum sphfsi_status sphfsi_step(struct sphfsi_simulation *s, double limit);

/** Steps until the simulated time is exactly `time` (s), which is the limit of these steps. Errors
 * as sphfsi_step. */
SPHFSI_API enum sphfsi_status sphfsi_advance(struct sphfsi_simulation *s, double time);

/** Simulated time, time at which the case ends, last time step, s. */
SPHFSI_API double sphfsi_time(const struct sphfsi_simulation *s);
SPHFSI_API double sphfsi_end_time(const struct sphfsi_simulation *s);
SPHFSI_API double sphfsi_time_step(const struct sphfsi_simulation *s);

/** Time (s) of the next output that sphfsi_run would write of this case, at most the end time. */
SPHFSI_API double sphfsi_next_output(const struct sphfsi_simulation *s);

/** Number of steps taken, and of particles of a kind. */
SPHFSI_API int64_t sphfsi_steps(const struct sphfsi_simulation *s);
SPHFSI_API int64_t sphfsi_count(const struct sphfsi_simulation *s, enum sphfsi_kind kind);

/** Gives a view of a field by its name; sphfsi_field_name lists the names. Arrays of the particles
 * are not copied: x, y (m), vx, vy (m/s), id, body; if the kind has them, dens (rho/rho0 - 1), p
 * (Pa), ux, uy (m), X, Y (m), fx, fy (N/m, the present force of the fluid on the particle) and
 * others. The fields of fields.vtkhdf are computed in the call: Points (m; on its line for a
 * particle of a beam or thin wall), velocity (m/s), density (kg/m^3), pressure (Pa), stress (Pa: xx
 * yy zz xy yz xz), von_mises (Pa), displacement (m), det_F; of walls, if there are beams, thickness
 * (m), axial_force, shear_force (N/m), moment (N), curvature (1/m). Fields that follow from
 * positions, such as p, fx and ddens, are updated to the present positions first; the state does
 * not change. SPHFSI_INPUT: this kind has no such field in this scene. */
SPHFSI_API enum sphfsi_status sphfsi_field(struct sphfsi_simulation *s, enum sphfsi_kind kind,
                                           const char *name, struct sphfsi_view *view);

/** Name of the k-th field (from 0) that particles of a kind have in this scene; NULL after the
 * last. */
SPHFSI_API const char *sphfsi_field_name(const struct sphfsi_simulation *s, enum sphfsi_kind kind,
                                         int k);

/** Values of a probe of the case now, or its mean so far, by the name of its section: as many as
 * its quantity has columns (docs/cases.md), at most SPHFSI_PROBE_COLUMNS. SPHFSI_INPUT: no such
 * probe. */
enum { SPHFSI_PROBE_COLUMNS = 5 };
SPHFSI_API enum sphfsi_status sphfsi_probe(struct sphfsi_simulation *s, const char *name,
                                           double values[SPHFSI_PROBE_COLUMNS]);

/** Name of the k-th probe of the case (from 0), and of the c-th of its columns, such as M1_dx_m;
 * NULL after the last. */
SPHFSI_API const char *sphfsi_probe_name(const struct sphfsi_simulation *s, int k);
SPHFSI_API const char *sphfsi_probe_column(struct sphfsi_simulation *s, int k, int c);

/** The particles, for a user's force; n items each, read only, valid during the call. */
struct sphfsi_particles {
    double time; /**< s */
    int64_t n;
    const int64_t *id;
    const int32_t *body;   /**< index of the section among those of its kind */
    const double *x, *y;   /**< m */
    const double *vx, *vy; /**< m/s */
};

/** A user's force: adds its accelerations (m/s^2) to ax and ay, which are zero before; n may be 0.
 * It is called at every evaluation of the rates, once or twice a step, and also when pressure is
 * read. So it should depend on its arguments only. The energy ledger does not contain its work, so
 * the guard that stops a simulation which gains energy ends with the first force. */
typedef void sphfsi_force(void *context, const struct sphfsi_particles *p, double *ax, double *ay);

/** Sets the force on fluid or solid; NULL removes it. Clamped particles do not move. */
SPHFSI_API enum sphfsi_status sphfsi_set_force(struct sphfsi_simulation *s, enum sphfsi_kind kind,
                                               sphfsi_force *force, void *context);

/** A motion of walls at a time: displacement from their position in the case (m), velocity and
 * acceleration; all are zero before. The acceleration enters the pressure on the wall. Times may go
 * back. While one is set, the calling thread alone steps solids that have moving clamps or contact.
 */
typedef void sphfsi_motion(void *context, double time, double d[2], double v[2], double a[2]);

/** Replaces [motion NAME] of the case by a user's motion, from the next step on; NULL restores it.
 */
SPHFSI_API enum sphfsi_status sphfsi_set_motion(struct sphfsi_simulation *s, const char *name,
                                                sphfsi_motion *motion, void *context);

/** Hash of the whole state; equal for equal bits. */
SPHFSI_API uint64_t sphfsi_hash(struct sphfsi_simulation *s);

/** Runs a case to its end and writes probes.csv, ledger.csv, fields.vtkhdf, summary.json, case.cfg
 * and checkpoints to its folder. */
SPHFSI_API enum sphfsi_status sphfsi_run(const struct sphfsi_options *options);

/** Prints, line by line through the message callback, effects, memory, time step and cost of a
 * case. */
SPHFSI_API enum sphfsi_status sphfsi_explain(const struct sphfsi_options *options);

/** Prints what sphfsi_explain prints as one JSON text through the message callback; docs/formats.md
 * lists its keys.
 */
SPHFSI_API enum sphfsi_status sphfsi_explain_json(const struct sphfsi_options *options);

/** Writes the case in effect, every default spelled out, to a file ("/dev/stdout" is one). Names of
 * files in it are relative to that file; in one of /dev they are absolute. */
SPHFSI_API enum sphfsi_status sphfsi_effective(const struct sphfsi_options *options,
                                               const char *path);

/** Draws the scene at the start as SVG: particles of bodies, names, clamps, probes, a grid. To
 * options->out; NULL: preview-<name of the case>.svg. */
SPHFSI_API enum sphfsi_status sphfsi_preview(const struct sphfsi_options *options);

/** Prints, line by line through the message callback, the publications of the methods that a case
 * uses. */
SPHFSI_API enum sphfsi_status sphfsi_cite(const struct sphfsi_options *options);

/** Prints, line by line through the message callback, every section and key of a case file, and the
 * quantities of a probe. The other options may be zero. */
SPHFSI_API enum sphfsi_status sphfsi_keys(const struct sphfsi_options *options);

/** Prints what sphfsi_keys prints, and the effects, as one JSON text through the message callback:
 * type, unit, range, default, meaning and example of each key. */
SPHFSI_API enum sphfsi_status sphfsi_keys_json(const struct sphfsi_options *options);

/** A commented case as a template; NULL, with the known names in sphfsi_error(), if no template has
 * this name. sphfsi_template_name: the k-th name; NULL after the last. */
SPHFSI_API const char *sphfsi_template(const char *name);
SPHFSI_API const char *sphfsi_template_name(int k);

/** Prints the contents of a checkpoint, a file or the newest valid one in the folder of a run, line
 * by line through the message callback. The other options may be zero. SPHFSI_INPUT: there is no
 * sound checkpoint of this format. */
SPHFSI_API enum sphfsi_status sphfsi_inspect(const char *file,
                                             const struct sphfsi_options *options);

#ifdef __cplusplus
}
#endif
#endif
