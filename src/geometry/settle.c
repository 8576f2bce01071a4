/* SPDX-License-Identifier: MIT
 * Fluid near edges off its lattice. The cells with their centre inside the shape
 * and not too near to a wall cover less than its area, and the level falls. So as many of the
 * cells that such edges cut are filled as their parts inside the shape add up to, on each side of
 * thin lines. Then the particles there are moved until a uniform pressure pushes none of them
 * (T-80; particle packing, Colagrossi et al. 2012). */
#include "geometry/thin.h"
#include "geometry/sampling.h"
#include "base/point_grid.h"
#include "particles/kernel.h"

/* Lines through a cell, for its area in the shape: that a slanted edge cuts, or one along them. */
enum { LINES = 16, LEVEL_LINES = 256 };
/* Slope of an edge that counts as one along the lattice. */
static const double along_lattice = 1e-6;
/* Fluid this much of dp too near to a thin line is still on the lattice. */
static const double beside_line = 1e-3;
/* A shift is this times h^2 grad C, below the limit of 0.5 of Lind et al. 2012, and at most
 * `longest` dp. The shifts end when all are below `still` dp. */
static const double shift_factor = 0.2, longest = 0.1, still = 1e-4;
static const int max_shifts = 1000;

/* The cells that slanted edges of a region cut, in the order of the edges; in lattice cells. */
struct cut_cells {
    const struct region *region;
    struct point_grid grid; /* their centres */
    int64_t n_slanted;      /* of them; faces of beams along the lattice cut the others */
    struct cut_part {       /* of a cell in the shape, on the right and left of the nearest line */
        double share, middle[2];
    } (*part)[2];
};

/* --- cells --- */

/* Adds the cell of a point of an edge with this normal, unless both sides are in the shape. */
static enum err visit(struct cut_cells *c, struct sampler *sampler, const double at[2],
                      const double normal[2])
{
    const double step = 1e-3 * c->region->lattice.dp;
    if ((geometry_piece_at(c->region, at[0] + step * normal[0], at[1] + step * normal[1]) < 0) ==
        (geometry_piece_at(c->region, at[0] - step * normal[0], at[1] - step * normal[1]) < 0))
        return ERR_OK;
    const struct scene_lattice *const l = &c->region->lattice;
    const double i = floor((at[0] - l->origin[0]) / l->spacing[0]) + 0.5,
                 j = floor((at[1] - l->origin[1]) / l->spacing[1]) + 0.5;
    return point_grid_any(&c->grid, i, j, 0.5)
               ? ERR_OK
               : point_grid_add(&c->grid, i, j, &sampler->temp, sampler->diag);
}

/* Whether an edge along the lattice lies between its lines. */
static bool lies_between(const struct scene_lattice *l, const double at[2], int across)
{
    const double cells = (at[across] - l->origin[across]) / l->spacing[across];
    return fabs(cells - round(cells)) > beside_line;
}

/* `level`: an edge along the lattice, between its lines; else: a slanted one. */
static enum err visit_edge(struct cut_cells *c, struct sampler *sampler, const double a[2],
                           const double b[2], bool level)
{
    const double dx = b[0] - a[0], dy = b[1] - a[1], length = elementary_hypot(dx, dy);
    const bool along = min2(fabs(dx), fabs(dy)) <= along_lattice * length;
    if (along != level || (level && !lies_between(&c->region->lattice, a, fabs(dx) > fabs(dy))))
        return ERR_OK;
    const double normal[2] = {-dy / length, dx / length};
    const int parts = 1 + (int)min2(1e8, length / c->region->lattice.dp * EDGE_PARTS);
    for (int k = 0; k < parts; k++) {
        const double s = (k + 0.5) / parts, at[2] = {a[0] + s * dx, a[1] + s * dy};
        TRY(visit(c, sampler, at, normal));
    }
    return ERR_OK;
}

static enum err visit_circle(struct cut_cells *c, struct sampler *sampler, const struct outline *o)
{
    const int parts = 1 + (int)min2(1e8, 2 * PI * o->radius / c->region->lattice.dp * EDGE_PARTS);
    for (int k = 0; k < parts; k++) {
        const double angle = 2 * PI * k / parts,
                     normal[2] = {elementary_cos(angle), elementary_sin(angle)},
                     at[2] = {o->centre[0] + o->radius * normal[0],
                              o->centre[1] + o->radius * normal[1]};
        TRY(visit(c, sampler, at, normal));
    }
    return ERR_OK;
}

