/* SPDX-License-Identifier: MIT
 * Warnings of openings between walls and solids that sampling has closed or left one particle wide. */
#include "geometry/sampling.h"

#include "base/elementary.h"
#include "case/case.h"
#include "base/point_grid.h"

#include <math.h>
#include <stdio.h>

/* Widest gap that counts as one particle wide, in dp. */
static const double one_wide = 1 + 1e-6;

/* --- between boxes --- */

static void warn_slit(struct sampler *g, const struct region *a, const struct shape *p,
                      const struct region *b, const struct shape *q)
{
    if (p->kind != SHAPE_BOX || q->kind != SHAPE_BOX) return;
    const double dp = g->scene->top.dp;
    for (int c = 0; c < 2; c++) {
        const double slit = max2(q->pt[0][c] - p->pt[1][c], p->pt[0][c] - q->pt[1][c]);
        const double shared =
            min2(p->pt[1][1 - c], q->pt[1][1 - c]) - max2(p->pt[0][1 - c], q->pt[0][1 - c]);
        if (slit <= 1e-6 * dp || slit > dp * one_wide || shared <= 1e-6 * dp) continue;
        const bool closed = slit < dp * (1 - 1e-6);
        char place[LOCATION_TEXT];
        scene_location(g->scene, q->line, place);
        diag_warn(g->diag,
                  "%s: the gap between [%s %s] and [%s %s] is %g m, %s dp = %g m, so %s; use dp "
                  "= %.2g m or less, or close the gap",
                  place, kind_names[a->kind], a->name, kind_names[b->kind], b->name, slit,
                  closed ? "narrower than" : "no wider than", dp,
                  closed ? "no fluid passes" : "hardly any fluid passes", 0.5 * slit);
        return;
    }
}

static void warn_slits(struct sampler *g)
{
    enum { MAX_PAIRS = 1000000 }; /* not done for scenes of thousands of boxes */
    long pairs = 0;
    for (int i = 0; i < g->n_regions && g->scene->n_fluid; i++) {
        for (int j = i; j < g->n_regions; j++) {
            const struct region *a = &g->regions[i], *b = &g->regions[j];
            if (b->kind == KIND_FLUID) break;
            for (int k = 0; k < a->list->n; k++)
                for (int l = i == j ? k + 1 : 0; l < b->list->n && pairs++ < MAX_PAIRS; l++)
                    warn_slit(g, a, &a->list->item[k], b, &b->list->item[l]);
        }
    }
}

/* --- cut out by `minus` --- */

/* Lattice points of the region that a piece of `minus` covers, up to `most`. */
static int64_t count_removed(const struct sampler *g, const struct region *region,
                             const struct outline *cut, int64_t most)
{
    const struct scene_lattice *const l = &region->lattice;
    int64_t n = 0, from[2], to[2];
    for (int c = 0; c < 2; c++) {
        from[c] =
            (int64_t)floor((max2(cut->low[c], region->low[c]) - l->origin[c]) / l->spacing[c]);
        to[c] =
            (int64_t)floor((min2(cut->high[c], region->high[c]) - l->origin[c]) / l->spacing[c]);
    }
    for (int64_t j = from[1]; j <= to[1]; j++)
        for (int64_t i = from[0]; i <= to[0]; i++) {
            const double x = l->origin[0] + ((double)i + 0.5 + NUDGE_X) * l->spacing[0];
            const double y = l->origin[1] + ((double)j + 0.5 + NUDGE_Y) * l->spacing[1];
            bool covered = false;
            if (!outline_contains(cut, x, y, g->scratch)) continue;
            for (int k = 0; k < region->add.n && !covered; k++)
                covered = outline_contains(&region->add.item[k], x, y, g->scratch);
            n += covered;
            if (n >= most) return n;
        }
    return n;
}

static const struct shape_list *minus_of(const struct scene *s, const struct region *region)
{
    return region->kind == KIND_WALL    ? &s->wall[region->body].minus
           : region->kind == KIND_SOLID ? &s->solid[region->body].minus
                                        : &s->fluid[region->body].minus;
}

