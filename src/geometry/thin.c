/* SPDX-License-Identifier: MIT
 * Thin lines and their dummies (T-110). Behind the line, as seen from either side, dummies lie in
 * rows as deep as the kernel. They continue beyond the ends, where only fluid sees them whose view
 * the line blocks. */
#include "geometry/thin.h"
#include "geometry/sampling.h"
#include "particles/kernel.h"

static struct line_part line_part_at(const struct scene_thin_line *line, int k)
{
    return line_part(line->pt[k], line->pt[k + 1]);
}

/* Distance of a place from a part; `left` of the part's line by so much, m. */
static double distance_from(const struct line_part *part, const double at[2], double *left)
{
    double place[2];
    relative_to_part(part, at, place);
    *left = place[1];
    return elementary_hypot(*left, place[0] - min2(max2(place[0], 0), part->length));
}

static void place_of(const struct scene_thin_line *line, const struct line_dummy *dummy,
                     double at[2])
{
    const struct line_part part = line_part_at(line, dummy->part);
    place_on_part(&part, dummy->along * part.length + dummy->beyond, dummy->off, at);
}

static bool is_closed(int n, double (*const pt)[2])
{
    return pt[0][0] == pt[n - 1][0] && pt[0][1] == pt[n - 1][1];
}

static int rows_of_line(const struct scene *scene)
{
    return (int)ceil(KERNEL_REACH * scene->h / scene->top.dp - 1e-9);
}

/* Odd: the middle one of these places in a step is a station. */
enum { PLACES = 15 };

/* Whether a place beside a part is nearer to another one. A place as far from both belongs to the
 * first of them that has it on the same side. No part is further from the next than the longest. */
static bool belongs_elsewhere(const struct scene_thin_line *line, const struct line_dummy *dummy,
                              double dp)
{
    const struct line_part own = line_part_at(line, dummy->part);
    double at[2], left;
    place_of(line, dummy, at);
    const double distance = distance_from(&own, at, &left), tie = 1e-6 * dp;
    for (int k = 0; k + 1 < line->n; k++) {
        const struct line_part other = line_part_at(line, k);
        const double its = distance_from(&other, at, &left);
        if (k != dummy->part &&
            (its < distance - tie || (its < distance + tie && k < dummy->part &&
                                      left * dummy->off > 0 && fabs(left) > tie)))
            return true;
        k += (int)max2(0, (its - distance) / line->longest - 1);
    }
    return false;
}

/* geometry_keep_off of the first n lines. The nearest part of each counts. */
static bool keep_off(const struct scene *scene, int n, double gap, double at[2])
{
    bool moved = false;
    for (int j = 0; j < n; j++) {
        const struct scene_thin_line *const line = &scene->thin[j];
        const double wanted = line->half + gap;
        double nearest = wanted, place[2], left;
        int its = -1;
        for (int k = 0; k + 1 < line->n; k++) {
            const struct line_part part = line_part_at(line, k);
            const double distance = distance_from(&part, at, &left);
            if (distance < nearest) its = k;
            nearest = min2(nearest, distance);
            k += (int)max2(0, (distance - wanted) / line->longest - 1);
        }
        if (its < 0) continue;
        const struct line_part part = line_part_at(line, its);
        relative_to_part(&part, at, place);
        if (!is_closed(line->n, line->pt) &&
            ((its == 0 && place[0] < 0) || (its + 2 == line->n && place[0] > part.length)))
            continue;
        const double along = min2(max2(place[0], 0), part.length),
                     factor = wanted / max2(nearest, 1e-300);
        place_on_part(&part, along + factor * (place[0] - along), factor * place[1], at);
        moved = true;
    }
    return moved;
}

/* Whether a dummy within the thickness lies beyond the face there: beside a corner, or beyond the
 * line's end; or in a beam before, to which this one is joined. */
static bool lies_outside(const struct scene *scene, const struct scene_thin_line *line,
                         const struct line_dummy *dummy)
{
    double at[2];
    place_of(line, dummy, at);
    if (keep_off(scene, (int)(line - scene->thin), 0, at)) return true;
    const bool end = dummy->beyond < 0 ? dummy->part == 0 : dummy->part == line->n - 2;
    return dummy->beyond != 0 && ((end && !is_closed(line->n, line->pt)) ||
                                  elementary_hypot(dummy->off, dummy->beyond) > line->half);
}

/* A row of a part's dummies for the fluid on one side (1: left, -1: right), one for each step of
 * the row, which is shorter or longer than a line that turns. `start`: where the part begins;
 * `from`, `to`: how deep the row lies below the face, in dp; `passed`: places of the row since the
 * end of its last full step. */
