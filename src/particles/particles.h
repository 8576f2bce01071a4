/* SPDX-License-Identifier: MIT
 * Particles as flat arrays (SoA), declared from particles/fields.def; one set of arrays for each
 * kind. */
#ifndef SPHFSI_PARTICLES_PARTICLES_H
#define SPHFSI_PARTICLES_PARTICLES_H

#include "base/base.h"

/* Field groups: the unit of allocation, particles/groups.def. */
enum group_number {
#define GROUP(name, meaning) GROUP_##name,
#include "particles/groups.def"
#undef GROUP
    GROUP_COUNT
};
enum group {
#define GROUP(name, meaning) G_##name = 1 << GROUP_##name,
#include "particles/groups.def"
#undef GROUP
};

enum keep { KEEP_STATE, KEEP_DERIVED };

/* The kinds of particles; each kind is a struct particles of its own. */
enum kind { KIND_FLUID, KIND_WALL, KIND_SOLID, KIND_COUNT };
extern const char *const kind_names[KIND_COUNT];

/* The particles of one kind. A pointer is NULL while its group is off. The arena owns the
 * memory. */
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

#endif
