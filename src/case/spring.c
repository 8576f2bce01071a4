/* SPDX-License-Identifier: MIT
 * The elastic force of a spring (T-100), and checks of a [spring]. */
#include "base/elementary.h"
#include "case/case.h"

double spring_force(const struct scene_spring *spring, double e)
{
    const struct expr *const law = spring->force.e[0];
    return law ? expr_at_arg(law, e) : spring->stiffness * e;
}

double spring_slope(const struct scene_spring *spring, double e)
{
    const struct expr *const law = spring->force.e[0];
    return law ? expr_jet_at(law, e).d1 : spring->stiffness;
}

void spring_add_energy(const struct scene_spring *spring, double e, struct body_energy *sum)
{
    const struct expr *const law = spring->force.e[0];
    if (law)
        sum->potential += expr_integral(law, 0, e);
    else
        sum->elastic += 0.5 * spring->stiffness * square(e);
}

double spring_mean(const struct scene_spring *spring, double from, double to, double taut)
{
    const struct expr *const law = spring->force.e[0];
    if (!law) return 0.5 * taut * spring->stiffness * (from + to);
    return taut * (from == to ? expr_at_arg(law, to) : expr_integral(law, from, to) / (to - from));
}

bool spring_is_finite(const struct scene_spring *spring, double e)
{
    return isfinite(spring_force(spring, e)) && isfinite(spring_slope(spring, e));
}

/* Finite at elongations up to its length and that of the start; no push if it only pulls. */
static enum err check_force(struct reader *r, const struct scene_spring *spring)
{
    enum { PARTS = 1000 };
    const double start =
        elementary_hypot(spring->to[0] - spring->from[0], spring->to[1] - spring->from[1]);
    const double length = spring->length >= 0 ? spring->length : start;
    const double most = max2(length, start - length);
    for (int k = -PARTS; k <= PARTS; k++) {
        const double e = (k < 0 ? length : most) * k / PARTS, force = spring_force(spring, e);
        if (!spring_is_finite(spring, e))
            return bad_key(r, "force", NULL,
                           "force = %.200s is not finite, or its slope is not, at e = %g m; "
                           "change the expression",
                           expr_source(spring->force.e[0]), e);
        if (spring->slack && k > 0 && force < 0)
            return bad_key(r, "force", NULL,
                           "force = %.200s is %g N/m at e = %g m, but slack = on lets the spring "
                           "only pull; change one of them",
                           expr_source(spring->force.e[0]), force, e);
    }
    return ERR_OK;
}

enum err case_check_spring(struct reader *r, const void *section)
{
    const struct scene_spring *const spring = section;
    const bool law = spring->force.e[0] != NULL;
    if (!law && spring->stiffness == 0 && spring->damping == 0)
        return bad_section(r, "needs `stiffness`, `force` or `damping`");
    if (law && spring->stiffness > 0)
        return bad_section(r, "has both `stiffness` and `force`; leave one out");
    /* Names that are missing or unknown are reported as such. */
    const bool joins = scene_find(r->scene, SECTION_rigid, spring->other) >= 0;
    if (joins && scene_find(r->scene, SECTION_beam, spring->body) >= 0)
        return bad_section(r,
                           "joins [beam %s] to [rigid %s]; the other end of a beam's spring is a "
                           "fixed point: leave `other` out, or join both by `hinge`",
                           spring->body, spring->other);
    if (joins && strcmp(spring->body, spring->other) == 0)
        return bad_section(r, "joins [rigid %s] to itself; name another body, or none",
                           spring->body);
    if (spring->from[0] == spring->to[0] && spring->from[1] == spring->to[1])
        return bad_section(r, "has no direction, because `from` and `to` are the same point");
    return law ? check_force(r, spring) : ERR_OK;
}
