/* SPDX-License-Identifier: MIT */
#include "solid/contact.h"

#include <math.h>
#include <string.h>

/* Partners are looked for this much further than they reach, in smallest spacings, so that the search
 * need not be repeated in every step. */
static const double skin_over_dp = 0.4;

/* --- laws --- */

static struct contact_law *law_of(const struct contact *c, int a, int b)
{
    return &c->law[a * (c->n_solids + c->n_walls) + b];
}

/* Spring constant stiffness * E of the softer body, so that a pressure p leaves an overlap of dp p/(stiffness
 * E); dashpots in shares of the pair's critical damping 2 sqrt(k m_ab), with m_ab = m_a m_b/(m_a + m_b). */
static struct contact_law law_between(const struct scene_contact *from, const struct solid_body *a,
                                      const struct solid_body *b, double wall_dp)
{
    const double young = b ? min2(a->young, b->young) : a->young;
    const double mass = b ? a->mass * b->mass / (a->mass + b->mass) : a->mass;
    const double k = from->stiffness * young, critical = 2 * sqrt(k * mass);
    return (struct contact_law){
        .on = true,
        .reach = 0.5 * (a->dp + (b ? b->dp : wall_dp)) + from->gap,
        .gap = from->gap,
        .stiffness = k,
        .damping = from->damping * critical,
        .friction = from->friction,
        .grip = from->friction > 0 ? 0.5 * critical : 0,
    };
}

/* The number of a section that `between` names, walls behind solids. */
static int number_of(const struct scene *s, const char *name)
{
    const int solid = scene_find_solid(s, name);
    return solid >= 0 ? solid : s->n_solid + scene_find_wall(s, name);
}

/* Bodies that are joined are one and do not touch. */
static void set_law(struct contact *c, const struct scene_contact *from, const struct solid *s,
                    int a, int b)
{
    if (a == b || (b < c->n_solids && s->body[a].bond == s->body[b].bond)) return;
    const bool wall = b >= c->n_solids;
    const struct contact_law law =
        law_between(from, &s->body[a], wall ? NULL : &s->body[b], c->scene->top.dp);
    *law_of(c, a, b) = law;
    if (!wall) *law_of(c, b, a) = law;
    c->reach = max2(c->reach, law.reach);
}

/* Sections that name nobody first: those that do may differ from them. */
static void set_laws(struct contact *c, const struct solid *s)
{
    const struct scene *const scene = c->scene;
    const int n = c->n_solids + c->n_walls;
    for (int k = 0; k < scene->n_contact; k++)
        if (!scene->contact[k].between[0])
            for (int a = 0; a < c->n_solids; a++)
                for (int b = a + 1; b < n; b++) set_law(c, &scene->contact[k], s, a, b);
    for (int k = 0; k < scene->n_contact; k++) {
        char name[2][SCENE_TEXT];
        if (!scene_pair(scene->contact[k].between, name)) continue;
        const int a = number_of(scene, name[0]), b = number_of(scene, name[1]);
        set_law(c, &scene->contact[k], s, a < b ? a : b, a < b ? b : a);
    }
}

/* By Gershgorin's circles: row a of M^-1 K sums to at most n (k + k)/m_a with n springs on a, and to half
 * of that against a wall, which does not move. A particle of spacing dp_b in front of it for every dp_b
 * along its reach on both sides, and one more. The same for dashpots, along and across. */
static void bound_step(struct contact *c, const struct solid *s)
{
    for (int a = 0; a < c->n_solids; a++) {
        for (int b = 0; b < c->n_solids + c->n_walls; b++) {
            const struct contact_law *const law = law_of(c, a, b);
            if (!law->on) continue;
            const bool wall = b >= c->n_solids;
            const double dp = wall ? c->scene->top.dp : s->body[b].dp;
            const double n = (1 + 2 * ceil(law->reach / dp - 1e-9)) * (wall ? 1 : 2);
            c->omega2 = max2(c->omega2, n * law->stiffness / s->body[a].mass);
            c->damping = max2(c->damping, n * max2(law->damping, law->grip) / s->body[a].mass);
        }
    }
}

