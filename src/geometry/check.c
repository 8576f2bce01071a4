/* SPDX-License-Identifier: MIT
 * Warnings on shapes that the lattice cannot represent as drawn: they tell what was sampled
 * instead. */
#include "geometry/sampling.h"

#include "case/case.h"
#include "case/effects.h"

#include <math.h>

static double cells_to(const struct region *region, int c, double x)
{
    return (x - region->lattice.origin[c]) / region->lattice.spacing[c];
}

static bool on_lattice(double cells)
{
    return fabs(cells - round(cells)) <= 1e-6 * max2(1, 1e-6 * fabs(cells));
}

/* Number of lattice columns (c = 0) or rows (c = 1) between two coordinates. */
static double points_between(const struct region *region, int c, double low, double high)
{
    return ceil(cells_to(region, c, high) - 0.5 - 1e-6) -
           ceil(cells_to(region, c, low) - 0.5 - 1e-6);
}

static void warn_box(struct sampler *g, const struct region *region, const struct shape *shape)
{
    const struct scene_lattice *const l = &region->lattice;
    char place[LOCATION_TEXT];
    scene_location(g->scene, shape->line, place);
    for (int c = 0; c < 2; c++) {
        const double low = shape->pt[0][c], high = shape->pt[1][c];
        const double a = cells_to(region, c, low), b = cells_to(region, c, high);
        if (on_lattice(a) && on_lattice(b)) continue;
        const double n = points_between(region, c, low, high);
        const double from = l->origin[c] + ceil(a - 0.5 - 1e-6) * l->spacing[c];
        g->scene->off_lattice = true;
        diag_warn(g->diag,
                  "%s: [%s %s] box from %c = %g to %g m is %.4g dp %s and off the lattice: "
                  "sampled as %.0f %s from %g to %g m; edges at %g and %g m would fit",
                  place, kind_names[region->kind], region->name, "xy"[c], low, high, b - a,
                  c ? "high" : "wide", n,
                  n == 1 ? (c ? "row" : "column")
                  : c    ? "rows"
                         : "columns",
                  from, from + n * l->spacing[c], l->origin[c] + round(a) * l->spacing[c],
                  l->origin[c] + round(b) * l->spacing[c]);
    }
}

/* The first edge along the lattice that lies between its lines. */
static void warn_edges(struct sampler *g, const struct region *region, int shape)
{
    const struct scene_lattice *const l = &region->lattice;
    for (int k = 0; k < region->add.n; k++) {
        const struct outline *o = &region->add.item[k];
        if (region->add.shape[k] != shape) continue;
        for (int j = 0; j < o->n; j++) {
            const double *a = o->pt[j], *b = o->pt[(j + 1) % o->n];
            const double round_off = l->angle == 0 ? 0 : 1e-9 * l->dp;
            const int c = fabs(a[0] - b[0]) <= round_off ? 0 : 1;
            const double cells = cells_to(region, c, a[c]);
            if (fabs(a[c] - b[c]) > round_off || on_lattice(cells)) continue;
            char place[LOCATION_TEXT];
            scene_location(g->scene, region->list->item[shape].line, place);
            const double fit = l->origin[c] + round(cells) * l->spacing[c];
            g->scene->off_lattice = true;
            if (l->angle == 0)
                diag_warn(g->diag,
                          "%s: [%s %s] edge at %c = %g m is off the lattice of dp = %g m; "
                          "%c = %g m would fit",
                          place, kind_names[region->kind], region->name, "xy"[c], a[c], l -> dp,
                          "xy"[c], fit);
            else
                diag_warn(g->diag,
                          "%s: an edge of [%s %s] is %.2g dp off the lattice, which is rotated by "
                          "%.4g degrees; move the edge or choose another dp",
                          place, kind_names[region->kind], region->name, fabs(a[c] - fit) / l->dp,
                          l->angle * (180 / PI));
            return;
        }
    }
}

/* Whether clamps hold a part of the solid: not all of it, nor a hinge, whose area is not that of its
 * particles. */
static bool clamp_takes_part(const struct region *region)
{
    return region->n_clamped > region->n_hinged && region->n_clamped < region->n;
}

/* The area of a solid where no clamp holds it; else the whole. */
static enum err free_area(struct sampler *g, const struct region *region, double *area)
{
    const struct shape_list *const list = &g->scene->solid[region->body].clamp;
    const struct outlines *const minus = &region->minus, *const clamps = &region->clamps;
    const bool part = clamp_takes_part(region);
    struct outlines cut = {.item = arena_alloc(&g->temp, (size_t)(minus->n + clamps->n),
                                               sizeof *cut.item, "shapes", g->diag)};
    if (!cut.item) return ERR_MEMORY;
    for (int k = 0; k < minus->n; k++) cut.item[cut.n++] = minus->item[k];
    for (int k = 0; part && k < clamps->n; k++)
        if (!geometry_is_hinge(&list->item[clamps->shape[k]], region->lattice.dp))
            cut.item[cut.n++] = clamps->item[k];
    return outlines_area(&region->add, &cut, 0.25 * region->lattice.spacing[1], area, &g->temp,
                         g->diag);
}

/* The bending stiffness of a thin body is proportional to the third power of its thickness, hence
 * of its area. What a clamp holds does not bend. */
