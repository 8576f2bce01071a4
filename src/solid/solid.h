/* SPDX-License-Identifier: MIT
 * Total-Lagrangian elastic solid: reference neighbours as packs, deformation gradient, stress,
 * forces. */
#pragma once

#include "particles/particles.h"
#include "base/simd.h"
#include "geometry/motion.h"

/* Constants of one body, SI. */
struct solid_body {
    double dp, h;      /* spacing and smoothing length of its particles */
    double lambda, mu; /* Lame constants */
    double density, young;
    double mass;         /* of a particle per depth, rho0 dp^2 */
    double viscosity;    /* alpha_s c_s h of Eq. 14b (without rho0), m^2/s; 0: none */
    double sound_speed;  /* c_s of Eq. 29 */
    double kappa;        /* Eq. 17 */
    double damping_time; /* of Kelvin and Voigt, s; 0: none */
    double mass_damping; /* beta of T-77, 1/s; 0: none */
    double gravity[2];
    int law, plane, gradient;
    double thickness; /* of a slender body with those bonded to it: area over largest extent, m */
    int bond;       /* the same number for bodies joined to each other: that of the first of them */
    bool symmetric; /* viscous force with both particles' tensors */
    bool variational; /* hourglass force from an energy */
    bool mixed;       /* joined to a body of another viscosity: pairs use the mean of both */
};

/* Packed fields of the sweeps: the solid's arrays, float in mixed, double in double precision. */
enum solid_packed_field {
    S_UX, /* displacement, m: in mixed precision its leading digits, */
    S_UY,
    S_LOW_X, /* and the remainder, which keeps differences of neighbours accurate. Mixed only */
    S_LOW_Y,
    S_VX, /* m/s */
    S_VY,
    S_UXX, /* displacement gradient, 1 */
    S_UXY,
    S_UYX,
    S_UYY,
    S_PXX, /* first Piola-Kirchhoff stress, with the part of a variational hourglass force, Pa */
    S_PXY,
    S_PYX,
    S_PYY,
    S_GX, /* sum of the gradient weights of its neighbours, 1/m */
    S_GY,
    S_PAIRS_X, /* acceleration by hourglass and viscous force, m/s^2; variational only */
    S_PAIRS_Y,
    S_VISCOSITY, /* rho0 alpha_s c_s h of its body, Pa s; of joined bodies */
    SOLID_PACKED_FIELDS
};

/* W_X of a lane without such a neighbour: a divisor all the same, so it must not be zero. */
#define ABSENT_NEIGHBOUR_X 1e6

/* One reference neighbour of each particle of a pack, a slot. For lane l it is the particle
 * `offset` + i + l; the weights are zero if that lane has no such neighbour. A slot has one number
 * per lane for each weight, one weight after the other. */
enum solid_weight {
    W_GX, /* G_ab = V_b L_a^-1 grad_0 W_0ab, 1/m: F_a = sum of x_ba G_ab */
    W_GY,
    W_HX, /* -G_ba, 1/m: the weight of P_b in the force on a */
    W_HY,
    W_X, /* X_ab, m */
    W_Y,
    W_HALF_K, /* k_ab of T-26 or T-26a over 2 V rho0, 1/s^2 */
    SOLID_WEIGHTS
};

/* Particles i .. i + lanes - 1 of one body, with common slots for their neighbours. Packs with
 * equal surroundings use the same slots: the interior of a lattice needs one set. */
struct solid_pack {
    int32_t i, lanes, body;
    int32_t first_slot, n_slots;
};

struct solid;

/* Processes the packs from `first` to before `last`. */
typedef void solid_sweep(const struct solid *solid, struct particles *particles, int64_t first,
                         int64_t last);

/* Kicks the particles from `first` to `end` - 1 for `kick_time`, then drifts them by `drift`, to
 * the end of this step, and by `next`, into the following one. The drifts are added separately:
 * their sum rounds differently, and n steps at once would not have the bits of n steps. */
typedef void solid_kick(const struct particles *particles, int64_t first, int64_t end,
                        double kick_time, double drift, double next);

/* The sweeps of one precision. Bodies with the variational form have a separate pass over pairs:
 * for the hourglass and viscous forces, and for the stress, to which the hourglass force adds. */
