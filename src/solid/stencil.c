/* SPDX-License-Identifier: MIT
 * The solid's reference neighbours, which never change: packs of particles and their slots. */
#include <stdlib.h>

#include "base/cholesky.h"
#include "base/point_grid.h"
#include "particles/kernel.h"
#include "solid/solid.h"

/* Neighbours of one particle within 2h. */
enum { MAX_NEIGHBOURS = 96, MAX_LANES = LANES_FLOAT, MAX_SLOTS = MAX_NEIGHBOURS * MAX_LANES };

/* A slot under construction. */
struct draft {
    double weight[SOLID_WEIGHTS][MAX_LANES];
    int64_t offset;
};

/* X_a - X_b, rounded to 2^-30 dp: so equal surroundings are bitwise equal and share slots. */
static double reference_distance(double a, double b, double dp)
{
    const double unit = dp * 0x1p-30;
    return nearbyint((a - b) / unit) * unit;
}

/* Neighbours of i in its own body and those joined to it, ascending. -1: too many. */
static int neighbours_of(const struct solid *solid, const struct point_grid *g,
                         const struct particles *particles, int64_t i, int32_t *found)
{
    const struct solid_body *const own = &solid->body[particles->body[i]];
    const double reach = KERNEL_REACH * own->h, dp = own->dp;
    int n = 0;
    struct point_visit v = point_grid_visit(g, particles->X[i], particles->Y[i], 1.001 * reach);
    while (point_grid_next(g, &v)) {
        const int32_t j = (int32_t)v.k;
        if (j == i || solid->body[particles->body[j]].bond != own->bond) continue;
        const double dx = reference_distance(particles->X[i], particles->X[j], dp);
        const double dy = reference_distance(particles->Y[i], particles->Y[j], dp);
        if (dx * dx + dy * dy >= reach * reach) continue;
        if (n == MAX_NEIGHBOURS) return -1;
        int at = n++;
        for (; at > 0 && found[at - 1] > j; at--) found[at] = found[at - 1];
        found[at] = j;
    }
    return n;
}

/* The slot of a pack for neighbours at this offset; creates it if there is none. */
static struct draft *slot_for(struct draft *slots, int *n, int64_t offset)
{
    for (int k = 0; k < *n; k++)
        if (slots[k].offset == offset) return &slots[k];
    struct draft *const slot = &slots[(*n)++];
    memset(slot, 0, sizeof *slot);
    slot->offset = offset;
    for (int l = 0; l < MAX_LANES; l++) slot->weight[W_X][l] = ABSENT_NEIGHBOUR_X;
    return slot;
}

/* Computes the gradient at a particle from the fields of its neighbours. */
struct gradient_moments {
    double inverse[2][5]; /* rows d/dX and d/dY of the inverse moment matrix; linear: of L */
};

/* Monomials of the offset from a particle, in units of h. */
static void basis(double x, double y, double b[5])
{
    b[0] = x;
    b[1] = y;
    b[2] = 0.5 * x * x;
    b[3] = x * y;
    b[4] = 0.5 * y * y;
}

/* Solves M z = e_row for the first n rows; false where M is (nearly) singular. */
static bool solve_row(const double M[5][5], int n, int row, double z[5])
{
    double copy[5][5];
    memcpy(copy, M, sizeof copy);
    for (int i = 0; i < n; i++) z[i] = i == row;
    return cholesky_solve(&copy[0][0], n, 5, 1e-4, z) == n;
}

/* Moment matrix of a particle with the weight |grad W|/r. Its linear block is L of Eq. 13c: two
 * rows give the article's corrected gradient, all five one that is exact for quadratic fields
 * (moving least squares). If the neighbours cannot determine a quadratic field, as across two
 * particles, the gradient stays linear. false: not even linear. */