static enum err check_area(struct sampler *g, const struct region *region)
{
    static const double tolerance = 0.005;
    const struct scene_lattice *const l = &region->lattice;
    const bool part = clamp_takes_part(region);
    const int64_t n = region->n - (part ? region->n_clamped - region->n_hinged : 0);
    double area;
    TRY(free_area(g, region, &area));
    const double ratio = (double)n * square(l->dp) / area, stiff = ratio * square(ratio);
    g->scene->solid_lattice[region->body].area = area;
    g->scene->solid_lattice[region->body].area_error = ratio - 1;
    if (fabs(ratio - 1) <= tolerance) return ERR_OK;
    g->scene->off_lattice = true;
    char place[LOCATION_TEXT];
    scene_location(g->scene, region->line, place);
    diag_warn(
        g->diag,
        "%s: the %lld particles of [solid %s]%s cover %.2g %% %s than its area of %.4g m^2%s, so a "
        "thin body is about %.2g %% too %s in bending; a finer dp or another lattice_angle helps",
        place, (long long)n, region->name, part ? " that no clamp holds" : "",
        100 * fabs(ratio - 1), ratio > 1 ? "more" : "less", area, part ? " there" : "",
        100 * fabs(stiff - 1), ratio > 1 ? "stiff" : "soft");
    return ERR_OK;
}

/* Whether a shape is sampled in layers, which follow its faces at any position. */
static bool has_layers(const struct region *region, int shape)
{
    for (int k = 0; k < region->add.n; k++)
        if (region->add.shape[k] == shape && region->layered[k]) return true;
    return false;
}

static double thinnest(const struct shape *shape)
{
    switch (shape->kind) {
    case SHAPE_BOX:
        return min2(shape->pt[1][0] - shape->pt[0][0], shape->pt[1][1] - shape->pt[0][1]);
    case SHAPE_POLYLINE: return fabs(shape->size);
    case SHAPE_CIRCLE: return 2 * shape->size;
    case SHAPE_POLYGON: break;
    }
    return HUGE_VAL;
}

/* A body thinner than the kernel's reach does not separate the fluid on its two sides. They
 * interact through the pressure of the body's particles, unless each fluid particle uses its own
 * pressure there. They interact directly if the nearest fluid on both sides, thickness plus one
 * spacing apart, is within reach. */
static void warn_see_through(struct sampler *g, const struct region *region, int line, double thick)
{
    const struct scene *const s = g->scene;
    const double reach = 2 * s->h * (1 - 1e-9);
    const bool directly = thick + s->top.dp < reach;
    if (s->n_fluid == 0 || thick >= reach || (s->numerics.sides == SIDES_ONE && !directly)) return;
    char place[LOCATION_TEXT];
    scene_location(s, line, place);
    diag_warn(g->diag,
              "%s: [%s %s] is %g m thick, less than the kernel's reach 2 h = %g m: fluid interacts "
              "with the fluid behind it; %s prevents that",
              place, kind_names[region->kind], region->name, thick, 2 * s->h,
              directly ? "a finer dp" : "numerics.sides = one");
}

static enum err check_solid(struct sampler *g, const struct region *region)
{
    double across = HUGE_VAL;
    for (int c = 0; c < 2; c++)
        across = min2(across, points_between(region, c, region->low[c], region->high[c]));
    for (int k = 0; k < region->list->n; k++)
        if (region->list->item[k].kind == SHAPE_POLYLINE)
            across = min2(across, round(thinnest(&region->list->item[k]) / region->lattice.dp));
    char place[LOCATION_TEXT];
    scene_location(g->scene, region->line, place);
    if (across < 2)
        return diag_add(g->diag, ERR_INPUT,
                        "%s: [solid %s] is %.0f particle thick at dp = %g m; bending needs at "
                        "least 2, better 4",
                        place, region->name, across, region->lattice.dp);
    if (across < 4)
        diag_warn(g->diag,
                  "%s: [solid %s] is only %.0f particles thick at dp = %g m, so its bending will "
                  "be inaccurate; use a finer dp, for 4 particles or more",
                  place, region->name, across, region->lattice.dp);
    if (scene_is_bonded(g->scene, region->body)) return ERR_OK;
    /* At the default h/dp a warning here would repeat the one on two particles across. */
    if (across > 2 || (across + 1) * region->lattice.dp < 2 * g->scene->h)
        warn_see_through(g, region, region->line, across * region->lattice.dp);
    return ERR_OK;
}

enum err geometry_check_regions(struct sampler *g)
{
    for (int r = 0; r < g->n_regions; r++) {
        const struct region *region = &g->regions[r];
        for (int k = 0; k < region->list->n; k++) {
            const struct shape *shape = &region->list->item[k];
            if (region->lattice.fitted || has_layers(region, k)) continue;
            if (shape->kind == SHAPE_BOX && region->lattice.angle == 0)
                warn_box(g, region, shape);
            else
                warn_edges(g, region, k);
            if (region->kind == KIND_WALL)
                warn_see_through(g, region, shape->line, thinnest(shape));
        }
        if (region->kind != KIND_SOLID) continue;
        TRY(geometry_go_on(g, check_solid(g, region)));
        TRY(check_area(g, region));
    }
    return ERR_OK;
}
