/* SPDX-License-Identifier: MIT */
#include "time/account.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "fluid/eos.h"
#include "particles/kernel.h"
#include "time/repulsion.h"

int account_entry(enum kind kind, int section) { return (int)kind * SCENE_MAX_SECTIONS + section; }

static int region_of(const struct account *a, int entry) { return (int)a->region[entry]; }

static bool in_region(const struct account *a, enum kind kind, int section, int entry)
{
    return region_of(a, account_entry(kind, section)) == entry;
}

/* The [fluid] and [solid] sections and the walls that move. */
static int sections(const struct simulation *s, enum kind kind)
{
    if (kind == KIND_FLUID) return s->scene->n_fluid;
    return kind == KIND_SOLID ? s->scene->n_solid : s->wall_motion.n;
}

static int section_at_index(const struct simulation *s, enum kind kind, int k)
{
    return kind == KIND_WALL ? s->wall_motion.body[k].section : k;
}

/* --- regions --- */

static void unite(struct account *a, int one, int other)
{
    const int from = region_of(a, one), to = region_of(a, other);
    const int first = from < to ? from : to, second = from < to ? to : from;
    if (first == second) return;
    for (int t = 0; t < ACCOUNT_TERMS; t++) {
        a->low[t][first] += a->low[t][second];
        a->available[t][first] += a->available[t][second];
    }
    a->lowest[first] += a->lowest[second];
    for (int k = 0; k < ACCOUNT_ENTRIES; k++)
        if (region_of(a, k) == second) a->region[k] = first;
}

/* The smallest box around a section's particles, with a margin. */
struct box {
    double low[2], high[2];
};

static bool meet_boxes(const struct box *a, const struct box *b)
{
    return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] &&
           b->low[1] <= a->high[1];
}

static void find_boxes(const struct simulation *s, struct box box[ACCOUNT_ENTRIES])
{
    const double none = (double)INFINITY, margin = 0.5 * KERNEL_REACH * s->scene->h;
    for (int k = 0; k < ACCOUNT_ENTRIES; k++) box[k] = (struct box){{none, none}, {-none, -none}};
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct particles *const p = &s->kind[kind];
        for (int64_t i = 0; i < p->n; i++) {
            struct box *const b = &box[account_entry((enum kind)kind, p->body[i])];
            b->low[0] = min2(b->low[0], p->x[i] - margin);
            b->low[1] = min2(b->low[1], p->y[i] - margin);
            b->high[0] = max2(b->high[0], p->x[i] + margin);
            b->high[1] = max2(b->high[1], p->y[i] + margin);
        }
    }
}

static bool one_region(const struct simulation *s)
{
    const struct account *const a = &s->state.account;
    int first = -1;
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int k = 0; k < sections(s, (enum kind)kind); k++) {
            const int entry =
                account_entry((enum kind)kind, section_at_index(s, (enum kind)kind, k));
            if (first >= 0 && region_of(a, entry) != first) return false;
            first = region_of(a, entry);
        }
    return true;
}

/* Whether two kinds exchange energy where they come near. */
static bool exchange(enum kind one, enum kind other)
{
    return one == KIND_FLUID || other == KIND_FLUID;
}

/* Sections whose boxes are within the kernel's reach of each other belong to one region from now
 * on. */
static void join_neighbours(struct simulation *s)
{
    if (one_region(s)) return;
    struct box box[ACCOUNT_ENTRIES];
    find_boxes(s, box);
    for (int one = 0; one < KIND_COUNT; one++)
        for (int other = one; other < KIND_COUNT; other++) {
            if (!exchange((enum kind)one, (enum kind)other)) continue;
            for (int j = 0; j < sections(s, (enum kind)one); j++)
                for (int k = 0; k < sections(s, (enum kind)other); k++) {
                    const int a =
                        account_entry((enum kind)one, section_at_index(s, (enum kind)one, j));
                    const int b =
                        account_entry((enum kind)other, section_at_index(s, (enum kind)other, k));
                    if (meet_boxes(&box[a], &box[b])) unite(&s->state.account, a, b);
                }
        }
}

/* Sections that belong together at any distance: joined bodies; all bodies once any is in contact,
 * since the energy of contact is a single number; all sections of a domain that is periodic or has
 * open boundaries. */
