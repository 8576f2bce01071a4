/* SPDX-License-Identifier: MIT
 * Total-Lagrangian elastic solid: reference neighbours as packs, deformation gradient, stress, forces. */
#ifndef SPHFSI_SOLID_SOLID_H
#define SPHFSI_SOLID_SOLID_H

#include "particles/particles.h"
#include "case/scene.h"
#include "base/simd.h"

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
    double gravity[2];
    int law, plane, gradient;
    int bond;         /* bodies joined to each other share this number, that of the first of them */
    bool symmetric;   /* viscous force with both particles' tensors */
    bool variational; /* hourglass force from an energy */
    bool touches;     /* has a neighbour in a body it is joined to */
    bool mixed;       /* joined to a body of another viscosity: pairs take the mean of both */
};

/* What the sweeps take of a particle: arrays of the solid's own, of float in mixed and double in double
 * precision. */
enum solid_packed_field {
    S_UX, /* displacement, m: in mixed precision its leading digits, */
    S_UY,
    S_LOW_X, /* and what they leave: differences of neighbours keep theirs. Mixed only */
    S_LOW_Y,
    S_VX, /* m/s */
    S_VY,
    S_UXX, /* displacement gradient, 1 */
    S_UXY,
    S_UYX,
    S_UYY,
    S_PXX, /* first Piola-Kirchhoff stress, with the share of a variational hourglass force, Pa */
    S_PXY,
    S_PYX,
    S_PYY,
    S_GX, /* sum of the gradient weights of its neighbours, 1/m */
    S_GY,
    S_PAIRS_X, /* acceleration by hourglass and viscous force, m/s^2; variational only */
    S_PAIRS_Y,
    S_DRAG, /* rho0 alpha_s c_s h of its body, Pa s; of joined bodies */
    SOLID_PACKED_FIELDS
};

/* One reference neighbour of each particle of a pack, a slot: of lane l the particle `offset` + i + l, with
 * weights that are zero where that lane has no such neighbour. A slot has of each weight as many as a pack
 * has lanes, one weight after the other. */
enum solid_weight {
    W_GX, /* G_ab = V_b L_a^-1 grad_0 W_0ab, 1/m: F_a = sum of x_ba G_ab */
    W_GY,
    W_HX, /* -G_ba, 1/m: the weight of P_b in the force on a */
    W_HY,
    W_X, /* X_ab, m */
    W_Y,
    W_HALF_K, /* kappa E_ab V_b W_0ab/(2 X_ab^2 rho0), 1/s^2 */
    SOLID_WEIGHTS
};

/* Particles i .. i + lanes - 1 of one body, which have their neighbours in common slots. Packs of equal
 * surroundings share their slots: on a lattice all of the interior needs one set. */
struct solid_pack {
    int32_t i, lanes, body;
    int32_t first_slot, n_slots;
};

struct solid;

/* Takes the packs from `first` to before `last`. */
typedef void solid_sweep(const struct solid *s, struct particles *p, int64_t first, int64_t last);

/* The sweeps of one precision. Bodies with the variational form have their pairs apart: the hourglass force
 * and the viscous force, and the stress, to which the first adds. */
struct solid_sweeps {
    const char *name;
    int lanes;            /* particles of a full pack */
    size_t size;          /* bytes of a number */
    solid_sweep *look;    /* takes displacement and velocity from p */
    solid_sweep *stress;  /* gradient, and stress but of variational bodies */
    solid_sweep *pairs;   /* forces of pairs and stress of variational bodies */
    solid_sweep *damping; /* adds the stress of Kelvin and Voigt */
    solid_sweep *forces;  /* acceleration by neighbours into sx, sy of p */
    solid_sweep *show;    /* gradient and stress into p */
    /* Energy of the hourglass force of each particle of a pack, J/m, [lanes]. */
    void (*hourglass)(const struct solid *s, const struct solid_pack *pack, double *energy);
};
extern const struct solid_sweeps solid_sweeps_mixed, solid_sweeps_double;

struct contact;
struct loads;
struct solid_part;

