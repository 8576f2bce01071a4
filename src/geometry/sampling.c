/* SPDX-License-Identifier: MIT
 * Sampling of shapes: particles are the centres of the cells of a square lattice. A centre within
 * 1e-6 dp of an edge counts as above and to the right of it, for any rounding error. So shapes with
 * a common edge neither miss nor double a particle. */
#include "geometry/layers.h"
#include "geometry/load.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Approximate bytes of a particle, to refuse absurd cases: fields, neighbour lists and copies. */
static const double bytes_per_particle = 300;
static const double max_lattice = 1e9, max_cells = 1e10;

/* --- regions --- */

static double piece_area(const struct outline *o)
{
    if (!o->n) return PI * square(o->radius);
    double twice = 0;
    for (int k = 0; k < o->n; k++) {
        const double *a = o->pt[k], *b = o->pt[(k + 1) % o->n], *base = o->pt[0];
        twice += (a[0] - base[0]) * (b[1] - base[1]) - (b[0] - base[0]) * (a[1] - base[1]);
    }
    return 0.5 * fabs(twice);
}

/* Refuses scenes that do not fit into memory before allocating anything of that size. */
static enum err check_size(struct sampler *g)
{
    const double dp = g->scene->top.dp;
    double total = 0, cells = 0;
    for (int k = 0; k < g->n_regions; k++) {
        const struct region *region = &g->regions[k];
        const double own = region->lattice.dp;
        for (int j = 0; j < region->add.n; j++)
            total += piece_area(&region->add.item[j]) / square(own);
        double wide[2];
        for (int c = 0; c < 2; c++) {
            const double low = fabs(region->box.low[c] - region->lattice.origin[c]) / own;
            const double high = fabs(region->box.high[c] - region->lattice.origin[c]) / own;
            wide[c] = (region->box.high[c] - region->box.low[c]) / own + 3;
            if (low > max_lattice || high > max_lattice) cells = HUGE_VAL;
        }
        cells += wide[0] * wide[1];
    }
    const double pages = (double)sysconf(_SC_PHYS_PAGES), page = (double)sysconf(_SC_PAGESIZE);
    const double memory = pages > 0 && page > 0 ? pages * page : 1e18;
    const double bytes = total * bytes_per_particle;
    if (total > 1e9 || bytes > memory)
        return diag_add(
            g->diag, ERR_INPUT,
            "%s: dp = %g m gives about %.3g particles, which need %.3g GB. This machine has %.3g "
            "GB, and the limit is 1e9 particles; use a larger dp or smaller shapes",
            g->scene->path, dp, total, 1e-9 * bytes, 1e-9 * memory);
    if (cells > max_cells)
        return diag_add(g->diag, ERR_INPUT,
                        "%s: the shapes span more than %g cells of dp = %g m; use a larger dp or "
                        "smaller shapes",
                        g->scene->path, max_cells, dp);
    return ERR_OK;
}

static enum err add_region(struct sampler *g, enum kind kind, int body,
                           const struct scene_section_common *common,
                           const struct shape_list *shape, const struct shape_list *minus)
{
    struct region *region = &g->regions[g->n_regions++];
    *region = (struct region){.kind = kind,
                              .body = body,
                              .name = common->name,
                              .line = common->line,
                              .list = shape,
                              .minus_list = minus};
    if (shape->n == 0)
        return fail_at(g->diag, g->scene, common->line, "[%s %s] has no shape", kind_names[kind],
                       common->name);
    TRY(outlines_of(&region->add, g->scene, shape, &g->temp, g->diag));
    return outlines_of(&region->minus, g->scene, minus, &g->temp, g->diag);
}

