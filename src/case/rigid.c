/* SPDX-License-Identifier: MIT
 * A [rigid] section is a wall and a motion of the same name, the last of their kinds but for beams:
 * all that knows moving walls knows rigid bodies. A [beam] section is a wall. */
#include "case/case.h"

int case_given_count(const struct scene *scene, enum section_id id)
{
    const int added = id == SECTION_wall     ? scene->n_rigid + scene->n_beam
                      : id == SECTION_motion ? scene->n_rigid
                                             : 0;
    return section_count(scene, id) - added;
}

/* A name that another body has would be that of both. */
static enum err check_own_name(struct reader *r, const struct scene_section_common *common)
{
    static const enum section_id kinds[] = {SECTION_wall, SECTION_motion, SECTION_solid,
                                            SECTION_rigid};
    const size_t n_kinds = common->section == SECTION_rigid ? COUNT_OF(kinds) - 1 : COUNT_OF(kinds);
    for (size_t n = 0; n < n_kinds; n++)
        for (int k = 0; k < case_given_count(r->scene, kinds[n]); k++) {
            const struct scene_section_common *const other = section_at(r->scene, kinds[n], k);
            if (strcmp(other->name, common->name) == 0)
                return bad_section(r, "has the name of %s; rename one of them",
                                   section_title(other).text);
        }
    return ERR_OK;
}

enum err case_place_bodies(struct reader *r)
{
    struct scene *const scene = r->scene;
    TRY(arena_array(&scene->arena, &scene->rigid_motion, scene->n_rigid, "rigid bodies", r->diag));
    TRY(arena_array(&scene->arena, &scene->rigid_mass, scene->n_rigid, "rigid bodies", r->diag));
    if (scene->n_wall > SCENE_MAX_SECTIONS || scene->n_motion > SCENE_MAX_SECTIONS)
        return bad_line(r,
                        scene->n_rigid ? scene->rigid[0].common.line : scene->beam[0].common.line,
                        "more than %d [wall], [rigid] and [beam], or [motion] and [rigid] sections "
                        "are given; merge some of them",
                        SCENE_MAX_SECTIONS);
    for (int k = 0; k < scene->n_rigid; k++) {
        const struct scene_rigid *const from = &scene->rigid[k];
        struct scene_wall *const wall = &scene->wall[scene_rigid_wall(scene, k)];
        struct scene_motion *const motion = &scene->motion[scene_rigid_motion(scene, k)];
        r->section = from;
        TRY(case_go_on(r, check_own_name(r, &from->common)));
        wall->common = motion->common = from->common;
        wall->shape = from->shape;
        wall->minus = from->minus;
        wall->slip = from->slip;
        snprintf(wall->motion, sizeof wall->motion, "%s", from->common.name);
    }
    for (int k = 0; k < scene->n_beam; k++) {
        struct scene_wall *const wall = &scene->wall[scene_beam_wall(scene, k)];
        r->section = &scene->beam[k];
        TRY(case_go_on(r, check_own_name(r, &scene->beam[k].common)));
        wall->common = scene->beam[k].common;
        wall->slip = scene->beam[k].slip;
        if (scene->n_fluid && scene->beam[k].shape.n) TRY(case_draw_beam(r, k));
    }
    return ERR_OK;
}

/* Each hinge is in place, on a wall or on another rigid body. */
static enum err check_hinges(struct reader *r, const struct scene_rigid *rigid)
{
    const int walls = scene_rigid_wall(r->scene, 0);
    int fixed = 0;
    for (int k = 0; k < rigid->hinge.n; k++) {
        const struct hinge_point *const hinge = &rigid->hinge.item[k];
        const int wall = scene_find(r->scene, SECTION_wall, hinge->other);
        struct nearest near = {0};
        if (*hinge->other && !case_may_hold(r->scene, &rigid->common, walls + r->scene->n_rigid,
                                            hinge->other, &near))
            return bad_line(r, hinge->line,
                            "[rigid %s] hinge: %s is no [wall] and no other [rigid]%s",
                            rigid->common.name, hinge->other, nearest_hint(&near));
        fixed += wall < walls || !*hinge->other;
        if (fixed > 1)
            return bad_line(
                r, hinge->line,
                "[rigid %s] has a second `hinge` to a fixed point or a [wall], which would "
                "hold it still; leave it out",
                rigid->common.name);
    }
    return ERR_OK;
}

static enum err check_hinge(struct reader *r, const struct scene_rigid *rigid)
{
    const double moments = rigid->hinge_stiffness + rigid->hinge_damping + rigid->hinge_friction;
    const bool guided = rigid->guide[0] != 0 || rigid->guide[1] != 0;
    if (rigid->hinge.n == 0)
        return moments > 0 || *rigid->hinge_motion
                   ? bad_section(r, "gives stiffness, damping, friction or motion of a hinge, but "
                                    "no `hinge`")
                   : ERR_OK;
    if (guided || !rigid->turns)
        return bad_section(r, "has both `hinge` and `%s`; leave one out",
                           guided ? "guide" : "turns = off");
    const int driven = scene_find(r->scene, SECTION_motion, rigid->hinge_motion);
    if (*rigid->hinge_motion && rigid->hinge.n > 1)
        return bad_section(r,
                           "has a `hinge_motion` and %d hinges; keep one, and give the others "
                           "to the other bodies",
                           rigid->hinge.n);
    if (driven >= 0 && !r->scene->motion[driven].turn.e[0])
        return bad_section(r, "has the `hinge_motion` %s, which has no angle; give it `turn`",
                           rigid->hinge_motion);
    if (*rigid->hinge_motion && moments > 0)
        return bad_section(r, "has a `hinge_motion`, which gives the angle, and a stiffness, "
                              "damping or friction of the hinge; leave one out");
    return check_hinges(r, rigid);
}

enum err case_check_rigid(struct reader *r, const void *section)
{
    const struct scene_rigid *const rigid = section;
    if (isnan(rigid->density) == isnan(rigid->mass))
        return bad_section(r, isnan(rigid->mass) ? "needs `density` or `mass`"
                                                 : "has both `density` and `mass`; leave one out");
    return check_hinge(r, rigid);
}