static void join_at_once(struct simulation *s, double contact)
{
    for (int j = 0; j < s->scene->n_solid; j++)
        for (int k = 0; k < j; k++)
            if (contact > 0 || s->solid.body[j].bond == s->solid.body[k].bond)
                unite(&s->state.account, account_entry(KIND_SOLID, j),
                      account_entry(KIND_SOLID, k));
    if (!(s->effects & (FX_PERIODIC | FX_OPEN))) return;
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int k = 0; k < sections(s, (enum kind)kind); k++)
            unite(&s->state.account, account_entry(KIND_FLUID, 0),
                  account_entry((enum kind)kind, section_at_index(s, (enum kind)kind, k)));
}

void account_touch(struct simulation *s)
{
    if (!(s->effects & FX_CONTACT) || !s->contact.touched) return;
    s->contact.touched = false;
    for (int k = 1; k < s->scene->n_solid; k++)
        unite(&s->state.account, account_entry(KIND_SOLID, 0), account_entry(KIND_SOLID, k));
}

/* --- energies --- */

struct energies {
    double kinetic, potential, internal, elastic, hourglass, contact;
    double dummies;     /* compression energy of dummies by their pressure */
    double repulsion;   /* of walls and structures, by L-7b */
    double alternating; /* by which Verlet's two solutions differ (T-46f) */
    double damper;      /* that the acoustic damper holds and has yet to dissipate (T-9a) */
    double scale;       /* of a strain of 1, or of a fluid at the speed of sound */
};

static double energy_without_potential(const struct energies *e)
{
    return e->kinetic + e->internal + e->elastic + e->hourglass + e->contact + e->repulsion;
}

/* That the work on a section changes. */
static double own_energy(const struct energies *e)
{
    return energy_without_potential(e) - e->repulsion + e->potential - e->alternating;
}

static void add_energies(struct energies *sum, const struct energies *e)
{
    sum->kinetic += e->kinetic;
    sum->potential += e->potential;
    sum->internal += e->internal;
    sum->elastic += e->elastic;
    sum->hourglass += e->hourglass;
    sum->contact += e->contact;
    sum->dummies += e->dummies;
    sum->repulsion += e->repulsion;
    sum->alternating += e->alternating;
    sum->damper += e->damper;
    sum->scale += e->scale;
}

static void add_fluid(const struct simulation *s, struct energies *of)
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    const struct fluid_constants *const k = &s->fluid.k;
    const double *const g = s->scene->top.gravity;
    for (int64_t i = 0; i < p->n; i++) {
        struct energies *const e = &of[account_entry(KIND_FLUID, p->body[i])];
        const double m = p->m ? k->mass * p->m[i] : k->mass;
        e->kinetic += 0.5 * m * (square(p->vx[i]) + square(p->vy[i]));
        e->potential -= m * (g[0] * p->x[i] + g[1] * p->y[i]);
        e->internal += m * eos_energy(p->dens[i], k->c0);
        e->scale += m * square(k->c0);
        if (p->dens_slow) e->damper += 0.5 * m * square(k->c0 * (p->dens[i] - p->dens_slow[i]));
    }
}

static void add_solids(const struct simulation *s, struct energies *of)
{
    const struct particles *const p = &s->kind[KIND_SOLID];
    for (int64_t i = 0; i < p->n; i++) {
        struct energies *const e = &of[account_entry(KIND_SOLID, p->body[i])];
        const struct solid_body *const b = &s->solid.body[p->body[i]];
        e->kinetic += 0.5 * b->mass * (square(p->vx[i]) + square(p->vy[i]));
        e->potential -= b->mass * (b->gravity[0] * p->x[i] + b->gravity[1] * p->y[i]);
        e->scale += b->young * square(b->dp);
    }
    for (int k = 0; k < s->scene->n_solid; k++) {
        struct energies *const e = &of[account_entry(KIND_SOLID, k)];
        double det_low;
        solid_energy(&s->solid, p, k, &e->elastic, &e->hourglass, &det_low);
    }
}

/* The energy of dummies, divided among the fluids as their compression energy is: a wall at rest
 * belongs to no region. */