static enum err list_regions(struct sampler *g)
{
    const struct scene *s = g->scene;
    const int n = s->n_solid + s->n_wall + s->n_fluid;
    g->regions = arena_alloc(&g->temp, (size_t)n, sizeof *g->regions, "regions", g->diag);
    if (!g->regions) return ERR_MEMORY;
    for (int k = 0; k < s->n_solid; k++)
        TRY(add_region(g, KIND_SOLID, k, &s->solid[k].common, &s->solid[k].shape,
                       &s->solid[k].minus));
    for (int k = 0; k < s->n_wall; k++)
        TRY(add_region(g, KIND_WALL, k, &s->wall[k].common, &s->wall[k].shape, &s->wall[k].minus));
    for (int k = 0; k < s->n_fluid; k++)
        TRY(add_region(g, KIND_FLUID, k, &s->fluid[k].common, &s->fluid[k].shape,
                       &s->fluid[k].minus));
    return ERR_OK;
}

/* Rotates shapes into the axes of their lattices. */
static enum err turn_regions(struct sampler *g)
{
    for (int k = 0; k < g->n_regions; k++) {
        struct region *const region = &g->regions[k];
        TRY(outlines_turn(&region->add, region->lattice.angle, &g->temp, g->diag));
        TRY(outlines_turn(&region->minus, region->lattice.angle, &g->temp, g->diag));
        region->box = box2_empty();
        for (int j = 0; j < region->add.n; j++) {
            const struct outline *const piece = &region->add.item[j];
            box2_include(&region->box, piece->low[0], piece->low[1]);
            box2_include(&region->box, piece->high[0], piece->high[1]);
        }
        TRY(layers_find(g, region));
    }
    return ERR_OK;
}

/* --- rows --- */

/* The first lattice index with its centre at or beyond x. */
static int64_t index_from(const struct region *region, int c, double x)
{
    const struct scene_lattice *const l = &region->lattice;
    return (int64_t)ceil((x - l->origin[c]) / l->spacing[c] - 0.5 - NUDGE_X);
}

static double centre(const struct region *region, int c, int64_t index)
{
    return region->lattice.origin[c] + ((double)index + 0.5) * region->lattice.spacing[c];
}

/* x, limited to the region's left and right end. */
static double inside(const struct region *region, double x)
{
    return min2(max2(x, region->box.low[0]), region->box.high[0]);
}

/* Marks a row's points inside a piece with `value`; returns their number. */
static int64_t mark(struct sampler *g, const struct region *region, const struct outline *o,
                    double y, unsigned char value)
{
    if (y < o->low[1] || y > o->high[1]) return 0;
    const int n = outline_crossings(o, y, g->scratch);
    int64_t marked = 0;
    for (int k = 0; k + 1 < n; k += 2) {
        const int64_t from = index_from(region, 0, inside(region, g->scratch[k]));
        const int64_t to = index_from(region, 0, inside(region, g->scratch[k + 1]));
        if (to <= from) continue;
        memset(g->mask + (from - region->first[0]), value, (size_t)(to - from));
        marked += to - from;
    }
    return marked;
}

/* Fills the mask for row j from pieces in layers or the others; optionally counts the points in
 * each shape. */
static void mark_row(struct sampler *g, const struct region *region, int64_t j, bool with_layered,
                     int64_t *per_shape)
{
    const double y = centre(region, 1, j) + NUDGE_Y * region->lattice.spacing[1];
    memset(g->mask, 0, (size_t)region->count[0]);
    for (int k = 0; k < region->add.n; k++) {
        if (region->layered[k] && !with_layered) continue;
        const int64_t marked = mark(g, region, &region->add.item[k], y, 1);
        if (per_shape) per_shape[region->add.shape[k]] += marked;
    }
    for (int k = 0; k < region->minus.n; k++) mark(g, region, &region->minus.item[k], y, 0);
}

