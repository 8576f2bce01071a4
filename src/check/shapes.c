/* SPDX-License-Identifier: MIT
 * Shapes that the lattice cannot represent as drawn, walls and bodies too thin, and openings that
 * sampling has closed or left one particle wide. */
#include "check/check.h"

#include "base/elementary.h"
#include "case/effects.h"

#include <stdio.h>

/* --- off the lattice --- */

static double cells_to(const struct region *region, int c, double x)
{
    return (x - region->lattice.origin[c]) / region->lattice.spacing[c];
}

static bool on_lattice(double cells)
{
    return fabs(cells - round(cells)) <= 1e-6 * max2(1, 1e-6 * fabs(cells));
}

static void warn_of_box(struct check *k, const struct region *region, const struct shape *shape)
{
    const struct scene_lattice *const l = &region->lattice;
    for (int c = 0; c < 2; c++) {
        const double low = shape->pt[0][c], high = shape->pt[1][c];
        const double a = cells_to(region, c, low), b = cells_to(region, c, high);
        if (on_lattice(a) && on_lattice(b)) continue;
        const double n = geometry_rows_between(region, c, low, high);
        const double from = l->origin[c] + ceil(a - 0.5 - 1e-6) * l->spacing[c];
        k->scene->off_lattice = true;
        warn_at(k->diag, k->scene, shape->line,
                "[%s %s] box from %c = %g to %g m is %.4g dp %s and off the lattice: "
                "sampled as %.0f %s%s from %g to %g m; edges at %g and %g m would fit",
                kind_names[region->kind], region->name, "xy"[c], low, high, b - a,
                c ? "high" : "wide", n, c ? "row" : "column", n == 1 ? "" : "s", from,
                from + n * l->spacing[c], l->origin[c] + round(a) * l->spacing[c],
                l->origin[c] + round(b) * l->spacing[c]);
    }
}

/* The first edge along the lattice that lies between its lines. */
static void warn_of_edges(struct check *check, const struct region *region, int shape)
{
    const struct scene_lattice *const l = &region->lattice;
    const int line = region->list->item[shape].line;
    for (int k = 0; k < region->add.n; k++) {
        const struct outline *o = &region->add.item[k];
        if (region->add.shape[k] != shape) continue;
        for (int j = 0; j < o->n; j++) {
            const double *a = o->pt[j], *b = o->pt[(j + 1) % o->n];
            const double round_off = l->angle == 0 ? 0 : 1e-9 * l->dp;
            const int c = fabs(a[0] - b[0]) <= round_off ? 0 : 1;
            const double cells = cells_to(region, c, a[c]);
            if (fabs(a[c] - b[c]) > round_off || on_lattice(cells)) continue;
            const double fit = l->origin[c] + round(cells) * l->spacing[c];
            check->scene->off_lattice = true;
            if (l->angle == 0)
                warn_at(check->diag, check->scene, line,
                        "[%s %s] edge at %c = %g m is off the lattice of dp = %g m; "
                        "%c = %g m would fit",
                        kind_names[region->kind], region->name, "xy"[c], a[c], l -> dp, "xy"[c],
                        fit);
            else
                warn_at(check->diag, check->scene, line,
                        "an edge of [%s %s] is %.2g dp off the lattice, which is rotated by "
                        "%.4g degrees; move the edge or choose another dp",
                        kind_names[region->kind], region->name, fabs(a[c] - fit) / l->dp,
                        l->angle * (180 / PI));
            return;
        }
    }
}

/* The bending stiffness of a thin body is proportional to the third power of its thickness, hence
 * of its area. What a clamp holds does not bend. */
static void warn_of_area(struct check *check, const struct region *region)
{
    const struct scene_lattice *const l = &check->scene->solid_lattice[region->body];
    const double ratio = 1 + l->area_error, stiff = ratio * square(ratio);
    if (fabs(l->area_error) <= 0.005) return;
    const bool part = l->area_free;
    check->scene->off_lattice = true;
    warn_at(check->diag, check->scene, region->line,
            "the %.0f particles of [solid %s]%s cover %.2g %% %s than its area of %.4g m^2%s, so a "
            "thin body is about %.2g %% too %s in bending; a finer dp or another lattice_angle "
            "helps",
            ratio * l->area / square(l->dp), region->name, part ? " that no clamp holds" : "",
            100 * fabs(ratio - 1), ratio > 1 ? "more" : "less", l->area, part ? " there" : "",
            100 * fabs(stiff - 1), ratio > 1 ? "stiff" : "soft");
}

/* --- too thin --- */

