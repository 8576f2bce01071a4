/* SPDX-License-Identifier: MIT
 * Refuses beams that begin where contact could not keep them on one side: across each other or
 * themselves, in a body, or with a free point on its face. */
#include "check/check.h"

/* Lengths over dp: along and beside a line, that count as nothing; between places tested. */
static const double ahead = 1e-3, beside = 1e-5, between = 0.02;

/* A segment of a beam, or of a wall that is a thin line (beam: NULL). */
struct part {
    const struct scene_beam *beam;
    struct line_part line;
};

static struct part part_of(const struct scene_beam *beam, const struct shape *line, int k)
{
    return (struct part){beam, line_part(line->pt[k], line->pt[k + 1])};
}

static bool is_near(const double a[2], const double b[2], double within)
{
    return elementary_hypot(a[0] - b[0], a[1] - b[1]) <= within;
}

/* Half the thickness of a part, m. */
static double half_of(const struct scene_beam *beam)
{
    return beam ? scene_half_thickness(beam) : 0;
}

/* Whether a clamp or hinge of a beam on another (NULL: any body) is near a place: also where lines
 * that meet at 30 degrees leave each other's thickness. */
static bool is_held(const struct check *check, const struct scene_beam *beam, const double at[2],
                    const struct scene_beam *other)
{
    const double reach = max2(beam->element > 0 ? beam->element : check->scene->top.dp,
                              2 * (half_of(beam) + half_of(other)));
    for (int k = 0; k < beam->clamp.n + beam->hinge.n; k++) {
        const struct hinge_point *const h =
            k < beam->clamp.n ? &beam->clamp.item[k] : &beam->hinge.item[k - beam->clamp.n];
        if (is_near(h->at, at, reach) && (!other || strcmp(h->other, other->common.name) == 0))
            return true;
    }
    return false;
}

/* --- lines that meet --- */

/* Whether parts may meet at a place: neighbours at their common end, other lines at a joint. */
static bool may_meet(const struct check *check, const struct part *p, const struct part *q,
                     const double at[2])
{
    const double nothing = 2 * beside * check->scene->top.dp;
    if (p->beam != q->beam && q->beam)
        return is_held(check, p->beam, at, q->beam) || is_held(check, q->beam, at, p->beam);
    if (!q->beam) return is_held(check, p->beam, at, NULL);
    return (is_near(at, p->line.to, nothing) && is_near(at, q->line.from, nothing)) ||
           (is_near(at, p->line.from, nothing) && is_near(at, q->line.to, nothing));
}

/* Half the thickness of both, m. A line with itself: 0, as where it bends its faces may meet. */
static double thickness_between(const struct part *p, const struct part *q)
{
    return p->beam == q->beam ? 0 : half_of(p->beam) + half_of(q->beam);
}

/* Whether two parts meet where they may not, and where; those of two lines by their thickness, too.
 */
static bool meet(const struct check *check, const struct part *p, const struct part *q,
                 double at[2])
{
    const double nothing = beside * check->scene->top.dp, thick = thickness_between(p, q),
                 least = max2(nothing, thick - nothing);
    double end[4][2]; /* of q relative to p, of p relative to q */
    for (int k = 0; k < 4; k++) {
        const struct part *const on = k < 2 ? p : q, *const of = k < 2 ? q : p;
        memcpy(at, k % 2 ? of->line.to : of->line.from, 2 * sizeof *at);
        relative_to_part(&on->line, at, end[k]);
        const double beyond = max2(-end[k][0], end[k][0] - on->line.length);
        if (fabs(end[k][1]) < least && beyond < nothing && !may_meet(check, p, q, at)) return true;
    }
    if (!(end[0][1] * end[1][1] < 0 && end[2][1] * end[3][1] < 0)) return false;
    const double part = end[0][1] / (end[0][1] - end[1][1]);
    place_on_part(&p->line, end[0][0] + part * (end[1][0] - end[0][0]), 0, at);
    return !may_meet(check, p, q, at);
}

