/* SPDX-License-Identifier: MIT
 * Polygons from shapes; their union, moments and intervals. */
#include "geometry/outline.h"
#include "base/segment.h"
#include "base/elementary.h"

#include <stdlib.h>

/* A joint longer than this many thicknesses is too sharp and refused. */
static const double max_mitre = 4;

double polygon_area(int n, double (*const pt)[2])
{
    double twice = 0;
    for (int k = 0; k < n; k++) {
        const double *a = pt[k], *b = pt[(k + 1) % n], *base = pt[0];
        twice += (a[0] - base[0]) * (b[1] - base[1]) - (b[0] - base[0]) * (a[1] - base[1]);
    }
    return 0.5 * twice;
}

/* Sets the box of a piece, and adds it to that of all. */
static void add_box(struct outlines *o, struct outline *piece)
{
    const double *const at = piece->centre, r = piece->radius;
    piece->box = box2_empty();
    if (!piece->n) piece->box = (struct box2){{at[0] - r, at[1] - r}, {at[0] + r, at[1] + r}};
    for (int k = 0; k < piece->n; k++) box2_include(&piece->box, piece->pt[k][0], piece->pt[k][1]);
    box2_include(&o->box, piece->box.low[0], piece->box.low[1]);
    box2_include(&o->box, piece->box.high[0], piece->box.high[1]);
}

/* Unit normal to the left of the segment from point k. */
static void left_normal(const struct shape *p, int k, double normal[2])
{
    const double dx = p->pt[k + 1][0] - p->pt[k][0], dy = p->pt[k + 1][1] - p->pt[k][1];
    const double length = elementary_hypot(dx, dy);
    normal[0] = -dy / length;
    normal[1] = dx / length;
}

/* Another wall drawn as a line that meets an end of this one, and its end; NULL: none. */
static const struct shape *line_at(const struct scene *scene, const struct shape *p,
                                   const double end[2], bool *last)
{
    const double nothing = 1e-6 * fabs(p->size);
    if (!p->bare) return NULL;
    for (int k = 0; k < scene->n_wall; k++)
        for (int j = 0; j < scene->wall[k].shape.n; j++) {
            const struct shape *const q = &scene->wall[k].shape.item[j];
            if (q == p || !q->bare || q->thin || q->kind != SHAPE_POLYLINE) continue;
            for (int n = 0; n < 2; n++) {
                const double *const at = q->pt[n ? q->n - 1 : 0];
                *last = n;
                if (fabs(at[0] - end[0]) <= nothing && fabs(at[1] - end[1]) <= nothing) return q;
            }
        }
    return NULL;
}

/* Refuses lines that meet with their walls on different sides. */
static enum err check_ends(const struct scene *scene, const struct shape *p, struct diag *d)
{
    for (int k = 0; k < 2; k++) {
        bool last;
        const double *const end = p->pt[k ? p->n - 1 : 0];
        const struct shape *const q = line_at(scene, p, end, &last);
        if (q && (q->size == p->size) != (k != last))
            return fail_at(
                d, scene, p->line > q->line ? p->line : q->line,
                "this line of a wall meets the one in line %d at (%.4g, %.4g) m, but their layers "
                "are on different sides; reverse the points of the line without fluid beside it",
                p->line < q->line ? p->line : q->line, end[0], end[1]);
    }
    return ERR_OK;
}

/* The point opposite to point k, on the bisector of its two segments; false: too sharp. */
static bool mitre(const struct scene *scene, const struct shape *p, int k, double far[2])
{
    const int last = p->n - 2; /* segment */
    const double *const first = p->pt[0], *const end = p->pt[p->n - 1];
    const bool closed = p->n > 3 && first[0] == end[0] && first[1] == end[1];
    int before = k - 1, after = k;
    if (k == 0) before = closed ? last : 0;
    if (k == p->n - 1) after = closed ? 0 : last;
    double a[2], b[2];
    left_normal(p, before, a);
    left_normal(p, after, b);
    bool of_end;
    const bool end_here = !closed && (k == 0 || k == p->n - 1);
    const struct shape *const q = end_here ? line_at(scene, p, p->pt[k], &of_end) : NULL;
    if (q) {
        double *const normal = k == 0 ? a : b;
        left_normal(q, of_end ? q->n - 2 : 0, normal);
        for (int c = 0; c < 2; c++) normal[c] *= q->size / p->size;
    }
    /* The sum of the normals over 1 + their cosine is as long as 1/cos of half of their angle. */
    const double scale = 1 + a[0] * b[0] + a[1] * b[1];
    if (scale < 2 / square(max_mitre)) return false;
    far[0] = p->pt[k][0] + p->size * (a[0] + b[0]) / scale;
    far[1] = p->pt[k][1] + p->size * (a[1] + b[1]) / scale;
    return true;
}

