/* SPDX-License-Identifier: MIT
 * Layer k of a wall consists of the points (k + 1/2) dp from the nearest point of its faces:
 * segments beside edges, cut at convex corners by those of the next edge, and arcs around concave
 * corners. Along a layer the points are evenly spaced, as near to dp as a whole number of them
 * allows. */
#include "geometry/sampling.h"
#include "base/elementary.h"
#include "base/point_grid.h"

/* Two points of a wall nearer than this many dp count as one. */
static const double coincident = 0.65;

/* Faces from which layers are measured. A polyline has its own, on the drawn side, and layers
 * through its thickness. All others have one set, and layers as deep as the kernel reaches. */
struct face_set {
    struct point_grid grid; /* the exposed parts of the faces */
    double spacing, depth;  /* of layers; down to which they go, m */
    int first, end;         /* pieces */
};

struct layers {
    struct sampler *g;
    const struct region *region;
    double dp;
    int n_sets;
    struct face_set *set;
    struct point_grid points; /* of the region: of its lattice, of its layers */
};

/* --- choice of pieces --- */

/* Whether all edges of a shape are along the lattice, but the joints of a polyline's segments. */
static bool along_lattice(const struct shape *shape, const struct region *region)
{
    const double c = region->lattice.turn[0], s = region->lattice.turn[1],
                 tolerance = 1e-9 * region->lattice.dp;
    if (shape->kind == SHAPE_CIRCLE) return false;
    if (shape->kind == SHAPE_BOX) return region->lattice.angle == 0;
    const int edges = shape->kind == SHAPE_POLYGON ? shape->n : shape->n - 1;
    for (int k = 0; k < edges; k++) {
        const double *a = shape->pt[k], *b = shape->pt[(k + 1) % shape->n];
        const double dx = b[0] - a[0], dy = b[1] - a[1];
        if (fabs(c * dx + s * dy) > tolerance && fabs(c * dy - s * dx) > tolerance) return false;
    }
    return true;
}

enum err geometry_choose_layered(struct sampler *sampler, struct region *region)
{
    TRY(geometry_array(sampler, &region->layered, region->add.n));
    if (region->kind != KIND_WALL) return ERR_OK;
    const struct shape_list *const minus = &sampler->scene->wall[region->body].minus;
    bool all = false;
    for (int k = 0; k < minus->n; k++) all |= !along_lattice(&minus->item[k], region);
    for (int k = 0; k < region->add.n; k++) {
        const struct shape *const shape = &region->list->item[region->add.shape[k]];
        region->layered[k] = all || !along_lattice(shape, region);
        region->has_layers |= region->layered[k];
    }
    return ERR_OK;
}

/* --- loops --- */

/* An outline that is followed with the wall on its left. */
struct loop {
    int n;
    double (*pt)[2];
    bool open;     /* no edge from the last point to the first */
    bool reversed; /* the points are in the order that has the wall on its right */
};

static int edges_of(const struct loop *o) { return o->open ? o->n - 1 : o->n; }

static enum err loop_of_circle(const struct outline *o, double dp, struct loop *to,
                               struct sampler *sampler)
{
    const double wanted = 2 * PI * o->radius / dp * EDGE_PARTS;
    to->n = wanted < 32 ? 32 : wanted > 1e6 ? 1000000 : (int)wanted;
    TRY(geometry_array(sampler, &to->pt, to->n));
    for (int k = 0; k < to->n; k++) {
        to->pt[k][0] = o->centre[0] + o->radius * elementary_cos(2 * PI * k / to->n);
        to->pt[k][1] = o->centre[1] + o->radius * elementary_sin(2 * PI * k / to->n);
    }
    return ERR_OK;
}

