/* SPDX-License-Identifier: MIT
 * Contact of solids with each other, with walls and with themselves: a surface particle and the
 * line through the surface particles opposite repel each other (docs/theory.md, Contact). */
#ifndef SPHFSI_SOLID_CONTACT_H
#define SPHFSI_SOLID_CONTACT_H

#include "solid/types.h"

/* Laws and surfaces of solids and walls. */
enum err contact_create(struct contact *contact, struct arena *a, const struct scene *scene,
                        const struct solid *solid, const struct particles *particles,
                        struct diag *d) SPHFSI_CHECKED;

/* Examines the state before a step of at most `longest`: whether surfaces may touch within the time
 * `span`, what contact adds to the solid's eigenvalues, and the longest step in which nothing
 * passes. The results do not depend on earlier calls. By one thread; returns `near`. */
bool contact_watch(struct contact *contact, const struct particles *particles, double time,
                   double longest, double span);

/* The state has been replaced, and walls at rest may be elsewhere: discards all that is known of
 * it. */
void contact_forget(struct contact *contact, const struct particles *walls);

/* Adds the accelerations of contact to sx, sy, with walls at their positions at `time`. Inside a
 * parallel region all threads call it together. */
void contact_forces(struct contact *contact, struct particles *particles, double time);

/* Energy of contact, J/m, with walls at their positions at `time`. */
double contact_energy(struct contact *contact, const struct particles *particles, double time);

/* "[solid a]" or "[wall b]" of a body, walls after solids. */
enum { CONTACT_NAME = 160 };
void contact_name(const struct contact *contact, int body, char text[CONTACT_NAME]);

#endif
