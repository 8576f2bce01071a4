/* SPDX-License-Identifier: MIT
 * What the matrix of implicit steps needs and never changes: links between particles, the
 * numbering of the unknowns, and the springs of hourglass control. */
#include "base/box2.h"
#include "implicit/implicit.h"
#include "solid/loads.h"

static const char what[] = "matrix of the solid";

/* One weight of a pair: of slot m and lane l of its pack. */
static double weight(const struct solid *solid, int64_t m, int number, int l)
{
    return solid_get(solid, solid->weight, (m * SOLID_WEIGHTS + number) * solid->sweeps->lanes + l);
}

/* Neighbours of each particle with the weights of its gradient, and itself with the opposite of
 * their sum. The last particle of a pack has as many places as the others. */
static enum err link_particles(const struct solid *solid, struct implicit_links *links,
                               struct arena *a, int64_t n, struct diag *d)
{
    int64_t most = n, at = 0;
    for (int64_t k = 0; k < solid->n_packs; k++)
        most += (int64_t)solid->pack[k].n_slots * solid->pack[k].lanes;
    TRY(arena_array(a, &links->first, (size_t)n + 1, what, d));
    TRY(arena_array(a, &links->node, most, what, d));
    TRY(arena_array(a, &links->gx, most, what, d));
    TRY(arena_array(a, &links->gy, most, what, d));
    for (int64_t k = 0; k < solid->n_packs; k++) {
        const struct solid_pack *const pack = &solid->pack[k];
        for (int l = 0; l < pack->lanes; l++) {
            const int64_t i = pack->i + l, own = at++;
            links->first[i] = own;
            links->node[own] = (int32_t)i;
            for (int64_t m = pack->first_slot; m < pack->first_slot + pack->n_slots; m++) {
                const double gx = weight(solid, m, W_GX, l), gy = weight(solid, m, W_GY, l);
                if (weight(solid, m, W_X, l) == ABSENT_NEIGHBOUR_X) continue;
                links->node[at] = (int32_t)(i + solid->offset[m]);
                links->gx[at] = gx;
                links->gy[at] = gy;
                links->gx[own] -= gx;
                links->gy[own] -= gy;
                at++;
            }
        }
    }
    links->first[n] = at;
    return ERR_OK;
}

/* Visits all particles in order of their distance from `from`, in steps between neighbours on the
 * lattice; returns how many these are. `seen` is larger than `round` where it was not visited. */
static int64_t visit(const struct solid *solid, const struct implicit_links *links,
                     const struct particles *particles, int64_t from, int32_t *seen, int32_t round,
                     int32_t *queue)
{
    int64_t n = 0;
    queue[n++] = (int32_t)from;
    seen[from] = round;
    for (int64_t k = 0; k < n; k++) {
        const int32_t i = queue[k];
        const double reach = 1.5 * solid->body[particles->body[i]].dp;
        for (int64_t m = links->first[i]; m < links->first[i + 1]; m++) {
            const int32_t j = links->node[m];
            const double r2 = square(particles->X[i] - particles->X[j]) +
                              square(particles->Y[i] - particles->Y[j]);
            if (seen[j] >= round || r2 > square(reach)) continue;
            seen[j] = round;
            queue[n++] = j;
        }
    }
    return n;
}

/* Along each body from one of its ends, so that the matrix has few columns beside its diagonal. */
static void number_unknowns(const struct solid *solid, struct implicit *implicit,
                            const struct particles *particles, const double *moves, int32_t *seen,
                            int32_t *queue)
{
    for (int64_t i = 0; i < particles->n; i++) seen[i] = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        if (seen[i]) continue;
        const int64_t n = visit(solid, &implicit->links, particles, i, seen, 1, queue);
        visit(solid, &implicit->links, particles, queue[n - 1], seen, 2, queue);
        const int64_t before = implicit->n;
        for (int64_t k = 0; k < n; k++)
            implicit->order[queue[k]] = moves[queue[k]] > 0 ? (int32_t)implicit->n++ : -1;
        implicit->n_free += implicit->n == before + n;
    }
}

/* The first unknown that the force on each depends on: in three steps, since the springs of two
 * neighbours depend on the neighbours of both (T-26). */
static void find_first(const struct implicit *implicit, int64_t n, int64_t *first, int64_t *next)
{
    const struct implicit_links *const links = &implicit->links;
    for (int64_t i = 0; i < n; i++)
        first[i] = implicit->order[i] < 0 ? INT64_MAX : implicit->order[i];
    for (int round = 0; round < 3; round++) {
        for (int64_t i = 0; i < n; i++) {
            next[i] = INT64_MAX;
            for (int64_t m = links->first[i]; m < links->first[i + 1]; m++)
                if (first[links->node[m]] < next[i]) next[i] = first[links->node[m]];
        }
        memcpy(first, next, (size_t)n * sizeof *first);
    }
    for (int64_t i = 0; i < n; i++)
        if (implicit->order[i] >= 0) next[implicit->order[i]] = first[i];
}

