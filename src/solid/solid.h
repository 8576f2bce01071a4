/* SPDX-License-Identifier: MIT
 * Total-Lagrangian elastic solid: reference neighbours as packs, deformation gradient, stress,
 * forces. */
#pragma once

#include "solid/types.h"

/* The name of a body that can turn freely, or has less artificial viscosity than SOLID_DAMPED, so
 * that float is not sufficient for it; NULL: none. */
#define SOLID_DAMPED 0.01
const char *solid_needs_double(const struct solid *solid, const struct scene *scene,
                               const struct particles *particles);

/* Builds constants, reference neighbours and their weights for the particles p (X, Y, body, free
 * are set). implicit: for implicit steps, in double precision. */
enum err solid_create(struct solid *solid, struct arena *a, const struct scene *scene,
                      struct particles *particles, bool implicit, struct diag *d) SPHFSI_CHECKED;

/* Cuts the particles into packs, finds their reference neighbours within 2h in the same body and
 * the weights of the gradient, and sums these (S_GX, S_GY). Bodies, sweeps and packed fields are
 * set. */
enum err solid_stencil_create(struct solid *solid, struct arena *a,
                              const struct particles *particles, struct diag *d) SPHFSI_CHECKED;

/* Displacement gradient and first Piola-Kirchhoff stress of every particle (Eqs. 9-13b). In the
 * variational form hourglass control adds to the stress; then also the viscous and the hourglass
 * force. */
void solid_stress(struct solid *solid, struct particles *particles);

/* Total acceleration (Eq. 21b) to sx, sy, from the results of solid_stress for the same
 * displacements and velocities; zero where clamped. */
void solid_forces(const struct solid *solid, struct particles *particles);

/* The displacement gradients alone, to p; in double precision. */
void solid_gradient(const struct solid *solid, struct particles *particles);

/* Both for the present displacements and velocities of p, with actions from outside at a time. */
void solid_forces_within(const struct solid *solid, struct particles *particles, double time);

/* The acceleration by the forces between particles alone to sx, sy; zero where clamped. Of the
 * other results only the packed fields are updated. displaced: not only velocities have changed
 * since the last call. */
void solid_operator(struct solid *solid, struct particles *particles, bool displaced);

/* Accelerations now, m/s^2, and forces of clamps and hinges, N/m (0 where none acts), from
 * what solid_stress has found. They stay in the scratch of s until that is used again; p is as
 * it was. */
struct solid_forces_now {
    const double *ax, *ay, *held_x, *held_y;
};
struct solid_forces_now solid_forces_now(struct solid *solid, struct particles *particles,
                                         double time);

/* n sub-steps of dt with the fluid's force. Semi-implicit Euler (Eq. 27): kick,
 * drift. With `centred`: half drift, kick, half drift, second order in time. Gradients, stresses,
 * accelerations and packed fields are those of the last sub-step only after solid_show and
 * solid_stress. */
void solid_advance(struct solid *solid, struct particles *particles, double dt, int n,
                   bool centred);

/* Kick and drift where no fluid resists them. */
solid_kick solid_free_kick;

/* x = X + u; returns the largest displacement by it, m. */
double solid_set_positions(struct particles *particles);

/* Gradients, stresses and accelerations of the last evaluation to p. */
void solid_show(const struct solid *solid, struct particles *particles);

/* Adds up the work of actions from outside over a kick of dt with the last forces, from the
 * velocities before it. Friction slides by these forces. */
void solid_book_work(struct solid *solid, struct particles *particles, const double *vx,
                     const double *vy, double dt);

/* Sets particles with prescribed motion to their positions at a time. */
void solid_place_clamps(const struct solid *solid, struct particles *particles, double time);

/* The largest stable step for the square of a frequency and a rate of damping, s. */
double solid_step_of(double omega2, double damping);

/* Largest frequency and damping rate of the operator linearised about the present deformation, by
 * power iteration on the force routine; and the stable step, s. Restores u, v and all data of the
 * present state. */
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

/* Strain energy and hourglass energy of a body, or of all (SOLID_ALL), J/m; smallest det F. From
 * the results of solid_stress. */
enum { SOLID_ALL = -1 };
void solid_energy(const struct solid *solid, const struct particles *particles, int body,
                  double *elastic, double *hourglass, double *det_low);
