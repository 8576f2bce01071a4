/* SPDX-License-Identifier: MIT */
#include "solid/parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/barrier.h"
#include "particles/kernel.h"
#include "solid/packed.h"
#include "solid/stencil.h"

/* Packed fields of HALO_POSITION, HALO_GRADIENT and HALO_STRESS. */
static const struct {
    int first, end;
} handed[] = {{S_UX, S_UXX}, {S_UXX, S_PXX}, {S_PXX, S_GX}};
enum { HALO_MOST = 8 };

/* From one part to another, with two buffers used alternately. Before a sender fills a buffer
 * again, the receiver has emptied it: both send each other the same number of messages. */
struct part_message {
    _Alignas(64) uint32_t sequence; /* number of messages; written by the sender */
    _Alignas(64) int n;
    int32_t *given, *taken; /* [n] indices in the sender and in the receiver */
    void *buffer[2];        /* [HALO_MOST][n] */
};

/* --- cutting --- */

/* Coordinate of a particle along the axis across which the solid is cut. */
struct position {
    double at;
    int32_t i;
};

static int compare_positions(const void *a, const void *b)
{
    const struct position *const x = a, *const y = b;
    if (x->at != y->at) return x->at < y->at ? -1 : 1;
    return (x->i > y->i) - (x->i < y->i);
}

/* Of n particles in order along the axis: a part's own ones and those within its reach around them,
 * up to before `end`. */
struct cut {
    int64_t first, end, own_first, own_end;
};

/* Both parts of a pair compute the same difference, so each is within the other's reach or neither
 * is. */
static struct cut cut_of(const struct position *position, int64_t n, double reach, int part,
                         int parts)
{
    struct cut c = {.own_first = n * part / parts, .own_end = n * (part + 1) / parts};
    const double low = position[c.own_first].at, high = position[c.own_end - 1].at;
    for (c.first = c.own_first; c.first > 0 && low - position[c.first - 1].at <= reach;) c.first--;
    for (c.end = c.own_end; c.end < n && position[c.end].at - high <= reach;) c.end++;
    return c;
}

/* Orders the particles along an axis; returns their number in all parts together. */
static int64_t order_along(struct position *position, const double *at, int64_t n, double reach,
                           int parts)
{
    for (int64_t i = 0; i < n; i++) position[i] = (struct position){at[i], (int32_t)i};
    qsort(position, (size_t)n, sizeof *position, compare_positions);
    int64_t sum = 0;
    for (int k = 0; k < parts; k++) {
        const struct cut c = cut_of(position, n, reach, k, parts);
        sum += c.end - c.first;
    }
    return sum;
}

static int compare_index(const void *a, const void *b)
{
    const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* Their indices in the whole, ascending. */
static void indices_of(const struct position *position, int64_t n, int32_t *index)
{
    for (int64_t k = 0; k < n; k++) index[k] = position[k].i;
    qsort(index, (size_t)n, sizeof *index, compare_index);
}

/* --- building --- */

/* Temporary data of building. */
struct plan {
    const struct solid *s;
    const struct particles *p;
    struct arena *arena;
    struct diag *d;
    struct position *position; /* [p->n] */
    struct cut *cut;           /* [parts] */
    int32_t **global;          /* [parts]: index in the whole, ascending */
    int32_t *local;            /* [p->n]: index in a part, -1: not in it */
    bool *own;                 /* [p->n]: the part's own */
};

static int64_t size_of(const struct cut *c) { return c->end - c->first; }

static void find_runs(struct solid_part *part, const struct plan *plan, const int32_t *global)
{
    for (int32_t k = 0; k < part->p.n; k++) {
        struct part_run *const last = part->n_runs ? &part->run[part->n_runs - 1] : NULL;
        const bool own = plan->own[global[k]];
        if (last && last->there + last->n == global[k] && last->own == own)
            last->n++;
        else
            /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): create_part has allocated it */
            part->run[part->n_runs++] = (struct part_run){k, global[k], 1, own};
    }
}

/* The particles of a part, with their constant fields. Copies are never free: messages set their
 * motion. */
