/* SPDX-License-Identifier: MIT
 * Conditions on a motion: its keys fit its kind, and its expressions have values without jumps. */
#include "case/case.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static enum err check_keys(struct reader *r, const struct scene_motion *m)
{
    char kind[SCENE_NAME];
    param_choice_name(param_find(SECTION_motion, "kind"), m->kind, kind);
    for (const struct param *p = param_table; p < param_table + PARAM_COUNT; p++)
        if (p->motion_kinds && !strstr(p->motion_kinds, kind) && !param_is_default(p, m))
            return bad_section(r, m, p->key,
                               "`%s` belongs to kind = %s, but this motion has kind = %s; leave it "
                               "out",
                               p->key, p->motion_kinds, kind);
    return ERR_OK;
}

/* What a motion of its kind cannot do without, or NULL. */
static const char *lacking(const struct scene_motion *m)
{
    const bool turns = m->angle_amplitude != 0;
    switch ((enum motion_kind)m->kind) {
    case MOTION_SINE: return m->period == 0 ? "kind = sine needs `period`" : NULL;
    case MOTION_ROTATION:
        if (turns && m->period == 0) return "angle_amplitude needs `period`";
        return turns || m->angle.n || *m->file
                   ? NULL
                   : "kind = rotation needs `angle`, `angle_amplitude` or `file`";
    case MOTION_TABLE: return *m->file ? NULL : "kind = table needs `file`";
    case MOTION_POLYNOMIAL:
        return m->poly_x.n + m->poly_y.n ? NULL : "kind = polynomial needs `poly_x` or `poly_y`";
    case MOTION_EXPRESSION:
        return m->x.e[0] || m->y.e[0] || m->turn.e[0]
                   ? NULL
                   : "kind = expression needs `x`, `y` or `turn`, expressions in t";
    case MOTION_VELOCITY: break;
    }
    return NULL;
}

enum { TIMES = 1000 }; /* looked at, from the start to the end */

/* Finite with its derivatives. */
static enum err check_finite(struct reader *r, const struct scene_motion *m, const struct expr *e,
                             double length)
{
    for (int n = 0; n <= TIMES; n++) {
        const struct expr_jet at = expr_jet_at(e, length * n / TIMES);
        if (!isfinite(at.value) || !isfinite(at.d1) || !isfinite(at.d2))
            return bad_section(r, m, NULL,
                               "%.200s: displacement, velocity or acceleration is not finite %g s "
                               "after `start`; change the expression",
                               expr_source(e), length * n / TIMES);
    }
    return ERR_OK;
}

/* A jump would move a body without a velocity. */
static enum err check_jumps(struct reader *r, const struct scene_motion *m, const char *key,
                            const struct expr *e, double length)
{
    if (expr_steps(e))
        return bad_section(r, m, key,
                           "%s = %.200s jumps in time, because it rounds a term with t, so the "
                           "velocity is undefined; use a continuous expression",
                           key, expr_source(e));
    double size = 0, at;
    for (int n = 0; n <= TIMES; n++)
        size = max2(size, 1e-6 * fabs(expr_jet_at(e, length * n / TIMES).value));
    for (int n = 0; n < TIMES; n++)
        if (expr_jumps(e, length * n / TIMES, length * (n + 1) / TIMES, size, &at))
            return bad_section(r, m, key,
                               "%s = %.200s jumps or is not finite %g s after `start`, so the "
                               "velocity is undefined; use a continuous expression",
                               key, expr_source(e), at);
    return ERR_OK;
}

enum err case_check_motion(struct reader *r, const void *section)
{
    const struct scene_motion *const m = section;
    const struct expr *const each[] = {m->x.e[0], m->y.e[0], m->turn.e[0], m->velocity_in_time.e[0],
                                       m->velocity_in_time.e[1]};
    static const char *const keys[] = {"x", "y", "turn"};
    const double length = fmax(fmin(r->scene->top.end_time, m->stop) - m->start, 0);
    if (!(m->start < m->stop))
        return bad_section(r, m, NULL, "start = %g s must come before stop = %g s", m->start,
                           m->stop);
    TRY(check_keys(r, m));
    if (lacking(m)) return bad_section(r, m, NULL, "%s", lacking(m));
    for (size_t k = 0; k < COUNT_OF(each); k++) {
        if (each[k]) TRY(check_finite(r, m, each[k], length));
        if (each[k] && k < COUNT_OF(keys)) TRY(check_jumps(r, m, keys[k], each[k], length));
    }
    return ERR_OK;
}
