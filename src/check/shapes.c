/* SPDX-License-Identifier: MIT
 * Shapes that the lattice cannot represent as drawn, walls and bodies too thin, and openings that
 * sampling has closed or left one particle wide. */
#include "check/check.h"

/* --- off the lattice --- */

static double cells_to(const struct region *region, int c, double x)
{
    return (x - region->lattice.origin[c]) / region->lattice.spacing[c];
}

/* An edge along an axis of the lattice, between its lines. `warned`: of one along each axis. */
static void warn_of_edge(struct check *check, const struct region *region, int line,
                         const double a[2], const double b[2], bool warned[2])
{
    const struct scene_lattice *const l = &region->lattice;
    const double dp = l->dp, round_off = l->angle == 0 ? 0 : 1e-9 * dp;
    const int c = fabs(a[0] - b[0]) <= round_off ? 0 : 1;
    const double cells = cells_to(region, c, a[c]);
    const bool fits = fabs(cells - round(cells)) <= 1e-6 * max2(1, 1e-6 * fabs(cells));
    if (fabs(a[c] - b[c]) > round_off || fits || warned[c]) return;
    const double fit = l->origin[c] + round(cells) * l->spacing[c];
    check->scene->off_lattice = warned[c] = true;
    if (l->angle == 0)
        warn_at(check->diag, check->scene, line,
                "%s edge at %c = %g m is off the lattice of dp = %g m; %c = %g m would fit",
                section_title(region->common).text, "xy"[c], a[c], dp, "xy"[c], fit);
    else
        warn_at(check->diag, check->scene, line,
                "an edge of %s is %.2g dp off the lattice, which is rotated by %.4g degrees; "
                "move the edge or choose another dp",
                section_title(region->common).text, fabs(a[c] - fit) / dp, l->angle * (180 / PI));
}

static void warn_of_edges(struct check *check, const struct region *region, int shape)
{
    const struct shape *const drawn = &region->list->item[shape];
    bool warned[2] = {false, false};
    for (int k = 0; k < region->add.n; k++) {
        const struct outline *o = &region->add.item[k];
        if (region->add.shape[k] != shape) continue;
        for (int j = 0; j < o->n; j++)
            warn_of_edge(check, region, drawn->line, o->pt[j], o->pt[(j + 1) % o->n], warned);
    }
    for (int k = 0; drawn->thin && k + 1 < drawn->n; k++) {
        double at[2][2];
        for (int j = 0; j < 2; j++)
            lattice_place(&region->lattice, drawn->pt[k + j][0], drawn->pt[k + j][1], at[j]);
        warn_of_edge(check, region, drawn->line, at[0], at[1], warned);
    }
}

/* A wet face of a body between the lines of the fluid's lattice leaves a gap, into which fluid that
 * starts under pressure expands, and gains energy. Fluid at faces in other directions settles.
 * Beside water that rests under its own weight it is below 2e-4 of the available energy. */
static void warn_of_wet_faces(struct check *check, const struct region *region)
{
    struct region face = *region;
    bool warned[2] = {false, false}, pressed = false;
    for (int k = 0; k < check->scene->n_fluid; k++)
        pressed |= check->scene->fluid[k].pressure.e[0] != NULL;
    face.lattice = check->scene->lattice;
    for (int k = 0; pressed && k < region->add.n && face.lattice.angle == region->lattice.angle;
         k++) {
        const struct outline *const o = &region->add.item[k];
        const int line = region->list->item[region->add.shape[k]].line;
        for (int j = 0; j < o->n; j++) {
            const double *const a = o->pt[j], *const b = o->pt[(j + 1) % o->n];
            double at[2];
            place_of_lattice(&face.lattice, 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), at);
            if (point_at(check, at, 1.5 * face.lattice.dp, POINT_FLUID) >= 0)
                warn_of_edge(check, &face, line, a, b, warned);
        }
    }
}

/* The bending stiffness of a thin body is proportional to the third power of its thickness, hence
 * of its area. Clamped parts do not bend. */