static enum err create_particles(struct solid_part *part, const struct plan *plan,
                                 const struct cut *c, const int32_t *global)
{
    const unsigned groups = G_POINT | G_SOLID | (plan->p->groups & (G_FORCE | G_WETTED));
    struct particles *const p = &part->p;
    TRY(particles_create(p, plan->arena, size_of(c), groups, "parts of the solid", plan->d));
    p->n = size_of(c);
    for (int64_t k = 0; k < p->n; k++) p->body[k] = plan->p->body[global[k]];
    return ERR_OK;
}

static enum err create_part(struct solid_part *part, const struct plan *plan, const struct cut *c,
                            const int32_t *global)
{
    struct solid *const s = &part->solid;
    memset(plan->own, 0, (size_t)plan->p->n * sizeof *plan->own);
    for (int64_t k = c->own_first; k < c->own_end; k++) plan->own[plan->position[k].i] = true;
    for (int64_t i = 0; i < plan->p->n; i++) plan->local[i] = -1;
    for (int32_t k = 0; k < size_of(c); k++) plan->local[global[k]] = k;
    part->run = arena_alloc(plan->arena, (size_t)size_of(c), sizeof *part->run,
                            "parts of the solid", plan->d);
    if (!part->run) return ERR_MEMORY;
    TRY(create_particles(part, plan, c, global));
    find_runs(part, plan, global);
    *s = *plan->s;
    s->threads = 1;
    s->barrier = NULL;
    s->part = NULL;
    memset(s->lane, 0, sizeof s->lane);
    memset(s->scratch, 0, sizeof s->scratch);
    TRY(solid_packed_create(s, plan->arena, &part->p, plan->d));
    return solid_stencil_of_part(s, plan->arena, &part->p, plan->s, global, plan->local, plan->d);
}

/* Index of a particle in a part. */
static int32_t place_of(const int32_t *global, int64_t n, int32_t i)
{
    const int32_t *const found = bsearch(&i, global, (size_t)n, sizeof i, compare_index);
    return (int32_t)(found - global);
}

/* The message with the particles of part `from` that part `to` has copies of, if any. */
static enum err create_message(struct solid *s, const struct plan *plan, int from, int to)
{
    const struct cut *const a = &plan->cut[from], *const b = &plan->cut[to];
    const int64_t first = a->own_first > b->first ? a->own_first : b->first;
    const int64_t end = a->own_end < b->end ? a->own_end : b->end;
    if (from == to || first >= end) return ERR_OK;
    const size_t n = (size_t)(end - first);
    const char *const what = "messages between parts of the solid";
    struct part_message *const m = arena_alloc(plan->arena, 1, sizeof *m, what, plan->d);
    if (!m) return ERR_MEMORY;
    m->n = (int)n;
    m->given = arena_alloc(plan->arena, n, sizeof *m->given, what, plan->d);
    m->taken = arena_alloc(plan->arena, n, sizeof *m->taken, what, plan->d);
    for (int k = 0; k < 2; k++)
        m->buffer[k] = arena_alloc(plan->arena, n * HALO_MOST, s->sweeps->size, what, plan->d);
    if (!m->given || !m->taken || !m->buffer[0] || !m->buffer[1]) return ERR_MEMORY;
    indices_of(&plan->position[first], end - first, m->taken);
    for (size_t k = 0; k < n; k++) {
        m->given[k] = place_of(plan->global[from], size_of(a), m->taken[k]);
        m->taken[k] = place_of(plan->global[to], size_of(b), m->taken[k]);
    }
    s->part[from].out[s->part[from].n_others++] = m;
    for (int k = 0;; k++) {
        if (s->part[to].in[k]) continue;
        s->part[to].in[k] = m;
        return ERR_OK;
    }
}