struct overlap {
    char text[100];
};

/* Says by how much parts that meet at an end of one of them overlap, if their lines do not meet. */
static struct overlap by_thickness(const struct part *p, const struct part *q, const double at[2])
{
    struct overlap to = {""};
    double mine[2], its[2];
    relative_to_part(&p->line, at, mine);
    relative_to_part(&q->line, at, its);
    const double apart = max2(fabs(mine[1]), fabs(its[1])), thick = thickness_between(p, q);
    if (apart > 0.01 * thick)
        snprintf(to.text, sizeof to.text,
                 ": the lines are %.4g m apart there, and their thicknesses need %.4g m", apart,
                 thick);
    return to;
}

/* A beam with itself or with one before it. */
static enum err refuse_meeting(const struct check *check, const struct scene_beam *beam,
                               const struct scene_beam *other)
{
    const struct shape *const line = beam->shape.item, *const its = other->shape.item;
    const bool own = beam == other;
    const int walls = check->scene->n_solid + scene_beam_wall(check->scene, 0);
    if (!own &&
        !scene_contact_of(check->scene, walls + beam->common.index, walls + other->common.index))
        return ERR_OK;
    for (int i = 0; i + 1 < line->n; i++)
        for (int j = own ? i + 1 : 0; j + 1 < its->n; j++) {
            const struct part p = part_of(beam, line, i), q = part_of(other, its, j);
            double at[2];
            if (!meet(check, &p, &q, at)) continue;
            if (own)
                return fail_at(check->diag, check->scene, line->line,
                               "[beam %s] crosses itself or turns back on itself near (%.6g, %.6g) "
                               "m; move the points of its line apart",
                               beam->common.name, at[0], at[1]);
            return fail_at(check->diag, check->scene, line->line,
                           "[beam %s] meets [beam %s] at (%.6g, %.6g) m without a joint%s; give "
                           "[beam %s] a `clamp` or `hinge` = X, Y, %s there, besides joints with "
                           "other beams, or move one of them",
                           beam->common.name, other->common.name, at[0], at[1],
                           by_thickness(&p, &q, at).text, beam->common.name, other->common.name);
        }
    return ERR_OK;
}

/* --- bodies --- */

/* How far a part lies in a region by so much on each side of it, m, and where; 0: not at all. Its
 * ends do not count, nor does its thickness where it is held. */
static double lies_in(const struct check *check, const struct part *p, const struct region *region,
                      double by, double at[2])
{
    const double dp = check->scene->top.dp, inner = p->line.length - 2 * ahead * dp;
    const int n = 1 + (int)max2(0, inner / (between * dp));
    for (int k = 0; k <= n; k++)
        for (int side = -1; side < 2; side += 2) {
            const double along = ahead * dp + inner * k / n;
            double from = 0, to = by, inside[2];
            place_on_part(&p->line, along, side * by, at);
            if (!geometry_covers(region, at[0], at[1]) ||
                (by > beside * dp && is_held(check, p->beam, at, NULL)))
                continue;
            while (to - from > 1e-5 * by) {
                const double middle = 0.5 * (from + to);
                place_on_part(&p->line, along, side * middle, inside);
                *(geometry_covers(region, inside[0], inside[1]) ? &to : &from) = middle;
            }
            return by - from;
        }
    return 0;
}

/* Whether a region has points at a distance from a place. */
static bool is_about(const struct region *region, const double at[2], double distance)
{
    for (int k = 0; k < 8; k++) {
        const double x = at[0] + distance * elementary_cos(PI * (k + 0.5) / 4),
                     y = at[1] + distance * elementary_sin(PI * (k + 0.5) / 4);
        if (geometry_covers(region, x, y)) return true;
    }
    return false;
}