static enum err prepare_rows(struct sampler *g)
{
    int64_t widest = 1;
    int most = 2;
    for (int k = 0; k < g->n_regions; k++) {
        struct region *region = &g->regions[k];
        for (int c = 0; c < 2; c++) {
            region->first[c] = index_from(region, c, region->box.low[c]) - 1;
            region->count[c] = index_from(region, c, region->box.high[c]) + 1 - region->first[c];
        }
        widest = region->count[0] > widest ? region->count[0] : widest;
        const int add = outlines_capacity(&region->add), minus = outlines_capacity(&region->minus);
        most = add > most ? add : most;
        most = minus > most ? minus : most;
    }
    for (int k = 0; k < g->scene->n_solid; k++)
        for (int j = 0; j < g->scene->solid[k].clamp.n; j++)
            most = g->scene->solid[k].clamp.item[j].n > most ? g->scene->solid[k].clamp.item[j].n
                                                             : most;
    g->mask = arena_alloc(&g->temp, (size_t)widest, 1, "sampling", g->diag);
    g->scratch = arena_alloc(&g->temp, (size_t)most + 4, sizeof(double), "sampling", g->diag);
    return g->mask && g->scratch ? ERR_OK : ERR_MEMORY;
}

/* The points of a wall with layers: the lattice in the pieces along it, then the layers, then the
 * lattice behind them. */
static enum err lay_layers(struct sampler *g, struct region *region)
{
    struct layers l;
    TRY(layers_create(&l, g, region));
    for (int behind = 0; behind < 2; behind++) {
        for (int64_t j = region->first[1]; j < region->first[1] + region->count[1]; j++) {
            mark_row(g, region, j, behind, NULL);
            for (int64_t i = 0; i < region->count[0]; i++) {
                if (!g->mask[i]) continue;
                const double x = centre(region, 0, region->first[0] + i), y = centre(region, 1, j);
                TRY(behind ? layers_fill(&l, x, y) : layers_take(&l, x, y));
            }
        }
        if (!behind) TRY(layers_trace(&l));
    }
    region->n = l.points.n;
    region->n_layered = l.points.n - l.first;
    if (region->n_layered > 0) {
        region->layer_x = l.points.x + l.first;
        region->layer_y = l.points.y + l.first;
    }
    return ERR_OK;
}

/* Shapes without particles are told together, before anything needs their particles. */
static enum err count_points(struct sampler *g, struct region *region)
{
    int64_t *per_shape =
        arena_alloc(&g->temp, (size_t)region->list->n, sizeof *per_shape, "sampling", g->diag);
    if (!per_shape) return ERR_MEMORY;
    for (int64_t j = 0; j < region->count[1]; j++) {
        mark_row(g, region, region->first[1] + j, true, per_shape);
        for (int64_t i = 0; i < region->count[0]; i++) region->n += g->mask[i];
    }
    if (region->has_layers) TRY(lay_layers(g, region));
    bool empty = false;
    for (int k = 0; k < region->list->n; k++) {
        if (per_shape[k]) continue;
        empty = true;
        TRY(geometry_go_on(
            g, fail_at(g->diag, g->scene, region->list->item[k].line,
                       "shape %d of [%s %s] contains no particle, because it is narrower "
                       "than dp = %g m or lies between lattice points; enlarge or move it",
                       k + 1, kind_names[region->kind], region->name, region->lattice.dp)));
    }
    if (region->n || empty) return ERR_OK;
    return geometry_go_on(g, fail_at(g->diag, g->scene, region->line,
                                     "nothing is left of [%s %s] after its `minus`",
                                     kind_names[region->kind], region->name));
}

/* Stores a point given in the axes of its lattice. */
static void put_point(const struct sampler *g, const struct region *region, struct samples *p,
                      int64_t k, double x, double y)
{
    double at[2];
    place_of_lattice(&region->lattice, x, y, at);
    p->x[k] = at[0];
    p->y[k] = at[1];
    p->region[k] = (int32_t)(region - g->regions);
}