struct solid_sweeps {
    const char *name;
    int lanes;                 /* particles of a full pack */
    size_t size;               /* bytes of a number */
    solid_sweep *pack_motion;  /* packs displacement and velocity */
    solid_sweep *stress;       /* gradient, and stress except of variational bodies */
    solid_sweep *pairs;        /* forces of pairs, and stress of variational bodies */
    solid_sweep *kelvin_voigt; /* adds the Kelvin-Voigt stress */
    solid_sweep *forces;       /* acceleration by neighbours, to sx, sy */
    solid_sweep *write_stress; /* gradient and stress, to the particles */
    /* Energy of the hourglass force of each particle of a pack, J/m, [lanes]. */
    void (*hourglass)(const struct solid *s, const struct solid_pack *pack, double *energy);
};
extern const struct solid_sweeps solid_sweeps_mixed, solid_sweeps_double;

/* Stands for all bodies. */
enum { SOLID_ALL = -1 };

struct solid {
    int n_bodies;
    struct solid_body *body;
    double dp; /* the smallest spacing of any body */
    int64_t n_packs, n_slots;
    int threads; /* that its loops use */
    const struct solid_sweeps *sweeps;
    void *packed[SOLID_PACKED_FIELDS]; /* each [n] */
    struct solid_pack *pack;
    void *weight;         /* [n_slots][SOLID_WEIGHTS][sweeps->lanes] */
    int64_t *offset;      /* [n_slots] */
    bool coupled;         /* meets fluid */
    bool centred;         /* kicks in the middle of drifts (T-30, T-36), else before them (T-32) */
    bool variational;     /* some body has its hourglass force from an energy */
    bool kelvin_voigt;    /* some body has a damping_time */
    double omega_max;     /* largest frequency of the linearised operator, 1/s */
    double damping_max;   /* largest rate of its viscous part, 1/s */
    double stable_step;   /* the largest stable step that follows from both, s */
    double acoustic_step; /* Eq. 29, s */
    double *scratch[6];   /* memory for the search of the step */
    double time;          /* of the displacements, s: contact uses walls at their positions then */
    /* Actions from outside, each NULL if there is none; contact: if none is near. */
    struct contact *contact;
    struct loads *loads;
    struct hinges *hinges;
    bool calls_out; /* a motion may be a function of the program, called on its own thread */
    const struct scene *gravity_scene;   /* of a gravity that varies in time; NULL: constant */
    const struct force_hook *force_hook; /* accelerations by a program */
    solid_kick *apply_kick;       /* of sub-steps: free, or against the impedance of a fluid */
    struct implicit *implicit;    /* data of implicit/; NULL: explicit steps only */
    solid_sweep *implicit_stress; /* what implicit steps change of the stress; NULL: nothing */
    double work;     /* of walls, clamps and loads on the solid since the last query, J/m */
    double *work_on; /* [n_bodies] the same for each body; contact counts for the first */
};

/* Element of an array in the precision of the sweeps, such as a packed field or the weights. */
SPHFSI_INLINE void solid_set(const struct solid *solid, void *array, int64_t i, double value)
{
    if (solid->sweeps->size == sizeof(double))
        ((double *)array)[i] = value;
    else
        ((float *)array)[i] = (float)value;
}

SPHFSI_INLINE double solid_get(const struct solid *solid, const void *array, int64_t i)
{
    return solid->sweeps->size == sizeof(double) ? ((const double *)array)[i]
                                                 : (double)((const float *)array)[i];
}

/* --- solid.c, stencil.c, spectrum.c, cauchy.c, reaction.c --- */

/* Builds constants, reference neighbours and their weights for particles whose X, Y, body and free
 * are set. implicit: for implicit steps, in double precision. */
enum err solid_create(struct solid *solid, struct arena *a, const struct scene *scene,
                      struct particles *particles, bool implicit, struct diag *d) SPHFSI_CHECKED;

/* Area of the bodies of a bond, or of all (SOLID_ALL), over their largest extent, m. */
double solid_thickness(const struct solid *solid, const struct particles *particles, int bond);

