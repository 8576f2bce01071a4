/* SPDX-License-Identifier: MIT
 * Shapes of a case file:
 *
 *   box X0, Y0, X1, Y1                    lower left and upper right corner
 *   circle X, Y, R
 *   polygon X, Y; X, Y; X, Y ...          corners in either order of turning
 *   polyline thickness T: X, Y; X, Y ...  a band to the left of the direction of the points; T < 0:
 *                                         to the right; last point = first point: closed
 *   polyline thickness 0: X, Y; X, Y ...  of a wall: a thin line, with fluid on both sides
 *   polyline: X, Y; X, Y ...              the side of a wall, whose thickness the kernel determines
 *   arc thickness T: X, Y, R, A, B        a polyline along a circle, from angle A to angle B
 *   arc: X, Y, R, A, B */
#include "case/case.h"
#include "base/elementary.h"

static enum err read_coordinate(struct reader *r, struct slice text, double *value)
{
    TRY(case_number(r, text, "m", value));
    return fabs(*value) > 1e9 ? bad_value(r, "out of range: at most 1e9 m is allowed") : ERR_OK;
}

static enum err read_point(struct reader *r, struct slice text, int n, double *value)
{
    struct slice piece;
    const int given = slice_count(text, ',');
    if (given != n)
        return bad_value(r, "%d numbers with commas between them are expected; `%.*s` has %d%s", n,
                         (int)(text.length < 40 ? text.length : 40), text.at, given,
                         given > n ? comma_hint(r->entry->value) : "");
    for (int k = 0; k < n && slice_next(&text, ',', &piece); k++)
        TRY(read_coordinate(r, piece, &value[k]));
    return ERR_OK;
}

static enum err read_box(struct reader *r, struct slice text, struct shape *shape)
{
    const double *const v = shape->pt[0];
    TRY(read_point(r, text, 4, shape->pt[0]));
    if (v[0] < v[2] && v[1] < v[3]) return ERR_OK;
    return bad_value(r,
                     "box X0, Y0, X1, Y1 needs X0 < X1 and Y0 < Y1; here X %g to %g, Y %g to %g m",
                     v[0], v[2], v[1], v[3]);
}

static enum err read_circle(struct reader *r, struct slice text, struct shape *shape)
{
    double v[3] = {0};
    TRY(read_point(r, text, 3, v));
    if (!(v[2] > 0)) return bad_value(r, "the radius of a circle must be above 0 m");
    memcpy(shape->pt[0], v, sizeof shape->pt[0]);
    shape->size = v[2];
    return ERR_OK;
}

static enum err read_points(struct reader *r, struct slice text, struct shape *shape)
{
    struct slice piece;
    for (int k = 0; k < shape->n && slice_next(&text, ';', &piece); k++) {
        const double *const p = shape->pt[k], *const before = shape->pt[k > 0 ? k - 1 : 0];
        TRY(read_point(r, piece, 2, shape->pt[k]));
        if (k > 0 && p[0] == before[0] && p[1] == before[1])
            return bad_value(r, "points %d and %d are the same", k, k + 1);
    }
    return ERR_OK;
}

