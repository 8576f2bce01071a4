/* SPDX-License-Identifier: MIT
 * What the fluid answers to a structure within the structure's sub-steps (T-35a, T-35b). */
#ifndef SPHFSI_INTERFACE_H
#define SPHFSI_INTERFACE_H

#include "solid.h"

/* Both for use inside a parallel region: each ends with all threads together. */

/* After the kick of a sub-step of dt. */
void interface_answer(const struct solid *s, struct particles *p, double dt);

/* Before the sub-steps of a step of dt: the structure returns a share of what it was given. */
void interface_return(struct particles *p, double dt);

#endif