static enum err cut_polyline(const struct scene *scene, const struct shape *p,
                             struct outline *pieces, struct arena *a, struct diag *d)
{
    double(*far)[2], (*corners)[2];
    TRY(arena_array(a, &far, p->n, "polyline", d));
    TRY(arena_array(a, &corners, 4 * p->n, "polyline", d));
    TRY(check_ends(scene, p, d));
    for (int k = 0; k < p->n; k++)
        if (!mitre(scene, p, k, far[k]))
            return fail_at(d, scene, p->line,
                           "the polyline turns too sharply at its point %d (%g, %g); use a "
                           "larger angle or insert a point",
                           k + 1, p->pt[k][0], p->pt[k][1]);
    for (int k = 0; k + 1 < p->n; k++) {
        const double along = (p->pt[k + 1][0] - p->pt[k][0]) * (far[k + 1][0] - far[k][0]) +
                             (p->pt[k + 1][1] - p->pt[k][1]) * (far[k + 1][1] - far[k][1]);
        if (along <= 0)
            return fail_at(d, scene, p->line,
                           "segment %d of the polyline is too short for a thickness of %g m: "
                           "the joints at its ends cross%s",
                           k + 1, fabs(p->size),
                           p->bare ? "; draw the wall as a `polygon` or `box`" : "");
        pieces[k].n = 4;
        pieces[k].pt = corners + 4 * k;
        memcpy(pieces[k].pt[0], p->pt[k], sizeof *far);
        memcpy(pieces[k].pt[1], p->pt[k + 1], sizeof *far);
        memcpy(pieces[k].pt[2], far[k + 1], sizeof *far);
        memcpy(pieces[k].pt[3], far[k], sizeof *far);
    }
    return ERR_OK;
}

static enum err cut_shape(const struct scene *scene, const struct shape *shape,
                          struct outline *piece, struct arena *a, struct diag *d)
{
    switch (shape->kind) {
    case SHAPE_CIRCLE:
        memcpy(piece->centre, shape->pt[0], sizeof piece->centre);
        piece->radius = shape->size;
        return ERR_OK;
    case SHAPE_POLYGON:
        piece->n = shape->n;
        piece->pt = shape->pt;
        return ERR_OK;
    case SHAPE_POLYLINE: return cut_polyline(scene, shape, piece, a, d);
    case SHAPE_BOX: break;
    }
    const double *low = shape->pt[0], *high = shape->pt[1];
    const double corners[4][2] = {{low[0], low[1]},
                                  {high[0], low[1]},
                                  {high[0], high[1]},
                                  {low[0], high[1]}};
    piece->n = 4;
    TRY(arena_array(a, &piece->pt, 4, "box", d));
    memcpy(piece->pt, corners, sizeof corners);
    return ERR_OK;
}

enum err outlines_of(struct outlines *o, const struct scene *scene, const struct shape_list *list,
                     struct arena *a, struct diag *d)
{
    size_t most = 0;
    for (int k = 0; k < list->n; k++)
        most += list->item[k].kind == SHAPE_POLYLINE ? (size_t)list->item[k].n : 1;
    o->n = 0;
    o->box = box2_empty();
    TRY(arena_array(a, &o->item, most, "shapes", d));
    TRY(arena_array(a, &o->shape, most, "shapes", d));
    for (int k = 0; k < list->n; k++) {
        const struct shape *shape = &list->item[k];
        const int pieces = shape->kind == SHAPE_POLYLINE ? shape->n - 1 : 1;
        if (shape->thin) continue;
        TRY(cut_shape(scene, shape, &o->item[o->n], a, d));
        for (int j = 0; j < pieces; j++) {
            add_box(o, &o->item[o->n]);
            o->shape[o->n++] = k;
        }
    }
    return ERR_OK;
}

void outlines_add(struct outlines *o, const struct outline *piece, int shape)
{
    o->item[o->n] = *piece;
    o->shape[o->n] = shape;
    add_box(o, &o->item[o->n++]);
}

