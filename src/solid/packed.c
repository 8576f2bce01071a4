/* SPDX-License-Identifier: MIT */
#include "solid/packed.h"

/* Whether the scene needs a packed field. */
static bool lane_needed(const struct solid *s, int lane)
{
    bool mixed = false;
    for (int k = 0; k < s->n_bodies; k++) mixed |= s->body[k].mixed;
    switch (lane) {
    case S_PAIRS_X:
    case S_PAIRS_Y: return s->variational;
    case S_DRAG: return mixed;
    case S_LOW_X:
    case S_LOW_Y: return s->sweeps->size < sizeof(double);
    default: return true;
    }
}

enum err solid_packed_create(struct solid *s, struct arena *a, const struct particles *p,
                             struct diag *d)
{
    double *const field[SOLID_PACKED_FIELDS] = {
        [S_UX] = p->ux,   [S_UY] = p->uy,   [S_VX] = p->vx,   [S_VY] = p->vy,
        [S_UXX] = p->Uxx, [S_UXY] = p->Uxy, [S_UYX] = p->Uyx, [S_UYY] = p->Uyy,
        [S_PXX] = p->Pxx, [S_PXY] = p->Pxy, [S_PYX] = p->Pyx, [S_PYY] = p->Pyy,
    };
    for (int k = 0; k < SOLID_PACKED_FIELDS; k++) {
        if (!lane_needed(s, k)) continue;
        s->lane[k] = field[k];
        if (field[k] && s->sweeps->size == sizeof(double)) continue;
        s->lane[k] = arena_alloc(a, (size_t)p->n, s->sweeps->size, "packed fields of the solid", d);
        if (!s->lane[k]) return ERR_MEMORY;
    }
    for (int64_t i = 0; s->lane[S_DRAG] && i < p->n; i++) {
        const struct solid_body *const b = &s->body[p->body[i]];
        solid_set(s, s->lane[S_DRAG], i, b->density * b->viscosity);
    }
    return ERR_OK;
}