static void add_dummies(const struct simulation *s, struct energies *of)
{
    double dummies = 0, internal = 0;
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
        const struct particles *const p = &s->kind[kind];
        for (int64_t i = 0; i < p->n && p->dens; i++)
            dummies += s->fluid.volume[kind][p->body[i]] * eos_energy(p->dens[i], s->fluid.k.c0);
    }
    for (int k = 0; k < s->scene->n_fluid; k++)
        internal += of[account_entry(KIND_FLUID, k)].internal;
    for (int k = 0; k < s->scene->n_fluid && internal > 0; k++) {
        struct energies *const e = &of[account_entry(KIND_FLUID, k)];
        e->dummies = s->fluid.k.mass * dummies * e->internal / internal;
    }
}

void account_alternating(const struct simulation *s, double of[SCENE_MAX_SECTIONS])
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    const double c0 = s->fluid.k.c0, since = s->state.dt;
    memset(of, 0, SCENE_MAX_SECTIONS * sizeof *of);
    for (int64_t i = 0; i < p->n && p->vx_old; i++) {
        if (p->open && p->open[i]) continue; /* set anew at each evaluation */
        const double m = p->m ? s->fluid.k.mass * p->m[i] : s->fluid.k.mass;
        const double u = p->vx_old[i] + since * p->ax[i], v = p->vy_old[i] + since * p->ay[i];
        const double d = p->dens_old[i] + since * p->ddens[i];
        of[p->body[i]] += 0.5 * m *
                          (0.5 * (square(p->vx[i]) + square(p->vy[i]) - square(u) - square(v)) +
                           eos_energy(p->dens[i], c0) - eos_energy(d, c0));
    }
}

/* Energies of fluids that depend on more than their own particles' state. */
static void add_shared(const struct simulation *s, struct energies *of)
{
    double repulsion[SCENE_MAX_SECTIONS] = {0}, alternating[SCENE_MAX_SECTIONS] = {0};
    if (s->effects & FX_REPULSION) repulsion_energy(s, repulsion);
    if (s->integrator->alternates) account_alternating(s, alternating);
    for (int k = 0; k < s->scene->n_fluid; k++) {
        struct energies *const e = &of[account_entry(KIND_FLUID, k)];
        e->repulsion = repulsion[k];
        e->alternating = alternating[k];
    }
}

/* Energies of the sections. The first solid carries the energy of contact of all. */
static void find_energies(struct simulation *s, struct energies of[ACCOUNT_ENTRIES])
{
    memset(of, 0, ACCOUNT_ENTRIES * sizeof *of);
    if (s->effects & FX_FLUID) add_fluid(s, of);
    if (s->effects & FX_SOLID) add_solids(s, of);
    if (s->effects & FX_FLUID) add_dummies(s, of);
    if (s->effects & FX_FLUID) add_shared(s, of);
    if (s->effects & FX_CONTACT)
        of[account_entry(KIND_SOLID, 0)].contact =
            contact_energy(&s->contact, &s->kind[KIND_SOLID], s->state.time);
}

/* --- terms --- */

/* Work that the fluid has still to receive from a body: the impulse that waits (T-35b) at the
 * velocity that the fluid uses. */
static void find_interface_work(const struct simulation *s, double of[SCENE_MAX_SECTIONS])
{
    const struct particles *const p = &s->kind[KIND_SOLID];
    memset(of, 0, SCENE_MAX_SECTIONS * sizeof *of);
    for (int64_t i = 0; i < p->n && p->interface_impulse_x; i++)
        of[p->body[i]] +=
            p->interface_impulse_x[i] * p->wx[i] + p->interface_impulse_y[i] * p->wy[i];
}

/* The terms of the sections as they are now. */
static void find_terms(const struct simulation *s, const struct energies of[ACCOUNT_ENTRIES],
                       double terms[ACCOUNT_TERMS][ACCOUNT_ENTRIES])
{
    const struct account *const a = &s->state.account;
    double to_return[SCENE_MAX_SECTIONS];
    find_interface_work(s, to_return);
    for (int k = 0; k < ACCOUNT_ENTRIES; k++) {
        const bool solid = k >= account_entry(KIND_SOLID, 0);
        const double more = own_energy(&of[k]) - a->put[k];
        terms[TERM_FLUID][k] = solid ? 0 : more;
        terms[TERM_SOLID][k] = solid ? more : 0;
        terms[TERM_DISSIPATION][k] = a->spent[k] + of[k].damper;
        terms[TERM_INTERFACE][k] =
            solid ? a->exchange[k] - to_return[k - account_entry(KIND_SOLID, 0)] : 0;
        terms[TERM_RESTARTS][k] = a->restarts[k];
        terms[TERM_ALL][k] = terms[TERM_FLUID][k] + terms[TERM_SOLID][k] +
                             terms[TERM_DISSIPATION][k] + terms[TERM_INTERFACE][k] +
                             terms[TERM_RESTARTS][k] + a->dummies[k] + of[k].repulsion;
    }
}