int geometry_ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Where the line at height y crosses edge k, if it does. */
static bool edge_crossing(const struct outline *o, int k, double y, double *x)
{
    const double *a = o->pt[k], *b = o->pt[k + 1 < o->n ? k + 1 : 0];
    if ((a[1] <= y) == (b[1] <= y)) return false;
    const double *low = a[1] <= y ? a : b, *high = a[1] <= y ? b : a;
    *x = low[0] + (y - low[1]) / (high[1] - low[1]) * (high[0] - low[0]);
    return true;
}

/* The intervals of the line at height y inside a piece. `from` has memory for max(n, 2). Neighbours
 * with a common edge neither overlap nor leave a gap: both use the same arithmetic at it. */
static int crossings_of(const struct outline *o, double y, double *from)
{
    if (!o->n) {
        const double height = y - o->centre[1];
        if (fabs(height) >= o->radius) return 0;
        const double half = sqrt(square(o->radius) - square(height));
        from[0] = o->centre[0] - half;
        from[1] = o->centre[0] + half;
        return 2;
    }
    int n = 0;
    for (int k = 0; k < o->n; k++) n += edge_crossing(o, k, y, &from[n]);
    qsort(from, (size_t)n, sizeof *from, geometry_ascending);
    return n;
}

bool outline_contains(const struct outline *o, double x, double y)
{
    double crossing, ends[2];
    bool inside = false;
    if (!box2_contains(&o->box, x, y)) return false;
    if (!o->n) return crossings_of(o, y, ends) && ends[0] <= x && x < ends[1];
    for (int k = 0; k < o->n; k++) inside ^= edge_crossing(o, k, y, &crossing) && crossing <= x;
    return inside;
}

int outlines_find(const struct outlines *o, double x, double y)
{
    for (int k = 0; k < o->n; k++)
        if (outline_contains(&o->item[k], x, y)) return k;
    return -1;
}

enum err body_outlines_of(struct body_outlines *o, const struct scene *scene,
                          const struct shape_list *shape, const struct shape_list *minus,
                          struct arena *a, struct diag *d)
{
    TRY(outlines_of(&o->add, scene, shape, a, d));
    return outlines_of(&o->minus, scene, minus, a, d);
}

bool body_outlines_contain(const struct body_outlines *o, double x, double y)
{
    return outlines_find(&o->add, x, y) >= 0 && outlines_find(&o->minus, x, y) < 0;
}

enum err outlines_turn(struct outlines *o, double angle, struct arena *a, struct diag *d)
{
    if (angle == 0) return ERR_OK;
    const double c = fabs(elementary_cos(angle)) < 1e-15 ? 0 : elementary_cos(angle),
                 s = elementary_sin(angle);
    struct outline *item;
    TRY(arena_array(a, &item, o->n, "shapes", d));
    o->box = box2_empty();
    for (int k = 0; k < o->n; k++) {
        const struct outline *const from = &o->item[k];
        struct outline *const to = &item[k];
        *to = *from;
        to->centre[0] = c * from->centre[0] + s * from->centre[1];
        to->centre[1] = c * from->centre[1] - s * from->centre[0];
        TRY(arena_array(a, &to->pt, from->n, "shapes", d));
        for (int j = 0; j < from->n; j++) {
            to->pt[j][0] = c * from->pt[j][0] + s * from->pt[j][1];
            to->pt[j][1] = c * from->pt[j][1] - s * from->pt[j][0];
        }
        add_box(o, to);
    }
    o->item = item;
    return ERR_OK;
}

/* --- unions along a line --- */

int outlines_ends(const struct outlines *o)
{
    int n = 0;
    for (int k = 0; k < o->n; k++) n += o->item[k].n > 2 ? o->item[k].n : 2;
    return n;
}

static int by_start(const void *a, const void *b)
{
    const double *const x = a, *const y = b;
    if (x[0] != y[0]) return x[0] < y[0] ? -1 : 1;
    return (x[1] > y[1]) - (x[1] < y[1]);
}