static void warn_of_area(struct check *check, const struct region *region)
{
    const struct scene_lattice *const l = &check->scene->solid_lattice[region->body];
    const double ratio = 1 + l->area_error, stiff = ratio * square(ratio);
    if (fabs(l->area_error) <= 0.005) return;
    check->scene->off_lattice = true;
    warn_at(check->diag, check->scene, region->common->line,
            "the %.0f particles of %s%s cover %.2g %% %s than the shape there, %.4g m^2, so a thin "
            "body is about %.2g %% too %s in bending; a smaller dp or another lattice_angle helps",
            ratio * l->area / square(l->dp), section_title(region->common).text,
            l->area_free ? " that no clamp holds" : "", 100 * fabs(ratio - 1),
            ratio > 1 ? "more" : "less", l->area, 100 * fabs(stiff - 1),
            ratio > 1 ? "stiff" : "soft");
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

/* Whether anything lies in a direction from a place, as far as the domain goes. */
static bool anything_beyond(const struct check *check, const double from[2], const double toward[2],
                            double first)
{
    const struct scene *const scene = check->scene;
    const double *const low = scene->domain_lower, *const high = scene->domain_upper,
                        dp = scene->top.dp, longest = high[0] - low[0] + high[1] - low[1];
    for (double path = first; path < longest; path += 0.5 * dp) {
        const double at[2] = {from[0] + path * toward[0], from[1] + path * toward[1]};
        for (int c = 0; c < 2; c++)
            if (!scene_periodic(scene, c) && (at[c] < low[c] || at[c] > high[c])) return false;
        if (point_at(check, at, 0.5 * dp, POINT_ANY) >= 0) return true;
    }
    return false;
}

/* Whether something is on both sides of a wall: a line between corners, `off` to its left. */
static bool has_two_sides(const struct check *check, const double corner[2][2], double off)
{
    const double dp = check->scene->top.dp, dx = corner[1][0] - corner[0][0],
                 dy = corner[1][1] - corner[0][1], length = elementary_hypot(dx, dy),
                 left[2] = {-dy / length, dx / length}, right[2] = {-left[0], -left[1]},
                 first = fabs(off) + 0.5 * dp;
    for (double s = 0.5 * dp; s < length; s += dp) {
        const double middle[2] = {corner[0][0] + s * dx / length + off * left[0],
                                  corner[0][1] + s * dy / length + off * left[1]};
        if (anything_beyond(check, middle, left, first) &&
            anything_beyond(check, middle, right, first))
            return true;
    }
    return false;
}

/* Whether a wall is not the outermost one. */
static bool is_between(const struct check *check, const struct shape *shape)
{
    if (shape->kind == SHAPE_BOX) {
        const double *const low = shape->pt[0], *const high = shape->pt[1];
        const bool upright = high[1] - low[1] > high[0] - low[0];
        const double side[2][2] = {{low[0], low[1]},
                                   {upright ? low[0] : high[0], upright ? high[1] : low[1]}};
        return has_two_sides(check, side,
                             upright ? 0.5 * (low[0] - high[0]) : 0.5 * (high[1] - low[1]));
    }
    for (int k = 0; shape->kind == SHAPE_POLYLINE && k + 1 < shape->n; k++) {
        const double side[2][2] = {{shape->pt[k][0], shape->pt[k][1]},
                                   {shape->pt[k + 1][0], shape->pt[k + 1][1]}};
        if (has_two_sides(check, side, 0.5 * shape->size)) return true;
    }
    return shape->kind == SHAPE_CIRCLE;
}

/* A body thinner than the kernel's reach does not separate the fluid on its two sides. They
 * interact through the pressure of the body's particles, unless each fluid particle uses its own
 * pressure there. They interact directly if the nearest fluid on both sides, thickness plus one
 * spacing apart, is within reach. `wall`: of a wall. */
static void warn_of_thin(struct check *check, const struct region *region, const struct shape *wall,
                         double thick)
{
    const struct scene *const scene = check->scene;
    const double reach = 2 * scene->h * (1 - 1e-9);
    const bool directly = thick + scene->top.dp < reach;
    if (scene->n_fluid == 0 || thick >= reach || (wall && !is_between(check, wall))) return;
    if (scene->numerics.sides == SIDES_ONE && !directly) return;
    warn_at(check->diag, check->scene, wall ? wall->line : region->common->line,
            "%s is %g m thick, less than the kernel's reach 2 h = %g m: fluid interacts with "
            "the fluid behind it; %s prevents that",
            section_title(region->common).text, thick, 2 * scene->h,
            !directly ? "numerics.sides = one"
            : wall    ? "a thicker wall or a smaller dp"
                      : "a smaller dp");
}

static void warn_of_thin_solid(struct check *check, const struct region *region)
{
    const double across = geometry_rows_across(region), dp = region->lattice.dp;
    if (across < 4)
        warn_section(check, region->common,
                     "is only %.0f particles thick at dp = %g m, so its bending will be "
                     "inaccurate; use a smaller dp, for 4 particles or more",
                     across, dp);
    if (scene_is_bonded(check->scene, region->body)) return;
    /* At the default h/dp a warning here would repeat the one on two particles across. */
    if (across > 2 || (across + 1) * dp < 2 * check->scene->h)
        warn_of_thin(check, region, NULL, across * dp);
}

static void warn_of_region(struct check *check, const struct region *region)
{
    if (check->scene->n_fluid + check->scene->n_solid == 0) return; /* rigid bodies are as drawn */
    const int k_beam = region->body - scene_beam_wall(check->scene, 0);
    const bool beam = region->kind == KIND_WALL && k_beam >= 0;
    for (int k = 0; k < region->list->n; k++) {
        const struct shape *const shape = &region->list->item[k];
        if (shape->thin && check->scene->n_fluid && check->scene->fluid[0].wall_repulsion == 0)
            warn_at(check->diag, check->scene, shape->line,
                    "single particles may pass through this line of %s; wall_repulsion above 0 in "
                    "[fluid %s] prevents that",
                    section_title(region->common).text, check->scene->fluid[0].common.name);
        if (shape->thin && check->scene->n_rigid && !beam)
            warn_at(check->diag, check->scene, shape->line,
                    "rigid bodies do not touch this line of %s but pass through it, because "
                    "it has no thickness",
                    section_title(region->common).text);
        bool layered = false; /* layers follow faces at any position */
        for (int j = 0; j < region->add.n; j++)
            layered |= region->add.shape[j] == k && region->layered[j];
        if (region->lattice.fitted || layered) continue;
        if (beam && check->scene->beam[k_beam].thickness > 0 &&
            check->scene->top.scheme == SCHEME_STANDARD)
            continue; /* fluid is settled there */
        warn_of_edges(check, region, k);
        if (region->kind == KIND_WALL && !shape->thin)
            warn_of_thin(check, region, shape, thickness(shape));
    }
    if (region->kind != KIND_SOLID) return;
    warn_of_wet_faces(check, region);
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
        from[c] = (int64_t)floor(cells_to(region, c, max2(cut->box.low[c], region->box.low[c])));
        to[c] = (int64_t)floor(cells_to(region, c, min2(cut->box.high[c], region->box.high[c])));
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
                "`minus` removes no particle of %s, because it is narrower than dp = %g m or "
                "lies outside, so the opening is closed; enlarge or move it, or use a smaller dp",
                section_title(region->common).text, region->lattice.dp);
    }
}