static enum err visit_outlines(struct cut_cells *c, struct sampler *sampler,
                               const struct outlines *o, bool level)
{
    for (int k = 0; k < o->n; k++) {
        const struct outline *const piece = &o->item[k];
        if (level && o->shape[k] >= 0) continue;
        if (piece->n == 0 && !level) TRY(visit_circle(c, sampler, piece));
        for (int j = 0; j < piece->n; j++)
            TRY(visit_edge(c, sampler, piece->pt[j], piece->pt[(j + 1) % piece->n], level));
    }
    return ERR_OK;
}

/* The parts of the cell with this centre, from zeros. `line` and `scratch`: see outlines_union. */
static void find_parts(const struct scene *scene, const struct region *r, const double centre[2],
                       int lines, struct cut_part part[2], double *line, double *scratch)
{
    const struct scene_lattice *const l = &r->lattice;
    for (int n = 0; n < lines; n++) {
        const double y = centre[1] - 0.5 + (n + 0.5) / lines;
        const int ends =
            outlines_union(&r->add, &r->minus, l->origin[1] + y * l->spacing[1], line, scratch);
        for (int e = 0; e + 1 < ends; e += 2) {
            const double low = max2((line[e] - l->origin[0]) / l->spacing[0], centre[0] - 0.5),
                         high = min2((line[e + 1] - l->origin[0]) / l->spacing[0], centre[0] + 0.5);
            double at[2], left;
            if (high <= low) continue;
            place_of_cell(l, (const double[]){0.5 * (low + high), y}, at);
            geometry_line_distance(scene, at, &left);
            struct cut_part *const to = &part[left > 0];
            to->share += (high - low) / lines;
            to->middle[0] += (high - low) / lines * 0.5 * (low + high);
            to->middle[1] += (high - low) / lines * y;
        }
    }
    for (int k = 0; k < 4; k++) part[k / 2].middle[k % 2] /= max2(part[k / 2].share, 1e-300);
}

static enum err find_cells(struct cut_cells *c, struct sampler *sampler,
                           const struct region *region)
{
    *c = (struct cut_cells){.region = region, .grid.side = 1};
    TRY(visit_outlines(c, sampler, &region->add, false));
    TRY(visit_outlines(c, sampler, &region->minus, false));
    c->n_slanted = c->grid.n;
    TRY(visit_outlines(c, sampler, &region->minus, true));
    const size_t n = (size_t)c->grid.n + 1;
    const size_t ends = (size_t)(outlines_ends(&region->add) + outlines_ends(&region->minus)) + 4;
    double *line;
    TRY(geometry_array(sampler, &line, 2 * ends));
    TRY(geometry_array(sampler, &c->part, n));
    for (int64_t k = 0; k < c->grid.n; k++)
        find_parts(sampler->scene, region, (const double[]){c->grid.x[k], c->grid.y[k]},
                   k < c->n_slanted ? LINES : LEVEL_LINES, c->part[k], line, line + ends);
    return ERR_OK;
}

/* --- particles --- */

/* All regions together. */
struct settling {
    struct sampler *sampler;
    struct point_grid cells, air; /* cut by an edge; near them, perhaps outside all shapes */
    int64_t n, n_free;            /* points; those that may move come first */
    double *x, *y, *volume;
    int64_t *particle; /* of a free point: its index */
    int *line;         /* the thin line that a point belongs to, from 1; 0: none */
};

/* Copies the particles of a region, with new ones in its cut cells. Along the edge a cell is
 * filled when the sum of the shares exceeds the number of filled cells by a half. Beside a beam
 * along the lattice, cells that keep their particle have it where it was. */