static bool find_moments(const struct solid *solid, const struct particles *particles, int64_t i,
                         const int32_t *found, int n, struct gradient_moments *m)
{
    const struct solid_body *const own = &solid->body[particles->body[i]];
    const double h = own->h, dp = own->dp;
    double M[5][5] = {{0}};
    for (int k = 0; k < n; k++) {
        const double x = reference_distance(particles->X[found[k]], particles->X[i], dp) / h;
        const double y = reference_distance(particles->Y[found[k]], particles->Y[i], dp) / h;
        const double weight = -square(h * dp) * kernel_slope(h * sqrt(x * x + y * y), h);
        double b[5];
        basis(x, y, b);
        for (int r = 0; r < 5; r++)
            for (int c = 0; c < 5; c++) M[r][c] += weight * b[r] * b[c];
    }
    if (own->gradient == GRADIENT_QUADRATIC && solve_row(M, 5, 0, m->inverse[0]) &&
        solve_row(M, 5, 1, m->inverse[1]))
        return true;
    memset(m, 0, sizeof *m);
    return solve_row(M, 2, 0, m->inverse[0]) && solve_row(M, 2, 1, m->inverse[1]);
}

/* G_ab: the weight of u_b - u_a in the gradient at a, for X_ab = (X, Y). */
static void gradient_weight(const struct solid_body *own, const struct gradient_moments *m,
                            double X, double Y, double G[2])
{
    const double h = own->h;
    double b[5];
    basis(-X / h, -Y / h, b);
    const double weight = -square(h * own->dp) * kernel_slope(sqrt(X * X + Y * Y), h) / h;
    for (int axis = 0; axis < 2; axis++) {
        G[axis] = 0;
        for (int k = 0; k < 5; k++) G[axis] += weight * m->inverse[axis][k] * b[k];
    }
}

/* k_ab over kappa Y V^2, 1/m^4: T-26 as printed, or T-26a, whose largest eigenvalue is lower. */
static double hourglass_weight(const struct solid_body *b, double R)
{
    return b->variational ? (1 - 0.5 * R / b->h) / (8 * square(square(b->h)))
                          : kernel_w(R, b->h) / square(R);
}

/* Fills one lane of a slot with the constants of the pair (i, j). */
static void slot_set(struct draft *slot, int lane, const struct solid *solid,
                     const struct particles *particles, const struct gradient_moments *moments,
                     int64_t i, int64_t j)
{
    const struct solid_body *const a = &solid->body[particles->body[i]],
                                   *const b = &solid->body[particles->body[j]];
    const double X = reference_distance(particles->X[i], particles->X[j], a->dp),
                 Y = reference_distance(particles->Y[i], particles->Y[j], a->dp);
    const double V = a->dp * a->dp, young = 0.5 * (a->young + b->young);
    double G[2], H[2];
    gradient_weight(a, &moments[i], X, Y, G);
    gradient_weight(b, &moments[j], -X, -Y, H);
    slot->weight[W_GX][lane] = G[0];
    slot->weight[W_GY][lane] = G[1];
    slot->weight[W_HX][lane] = -H[0];
    slot->weight[W_HY][lane] = -H[1];
    slot->weight[W_X][lane] = X;
    slot->weight[W_Y][lane] = Y;
    slot->weight[W_HALF_K][lane] =
        0.5 * a->kappa * young * V * hourglass_weight(a, sqrt(X * X + Y * Y)) / a->density;
}

static int compare_slot(const void *a, const void *b)
{
    const int64_t x = ((const struct draft *)a)->offset, y = ((const struct draft *)b)->offset;
    return (x > y) - (x < y);
}

/* The slots of one pack, in ascending order of neighbours; returns their number. */
static int pack_slots(const struct solid *solid, const struct particles *particles,
                      const struct point_grid *grid, const struct gradient_moments *moments,
                      const struct solid_pack *pack, struct draft *slots)
{
    int32_t found[MAX_NEIGHBOURS];
    int n = 0;
    for (int l = 0; l < pack->lanes; l++) {
        const int64_t i = pack->i + l;
        const int count = neighbours_of(solid, grid, particles, i, found);
        for (int k = 0; k < count; k++)
            slot_set(slot_for(slots, &n, found[k] - i), l, solid, particles, moments, i, found[k]);
    }
    qsort(slots, (size_t)n, sizeof *slots, compare_slot);
    return n;
}