/* --- gaps as wide as a particle --- */

/* Gaps up to `widest` dp may hold a single row of particles, or none. One below `joint` is meant as
 * a joint. Faces are followed in steps of `along`, gaps are measured in steps of `step`. */
static const double widest = 2, joint = 0.04, along = 0.25, step = 0.02;

/* Gaps between walls and solids as drawn. */
struct gaps {
    struct check *check;
    int n;
    bool *warned; /* [n][n][2]: by a pair of regions, of an open gap, of a closed one */
};

/* How far from a place the next wall or solid is, in dp up to a limit; its region, or -1. */
static double free_path(const struct check *check, const double at[2], const double toward[2],
                        double limit, int *region)
{
    const double dp = check->scene->top.dp;
    for (double path = 0.5 * step; path < limit; path += step) {
        *region = drawn_at(check, at[0] + path * dp * toward[0], at[1] + path * dp * toward[1]);
        if (*region < 0) continue;
        for (double half = 0.5 * step; half > 1e-3 * step; half *= 0.5) {
            const double mid = path - half;
            path = drawn_at(check, at[0] + mid * dp * toward[0], at[1] + mid * dp * toward[1]) < 0
                       ? path
                       : mid;
        }
        return path;
    }
    *region = -1;
    return limit;
}

/* Whether a gap goes on in both directions from its middle to where it is wider than a particle. A
 * wedge between a circle and the floor that it touches does not. */
