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
static const double max_cells = 1e9; /* of the shapes' boxes together, or away from the origin */

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
            if (low > max_cells || high > max_cells) cells = HUGE_VAL;
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

/* Whether a point is in a piece, of those on the lattice or of all; counts those of each shape. */
static bool is_inside(const struct region *region, double x, double y, bool all, int64_t *per_shape)
{
    bool inside = false;
    for (int k = 0; k < region->add.n; k++) {
        if (!outline_contains(&region->add.item[k], x, y)) continue;
        per_shape[region->add.shape[k]]++;
        inside |= all || !region->layered[k];
    }
    return inside && outlines_find(&region->minus, x, y) < 0;
}

/* Adds a point given in the axes of its lattice. */
static enum err sample_point(struct sampler *sampler, const struct region *region, double x,
                             double y, struct samples *to)
{
    struct arena *const a = &sampler->temp;
    const size_t n = (size_t)to->n;
    double at[2];
    to->x = arena_grow(a, to->x, n, sizeof *to->x, "sampling", sampler->diag);
    to->y = arena_grow(a, to->y, n, sizeof *to->y, "sampling", sampler->diag);
    to->region = arena_grow(a, to->region, n, sizeof *to->region, "sampling", sampler->diag);
    to->clamped = arena_grow(a, to->clamped, n, 1, "sampling", sampler->diag);
    if (!to->x || !to->y || !to->region || !to->clamped) return ERR_MEMORY;
    place_of_lattice(&region->lattice, x, y, at);
    to->x[n] = at[0];
    to->y[n] = at[1];
    to->region[n] = (int32_t)(region - sampler->regions);
    to->n++;
    return ERR_OK;
}

/* Visits the points of a region's lattice row by row, or column by column if it is upright: adds
 * those inside, or offers all as points `behind` the layers. */
static enum err lay_lattice(struct sampler *sampler, const struct region *region, bool behind,
                            struct layers *layers, int64_t *per_shape, struct samples *to)
{
    int64_t first[2], end[2];
    for (int c = 0; c < 2; c++) {
        first[c] = index_from(region, c, region->box.low[c]) - 1;
        end[c] = index_from(region, c, region->box.high[c]) + 1;
    }
    const int outer = region->kind == KIND_SOLID && end[1] - first[1] > end[0] - first[0] ? 0 : 1;
    int64_t at[2];
    for (at[outer] = first[outer]; at[outer] < end[outer]; at[outer]++)
        for (at[!outer] = first[!outer]; at[!outer] < end[!outer]; at[!outer]++) {
            const double x = centre(region, 0, at[0]), y = centre(region, 1, at[1]);
            if (!is_inside(region, x + NUDGE_X * region->lattice.spacing[0],
                           y + NUDGE_Y * region->lattice.spacing[1], behind, per_shape))
                continue;
            if (!behind) TRY(sample_point(sampler, region, x, y, to));
            if (region->has_layers) TRY((behind ? layers_fill : layers_take)(layers, x, y));
        }
    return ERR_OK;
}

/* The lattice in the pieces along it, then the layers, then the lattice behind them. */
static enum err lay_points(struct sampler *sampler, struct region *region, int64_t *per_shape,
                           struct samples *to)
{
    struct layers l;
    const int64_t before = to->n;
    if (region->has_layers) TRY(layers_create(&l, sampler, region));
    TRY(lay_lattice(sampler, region, false, &l, per_shape, to));
    if (region->has_layers) {
        TRY(layers_trace(&l));
        TRY(lay_lattice(sampler, region, true, &l, per_shape, to));
        for (int64_t k = l.first; k < l.points.n; k++)
            TRY(sample_point(sampler, region, l.points.x[k], l.points.y[k], to));
    }
    region->n = to->n - before;
    return ERR_OK;
}

/* Shapes without particles are reported together, before anything needs their particles. */
static enum err sample_region(struct sampler *sampler, struct region *region, struct samples *to)
{
    int64_t *const per_shape = geometry_alloc(sampler, (size_t)region->list->n, sizeof *per_shape);
    if (!per_shape) return ERR_MEMORY;
    TRY(lay_points(sampler, region, per_shape, to));
    bool missing = region->n == 0;
    for (int k = 0; k < region->list->n; k++) {
        missing &= per_shape[k] > 0;
        if (per_shape[k] || region->list->item[k].thin) continue;
        TRY(geometry_refuse(sampler, region->list->item[k].line,
                            "shape %d of [%s %s] contains no particle, because it is narrower "
                            "than dp = %g m or lies between lattice points; enlarge or move it",
                            k + 1, region->word, region->name, region->lattice.dp));
    }
    if (!missing) return ERR_OK;
    return geometry_refuse(sampler, region->line, "nothing is left of [%s %s] after its `minus`",
                           region->word, region->name);
}

/* An error if there was bad input. */
static enum err problems_found(const struct sampler *sampler)
{
    return sampler->problems ? ERR_INPUT : ERR_OK;
}

static enum err sample_regions(struct sampler *sampler, struct samples *samples)
{
    TRY(list_regions(sampler));
    TRY(geometry_thin(sampler));
    TRY(geometry_choose_lattices(sampler));
    TRY(turn_regions(sampler));
    TRY(check_size(sampler));
    for (int k = 0; k < sampler->n_regions; k++) {
        struct region *const region = &sampler->regions[k];
        const int64_t from = samples->n;
        TRY(sample_region(sampler, region, samples));
        if (region->kind == KIND_SOLID && region->n > 0)
            TRY(geometry_clamp(sampler, region, from, samples));
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
    return turn_regions(sampler);
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
