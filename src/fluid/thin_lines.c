/* SPDX-License-Identifier: MIT
 * Places the dummies and pieces of thin lines, and finds what a line separates (T-110). */
#include "fluid/wall_motion.h"
#include "geometry/motion.h"

static int parts_of(const struct thin_line *line) { return line->given->n - 1; }

/* The ends as the scene has them, at rest. */
static void start_ends(struct thin_line *line)
{
    for (int k = 0; k < parts_of(line); k++) {
        const double *const a = line->given->pt[k], *const b = line->given->pt[k + 1];
        const double length = elementary_hypot(b[0] - a[0], b[1] - a[1]);
        for (int last = 0; last < 2; last++)
            line->end[2 * k + last] =
                (struct line_end){.x = {(last ? b : a)[0], (last ? b : a)[1]},
                                  .normal = {-(b[1] - a[1]) / length, (b[0] - a[0]) / length}};
    }
}

void line_follow(struct thin_line *line, const struct motion_state *motion)
{
    start_ends(line);
    for (int k = 0; k < 2 * parts_of(line); k++) {
        struct line_end *const end = &line->end[k];
        const struct motion_point at = motion_of_point(motion, end->x[0], end->x[1]);
        const double n[2] = {end->normal[0], end->normal[1]};
        memcpy(end->x, at.x, sizeof end->x);
        memcpy(end->v, at.v, sizeof end->v);
        memcpy(end->a, at.a, sizeof end->a);
        end->normal[0] = motion->turn[0] * n[0] - motion->turn[1] * n[1];
        end->normal[1] = motion->turn[1] * n[0] + motion->turn[0] * n[1];
        end->rate = motion->rate;
        end->angular_acceleration = motion->angular_acceleration;
    }
}

/* A dummy's place relative to an end of its part. */
SPHFSI_INLINE void arm_of(const struct line_dummy *dummy, const struct line_end *end, double arm[2])
{
    arm[0] = dummy->off * end->normal[0] + dummy->beyond * end->normal[1];
    arm[1] = dummy->off * end->normal[1] - dummy->beyond * end->normal[0];
}

void line_tangent(const struct thin_line *line, int64_t j, double t[2])
{
    const struct line_dummy *const dummy = &line->given->dummy[j];
    const struct line_end *const end = &line->end[2 * dummy->part];
    double n[2];
    for (int c = 0; c < 2; c++)
        n[c] = (1 - dummy->along) * end[0].normal[c] + dummy->along * end[1].normal[c];
    const double size = elementary_hypot(n[0], n[1]);
    t[0] = n[1] / size;
    t[1] = -n[0] / size;
}

void line_slides(const struct thin_line *line, int64_t i, double t[2])
{
    const struct line_dummy *const dummy = &line->given->dummy[i - line->first];
    const struct scene_thin_line *const from = line->given;
    const bool tip[] = {from->tip[0] && from->extend[0] == 0, from->tip[1] && from->extend[1] == 0};
    const bool first = dummy->part == 0 && tip[0],
               last = dummy->part + 1 == parts_of(line) && tip[1];
    if (!tip[0] && !tip[1]) return;
    if ((dummy->beyond < 0 && !first) || (dummy->beyond > 0 && !last)) return;
    line_tangent(line, i - line->first, t);
}

/* T-111a: along a beam its dummies have the motion of its carrier. */
static void carry(const struct thin_line *line, int64_t j, double v[2], double a[2])
{
    const struct line_carrier *const carrier = &line->carrier;
    double t[2], foot[2], excess[2] = {0};
    line_tangent(line, j, t);
    line_foot(line, j, foot);
    const double arm[2] = {foot[0] - carrier->x[0], foot[1] - carrier->x[1]},
                 across[2] = {-arm[1], arm[0]};
    for (int c = 0; c < 2; c++) {
        excess[0] += t[c] * (carrier->v[c] + carrier->spin * across[c] - v[c]);
        excess[1] += t[c] * (carrier->a[c] + carrier->spin_rate * across[c] -
                             square(carrier->spin) * arm[c] - a[c]);
    }
    for (int c = 0; c < 2; c++) {
        v[c] += excess[0] * t[c];
        a[c] += excess[1] * t[c];
    }
}