/* The intervals inside any of the pieces, merged and in order. */
static int merged(const struct outlines *o, double y, double *to)
{
    int n = 0, kept = 0;
    for (int k = 0; k < o->n; k++) {
        if (y < o->item[k].box.low[1] || y > o->item[k].box.high[1]) continue;
        n += crossings_of(&o->item[k], y, to + n);
    }
    qsort(to, (size_t)(n / 2), 2 * sizeof *to, by_start);
    for (int k = 0; k + 1 < n; k += 2) {
        if (kept && to[k] <= to[kept - 1]) {
            to[kept - 1] = max2(to[kept - 1], to[k + 1]);
            continue;
        }
        to[kept] = to[k];
        to[kept + 1] = to[k + 1];
        kept += 2;
    }
    return kept;
}

int outlines_union(const struct outlines *add, const struct outlines *minus, double y, double *to,
                   double *scratch)
{
    if (!minus || minus->n == 0) return merged(add, y, to);
    double *const less = scratch + outlines_ends(add);
    const int n = merged(add, y, scratch), n_less = merged(minus, y, less);
    int count = 0;
    for (int k = 0; k < n; k += 2) {
        double from = scratch[k];
        for (int j = 0; j < n_less && from < scratch[k + 1]; j += 2) {
            if (less[j + 1] <= from || less[j] >= scratch[k + 1]) continue;
            if (less[j] > from) {
                to[count++] = from;
                to[count++] = less[j];
            }
            from = less[j + 1];
        }
        if (from >= scratch[k + 1]) continue;
        to[count++] = from;
        to[count++] = scratch[k + 1];
    }
    return count;
}

/* Appends the heights at which the pieces begin, end or bend. */
static int add_heights(const struct outlines *o, double *to)
{
    int n = 0;
    for (int k = 0; k < o->n; k++) {
        const struct outline *const piece = &o->item[k];
        for (int j = 0; j < piece->n; j++) to[n++] = piece->pt[j][1];
        if (piece->n) continue;
        to[n++] = piece->box.low[1];
        to[n++] = piece->box.high[1];
    }
    return n;
}

static void add_interval(struct moments *of, double weight, double y, double from, double to)
{
    const double length = weight * (to - from);
    of->area += length;
    of->x += 0.5 * length * (from + to);
    of->y += length * y;
    of->xx += length * (from * from + from * to + to * to) / 3;
    of->yy += length * y * y;
}

/* Gauss's two points between neighbouring heights, where the width of polygons is linear. */
enum err outlines_moments(const struct outlines *add, const struct outlines *minus, double step,
                          struct moments *of, struct arena *a, struct diag *d)
{
    const size_t capacity = (size_t)(outlines_ends(add) + outlines_ends(minus)) + 4;
    double *height, *line;
    TRY(arena_array(a, &height, capacity, "area of shapes", d));
    TRY(arena_array(a, &line, 2 * capacity, "area of shapes", d));
    int n = add_heights(add, height);
    n += add_heights(minus, height + n);
    enum { MOST = 1 << 16 }; /* parts in which Gauss' rule is exact to round-off */
    qsort(height, (size_t)n, sizeof *height, geometry_ascending);
    *of = (struct moments){0};
    for (int k = 0; k + 1 < n; k++) {
        const double high = height[k + 1] - height[k];
        const int parts = high < MOST * step ? (int)ceil(high / step) : MOST;
        for (int j = 0; j < 2 * parts; j++) {
            const double part = high / parts, gauss = 0.5 + (j % 2 ? 0.5 : -0.5) / sqrt(3);
            const double y = height[k] + (j / 2 + gauss) * part;
            const int ends = outlines_union(add, minus, y, line, line + capacity);
            for (int e = 0; e + 1 < ends; e += 2)
                add_interval(of, 0.5 * part, y, line[e], line[e + 1]);
        }
    }
    return ERR_OK;
}

bool outlines_edge_within(const struct outlines *o, double x, double y, double reach)
{
    const double place[2] = {x, y};
    const struct box2 at = {{x, y}, {x, y}};
    for (int k = 0; k < o->n; k++) {
        const struct outline *const piece = &o->item[k];
        if (!box2_near(&at, &piece->box, reach)) continue;
        if (piece->n == 0 && fabs(elementary_hypot(x - piece->centre[0], y - piece->centre[1]) -
                                  piece->radius) <= reach)
            return true;
        for (int j = 0; j < piece->n; j++)
            if (segment_foot(place, piece->pt[j], piece->pt[j + 1 < piece->n ? j + 1 : 0], 0)
                    .distance <= reach)
                return true;
    }
    return false;
}