/* The error of T-26 of one pair as a sum over particles, `share` of each; 0 outside `node`. */
struct spring {
    double *share;
    int32_t *node;
    int n;
};

static void add_share(struct spring *spring, int32_t node, double share)
{
    int k = 0;
    while (k < spring->n && spring->node[k] != node) k++;
    if (k == spring->n) {
        spring->node[spring->n++] = node;
        spring->share[k] = 0;
    }
    spring->share[k] += share;
}

static void add_spring(struct implicit *implicit, const struct spring *spring, double stiffness)
{
    for (int m = 0; m < spring->n; m++) {
        const int64_t row = implicit->order[spring->node[m]];
        if (row < 0) continue;
        for (int k = 0; k < spring->n; k++) {
            const int64_t column = implicit->order[spring->node[k]];
            if (column >= 0 && column <= row)
                envelope_add(&implicit->springs, row, column,
                             stiffness * spring->share[m] * spring->share[k]);
        }
    }
}

/* T-28: k e e^T/2 of each pair, with e = (F_a + F_b) X_ab/2 - x_ab. */
static void add_springs(const struct solid *solid, struct implicit *implicit, const int32_t *body,
                        struct spring *spring)
{
    const struct implicit_links *const links = &implicit->links;
    for (int64_t k = 0; k < solid->n_packs; k++) {
        const struct solid_pack *const pack = &solid->pack[k];
        for (int64_t m = pack->first_slot; m < pack->first_slot + pack->n_slots; m++)
            for (int l = 0; l < pack->lanes; l++) {
                const int64_t i = pack->i + l, j = i + solid->offset[m];
                const double half_k = weight(solid, m, W_HALF_K, l), X = weight(solid, m, W_X, l),
                             Y = weight(solid, m, W_Y, l);
                if (!(half_k > 0) || j < i) continue;
                const int64_t ends[] = {i, j};
                spring->n = 0;
                for (int e = 0; e < 2; e++)
                    for (int64_t at = links->first[ends[e]]; at < links->first[ends[e] + 1]; at++)
                        add_share(spring, links->node[at],
                                  0.5 * (links->gx[at] * X + links->gy[at] * Y));
                add_share(spring, (int32_t)i, -1);
                add_share(spring, (int32_t)j, 1);
                add_spring(implicit, spring, 2 * half_k * solid->body[body[i]].mass);
            }
    }
}

static enum err create_matrices(const struct solid *solid, struct implicit *implicit,
                                struct arena *a, const struct particles *particles,
                                const double *moves, struct arena *scratch, struct diag *d)
{
    const size_t n = (size_t)particles->n;
    int32_t *const seen = arena_alloc(scratch, n, sizeof *seen, what, d),
                   *const queue = arena_alloc(scratch, n, sizeof *queue, what, d);
    int64_t *const first = arena_alloc(scratch, 2 * n, sizeof *first, what, d),
                   *const next = arena_alloc(scratch, n, sizeof *next, what, d);
    struct spring spring = {.share = arena_alloc(scratch, n, sizeof *spring.share, what, d),
                            .node = arena_alloc(scratch, n, sizeof *spring.node, what, d)};
    if (!seen || !queue || !first || !next || !spring.share || !spring.node) return ERR_MEMORY;
    number_unknowns(solid, implicit, particles, moves, seen, queue);
    find_first(implicit, particles->n, first, next);
    TRY(envelope_create(&implicit->springs, a, implicit->n, next, d));
    for (int64_t i = 0; i < 2 * implicit->n; i++) first[i] = 2 * next[i / 2];
    TRY(envelope_create(&implicit->matrix, a, 2 * implicit->n, first, d));
    add_springs(solid, implicit, particles->body, &spring);
    return ERR_OK;
}

enum err implicit_create(struct solid *solid, struct arena *a, const struct particles *particles,
                         struct diag *d)
{
    const size_t n = (size_t)particles->n;
    struct implicit *const implicit = arena_alloc(a, 1, sizeof *implicit, what, d);
    if (!implicit) return ERR_MEMORY;
    TRY(arena_array(a, &implicit->order, n, what, d));
    TRY(arena_array(a, &implicit->unknown, 2 * n + ENVELOPE_ALIGN, what, d));
    for (int k = 0; k < 4; k++) TRY(arena_array(a, &implicit->start[k], n, what, d));
    TRY(link_particles(solid, &implicit->links, a, particles->n, d));
    struct arena scratch = {.limit = a->limit};
    double *const moves = arena_alloc(&scratch, n, sizeof *moves, what, d);
    for (size_t i = 0; moves && i < n; i++) moves[i] = particles->free[i];
    for (int64_t k = 0; moves && solid->loads && k < solid->loads->n_held; k++)
        moves[solid->loads->held[k]] = 0;
    const enum err e =
        moves ? create_matrices(solid, implicit, a, particles, moves, &scratch, d) : ERR_MEMORY;
    arena_free(&scratch);
    solid->implicit = implicit;
    return e || !solid->hinges ? e : constraint_create(implicit, solid->hinges, a, d);
}