/* --- surfaces --- */

static int64_t cell_of(const struct contact_grid *g, double x)
{
    return (int64_t)floor(x / g->side);
}

static enum err grid_create(struct contact_grid *g, struct arena *a, int64_t n, struct diag *d)
{
    uint32_t size = 64;
    while (size < (uint64_t)n) size *= 2;
    g->mask = size - 1;
    g->head = arena_alloc(a, size, sizeof *g->head, "contact", d);
    g->next = arena_alloc(a, (size_t)n, sizeof *g->next, "contact", d);
    return g->head && g->next ? ERR_OK : ERR_MEMORY;
}

static void grid_fill(struct contact_grid *g, int64_t n)
{
    memset(g->head, 0xff, ((size_t)g->mask + 1) * sizeof *g->head);
    for (int64_t k = n - 1; k >= 0; k--) {
        const uint32_t slot = hash_cell(cell_of(g, g->x[k]), cell_of(g, g->y[k]), g->mask);
        g->next[k] = g->head[slot];
        g->head[slot] = (int32_t)k;
    }
}

/* Points within `reach`, at most `side`, of (x, y), ascending; returns how many, of which at most `room`
 * are stored. */
static int grid_find(const struct contact_grid *g, double x, double y, double reach, int room,
                     int32_t *found)
{
    const int64_t ci = cell_of(g, x), cj = cell_of(g, y);
    int n = 0;
    for (int64_t j = cj - 1; j <= cj + 1; j++) {
        for (int64_t i = ci - 1; i <= ci + 1; i++) {
            for (int32_t k = g->head[hash_cell(i, j, g->mask)]; k >= 0; k = g->next[k]) {
                /* Cells may share a slot. */
                if (cell_of(g, g->x[k]) != i || cell_of(g, g->y[k]) != j) continue;
                if (square(g->x[k] - x) + square(g->y[k] - y) >= reach * reach) continue;
                if (n++ >= room) continue;
                int at = n - 1;
                for (; at > 0 && found[at - 1] > k; at--) found[at] = found[at - 1];
                found[at] = k;
            }
        }
    }
    return n;
}

/* A particle with an empty place among the eight next to it belongs to a surface. Bodies that are joined
 * count as one, and so do walls. */
static enum err add_surface(struct contact *c, struct arena *a, const struct solid *s,
                            const struct particles *p, bool walls, struct diag *d)
{
    const double largest = walls ? c->scene->top.dp : c->largest_dp;
    struct arena temp = {.limit = a->limit};
    struct contact_grid g = {.side = 1.5 * largest, .x = p->X, .y = p->Y};
    enum err e = grid_create(&g, &temp, p->n, d);
    if (!e) grid_fill(&g, p->n);
    for (int64_t i = 0; i < p->n && !e; i++) {
        int32_t near[CONTACT_PARTNERS];
        const double dp = walls ? c->scene->top.dp : s->body[p->body[i]].dp;
        const int found = grid_find(&g, p->X[i], p->Y[i], 1.5 * dp, CONTACT_PARTNERS, near);
        int n = 0;
        for (int k = 0; k < found && k < CONTACT_PARTNERS; k++)
            n += walls || s->body[p->body[near[k]]].bond == s->body[p->body[i]].bond;
        if (n >= 9) continue; /* itself and eight more */
        c->index[c->n_points] = (int32_t)i;
        c->body[c->n_points] = p->body[i] + (walls ? c->n_solids : 0);
        c->n_points++;
    }
    arena_free(&temp);
    return e;
}

/* --- where points are --- */

/* Brings the points of solids to where they are at the state, those of moving walls to `time`; notes
 * whether any has gone too far since partners were looked for. */
