/* SPDX-License-Identifier: MIT
 * The lattices that regions are sampled on: their angles, origins and spacings. Fluid and walls
 * have one common lattice of spacing dp. Each solid, with the solids bonded to it, has its own. */
#include "geometry/sampling.h"
#include "base/elementary.h"

#include <stdlib.h>

/* Tolerances: directions closer than this are equal, rad; edges are on the lattice, dp. */
static const double same_direction = 1e-6, on_lattice = 1e-6;

/* Sampling lines at right angles to an axis, per spacing, which find the edges along it. */
enum { LINES_PER_DP = 4, MAX_SCAN_LINES = 20000, MAX_EDGES = 24 };

/* --- direction --- */

struct direction {
    double angle, length;
};

/* An edge's direction modulo a right angle, rad: above -PI/4, up to PI/4. */
static struct direction direction_of(const double a[2], const double b[2])
{
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    if (dx == 0 || dy == 0) return (struct direction){0, fabs(dx) + fabs(dy)};
    double angle = elementary_atan2(dy, dx);
    angle -= 0.5 * PI * round(angle / (0.5 * PI));
    if (angle < same_direction - 0.25 * PI) angle += 0.5 * PI;
    return (struct direction){fabs(angle) < same_direction ? 0 : angle, elementary_hypot(dx, dy)};
}

/* Appends the straight edges of shapes; both sides of a polyline, with equal lengths. */
static int add_directions(const struct shape_list *list, struct direction *to)
{
    int n = 0;
    for (int k = 0; k < list->n; k++) {
        const struct shape *shape = &list->item[k];
        const int edges = shape->kind == SHAPE_POLYGON    ? shape->n
                          : shape->kind == SHAPE_POLYLINE ? shape->n - 1
                                                          : 0;
        for (int j = 0; j < edges; j++) {
            to[n] = direction_of(shape->pt[j], shape->pt[(j + 1) % shape->n]);
            if (shape->kind == SHAPE_POLYLINE) to[n].length *= 2;
            n++;
        }
        if (shape->kind != SHAPE_BOX) continue;
        const double *low = shape->pt[0], *high = shape->pt[1];
        to[n++] = (struct direction){0, 2 * (high[0] - low[0] + high[1] - low[1])};
    }
    return n;
}

/* The direction of more than half of all straight edges, by length; otherwise 0. */
static double main_direction(struct direction *all, int n)
{
    double total = 0;
    for (int k = 0; k < n; k++) total += all[k].length;
    qsort(all, (size_t)n, sizeof *all, geometry_ascending);
    for (int k = 0, end; k < n; k = end) {
        double length = 0, moment = 0;
        for (end = k; end < n && all[end].angle - all[k].angle <= same_direction; end++) {
            length += all[end].length;
            moment += all[end].length * (all[end].angle - all[k].angle);
        }
        if (length > 0.5 * total * (1 + 1e-9))
            return all[k].angle == 0 ? 0 : all[k].angle + moment / length;
    }
    return 0;
}

/* --- edges along an axis --- */

/* Positions at which lines cross the boundary, grouped into edges at right angles to the axis. */
struct crossing {
    double at, weight;
    bool clamp; /* of a clamp's end inside the body, otherwise of the body's own boundary */
};

static int by_weight(const void *a, const void *b)
{
    const double x = ((const struct crossing *)a)->weight, y = ((const struct crossing *)b)->weight;
    return (x < y) - (x > y);
}

static bool covered(const double *from, int n, double x, double tolerance)
{
    for (int k = 0; k + 1 < n; k += 2)
        if (x >= from[k] - tolerance && x <= from[k + 1] + tolerance) return true;
    return false;
}

/* Ends of the body on a line, except those inside its clamps, and ends of clamps inside the body:
 * the boundary of the part that is free to move. Appends them, and returns their number. */
static int free_ends(const struct outlines *body, const struct outlines *minus,
                     const struct outlines *clamp, double y, double dp, double *buffer,
                     int capacity, struct crossing *to)
{
    double *const inside = buffer, *const held = buffer + capacity,
                  *const scratch = held + capacity;
    const int n = outlines_union(body, minus, y, inside, scratch);
    const int n_held = clamp ? outlines_union(clamp, NULL, y, held, scratch) : 0;
    int count = 0;
    for (int k = 0; k < n; k++)
        if (!covered(held, n_held, inside[k], on_lattice * dp))
            to[count++] = (struct crossing){.at = inside[k]};
    for (int k = 0; k < n_held; k++)
        if (covered(inside, n, held[k], -on_lattice * dp))
            to[count++] = (struct crossing){.at = held[k], .clamp = true};
    return count;
}