void account_begin(struct simulation *s)
{
    struct account *const a = &s->state.account;
    struct energies of[ACCOUNT_ENTRIES];
    memset(a, 0, sizeof *a);
    find_energies(s, of);
    a->open = s->effects & FX_OPEN ? open_energy(&s->open) : 0;
    a->checked_at = s->state.time;
    double contact = 0;
    find_interface_work(s, &a->exchange[account_entry(KIND_SOLID, 0)]);
    for (int k = 0; k < ACCOUNT_ENTRIES; k++) {
        const double available = energy_without_potential(&of[k]);
        a->put[k] = own_energy(&of[k]);
        a->lowest[k] = of[k].potential;
        for (int t = 0; t < ACCOUNT_TERMS; t++) a->available[t][k] = available;
        a->low[TERM_ALL][k] = of[k].dummies + of[k].damper + of[k].repulsion;
        a->low[TERM_DISSIPATION][k] = of[k].damper;
        a->region[k] = k;
        contact += of[k].contact;
    }
    join_at_once(s, contact);
}

enum err account_check(const struct account *a, struct diag *d)
{
    for (int k = 0; k < ACCOUNT_ENTRIES; k++)
        if (!(a->region[k] >= 0 && a->region[k] <= k))
            return diag_fail(d, ERR_INPUT,
                             "checkpoint: section %d refers to region %g, which does not exist; "
                             "the file is damaged or not of this case",
                             k, a->region[k]);
    return ERR_OK;
}

void account_work(struct account *a, enum account_source source, enum kind kind, int section,
                  double work)
{
    const int k = account_entry(kind, section);
    a->put[k] += work;
    account_step(a, source, k, work);
}

void account_step(struct account *a, enum account_source source, int entry, double work)
{
    const double change = fabs(work - a->last[source][entry]);
    a->step_work[entry] = max2(a->step_work[entry], change);
    a->last[source][entry] = work;
}

/* --- the check --- */

/* Round-off of sums, and of strains and speeds, whose squares are energies (T-46). */
#define ROUND_OFF 1e-9

/* Sums over the sections of a region. */
struct region_sums {
    struct energies energies;
    double term[ACCOUNT_TERMS];
    double off; /* below which a gain is an error of the sums */
};

static struct region_sums sum_region(const struct account *a, int region, const struct energies *of,
                                     double terms[ACCOUNT_TERMS][ACCOUNT_ENTRIES])
{
    struct region_sums sum = {.off = 0};
    for (int k = 0; k < ACCOUNT_ENTRIES; k++) {
        if (region_of(a, k) != region) continue;
        add_energies(&sum.energies, &of[k]);
        for (int t = 0; t < ACCOUNT_TERMS; t++) sum.term[t] += terms[t][k];
        sum.off += a->step_work[k] + ROUND_OFF * (fabs(a->put[k]) + fabs(of[k].potential)) +
                   square(ROUND_OFF) * of[k].scale;
    }
    return sum;
}

/* A gain of all terms together by the largest of them, if that is half of it. The rest is the work
 * of dummies. */
static void name_cause(struct gain *g, const double gained[ACCOUNT_TERMS])
{
    int largest = TERM_FLUID;
    for (int t = 0; t < TERM_ALL; t++)
        if (gained[t] > gained[largest]) largest = t;
    if (g->term == TERM_ALL && gained[largest] >= 0.5 * g->energy)
        g->term = (enum account_term)largest;
}

/* Energy of a flow at a tenth of the speed of sound (Eq. 3), which open boundaries drive. Beside it the
 * energy at the start from rest says nothing. */
static double driven_energy(const struct simulation *s)
{
    if (!(s->effects & FX_OPEN)) return 0;
    return 0.5 * s->fluid.k.mass * (double)s->kind[KIND_FLUID].n * square(0.1 * s->fluid.k.c0);
}

