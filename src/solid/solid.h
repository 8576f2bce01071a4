/* SPDX-License-Identifier: MIT
 * Total-Lagrangian elastic solid: reference neighbours as packs, deformation gradient, stress, forces. */
#ifndef SPHFSI_SOLID_SOLID_H
#define SPHFSI_SOLID_SOLID_H

#include "solid/types.h"

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

/* Accelerations now, m/s^2, and forces of clamps on their particles, N/m (0 on all others), from what
 * solid_stress has found. They stay in the scratch of s until that is used again; p is as it was. */
struct solid_forces_now {
    const double *ax, *ay, *clamp_x, *clamp_y;
};
struct solid_forces_now solid_forces_now(struct solid *s, struct particles *p, double time);

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