static enum err refill(struct settling *s, const struct cut_cells *c, struct scene_points *to)
{
    const struct scene *const scene = s->sampler->scene;
    const struct scene_points *const from = &scene->points[KIND_FLUID];
    const struct scene_lattice *const l = &c->region->lattice;
    for (int64_t k = 0; k < from->n; k++) {
        double cell[2];
        if (from->body[k] != c->region->body) continue;
        cell_of_place(l, from->x[k], from->y[k], cell);
        if (point_grid_any(&c->grid, cell[0], cell[1], 0.1)) continue;
        to->x[to->n] = from->x[k];
        to->y[to->n] = from->y[k];
        to->body[to->n++] = from->body[k];
    }
    double excess[2] = {0, 0}; /* sum of the shares less the filled parts, on each side */
    for (int64_t k = 0; k < 2 * c->grid.n; k++) {
        const double cell[2] = {c->grid.x[k / 2], c->grid.y[k / 2]};
        const struct cut_part *const part = &c->part[k / 2][k % 2];
        double at[2], left;
        place_of_cell(l, cell, at);
        geometry_line_distance(scene, at, &left);
        const bool level = k >= 2 * c->n_slanted,
                   drawn = level && (left > 0) == k % 2 && geometry_covers(c->region, at[0], at[1]),
                   filled = (excess[k % 2] += part->share) >= 0.5;
        if (!level || drawn != filled)
            TRY(point_grid_add(&s->cells, cell[0], cell[1], &s->sampler->temp, s->sampler->diag));
        if (!filled) continue;
        excess[k % 2]--;
        if (!drawn) place_of_cell(l, part->middle, at);
        to->x[to->n] = at[0];
        to->y[to->n] = at[1];
        to->body[to->n++] = c->region->body;
    }
    return ERR_OK;
}

/* Fluid that begins nearer to a thin line than half a spacing: its cells are cut. */
static enum err visit_lines(struct settling *s)
{
    const struct scene *const scene = s->sampler->scene;
    const struct scene_points *const p = &scene->points[KIND_FLUID];
    const double near = (0.5 - beside_line) * scene->top.dp;
    if (scene->n_thin == 0) return ERR_OK;
    for (int64_t k = 0; k < p->n; k++) {
        const double at[2] = {p->x[k], p->y[k]};
        double cell[2], left;
        if (geometry_line_distance(scene, at, &left) >= near) continue;
        cell_of_place(&scene->lattice, at[0], at[1], cell);
        TRY(point_grid_add(&s->cells, cell[0], cell[1], &s->sampler->temp, s->sampler->diag));
    }
    return ERR_OK;
}

/* Whether a position is within `reach` smoothing lengths of a cut cell. */
static bool beside(const struct settling *s, double x, double y, double reach)
{
    const struct scene *const scene = s->sampler->scene;
    double at[2];
    cell_of_place(&scene->lattice, x, y, at);
    return point_grid_any(&s->cells, at[0], at[1], reach * scene->h / scene->top.dp);
}

/* What covers a place in the lattice: a shape of fluid, any other, or none. */
enum cover { COVER_NONE, COVER_FLUID, COVER_BODY };

static enum cover cover_of(const struct sampler *sampler, const double cell[2])
{
    enum cover found = COVER_NONE;
    double at[2];
    place_of_cell(&sampler->scene->lattice, cell, at);
    if (geometry_keep_off(sampler->scene, 0, at)) return COVER_BODY;
    for (int r = 0; r < sampler->n_regions && found != COVER_BODY; r++)
        if (geometry_covers(&sampler->regions[r], at[0], at[1]))
            found = sampler->regions[r].kind == KIND_FLUID ? COVER_FLUID : COVER_BODY;
    return found;
}

/* The parts of the cell with this centre on both sides of the nearest line, with their shares of
 * air. Beside fluid alone the middle of a part decides, as for fluid. Beside walls and bodies,
 * whose particles are not in the lattice, it is the share of points in it. Their rows and columns
 * differ in number, so that an edge along the diagonal meets one of them at most. */
