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

/* Whether a clamp or hinge of a beam on another (NULL: any body) is near a place. */
static bool is_held(const struct check *check, const struct scene_beam *beam, const double at[2],
                    const struct scene_beam *other)
{
    const double reach = beam->element > 0 ? beam->element : check->scene->top.dp;
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

/* Whether two parts meet where they may not, and where. */
static bool meet(const struct check *check, const struct part *p, const struct part *q,
                 double at[2])
{
    const double nothing = beside * check->scene->top.dp;
    double end[4][2]; /* of q relative to p, of p relative to q */
    for (int k = 0; k < 4; k++) {
        const struct part *const on = k < 2 ? p : q, *const of = k < 2 ? q : p;
        memcpy(at, k % 2 ? of->line.to : of->line.from, 2 * sizeof *at);
        relative_to_part(&on->line, at, end[k]);
        const double beyond = max2(-end[k][0], end[k][0] - on->line.length);
        if (fabs(end[k][1]) < nothing && beyond < nothing && !may_meet(check, p, q, at))
            return true;
    }
    if (!(end[0][1] * end[1][1] < 0 && end[2][1] * end[3][1] < 0)) return false;
    const double part = end[0][1] / (end[0][1] - end[1][1]);
    place_on_part(&p->line, end[0][0] + part * (end[1][0] - end[0][0]), 0, at);
    return !may_meet(check, p, q, at);
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
                           "[beam %s] meets [beam %s] at (%.6g, %.6g) m without a joint; give "
                           "[beam %s] a `clamp` or `hinge` = X, Y, %s there, besides joints with "
                           "other beams, or move one of them",
                           beam->common.name, other->common.name, at[0], at[1], beam->common.name,
                           other->common.name);
        }
    return ERR_OK;
}

/* --- bodies --- */

/* Whether a place of a part, other than its ends, lies in a region or on its face. */
static bool lies_in(const struct line_part *p, const struct region *region, double dp, double at[2])
{
    const double inner = p->length - 2 * ahead * dp;
    const int n = 1 + (int)max2(0, inner / (between * dp));
    for (int k = 0; k <= n; k++)
        for (int side = -1; side < 2; side += 2) {
            place_on_part(p, ahead * dp + inner * k / n, side * beside * dp, at);
            if (geometry_covers(region, at[0], at[1])) return true;
        }
    return false;
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
        if (lies_in(&p.line, region, dp, at))
            return fail_at(check->diag, check->scene, line->line,
                           "[beam %s] lies in %s or on its face, at (%.6g, %.6g) m; end its "
                           "line at the face of the body",
                           beam->common.name, section_title(region->common).text, at[0], at[1]);
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
                                   "[beam %s] meets the line of [wall %s] at (%.6g, %.6g) m; hold "
                                   "it there by `clamp` or `hinge`, or leave a gap",
                                   beam->common.name, region->common->name, at[0], at[1]);
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
