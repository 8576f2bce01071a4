/* SPDX-License-Identifier: MIT
 * The impedance of the fluid at a structure within the structure's sub-steps, and the impulse
 * that it exchanges (T-35a to T-35e). */
#pragma once

#include "coupling/coupling.h"

/* Before sub-steps of dt, 0: an implicit step of any length: the wetted normals. Afterwards: the
 * impulse of the sub-steps, and the pressure that gives it to the fluid. */
void impulse_begin(struct coupling *coupling, double dt);
void impulse_end(struct coupling *coupling);

/* A kick and drift of sub-steps with T-35a. */
solid_kick impedance_kick;

/* T-35b: after an evaluation whose rates act for `kick`. */
void impulse_return(struct coupling *coupling, double kick);

/* T-35e: the exchange time follows the steps, here one of dt. */
void impulse_set_time(struct coupling *coupling, double dt);

/* Particle i and the fluid have no impulse to exchange. */
void impulse_clear(struct particles *particles, int64_t i);