static void place_dummy(const struct thin_line *line, int64_t j, struct particles *walls)
{
    const struct line_dummy *const dummy = &line->given->dummy[j];
    const int64_t i = line->first + j;
    double x[2] = {0}, v[2] = {0}, a[2] = {0};
    for (int last = 0; last < 2; last++) {
        const struct line_end *const end = &line->end[2 * dummy->part + last];
        const double weight = last ? dummy->along : 1 - dummy->along;
        double arm[2];
        arm_of(dummy, end, arm);
        for (int c = 0; c < 2; c++) {
            const double across = c ? arm[0] : -arm[1];
            x[c] += weight * (end->x[c] + arm[c]);
            v[c] += weight * (end->v[c] + end->rate * across);
            a[c] += weight *
                    (end->a[c] + end->angular_acceleration * across - square(end->rate) * arm[c]);
        }
    }
    walls->x[i] = x[0];
    walls->y[i] = x[1];
    if (!walls->ax) return;
    if (line->bends) carry(line, j, v, a);
    walls->vx[i] = v[0];
    walls->vy[i] = v[1];
    walls->ax[i] = a[0];
    walls->ay[i] = a[1];
}

void line_foot(const struct thin_line *line, int64_t j, double at[2])
{
    const struct line_dummy *const dummy = &line->given->dummy[j];
    const struct line_end *const end = &line->end[2 * dummy->part];
    for (int c = 0; c < 2; c++)
        at[c] = (1 - dummy->along) * end[0].x[c] + dummy->along * end[1].x[c];
}

/* Where a point is if it moves with a wall; NULL: at rest. */
static void place_with(const struct moving_wall *wall, const double at[2], double to[2])
{
    memcpy(to, wall ? motion_of_point(&wall->placed, at[0], at[1]).x : at, 2 * sizeof *to);
}

/* T-111b: an end may leave the wall at which it begins. In single precision round-off at a hinge is
 * no distance. */
static void leave_walls(struct thin_line *line)
{
    const struct scene_thin_line *const from = line->given;
    for (int last = 0; last < 2; last++) {
        const double *const at = line->end[last ? 2 * parts_of(line) - 1 : 0].x;
        double start[2], inner[2];
        place_with(line->starts_at[last], from->pt[last ? from->n - 1 : 0], start);
        place_with(line->starts_at[last], from->pt[last ? from->n - 2 : 1], inner);
        const double x = start[0] - inner[0], y = start[1] - inner[1];
        const double off =
            (x * (start[0] - at[0]) + y * (start[1] - at[1])) / elementary_hypot(x, y);
        const float left = 1 - (float)max2(0, min2(1, off / line->dp));
        line->extend[last] = (double)left * from->extend[last];
        line->tip[last] = from->tip[last] && (from->extend[last] == 0 || left < 1);
    }
}

/* The pieces: the parts, and the extensions straight on from its first and last end. */
static void place_pieces(struct thin_line *line)
{
    const int parts = parts_of(line);
    struct box2 box = box2_empty();
    for (int k = 0; k < parts; k++) {
        memcpy(line->piece[k + 1].from, line->end[2 * k].x, sizeof line->piece->from);
        memcpy(line->piece[k + 1].to, line->end[2 * k + 1].x, sizeof line->piece->to);
    }
    const struct line_end *const start = &line->end[0], *const last = &line->end[2 * parts - 1];
    struct line_piece *const before = &line->piece[0], *const after = &line->piece[parts + 1];
    for (int c = 0; c < 2; c++) {
        const double along[2] = {c ? -start->normal[0] : start->normal[1],
                                 c ? -last->normal[0] : last->normal[1]};
        before->from[c] = start->x[c] - line->extend[0] * along[0];
        before->to[c] = start->x[c];
        after->from[c] = last->x[c];
        after->to[c] = last->x[c] + line->extend[1] * along[1];
    }
    line->n_pieces = parts + 2;
    line->length = 0;
    for (int k = 0; k < line->n_pieces; k++) {
        struct line_piece *const piece = &line->piece[k];
        piece->start = line->length;
        piece->length =
            elementary_hypot(piece->to[0] - piece->from[0], piece->to[1] - piece->from[1]);
        line->length += piece->length;
        box2_include(&box, piece->from[0], piece->from[1]);
        box2_include(&box, piece->to[0], piece->to[1]);
    }
    line->box = box;
}