static enum err lay_row(struct sampler *sampler, struct scene_thin_line *line, int k, double start,
                        double step, double side, double from, double to, int *passed)
{
    const double dp = sampler->scene->top.dp, length = line_part_at(line, k).length,
                 deep = max2(line->half, dp * rows_of_line(sampler->scene)),
                 both = 2 * line->half / dp;
    const int64_t first = (int64_t)ceil((start - deep) / step - 0.5),
                  end = (int64_t)ceil((start + length + deep) / step - 0.5);
    for (int64_t j = PLACES * first; j < PLACES * end; j++) {
        const double along = ((double)j + 0.5) / PLACES * step - start,
                     on_part = min2(max2(along, 0), length),
                     off = 0.5 * (from + to) * dp - line->half;
        const struct line_dummy dummy = {.part = k,
                                         .same_side = off < 0,
                                         .along = on_part / length,
                                         .off = side * off,
                                         .beyond = along - on_part,
                                         .width = to - from,
                                         .inside = max2(0, min2(both, to) - from) / (to - from)};
        if ((dummy.same_side && lies_outside(sampler->scene, line, &dummy)) ||
            belongs_elsewhere(line, &dummy, dp))
            continue;
        if (++*passed <= PLACES / 2) continue;
        *passed -= PLACES;
        TRY(arena_more(&sampler->scene->arena, &line->dummy, line->n_dummies, "thin walls",
                       sampler->diag));
        line->dummy[line->n_dummies++] = dummy;
    }
    return ERR_OK;
}

/* T-110f: rows from the face on, as deep as the kernel, and at least to the line; it cuts the row
 * that it meets. */
static enum err lay_part(struct sampler *sampler, struct scene_thin_line *line, int k, double start,
                         double step, double side, int *passed)
{
    const double half = line->half / sampler->scene->top.dp,
                 deep = max2(rows_of_line(sampler->scene), half), nothing = 1e-6;
    for (double from = 0, to; from < deep; from = to) {
        to = min2(deep, floor(from + 1 + nothing));
        if (from < half - nothing && half < to - nothing) to = half;
        TRY(lay_row(sampler, line, k, start, step, side, from, to, passed++));
    }
    return ERR_OK;
}

/* A line that ends at a wall continues into it, so that the fluid of one side does not see the
 * wall's particles below the other side. The wall may end there, too. */
static double extension(const struct sampler *sampler, struct scene_thin_line *line, bool last)
{
    const struct line_part part = line_part_at(line, last ? line->n - 2 : 0);
    const double reach = KERNEL_REACH * sampler->scene->h, dp = sampler->scene->top.dp;
    for (int k = 0; k < 3 * sampler->n_regions; k++) {
        double at[2];
        place_on_part(&part, last ? part.length + 0.5 * dp : -0.5 * dp, (k % 3 - 1) * 1e-3 * dp,
                      at);
        const struct region *const region = &sampler->regions[k / 3];
        if (region->kind != KIND_WALL || geometry_piece_at(region, at[0], at[1]) < 0) continue;
        line->into[last] = region->body;
        return reach;
    }
    return 0;
}

/* Whether an end of a line lies on another part of it or of another line, also through a periodic
 * side: no fluid flows round it. */
static bool is_joined(const struct scene *scene, const struct scene_thin_line *line, bool last)
{
    const double *const end = line->pt[last ? line->n - 1 : 0];
    for (int j = 0; j < scene->n_thin; j++)
        for (int k = 0; k + 1 < scene->thin[j].n; k++) {
            const struct line_part part = line_part_at(&scene->thin[j], k);
            for (int image = 0; image < 9; image++) {
                const int times[2] = {image % 3 - 1, image / 3 - 1};
                double at[2], left;
                for (int c = 0; c < 2; c++)
                    at[c] = end[c] + times[c] * scene_periodic(scene, c) *
                                         (scene->domain.upper[c] - scene->domain.lower[c]);
                const bool own = &scene->thin[j] == line && k == (last ? line->n - 2 : 0) &&
                                 at[0] == end[0] && at[1] == end[1];
                if (!own && distance_from(&part, at, &left) < 0.5 * scene->top.dp) return true;
            }
        }
    return false;
}