static double thickness(const struct shape *shape)
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
static void warn_of_thin(struct check *check, const struct region *region, int line, double thick)
{
    const struct scene *const scene = check->scene;
    const double reach = 2 * scene->h * (1 - 1e-9);
    const bool directly = thick + scene->top.dp < reach;
    if (scene->n_fluid == 0 || thick >= reach) return;
    if (scene->numerics.sides == SIDES_ONE && !directly) return;
    warn_at(check->diag, scene, line,
            "[%s %s] is %g m thick, less than the kernel's reach 2 h = %g m: fluid interacts "
            "with the fluid behind it; %s prevents that",
            kind_names[region->kind], region->name, thick, 2 * scene->h,
            directly ? "a finer dp" : "numerics.sides = one");
}

static void warn_of_thin_solid(struct check *check, const struct region *region)
{
    const double across = geometry_rows_across(region), dp = region->lattice.dp;
    if (across < 4)
        warn_at(check->diag, check->scene, region->line,
                "[solid %s] is only %.0f particles thick at dp = %g m, so its bending will "
                "be inaccurate; use a finer dp, for 4 particles or more",
                region->name, across, dp);
    if (scene_is_bonded(check->scene, region->body)) return;
    /* At the default h/dp a warning here would repeat the one on two particles across. */
    if (across > 2 || (across + 1) * dp < 2 * check->scene->h)
        warn_of_thin(check, region, region->line, across * dp);
}

static void warn_of_region(struct check *check, const struct region *region)
{
    for (int k = 0; k < region->list->n; k++) {
        const struct shape *const shape = &region->list->item[k];
        bool layered = false; /* layers follow faces at any position */
        for (int j = 0; j < region->add.n; j++)
            layered |= region->add.shape[j] == k && region->layered[j];
        if (region->lattice.fitted || layered) continue;
        if (shape->kind == SHAPE_BOX && region->lattice.angle == 0)
            warn_of_box(check, region, shape);
        else
            warn_of_edges(check, region, k);
        if (region->kind == KIND_WALL) warn_of_thin(check, region, shape->line, thickness(shape));
    }
    if (region->kind != KIND_SOLID) return;
    warn_of_thin_solid(check, region);
    warn_of_area(check, region);
}

/* --- openings cut out by `minus` --- */

/* Whether a piece of `minus` covers a lattice point of the region. */
static bool removes_any(const struct region *region, const struct outline *cut)
{
    const struct scene_lattice *const l = &region->lattice;
    int64_t from[2], to[2];
    for (int c = 0; c < 2; c++) {
        from[c] = (int64_t)floor(cells_to(region, c, max2(cut->low[c], region->box.low[c])));
        to[c] = (int64_t)floor(cells_to(region, c, min2(cut->high[c], region->box.high[c])));
    }
    for (int64_t j = from[1]; j <= to[1]; j++)
        for (int64_t i = from[0]; i <= to[0]; i++) {
            const double x = l->origin[0] + ((double)i + 0.5 + NUDGE_X) * l->spacing[0];
            const double y = l->origin[1] + ((double)j + 0.5 + NUDGE_Y) * l->spacing[1];
            if (!outline_contains(cut, x, y)) continue;
            for (int k = 0; k < region->add.n; k++)
                if (outline_contains(&region->add.item[k], x, y)) return true;
        }
    return false;
}

static void warn_of_cuts(struct check *check, const struct region *region)
{
    for (int shape = 0; shape < region->minus_list->n; shape++) {
        bool removes = false;
        for (int k = 0; k < region->minus.n && !removes; k++)
            removes =
                region->minus.shape[k] == shape && removes_any(region, &region->minus.item[k]);
        if (removes) continue;
        warn_at(check->diag, check->scene, region->minus_list->item[shape].line,
                "`minus` removes no particle of [%s %s], because it is narrower than dp = %g "
                "m or lies outside, so the opening is closed; enlarge or move it, or use a "
                "smaller dp",
                kind_names[region->kind], region->name, region->lattice.dp);
    }
}

/* --- gaps between boxes --- */

/* Widest gap that counts as one particle wide, in dp. */
static const double one_wide = 1 + 1e-6;