static void warn_of_cuts(struct sampler *g, const struct region *region)
{
    const struct shape_list *const list = minus_of(g->scene, region);
    for (int shape = 0; shape < list->n; shape++) {
        bool removes = false;
        for (int k = 0; k < region->minus.n && !removes; k++)
            removes = region->minus.shape[k] == shape &&
                      count_removed(g, region, &region->minus.item[k], 1) > 0;
        if (removes) continue;
        char place[LOCATION_TEXT];
        scene_location(g->scene, list->item[shape].line, place);
        diag_warn(g->diag,
                  "%s: `minus` removes no particle of [%s %s], because it is narrower than dp = %g "
                  "m or lies outside, so the opening is closed; enlarge or move it, or use a "
                  "smaller dp",
                  place, kind_names[region->kind], region->name, region->lattice.dp);
    }
}

/* --- between sections, and shapes of a section, of any kind --- */

/* Particles of walls and solids in one list. */
struct faces {
    struct point_grid grid;
    int64_t n, n_wall;
    double *x, *y;
    int *part; /* the shape of each, counted over all regions; -1: unknown */
    int n_parts;
};

static bool is_wall(const struct faces *f, int64_t k) { return k < f->n_wall; }

static int section_of(const struct scene *s, const struct faces *f, int64_t k)
{
    return is_wall(f, k) ? s->points[KIND_WALL].body[k]
                         : s->n_wall + s->points[KIND_SOLID].body[k - f->n_wall];
}

static const char *name_of(const struct scene *s, int section)
{
    return section < s->n_wall ? s->wall[section].common.name
                               : s->solid[section - s->n_wall].common.name;
}

/* The region of a section. */
static int region_of(const struct sampler *g, int section)
{
    const int n_wall = g->scene->n_wall;
    int k = 0;
    while (g->regions[k].kind != (section < n_wall ? KIND_WALL : KIND_SOLID) ||
           g->regions[k].body != (section < n_wall ? section : section - n_wall))
        k++;
    return k;
}

/* Shapes are told apart unless there are too many to mark each with each. */
static enum err number_parts(struct faces *f, struct sampler *g)
{
    enum { MAX_PARTS = 2000 };
    const int sections = g->scene->n_wall + g->scene->n_solid;
    int *const first = arena_alloc(&g->temp, (size_t)sections, sizeof *first, "gaps", g->diag);
    f->part = arena_alloc(&g->temp, (size_t)f->n, sizeof *f->part, "gaps", g->diag);
    if (!first || !f->part) return ERR_MEMORY;
    for (int k = 0; k < sections; k++) {
        first[k] = f->n_parts;
        f->n_parts += g->regions[region_of(g, k)].list->n;
    }
    const bool shapes = f->n_parts <= MAX_PARTS;
    if (!shapes) f->n_parts = sections;
    for (int64_t k = 0; k < f->n; k++) {
        const int section = section_of(g->scene, f, k);
        const struct region *const region = &g->regions[region_of(g, section)];
        const int shape = shapes ? geometry_shape_at(g, region, f->x[k], f->y[k]) : 0;
        f->part[k] = shape < 0 ? -1 : shapes ? first[section] + shape : section;
    }
    return ERR_OK;
}

static enum err list_faces(struct faces *f, struct sampler *g)
{
    const struct scene_points *const w = &g->scene->points[KIND_WALL],
                                     *const p = &g->scene->points[KIND_SOLID];
    f->n_wall = w->n;
    f->n = w->n + p->n;
    f->x = arena_alloc(&g->temp, (size_t)f->n, sizeof *f->x, "gaps", g->diag);
    f->y = arena_alloc(&g->temp, (size_t)f->n, sizeof *f->y, "gaps", g->diag);
    if (!f->x || !f->y) return ERR_MEMORY;
    for (int64_t k = 0; k < f->n; k++) {
        f->x[k] = k < w->n ? w->x[k] : p->x[k - w->n];
        f->y[k] = k < w->n ? w->y[k] : p->y[k - w->n];
    }
    TRY(point_grid_create(&f->grid, 2.1 * g->scene->top.dp, f->n, f->x, f->y, &g->temp, g->diag));
    for (int64_t k = 0; k < f->n; k++) point_grid_insert(&f->grid, k);
    return number_parts(f, g);
}

