/* SPDX-License-Identifier: MIT */
#include "solid/packed.h"

/* Whether the scene needs a packed field. */
static bool lane_needed(const struct solid *solid, int lane)
{
    bool mixed = false;
    for (int k = 0; k < solid->n_bodies; k++) mixed |= solid->body[k].mixed;
    switch (lane) {
    case S_PAIRS_X:
    case S_PAIRS_Y: return solid->variational;
    case S_DRAG: return mixed;
    case S_LOW_X:
    case S_LOW_Y: return solid->sweeps->size < sizeof(double);
    default: return true;
    }
}

enum err solid_packed_create(struct solid *solid, struct arena *a,
                             const struct particles *particles, struct diag *d)
{
    double *const field[SOLID_PACKED_FIELDS] = {
        [S_UX] = particles->ux,   [S_UY] = particles->uy,   [S_VX] = particles->vx,
        [S_VY] = particles->vy,   [S_UXX] = particles->Uxx, [S_UXY] = particles->Uxy,
        [S_UYX] = particles->Uyx, [S_UYY] = particles->Uyy, [S_PXX] = particles->Pxx,
        [S_PXY] = particles->Pxy, [S_PYX] = particles->Pyx, [S_PYY] = particles->Pyy,
    };
    for (int k = 0; k < SOLID_PACKED_FIELDS; k++) {
        if (!lane_needed(solid, k)) continue;
        solid->lane[k] = field[k];
        if (field[k] && solid->sweeps->size == sizeof(double)) continue;
        solid->lane[k] = arena_alloc(a, (size_t)particles->n, solid->sweeps->size,
                                     "packed fields of the solid", d);
        if (!solid->lane[k]) return ERR_MEMORY;
    }
    for (int64_t i = 0; solid->lane[S_DRAG] && i < particles->n; i++) {
        const struct solid_body *const b = &solid->body[particles->body[i]];
        solid_set(solid, solid->lane[S_DRAG], i, b->density * b->viscosity);
    }
    return ERR_OK;
}