static bool is_passage(const struct check *check, const double middle[2], const double across[2])
{
    const double dp = check->scene->top.dp, back[2] = {-across[0], -across[1]};
    for (int sign = -1; sign <= 1; sign += 2) {
        double at[2] = {middle[0], middle[1]}, width = 0;
        int64_t steps = 20 * check->points.n; /* a ring has no end */
        for (int region; width < widest && steps > 0; steps--) {
            at[0] -= sign * 5 * step * dp * across[1];
            at[1] += sign * 5 * step * dp * across[0];
            if (drawn_at(check, at[0], at[1]) >= 0) return false;
            const double ahead = free_path(check, at, across, widest, &region),
                         behind = free_path(check, at, back, widest, &region);
            width = ahead + behind;
            for (int c = 0; c < 2; c++) at[c] += 0.5 * (ahead - behind) * dp * across[c];
        }
        if (steps == 0) return false;
    }
    return true;
}

/* The distance between the rows of particles on both sides of a place, in dp. */
static double row_distance(const struct check *check, const double at[2], const double across[2])
{
    const struct points *const p = &check->points;
    const double dp = check->scene->top.dp;
    double nearest[2] = {widest, widest};
    struct point_visit v = point_grid_visit(&p->grid, at[0], at[1], widest * dp);
    while (point_grid_next(&p->grid, &v)) {
        const double dx = (p->x[v.k] - at[0]) / dp, dy = (p->y[v.k] - at[1]) / dp,
                     over = dx * across[0] + dy * across[1],
                     beside = dy * across[0] - dx * across[1];
        if (p->bit[v.k] == POINT_BODY && fabs(beside) < 0.51)
            nearest[over > 0] = min2(nearest[over > 0], fabs(over));
    }
    return nearest[0] + nearest[1];
}

/* The gap in front of a face, if there is one: from a place on it to that opposite. Rows of
 * particles two spacings apart leave space for one between them. Measured under a sluice with 20 to
 * 80 particles of water above it: a gap of one particle passed 0.2 to 0.8 of the theoretical flow,
 * and energy was gained. Two passed 0.84 to 1.16, three 0.93 to 1.08. */
static void warn_of_gap(struct gaps *g, int region, int line, const double face[2],
                        const double across[2])
{
    const struct check *const check = g->check;
    const double dp = check->scene->top.dp;
    int other;
    const double width = free_path(check, face, across, widest, &other);
    if (other < 0 || width < joint) return;
    const double at[2] = {face[0] + 0.5 * width * dp * across[0],
                          face[1] + 0.5 * width * dp * across[1]};
    const double rows = row_distance(check, at, across);
    const bool closed = rows < 1.5;
    const int a = region < other ? region : other, b = region < other ? other : region;
    bool *const warned = &g->warned[2 * (a * g->n + b) + closed];
    if (*warned || rows > 2.5 || !is_passage(check, at, across)) return;
    const struct region *const p = &check->shapes.regions[a], *const q = &check->shapes.regions[b];
    char between[sizeof(struct section_title) + 16] = "in";
    *warned = true;
    if (a != b) snprintf(between, sizeof between, "between %s and", section_title(p->common).text);
    warn_at(check->diag, check->scene, line,
            "the gap %s %s at (%.4g, %.4g) m is %.2g m wide, %s; use dp = %.2g m or less, or "
            "close the gap",
            between, section_title(q->common).text, at[0], at[1], width * dp,
            closed ? "and closed by sampling, so no fluid passes"
                   : "one particle: the flow through it is 0.2 to 0.8 of the exact flow, and "
                     "energy may be gained",
            0.5 * width * dp);
}

/* Finds gaps beside an edge, given in the axes of its region. */
static void warn_beside_edge(struct gaps *g, int region, int line, const double from[2],
                             const double to[2])
{
    const struct check *const check = g->check;
    const struct scene_lattice *const l = &check->shapes.regions[region].lattice;
    const double dp = check->scene->top.dp, aside = 1e-3 * dp;
    double a[2], b[2];
    place_of_lattice(l, from[0], from[1], a);
    place_of_lattice(l, to[0], to[1], b);
    const double length = elementary_hypot(b[0] - a[0], b[1] - a[1]);
    const int64_t parts = 1 + (int64_t)min2(1e8, length / (along * dp));
    for (int64_t k = 0; k < parts && length > 0; k++)
        for (int side = -1; side <= 1; side += 2) {
            const double s = ((double)k + 0.5) / (double)parts,
                         toward[2] = {side * (a[1] - b[1]) / length, side * (b[0] - a[0]) / length},
                         at[2] = {a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])},
                         front[2] = {at[0] + aside * toward[0], at[1] + aside * toward[1]},
                         far[2] = {at[0] + 1.3 * dp * toward[0], at[1] + 1.3 * dp * toward[1]};
            /* Behind a gap there are particles further from the face than its own. */
            if (point_at(check, far, 1.5 * dp, POINT_BODY) < 0 ||
                drawn_at(check, at[0] - aside * toward[0], at[1] - aside * toward[1]) != region ||
                drawn_at(check, front[0], front[1]) >= 0)
                continue;
            warn_of_gap(g, region, line, front, toward);
        }
}

