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
    return o->n ? fabs(polygon_area(o->n, o->pt)) : PI * square(o->radius);
}

/* Refuses scenes that do not fit into memory before allocating anything of that size. */
static enum err check_size(struct sampler *sampler)
{
    const double dp = sampler->scene->top.dp;
    double total = 0, cells = 0;
    for (int k = 0; k < sampler->n_regions; k++) {
        const struct region *region = &sampler->regions[k];
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
            sampler->diag, ERR_INPUT,
            "%s: dp = %g m gives about %.3g particles, which need %.3g GB. This machine has %.3g "
            "GB, and the limit is 1e9 particles; use a larger dp or smaller shapes",
            sampler->scene->path, dp, total, 1e-9 * bytes, 1e-9 * memory);
    if (cells > max_cells)
        return diag_add(sampler->diag, ERR_INPUT,
                        "%s: the shapes span more than %g cells of dp = %g m; use a larger dp or "
                        "smaller shapes",
                        sampler->scene->path, max_cells, dp);
    return ERR_OK;
}

static void add_region(struct sampler *sampler, enum kind kind, int body,
                       const struct scene_section_common *common, const struct shape_list *shape,
                       const struct shape_list *minus)
{
    sampler->regions[sampler->n_regions++] =
        (struct region){.kind = kind,
                        .body = body,
                        .word = section_table[common->section].word,
                        .name = common->name,
                        .line = common->line,
                        .list = shape,
                        .minus_list = minus};
}

static enum err draw_region(struct sampler *sampler, struct region *region)
{
    TRY(outlines_of(&region->add, sampler->scene, region->list, &sampler->temp, sampler->diag));
    return outlines_of(&region->minus, sampler->scene, region->minus_list, &sampler->temp,
                       sampler->diag);
}

/* Fluid is drawn before the walls beside it, and these have their thickness before joints are. */
static enum err list_regions(struct sampler *sampler)
{
    const struct scene *scene = sampler->scene;
    const int n_wall = scene->n_fluid ? scene->n_wall : scene_beam_wall(scene, 0),
              n = scene->n_solid + n_wall + scene->n_fluid;
    sampler->regions = geometry_alloc(sampler, (size_t)n, sizeof *sampler->regions);
    if (!sampler->regions) return ERR_MEMORY;
    for (int k = 0; k < scene->n_solid; k++)
        add_region(sampler, KIND_SOLID, k, &scene->solid[k].common, &scene->solid[k].shape,
                   &scene->solid[k].minus);
    for (int k = 0; k < n_wall; k++)
        add_region(sampler, KIND_WALL, k, &scene->wall[k].common, &scene->wall[k].shape,
                   &scene->wall[k].minus);
    for (int k = 0; k < scene->n_fluid; k++)
        add_region(sampler, KIND_FLUID, k, &scene->fluid[k].common, &scene->fluid[k].shape,
                   &scene->fluid[k].minus);
    for (int k = n - scene->n_fluid; k < n; k++) TRY(draw_region(sampler, &sampler->regions[k]));
    for (int k = scene->n_solid; k < n - scene->n_fluid; k++)
        TRY(geometry_thicken(sampler, &sampler->regions[k]));
    for (int k = 0; k < n - scene->n_fluid; k++) TRY(draw_region(sampler, &sampler->regions[k]));
    for (int k = 0; k < scene->n_rigid; k++)
        TRY(geometry_rigid_mass(sampler, k,
                                &sampler->regions[scene->n_solid + scene_rigid_wall(scene, k)]));
    return ERR_OK;
}