static void find_air(const struct sampler *sampler, const double cell[2], struct cut_part part[2])
{
    enum { COLUMNS = 8, ROWS_OF_CELL = 7, POINTS = COLUMNS * ROWS_OF_CELL };
    int air[2] = {0, 0}, n[2] = {0, 0}, body = 0;
    double sum[2][2] = {{0}};
    for (int k = 0; k < POINTS; k++) {
        const double off[2] = {(k % COLUMNS - 0.5 * (COLUMNS - 1)) / COLUMNS,
                               (k / COLUMNS - 0.5 * (ROWS_OF_CELL - 1)) / ROWS_OF_CELL},
                     of_cell[2] = {cell[0] + off[0], cell[1] + off[1]};
        double at[2], left;
        place_of_cell(&sampler->scene->lattice, of_cell, at);
        geometry_line_distance(sampler->scene, at, &left);
        const int side = left > 0;
        const enum cover cover = cover_of(sampler, of_cell);
        air[side] += cover == COVER_NONE;
        body += cover == COVER_BODY;
        n[side]++;
        for (int c = 0; c < 2; c++) sum[side][c] += off[c];
    }
    for (int k = 0; k < 2; k++) {
        for (int c = 0; c < 2; c++) part[k].middle[c] = cell[c] + sum[k][c] / max2(n[k], 1);
        if (!body) air[k] = cover_of(sampler, part[k].middle) == COVER_NONE ? n[k] : 0;
        part[k].share = (double)air[k] / POINTS;
    }
}

/* Lattice cells count as points by their share outside shapes: nothing moves into the air. */
static enum err add_air(struct settling *s)
{
    struct sampler *const sampler = s->sampler;
    const int64_t around =
        (int64_t)ceil(2 * KERNEL_REACH * sampler->scene->h / sampler->scene->top.dp);
    for (int64_t k = 0; k < s->cells.n; k++)
        for (int64_t j = -around; j <= around; j++)
            for (int64_t i = -around; i <= around; i++) {
                const double cell[2] = {s->cells.x[k] + (double)i, s->cells.y[k] + (double)j};
                if (!point_grid_any(&s->air, cell[0], cell[1], 0.1))
                    TRY(point_grid_add(&s->air, cell[0], cell[1], &sampler->temp, sampler->diag));
            }
    return ERR_OK;
}

static void add_point(struct settling *s, double x, double y, double volume)
{
    s->x[s->n] = x;
    s->y[s->n] = y;
    s->volume[s->n++] = volume;
}

/* The points that take part: fluid within the kernel's reach of a cut cell, which alone moves. */
static enum err gather(struct settling *s)
{
    struct sampler *const sampler = s->sampler;
    const struct scene *const scene = sampler->scene;
    size_t n = 2 * (size_t)s->air.n;
    for (int kind = 0; kind < KIND_COUNT; kind++) n += (size_t)scene->points[kind].n;
    TRY(geometry_array(sampler, &s->x, n));
    TRY(geometry_array(sampler, &s->y, n));
    TRY(geometry_array(sampler, &s->volume, n));
    TRY(geometry_array(sampler, &s->particle, n));
    TRY(geometry_array(sampler, &s->line, n));
    for (int fixed = 0; fixed < 2; fixed++) {
        for (int kind = 0; kind < (fixed ? KIND_COUNT : KIND_FLUID + 1); kind++) {
            const struct scene_points *const from = &scene->points[kind];
            for (int64_t k = 0; k < from->n; k++) {
                const bool moves =
                    kind == KIND_FLUID && beside(s, from->x[k], from->y[k], KERNEL_REACH);
                if (moves == (fixed == 1) ||
                    !beside(s, from->x[k], from->y[k], 2 * KERNEL_REACH + 1))
                    continue;
                if (moves) s->particle[s->n] = k;
                const int line = kind == KIND_WALL ? scene_thin_line_of(scene, k) : 0;
                const struct scene_thin_line *const of = line ? &scene->thin[line - 1] : NULL;
                const struct line_dummy *const dummy = of ? &of->dummy[k - of->first] : NULL;
                if (dummy && !dummy->same_side) s->line[s->n] = line;
                const double dp =
                    kind == KIND_SOLID ? scene_solid_dp(scene, from->body[k]) : scene->top.dp;
                add_point(s, from->x[k], from->y[k],
                          square(dp) * (from->volume ? from->volume[k] : 1));
            }
        }
        if (!fixed) s->n_free = s->n;
    }
    for (int64_t k = 0; k < s->air.n; k++) {
        struct cut_part part[2];
        find_air(sampler, (const double[]){s->air.x[k], s->air.y[k]}, part);
        for (int side = 0; side < 2; side++) {
            double at[2];
            place_of_cell(&scene->lattice, part[side].middle, at);
            if (part[side].share > 0)
                add_point(s, at[0], at[1], part[side].share * square(scene->top.dp));
        }
    }
    return ERR_OK;
}