static double cross(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static enum err check_polygon(struct reader *r, const struct shape *shape)
{
    const int n = shape->n;
    double area = 0, size = 0;
    for (int k = 0; k < n; k++) {
        const double *a = shape->pt[k], *b = shape->pt[(k + 1) % n];
        area += 0.5 * cross(shape->pt[0], a, b);
        size = max2(size, elementary_hypot(b[0] - a[0], b[1] - a[1]));
    }
    if (fabs(area) <= 1e-12 * size * size)
        return bad_value(r, "the polygon has no area; check its points");
    for (int i = 0; i < n; i++)
        for (int j = i + 2; j < n; j++) {
            const double *const a = shape->pt[i], *const b = shape->pt[i + 1],
                                *const c = shape->pt[j], *const d = shape->pt[(j + 1) % n];
            if (cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0)
                return bad_value(r, "edges %d and %d of the polygon cross", i + 1, j + 1);
        }
    return ERR_OK;
}

/* "thickness T:", or ":" alone, before the points of a line. */
static enum err read_thickness(struct reader *r, struct slice *text, struct shape *shape)
{
    static const char word[] = "thickness";
    const size_t length = sizeof word - 1;
    struct slice number;
    const int section = r->sections[r->entry->section].id;
    const bool given = text->length >= length && memcmp(text->at, word, length) == 0,
               shaped = strcmp(r->entry->key, "shape") == 0,
               wall = (section == SECTION_wall || section == SECTION_beam) && shaped;
    shape->bare = text->at[0] == ':' && wall;
    if ((!given && !shape->bare) || !slice_next(text, ':', &number) || !text->at)
        return bad_value(r, "write `polyline thickness T: X, Y; X, Y; ...`; `thickness T` may be "
                            "left out in a `shape` of a [wall]");
    if (shape->bare) return ERR_OK;
    TRY(case_number(r, slice_after(number, length), "m", &shape->size));
    shape->thin = shape->size == 0 && (wall || (section == SECTION_rigid && shaped));
    if ((shape->size == 0 && !shape->thin) || fabs(shape->size) > 1e9)
        return bad_value(r, "the thickness must be at most 1e9 m, and 0 only in a `shape` of a "
                            "[wall] or [rigid]");
    return ERR_OK;
}

/* Points at most a degree apart. A full circle ends exactly where it begins. */
static enum err read_arc(struct reader *r, struct slice text, struct shape *shape)
{
    static const char *const units[] = {"m", "m", "m", "rad", "rad"};
    const double degree = PI / 180;
    double v[COUNT_OF(units)] = {0};
    struct slice piece;
    if (slice_count(text, ',') != (int)COUNT_OF(units))
        return bad_value(r, "write `arc: X, Y, R, A, B`: centre, radius and two angles");
    for (size_t k = 0; k < COUNT_OF(units) && slice_next(&text, ',', &piece); k++)
        TRY(case_number(r, piece, units[k], &v[k]));
    const double turn = v[4] - v[3], parts = ceil(fabs(turn) / degree - 1e-9);
    if (!(v[2] > 0 && v[2] <= 1e9) || !(fabs(v[0]) <= 1e9 && fabs(v[1]) <= 1e9) || !(parts > 0) ||
        parts > 360)
        return bad_value(
            r, "the radius must be above 0, and the angles differ by at most 360 degrees");
    shape->n = (int)parts + 1;
    TRY(arena_array(&r->scene->arena, &shape->pt, shape->n, "shape", r->diag));
    for (int k = 0; k < shape->n; k++) {
        const double angle = v[3] + turn * k / parts;
        shape->pt[k][0] = v[0] + v[2] * elementary_cos(angle);
        shape->pt[k][1] = v[1] + v[2] * elementary_sin(angle);
    }
    if (fabs(fabs(turn) - 2 * PI) < 1e-9 * degree)
        memcpy(shape->pt[shape->n - 1], shape->pt[0], sizeof *shape->pt);
    return ERR_OK;
}

const char *const shape_words[] = {[SHAPE_BOX] = "box",
                                   [SHAPE_POLYGON] = "polygon",
                                   [SHAPE_POLYLINE] = "polyline",
                                   [SHAPE_CIRCLE] = "circle",
                                   [SHAPE_CIRCLE + 1] = "arc"};

static enum err read_shape(struct reader *r, struct slice text, bool arc, struct shape *shape)
{
    static const int needed[] = {
        [SHAPE_BOX] = 2, [SHAPE_CIRCLE] = 1, [SHAPE_POLYGON] = 3, [SHAPE_POLYLINE] = 2};
    const int min_points = needed[shape->kind];
    const bool listed = shape->kind == SHAPE_POLYGON || shape->kind == SHAPE_POLYLINE;
    if (shape->kind == SHAPE_POLYLINE) TRY(read_thickness(r, &text, shape));
    if (arc) return read_arc(r, text, shape);
    shape->n = listed ? slice_count(text, ';') : min_points;
    if (shape->n < min_points)
        return bad_value(r, "%d points or more are expected, `X, Y; X, Y; ...`; there %s %d",
                         min_points, shape->n == 1 ? "is" : "are", shape->n);
    if (shape->n > CASE_MAX_POINTS)
        return bad_value(r, "more than %d points are given; use fewer points or several shapes",
                         CASE_MAX_POINTS);
    TRY(arena_array(&r->scene->arena, &shape->pt, shape->n, "shape", r->diag));
    if (shape->kind == SHAPE_BOX) return read_box(r, text, shape);
    if (shape->kind == SHAPE_CIRCLE) return read_circle(r, text, shape);
    TRY(read_points(r, text, shape));
    return shape->kind == SHAPE_POLYGON ? check_polygon(r, shape) : ERR_OK;
}

enum err case_shape(struct reader *r, struct shape_list *list)
{
    const size_t length = strcspn(r->entry->value, " \t:");
    const int arc = SHAPE_CIRCLE + 1;
    int kind = SHAPE_BOX;
    while (kind <= arc && (strlen(shape_words[kind]) != length ||
                           memcmp(shape_words[kind], r->entry->value, length) != 0))
        kind++;
    if (kind > arc)
        return bad_value(
            r,
            "`%.*s` is not a shape; known: box X0, Y0, X1, Y1; circle X, Y, R; polygon X, Y; ...; "
            "polyline thickness T: X, Y; ...; arc thickness T: X, Y, R, A, B",
            (int)(length < 40 ? length : 40), r->entry->value);
    struct shape shape = {.kind = kind == arc ? SHAPE_POLYLINE : (enum shape_kind)kind,
                          .line = r->entry->line};
    TRY(read_shape(r, slice_trimmed(slice_of(r->entry->value + length)), kind == arc, &shape));
    TRY(arena_more(&r->scene->arena, &list->item, list->n, "regions of a body", r->diag));
    list->item[list->n++] = shape;
    return ERR_OK;
}

enum err case_hinge(struct reader *r, struct hinge_list *list)
{
    struct hinge_point hinge = {.line = r->entry->line};
    struct slice rest = slice_of(r->entry->value), piece;
    const int n = slice_count(rest, ',');
    if (n != 2 && n != 3)
        return bad_value(r, "`X, Y` or `X, Y, NAME` is expected; there %s %d%s",
                         n == 1 ? "is" : "are", n, comma_hint(r->entry->value));
    for (int k = 0; k < 2 && slice_next(&rest, ',', &piece); k++)
        TRY(read_coordinate(r, piece, &hinge.at[k]));
    if (n == 3) {
        rest = slice_trimmed(rest);
        snprintf(hinge.other, sizeof hinge.other, "%.*s", (int)rest.length, rest.at);
    }
    TRY(arena_more(&r->scene->arena, &list->item, list->n, "hinges of a body", r->diag));
    list->item[list->n++] = hinge;
    return ERR_OK;
}