/* A hinge takes the particle that is there; it is no end that a lattice could fit. */
static void omit_hinges(struct outlines *clamp, const struct shape_list *list, double dp)
{
    int kept = 0;
    for (int k = 0; k < clamp->n; k++) {
        if (geometry_is_hinge(&list->item[clamp->shape[k]], dp)) continue;
        clamp->item[kept] = clamp->item[k];
        clamp->shape[kept++] = clamp->shape[k];
    }
    clamp->n = kept;
}

/* Merges crossings that are close together into edges, each at the mean position. Omits edges
 * shorter than a spacing, curved or slanted ends of a body, and clamps spread over more than two
 * spacings. On any lattice, the rows of these end on average where they are drawn. */
static int merge_edges(struct crossing *c, int n, double dp)
{
    int kept = 0;
    if (n == 0) return 0; /* qsort must not get NULL */
    qsort(c, (size_t)n, sizeof *c, geometry_ascending);
    for (int k = 0, end; k < n; k = end) {
        double weight = 0, moment = 0, spread = 0.02 * dp;
        const double first = c[k].at;
        for (end = k; end < n && (end == k || c[end].at - c[end - 1].at < 0.1 * dp); end++) {
            weight += c[end].weight;
            moment += c[end].weight * (c[end].at - first);
            if (c[end].clamp) spread = 2 * dp;
        }
        if (c[end - 1].at - first > spread || weight < dp) continue;
        c[kept++] = (struct crossing){.at = first + moment / weight, .weight = weight};
    }
    qsort(c, (size_t)kept, sizeof *c, by_weight);
    return kept < MAX_EDGES ? kept : MAX_EDGES;
}

/* A group of regions with a common lattice. */
struct lattice_group {
    int n;
    struct region *const *region;
    double angle, dp;
};

static enum err turned_outlines(struct outlines *o, const struct outlines *from, double angle,
                                struct sampler *sampler)
{
    *o = *from;
    return outlines_turn(o, angle, &sampler->temp, sampler->diag);
}

/* Whether the previous line has a crossing of the same kind at nearly the same position: then the
 * boundary is at right angles to the axis, and not slanted. */
static bool continues_edge(const struct crossing *before, int n, const struct crossing *c,
                           double dp)
{
    for (int k = 0; k < n; k++)
        if (before[k].clamp == c->clamp && fabs(before[k].at - c->at) < 0.1 * dp) return true;
    return false;
}

/* A list of them. */
struct crossings {
    int n;
    struct crossing *item;
};

/* Adds the crossings of one region along the axis at `angle`. */
static enum err region_crossings(struct sampler *sampler, const struct region *region, double angle,
                                 double dp, bool whole, struct crossings *to)
{
    struct outlines body, minus, clamp = {0};
    TRY(turned_outlines(&body, &region->add, angle, sampler));
    TRY(turned_outlines(&minus, &region->minus, angle, sampler));
    if (region->kind == KIND_SOLID && !whole) {
        TRY(outlines_of(&clamp, sampler->scene, &sampler->scene->solid[region->body].clamp,
                        &sampler->temp, sampler->diag));
        TRY(outlines_turn(&clamp, angle, &sampler->temp, sampler->diag));
        omit_hinges(&clamp, &sampler->scene->solid[region->body].clamp, dp);
    }
    const double low = body.box.low[1], high = body.box.high[1];
    const int capacity = outlines_ends(&body) + outlines_ends(&minus) + outlines_ends(&clamp) + 4;
    const double wanted = ceil(LINES_PER_DP * (high - low) / dp);
    const int lines = wanted < 1 ? 1 : wanted > MAX_SCAN_LINES ? MAX_SCAN_LINES : (int)wanted;
    const double step = (high - low) / lines;
    double *buffer;
    struct crossing *two_lines;
    TRY(geometry_array(sampler, &buffer, 3 * capacity));
    TRY(geometry_array(sampler, &two_lines, 4 * capacity));
    int before = 0;
    for (int k = 0; k < lines; k++) {
        struct crossing *const line = two_lines + (k % 2 ? 2 * capacity : 0),
                               *const last = two_lines + (k % 2 ? 0 : 2 * capacity);
        const int found = free_ends(&body, &minus, clamp.n ? &clamp : NULL, low + (k + 0.5) * step,
                                    dp, buffer, capacity, line);
        for (int j = 0; j < found; j++) {
            if (!continues_edge(last, before, &line[j], dp)) continue;
            TRY(arena_more(&sampler->temp, &to->item, to->n, "sampling", sampler->diag));
            to->item[to->n++] = (struct crossing){line[j].at, step, line[j].clamp};
        }
        before = found;
    }
    return ERR_OK;
}

