/* SPDX-License-Identifier: MIT
 * The state of a run in memory: what it carries from step to step, and `struct simulation`,
 * which all files of this folder work on. */
#pragma once

#include "base/threads.h"
#include "beam/beam.h"
#include "coupling/coupling.h"
#include "fluid/damping.h"
#include "fluid/open.h"
#include "solid/contact.h"
#include "implicit/implicit.h"
#include "time/account.h"

struct guard {
    double dens_limit;  /* |rho/rho0 - 1| */
    double speed_limit; /* m/s: at the speed of sound no flow is weakly compressible */
    double step_limit;  /* s: a smaller step stops the run */
    double warned_gain; /* of energy: the share in the last warning of it, or 0 */
    bool warned_speed, warned_dens, warned_det, warned_step, warned_entered, warned_contact,
        warned_voids, warned_rigid, warned_beams, warned_beam_in_solid,
        warned_left[ENERGY_ENTRIES]; /* of each section */
    bool case_at_fault; /* what stopped the run would stop it with shorter steps, too */
    bool soft_beam;     /* a beam without enough damping may have; its last state is lost already */
};

enum bound {
#define BOUND(name, effect, source) BOUND_##name,
#include "time/bounds.def"
#undef BOUND
    BOUND_COUNT
};
/* From time/bounds.def. */
extern const struct bound_info {
    const char *name, *source;
    effect_set effect; /* that the bound belongs to; 0: none */
} bound_table[BOUND_COUNT];

/* Scalars carried from step to step, from time/state.def. */
struct state {
#define STATE(type, name, low, high, unit, meaning) type name;
#include "time/state.def"
#undef STATE
    int64_t bound_steps[BOUND_COUNT]; /* steps that each bound has limited */
    struct energy_account energy;
};

struct simulation;

/* Reads the state between steps and changes nothing that a step depends on. */
struct observer {
    /* Called if `next` is not after `until`, the latest time at which the coming step can end. Sets
     * `next`. */
    enum err (*look)(void *context, struct simulation *sim, double until, struct diag *d);
    void *context; /* NULL: nobody looks */
    double next;   /* s: the states on both sides of this time are wanted */
};

/* Extremes of density (rho/rho0 - 1) and squared speed ((m/s)^2). The maxima may skip values that
 * are not numbers; the NaN probe is zero if there are none. */
struct extremes {
    double dens_low, dens_high, speed2, nan_probe;
};

/* What the next sorting of particles into cells depends on. */
struct sorting {
    double speed2;     /* of the fastest particle of any kind, squared, (m/s)^2 */
    double solid_move; /* largest of a solid particle in the last step, m; not at a single rate of
                        * `symplectic`, where sorting_due measures */
    double shifted;    /* largest shift of a fluid particle in the last step, m; 0: no shifting */
    double skin_left;  /* distance that two particles may move until a sorting is due, m */
};

/* What differs between the time integrators of Sec. 2.4. */
struct integrator {
    /* One step of fluid, walls and structures, which ends no later than t_limit. */
    void (*step)(struct simulation *sim, double t_limit);
    /* The fluid's part of a step with one evaluation (step_of_one_stage); NULL: others. */
    void (*update)(struct simulation *sim, double dt);
    /* One step of a solid without fluid; NULL: by solid_advance. */
    void (*solid_step)(struct simulation *sim, double dt);
    double largest_cfl; /* up to it the fluid is stable */
    /* T-33b: a decay of density or velocity at a rate m is followed up to m dt of these. */
    double density_decay, velocity_decay;
    unsigned fluid_groups; /* fields that it needs besides those of its effect */
    double rates_at; /* of the rates that advance the fluid, in steps after the start of the step */
    bool centred;    /* `centred` of the solid's explicit steps (solid.h) */
    bool alternates; /* carries on two solutions, by turns */
};

struct simulation {
    const struct scene *scene; /* borrowed; outlives the simulation */
    const struct integrator *integrator;
    struct arena arena;
    struct particles particles[KIND_COUNT]; /* fluid, wall, solid */
    struct cells cells;
    struct fluid fluid;             /* model and sweeps of fluid and walls; unused without fluid */
    struct wall_motion wall_motion; /* walls that move; unused where none does */
    struct rigid rigid;             /* rigid bodies, a part of these; unused without any */
    struct beams beams;             /* unused without any */
    struct damping_zones zones;     /* zones of damping; unused without any */
    struct open_boundaries open;    /* open boundaries; unused without any */
    struct solid solid;             /* model of the solid; unused without one */
    struct coupling coupling;       /* of fluid and solid; unused without both */
    struct contact contact;         /* of the solid; unused without it */
    struct equilibrium rest;        /* of solids without fluid, with [relax] */
    effect_set effects;             /* bits of case/effects.h */
    struct state state;
    double dt_bound[BOUND_COUNT]; /* bounds found at the last step, s; INFINITY where none */
    double dt_solid;      /* step that solids allow, with solid_safety; without solids that of
                             rigid bodies and beams, s */
    double dt_lone_solid; /* dt_solid as if there were no contact, s */
    int stiffest;         /* the [spring] that sets dt_solid without solids, from 1; 0: none */
    int substeps;         /* solid steps in the last fluid step */
    struct team team;
    double phase_seconds[PHASE_COUNT];
    struct extremes extremes; /* of the fluid */
    struct sorting sorting;
    bool evaluated;      /* rates, pressures and the fluid's force are those of the present state */
    bool cells_overfull; /* more particles in a cell than the sweeps support: no evaluations */
    bool gravity_varies; /* with time */
    struct {
        int64_t n;
        double *value;
    } carried; /* by rows from step to step (output/rows.h): checkpointed, not hashed */
    struct observer observer;
    struct guard guard;
    struct force_hook force_hook[KIND_COUNT]; /* of fluid and solid */
    struct energy_gain gain;                  /* of the last test of the energy account */
};

/* While rest is sought (T-78), the state's time is how long it has been sought. Motions, loads and
 * gravity are taken at scene_time: at `time` of the run, and before all of it while rest is sought,
 * when nothing is driven and all else is as at t = 0. The run's own time is 0 then. */
double scene_time(const struct simulation *sim, double time);
double simulation_time(const struct simulation *sim);

/* "t = 0.1 s" for a message, or how long rest has been sought. */
struct time_text {
    char text[64];
};
struct time_text time_text(const struct simulation *sim);

/* Lets the observer look at the present state; the coming step ends at `until` at the latest. */
enum err observe(struct simulation *sim, double until, struct diag *d) SPHFSI_CHECKED;

/* Adds the time since `since` to a phase and returns the present time. */
double phase_add(struct simulation *sim, enum phase phase, double since);
double phases_so_far(const struct simulation *sim);
