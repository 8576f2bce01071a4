/* SPDX-License-Identifier: MIT */
#include "output/ranges.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum err range_check(const char *name, double value, double low, double high, struct diag *d)
{
    if (value >= low && value <= high) return ERR_OK;
    return diag_fail(d, ERR_INPUT,
                     "checkpoint: %s = %g is outside the valid range %g to %g; the file is damaged "
                     "or not of this case",
                     name, value, low, high);
}

static enum err check_state(const struct simulation *sim, struct diag *d)
{
    const struct state *const st = &sim->state;
#define STATE(type, name, low, high, unit, meaning) \
    TRY(range_check(#name, (double)st->name, low, high, d));
#include "time/state.def"
#undef STATE
    for (int k = 0; k < BOUND_COUNT; k++)
        TRY(range_check("bound_steps", (double)st->bound_steps[k], 0, COUNTS, d));
    if (!(sim->effects & FX_SOLID)) return ERR_OK;
    /* The solid's step is divided and multiplied by them. */
    TRY(range_check("solid_stiffening", st->solid_stiffening, 1e-9, 1e9, d));
    return range_check("solid_slowing", st->solid_slowing, 1e-9, 1e9, d);
}

static enum err check_energy(const struct energy_account *account, struct diag *d)
{
    const double *const number = (const double *)(const void *)account;
    for (size_t k = 0; k < ENERGY_NUMBERS; k++)
        TRY(range_check("energy", number[k], -FINITE, FINITE, d));
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        TRY(range_check("energy", account->entry[k].work_change, 0, FINITE, d));
        TRY(range_check("energy", account->entry[k].region, -1, k, d));
    }
    return ERR_OK;
}

static enum err check_fields(const struct particles *particles, enum kind kind, struct diag *d)
{
    for (int f = 0; f < field_count; f++) {
        const struct field_info *const info = &field_table[f];
        const double *const data = field_array(particles, info);
        if (!data || info->keep != KEEP_STATE || strcmp(info->type, "double") != 0) continue;
        for (int64_t i = 0; i < particles->n; i++)
            if (!(fabs(data[i]) <= FINITE))
                return diag_fail(d, ERR_INPUT,
                                 "checkpoint: block %s holds %g for %s particle %" PRId64
                                 ", which is not a finite number; the file is damaged",
                                 info->name, data[i], kind_names[kind], i);
    }
    return ERR_OK;
}

/* Numbers that serve as an index. */
static enum err check_bodies(const struct simulation *sim, enum kind kind, struct diag *d)
{
    const int bodies[KIND_COUNT] = {sim->scene->n_fluid, sim->scene->n_wall, sim->scene->n_solid};
    const struct particles *particles = &sim->kind[kind];
    for (int64_t i = 0; i < particles->n; i++)
        if (particles->body[i] < 0 || particles->body[i] >= bodies[kind])
            return diag_fail(d, ERR_INPUT,
                             "checkpoint: %s particle %" PRId64 " belongs to section %d, but the "
                             "case has sections 0 to %d",
                             kind_names[kind], i, particles->body[i], bodies[kind] - 1);
    return ERR_OK;
}

static enum err check_open(const struct open *o, struct diag *d)
{
    if (o->n == 0) return ERR_OK;
    for (int k = 0; k < o->n; k++) {
        for (int c = 0; c < OPEN_SUMS; c++)
            if (c != OPEN_MEAN_FLOW || !isnan(o->sum[k][c]))
                TRY(range_check("open_sum", o->sum[k][c], -FINITE, FINITE, d));
        for (int c = 0; c < OPEN_COUNTS; c++)
            TRY(range_check("open_count", (double)o->count[k][c], 0, COUNTS, d));
    }
    return range_check("open_next_id", (double)o->next_id, 0, COUNTS, d);
}

enum err ranges_check(const struct simulation *sim, struct diag *d)
{
    for (int k = 0; k < KIND_COUNT; k++) {
        TRY(check_bodies(sim, (enum kind)k, d));
        TRY(check_fields(&sim->kind[k], (enum kind)k, d));
    }
    TRY(check_open(&sim->open, d));
    for (int k = 0; k < sim->damping.n; k++)
        TRY(range_check("damping", sim->damping.taken[k], 0, FINITE, d));
    for (int k = 0; k < sim->rigid.n * RIGID_NUMBERS; k++)
        TRY(range_check("rigid", ((const double *)sim->rigid.state)[k], -FINITE, FINITE, d));
    for (int k = 0; k < sim->beams.n_nodes * BEAM_NUMBERS; k++)
        TRY(range_check("beams", ((const double *)sim->beams.state)[k], -FINITE, FINITE, d));
    TRY(check_state(sim, d));
    return check_energy(&sim->state.energy, d);
}