static void place_points(struct contact *c, const struct particles *p, double time)
{
    const double far2 = square(0.5 * c->skin);
    if (c->power) {
#pragma omp single
        for (int k = 0; k < c->n_walls; k++) {
            const int motion = scene_find_motion(c->scene, c->scene->wall[k].motion);
            c->motion[k] =
                motion >= 0 ? motion_at(c->scene, motion, time) : (struct motion_state){0};
        }
    }
    /* Walls at rest stay where they were put. */
    const int64_t n = c->power ? c->n_points : c->n_solid_points;
#pragma omp for schedule(static)
    for (int64_t k = 0; k < n; k++) {
        const int32_t i = c->index[k];
        if (k < c->n_solid_points) {
            c->x[k] = p->X[i] + p->ux[i];
            c->y[k] = p->Y[i] + p->uy[i];
        } else {
            const struct motion_point at =
                motion_of_point(&c->motion[c->body[k] - c->n_solids], c->wall->X[i], c->wall->Y[i]);
            c->x[k] = at.x[0];
            c->y[k] = at.x[1];
            c->vx[k - c->n_solid_points] = at.v[0];
            c->vy[k - c->n_solid_points] = at.v[1];
        }
        /* Not a number counts as far. */
        if (!(square(c->x[k] - c->at_x[k]) + square(c->y[k] - c->at_y[k]) <= far2)) {
#pragma omp atomic write
            c->stale = 1;
        }
    }
}

/* Every solid point's partners. Which there are beyond the reach changes no bit of a force, so it does not
 * matter when they were looked for. */
static void find_partners(struct contact *c)
{
    memcpy(c->at_x, c->x, (size_t)c->n_points * sizeof *c->x);
    memcpy(c->at_y, c->y, (size_t)c->n_points * sizeof *c->y);
    grid_fill(&c->grid, c->n_points);
    for (int64_t k = 0; k < c->n_solid_points; k++) {
        enum { ROOM = 4 * CONTACT_PARTNERS };
        int32_t near[ROOM], *const kept = &c->partner[k * CONTACT_PARTNERS];
        const int found = grid_find(&c->grid, c->x[k], c->y[k], c->reach + c->skin, ROOM, near);
        int n = 0;
        for (int m = 0; m < found && m < ROOM; m++) {
            if (!law_of(c, c->body[k], c->body[near[m]])->on) continue;
            if (n < CONTACT_PARTNERS) kept[n] = near[m];
            n++;
        }
        if (n > CONTACT_PARTNERS || found > ROOM) c->crowded = 1;
        c->n_partners[k] = n < CONTACT_PARTNERS ? n : CONTACT_PARTNERS;
    }
    c->stale = 0;
}

static void update(struct contact *c, const struct particles *p, double time)
{
    place_points(c, p, time);
    if (!c->stale) return;
#pragma omp barrier
#pragma omp single
    find_partners(c);
}

/* --- forces --- */

/* A pair within reach: its direction from the partner, overlap and relative velocity. */
struct touch {
    double x, y, overlap, vx, vy;
};

/* Where a gap was narrower at the start, as beside a clamp or under a body that rests, that is its gap. */
static double pair_reach(const struct contact *c, const struct contact_law *law, int64_t k,
                         int32_t other)
{
    if (law->gap == 0) return law->reach;
    const double began = hypot(c->X[k] - c->X[other], c->Y[k] - c->Y[other]);
    return min2(law->reach, max2(law->reach - law->gap, began));
}

static bool touches(const struct contact *c, const struct contact_law *law, int64_t k,
                    int32_t other, struct touch *t)
{
    const double dx = c->x[k] - c->x[other], dy = c->y[k] - c->y[other], r2 = dx * dx + dy * dy;
    if (r2 >= law->reach * law->reach || r2 == 0) return false;
    const double r = sqrt(r2), reach = pair_reach(c, law, k, other);
    *t = (struct touch){.x = dx / r, .y = dy / r, .overlap = reach - r};
    return r < reach;
}

/* Potential k/2 (r0 - r)^2 below r0 = the mean spacing: the linear spring of Cundall and Strack (1979)
 * on the particles of a surface, as in the contact of Campbell, Vignjevic and Libersky (2000). Along the
 * pair a dashpot that may weaken the push but not turn it into a pull; across it Coulomb's friction, below
 * the speed of sliding proportional to the speed. */