static enum err add_line(struct sampler *sampler, int wall, const struct shape *shape)
{
    struct scene *const scene = sampler->scene;
    const int beam = wall - scene_beam_wall(scene, 0);
    TRY(arena_more(&scene->arena, &scene->thin, scene->n_thin, "thin walls", sampler->diag));
    struct scene_thin_line *const line = &scene->thin[scene->n_thin++];
    *line = (struct scene_thin_line){.wall = wall, .n = shape->n, .pt = shape->pt};
    if (beam >= 0) line->half = scene_half_thickness(&scene->beam[beam]);
    double length = 0, start = 0;
    for (int k = 0; k + 1 < line->n; k++) {
        const double part = line_part_at(line, k).length;
        length += part;
        line->longest = max2(line->longest, part);
    }
    const double step = length / max2(1, round(length / scene->top.dp));
    for (int last = 0; last < 2 && !is_closed(line->n, line->pt); last++) {
        line->extend[last] = extension(sampler, line, last);
        line->tip[last] = true;
    }
    TRY(arena_array(&scene->arena, &line->seen, line->n, "thin walls", sampler->diag));
    memcpy(line->seen, line->pt, (size_t)line->n * sizeof *line->pt);
    for (int last = 0; last < 2; last++) {
        const struct line_part part = line_part_at(line, last ? line->n - 2 : 0);
        const double along = last ? part.length + line->extend[1] : -line->extend[0];
        if (line->extend[last] > 0)
            place_on_part(&part, along, 0, line->seen[last ? line->n - 1 : 0]);
    }
    const int rows = rows_of_line(scene) + (int)(line->half / scene->top.dp) + 2;
    int *passed;
    TRY(geometry_array(sampler, &passed, 2 * rows));
    for (int k = 0; k + 1 < line->n && scene->n_fluid; start += line_part_at(line, k++).length)
        for (int side = 0; side < 2; side++)
            TRY(lay_part(sampler, line, k, start, step, side ? 1 : -1, passed + side * rows));
    return ERR_OK;
}

double geometry_line_distance(const struct scene *scene, const double at[2], double *left)
{
    double nearest = (double)INFINITY, its_left;
    *left = 0;
    for (int j = 0; j < scene->n_thin; j++)
        for (int k = 0; k + 1 < scene->thin[j].n; k++) {
            const struct line_part part = line_part_at(&scene->thin[j], k);
            const double distance = distance_from(&part, at, &its_left);
            if (distance < nearest) *left = its_left;
            nearest = min2(nearest, distance);
        }
    return nearest;
}

bool geometry_keep_off(const struct scene *scene, double gap, double at[2])
{
    return keep_off(scene, scene->n_thin, gap, at);
}

static bool turns_at(const struct shape *line, int k)
{
    if (k == 0 && !is_closed(line->n, line->pt)) return false;
    const struct line_part before = line_part(line->pt[k ? k - 1 : line->n - 2], line->pt[k]),
                           after = line_part(line->pt[k], line->pt[k + 1]);
    return fabs(before.t[0] * after.t[1] - before.t[1] * after.t[0]) > 1e-9;
}

/* T-110f: a box around each part of a beam, and a disc around each of its corners. */
enum err geometry_subtract_beams(struct sampler *sampler, struct outlines *minus)
{
    const struct scene *const scene = sampler->scene;
    const struct outlines own = *minus;
    int n = own.n;
    for (int b = 0; b < scene->n_beam; b++) n += 2 * scene->beam[b].shape.item->n;
    TRY(geometry_array(sampler, &minus->item, n));
    TRY(geometry_array(sampler, &minus->shape, n));
    minus->n = 0;
    for (int k = 0; k < own.n; k++) outlines_add(minus, &own.item[k], own.shape[k]);
    for (int b = 0; b < scene->n_beam; b++) {
        const struct shape *const line = scene->beam[b].shape.item;
        const double half = scene_half_thickness(&scene->beam[b]);
        for (int k = 0; k + 1 < line->n && half > 0; k++) {
            const struct line_part part = line_part(line->pt[k], line->pt[k + 1]);
            struct outline box = {.n = 4},
                           disc = {.centre = {line->pt[k][0], line->pt[k][1]}, .radius = half};
            TRY(geometry_array(sampler, &box.pt, 4));
            for (int c = 0; c < 4; c++)
                place_on_part(&part, c == 1 || c == 2 ? part.length : 0, c < 2 ? -half : half,
                              box.pt[c]);
            outlines_add(minus, &box, -1);
            if (turns_at(line, k)) outlines_add(minus, &disc, -1);
        }
    }
    return ERR_OK;
}

/* A connection that is further from the end of a piece than the next ones reach crosses none of
 * them. The last piece may be longer. */
