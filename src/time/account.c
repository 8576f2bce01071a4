/* SPDX-License-Identifier: MIT */
#include "time/account.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "fluid/eos.h"
#include "time/simulation.h"
#include "particles/kernel.h"

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
    a->high[first] += a->high[second];
    a->play[first] += a->play[second];
    for (int k = 0; k < ACCOUNT_ENTRIES; k++)
        if (region_of(a, k) == second) a->region[k] = first;
}

/* The smallest box around a section's particles, with a margin. */
struct box {
    double low[2], high[2];
};

static void widen(struct box *b, double x, double y, double margin)
{
    b->low[0] = min2(b->low[0], x - margin);
    b->low[1] = min2(b->low[1], y - margin);
    b->high[0] = max2(b->high[0], x + margin);
    b->high[1] = max2(b->high[1], y + margin);
}

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
        for (int64_t i = 0; i < p->n; i++)
            widen(&box[account_entry((enum kind)kind, p->body[i])], p->x[i], p->y[i], margin);
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

/* --- energies --- */

struct energies {
    double kinetic, potential, internal, elastic, hourglass, contact;
};

static double in_play(const struct energies *e)
{
    return e->kinetic + e->internal + e->elastic + e->hourglass + e->contact;
}

static void add_fluid(const struct simulation *s, struct energies *of)
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    const struct fluid_constants *const k = &s->fluid.k;
    for (int64_t i = 0; i < p->n; i++) {
        struct energies *const e = &of[account_entry(KIND_FLUID, p->body[i])];
        const double m = p->m ? k->mass * p->m[i] : k->mass;
        e->kinetic += 0.5 * m * (square(p->vx[i]) + square(p->vy[i]));
        e->potential -= m * (k->gravity[0] * p->x[i] + k->gravity[1] * p->y[i]);
        e->internal += m * eos_energy(p->dens[i], k->c0);
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
    }
    for (int k = 0; k < s->scene->n_solid; k++) {
        struct energies *const e = &of[account_entry(KIND_SOLID, k)];
        double det_low;
        solid_energy(&s->solid, p, k, &e->elastic, &e->hourglass, &det_low);
    }
}

/* Energies of the sections. The first solid carries the energy of contact of all. */
static void find_energies(const struct simulation *s, const struct ledger *now,
                          struct energies of[ACCOUNT_ENTRIES])
{
    memset(of, 0, ACCOUNT_ENTRIES * sizeof *of);
    if (s->effects & FX_FLUID) add_fluid(s, of);
    if (s->effects & FX_SOLID) add_solids(s, of);
    of[account_entry(KIND_SOLID, 0)].contact = now->contact;
}

void account_begin(struct simulation *s, const struct ledger *now)
{
    struct account *const a = &s->state.account;
    struct energies of[ACCOUNT_ENTRIES];
    memset(a, 0, sizeof *a);
    find_energies(s, now, of);
    for (int k = 0; k < ACCOUNT_ENTRIES; k++) {
        a->put[k] = in_play(&of[k]) + of[k].potential;
        a->play[k] = in_play(&of[k]);
        a->region[k] = k;
    }
    join_at_once(s, now->contact);
}

enum err account_check(const struct account *a, struct diag *d)
{
    for (int k = 0; k < ACCOUNT_ENTRIES; k++)
        if (!(a->region[k] >= 0 && a->region[k] <= k))
            return diag_fail(d, ERR_INPUT, "checkpoint: section %d is in region %g", k,
                             a->region[k]);
    return ERR_OK;
}

void account_work(struct account *a, enum kind kind, int section, double work)
{
    const int k = account_entry(kind, section);
    a->put[k] += work;
    a->step_work[k] = max2(a->step_work[k], fabs(work));
}

/* --- the check at a row --- */

/* Round-off of the sums (T-46). */
#define ROUND_OFF 1e-9

static struct gain gain_of(struct account *a, int region, const struct energies *of)
{
    struct energies sum = {0};
    double put = 0, size = 0, late = 0;
    for (int k = 0; k < ACCOUNT_ENTRIES; k++) {
        if (region_of(a, k) != region) continue;
        put += a->put[k];
        size += fabs(a->put[k]) + fabs(of[k].potential);
        late += a->step_work[k];
        sum.kinetic += of[k].kinetic;
        sum.potential += of[k].potential;
        sum.internal += of[k].internal;
        sum.elastic += of[k].elastic;
        sum.hourglass += of[k].hourglass;
        sum.contact += of[k].contact;
    }
    const double active = in_play(&sum), lost = put - active - sum.potential;
    if (lost >= a->high[region]) {
        a->high[region] = lost;
        a->play[region] = active;
    }
    a->play[region] = max2(a->play[region], active);
    const double off = late + ROUND_OFF * size, gained = a->high[region] - lost - off;
    return (struct gain){
        .entry = gained > 0 ? region : -1,
        .energy = gained,
        .play = a->play[region],
        .net = -lost - off,
        .kinetic = sum.kinetic,
        .internal = sum.internal,
        .elastic = sum.elastic,
        .hourglass = sum.hourglass,
    };
}

/* The power at the end of a step is counted with the next step. So fluid that a wall has just
 * touched has its energy before any work of the wall is counted. */
static void look_ahead(struct simulation *s)
{
    for (int k = 0; k < s->wall_motion.n; k++) {
        const struct moving_wall *const b = &s->wall_motion.body[k];
        double *const step_work = &s->state.account.step_work[account_entry(KIND_WALL, b->section)];
        const double power = moving_body_power(b, &s->kind[KIND_WALL]);
        *step_work = max2(*step_work, s->state.dt * fabs(power));
    }
}

struct gain account_look(struct simulation *s, const struct ledger *now)
{
    struct account *const a = &s->state.account;
    struct energies of[ACCOUNT_ENTRIES];
    struct gain worst = {.entry = -1, .play = 1};
    join_at_once(s, now->contact);
    join_neighbours(s);
    if (s->effects & FX_FLUID) look_ahead(s);
    find_energies(s, now, of);
    /* The energy that open boundaries bring in is less accurate than a gain (T-46): no check. */
    const int open = s->effects & FX_OPEN ? region_of(a, account_entry(KIND_FLUID, 0)) : -1;
    for (int k = 0; k < ACCOUNT_ENTRIES; k++) {
        if (region_of(a, k) != k || k == open) continue;
        const struct gain g = gain_of(a, k, of);
        if (g.entry >= 0 && (worst.entry < 0 || g.energy * worst.play > worst.energy * g.play))
            worst = g;
    }
    return worst;
}

/* --- names in messages --- */

void account_name(const struct simulation *s, int entry, char text[ACCOUNT_TEXT])
{
    static const char *const words[KIND_COUNT] = {"fluid", "wall", "solid"};
    static const enum kind order[] = {KIND_SOLID, KIND_FLUID, KIND_WALL};
    size_t used = 0;
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
        }
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