/* The outline of a piece, or the drawn side of a polyline, from its pieces `first` to `end`. */
static enum err make_loop(const struct outlines *o, int first, int end, bool polyline,
                          bool wall_inside, double dp, struct loop *to, struct sampler *sampler)
{
    const struct outline *const piece = &o->item[first];
    *to = (struct loop){.n = piece->n, .pt = piece->pt};
    if (piece->n == 0) TRY(loop_of_circle(piece, dp, to, sampler));
    to->reversed = (polygon_area(to->n, to->pt) > 0) != wall_inside;
    if (!polyline) return ERR_OK;
    to->n = end - first + 1;
    to->open = true;
    TRY(geometry_array(sampler, &to->pt, to->n));
    for (int k = 0; k < to->n; k++)
        memcpy(to->pt[k], k < to->n - 1 ? piece[k].pt[0] : piece[k - 1].pt[1], sizeof *to->pt);
    return ERR_OK;
}

/* --- faces --- */

/* Whether a point is in a piece that is sampled on the lattice. */
static bool on_the_lattice(const struct layers *l, double x, double y)
{
    const struct region *const r = l->region;
    for (int k = 0; k < r->add.n; k++)
        if (!r->layered[k] && outline_contains(&r->add.item[k], x, y)) return true;
    return false;
}

/* One edge of a loop. */
struct edge {
    double a[2], along[2], in[2], length;
    int parts;
};

static struct edge edge_of(const struct loop *o, int k, double dp)
{
    const int next = (k + 1) % o->n, last = o->n - 1;
    const double *const a = o->pt[o->reversed ? last - k : k],
                        *const b = o->pt[o->reversed ? last - next : next];
    const double length = elementary_hypot(b[0] - a[0], b[1] - a[1]);
    struct edge e = {.a = {a[0], a[1]}, .length = length};
    if (length <= 1e-9 * dp) return e;
    e.along[0] = (b[0] - a[0]) / length;
    e.along[1] = (b[1] - a[1]) / length;
    e.in[0] = -e.along[1];
    e.in[1] = e.along[0];
    e.parts = 1 + (int)min2(1e8, length / dp * EDGE_PARTS);
    return e;
}

static void part_of(const struct edge *e, int k, double depth, double at[2])
{
    const double s = (k + 0.5) * e->length / e->parts;
    for (int c = 0; c < 2; c++) at[c] = e->a[c] + s * e->along[c] + depth * e->in[c];
}

/* Whether a part of an edge is a face: wall on its left, no wall on its right. */
static bool exposed(const struct layers *l, const struct edge *e, int k)
{
    double left[2], right[2];
    part_of(e, k, 1e-3 * l->dp, left);
    part_of(e, k, -1e-3 * l->dp, right);
    return geometry_piece_at(l->region, left[0], left[1]) >= 0 &&
           geometry_piece_at(l->region, right[0], right[1]) < 0;
}

static enum err add_faces(struct layers *l, struct face_set *set, const struct loop *o)
{
    for (int k = 0; k < edges_of(o); k++) {
        const struct edge e = edge_of(o, k, l->dp);
        for (int j = 0; j < e.parts; j++) {
            double at[2];
            part_of(&e, j, 0, at);
            if (exposed(l, &e, j))
                TRY(point_grid_add(&set->grid, at[0], at[1], &l->g->temp, l->g->diag));
        }
    }
    return ERR_OK;
}

/* --- layers --- */

/* Points of a layer before they are evenly spaced. */
struct trace {
    const struct face_set *set;
    double depth;
    int64_t n;
    double (*pt)[2];
};

static enum err trace_add(struct layers *l, struct trace *t, const double at[2])
{
    if (point_grid_any(&t->set->grid, at[0], at[1], t->depth - 0.01 * l->dp) ||
        geometry_piece_at(l->region, at[0], at[1]) < 0 || on_the_lattice(l, at[0], at[1]))
        return ERR_OK;
    TRY(arena_more(&l->g->temp, &t->pt, t->n, "walls", l->g->diag));
    memcpy(t->pt[t->n++], at, 2 * sizeof *at);
    return ERR_OK;
}