int geometry_between(const struct scene *scene, const double from[2], const double to[2])
{
    const double offset[2] = {to[0] - from[0], to[1] - from[1]};
    const double length2 = square(offset[0]) + square(offset[1]), length = sqrt(length2);
    for (int j = 0; j < scene->n_thin; j++) {
        const struct scene_thin_line *const line = &scene->thin[j];
        const double piece = 1 / max2(length * line->longest, 1e-300);
        bool odd = false;
        for (int k = 0; k + 1 < line->n; k++) {
            const double *const seen = line->seen[k + 1],
                                a[2] = {line->seen[k][0] - from[0], line->seen[k][1] - from[1]},
                                b[2] = {seen[0] - from[0], seen[1] - from[1]};
            odd ^= crosses_piece(offset, a, b);
            const double along = offset[0] * b[0] + offset[1] * b[1],
                         across = offset[0] * b[1] - offset[1] * b[0],
                         far = max2(fabs(across), max2(-along, along - length2));
            k += (int)max2(0, min2(far * piece - 1, line->n - 3 - k));
        }
        if (odd) return j + 1;
    }
    return 0;
}

/* Solids and rigid bodies would pass through a line. */
static enum err refuse_contact(struct sampler *sampler, int wall, const struct shape *shape)
{
    const struct scene *const scene = sampler->scene;
    const char *const name = scene->wall[wall].common.name;
    const bool beam = wall >= scene_beam_wall(scene, 0);
    for (int k = 0; k < scene->n_solid; k++)
        if (scene_contact_of(scene, k, scene->n_solid + wall))
            return geometry_refuse(
                sampler, shape->line,
                "this line of [%s %s] has no thickness, so [solid %s] cannot touch it; %sswitch "
                "their contact off: [contact] between = %s, %s and enabled = off",
                beam ? "beam" : "wall", name, scene->solid[k].common.name,
                beam ? "" : "give it a thickness, or ", scene->solid[k].common.name, name);
    return ERR_OK;
}

enum err geometry_thin(struct sampler *sampler)
{
    struct scene *const scene = sampler->scene;
    for (int k = 0; k < scene->n_wall; k++)
        for (int j = 0; j < scene->wall[k].shape.n; j++) {
            if (!scene->wall[k].shape.item[j].thin) continue;
            TRY(refuse_contact(sampler, k, &scene->wall[k].shape.item[j]));
            TRY(add_line(sampler, k, &scene->wall[k].shape.item[j]));
        }
    for (int k = 0; k < scene->n_thin; k++)
        for (int last = 0; last < 2; last++)
            if (is_joined(scene, &scene->thin[k], last)) scene->thin[k].tip[last] = false;
    return ERR_OK;
}

int geometry_cut(const struct scene *scene, enum kind kind, int body, double x, double y,
                 double to[2][3])
{
    const struct scene_lattice *const l = &scene->lattice;
    const double at[2] = {x, y}, nothing = 1e-6;
    for (int k = 0; k < 2 * scene->n_thin && kind == KIND_WALL; k++) {
        const struct scene_thin_line *const line = &scene->thin[k / 2];
        const bool last = k % 2;
        if (line->into[last] != body) continue;
        const struct line_part part = line_part_at(line, last ? line->n - 2 : 0);
        const double along = part.t[0] * l->turn[0] + part.t[1] * l->turn[1],
                     across = part.t[1] * l->turn[0] - part.t[0] * l->turn[1],
                     width = scene->top.dp * (fabs(along) + fabs(across));
        double place[2];
        relative_to_part(&part, at, place);
        const double beyond = last ? place[0] - part.length : -place[0],
                     left = 0.5 + place[1] / width;
        if (beyond < 0 || beyond > line->extend[last] || left < nothing || left > 1 - nothing)
            continue;
        for (int side = 0; side < 2; side++) {
            to[side][2] = side ? 1 - left : left;
            place_on_part(&part, place[0], (side ? -0.5 : 0.5) * width * to[side][2], to[side]);
        }
        return 2;
    }
    to[0][0] = x;
    to[0][1] = y;
    to[0][2] = 1;
    return 1;
}

void geometry_thin_store(struct scene *scene, int wall)
{
    struct scene_points *const to = &scene->points[KIND_WALL];
    for (struct scene_thin_line *line = scene->thin; line < scene->thin + scene->n_thin; line++) {
        if (line->wall != wall) continue;
        line->first = to->n;
        for (int64_t j = 0; j < line->n_dummies; j++) {
            double at[2];
            place_of(line, &line->dummy[j], at);
            to->x[to->n] = at[0];
            to->y[to->n] = at[1];
            to->volume[to->n] = line->dummy[j].width;
            to->body[to->n++] = wall;
        }
    }
}