/* Whether a particle lies nearer to the point than `reach`, at most a cell's side. */
static bool is_covered(const struct faces *f, double x, double y, double reach)
{
    return point_grid_any(&f->grid, x, y, reach);
}

/* Whether a particle is one of a box that is not cut. */
static bool is_of_box(const struct sampler *g, const struct faces *f, int64_t k)
{
    const struct region *const region = &g->regions[region_of(g, section_of(g->scene, f, k))];
    const int shape = geometry_shape_at(g, region, f->x[k], f->y[k]);
    return region->minus.n == 0 && shape >= 0 && region->list->item[shape].kind == SHAPE_BOX;
}

/* A gap that warn_slits judges by its drawn width. */
static bool is_slit(const struct sampler *g, const struct faces *f, int64_t k, int64_t m)
{
    return is_of_box(g, f, k) && is_of_box(g, f, m);
}

struct pair_visitor {
    struct sampler *g;
    const struct faces *f;
    bool *settled; /* pairs of sections, or of shapes, that need no further look */
};
typedef void pair_function(struct pair_visitor *v, int64_t k, int64_t m);

/* Calls `visit` for each particle m > k within `reach`, at most a cell's side. */
static void visit_pairs(struct pair_visitor *v, int64_t k, double reach, pair_function *visit)
{
    const struct faces *const f = v->f;
    struct point_visit at = point_grid_visit(&f->grid, f->x[k], f->y[k], reach);
    while (point_grid_next(&f->grid, &at))
        if (at.k > k) visit(v, k, at.k);
}

/* Whether fluid could pass between two faces in both directions along the unit vector: the gap ends where
 * a face does, before another face closes it. */
static bool is_passage(const struct sampler *g, const struct faces *f, const double at[2],
                       const double along[2])
{
    const double dp = g->scene->top.dp, reach = 0.75 * dp;
    for (int way = -1; way <= 1; way += 2)
        for (double path = 0.5 * dp;; path += 0.5 * dp) {
            const double x = at[0] + way * path * along[0], y = at[1] + way * path * along[1];
            if (is_covered(f, x, y, reach)) return false;
            if (!is_covered(f, x - dp * along[1], y + dp * along[0], reach) ||
                !is_covered(f, x + dp * along[1], y - dp * along[0], reach))
                break;
        }
    return true;
}

/* Whether the sections of two particles are settled. */
static bool *mark_of_sections(const struct pair_visitor *v, int64_t k, int64_t m)
{
    const struct scene *const s = v->g->scene;
    const int a = section_of(s, v->f, k), b = section_of(s, v->f, m);
    return &v->settled[(a < b ? a : b) * (s->n_wall + s->n_solid) + (a < b ? b : a)];
}

enum { BETWEEN_TEXT = 2 * SCENE_NAME + 32 };

/* The line of the case, of a shape if it is known, and the sections between which a gap is. */
static void name_gap(const struct sampler *g, const struct faces *f, int64_t k, int64_t m,
                     char place[LOCATION_TEXT], char between[BETWEEN_TEXT])
{
    const struct scene *const s = g->scene;
    const struct region *const region = &g->regions[region_of(g, section_of(s, f, m))];
    const int shape = geometry_shape_at(g, region, f->x[m], f->y[m]);
    const int a = section_of(s, f, k), b = section_of(s, f, m);
    const char *const of = kind_names[is_wall(f, m) ? KIND_WALL : KIND_SOLID];
    scene_location(s, shape >= 0 ? region->list->item[shape].line : region->line, place);
    if (a == b)
        snprintf(between, BETWEEN_TEXT, "in [%s %s]", of, name_of(s, b));
    else
        snprintf(between, BETWEEN_TEXT, "between [%s %s] and [%s %s]",
                 kind_names[is_wall(f, k) ? KIND_WALL : KIND_SOLID], name_of(s, a), of,
                 name_of(s, b));
}