/* The arc around a concave corner between two edges. */
static enum err trace_corner(struct layers *l, struct trace *t, const struct edge *e,
                             const struct edge *next)
{
    const double depth = t->depth;
    const double turn =
        elementary_atan2(e->along[0] * next->along[1] - e->along[1] * next->along[0],
                         e->along[0] * next->along[0] + e->along[1] * next->along[1]);
    if (!(turn < 0) || !exposed(l, e, e->parts - 1) || !exposed(l, next, 0)) return ERR_OK;
    const int parts = 1 + (int)(-turn * depth / l->dp * EDGE_PARTS);
    for (int k = 0; k < parts; k++) {
        const double angle = turn * (k + 0.5) / parts, c = elementary_cos(angle),
                     s = elementary_sin(angle);
        const double at[2] = {next->a[0] + depth * (c * e->in[0] - s * e->in[1]),
                              next->a[1] + depth * (c * e->in[1] + s * e->in[0])};
        TRY(trace_add(l, t, at));
    }
    return ERR_OK;
}

static enum err trace_loop(struct layers *l, struct trace *t, const struct loop *o)
{
    const int edges = edges_of(o);
    for (int k = 0; k < edges; k++) {
        const bool last = o->open && k == edges - 1;
        const struct edge e = edge_of(o, k, l->dp), next = edge_of(o, (k + 1) % edges, l->dp);
        for (int j = 0; j < e.parts; j++) {
            double at[2];
            part_of(&e, j, t->depth, at);
            if (exposed(l, &e, j)) TRY(trace_add(l, t, at));
        }
        if (e.parts && next.parts && !last) TRY(trace_corner(l, t, &e, &next));
    }
    return ERR_OK;
}

static double gap(const struct trace *t, int64_t a, int64_t b)
{
    a %= t->n;
    b %= t->n;
    return elementary_hypot(t->pt[b][0] - t->pt[a][0], t->pt[b][1] - t->pt[a][1]);
}

/* Adds a point unless there is already one at its place. */
static enum err add_new_point(struct layers *l, double x, double y)
{
    if (point_grid_any(&l->points, x, y, coincident * l->dp)) return ERR_OK;
    return point_grid_add(&l->points, x, y, &l->g->temp, l->g->diag);
}

/* Points at equal distances along the trace from `first` to `last`. */
static enum err space_out(struct layers *l, const struct trace *t, int64_t first, int64_t last)
{
    double length = 0;
    for (int64_t k = first; k < last; k++) length += gap(t, k, k + 1);
    const double count = max2(1, round(length / l->dp)), step = length / count;
    double passed = 0, wanted = 0.5 * step;
    int64_t k = first;
    for (double n = 0; n < count; n++, wanted += step) {
        while (k < last - 1 && passed + gap(t, k, k + 1) < wanted) {
            passed += gap(t, k, k + 1);
            k++;
        }
        const double *a = t->pt[k % t->n], *b = t->pt[(k < last ? k + 1 : k) % t->n];
        const double between = gap(t, k, k < last ? k + 1 : k);
        const double share = between > 0 ? (wanted - passed) / between : 0;
        TRY(add_new_point(l, a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])));
    }
    return ERR_OK;
}

/* A trace is cut at its jumps; one without jumps is closed. */
static enum err space_runs(struct layers *l, const struct trace *t)
{
    const double leap = 0.5 * l->dp;
    int64_t start = 0;
    while (start < t->n && gap(t, start + t->n - 1, start) <= leap) start++;
    if (start == t->n) return t->n ? space_out(l, t, 0, t->n) : ERR_OK;
    for (int64_t k = start; k < start + t->n;) {
        int64_t last = k;
        while (last + 1 < start + t->n && gap(t, last, last + 1) <= leap) last++;
        TRY(space_out(l, t, k, last));
        k = last + 1;
    }
    return ERR_OK;
}

/* --- all layers --- */

static const struct shape *shape_of(const struct region *r, int piece)
{
    return &r->list->item[r->add.shape[piece]];
}

