/* SPDX-License-Identifier: MIT
 * Allocates, permutes and hashes all fields of a kind. */
#include "particles/particles.h"
#include "base/hash.h"

const char *const kind_names[KIND_COUNT] = {"fluid", "wall", "solid"};

const struct field_info field_table[] = {
#define FIELD(type, name, group, keep, unit, meaning)                                      \
    {#name,     #type,      unit, meaning, sizeof(type), offsetof(struct particles, name), \
     G_##group, KEEP_##keep},
#include "particles/fields.def"
#undef FIELD
};
const int field_count = COUNT_OF(field_table);

void *field_array(const struct particles *particles, const struct field_info *f)
{
    return *(void *const *)(const void *)((const unsigned char *)particles + f->offset);
}

enum err particles_create(struct particles *particles, struct arena *a, int64_t capacity,
                          unsigned groups, const char *what, struct diag *d)
{
    memset(particles, 0, sizeof *particles);
    particles->capacity = capacity;
    return particles_add(particles, a, groups, what, d);
}

enum err particles_add(struct particles *particles, struct arena *a, unsigned groups,
                       const char *what, struct diag *d)
{
    particles->groups |= groups;
    for (int k = 0; k < field_count; k++) {
        const struct field_info *f = &field_table[k];
        if (!(f->group & groups)) continue;
        void *memory = arena_alloc(a, (size_t)particles->capacity, f->size, what, d);
        if (!memory) return ERR_MEMORY;
        ASSERT((uintptr_t)memory % ARENA_ALIGN == 0);
        memcpy((unsigned char *)particles + f->offset, &memory, sizeof memory);
    }
    return ERR_OK;
}

/* Bits of any 8- or 4-byte field, whatever its declared type. */
typedef uint64_t bits64 __attribute__((may_alias));
typedef uint32_t bits32 __attribute__((may_alias));

static void permute(void *values, bool wide, const int32_t *order, int64_t n, void *scratch)
{
    bits64 *const to_8 = scratch, *const at_8 = values;
    bits32 *const to_4 = scratch, *const at_4 = values;
#pragma omp parallel for schedule(static)
    for (int64_t k = 0; k < n; k++)
        if (wide)
            to_8[k] = at_8[order[k]];
        else
            to_4[k] = at_4[order[k]];
#pragma omp parallel for schedule(static)
    for (int64_t k = 0; k < n; k++)
        if (wide)
            at_8[k] = to_8[k];
        else
            at_4[k] = to_4[k];
}

void particles_permute(struct particles *particles, const int32_t *order, int64_t n, void *scratch)
{
    ASSERT(n <= particles->n && particles->n <= particles->capacity);
    for (int64_t k = 0; k < n; k++) ASSERT(order[k] >= 0 && order[k] < n);
    for (int k = 0; k < field_count; k++) {
        void *values = field_array(particles, &field_table[k]);
        if (!values || field_table[k].keep != KEEP_STATE) continue;
        permute(values, field_table[k].size == 8, order, n, scratch);
    }
}

void particles_copy(struct particles *particles, int64_t from, int64_t to)
{
    for (int k = 0; k < field_count; k++) {
        unsigned char *const values = field_array(particles, &field_table[k]);
        const size_t size = field_table[k].size;
        if (!values || field_table[k].keep != KEEP_STATE) continue;
        memcpy(values + (size_t)to * size, values + (size_t)from * size, size);
    }
}

uint64_t particles_hash(const struct particles *particles, uint64_t seed)
{
    uint64_t h = seed;
    for (int k = 0; k < field_count; k++) {
        const void *values = field_array(particles, &field_table[k]);
        if (values && field_table[k].keep == KEEP_STATE)
            h = hash_bytes(h, values, (size_t)particles->n * field_table[k].size);
    }
    return h;
}

size_t particles_bytes(const struct particles *particles)
{
    size_t bytes = 0;
    for (int k = 0; k < field_count; k++)
        if (field_array(particles, &field_table[k]))
            bytes += (size_t)particles->capacity * field_table[k].size;
    return bytes;
}