/* The term of a region that has gained the largest fraction. */
static struct gain gain_of(struct account *a, int region, const struct region_sums *sum,
                           double driven)
{
    const struct energies *const e = &sum->energies;
    struct gain worst = {.entry = -1,
                         .available = 1,
                         .kinetic = e->kinetic,
                         .internal = e->internal,
                         .elastic = e->elastic,
                         .hourglass = e->hourglass};
    a->lowest[region] = min2(a->lowest[region], e->potential);
    const double active = driven + energy_without_potential(e) + e->potential - a->lowest[region];
    double gained[ACCOUNT_TERMS];
    a->top = max2(a->top, active);
    for (int t = 0; t < ACCOUNT_TERMS; t++) {
        /* Dummies may return what they hold. */
        const double now = sum->term[t], base = now + (t == TERM_ALL ? e->dummies : 0);
        if (base <= a->low[t][region]) {
            a->low[t][region] = base;
            a->available[t][region] = active;
        }
        a->available[t][region] = max2(a->available[t][region], active);
        const double available = a->available[t][region];
        const double more = gained[t] = now - a->low[t][region] - sum->off;
        a->most[t] = max2(a->most[t], more + sum->off);
        if (!(more > 0) || (worst.entry >= 0 && more * worst.available <= worst.energy * available))
            continue;
        worst.entry = region;
        worst.term = (enum account_term)t;
        worst.energy = more;
        worst.available = available;
    }
    const double all = gained[TERM_ALL] / a->available[TERM_ALL][region];
    worst.all = gained[TERM_ALL] > 0 ? all : 0;
    name_cause(&worst, gained);
    return worst;
}

struct gain account_gain(struct simulation *s)
{
    struct account *const a = &s->state.account;
    struct energies of[ACCOUNT_ENTRIES];
    double terms[ACCOUNT_TERMS][ACCOUNT_ENTRIES];
    struct gain worst = {.entry = -1, .available = 1};
    const double driven = driven_energy(s);
    find_energies(s, of);
    join_at_once(s, of[account_entry(KIND_SOLID, 0)].contact);
    join_neighbours(s);
    find_terms(s, of, terms);
    for (int t = 0; t < ACCOUNT_TERMS; t++) {
        a->now[t] = 0;
        for (int k = 0; k < ACCOUNT_ENTRIES; k++) a->now[t] += terms[t][k];
    }
    for (int k = 0; k < ACCOUNT_ENTRIES; k++) {
        if (region_of(a, k) != k) continue;
        const struct region_sums sum = sum_region(a, k, of, terms);
        const struct gain g = gain_of(a, k, &sum, in_region(a, KIND_FLUID, 0, k) ? driven : 0);
        if (g.entry >= 0 &&
            (worst.entry < 0 || g.energy * worst.available > worst.energy * g.available))
            worst = g;
    }
    return worst;
}

/* --- names in messages --- */

int account_name(const struct simulation *s, int entry, char text[ACCOUNT_TEXT])
{
    static const char *const words[KIND_COUNT] = {"fluid", "wall", "solid"};
    static const enum kind order[] = {KIND_SOLID, KIND_FLUID, KIND_WALL};
    size_t used = 0;
    int names = 0;
    text[0] = '\0';
    for (int o = 0; o < KIND_COUNT; o++)
        for (int k = 0; k < sections(s, order[o]); k++) {
            const int section = section_at_index(s, order[o], k);
            const char *const name = order[o] == KIND_SOLID   ? s->scene->solid[section].common.name
                                     : order[o] == KIND_FLUID ? s->scene->fluid[section].common.name
                                                              : s->scene->wall[section].common.name;
            if (!in_region(&s->state.account, order[o], section, entry) || used >= ACCOUNT_TEXT)
                continue;
            used += (size_t)snprintf(text + used, ACCOUNT_TEXT - used, "%s[%s %s]",
                                     used ? ", " : "", words[order[o]], name);
            names++;
        }
    return names;
}

bool account_fastest(const struct simulation *s, int entry, double at[2])
{
    double top = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct particles *const p = &s->kind[kind];
        if (kind == KIND_WALL) continue;
        for (int64_t i = 0; i < p->n; i++) {
            const double speed2 = square(p->vx[i]) + square(p->vy[i]);
            if (!(speed2 > top) ||
                !in_region(&s->state.account, (enum kind)kind, p->body[i], entry))
                continue;
            top = speed2;
            at[0] = p->x[i];
            at[1] = p->y[i];
        }
    }
    return top > 0;
}