/* Bytes of the weights of a slot. */
static size_t slot_bytes(const struct solid *solid)
{
    return SOLID_WEIGHTS * (size_t)solid->sweeps->lanes * solid->sweeps->size;
}

/* Moves the slots to memory for `capacity`. */
static enum err slots_move(struct solid *solid, struct arena *a, int64_t capacity, struct diag *d)
{
    const size_t n = (size_t)solid->n_slots, all = (size_t)capacity;
    int64_t *const offset = arena_alloc(a, all, sizeof *offset, "slots of the solid", d);
    void *const weight = arena_alloc(a, all, slot_bytes(solid), "slots of the solid", d);
    if (!offset || !weight) return ERR_MEMORY;
    if (n) memcpy(offset, solid->offset, n * sizeof *offset);
    if (n) memcpy(weight, solid->weight, n * slot_bytes(solid));
    solid->offset = offset;
    solid->weight = weight;
    return ERR_OK;
}

/* The sets that are stored already, by hash. */
struct slot_sets {
    int32_t *pack; /* [size] a pack with this set, -1: free */
    size_t size;   /* a power of two */
};

/* Finds a set equal to the n slots after those stored, or stores these. */
static void reuse_slots(struct solid *solid, const struct slot_sets *sets, int32_t pack_index,
                        int n)
{
    struct solid_pack *const pack = &solid->pack[pack_index];
    const char *const all = solid->weight;
    const int64_t *const offset = &solid->offset[solid->n_slots];
    const char *const weight = &all[(size_t)solid->n_slots * slot_bytes(solid)];
    const size_t offsets = (size_t)n * sizeof *offset, weights = (size_t)n * slot_bytes(solid);
    pack->n_slots = n;
    size_t k = hash_bytes(hash_bytes(HASH_START, offset, offsets), weight, weights);
    for (k &= sets->size - 1; sets->pack[k] >= 0; k = (k + 1) & (sets->size - 1)) {
        const struct solid_pack *const other = &solid->pack[sets->pack[k]];
        const size_t first = (size_t)other->first_slot;
        if (other->body == pack->body && other->n_slots == n &&
            memcmp(&solid->offset[first], offset, offsets) == 0 &&
            memcmp(&all[first * slot_bytes(solid)], weight, weights) == 0) {
            pack->first_slot = other->first_slot;
            return;
        }
    }
    sets->pack[k] = pack_index;
    pack->first_slot = (int32_t)solid->n_slots;
    solid->n_slots += n;
}

static void cut_packs(struct solid *solid, const struct particles *particles)
{
    for (int64_t i = 0; i < particles->n;) {
        struct solid_pack *const pack = &solid->pack[solid->n_packs++];
        *pack = (struct solid_pack){.i = (int32_t)i, .body = particles->body[i]};
        while (pack->lanes < solid->sweeps->lanes && i < particles->n &&
               particles->body[i] == pack->body) {
            pack->lanes++;
            i++;
        }
    }
}

