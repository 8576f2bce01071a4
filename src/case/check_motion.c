/* SPDX-License-Identifier: MIT
 * Conditions on a motion: its keys fit its kind, and its expressions have values without jumps. */
#include "case/case.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A key that applies to some kinds of motion only. */
static enum err check_motion_keys(struct reader *r, const struct scene_motion *m)
{
#define KIND(kind) (1u << MOTION_##kind)
    static const struct {
        const char *key, *kinds;
        unsigned of;
    } owned[] = {
        {"velocity", "velocity", KIND(VELOCITY)},
        {"poly_x", "polynomial", KIND(POLYNOMIAL)},
        {"poly_y", "polynomial", KIND(POLYNOMIAL)},
        {"amplitude", "sine", KIND(SINE)},
        {"period", "sine and rotation", KIND(SINE) | KIND(ROTATION)},
        {"phase", "sine and rotation", KIND(SINE) | KIND(ROTATION)},
        {"centre", "rotation and expression", KIND(ROTATION) | KIND(EXPRESSION)},
        {"angle", "rotation", KIND(ROTATION)},
        {"angle_amplitude", "rotation", KIND(ROTATION)},
        {"file", "table and rotation", KIND(TABLE) | KIND(ROTATION)},
        {"x", "expression", KIND(EXPRESSION)},
        {"y", "expression", KIND(EXPRESSION)},
        {"turn", "expression", KIND(EXPRESSION)},
    };
#undef KIND
    for (size_t k = 0; k < COUNT_OF(owned); k++) {
        const struct param *const param = param_find(SECTION_motion, owned[k].key);
        if (owned[k].of & (1u << m->kind) || param_is_default(param, m)) continue;
        char name[SCENE_NAME];
        param_choice_name(param_find(SECTION_motion, "kind"), m->kind, name);
        const int index = (int)(m - r->scene->motion);
        return bad_line(
            r, scene_line(r->scene, SECTION_motion, index, owned[k].key),
            "[motion %s] `%s` belongs to kind = %s, but this motion has kind = %s; leave it out",
            m->common.name, owned[k].key, owned[k].kinds, name);
    }
    return ERR_OK;
}

enum { MOTION_TIMES = 1000 };

/* A jump would move a body without a velocity. */
static enum err check_motion_jumps(struct reader *r, const struct scene_motion *m, const char *key,
                                   const struct expr *e, double length)
{
    const int line = scene_line(r->scene, SECTION_motion, (int)(m - r->scene->motion), key);
    if (expr_steps(e))
        return bad_line(r, line,
                        "[motion %s] %s = %.200s jumps in time, because it rounds a term with t, "
                        "so the velocity is undefined; use a continuous expression",
                        m->common.name, key, expr_source(e));
    double size = 0, at;
    for (int n = 0; n <= MOTION_TIMES; n++)
        size = max2(size, 1e-6 * fabs(expr_jet_at(e, length * n / MOTION_TIMES).value));
    for (int n = 0; n < MOTION_TIMES; n++)
        if (expr_jumps(e, length * n / MOTION_TIMES, length * (n + 1) / MOTION_TIMES, size, &at))
            return bad_line(r, line,
                            "[motion %s] %s = %.200s jumps or is not finite %g s after `start`, so "
                            "the velocity is undefined; use a continuous expression",
                            m->common.name, key, expr_source(e), at);
    return ERR_OK;
}

static double motion_length(const struct reader *r, const struct scene_motion *m)
{
    return fmax(fmin(r->scene->top.end_time, m->stop) - m->start, 0);
}

/* Finite with its derivatives at the start and at a thousand times until the end. */
static enum err check_motion_finite(struct reader *r, const struct scene_motion *m,
                                    const struct expr *e)
{
    for (int n = 0; e && n <= MOTION_TIMES; n++) {
        const double t = motion_length(r, m) * n / MOTION_TIMES;
        const struct expr_jet at = expr_jet_at(e, t);
        if (!isfinite(at.value) || !isfinite(at.d1) || !isfinite(at.d2))
            return bad_line(r, m->common.line,
                            "[motion %s] %.200s: displacement, velocity or acceleration is not "
                            "finite %g s after `start`; change the expression",
                            m->common.name, expr_source(e), t);
    }
    return ERR_OK;
}

/* Finite, and no jumps in between. */
static enum err check_motion_expressions(struct reader *r, const struct scene_motion *m)
{
    const struct scene_expr *const each[] = {&m->x, &m->y, &m->turn};
    static const char *const keys[] = {"x", "y", "turn"};
    if (!m->x.e[0] && !m->y.e[0] && !m->turn.e[0])
        return bad_line(r, m->common.line,
                        "[motion %s] kind = expression needs `x`, `y` or `turn`, expressions in t",
                        m->common.name);
    for (size_t k = 0; k < COUNT_OF(each); k++) {
        TRY(check_motion_finite(r, m, each[k]->e[0]));
        if (each[k]->e[0])
            TRY(check_motion_jumps(r, m, keys[k], each[k]->e[0], motion_length(r, m)));
    }
    return ERR_OK;
}

enum err case_check_motion(struct reader *r, const struct scene_motion *m)
{
    const int line = m->common.line;
    if (!(m->start < m->stop))
        return bad_line(r, line, "[motion %s] start = %g s must come before stop = %g s",
                        m->common.name, m->start, m->stop);
    TRY(check_motion_keys(r, m));
    if (m->kind == MOTION_EXPRESSION) TRY(check_motion_expressions(r, m));
    for (int c = 0; c < 2; c++) TRY(check_motion_finite(r, m, m->velocity_in_time.e[c]));
    if (m->kind == MOTION_SINE && m->period == 0)
        return bad_line(r, line, "[motion %s] kind = sine needs `period`", m->common.name);
    if (m->kind == MOTION_ROTATION && m->angle_amplitude != 0 && m->period == 0)
        return bad_line(r, line, "[motion %s] angle_amplitude needs `period`", m->common.name);
    if (m->kind == MOTION_ROTATION && m->angle_amplitude == 0 && m->angle.n == 0 && !*m->file)
        return bad_line(r, line,
                        "[motion %s] kind = rotation needs `angle`, `angle_amplitude` or `file`",
                        m->common.name);
    if (m->kind == MOTION_TABLE && !*m->file)
        return bad_line(r, line, "[motion %s] kind = table needs `file`", m->common.name);
    if (m->kind == MOTION_POLYNOMIAL && m->poly_x.n + m->poly_y.n == 0)
        return bad_line(r, line, "[motion %s] kind = polynomial needs `poly_x` or `poly_y`",
                        m->common.name);
    return ERR_OK;
}