/* Minus the gradient of C, 1/m (T-80). */
static void push(const struct settling *s, const struct point_grid *t, int64_t k, double sum[2])
{
    const double h = s->sampler->scene->h, x = s->x[k], y = s->y[k];
    sum[0] = sum[1] = 0;
    struct point_visit v = point_grid_visit(t, x, y, KERNEL_REACH * h);
    while (point_grid_next(t, &v)) {
        const double from[2] = {x, y}, to[2] = {s->x[v.k], s->y[v.k]};
        if (geometry_between(s->sampler->scene, from, to) != s->line[v.k]) continue;
        const double dx = x - s->x[v.k], dy = y - s->y[v.k], r = sqrt(dx * dx + dy * dy);
        const double factor = -s->volume[v.k] * kernel_slope(r, h);
        sum[0] += factor * dx;
        sum[1] += factor * dy;
    }
}

/* The shifts of T-80. Between two dummies the push vanishes, so fluid keeps off faces by itself
 * only if nothing crowds it: half a spacing is required. */
static enum err settle(struct settling *s)
{
    struct sampler *const sampler = s->sampler;
    const double h = sampler->scene->h, dp = sampler->scene->top.dp;
    struct point_grid t;
    TRY(point_grid_create(&t, KERNEL_REACH * h, s->n, s->x, s->y, &sampler->temp, sampler->diag));
    double(*move)[2];
    TRY(geometry_array(sampler, &move, s->n_free + 1));
    double largest = HUGE_VAL;
    for (int step = 0; step < max_shifts && largest > still * dp; step++) {
        largest = 0;
        point_grid_clear(&t);
        for (int64_t k = 0; k < s->n; k++) point_grid_insert(&t, k);
        for (int64_t k = 0; k < s->n_free; k++) push(s, &t, k, move[k]);
        for (int64_t k = 0; k < s->n_free; k++) {
            for (int c = 0; c < 2; c++) move[k][c] *= shift_factor * square(h);
            const double length = elementary_hypot(move[k][0], move[k][1]);
            const double part = min2(1, longest * dp / max2(length, 1e-300));
            double to[2] = {s->x[k] + part * move[k][0], s->y[k] + part * move[k][1]};
            geometry_keep_off(sampler->scene, 0.5 * dp, to);
            largest = max2(largest, elementary_hypot(to[0] - s->x[k], to[1] - s->y[k]));
            s->x[k] = to[0];
            s->y[k] = to[1];
        }
    }
    return ERR_OK;
}

enum err geometry_settle(struct sampler *sampler)
{
    struct scene *const scene = sampler->scene;
    struct scene_points *const points = &scene->points[KIND_FLUID];
    if (scene->top.scheme != SCHEME_STANDARD || points->n == 0) return ERR_OK;
    struct cut_cells *cut;
    TRY(geometry_array(sampler, &cut, scene->n_fluid));
    int64_t most = 0;
    int n_cut = 0;
    for (int k = 0; k < sampler->n_regions; k++) {
        if (sampler->regions[k].kind != KIND_FLUID) continue;
        TRY(find_cells(&cut[n_cut], sampler, &sampler->regions[k]));
        most += cut[n_cut++].grid.n;
    }
    struct settling settling = {.sampler = sampler,
                                .cells.side = KERNEL_REACH * scene->h / scene->top.dp,
                                .air.side = 1};
    TRY(visit_lines(&settling));
    if (most == 0 && settling.cells.n == 0) return ERR_OK;
    struct scene_points to;
    TRY(geometry_points(sampler, KIND_FLUID, points->n + most, false, &to));
    for (int k = 0; k < n_cut; k++) TRY(refill(&settling, &cut[k], &to));
    *points = to;
    scene->settled = settling.cells.n > 0;
    TRY(add_air(&settling));
    TRY(gather(&settling));
    TRY(settle(&settling));
    for (int64_t k = 0; k < settling.n_free; k++) {
        points->x[settling.particle[k]] = settling.x[k];
        points->y[settling.particle[k]] = settling.y[k];
    }
    return ERR_OK;
}