/* Appends a region's points: row by row, or column by column with `upright`. */
static enum err append_points(struct sampler *g, const struct region *region, bool upright,
                              struct samples *p)
{
    int64_t *next = NULL;
    if (upright) { /* position of each column: a counting sort over the rows */
        next =
            arena_alloc(&g->temp, (size_t)region->count[0] + 1, sizeof *next, "sampling", g->diag);
        if (!next) return ERR_MEMORY;
        for (int64_t j = 0; j < region->count[1]; j++) {
            mark_row(g, region, region->first[1] + j, false, NULL);
            for (int64_t i = 0; i < region->count[0]; i++) next[i + 1] += g->mask[i];
        }
        for (int64_t i = 0; i < region->count[0]; i++) next[i + 1] += next[i];
    }
    int64_t filled = 0;
    for (int64_t j = 0; j < region->count[1]; j++) {
        mark_row(g, region, region->first[1] + j, false, NULL);
        for (int64_t i = 0; i < region->count[0]; i++) {
            if (!g->mask[i]) continue;
            const int64_t k = p->n + (upright ? next[i]++ : filled);
            put_point(g, region, p, k, centre(region, 0, region->first[0] + i),
                      centre(region, 1, region->first[1] + j));
            filled++;
        }
    }
    p->n += filled;
    for (int64_t k = 0; k < region->n_layered; k++)
        put_point(g, region, p, p->n++, region->layer_x[k], region->layer_y[k]);
    return ERR_OK;
}

enum err geometry_sample(struct sampler *g, struct samples *p)
{
    TRY(list_regions(g));
    TRY(geometry_choose_lattices(g));
    TRY(turn_regions(g));
    TRY(check_size(g));
    TRY(prepare_rows(g));
    int64_t total = 0;
    for (int k = 0; k < g->n_regions; k++) {
        TRY(count_points(g, &g->regions[k]));
        total += g->regions[k].n;
    }
    TRY(geometry_problems(g));
    p->x = arena_alloc(&g->temp, (size_t)total, sizeof *p->x, "sampling", g->diag);
    p->y = arena_alloc(&g->temp, (size_t)total, sizeof *p->y, "sampling", g->diag);
    p->region = arena_alloc(&g->temp, (size_t)total, sizeof *p->region, "sampling", g->diag);
    p->clamped = arena_alloc(&g->temp, (size_t)total, 1, "sampling", g->diag);
    if (!p->x || !p->y || !p->region || !p->clamped) return ERR_MEMORY;
    for (int k = 0; k < g->n_regions; k++) {
        struct region *region = &g->regions[k];
        const int64_t from = p->n;
        const bool upright = region->kind == KIND_SOLID && region->count[1] > region->count[0];
        TRY(append_points(g, region, upright, p));
        if (region->kind == KIND_SOLID) TRY(geometry_clamp(g, region, from, p));
    }
    return ERR_OK;
}

enum err geometry_draw(struct sampler *g)
{
    TRY(list_regions(g));
    for (int k = 0; k < g->n_regions; k++)
        g->regions[k].lattice = g->regions[k].kind == KIND_SOLID
                                    ? g->scene->solid_lattice[g->regions[k].body]
                                    : g->scene->lattice;
    TRY(turn_regions(g));
    return prepare_rows(g);
}

enum err scene_sample(struct scene *s, struct diag *d)
{
    struct sampler g = {.scene = s, .diag = d};
    struct samples points = {0};
    s->h = s->numerics.h_over_dp * s->top.dp;
    enum err err = geometry_sample(&g, &points);
    if (!err) err = geometry_check_bodies(&g);
    if (!err) err = geometry_problems(&g);
    if (!err) err = geometry_merge(&g, &points);
    if (!err) err = geometry_pack(&g);
    if (!err) err = geometry_open(&g);
    if (!err) err = geometry_extent(&g);
    if (!err) err = geometry_check_joined(&g);
    if (!err) err = geometry_problems(&g);
    arena_free(&g.temp);
    return err;
}