static enum err refuse_in_body(const struct check *check, const struct scene_beam *beam,
                               const struct region *region)
{
    const struct shape *const line = beam->shape.item;
    const double dp = check->scene->top.dp;
    for (int k = 0; k < line->n; k++) {
        const struct part p = part_of(beam, line, k + 1 < line->n ? k : k - 1);
        double at[2];
        if (lies_in(check, &p, region, beside * dp, at) > 0)
            return fail_at(check->diag, check->scene, line->line,
                           "[beam %s] lies in %s or on its face, at (%.6g, %.6g) m; end its "
                           "line at the face of the body",
                           beam->common.name, section_title(region->common).text, at[0], at[1]);
        const double depth = lies_in(check, &p, region, half_of(beam) - beside * dp, at);
        if (half_of(beam) > 2 * beside * dp && depth > 0)
            return fail_at(check->diag, check->scene, line->line,
                           "[beam %s] lies %.4g m deep in %s by its thickness of %.4g m, at "
                           "(%.6g, %.6g) m; move its line away or make it thinner",
                           beam->common.name, depth, section_title(region->common).text,
                           2 * half_of(beam), at[0], at[1]);
        if (is_about(region, line->pt[k], beside * dp) && !is_held(check, beam, line->pt[k], NULL))
            return fail_at(check->diag, check->scene, line->line,
                           "[beam %s] touches %s with a free point, at (%.6g, %.6g) m; hold "
                           "it there by `clamp` or `hinge`, or leave a gap",
                           beam->common.name, section_title(region->common).text, line->pt[k][0],
                           line->pt[k][1]);
    }
    for (int s = 0; s < region->list->n; s++) {
        const struct shape *const thin = &region->list->item[s];
        for (int j = 0; thin->thin && j + 1 < thin->n; j++)
            for (int k = 0; k + 1 < line->n; k++) {
                const struct part p = part_of(beam, line, k), q = part_of(NULL, thin, j);
                double at[2];
                if (meet(check, &p, &q, at))
                    return fail_at(check->diag, check->scene, line->line,
                                   "[beam %s] meets the line of [wall %s] at (%.6g, %.6g) m%s; "
                                   "hold it there by `clamp` or `hinge`, or leave a gap",
                                   beam->common.name, region->common->name, at[0], at[1],
                                   by_thickness(&p, &q, at).text);
            }
    }
    return ERR_OK;
}

/* Joints of a beam on a body that is further away than a spacing. */
static enum err refuse_far(const struct check *check, const struct scene_beam *beam,
                           const struct hinge_list *list, const struct region *region)
{
    for (int k = 0; k < list->n; k++) {
        const struct hinge_point *const h = &list->item[k];
        if (strcmp(h->other, region->common->name) != 0 ||
            is_about(region, h->at, check->scene->top.dp))
            continue;
        return fail_at(check->diag, check->scene, h->line,
                       "[beam %s] %s = %.6g, %.6g, %s: %s is more than a spacing from it; "
                       "choose a point of the beam at the face of the body",
                       beam->common.name, list == &beam->clamp ? "clamp" : "hinge", h->at[0],
                       h->at[1], h->other, section_title(region->common).text);
    }
    return ERR_OK;
}

enum err refuse_beams(const struct check *check)
{
    const struct scene *const scene = check->scene;
    const int first = scene->n_solid + scene_beam_wall(scene, 0);
    for (int k = 0; k < scene->n_beam; k++) {
        for (int j = 0; j <= k; j++) TRY(refuse_meeting(check, &scene->beam[k], &scene->beam[j]));
        for (int r = 0; r < first; r++) {
            const bool apart = r < scene->n_solid || scene_contact_of(scene, first + k, r);
            const struct region *const region = &check->shapes.regions[r];
            if (apart) TRY(refuse_in_body(check, &scene->beam[k], region));
            if (r < scene->n_solid + scene_rigid_wall(scene, 0)) continue;
            TRY(refuse_far(check, &scene->beam[k], &scene->beam[k].clamp, region));
            TRY(refuse_far(check, &scene->beam[k], &scene->beam[k].hinge, region));
        }
    }
    return ERR_OK;
}