static void touch_force(const struct contact_law *law, const struct touch *t, double f[2])
{
    const double along = t->vx * t->x + t->vy * t->y;
    const double push = max2(0, law->stiffness * t->overlap - law->damping * along);
    f[0] = push * t->x;
    f[1] = push * t->y;
    if (!(law->friction > 0)) return;
    const double sx = t->vx - along * t->x, sy = t->vy - along * t->y,
                 slip = sqrt(sx * sx + sy * sy);
    if (!(slip > 0)) return;
    const double drag = min2(law->friction * push, law->grip * slip) / slip;
    f[0] -= drag * sx;
    f[1] -= drag * sy;
}

static void partner_velocity(const struct contact *c, const struct particles *p, int32_t j,
                             double v[2])
{
    const bool solid = j < c->n_solid_points;
    const int64_t wall = j - c->n_solid_points;
    v[0] = solid ? p->vx[c->index[j]] : c->power ? c->vx[wall] : 0;
    v[1] = solid ? p->vy[c->index[j]] : c->power ? c->vy[wall] : 0;
}

/* All forces on one point of a solid. */
static void point_forces(struct contact *c, const struct solid *s, struct particles *p, int64_t k)
{
    const int32_t i = c->index[k], *const partner = &c->partner[k * CONTACT_PARTNERS];
    double fx = 0, fy = 0, power = 0;
    for (int m = 0; m < c->n_partners[k]; m++) {
        const int32_t j = partner[m];
        const struct contact_law *const law = law_of(c, c->body[k], c->body[j]);
        struct touch t;
        if (!touches(c, law, k, j, &t)) continue;
        double v[2];
        partner_velocity(c, p, j, v);
        t.vx = p->vx[i] - v[0];
        t.vy = p->vy[i] - v[1];
        double f[2];
        touch_force(law, &t, f);
        fx += f[0];
        fy += f[1];
        if (j >= c->n_solid_points) power += f[0] * v[0] + f[1] * v[1];
    }
    if (c->power) c->power[k] = power;
    const double per_mass = p->free[i] / s->body[c->body[k]].mass;
    p->sx[i] += fx * per_mass;
    p->sy[i] += fy * per_mass;
}

void contact_forces(struct contact *c, const struct solid *s, struct particles *p, double time)
{
    update(c, p, time);
#pragma omp for schedule(static)
    for (int64_t k = 0; k < c->n_solid_points; k++) point_forces(c, s, p, k);
}

double contact_power(const struct contact *c)
{
    double sum = 0;
    for (int64_t k = 0; c->power && k < c->n_solid_points; k++) sum += c->power[k];
    return sum;
}

/* Pairs of solids are met twice, those with walls once. */
double contact_energy(struct contact *c, const struct particles *p, double time)
{
    update(c, p, time);
    double sum = 0;
    for (int64_t k = 0; k < c->n_solid_points; k++) {
        for (int m = 0; m < c->n_partners[k]; m++) {
            const int32_t j = c->partner[k * CONTACT_PARTNERS + m];
            const struct contact_law *const law = law_of(c, c->body[k], c->body[j]);
            struct touch t;
            if (touches(c, law, k, j, &t))
                sum += (j < c->n_solid_points ? 0.25 : 0.5) * law->stiffness * square(t.overlap);
        }
    }
    return sum;
}

/* --- the beginning --- */

/* Bodies on lattices that do not fit may start nearer to each other than they like. */
static void warn_of_overlap(const struct contact *c, const struct particles *p, struct diag *d)
{
    double most = 0;
    int64_t at = -1;
    for (int64_t k = 0; k < c->n_solid_points; k++) {
        if (p->free[c->index[k]] == 0) continue;
        for (int m = 0; m < c->n_partners[k]; m++) {
            const int32_t j = c->partner[k * CONTACT_PARTNERS + m];
            const struct contact_law *const law = law_of(c, c->body[k], c->body[j]);
            struct touch t;
            const double spacing = law->reach - law->gap;
            if (!touches(c, law, k, j, &t) || t.overlap / spacing <= most) continue;
            most = t.overlap / spacing;
            at = k;
        }
    }
    if (most > 1e-3)
        diag_warn(d,
                  "bodies start in contact: near (%.6g, %.6g) m particles overlap by %.2g of their "
                  "spacing and push from the beginning; a common lattice or a gap would mend it",
                  c->x[at], c->y[at], most);
}

