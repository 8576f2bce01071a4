/* SPDX-License-Identifier: MIT
 * A run in memory: the scene's particles, their neighbours, the models, and the order of a step.
 * Contains no file names and no command lines. */
#ifndef SPHFSI_TIME_SIMULATION_H
#define SPHFSI_TIME_SIMULATION_H

#include "coupling/coupling.h"
#include "particles/cells.h"
#include "solid/contact.h"
#include "solid/loads.h"
#include "case/effects.h"
#include "fluid/fluid.h"
#include "fluid/open.h"
#include "time/ledger.h"
#include "time/state.h"
#include "fluid/wall_motion.h"
#include "particles/particles.h"
#include "case/scene.h"
#include "solid/solid.h"

/* Extremes of density (rho/rho0 - 1) and squared speed ((m/s)^2). The maxima may skip values that
 * are not numbers; the NaN probe is zero if there are none. */
struct extremes {
    double dens_low, dens_high, speed2, nan_probe;
};

/* Accelerations from outside, added to those of the model by a program that uses the library. */
typedef void external_function(void *context, double time, const struct particles *p, double *ax,
                               double *ay);
struct external {
    external_function *at; /* NULL: none */
    void *context;
    double *ax, *ay; /* m/s^2 */
};

struct simulation {
    const struct scene *scene; /* borrowed; outlives the simulation */
    struct arena arena;
    struct particles kind[KIND_COUNT]; /* fluid, wall, solid */
    struct cells cells;
    struct fluid fluid; /* model and sweeps of fluid, walls and coupling; unused without fluid */
    struct wall_motion wall_motion; /* walls that move; unused where none does */
    struct open open;               /* open boundaries; unused without any */
    struct solid solid;             /* model of the solid; unused without one */
    struct coupling coupling;       /* of fluid and solid; unused without both */
    struct contact contact;         /* of the solid; unused without it */
    struct loads loads;             /* of the solid; unused without loads and moving clamps */
    effect_set effects;             /* bits of case/effects.h */
    struct state state;
    double dt_bound[BOUND_COUNT]; /* bounds found at the last step, s; INFINITY where none */
    double dt_solid;              /* stable step of the solid times its safety, s */
    double dt_lone_solid;         /* the same as if there were no contact */
    int substeps;                 /* solid steps in the last fluid step */
    double phase_seconds[PHASE_COUNT];
    struct extremes extremes; /* of the fluid */
    double speed2;            /* of the fastest particle of any kind, squared, (m/s)^2 */
    double solid_max_move;    /* of a solid particle in the last step, m (not with symplectic) */
    double shifted;   /* largest shift of a fluid particle in the last step, m; 0: no shifting */
    double skin_left; /* distance that two particles may move until a sorting is due, m */
    bool evaluated;   /* rates, pressures and the fluid's force are those of the present state */
    bool
        cells_overfull; /* cells hold more particles than the sweeps support: evaluations do nothing */
    bool gravity_varies; /* with time */
    int uneven; /* the output, from 1, that has no such grid with those before it; 0: none */
    double output_grid; /* s, of all frequent outputs; 0: none is needed (T-34d) */
    struct {
        int64_t n;
        double *value;
    } carried; /* by probes from step to step (output/probes.h): checkpointed, not hashed */
    struct guard guard;
    struct external external[KIND_COUNT]; /* of fluid and solid */
    struct gain gain;                     /* of the last check of the account */
    bool checked;                         /* the guards have yet to read it */
};

/* Registers `at`, which adds accelerations to the particles of a kind (fluid or solid) from the
 * next evaluation on. It is called once for each evaluation of the fluid; the solid's sub-steps use
 * the same values. */
enum err simulation_external(struct simulation *s, enum kind kind, external_function *at,
                             void *context, struct diag *d) SPHFSI_CHECKED;

/* Builds the state at time zero from a scene, or the arrays for it if a checkpoint is to be loaded.
 * After a failure there is nothing to free. */
enum err simulation_create(struct simulation *s, const struct scene *scene, struct diag *d)
    SPHFSI_CHECKED;
void simulation_free(struct simulation *s);

/* Advances by one time step, ending no later than t_limit (> time), and exactly at it if the step
 * comes within a step of it. ERR_GUARD: the state is invalid; d has the message. */
enum err simulation_step(struct simulation *s, double t_limit, struct diag *d) SPHFSI_CHECKED;

/* After the STATE fields, n of each kind and s->state have been loaded from a checkpoint: rebuilds
 * everything derived. The next step gives the same bits as in the uninterrupted run. */
enum err simulation_resume(struct simulation *s, struct diag *d) SPHFSI_CHECKED;

/* Brings DERIVED fields that output uses (pressure of wall and solid; displacement gradient) up to
 * date without changing the state. */
void simulation_refresh(struct simulation *s);

/* Present energy, momentum and extremes; calls simulation_refresh. */
struct ledger simulation_ledger(struct simulation *s);

/* The account of energy begins with the present state. */
void simulation_begin_account(struct simulation *s);

/* Hash of every STATE field and state scalar; calls simulation_refresh. */
uint64_t simulation_hash(struct simulation *s);

/* The fluid at a fixed point, by the kernel over its particles within reach. Positions and
 * densities must be up to date, as they are between two steps; for the pressure accelerations as well, as
 * after simulation_refresh. */
struct sample {
    double fill;     /* sum V W of the fluid: about 1 inside it, 0.5 at its surface */
    double occupied; /* the same of walls and structures */
    double pressure; /* Pa, mean over the fluid, brought to the point (T-10a); 0 where dry */
    double vx, vy;   /* m/s, mean over the fluid; 0 where dry */
};
struct sample simulation_sample(const struct simulation *s, double x, double y);

/* Energy that walls and structures have stored by repelling each fluid section (L-7b), J/m. */
void simulation_repulsion(const struct simulation *s, double of[SCENE_MAX_SECTIONS]);

/* Particles of all kinds within reach of a point. */
int simulation_near(const struct simulation *s, double x, double y);

/* Fluid pressure at a fixed point, Pa: that of simulation_sample. */
double simulation_pressure_at(const struct simulation *s, double x, double y);

/* Height of the free surface above (x, y): the lowest height at which the water ends. y itself if
 * no water is within reach above it. */
double simulation_level(const struct simulation *s, double x, double y);

/* Coordinate of the foremost fluid in a direction (enum probe_direction). Isolated groups of one or
 * two particles are ignored unless there is no other fluid. NAN if there is no fluid. */
double simulation_front(const struct simulation *s, int direction);

/* Flow through the line from a to b, positive to the right of that direction, m^2/s per depth. */
double simulation_flux(const struct simulation *s, const double a[2], const double b[2]);
/* Mean pressure along the line from a to b, Pa, and its force on a surface with the fluid to the left of the
 * line, N/m: the midpoint rule over pieces of at most dp. */
void simulation_pressure_on(const struct simulation *s, const double a[2], const double b[2],
                            double out[3]);

#endif