/* Warns if an empty gap lies between two particles in which at most one particle fits. Centres on both
 * sides of a gap of width w are w + dp apart. Where two lattices meet, they are up to 1.5 dp apart, and a
 * particle lies nearer to their middle than 0.75 dp. Where two faces meet at an angle, the gap is no
 * passage. */
static void warn_of_gap(struct pair_visitor *v, int64_t k, int64_t m)
{
    const struct scene *const s = v->g->scene;
    const struct faces *const f = v->f;
    const double dp = s->top.dp, dx = f->x[m] - f->x[k], dy = f->y[m] - f->y[k];
    const double r = elementary_hypot(dx, dy), at[2] = {f->x[k] + 0.5 * dx, f->y[k] + 0.5 * dy};
    const double along[2] = {-dy / r, dx / r};
    if (r < 1.5 * dp || *mark_of_sections(v, k, m) || is_covered(f, at[0], at[1], 0.75 * dp))
        return;
    if (is_slit(v->g, f, k, m) || !is_passage(v->g, f, at, along)) return;
    *mark_of_sections(v, k, m) = true;
    char place[LOCATION_TEXT], between[BETWEEN_TEXT];
    name_gap(v->g, f, k, m, place, between);
    diag_warn(v->g->diag,
              "%s: the gap %s at (%.4g, %.4g) m is no wider than dp = %g m, so hardly any fluid "
              "passes; use dp = %.2g m or less, or close the gap",
              place, between, at[0], at[1], dp, 0.5 * (r - dp));
}

/* Whether a wall or solid covers the point as drawn. */
static bool is_drawn(const struct sampler *g, double x, double y)
{
    for (int r = 0; r < g->n_regions; r++)
        if (g->regions[r].kind != KIND_FLUID && geometry_covers(g, &g->regions[r], x, y))
            return true;
    return false;
}

/* How wide the drawn shapes leave a line through the point open, up to 2 `most`; moves the point to the
 * middle. */
static double open_width(const struct sampler *g, double at[2], const double across[2], double most)
{
    const double step = 0.02 * g->scene->top.dp;
    double end[2];
    if (is_drawn(g, at[0], at[1])) return 0;
    for (int way = 0; way < 2; way++) {
        const double sign = way ? 1 : -1;
        end[way] = 0.5 * step;
        while (end[way] < most && !is_drawn(g, at[0] + sign * end[way] * across[0],
                                            at[1] + sign * end[way] * across[1]))
            end[way] += step;
    }
    for (int c = 0; c < 2; c++) at[c] += 0.5 * (end[1] - end[0]) * across[c];
    return end[0] + end[1];
}

/* The narrowest width of an opening around the point, and the direction across. */
static double narrowest(const struct sampler *g, double at[2], double across[2])
{
    enum { DIRECTIONS = 24 };
    const double from[2] = {at[0], at[1]};
    double least = HUGE_VAL;
    for (int k = 0; k < DIRECTIONS; k++) {
        const double way[2] = {elementary_cos(k * PI / DIRECTIONS),
                               elementary_sin(k * PI / DIRECTIONS)};
        double middle[2] = {from[0], from[1]};
        const double width = open_width(g, middle, way, g->scene->top.dp);
        if (width >= least) continue;
        least = width;
        for (int c = 0; c < 2; c++) at[c] = middle[c], across[c] = way[c];
    }
    return least;
}

/* Whether a gap goes on as drawn, both ways from the point, to where it is wider than dp. A wedge
 * between a circle and the floor that it touches does not. */
static bool is_drawn_passage(const struct sampler *g, const struct faces *f, const double from[2],
                             const double across[2])
{
    const double dp = g->scene->top.dp, step = 0.1 * dp;
    for (int way = -1; way <= 1; way += 2) {
        double at[2] = {from[0], from[1]}, width = 0;
        int64_t steps = 20 * f->n; /* a ring has no end */
        for (; width <= dp * one_wide && steps > 0; steps--) {
            at[0] -= way * step * across[1];
            at[1] += way * step * across[0];
            width = open_width(g, at, across, dp);
            if (width == 0) return false;
        }
        if (steps == 0) return false;
    }
    return true;
}