static void warn_of_slit(struct check *check, const struct region *a, const struct shape *p,
                         const struct region *b, const struct shape *q)
{
    if (p->kind != SHAPE_BOX || q->kind != SHAPE_BOX) return;
    const double dp = check->scene->top.dp;
    for (int c = 0; c < 2; c++) {
        const double slit = max2(q->pt[0][c] - p->pt[1][c], p->pt[0][c] - q->pt[1][c]);
        const double shared =
            min2(p->pt[1][1 - c], q->pt[1][1 - c]) - max2(p->pt[0][1 - c], q->pt[0][1 - c]);
        if (slit <= 1e-6 * dp || slit > dp * one_wide || shared <= 1e-6 * dp) continue;
        const bool closed = slit < dp * (1 - 1e-6);
        warn_at(check->diag, check->scene, q->line,
                "the gap between [%s %s] and [%s %s] is %g m, %s dp = %g m, so %s; use dp "
                "= %.2g m or less, or close the gap",
                kind_names[a->kind], a->name, kind_names[b->kind], b->name, slit,
                closed ? "narrower than" : "no wider than", dp,
                closed ? "no fluid passes" : "hardly any fluid passes", 0.5 * slit);
        return;
    }
}

static void warn_of_slits(struct check *check)
{
    enum { MAX_PAIRS = 1000000 }; /* not done for scenes of thousands of boxes */
    long pairs = 0;
    for (int i = 0; i < check->shapes.n_regions; i++) {
        for (int j = i; j < check->shapes.n_regions; j++) {
            const struct region *a = &check->shapes.regions[i], *b = &check->shapes.regions[j];
            if (b->kind == KIND_FLUID) break;
            for (int k = 0; k < a->list->n; k++)
                for (int l = i == j ? k + 1 : 0; l < b->list->n && pairs++ < MAX_PAIRS; l++)
                    warn_of_slit(check, a, &a->list->item[k], b, &b->list->item[l]);
        }
    }
}

/* --- gaps between sections, and shapes of a section, of any kind --- */

/* Pairs of regions, and of shapes counted over all regions, of which no more needs to be said. */
struct gaps {
    struct check *c;
    int *part; /* the shape of each point; -1: unknown */
    int n_parts, n_regions;
    bool *narrow, *closed; /* [n_regions^2], [n_parts^2] */
};

/* Regions are solids, then walls. */
static int region_index(const struct check *check, int64_t k)
{
    return check->points.section[k] +
           (check->points.kind[k] == KIND_WALL ? check->scene->n_solid : 0);
}

static const struct region *region_of(const struct check *check, int64_t k)
{
    return &check->shapes.regions[region_index(check, k)];
}

static int shape_of(const struct check *check, int64_t k)
{
    return geometry_shape_at(region_of(check, k), check->points.x[k], check->points.y[k]);
}

/* Shapes are told apart unless there are too many to mark each with each. */
static enum err create_gaps(struct gaps *g, struct check *check)
{
    enum { MAX_PARTS = 2000 };
    struct arena *const a = &check->shapes.temp;
    *g = (struct gaps){.c = check, .n_regions = check->scene->n_solid + check->scene->n_wall};
    const size_t regions = (size_t)g->n_regions;
    int *const first = arena_alloc(a, regions, sizeof *first, "gaps", check->diag);
    g->part = arena_alloc(a, (size_t)check->points.n, sizeof *g->part, "gaps", check->diag);
    if (!first || !g->part) return ERR_MEMORY;
    for (int k = 0; k < g->n_regions; k++) {
        first[k] = g->n_parts;
        g->n_parts += check->shapes.regions[k].list->n;
    }
    const bool shapes = g->n_parts <= MAX_PARTS;
    if (!shapes) g->n_parts = g->n_regions;
    for (int64_t k = 0; k < check->points.n; k++) {
        if (check->points.bit[k] != POINT_BODY) continue;
        const int region = region_index(check, k), shape = shapes ? shape_of(check, k) : 0;
        g->part[k] = shape < 0 ? -1 : shapes ? first[region] + shape : region;
    }
    const size_t parts = (size_t)g->n_parts;
    g->narrow = arena_alloc(a, regions * regions, sizeof *g->narrow, "gaps", check->diag);
    g->closed = arena_alloc(a, parts * parts, sizeof *g->closed, "gaps", check->diag);
    return g->narrow && g->closed ? ERR_OK : ERR_MEMORY;
}

static bool *mark_of(bool *settled, int n, int a, int b)
{
    return &settled[(size_t)(a < b ? a : b) * (size_t)n + (size_t)(a < b ? b : a)];
}

/* Whether a particle of a wall or solid lies nearer to the point than `reach`. */
static bool is_covered(const struct check *check, double x, double y, double reach)
{
    struct point_visit v = point_grid_visit(&check->points.grid, x, y, reach);
    while (point_grid_next(&check->points.grid, &v))
        if (check->points.bit[v.k] == POINT_BODY) return true;
    return false;
}

