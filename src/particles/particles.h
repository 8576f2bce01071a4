/* SPDX-License-Identifier: MIT
 * Particles as flat arrays (SoA), declared from particles/fields.def; one set of arrays for each
 * kind. */
#pragma once

#include "base/base.h"

/* Field groups, the unit of allocation, and the particles that have them. */
enum group {
    G_POINT = 1 << 0,          /* every particle */
    G_DENSITY = 1 << 1,        /* fluid; walls and structures in contact with fluid */
    G_RATE = 1 << 2,           /* fluid, moving walls, structures */
    G_FLUID = 1 << 3,          /* fluid */
    G_START = 1 << 4,          /* start of a step: solids; fluid of the predictor-corrector */
    G_START_FLUID = 1 << 5,    /* predictor-corrector: fluid */
    G_VERLET = 1 << 6,         /* Verlet: fluid */
    G_LEAPFROG = 1 << 7,       /* leapfrog: fluid */
    G_REFERENCE = 1 << 8,      /* solid, moving walls */
    G_SOLID = 1 << 9,          /* solid */
    G_FRICTION = 1 << 10,      /* solids that rub against each other or walls */
    G_MATRIX = 1 << 11,        /* solids with implicit steps */
    G_COUPLED = 1 << 12,       /* structures in contact with fluid */
    G_MEAN_FORCE = 1 << 13,    /* Verlet, leapfrog: structures in contact with fluid */
    G_SPLIT_IMPULSE = 1 << 14, /* Verlet: structures in contact with fluid, in sub-steps */
    G_WETTED = 1 << 15,        /* structures in sub-steps, rigid bodies and beams in fluid */
    G_FORCE = 1 << 16,         /* structures, and walls that move or are probed, in fluid */
    G_SHIFT = 1 << 17,         /* fluid with particle shifting */
    G_DAMPER = 1 << 18,        /* fluid with an acoustic damper */
    G_MASS = 1 << 19,          /* fluid with particles of different masses */
    G_OPEN = 1 << 20,          /* fluid that enters or leaves through open boundaries */
    G_SLOPE = 1 << 21,         /* fluid whose diffusion needs the density gradient */
};

enum keep { KEEP_STATE, KEEP_DERIVED };

/* The kinds of particles; each kind is a struct particles of its own. */
enum kind { KIND_FLUID, KIND_WALL, KIND_SOLID, KIND_COUNT };
extern const char *const kind_names[KIND_COUNT];

/* The particles of a kind. A pointer is NULL while its group is off. The arena owns all. */
struct particles {
    int64_t n;        /* particles now */
    int64_t capacity; /* items of each array; vector loads may cross its end (ARENA_MARGIN) */
    unsigned groups;
#define FIELD(type, name, group, keep, unit, meaning) type *name;
#include "particles/fields.def"
#undef FIELD
};

/* One row of particles/fields.def as data. */
struct field_info {
    const char *name, *type, *unit, *meaning;
    size_t size;   /* bytes of one item */
    size_t offset; /* of the pointer in struct particles */
    unsigned group;
    enum keep keep;
};
extern const struct field_info field_table[];
extern const int field_count;

/* Accelerations from outside, added to those of the model by a program that uses the library. */
typedef void force_hook_function(void *context, double time, const struct particles *particles,
                                 double *ax, double *ay);
struct force_hook {
    force_hook_function *accelerate; /* NULL: none */
    void *context;
    double *ax, *ay; /* m/s^2 */
};

/* The array of a field, or NULL while its group is off. */
void *field_array(const struct particles *particles, const struct field_info *f);

/* Allocates the arrays of the named groups for `capacity` particles. */
enum err particles_create(struct particles *particles, struct arena *a, int64_t capacity,
                          unsigned groups, const char *what, struct diag *d) SPHFSI_CHECKED;

/* The arrays of further groups, zero. */
enum err particles_add(struct particles *particles, struct arena *a, unsigned groups,
                       const char *what, struct diag *d) SPHFSI_CHECKED;

/* Reorders every active field: new[k] = old[order[k]] for k < n. `scratch` holds n * 8 bytes. */
void particles_permute(struct particles *particles, const int32_t *order, int64_t n, void *scratch);

/* Copies every active STATE field of one particle. */
void particles_copy(struct particles *particles, int64_t from, int64_t to);

/* Hash of every STATE field, in array order, continued from `seed` (base/hash.h). */
uint64_t particles_hash(const struct particles *particles, uint64_t seed);

/* Bytes of all arrays of p. */
size_t particles_bytes(const struct particles *particles);

/* Sets a field of n particles to zero; NULL: there is none. */
SPHFSI_INLINE void particles_clear(double *field, int64_t n)
{
    for (int64_t i = 0; field && i < n; i++) field[i] = 0;
}