/* The edges of a group across one axis: of its free part, or of the whole if no part is free. */
static enum err find_edges(struct sampler *sampler, const struct lattice_group *group, int axis,
                           struct crossings *edges)
{
    const double angle = group->angle + (axis ? 0.5 * PI : 0);
    *edges = (struct crossings){0};
    for (int whole = 0; whole < 2 && edges->n == 0; whole++) {
        for (int k = 0; k < group->n; k++)
            TRY(region_crossings(sampler, group->region[k], angle, group->dp, whole, edges));
        edges->n = merge_edges(edges->item, edges->n, group->dp);
    }
    return ERR_OK;
}

/* --- spacing and origin --- */

/* Mean square of the edges' distances from the lattice lines, in spacings, weighted by length. */
static double misfit(const struct crossings *edges, double origin, double spacing)
{
    double sum = 0, weight = 0;
    for (int k = 0; k < edges->n; k++) {
        const double cells = (edges->item[k].at - origin) / spacing;
        sum += edges->item[k].weight * square(cells - round(cells));
        weight += edges->item[k].weight;
    }
    return weight > 0 ? sum / weight : 0;
}

/* The line through (count, position) of the edges, by least squares; `origin` and `spacing`
 * determine the lattice line nearest to each. With `fixed` the spacing is constant. */
static void regress(const struct crossings *edges, bool fixed, double *origin, double *spacing)
{
    double w = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (int k = 0; k < edges->n; k++) {
        const double count = round((edges->item[k].at - *origin) / *spacing);
        const double place = edges->item[k].at - *origin;
        w += edges->item[k].weight;
        x += edges->item[k].weight * count;
        y += edges->item[k].weight * place;
        xx += edges->item[k].weight * count * count;
        xy += edges->item[k].weight * count * place;
    }
    const double spread = w * xx - x * x;
    const double found = fixed || spread <= 0 ? *spacing : (w * xy - x * y) / spread;
    *origin += (y - found * x) / w;
    *spacing = found;
}

/* The origin and spacing with the best fit to the edges. Candidates: each edge with dp, and every
 * pair of edges. Among equal fits, the spacing nearest to dp. */
static void fit_axis(const struct crossings *edges, double dp, bool fixed, double *origin,
                     double *spacing)
{
    double best = misfit(edges, *origin, *spacing);
    for (int i = 0; i < edges->n; i++) {
        for (int j = 0; j < 2 * edges->n; j++) {
            const double apart = fabs(edges->item[j / 2].at - edges->item[i].at) / dp;
            const double count = j % 2 ? floor(apart) : ceil(apart);
            const bool alone = j / 2 == i;
            if (!alone && (fixed || count < 2)) continue;
            double o = edges->item[i].at, d = alone ? dp : apart / count * dp;
            regress(edges, alone, &o, &d);
            const double off = misfit(edges, o, d);
            const bool better = off < best - 1e-12;
            if (!better && (off > best + 1e-12 || fabs(d - dp) >= fabs(*spacing - dp))) continue;
            best = min2(off, best);
            *origin = o;
            *spacing = d;
        }
    }
}

/* Corner of the box around a group, in its own axes. */
static enum err lower_corner(struct sampler *sampler, const struct lattice_group *group,
                             double corner[2])
{
    corner[0] = corner[1] = HUGE_VAL;
    for (int k = 0; k < group->n; k++) {
        struct outlines o;
        TRY(turned_outlines(&o, &group->region[k]->add, group->angle, sampler));
        for (int c = 0; c < 2; c++) corner[c] = min2(corner[c], o.box.low[c]);
    }
    return ERR_OK;
}

/* A solid's lattice is the common one if that fits. Otherwise its origin is its lower left corner.
 * If edges are then between lattice lines, it is fitted to them. */