/* A gap between boxes that are not cut: warn_of_slits judges its drawn width. */
static bool is_slit(const struct check *check, int64_t k, int64_t m)
{
    const int64_t at[2] = {k, m};
    for (int n = 0; n < 2; n++) {
        const struct region *const region = region_of(check, at[n]);
        const int shape = shape_of(check, at[n]);
        if (region->minus.n > 0 || shape < 0 || region->list->item[shape].kind != SHAPE_BOX)
            return false;
    }
    return true;
}

/* Whether fluid could pass between two faces in both directions along the unit vector: the gap
 * ends where a face does, before another face closes it. */
static bool is_passage(const struct check *check, const double at[2], const double along[2])
{
    const double dp = check->scene->top.dp, reach = 0.75 * dp;
    for (int way = -1; way <= 1; way += 2)
        for (double path = 0.5 * dp;; path += 0.5 * dp) {
            const double x = at[0] + way * path * along[0], y = at[1] + way * path * along[1];
            if (is_covered(check, x, y, reach)) return false;
            if (!is_covered(check, x - dp * along[1], y + dp * along[0], reach) ||
                !is_covered(check, x + dp * along[1], y - dp * along[0], reach))
                break;
        }
    return true;
}

enum { BETWEEN_TEXT = 2 * SCENE_NAME + 32 };

/* The line of the case, of a shape if it is known, and the sections between which a gap is. */
static int name_gap(const struct check *check, int64_t k, int64_t m, char between[BETWEEN_TEXT])
{
    const struct region *const a = region_of(check, k), *const b = region_of(check, m);
    const int shape = shape_of(check, m);
    if (a == b)
        snprintf(between, BETWEEN_TEXT, "in [%s %s]", kind_names[b->kind], b->name);
    else
        snprintf(between, BETWEEN_TEXT, "between [%s %s] and [%s %s]", kind_names[a->kind], a->name,
                 kind_names[b->kind], b->name);
    return shape >= 0 ? b->list->item[shape].line : b->line;
}

/* Warns if an empty gap lies between two particles in which at most one particle fits. Centres on
 * both sides of a gap of width w are w + dp apart. Where two lattices meet, they are up to 1.5 dp
 * apart, and a particle lies nearer to their middle than 0.75 dp. Where two faces meet at an
 * angle, the gap is no passage. */
static void warn_of_narrow_gap(struct gaps *g, int64_t k, int64_t m)
{
    const struct check *const check = g->c;
    const double *const x = check->points.x, *const y = check->points.y;
    const double dp = check->scene->top.dp, dx = x[m] - x[k], dy = y[m] - y[k];
    const double r = elementary_hypot(dx, dy), at[2] = {x[k] + 0.5 * dx, y[k] + 0.5 * dy};
    const double along[2] = {-dy / r, dx / r};
    bool *const mark =
        mark_of(g->narrow, g->n_regions, region_index(check, k), region_index(check, m));
    if (r < 1.5 * dp || *mark || is_covered(check, at[0], at[1], 0.75 * dp)) return;
    if (is_slit(check, k, m) || !is_passage(check, at, along)) return;
    *mark = true;
    char between[BETWEEN_TEXT];
    const int line = name_gap(check, k, m, between);
    warn_at(check->diag, check->scene, line,
            "the gap %s at (%.4g, %.4g) m is no wider than dp = %g m, so hardly any fluid "
            "passes; use dp = %.2g m or less, or close the gap",
            between, at[0], at[1], dp, 0.5 * (r - dp));
}

/* How wide the drawn shapes leave a line through the point open, up to 2 `most`; moves the point
 * to the middle. */
static double open_width(const struct check *check, double at[2], const double across[2],
                         double most)
{
    const double step = 0.02 * check->scene->top.dp;
    double end[2];
    if (is_drawn(check, at[0], at[1])) return 0;
    for (int way = 0; way < 2; way++) {
        const double sign = way ? 1 : -1;
        end[way] = 0.5 * step;
        while (end[way] < most && !is_drawn(check, at[0] + sign * end[way] * across[0],
                                            at[1] + sign * end[way] * across[1]))
            end[way] += step;
    }
    for (int axis = 0; axis < 2; axis++) at[axis] += 0.5 * (end[1] - end[0]) * across[axis];
    return end[0] + end[1];
}

/* The narrowest width of an opening around the point, and the direction across. */
static double narrowest(const struct check *check, double at[2], double across[2])
{
    enum { DIRECTIONS = 24 };
    const double from[2] = {at[0], at[1]};
    double least = HUGE_VAL;
    for (int k = 0; k < DIRECTIONS; k++) {
        const double way[2] = {elementary_cos(k * PI / DIRECTIONS),
                               elementary_sin(k * PI / DIRECTIONS)};
        double middle[2] = {from[0], from[1]};
        const double width = open_width(check, middle, way, check->scene->top.dp);
        if (width >= least) continue;
        least = width;
        for (int axis = 0; axis < 2; axis++) at[axis] = middle[axis], across[axis] = way[axis];
    }
    return least;
}

