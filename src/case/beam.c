/* SPDX-License-Identifier: MIT
 * Conditions on a [beam] section: one line, stiffness and mass from one source each, supports. */
#include "case/case.h"
#include "base/elementary.h"

static enum err check_line(struct reader *r, const struct scene_beam *beam)
{
    if (beam->shape.n > 1)
        return bad_line(r, beam->shape.item[1].line,
                        "[beam %s] has a second `shape`; a beam is one line, so give each a "
                        "section of its own",
                        beam->common.name);
    if (beam->shape.n == 1 && !beam->shape.item[0].bare)
        return bad_line(r, beam->shape.item[0].line,
                        "[beam %s] shape: a beam is a line in the middle of its thickness; write "
                        "`polyline: X, Y; X, Y` or `arc: X, Y, R, A, B`, and the thickness as a "
                        "key of its own",
                        beam->common.name);
    return ERR_OK;
}

/* A line longer than it is thick, in elements that a run can bear. */
static enum err check_extent(struct reader *r, const struct scene_beam *beam)
{
    enum { ELEMENTS = 10000 }; /* pairs of them are compared in each step */
    const struct shape *const line = beam->shape.item;
    double length = 0, parts = 0;
    for (int i = 0; i + 1 < line->n; i++) {
        const double *const a = line->pt[i], *const b = line->pt[i + 1];
        length += elementary_hypot(b[0] - a[0], b[1] - a[1]);
        parts += scene_beam_parts(r->scene, beam, a, b);
    }
    if (beam->thickness > length)
        return bad_section(r,
                           "has a `thickness` of %g m and is %g m long; a body that is thicker "
                           "than long is a [solid]",
                           beam->thickness, length);
    if (parts > ELEMENTS)
        return bad_section(r,
                           "has %.0f elements; at most %d are possible: set `element` to %.2g m "
                           "or more",
                           parts, ELEMENTS, 1.01 * length / ELEMENTS);
    return ERR_OK;
}

/* Each from the material and the thickness, or given. */
static enum err check_values(struct reader *r, const struct scene_beam *beam)
{
    const bool thick = !isnan(beam->thickness);
    if (isnan(beam->density) == isnan(beam->mass))
        return bad_section(r, isnan(beam->mass) ? "has no mass: it needs `density` or `mass`"
                                                : "has both `density` and `mass`; leave one out");
    if (!thick && !(isnan(beam->density) && isnan(beam->young)))
        return bad_section(r, "lacks `thickness`, which it needs with `%s`",
                           isnan(beam->young) ? "density" : "young");
    if (isnan(beam->young) && (isnan(beam->bending_stiffness) || isnan(beam->axial_stiffness)))
        return bad_section(r,
                           "lacks `%s`: it needs `young` and `thickness`, or both "
                           "`bending_stiffness` and `axial_stiffness`",
                           isnan(beam->bending_stiffness) ? "bending_stiffness"
                                                          : "axial_stiffness");
    return ERR_OK;
}

bool case_may_hold(const struct scene *scene, const struct scene_section_common *held, int walls,
                   const char *name, struct nearest *near)
{
    for (int k = 0; k < walls; k++) {
        const char *const other = scene->wall[k].common.name;
        if (strcmp(other, held->name) == 0) continue;
        if (strcmp(other, name) == 0) return true;
        nearest_offer(near, name, other);
    }
    return false;
}

static enum err check_supports(struct reader *r, const struct scene_beam *beam,
                               const struct hinge_list *list, const char *key)
{
    for (int k = 0; k < list->n; k++) {
        const char *const other = list->item[k].other;
        struct nearest near = {0};
        if (!*other || case_may_hold(r->scene, &beam->common, r->scene->n_wall, other, &near))
            continue;
        return bad_line(r, list->item[k].line,
                        "[beam %s] %s: %s is no [wall], [rigid] or other [beam], which may hold a "
                        "beam%s",
                        beam->common.name, key, other, nearest_hint(&near));
    }
    return ERR_OK;
}

enum err case_draw_beam(struct reader *r, int k)
{
    struct scene *const scene = r->scene;
    const struct scene_beam *const beam = &scene->beam[k];
    struct scene_wall *const wall = &scene->wall[scene_beam_wall(scene, k)];
    const struct shape *const from = beam->shape.item;
    struct shape *to;
    int n = 0;
    for (int s = 0; s + 1 < from->n; s++)
        n += scene_beam_parts(scene, beam, from->pt[s], from->pt[s + 1]);
    double(*pt)[2];
    TRY(arena_array(&scene->arena, &to, 1, "beams", r->diag));
    TRY(arena_array(&scene->arena, &pt, n + 1, "beams", r->diag));
    *to = (struct shape){.kind = SHAPE_POLYLINE, .pt = pt, .thin = true, .line = from->line};
    for (int s = 0; s + 1 < from->n; s++) {
        const double *const a = from->pt[s], *const b = from->pt[s + 1];
        const int parts = scene_beam_parts(scene, beam, a, b);
        for (int j = s > 0; j <= parts; j++, to->n++)
            for (int c = 0; c < 2; c++) pt[to->n][c] = a[c] + (b[c] - a[c]) * j / parts;
    }
    wall->shape = (struct shape_list){1, to};
    return ERR_OK;
}

/* Whether a support has no other section that moves it. */
static bool has_own(const struct hinge_list *list)
{
    for (int k = 0; k < list->n; k++)
        if (!*list->item[k].other) return true;
    return false;
}

enum err case_check_beam(struct reader *r, const void *section)
{
    const struct scene_beam *const beam = section;
    if (*beam->motion && !has_own(&beam->clamp) && !has_own(&beam->hinge))
        return bad_section(r, "has a `motion`, but neither `clamp` nor `hinge` for it to move; add "
                              "one without NAME");
    if (r->scene->n_fluid && r->scene->numerics.sides == SIDES_ONE)
        return bad_section(r, "would gain energy in fluid with numerics.sides = one; use sides = "
                              "both: each side of a beam has dummies of its own");
    TRY(check_line(r, beam));
    if (beam->shape.n) TRY(check_extent(r, beam));
    TRY(check_values(r, beam));
    TRY(check_supports(r, beam, &beam->clamp, "clamp"));
    return check_supports(r, beam, &beam->hinge, "hinge");
}