static enum err create_all(struct solid *s, struct plan *plan, int parts)
{
    for (int k = 0; k < parts; k++) {
        struct solid_part *const part = &s->part[k];
        part->out =
            arena_alloc(plan->arena, (size_t)parts, sizeof(void *), "parts of the solid", plan->d);
        part->in =
            arena_alloc(plan->arena, (size_t)parts, sizeof(void *), "parts of the solid", plan->d);
        if (!part->out || !part->in) return ERR_MEMORY;
        TRY(create_part(part, plan, &plan->cut[k], plan->global[k]));
    }
    for (int from = 0; from < parts; from++)
        for (int to = 0; to < parts; to++) TRY(create_message(s, plan, from, to));
    return ERR_OK;
}

/* Memory for the cuts; chooses the axis with the fewest copies. Sets `pays` to false if there are
 * too many. */
static enum err make_plan(struct plan *plan, struct arena *scratch, int parts, bool *pays)
{
    const char *const what = "cutting the solid";
    const struct particles *const p = plan->p;
    const size_t n = (size_t)p->n;
    double reach = 0;
    for (int k = 0; k < plan->s->n_bodies; k++)
        reach = max2(reach, 1.001 * KERNEL_REACH * plan->s->body[k].h);
    plan->position = arena_alloc(scratch, n, sizeof *plan->position, what, plan->d);
    plan->cut = arena_alloc(scratch, (size_t)parts, sizeof *plan->cut, what, plan->d);
    plan->global = arena_alloc(scratch, (size_t)parts, sizeof *plan->global, what, plan->d);
    plan->local = arena_alloc(scratch, n, sizeof *plan->local, what, plan->d);
    plan->own = arena_alloc(scratch, n, sizeof *plan->own, what, plan->d);
    if (!plan->position || !plan->cut || !plan->global || !plan->local || !plan->own)
        return ERR_MEMORY;
    const int64_t across = order_along(plan->position, p->X, p->n, reach, parts);
    int64_t all = order_along(plan->position, p->Y, p->n, reach, parts);
    if (across < all) all = order_along(plan->position, p->X, p->n, reach, parts);
    *pays = all < p->n + p->n / 2;
    for (int k = 0; *pays && k < parts; k++) {
        plan->cut[k] = cut_of(plan->position, p->n, reach, k, parts);
        const int64_t size = size_of(&plan->cut[k]);
        plan->global[k] = arena_alloc(scratch, (size_t)size, sizeof **plan->global, what, plan->d);
        if (!plan->global[k]) return ERR_MEMORY;
        indices_of(&plan->position[plan->cut[k].first], size, plan->global[k]);
    }
    return ERR_OK;
}

enum err solid_parts_create(struct solid *s, struct arena *a, const struct particles *p,
                            struct diag *d)
{
    /* In larger bodies the data that both threads need is a small fraction of each one's own.
     * Measured: no gain with 8080 particles a thread, a loss of 1 % with 32160. */
    enum { MOST_OWN = 8192 };
    const int parts = s->threads;
    if (parts < 2 || p->n > (int64_t)MOST_OWN * parts) return ERR_OK;
    struct arena scratch = {.limit = a->limit};
    struct plan plan = {.s = s, .p = p, .arena = a, .d = d};
    bool pays;
    enum err e = make_plan(&plan, &scratch, parts, &pays);
    if (!e && pays) {
        s->part = arena_alloc(a, (size_t)parts, sizeof *s->part, "parts of the solid", d);
        e = s->part ? create_all(s, &plan, parts) : ERR_MEMORY;
    }
    arena_free(&scratch);
    return e;
}

/* --- stepping --- */

#define STATE_FIELDS(p) (p)->ux, (p)->uy, (p)->vx, (p)->vy
#define FACE_FIELDS(p) (p)->face_x, (p)->face_y, (p)->face_v, (p)->face_dv, (p)->face_work
#define SHOWN_FIELDS(p) \
    (p)->Uxx, (p)->Uxy, (p)->Uyx, (p)->Uyy, (p)->Pxx, (p)->Pxy, (p)->Pyx, (p)->Pyy, (p)->sx, (p)->sy