/* The middle of the longest stretch between two particles that their own shapes leave open. A slit of less
 * than a fortieth of their distance is meant as a joint. */
static bool find_opening(const struct pair_visitor *v, int64_t k, int64_t m, double at[2])
{
    enum { POINTS = 80 };
    const struct faces *const f = v->f;
    const struct region *const a = &v->g->regions[region_of(v->g, section_of(v->g->scene, f, k))],
                               *const b =
                                   &v->g->regions[region_of(v->g, section_of(v->g->scene, f, m))];
    int longest = 0, now = 0;
    for (int n = 0; n < POINTS; n++) {
        const double t = (n + 0.5) / POINTS, x = f->x[k] + t * (f->x[m] - f->x[k]),
                     y = f->y[k] + t * (f->y[m] - f->y[k]);
        now = geometry_covers(v->g, a, x, y) || geometry_covers(v->g, b, x, y) ? 0 : now + 1;
        if (now <= longest) continue;
        longest = now;
        const double middle = (n + 1 - 0.5 * now) / POINTS;
        at[0] = f->x[k] + middle * (f->x[m] - f->x[k]);
        at[1] = f->y[k] + middle * (f->y[m] - f->y[k]);
    }
    return longest > 2;
}

/* Whether the shapes of two particles are settled; NULL: nothing is known of them. */
static bool *mark_of_parts(const struct pair_visitor *v, int64_t k, int64_t m)
{
    const int a = v->f->part[k], b = v->f->part[m];
    if (a < 0 || b < 0 || a == b) return NULL;
    return &v->settled[(size_t)(a < b ? a : b) * (size_t)v->f->n_parts + (size_t)(a < b ? b : a)];
}

/* Warns of particles that leave no space for one between them, and whose shapes do as drawn. */
static void warn_of_closed(struct pair_visitor *v, int64_t k, int64_t m)
{
    const struct faces *const f = v->f;
    bool *const mark = mark_of_parts(v, k, m);
    double at[2] = {0}, across[2];
    if (!mark || *mark || is_slit(v->g, f, k, m) || !find_opening(v, k, m, at)) return;
    const double width = narrowest(v->g, at, across);
    if (width == 0 || !is_drawn_passage(v->g, f, at, across)) return;
    *mark = true;
    char place[LOCATION_TEXT], between[BETWEEN_TEXT];
    name_gap(v->g, f, k, m, place, between);
    diag_warn(v->g->diag,
              "%s: the gap %s at (%.4g, %.4g) m is about %.2g m wide, narrower than dp = %g m, and "
              "closed "
              "by sampling, so no fluid passes; use dp = %.1g m or less, or close the gap",
              place, between, at[0], at[1], width, v->g->scene->top.dp, 0.5 * width);
}

static enum err warn_of_gaps(struct sampler *g)
{
    const struct scene *const s = g->scene;
    const size_t sections = (size_t)s->n_wall + (size_t)s->n_solid;
    const double dp = s->top.dp;
    struct faces f = {0};
    struct pair_visitor narrow = {.g = g, .f = &f}, closed = {.g = g, .f = &f};
    TRY(list_faces(&f, g));
    const size_t parts = (size_t)f.n_parts;
    narrow.settled =
        arena_alloc(&g->temp, sections * sections, sizeof *narrow.settled, "gaps", g->diag);
    closed.settled = arena_alloc(&g->temp, parts * parts, sizeof *closed.settled, "gaps", g->diag);
    if (!narrow.settled || !closed.settled) return ERR_MEMORY;
    for (int64_t k = 0; k < f.n; k++) visit_pairs(&narrow, k, (1 + one_wide) * dp, warn_of_gap);
    for (int64_t k = 0; k < f.n; k++) visit_pairs(&closed, k, (1.5 + 1e-9) * dp, warn_of_closed);
    return ERR_OK;
}

enum err geometry_warn_of_gaps(struct sampler *g)
{
    for (int k = 0; k < g->n_regions; k++) warn_of_cuts(g, &g->regions[k]);
    if (g->scene->n_fluid == 0) return ERR_OK;
    warn_slits(g);
    return warn_of_gaps(g);
}