static void warn_around_outline(struct gaps *g, int region, int line, const struct outline *o)
{
    const int n = o->n ? o->n : 8 + (int)min2(1e7, 2 * PI * o->radius / (along * o->radius));
    for (int k = 0; k < n; k++) {
        double end[2][2];
        for (int j = 0; j < 2 && !o->n; j++) {
            const double angle = 2 * PI * (k + j) / n;
            end[j][0] = o->centre[0] + o->radius * elementary_cos(angle);
            end[j][1] = o->centre[1] + o->radius * elementary_sin(angle);
        }
        warn_beside_edge(g, region, line, o->n ? o->pt[k] : end[0],
                         o->n ? o->pt[(k + 1) % n] : end[1]);
    }
}

static enum err warn_of_gaps(struct check *check)
{
    struct gaps g = {.check = check, .n = check->scene->n_solid + check->scene->n_wall};
    const size_t n = (size_t)g.n;
    TRY(arena_array(&check->shapes.temp, &g.warned, 2 * n * n, "gaps", check->diag));
    for (int r = g.n - 1; r >= 0; r--) {
        const struct region *const region = &check->shapes.regions[r];
        for (int k = region->add.n - 1; k >= 0; k--)
            warn_around_outline(&g, r, region->list->item[region->add.shape[k]].line,
                                &region->add.item[k]);
        for (int k = 0; k < region->minus.n; k++)
            warn_around_outline(&g, r, region->minus_list->item[region->minus.shape[k]].line,
                                &region->minus.item[k]);
    }
    return ERR_OK;
}

/* --- points of rigid bodies --- */

/* A point that moves with a rigid body, further from it than the body is long. A hinge may be. */
static void warn_of_far_point(const struct check *check, const struct scene_section_common *common,
                              const char *key, const double at[2], int rigid)
{
    const struct scene *const scene = check->scene;
    const int wall = scene_rigid_wall(scene, rigid);
    const struct region *const region = &check->shapes.regions[scene->n_solid + wall];
    const struct box2 *const box = &region->add.box;
    struct box2 point;
    lattice_place(&region->lattice, at[0], at[1], point.low);
    memcpy(point.high, point.low, sizeof point.high);
    if (box2_near(&point, box, max2(box->high[0] - box->low[0], box->high[1] - box->low[1])))
        return;
    warn_at(check->diag, scene,
            key_line(scene, (enum section_id)common->section, common->index, key),
            "%s %s = %g, %g is further from [rigid %s] than the body is long, and moves with it; "
            "choose a point of the body",
            section_title(common).text, key, at[0], at[1], scene->rigid[rigid].common.name);
}

static void warn_of_far_points(const struct check *check)
{
    const struct scene *const scene = check->scene;
    for (int k = 0; k < scene->n_rigid; k++)
        if (!isnan(scene->rigid[k].centre[0]))
            warn_of_far_point(check, &scene->rigid[k].common, "centre", scene->rigid[k].centre, k);
    for (int k = 0; k < scene->n_spring; k++) {
        const struct scene_spring *const spring = &scene->spring[k];
        const int body = scene_find(scene, SECTION_rigid, spring->body),
                  other = scene_find(scene, SECTION_rigid, spring->other);
        if (body >= 0) warn_of_far_point(check, &spring->common, "from", spring->from, body);
        if (other >= 0) warn_of_far_point(check, &spring->common, "to", spring->to, other);
    }
}

enum err warn_of_shapes(struct check *check)
{
    warn_of_far_points(check);
    for (int k = 0; k < check->shapes.n_regions; k++)
        warn_of_region(check, &check->shapes.regions[k]);
    for (int k = 0; k < check->shapes.n_regions; k++)
        warn_of_cuts(check, &check->shapes.regions[k]);
    return check->scene->n_fluid ? warn_of_gaps(check) : ERR_OK;
}