void solid_part_load(struct solid_part *part, const struct particles *whole)
{
    const struct particles *const p = &part->p;
    double *const from[] = {STATE_FIELDS(whole), whole->fx, whole->fy, FACE_FIELDS(whole)};
    double *const to[] = {STATE_FIELDS(p), p->fx, p->fy, FACE_FIELDS(p)};
    for (int f = 0; f < (int)COUNT_OF(from) && from[f]; f++)
        for (const struct part_run *r = part->run; r < part->run + part->n_runs; r++)
            memcpy(&to[f][r->here], &from[f][r->there], (size_t)r->n * sizeof(double));
    for (const struct part_run *r = part->run; r < part->run + part->n_runs; r++)
        if (r->own)
            memcpy(&p->free[r->here], &whole->free[r->there], (size_t)r->n * sizeof(double));
}

/* Copies fields of the part's own particles to those of the whole. */
static void give(const struct solid_part *part, double *const *from, double *const *to, int fields)
{
    for (int f = 0; f < fields && from[f]; f++)
        for (const struct part_run *r = part->run; r < part->run + part->n_runs; r++)
            if (r->own) memcpy(&to[f][r->there], &from[f][r->here], (size_t)r->n * sizeof(double));
}

void solid_part_store(const struct solid_part *part, const struct particles *whole)
{
    double *const from[] = {STATE_FIELDS(&part->p), part->p.face_dv, part->p.face_work};
    double *const to[] = {STATE_FIELDS(whole), whole->face_dv, whole->face_work};
    give(part, from, to, COUNT_OF(from));
}

void solid_part_results(struct solid_part *part, const struct particles *whole)
{
    double *const from[] = {SHOWN_FIELDS(&part->p)}, *const to[] = {SHOWN_FIELDS(whole)};
    part->solid.sweeps->write_stress(&part->solid, &part->p, 0, part->solid.n_packs);
    give(part, from, to, COUNT_OF(from));
}

/* Numbers of a packed field to a buffer, and from it. */
static void gather_lane(const void *lane, const int32_t *at, int n, size_t size, void *buffer)
{
    if (size == sizeof(double))
        for (int k = 0; k < n; k++) ((double *)buffer)[k] = ((const double *)lane)[at[k]];
    else
        for (int k = 0; k < n; k++) ((float *)buffer)[k] = ((const float *)lane)[at[k]];
}

static void scatter_lane(void *lane, const int32_t *at, int n, size_t size, const void *buffer)
{
    if (size == sizeof(double))
        for (int k = 0; k < n; k++) ((double *)lane)[at[k]] = ((const double *)buffer)[k];
    else
        for (int k = 0; k < n; k++) ((float *)lane)[at[k]] = ((const float *)buffer)[k];
}

/* The packed fields of a halo; returns their number. */
static int lanes_of(const struct solid *s, unsigned what, void *lane[HALO_MOST])
{
    int n = 0;
    for (int k = 0; k < (int)COUNT_OF(handed); k++)
        for (int l = handed[k].first; what & 1u << k && l < handed[k].end; l++)
            if (s->lane[l]) lane[n++] = s->lane[l];
    return n;
}

void halo_exchange(struct solid_part *part, unsigned what)
{
    void *lane[HALO_MOST];
    const int n = lanes_of(&part->solid, what, lane);
    const size_t size = part->solid.sweeps->size;
    part->sequence++;
    for (int k = 0; k < part->n_others; k++) {
        struct part_message *const m = part->out[k];
        char *buffer = m->buffer[part->sequence & 1];
        for (int l = 0; l < n; l++, buffer += (size_t)m->n * size)
            gather_lane(lane[l], m->given, m->n, size, buffer);
        __atomic_store_n(&m->sequence, part->sequence, __ATOMIC_RELEASE);
    }
    for (int k = 0; k < part->n_others; k++) {
        struct part_message *const m = part->in[k];
        barrier_wait_for(&m->sequence, part->sequence);
        const char *buffer = m->buffer[part->sequence & 1];
        for (int l = 0; l < n; l++, buffer += (size_t)m->n * size)
            scatter_lane(lane[l], m->taken, m->n, size, buffer);
    }
}