/* Rotates shapes into the axes of their lattices. */
static enum err turn_regions(struct sampler *sampler)
{
    for (int k = 0; k < sampler->n_regions; k++) {
        struct region *const region = &sampler->regions[k];
        TRY(outlines_turn(&region->add, region->lattice.angle, &sampler->temp, sampler->diag));
        TRY(outlines_turn(&region->minus, region->lattice.angle, &sampler->temp, sampler->diag));
        region->box = region->add.box;
        if (region->add.n == 0) /* thin lines only: one point, and nothing is there */
            for (int c = 0; c < 2; c++)
                region->box.low[c] = region->box.high[c] = region->lattice.origin[c];
        TRY(layers_find(sampler, region));
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
static int64_t mark(struct sampler *sampler, const struct region *region, const struct outline *o,
                    double y, unsigned char value)
{
    if (y < o->box.low[1] || y > o->box.high[1]) return 0;
    const int n = outline_crossings(o, y, sampler->scratch);
    int64_t marked = 0;
    for (int k = 0; k + 1 < n; k += 2) {
        const int64_t from = index_from(region, 0, inside(region, sampler->scratch[k]));
        const int64_t to = index_from(region, 0, inside(region, sampler->scratch[k + 1]));
        if (to <= from) continue;
        memset(sampler->mask + (from - region->first[0]), value, (size_t)(to - from));
        marked += to - from;
    }
    return marked;
}

/* Fills the mask for row j from pieces in layers or the others; optionally counts the points in
 * each shape. */
static void mark_row(struct sampler *sampler, const struct region *region, int64_t j,
                     bool with_layered, int64_t *per_shape)
{
    const double y = centre(region, 1, j) + NUDGE_Y * region->lattice.spacing[1];
    memset(sampler->mask, 0, (size_t)region->count[0]);
    for (int k = 0; k < region->add.n; k++) {
        if (region->layered[k] && !with_layered) continue;
        const int64_t marked = mark(sampler, region, &region->add.item[k], y, 1);
        if (per_shape) per_shape[region->add.shape[k]] += marked;
    }
    for (int k = 0; k < region->minus.n; k++) mark(sampler, region, &region->minus.item[k], y, 0);
}

static enum err prepare_rows(struct sampler *sampler)
{
    int64_t widest = 1;
    int most = 2;
    for (int k = 0; k < sampler->n_regions; k++) {
        struct region *region = &sampler->regions[k];
        for (int c = 0; c < 2; c++) {
            region->first[c] = index_from(region, c, region->box.low[c]) - 1;
            region->count[c] = index_from(region, c, region->box.high[c]) + 1 - region->first[c];
        }
        widest = region->count[0] > widest ? region->count[0] : widest;
        const int ends = outlines_ends(&region->add) + outlines_ends(&region->minus);
        most = ends > most ? ends : most;
    }
    sampler->mask = geometry_alloc(sampler, (size_t)widest, 1);
    sampler->scratch = geometry_alloc(sampler, (size_t)most + 4, sizeof(double));
    return sampler->mask && sampler->scratch ? ERR_OK : ERR_MEMORY;
}

/* The points of a wall with layers: the lattice in the pieces along it, then the layers, then the
 * lattice behind them. */
static enum err lay_layers(struct sampler *sampler, struct region *region)
{
    struct layers l;
    TRY(layers_create(&l, sampler, region));
    for (int behind = 0; behind < 2; behind++) {
        for (int64_t j = region->first[1]; j < region->first[1] + region->count[1]; j++) {
            mark_row(sampler, region, j, behind, NULL);
            for (int64_t i = 0; i < region->count[0]; i++) {
                if (!sampler->mask[i]) continue;
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

/* Shapes without particles are reported together, before anything needs their particles. */
static enum err count_points(struct sampler *sampler, struct region *region)
{
    int64_t *per_shape = geometry_alloc(sampler, (size_t)region->list->n, sizeof *per_shape);
    if (!per_shape) return ERR_MEMORY;
    for (int64_t j = 0; j < region->count[1]; j++) {
        mark_row(sampler, region, region->first[1] + j, true, per_shape);
        for (int64_t i = 0; i < region->count[0]; i++) region->n += sampler->mask[i];
    }
    if (region->has_layers) TRY(lay_layers(sampler, region));
    if (region->kind == KIND_WALL) region->n += geometry_thin_count(sampler->scene, region->body);
    bool empty = false;
    for (int k = 0; k < region->list->n; k++) {
        if (per_shape[k] || region->list->item[k].thin) continue;
        empty = true;
        TRY(geometry_refuse(sampler, region->list->item[k].line,
                            "shape %d of [%s %s] contains no particle, because it is narrower "
                            "than dp = %g m or lies between lattice points; enlarge or move it",
                            k + 1, region->word, region->name, region->lattice.dp));
    }
    if (region->n || empty) return ERR_OK;
    return geometry_refuse(sampler, region->line, "nothing is left of [%s %s] after its `minus`",
                           region->word, region->name);
}

/* Stores a point given in the axes of its lattice. */
static void put_point(const struct sampler *sampler, const struct region *region,
                      struct samples *samples, int64_t k, double x, double y)
{
    double at[2];
    place_of_lattice(&region->lattice, x, y, at);
    samples->x[k] = at[0];
    samples->y[k] = at[1];
    samples->region[k] = (int32_t)(region - sampler->regions);
}

/* Appends a region's points: row by row, or column by column with `upright`. */
static enum err append_points(struct sampler *sampler, const struct region *region, bool upright,
                              struct samples *samples)
{
    int64_t *next = NULL;
    if (upright) { /* position of each column: a counting sort over the rows */
        next = geometry_alloc(sampler, (size_t)region->count[0] + 1, sizeof *next);
        if (!next) return ERR_MEMORY;
        for (int64_t j = 0; j < region->count[1]; j++) {
            mark_row(sampler, region, region->first[1] + j, false, NULL);
            for (int64_t i = 0; i < region->count[0]; i++) next[i + 1] += sampler->mask[i];
        }
        for (int64_t i = 0; i < region->count[0]; i++) next[i + 1] += next[i];
    }
    int64_t filled = 0;
    for (int64_t j = 0; j < region->count[1]; j++) {
        mark_row(sampler, region, region->first[1] + j, false, NULL);
        for (int64_t i = 0; i < region->count[0]; i++) {
            if (!sampler->mask[i]) continue;
            const int64_t k = samples->n + (upright ? next[i]++ : filled);
            put_point(sampler, region, samples, k, centre(region, 0, region->first[0] + i),
                      centre(region, 1, region->first[1] + j));
            filled++;
        }
    }
    samples->n += filled;
    for (int64_t k = 0; k < region->n_layered; k++)
        put_point(sampler, region, samples, samples->n++, region->layer_x[k], region->layer_y[k]);
    return ERR_OK;
}

/* An error if there was bad input. */
static enum err problems_found(const struct sampler *sampler)
{
    return sampler->problems ? ERR_INPUT : ERR_OK;
}

static void append_thin(const struct sampler *sampler, const struct region *region,
                        struct samples *samples)
{
    const int64_t n = geometry_thin_count(sampler->scene, region->body);
    geometry_thin_points(sampler->scene, region->body, samples->x + samples->n,
                         samples->y + samples->n);
    for (int64_t k = 0; k < n; k++) {
        samples->region[samples->n] = (int32_t)(region - sampler->regions);
        samples->thin[samples->n++] = 1;
    }
}

static enum err sample_regions(struct sampler *sampler, struct samples *samples)
{
    TRY(list_regions(sampler));
    TRY(geometry_thin(sampler));
    TRY(geometry_choose_lattices(sampler));
    TRY(turn_regions(sampler));
    TRY(check_size(sampler));
    TRY(prepare_rows(sampler));
    int64_t total = 0;
    for (int k = 0; k < sampler->n_regions; k++) {
        TRY(count_points(sampler, &sampler->regions[k]));
        total += sampler->regions[k].n;
    }
    TRY(problems_found(sampler));
    samples->x = geometry_alloc(sampler, (size_t)total, sizeof *samples->x);
    samples->y = geometry_alloc(sampler, (size_t)total, sizeof *samples->y);
    samples->region = geometry_alloc(sampler, (size_t)total, sizeof *samples->region);
    samples->clamped = geometry_alloc(sampler, (size_t)total, 1);
    samples->thin = geometry_alloc(sampler, (size_t)total, 1);
    if (!samples->x || !samples->y || !samples->region || !samples->clamped || !samples->thin)
        return ERR_MEMORY;
    for (int k = 0; k < sampler->n_regions; k++) {
        struct region *region = &sampler->regions[k];
        const int64_t from = samples->n;
        const bool upright = region->kind == KIND_SOLID && region->count[1] > region->count[0];
        TRY(append_points(sampler, region, upright, samples));
        if (region->kind == KIND_SOLID) TRY(geometry_clamp(sampler, region, from, samples));
        if (region->kind == KIND_WALL) append_thin(sampler, region, samples);
    }
    return ERR_OK;
}

enum err geometry_draw(struct sampler *sampler)
{
    TRY(list_regions(sampler));
    for (int k = 0; k < sampler->n_regions; k++)
        sampler->regions[k].lattice = sampler->regions[k].kind == KIND_SOLID
                                          ? sampler->scene->solid_lattice[sampler->regions[k].body]
                                          : sampler->scene->lattice;
    TRY(turn_regions(sampler));
    return prepare_rows(sampler);
}

enum err scene_sample(struct scene *scene, struct diag *d)
{
    struct sampler sampler = {.scene = scene, .diag = d};
    struct samples points = {0};
    scene->h = scene->numerics.h_over_dp * scene->top.dp;
    enum err err = sample_regions(&sampler, &points);
    if (!err) err = geometry_check_bodies(&sampler);
    if (!err) err = problems_found(&sampler);
    if (!err) err = geometry_merge(&sampler, &points);
    if (!err) geometry_thin_number(scene);
    if (!err) err = geometry_pack(&sampler);
    if (!err) err = geometry_open(&sampler);
    if (!err) err = geometry_extent(&sampler);
    if (!err) err = geometry_check_joined(&sampler);
    if (!err) err = problems_found(&sampler);
    arena_free(&sampler.temp);
    return err;
}

static enum err sampled(struct scene *scene, struct diag *d)
{
    const enum err err = scene_sample(scene, d);
    if (err) scene_free(scene);
    return err;
}

enum err scene_load(struct scene *scene, const char *path, int n_sets, const char *const *sets,
                    struct diag *d)
{
    TRY(scene_read(scene, path, n_sets, sets, d));
    return sampled(scene, d);
}

enum err scene_load_text(struct scene *scene, const char *text, const char *path, int n_sets,
                         const char *const *sets, struct diag *d)
{
    TRY(scene_parse(scene, text, path, n_sets, sets, d));
    return sampled(scene, d);
}