void line_place(struct thin_line *line, struct particles *walls, bool predicted)
{
#pragma omp parallel for schedule(static)
    for (int64_t j = 0; j < line->given->n_dummies; j++) place_dummy(line, j, walls);
    if (!predicted) leave_walls(line);
    place_pieces(line);
}

void line_at_ends(const struct thin_line *line, int64_t j, double x, double y, double to[6])
{
    const struct line_dummy *const dummy = &line->given->dummy[j];
    for (int last = 0; last < 2; last++) {
        const double weight = last ? dummy->along : 1 - dummy->along;
        double arm[2];
        arm_of(dummy, &line->end[2 * dummy->part + last], arm);
        to[3 * last] = weight * x;
        to[3 * last + 1] = weight * y;
        to[3 * last + 2] = weight * (arm[0] * y - arm[1] * x);
    }
}

enum err lines_create(struct lines *lines, struct arena *a, const struct scene *scene,
                      struct particles *walls, struct diag *d)
{
    static const char what[] = "thin walls";
    lines->n = scene->n_thin;
    lines->volume = scene->points[KIND_WALL].volume;
    TRY(arena_array(a, &lines->line, lines->n, what, d));
    TRY(arena_array(a, &lines->of_wall, walls->n, what, d));
    TRY(arena_array(a, &lines->filled, walls->n, what, d));
    for (int k = 0; k < lines->n; k++) {
        struct thin_line *const line = &lines->line[k];
        line->given = &scene->thin[k];
        const int parts = parts_of(line);
        line->first = line->given->first;
        line->dp = scene->top.dp;
        for (int64_t j = 0; j < line->given->n_dummies; j++)
            lines->of_wall[line->first + j] = k + 1;
        TRY(arena_array(a, &line->end, 2 * (size_t)parts, what, d));
        TRY(arena_array(a, &line->piece, (size_t)parts + 2, what, d));
        lines->n_pieces += parts + 2;
        start_ends(line);
        line_place(line, walls, false);
    }
    return ERR_OK;
}

void lines_tie(struct lines *lines, const struct wall_motion *m)
{
    for (int k = 0; k < lines->n; k++)
        for (int b = 0; b < m->n; b++) {
            const struct moving_wall *const wall = &m->wall[b];
            struct thin_line *const line = &lines->line[k];
            if (wall->motion < 0) continue;
            if (line->given->wall == wall->section) line->follows = wall;
            for (int last = 0; last < 2; last++)
                if (line->given->extend[last] > 0 && line->given->into[last] == wall->section)
                    line->starts_at[last] = wall;
        }
}

/* T-110b: how much passes a piece that the connection `offset` crosses between these ends, which
 * are relative to its beginning. */
static double passes_piece(const struct thin_line *line, const struct line_piece *piece,
                           const double offset[2], const double from[2], const double to[2],
                           double reach)
{
    const double a = offset[0] * from[1] - offset[1] * from[0],
                 b = offset[0] * to[1] - offset[1] * to[0];
    const double along = piece->start + piece->length * a / (a - b);
    const double first = line->tip[0] ? along : reach,
                 last = line->tip[1] ? line->length - along : reach;
    return max2(0, 1 - min2(first, last) / reach);
}

double lines_seen(const struct lines *lines, const struct cells *cells, double reach,
                  const double from[2], const double offset[2], int32_t own, double filled)
{
    double clear = 1;
    for (int k = 0; k < lines->n; k++) {
        const struct thin_line *const line = &lines->line[k];
        bool odd = false;
        double passes = 1;
        for (int image = 0; image < CELLS_IMAGES; image++) {
            double shift[2];
            if (!cells_image(cells, image, shift)) continue;
            for (int m = 0; m < line->n_pieces; m++) {
                const double *const start = line->piece[m].from, *const end = line->piece[m].to;
                const double one[2] = {start[0] + shift[0] - from[0],
                                       start[1] + shift[1] - from[1]},
                             other[2] = {end[0] + shift[0] - from[0], end[1] + shift[1] - from[1]};
                if (!crosses_piece(offset, one, other)) continue;
                odd = !odd;
                passes =
                    min2(passes, passes_piece(line, &line->piece[m], offset, one, other, reach));
            }
        }
        if (!odd) passes = 1;
        if (own == k + 1) return odd ? clear * (1 - filled * passes) : 0;
        clear *= passes;
    }
    return own ? 0 : clear;
}