/* Whether a gap goes on as drawn, both ways from the point, to where it is wider than dp. A wedge
 * between a circle and the floor that it touches does not. */
static bool is_drawn_passage(const struct check *check, const double from[2],
                             const double across[2])
{
    const double dp = check->scene->top.dp, step = 0.1 * dp;
    for (int way = -1; way <= 1; way += 2) {
        double at[2] = {from[0], from[1]}, width = 0;
        int64_t steps = 20 * check->points.n; /* a ring has no end */
        for (; width <= dp * one_wide && steps > 0; steps--) {
            at[0] -= way * step * across[1];
            at[1] += way * step * across[0];
            width = open_width(check, at, across, dp);
            if (width == 0) return false;
        }
        if (steps == 0) return false;
    }
    return true;
}

/* The middle of the longest stretch between two particles that their own shapes leave open. A slit
 * of less than a fortieth of their distance is meant as a joint. */
static bool find_opening(const struct check *check, int64_t k, int64_t m, double at[2])
{
    enum { POINTS = 80 };
    const double *const px = check->points.x, *const py = check->points.y;
    const struct region *const a = region_of(check, k), *const b = region_of(check, m);
    int longest = 0, now = 0;
    for (int n = 0; n < POINTS; n++) {
        const double t = (n + 0.5) / POINTS;
        const double x = px[k] + t * (px[m] - px[k]), y = py[k] + t * (py[m] - py[k]);
        now = geometry_covers(a, x, y) || geometry_covers(b, x, y) ? 0 : now + 1;
        if (now <= longest) continue;
        longest = now;
        const double middle = (n + 1 - 0.5 * now) / POINTS;
        at[0] = px[k] + middle * (px[m] - px[k]);
        at[1] = py[k] + middle * (py[m] - py[k]);
    }
    return longest > 2;
}

/* Warns of particles that leave no space for one between them, and whose shapes do as drawn. */
static void warn_of_closed_gap(struct gaps *g, int64_t k, int64_t m)
{
    const struct check *const check = g->c;
    const int a = g->part[k], b = g->part[m];
    double at[2] = {0}, across[2];
    if (a < 0 || b < 0 || a == b) return;
    bool *const mark = mark_of(g->closed, g->n_parts, a, b);
    if (*mark || is_slit(check, k, m) || !find_opening(check, k, m, at)) return;
    const double width = narrowest(check, at, across);
    if (width == 0 || !is_drawn_passage(check, at, across)) return;
    *mark = true;
    char between[BETWEEN_TEXT];
    const int line = name_gap(check, k, m, between);
    warn_at(check->diag, check->scene, line,
            "the gap %s at (%.4g, %.4g) m is about %.2g m wide, narrower than dp = %g m, and "
            "closed by sampling, so no fluid passes; use dp = %.1g m or less, or close the gap",
            between, at[0], at[1], width, check->scene->top.dp, 0.5 * width);
}

static enum err warn_of_gaps(struct check *check)
{
    const struct points *const p = &check->points;
    const double dp = check->scene->top.dp, reach[2] = {(1 + one_wide) * dp, (1.5 + 1e-9) * dp};
    struct gaps g;
    TRY(create_gaps(&g, check));
    for (int closed = 0; closed < 2; closed++)
        for (int64_t k = 0; k < p->n; k++) {
            if (p->bit[k] != POINT_BODY) continue;
            struct point_visit v = point_grid_visit(&p->grid, p->x[k], p->y[k], reach[closed]);
            while (point_grid_next(&p->grid, &v)) {
                if (v.k <= k) continue; /* so it is of a wall or solid, too */
                if (closed)
                    warn_of_closed_gap(&g, k, v.k);
                else
                    warn_of_narrow_gap(&g, k, v.k);
            }
        }
    return ERR_OK;
}

enum err warn_of_shapes(struct check *check)
{
    for (int k = 0; k < check->shapes.n_regions; k++)
        warn_of_region(check, &check->shapes.regions[k]);
    for (int k = 0; k < check->shapes.n_regions; k++)
        warn_of_cuts(check, &check->shapes.regions[k]);
    if (check->scene->n_fluid == 0) return ERR_OK;
    warn_of_slits(check);
    return warn_of_gaps(check);
}