static enum err store_slots(struct solid *solid, struct arena *a, struct arena *scratch,
                            const struct particles *particles, const struct point_grid *grid,
                            const struct gradient_moments *moments, struct diag *d)
{
    struct slot_sets sets = {.size = 1};
    while (sets.size < 2 * (size_t)solid->n_packs) sets.size *= 2;
    TRY(arena_array(scratch, &sets.pack, sets.size, "slots of the solid", d));
    struct draft *drafts;
    TRY(arena_array(scratch, &drafts, MAX_SLOTS, "slots of the solid", d));
    memset(sets.pack, 0xff, sets.size * sizeof *sets.pack);
    const int lanes = solid->sweeps->lanes;
    int64_t capacity = 0;
    for (int64_t k = 0; k < solid->n_packs; k++) {
        const int n = pack_slots(solid, particles, grid, moments, &solid->pack[k], drafts);
        if (solid->n_slots + n > capacity) {
            capacity = 2 * (solid->n_slots + n);
            TRY(slots_move(solid, scratch, capacity, d));
        }
        for (int m = 0; m < n; m++) {
            const int64_t slot = solid->n_slots + m;
            solid->offset[slot] = drafts[m].offset;
            for (int w = 0; w < SOLID_WEIGHTS; w++)
                for (int l = 0; l < lanes; l++)
                    solid_set(solid, solid->weight, (slot * SOLID_WEIGHTS + w) * lanes + l,
                              drafts[m].weight[w][l]);
        }
        reuse_slots(solid, &sets, (int32_t)k, n);
    }
    return slots_move(solid, a, solid->n_slots, d);
}

/* Moments of every particle; also checks the number of neighbours. */
static enum err all_moments(const struct solid *solid, const struct point_grid *g,
                            const struct particles *particles, struct gradient_moments *moments,
                            struct diag *d)
{
    int32_t found[MAX_NEIGHBOURS];
    for (int64_t i = 0; i < particles->n; i++) {
        const int n = neighbours_of(solid, g, particles, i, found);
        if (n < 0)
            return diag_fail(
                d, ERR_INPUT,
                "the solid particle at (%.6g, %.6g) m has more than %d neighbours within 2h; "
                "use a smaller h_over_dp; bodies that overlap also cause this",
                particles->X[i], particles->Y[i], MAX_NEIGHBOURS);
        if (!find_moments(solid, particles, i, found, n, &moments[i]))
            return diag_fail(
                d, ERR_INPUT,
                "the solid particle at (%.6g, %.6g) m has too few neighbours to determine a "
                "deformation gradient; a body needs at least 2 particles across",
                particles->X[i], particles->Y[i]);
    }
    return ERR_OK;
}

/* Sums of the gradient weights over the neighbours, constant in time. */
static void sum_weights(const struct solid *solid)
{
    const int lanes = solid->sweeps->lanes;
    for (int64_t k = 0; k < solid->n_packs; k++) {
        const struct solid_pack *const pack = &solid->pack[k];
        for (int l = 0; l < pack->lanes; l++) {
            double Gx = 0, Gy = 0;
            for (int64_t m = pack->first_slot; m < pack->first_slot + pack->n_slots; m++) {
                Gx += solid_get(solid, solid->weight, (m * SOLID_WEIGHTS + W_GX) * lanes + l);
                Gy += solid_get(solid, solid->weight, (m * SOLID_WEIGHTS + W_GY) * lanes + l);
            }
            solid_set(solid, solid->packed[S_GX], pack->i + l, Gx);
            solid_set(solid, solid->packed[S_GY], pack->i + l, Gy);
        }
    }
}

enum err solid_stencil_create(struct solid *solid, struct arena *a,
                              const struct particles *particles, struct diag *d)
{
    TRY(arena_array(a, &solid->pack, particles->n, "packs of the solid", d));
    cut_packs(solid, particles);
    struct arena scratch = {.limit = a->limit};
    struct point_grid grid;
    double reach = 0;
    for (int k = 0; k < solid->n_bodies; k++) reach = max2(reach, KERNEL_REACH * solid->body[k].h);
    struct gradient_moments *const moments =
        arena_alloc(&scratch, (size_t)particles->n, sizeof *moments,
                    "gradient weights of the solid", d);
    enum err e = moments ? point_grid_create(&grid, reach, particles->n, particles->X, particles->Y,
                                             &scratch, d)
                         : ERR_MEMORY;
    for (int64_t i = 0; !e && i < particles->n; i++) point_grid_insert(&grid, i);
    if (!e) e = all_moments(solid, &grid, particles, moments, d);
    if (!e) e = store_slots(solid, a, &scratch, particles, &grid, moments, d);
    arena_free(&scratch);
    if (!e) sum_weights(solid);
    return e;
}