static enum err fit_solids(struct sampler *sampler, const struct lattice_group *group)
{
    double corner[2];
    bool shifted = false;
    struct scene_lattice l = {.angle = group->angle,
                              .turn = {elementary_cos(group->angle), elementary_sin(group->angle)},
                              .spacing = {group->dp, group->dp}};
    TRY(lower_corner(sampler, group, corner));
    for (int c = 0; c < 2; c++) {
        const struct scene_lattice *const common = &sampler->scene->lattice;
        const double cells = (corner[c] - common->origin[c]) / group->dp;
        const bool same = group->angle == common->angle && fabs(cells - round(cells)) <= on_lattice;
        l.origin[c] = same ? common->origin[c] : corner[c];
        struct crossings edges;
        TRY(find_edges(sampler, group, c, &edges));
        double off = 0;
        for (int k = 0; k < edges.n; k++) {
            const double place = (edges.item[k].at - l.origin[c]) / group->dp;
            off = max2(off, fabs(place - round(place)));
        }
        if (off > on_lattice) {
            fit_axis(&edges, group->dp, false, &l.origin[c], &l.spacing[c]);
            l.fitted = true;
        } else
            shifted |= !same;
    }
    const bool square_cells = l.spacing[0] == group->dp && l.spacing[1] == group->dp;
    l.dp = square_cells ? group->dp : sqrt(l.spacing[0] * l.spacing[1]);
    for (int k = 0; k < group->n; k++) group->region[k]->lattice = l;
    sampler->scene->off_lattice |= shifted && group->angle == 0 && !l.fitted;
    return ERR_OK;
}

/* --- groups --- */

static enum err group_direction(struct sampler *sampler, struct lattice_group *group)
{
    size_t most = 1;
    for (int k = 0; k < group->n; k++)
        for (int j = 0; j < group->region[k]->list->n; j++)
            most += (size_t)group->region[k]->list->item[j].n;
    struct direction *all;
    TRY(geometry_array(sampler, &all, most));
    int n = 0;
    for (int k = 0; k < group->n; k++) n += add_directions(group->region[k]->list, all + n);
    group->angle = main_direction(all, n);
    return ERR_OK;
}

/* A given angle modulo a right angle. */
static double given_angle(double angle)
{
    const double a[2] = {0, 0}, b[2] = {elementary_cos(angle), elementary_sin(angle)};
    return direction_of(a, b).angle;
}

/* The lattice of fluid and walls. A periodic one cannot be rotated. */
static enum err common_lattice(struct sampler *sampler, struct region **list)
{
    struct scene *scene = sampler->scene;
    struct lattice_group group = {.region = list, .dp = scene->top.dp};
    for (int k = 0; k < sampler->n_regions; k++)
        if (sampler->regions[k].kind != KIND_SOLID) list[group.n++] = &sampler->regions[k];
    if (!isnan(scene->numerics.lattice_angle))
        group.angle = given_angle(scene->numerics.lattice_angle);
    else if (scene->domain.periodic == PERIODIC_NONE)
        TRY(group_direction(sampler, &group));
    const double *at = scene->numerics.lattice_origin;
    const double c = elementary_cos(group.angle), sine = elementary_sin(group.angle);
    struct scene_lattice *l = &scene->lattice;
    *l = (struct scene_lattice){.angle = group.angle,
                                .turn = {c, sine},
                                .spacing = {group.dp, group.dp},
                                .dp = group.dp};
    lattice_place(l, at[0], at[1], l->origin);
    if (group.angle != 0 && !scene_given(scene, SECTION_numerics, 0, "lattice_origin")) {
        for (int axis = 0; axis < 2; axis++) {
            struct crossings edges;
            TRY(find_edges(sampler, &group, axis, &edges));
            fit_axis(&edges, group.dp, true, &l->origin[axis], &l->spacing[axis]);
        }
    }
    for (int k = 0; k < group.n; k++) list[k]->lattice = *l;
    return ERR_OK;
}

static enum err solid_lattice(struct sampler *sampler, const int *bond, int number,
                              struct region **list)
{
    struct scene *scene = sampler->scene;
    struct lattice_group group = {.region = list, .dp = scene_solid_dp(scene, number)};
    for (int k = 0; k < scene->n_solid; k++)
        if (bond[k] == number) list[group.n++] = &sampler->regions[k];
    if (group.n == 0) return ERR_OK;
    TRY(group_direction(sampler, &group));
    for (int k = group.n - 1; k >= 0; k--) {
        const double given = scene->solid[list[k]->body].lattice_angle;
        if (!isnan(given)) group.angle = given_angle(given);
    }
    return fit_solids(sampler, &group);
}

enum err geometry_choose_lattices(struct sampler *sampler)
{
    struct scene *scene = sampler->scene;
    struct region **list;
    struct scene_lattice *to;
    int bond[SCENE_MAX_SECTIONS];
    TRY(geometry_array(sampler, &list, sampler->n_regions));
    TRY(arena_array(&scene->arena, &to, scene->n_solid, "lattice", sampler->diag));
    scene_bonds(scene, bond);
    TRY(common_lattice(sampler, list));
    for (int k = 0; k < scene->n_solid; k++) TRY(solid_lattice(sampler, bond, k, list));
    for (int k = 0; k < scene->n_solid; k++) to[k] = sampler->regions[k].lattice;
    scene->solid_lattice = to;
    return ERR_OK;
}