/* Lets n threads step a solid that is large enough; a small one keeps what it has. */
void solid_use_threads(struct solid *solid, const struct particles *particles, int n);

/* Cuts the particles into packs, finds their reference neighbours within 2h in their body and the
 * gradient's weights, and sums these (S_GX, S_GY). Bodies, sweeps and packed fields are set. */
enum err solid_stencil_create(struct solid *solid, struct arena *a,
                              const struct particles *particles, struct diag *d) SPHFSI_CHECKED;

/* Displacement gradient and first Piola-Kirchhoff stress of every particle (Eqs. 9-13b). In the
 * variational form hourglass control adds to the stress; then also the pair forces. */
void solid_stress(struct solid *solid, struct particles *particles);

/* Total acceleration (Eq. 21b) to sx, sy, after solid_stress of this state; zero where clamped. */
void solid_forces(const struct solid *solid, struct particles *particles);

/* The displacement gradients alone, to the particles; in double precision. */
void solid_gradient(const struct solid *solid, struct particles *particles);

/* Stress and acceleration for the present displacements and velocities, with actions from outside
 * at a time. */
void solid_stress_and_forces(const struct solid *solid, struct particles *particles, double time);

/* The acceleration by the forces between particles alone to sx, sy; zero where clamped. Of the
 * other results only the packed fields are updated. displaced: not only velocities have changed
 * since the last call. */
void solid_pair_forces(struct solid *solid, struct particles *particles, bool displaced);

/* Accelerations now, m/s^2, and forces of clamps and hinges, N/m (0 where none acts), from
 * what solid_stress has found. They stay in the scratch of the solid until that is used again. The
 * particles keep theirs. */
struct held_forces {
    const double *ax, *ay, *held_x, *held_y;
};
struct held_forces solid_held_forces(struct solid *solid, struct particles *particles, double time);

/* n explicit sub-steps of dt with the fluid's force. Semi-implicit Euler (Eq. 27): kick,
 * drift. With `centred`: half drift, kick, half drift, second order in time. Gradients, stresses,
 * accelerations and packed fields are those of the last sub-step only after solid_write_stress and
 * solid_stress. */
void solid_advance(struct solid *solid, struct particles *particles, double dt, int n);

/* Kick and drift where no fluid resists them. */
solid_kick solid_plain_kick;

/* x = X + u; returns the largest displacement by it, m. */
double solid_set_positions(struct particles *particles);

/* Writes gradients and stresses of the last evaluation to the particles; in double precision they
 * are there. */
void solid_write_stress(const struct solid *solid, struct particles *particles);

/* After a kick of dt with the last forces, from the velocities vx, vy: friction slides, rigid
 * bodies are kicked, and the work of actions from outside is added up. */
void solid_finish_kick(struct solid *solid, struct particles *particles, const double *vx,
                       const double *vy, double dt);

/* Sets particles with prescribed motion to their positions at a time. */
void solid_place_clamps(const struct solid *solid, struct particles *particles, double time);

/* The largest stable step for the square of a frequency and a rate of damping, s. */
double solid_step_of(double omega2, double damping);

/* Largest frequency and damping rate of the operator linearised about the present deformation, by
 * power iteration on the force routine; and the stable step, s. Restores all data. */
double solid_stable_step(struct solid *solid, struct particles *particles, double *omega,
                         double *damping);

/* Stiffness of the stiffest particle to a wave along a principal axis, over the undeformed one,
 * from gradients that are up to date. 1 if no particle is stretched or compressed by some 5 %. */
double solid_stiffening(const struct solid *solid, const struct particles *particles);

/* Cauchy stress (xx, yy, xy, zz), Pa, and det F of a particle from its displacement gradient. */
void solid_cauchy(const struct solid *solid, const struct particles *particles, int64_t i,
                  double sigma[4], double *det);

/* Von Mises stress, Pa, of a Cauchy stress (xx, yy, xy, zz). */
double solid_von_mises(const double sigma[4]);

/* Strain and hourglass energy of a body, or all, J/m; smallest det F. After solid_stress. */
void solid_energy(const struct solid *solid, const struct particles *particles, int body,
                  double *elastic, double *hourglass, double *det_low);
