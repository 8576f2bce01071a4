/* SPDX-License-Identifier: MIT
 * Sampling of shapes: particles are the centres of the cells of a square lattice. A centre within
 * 1e-6 dp of an edge counts as above and to the right of it, for any rounding error. So shapes with
 * a common edge neither miss nor double a particle. */
#include "geometry/scene_points.h"
#include "geometry/sampling.h"

#include <unistd.h>

/* Approximate bytes of a particle, to refuse absurd cases: fields, neighbour lists and copies. */
static const double bytes_per_particle = 300;
static const double max_cells = 1e9; /* of the boxes around shapes, or away from the origin */

/* --- regions --- */

/* Refuses scenes that do not fit into memory before allocating anything of that size. */
static enum err check_size(struct sampler *sampler)
{
    const double dp = sampler->scene->top.dp;
    double particles = 0, cells = 0;
    for (int k = 0; k < sampler->n_regions; k++) {
        const struct region *const region = &sampler->regions[k];
        const double own = region->lattice.dp, *const origin = region->lattice.origin,
                     *const low = region->box.low, *const high = region->box.high;
        for (const struct outline *o = region->add.item; o < region->add.item + region->add.n; o++)
            particles +=
                (o->n ? fabs(polygon_area(o->n, o->pt)) : PI * square(o->radius)) / square(own);
        cells += ((high[0] - low[0]) / own + 3) * ((high[1] - low[1]) / own + 3);
        for (int c = 0; c < 2; c++)
            cells = max2(cells, max2(fabs(low[c] - origin[c]), fabs(high[c] - origin[c])) / own);
    }
    const double pages = (double)sysconf(_SC_PHYS_PAGES), page = (double)sysconf(_SC_PAGESIZE);
    const double memory = pages > 0 && page > 0 ? pages * page : 1e18;
    const double bytes = particles * bytes_per_particle;
    if (particles <= max_cells && bytes <= memory && cells <= max_cells) return ERR_OK;
    return diag_add(sampler->diag, ERR_INPUT,
                    "%s: dp = %g m gives about %.3g particles, which need %.3g GB, in shapes that "
                    "span %.3g cells. This machine has %.3g GB, and at most %g particles and "
                    "cells are allowed; use a larger dp or smaller shapes",
                    sampler->scene->path, dp, particles, 1e-9 * bytes, cells, 1e-9 * memory,
                    max_cells);
}

static void add_region(struct sampler *sampler, enum kind kind, int body,
                       const struct scene_section_common *common, const struct shape_list *shape,
                       const struct shape_list *minus)
{
    sampler->regions[sampler->n_regions++] = (struct region){
        .kind = kind, .body = body, .common = common, .list = shape, .minus_list = minus};
}

static enum err draw_region(struct sampler *sampler, struct region *region)
{
    TRY(outlines_of(&region->add, sampler->scene, region->list, &sampler->temp, sampler->diag));
    TRY(outlines_of(&region->minus, sampler->scene, region->minus_list, &sampler->temp,
                    sampler->diag));
    return region->kind == KIND_FLUID ? geometry_subtract_beams(sampler, &region->minus) : ERR_OK;
}

/* Fluid is drawn before the walls beside it, and these have their thickness before joints are. */
static enum err list_regions(struct sampler *sampler)
{
    const struct scene *scene = sampler->scene;
    const int n_wall = scene->n_fluid ? scene->n_wall : scene_beam_wall(scene, 0),
              n = scene->n_solid + n_wall + scene->n_fluid;
    TRY(geometry_array(sampler, &sampler->regions, n));
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
        TRY(geometry_choose_layered(sampler, region));
    }
    return ERR_OK;
}

/* --- rows --- */

/* Adds a lattice place in a piece, to `layered` if all its pieces are; counts it for shapes. */
static enum err visit_place(struct sampler *sampler, const struct region *region,
                            const int64_t at[2], int64_t *per_shape, struct samples *to,
                            struct samples *layered)
{
    const struct scene_lattice *const l = &region->lattice;
    const double x = l->origin[0] + ((double)at[0] + 0.5) * l->spacing[0],
                 y = l->origin[1] + ((double)at[1] + 0.5) * l->spacing[1],
                 u = x + NUDGE_X * l->spacing[0], v = y + NUDGE_Y * l->spacing[1];
    bool inside = false, on_lattice = false;
    for (int k = 0; k < region->add.n; k++) {
        if (!outline_contains(&region->add.item[k], u, v)) continue;
        per_shape[region->add.shape[k]]++;
        inside = true;
        on_lattice |= !region->layered[k];
    }
    if (!inside || outlines_find(&region->minus, u, v) >= 0) return ERR_OK;
    return geometry_sample(sampler, region, x, y, on_lattice ? to : layered);
}

/* The points of a region row by row, or column by column if it is an upright body. */
static enum err lay_points(struct sampler *sampler, struct region *region, int64_t *per_shape,
                           struct samples *to)
{
    const struct scene_lattice *const l = &region->lattice;
    struct samples layered = {0};
    const int64_t from = to->n;
    int64_t at[2], first[2], end[2];
    for (int c = 0; c < 2; c++) {
        first[c] = geometry_index(region, c, region->box.low[c]) - 1;
        end[c] = geometry_index(region, c, region->box.high[c]) + 1;
    }
    const bool upright = region->kind == KIND_SOLID && end[1] - first[1] > end[0] - first[0];
    const int outer = upright ? 0 : 1, inner = 1 - outer;
    for (at[outer] = first[outer]; at[outer] < end[outer]; at[outer]++)
        for (at[inner] = first[inner]; at[inner] < end[inner]; at[inner]++)
            TRY(visit_place(sampler, region, at, per_shape, to, &layered));
    if (region->has_layers) TRY(geometry_lay_layers(sampler, region, from, &layered, to));
    for (int64_t k = from; k < to->n; k++) {
        double place[2];
        place_of_lattice(l, to->x[k], to->y[k], place);
        to->x[k] = place[0];
        to->y[k] = place[1];
    }
    region->n = to->n - from;
    return ERR_OK;
}

/* Shapes without particles are reported together, before anything needs their particles. */
static enum err sample_region(struct sampler *sampler, struct region *region, struct samples *to)
{
    int64_t *per_shape;
    TRY(geometry_array(sampler, &per_shape, region->list->n));
    TRY(lay_points(sampler, region, per_shape, to));
    bool missing = region->n == 0;
    for (int k = 0; k < region->list->n; k++) {
        missing &= per_shape[k] > 0;
        if (per_shape[k] || region->list->item[k].thin) continue;
        TRY(geometry_refuse(sampler, region->list->item[k].line,
                            "shape %d of %s contains no particle, because it is narrower "
                            "than dp = %g m or lies between lattice points; enlarge or move it",
                            k + 1, section_title(region->common).text, region->lattice.dp));
    }
    if (!missing) return ERR_OK;
    return geometry_refuse(sampler, region->common->line, "nothing is left of %s after its `minus`",
                           section_title(region->common).text);
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
    if (!err) err = geometry_settle(&sampler);
    if (!err) err = geometry_open(&sampler);
    if (!err) err = geometry_extent(&sampler);
    if (!err) err = geometry_check_joined(&sampler);
    if (!err) err = problems_found(&sampler);
    arena_free(&sampler.temp);
    return err;
}

enum err scene_load_text(struct scene *scene, const char *text, const char *path, int n_sets,
                         const char *const *sets, struct diag *d)
{
    TRY(scene_read(scene, text, path, n_sets, sets, d));
    const enum err err = scene_sample(scene, d);
    if (err) scene_free(scene);
    return err;
}