static enum err create_points(struct contact *c, struct arena *a, const struct solid *s,
                              const struct particles *solid, bool moves, struct diag *d)
{
    const size_t most = (size_t)(solid->n + c->wall->n);
    c->index = arena_alloc(a, most, sizeof *c->index, "contact", d);
    c->body = arena_alloc(a, most, sizeof *c->body, "contact", d);
    if (!c->index || !c->body) return ERR_MEMORY;
    TRY(add_surface(c, a, s, solid, false, d));
    c->n_solid_points = c->n_points;
    if (c->wall->n) TRY(add_surface(c, a, s, c->wall, true, d));
    double **const place[] = {&c->X, &c->Y, &c->x, &c->y, &c->at_x, &c->at_y};
    for (size_t k = 0; k < COUNT_OF(place); k++) {
        *place[k] = arena_alloc(a, (size_t)c->n_points, sizeof(double), "contact", d);
        if (!*place[k]) return ERR_MEMORY;
    }
    const size_t n = (size_t)c->n_solid_points;
    c->partner = arena_alloc(a, n * CONTACT_PARTNERS, sizeof *c->partner, "contact", d);
    c->n_partners = arena_alloc(a, n, sizeof *c->n_partners, "contact", d);
    if (!c->partner || !c->n_partners) return ERR_MEMORY;
    for (int64_t k = 0; k < c->n_points; k++) {
        const struct particles *const of = k < c->n_solid_points ? solid : c->wall;
        c->X[k] = c->x[k] = of->X[c->index[k]];
        c->Y[k] = c->y[k] = of->Y[c->index[k]];
    }
    if (moves) {
        const size_t walls = (size_t)(c->n_points - c->n_solid_points);
        c->power = arena_alloc(a, n, sizeof *c->power, "contact", d);
        c->vx = arena_alloc(a, walls, sizeof *c->vx, "contact", d);
        c->vy = arena_alloc(a, walls, sizeof *c->vy, "contact", d);
        if (!c->power || !c->vx || !c->vy) return ERR_MEMORY;
    }
    c->grid = (struct contact_grid){.side = c->reach + c->skin, .x = c->x, .y = c->y};
    return grid_create(&c->grid, a, c->n_points, d);
}

enum err contact_create(struct contact *c, struct arena *a, const struct scene *scene,
                        const struct solid *s, const struct particles *solid,
                        const struct particles *wall, struct diag *d)
{
    *c = (struct contact){.scene = scene, .wall = wall, .n_solids = scene->n_solid, .stale = 1};
    c->n_walls = wall->n ? scene->n_wall : 0;
    const size_t laws = (size_t)c->n_solids * (size_t)(c->n_solids + c->n_walls);
    c->law = arena_alloc(a, laws, sizeof *c->law, "contact", d);
    c->motion = arena_alloc(a, (size_t)c->n_walls, sizeof *c->motion, "contact", d);
    if (!c->law || !c->motion) return ERR_MEMORY;
    set_laws(c, s);
    bound_step(c, s);
    for (int k = 0; k < c->n_solids; k++) c->largest_dp = max2(c->largest_dp, s->body[k].dp);
    c->skin = skin_over_dp * s->dp;
    bool moves = false;
    for (int k = 0; k < c->n_walls; k++) moves |= scene->wall[k].motion[0] != '\0';
    TRY(create_points(c, a, s, solid, moves, d));
    update(c, solid, 0);
    warn_of_overlap(c, solid, d);
    return ERR_OK;
}