static bool is_polyline(const struct region *r, int piece)
{
    return shape_of(r, piece)->kind == SHAPE_POLYLINE;
}

typedef enum err visitor(struct layers *, struct face_set *, const struct loop *);

/* Calls for each loop of a set; `minus` limits those that are not polylines. */
static enum err each_loop(struct layers *l, struct face_set *set, visitor *visit)
{
    const struct region *const r = l->region;
    struct loop loop;
    if (set->end > set->first) {
        TRY(make_loop(&r->add, set->first, set->end, true, true, l->dp, &loop, l->g));
        return visit(l, set, &loop);
    }
    for (int k = 0; k < r->add.n; k++) {
        if (!r->layered[k] || is_polyline(r, k)) continue;
        TRY(make_loop(&r->add, k, k + 1, false, true, l->dp, &loop, l->g));
        TRY(visit(l, set, &loop));
    }
    for (int k = 0; k < r->minus.n; k++) {
        TRY(make_loop(&r->minus, k, k + 1, false, false, l->dp, &loop, l->g));
        TRY(visit(l, set, &loop));
    }
    return ERR_OK;
}

static enum err find_faces(struct layers *l, struct sampler *sampler, const struct region *region)
{
    const double dp = region->lattice.dp;
    *l = (struct layers){.g = sampler, .region = region, .dp = dp, .points = {.side = dp}};
    TRY(geometry_array(sampler, &l->set, (size_t)region->add.n + 1));
    l->set[l->n_sets++] =
        (struct face_set){.spacing = dp, .depth = dp * (1 + ceil(2 * sampler->scene->h / dp))};
    for (int k = 0, end; k < region->add.n; k = end) {
        for (end = k + 1; end < region->add.n && region->add.shape[end] == region->add.shape[k];)
            end++;
        if (!region->layered[k] || !is_polyline(region, k)) continue;
        const double thick = fabs(shape_of(region, k)->size), count = max2(1, round(thick / dp));
        l->set[l->n_sets++] =
            (struct face_set){.spacing = thick / count, .depth = thick, .first = k, .end = end};
    }
    for (int k = 0; k < l->n_sets; k++) {
        l->set[k].grid.side = dp;
        TRY(each_loop(l, &l->set[k], add_faces));
    }
    return ERR_OK;
}

static enum err trace_all(struct layers *l, struct face_set *set, const struct loop *o)
{
    for (double layer = 0.5; layer * set->spacing < set->depth; layer++) {
        struct trace t = {.set = set, .depth = layer * set->spacing};
        TRY(trace_loop(l, &t, o));
        TRY(space_runs(l, &t));
    }
    return ERR_OK;
}

/* A place on the lattice behind the last layer. */
static bool is_behind(const struct layers *l, double x, double y)
{
    bool behind = true;
    for (int k = 0; k < l->n_sets; k++)
        behind &= !point_grid_any(&l->set[k].grid, x, y, l->set[k].depth);
    return behind;
}

enum err geometry_lay_layers(struct sampler *sampler, const struct region *region, int64_t from,
                             const struct samples *layered, struct samples *to)
{
    struct layers l;
    TRY(find_faces(&l, sampler, region));
    for (int64_t k = from; k < to->n; k++)
        TRY(point_grid_add(&l.points, to->x[k], to->y[k], &sampler->temp, sampler->diag));
    const int64_t first = l.points.n;
    for (int k = 0; k < l.n_sets; k++) TRY(each_loop(&l, &l.set[k], trace_all));
    for (int64_t k = 0; k < layered->n; k++)
        if (is_behind(&l, layered->x[k], layered->y[k]))
            TRY(add_new_point(&l, layered->x[k], layered->y[k]));
    for (int64_t k = first; k < l.points.n; k++)
        TRY(geometry_sample(sampler, region, l.points.x[k], l.points.y[k], to));
    return ERR_OK;
}