struct solid {
    int n_bodies;
    struct solid_body *body;
    double dp; /* the smallest spacing of any body */
    int64_t n_packs, n_slots;
    int threads; /* that its loops use */
    const struct solid_sweeps *sweeps;
    void *lane[SOLID_PACKED_FIELDS]; /* each [n] */
    struct solid_pack *pack;
    void *weight;                 /* [n_slots][SOLID_WEIGHTS][sweeps->lanes] */
    int64_t *offset;              /* [n_slots] */
    bool coupled;                 /* meets fluid */
    bool variational;             /* some body has its hourglass force from an energy */
    bool kelvin_voigt;            /* some body has a damping_time */
    double omega_max;             /* largest frequency of the linearised operator, 1/s */
    double damping_max;           /* largest rate of its viscous part, 1/s */
    double stable_step;           /* the largest stable step that follows from both, s */
    double paper_step;            /* Eq. 29, s */
    struct spin_barrier *barrier; /* of the threads between two loops */
    struct solid_part *part;      /* [threads], each stepped by a thread; NULL: not cut */
    bool in_parts;                /* the last evaluation was theirs */
    double *scratch[6];           /* room for the search of the step */
    double time; /* of the displacements, s: walls that are touched stand where they are then */
    /* What acts from outside, each NULL where there is none; contact: where none is near. */
    struct contact *contact;
    struct loads *loads;
    bool calls_out;              /* a motion may be the program's own, which its own thread calls */
    const struct scene *gravity; /* varies in time: what it is beyond its value at t = 0 */
    const double *push[2];       /* accelerations, x and y, m/s^2 */
    double
        impedance; /* rho0 c0 of the fluid at the interface, kg/(m^2 s); 0: there are no sub-steps */
    double work;   /* of walls, clamps and loads on the solid since it was last asked for, J/m */
    double *work_on; /* [n_bodies] the same of each; that of contact at the first */
};

/* Builds constants, reference neighbours and their weights for the particles p (X, Y, body, free are
 * set). */
enum err solid_create(struct solid *s, struct arena *a, const struct scene *scene,
                      struct particles *p, struct diag *d) SPHFSI_CHECKED;

/* Displacement gradient and first Piola-Kirchhoff stress of every particle (Eqs. 9-13b); with the variational
 * form, in which hourglass control has a part in the stress, the viscous and the hourglass force as well. */
void solid_stress(struct solid *s, struct particles *p);

/* Total acceleration (Eq. 21b) into sx, sy from what solid_stress has found for the same displacements and
 * velocities; zero where clamped. */
void solid_forces(const struct solid *s, struct particles *p);

/* n sub-steps of dt with the fluid's force and its impedance. Semi-implicit Euler (Eq. 27): kick, drift. With
 * `centred`: half drift, kick, half drift, which is second order in time. Gradients, stresses and
 * accelerations of p and the lanes are not those of the last sub-step before solid_show and solid_stress. */
void solid_advance(struct solid *s, struct particles *p, double dt, int n, bool centred);

/* Gradients, stresses and accelerations of the last evaluation into p. */
void solid_show(const struct solid *s, struct particles *p);

/* Books the work of what pushes from outside over a kick of dt with the last forces, from the velocities
 * before it. */
void solid_book_work(struct solid *s, const struct particles *p, const double *vx, const double *vy,
                     double dt);

/* Puts what is driven where it is at a time. */
void solid_place_clamps(const struct solid *s, struct particles *p, double time);

/* The largest stable step for the square of a frequency and a rate of damping, s. */
double solid_step_of(double omega2, double damping);

/* Largest frequency and damping rate of the operator linearised about the present deformation, by power
 * iteration on the force routine, and the stable step that follows, s. Leaves u, v and what is known of the
 * present state as they were. */
double solid_stable_step(struct solid *s, struct particles *p, double *omega, double *damping);

/* The same about the undeformed state, kept in s. */
void solid_find_step(struct solid *s, struct particles *p);

/* How much stiffer than undeformed the stiffest particle is to a wave along a principal axis, from
 * gradients that are up to date. 1 while no particle is stretched or compressed by some 5 %. */
double solid_stiffening(const struct solid *s, const struct particles *p);

/* Cauchy stress (xx, yy, xy, zz), Pa, and det F of a particle from its displacement gradient. */
void solid_cauchy(const struct solid *s, const struct particles *p, int64_t i, double sigma[4],
                  double *det);

/* Von Mises stress, Pa, of a Cauchy stress (xx, yy, xy, zz). */
double solid_von_mises(const double sigma[4]);

/* Strain energy and energy of the hourglass force of a body, or of all (SOLID_ALL), J/m; smallest
 * det F. From what solid_stress has found. */
enum { SOLID_ALL = -1 };
void solid_energy(const struct solid *s, const struct particles *p, int body, double *elastic,
                  double *hourglass, double *det_low);

#endif
