/* SPDX-License-Identifier: MIT
 * What hinges and guides leave free, the rows of the equations of motion, and springs. */
#include "rigid/forces.h"
#include "base/cholesky.h"
#include "geometry/motion.h"

/* --- hinges and guides --- */

/* T-99: velocities that a body may have: `base` and any sum of the `n` columns of B. */
struct freedom {
    int n;
    double B[3][3], base[3];
};

/* The point of a hinge: position and velocity at a time. */
static struct motion_point hinge_at(const struct rigid *rigid, const struct rigid_body *body,
                                    double time)
{
    const double *const at = body->fixed->at;
    const struct motion_state m = motion_at(rigid->scene, body->hinge_motion, time);
    return motion_of_point(&m, at[0], at[1]);
}

void rigid_arm(const struct rigid *rigid, int k, const double at[2], double angle, double arm[2])
{
    const double *const centre = rigid->body[k].centre;
    const double x = at[0] - centre[0], y = at[1] - centre[1];
    const double c = elementary_cos(angle), s = elementary_sin(angle);
    arm[0] = c * x - s * y;
    arm[1] = s * x + c * y;
}

struct motion_state rigid_placed(const struct rigid *rigid, int k, const double x[3])
{
    const double *const centre = rigid->body[k].centre;
    return (struct motion_state){.d = {x[0], x[1]},
                                 .centre = {centre[0], centre[1]},
                                 .angle = x[2],
                                 .turn = {elementary_cos(x[2]), elementary_sin(x[2])}};
}

static struct freedom freedom_of(const struct rigid *rigid, int k, double time)
{
    const struct rigid_body *const body = &rigid->body[k];
    const double *const along = body->given->guide, size = elementary_hypot(along[0], along[1]);
    struct freedom f = {.n = 0};
    if (body->fixed) {
        const struct motion_point at = hinge_at(rigid, body, time);
        double arm[2];
        rigid_arm(rigid, k, body->fixed->at, rigid->state[k].x[2], arm);
        f.B[0][0] = arm[1], f.B[1][0] = -arm[0], f.B[2][0] = 1;
        memcpy(f.base, at.v, sizeof at.v);
        f.n = 1;
        return f;
    }
    if (size > 0) {
        f.B[0][0] = along[0] / size, f.B[1][0] = along[1] / size;
        f.n = 1;
    } else {
        f.B[0][0] = f.B[1][1] = 1;
        f.n = 2;
    }
    if (body->given->turns) f.B[2][f.n++] = 1;
    return f;
}

void rigid_follow_hinge(const struct rigid *rigid, int k, double time, double x[3])
{
    const struct rigid_body *const body = &rigid->body[k];
    const struct motion_point at = hinge_at(rigid, body, time);
    double arm[2];
    rigid_arm(rigid, k, body->fixed->at, x[2], arm);
    for (int c = 0; c < 2; c++) x[c] = at.x[c] - arm[c] - body->centre[c];
}

void rigid_hold(struct rigid *rigid, int k, double place, double speed)
{
    const struct rigid_body *const body = &rigid->body[k];
    struct rigid_state *const s = &rigid->state[k];
    const struct freedom f = freedom_of(rigid, k, speed);
    double v[3];
    if (body->fixed) {
        rigid_follow_hinge(rigid, k, place, s->x);
        for (int c = 0; c < 3; c++) v[c] = f.base[c] + f.B[c][0] * s->v[2];
    } else if (f.n == 3) {
        return;
    } else {
        /* Columns of B are orthonormal. */
        for (int c = 0; c < 3; c++) {
            v[c] = 0;
            for (int j = 0; j < f.n; j++)
                for (int e = 0; e < 3; e++) v[c] += f.B[c][j] * f.B[e][j] * s->v[e];
        }
    }
    memcpy(s->v, v, sizeof v);
}

/* The change of velocity by a unit of each impulse: B S^-1 B^T. */
static void find_mobility(const struct freedom *f, double A[3][3], double mobility[3][3])
{
    double S[3][3] = {{0}};
    for (int i = 0; i < f->n; i++)
        for (int j = 0; j < f->n; j++)
            for (int c = 0; c < 3; c++)
                for (int e = 0; e < 3; e++) S[i][j] += f->B[c][i] * A[c][e] * f->B[e][j];
    for (int c = 0; c < 3; c++) {
        double M[3][3], q[3];
        memcpy(M, S, sizeof M);
        for (int i = 0; i < f->n; i++) q[i] = f->B[c][i];
        (void)cholesky_solve(M[0], f->n, 3, 0, q); /* positive, as masses and impedances are */
        for (int e = 0; e < 3; e++) {
            mobility[e][c] = 0;
            for (int i = 0; i < f->n; i++) mobility[e][c] += f->B[e][i] * q[i];
        }
    }
}

void rigid_find_mobility_dry(struct rigid *rigid, int k, double time)
{
    const double *const mass = rigid->body[k].mass;
    const struct freedom f = freedom_of(rigid, k, time);
    double dry_mass[3][3] = {{mass[0]}, {0, mass[1]}, {0, 0, mass[2]}};
    find_mobility(&f, dry_mass, rigid->eq[k].mobility_dry);
}

void rigid_solve(struct rigid *rigid, int k, double end, double rates_time)
{
    struct rigid_equations *const eq = &rigid->eq[k];
    const struct rigid_body *const body = &rigid->body[k];
    const struct rigid_state *const s = &rigid->state[k];
    const struct freedom f = freedom_of(rigid, k, end);
    double A[3][3], right[3], S[3][3] = {{0}}, q[3];
    for (int c = 0; c < 3; c++) {
        right[c] = eq->impulse[c] - rates_time * body->mass[c] * s->a[c];
        for (int e = 0; e < 3; e++) {
            A[c][e] = eq->resisting[c][e] + (c == e ? body->mass[c] : 0);
            right[c] += A[c][e] * (s->v[e] + rates_time * s->a[e] - f.base[e]);
        }
    }
    for (int i = 0; i < f.n; i++) {
        q[i] = 0;
        for (int c = 0; c < 3; c++) {
            q[i] += f.B[c][i] * right[c];
            for (int e = 0; e < 3; e++)
                for (int j = 0; j < f.n; j++) S[i][j] += f.B[c][i] * A[c][e] * f.B[e][j];
        }
    }
    find_mobility(&f, A, eq->mobility);
    rigid_find_mobility_dry(rigid, k, end);
    if (f.n) (void)cholesky_solve(S[0], f.n, 3, 0, q);
    for (int c = 0; c < 3; c++) {
        eq->change[c] = f.base[c] - s->v[c];
        for (int j = 0; j < f.n; j++) eq->change[c] += f.B[c][j] * q[j];
        eq->excess[c] = eq->change[c] - rates_time * s->a[c];
    }
}

void rigid_find_reaction(struct rigid *rigid, int k, double rates_time)
{
    const struct rigid_body *const body = &rigid->body[k];
    const struct rigid_equations *const eq = &rigid->eq[k];
    const double *const along = body->given->guide;
    const bool free = !body->given->hinge.n && along[0] == 0 && along[1] == 0 && body->given->turns;
    for (int c = 0; c < 3; c++) {
        double needed = body->mass[c] * eq->change[c] - eq->impulse[c];
        for (int e = 0; e < 3; e++) needed += eq->resisting[c][e] * eq->excess[e];
        rigid->state[k].reaction[c] = free ? 0 : needed / rates_time;
    }
}

/* --- rows --- */

struct rigid_row *rigid_add_row(struct rigid *rigid, enum rigid_law law, const int body[2])
{
    struct rigid_row *const row = &rigid->row[rigid->n_rows++];
    *row = (struct rigid_row){.law = law, .body = {body[0], body[1]}};
    return row;
}

/* An impact is over before the fluid resists. */
static const double (*mobility_in(const struct rigid_equations *eq, enum rigid_stage stage))[3]
{
    return stage == RIGID_IMPACT ? eq->mobility_dry : eq->mobility;
}

void rigid_row_along(struct rigid_row *row, int side, const double arm[2], const double e[2])
{
    const double sign = side ? -1 : 1;
    row->along[side][0] = sign * e[0];
    row->along[side][1] = sign * e[1];
    row->along[side][2] = sign * (arm[0] * e[1] - arm[1] * e[0]);
}

double rigid_row_change(const struct rigid *rigid, const struct rigid_row *row,
                        enum rigid_stage stage)
{
    double rate = 0;
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < 3 && row->body[side] >= 0; c++)
            rate += row->along[side][c] * rigid->eq[row->body[side]].touch[stage][c];
    return rate;
}

double rigid_row_rate(const struct rigid *rigid, const struct rigid_row *row,
                      enum rigid_stage stage)
{
    double rate = 0;
    for (int side = 0; side < 2; side++) {
        if (row->body[side] < 0) continue;
        const struct rigid_equations *const eq = &rigid->eq[row->body[side]];
        for (int c = 0; c < 3; c++) {
            const double impact = eq->before[c] + (stage == RIGID_STEP ? eq->touch[0][c] : 0);
            const double start =
                stage == RIGID_PUSH ? 0 : impact + (stage == RIGID_STEP ? eq->change[c] : 0);
            rate += row->along[side][c] * (start + eq->touch[stage][c]);
        }
    }
    return rate;
}

double rigid_row_mobility(const struct rigid *rigid, const struct rigid_row *row,
                          enum rigid_stage stage)
{
    double sum = 0;
    for (int side = 0; side < 2; side++) {
        if (row->body[side] < 0) continue;
        const double(*const mobility)[3] = mobility_in(&rigid->eq[row->body[side]], stage);
        for (int c = 0; c < 3; c++)
            for (int e = 0; e < 3; e++)
                sum += row->along[side][c] * mobility[c][e] * row->along[side][e];
    }
    return sum;
}

void rigid_row_push(struct rigid *rigid, const struct rigid_row *row, enum rigid_stage stage,
                    double impulse)
{
    for (int side = 0; side < 2; side++) {
        if (row->body[side] < 0) continue;
        struct rigid_equations *const eq = &rigid->eq[row->body[side]];
        const double(*const mobility)[3] = mobility_in(eq, stage);
        for (int c = 0; c < 3; c++)
            for (int e = 0; e < 3; e++)
                eq->touch[stage][c] += mobility[c][e] * row->along[side][e] * impulse;
    }
}

double rigid_displacement(const struct rigid *rigid, int k, int c, double lag)
{
    const struct rigid_equations *const eq = &rigid->eq[k];
    const double v =
        eq->before[c] + eq->change[c] + eq->touch[RIGID_IMPACT][c] + eq->touch[RIGID_STEP][c];
    return lag * (v - eq->push_change[c]) + rigid->body[k].moved[c];
}

/* --- springs --- */

int rigid_find(const struct scene *scene, const char *name)
{
    const int k = *name ? scene_find(scene, SECTION_wall, name) - scene_rigid_wall(scene, 0) : -1;
    return k >= 0 && k < scene->n_rigid ? k : -1;
}

enum err rigid_springs_create(struct rigid *rigid, struct arena *a, struct diag *d)
{
    const struct scene *const scene = rigid->scene;
    rigid->n_springs = scene->n_spring;
    TRY(arena_array(a, &rigid->spring, rigid->n_springs, "springs", d));
    for (int k = 0; k < rigid->n_springs; k++) {
        const struct scene_spring *const given = &scene->spring[k];
        const double start =
            elementary_hypot(given->to[0] - given->from[0], given->to[1] - given->from[1]);
        rigid->spring[k] =
            (struct rigid_spring){.given = given,
                                  .body = {rigid_find(scene, given->body),
                                           rigid_find(scene, given->other)},
                                  .length = isnan(given->length) ? start : given->length};
    }
    return ERR_OK;
}

/* An end of a spring: where it is, its velocity, and its arm from the centre of mass. */
struct spring_end {
    double x[2], v[2], arm[2];
};

static struct spring_end end_at(const struct rigid *rigid, const struct rigid_spring *spring,
                                int end)
{
    const double *const at = end ? spring->given->to : spring->given->from;
    const int k = spring->body[end];
    struct spring_end e = {.x = {at[0], at[1]}};
    if (k < 0) return e;
    const struct rigid_state *const s = &rigid->state[k];
    rigid_arm(rigid, k, at, s->x[2], e.arm);
    for (int m = 0; m < 2; m++) {
        e.x[m] = rigid->body[k].centre[m] + s->x[m] + e.arm[m];
        e.v[m] = s->v[m] + (m ? e.arm[0] : -e.arm[1]) * s->v[2];
    }
    return e;
}

/* A spring now: its ends, the direction between them, its elongation and the rate of that. */
struct spring_now {
    struct spring_end end[2];
    double along[2], elongation, rate, tension;
};

/* T-100. A damper in a line that only pulls does not push. */
static struct spring_now spring_now(const struct rigid *rigid, const struct rigid_spring *spring)
{
    struct spring_now now = {.end = {end_at(rigid, spring, 0), end_at(rigid, spring, 1)}};
    const double *const a = now.end[0].x, *const b = now.end[1].x;
    const double length = max2(elementary_hypot(b[0] - a[0], b[1] - a[1]), 1e-300);
    double rate = 0;
    for (int c = 0; c < 2; c++) {
        now.along[c] = (b[c] - a[c]) / length;
        rate += now.along[c] * (now.end[1].v[c] - now.end[0].v[c]);
    }
    now.elongation = length - spring->length;
    now.rate = rate;
    now.tension = spring_force(spring->given, now.elongation) + spring->given->damping * rate;
    if (spring->given->slack && (now.elongation <= 0 || now.tension <= 0)) now.tension = 0;
    return now;
}

void rigid_add_springs(struct rigid *rigid, double dt)
{
    for (int k = 0; k < rigid->n_springs; k++) {
        struct rigid_spring *const spring = &rigid->spring[k];
        const struct spring_now now = spring_now(rigid, spring);
        const bool law = spring->given->force.e[0] && !spring->given->slack;
        const double half = law ? 0.5 * dt * now.rate : 0; /* T-100a */
        spring->elongation = now.elongation + fabs(half);
        if (spring->body[0] < 0 || (spring->given->slack && now.elongation <= 0)) continue;
        struct rigid_row *const row = rigid_add_row(rigid, RIGID_SPRING, spring->body);
        row->stiffness = max2(spring_slope(spring->given, now.elongation), 0);
        row->damping = spring->given->damping;
        const double shortest = -spring->length; /* both ends are in one place */
        row->force = -spring_mean(spring->given, max2(now.elongation - half, shortest),
                                  max2(now.elongation + half, shortest), 1);
        row->theta = spring->body[1] < 0 ? 0.25 : 0;
        row->pulls_only = spring->given->slack;
        for (int end = 0; end < 2; end++) rigid_row_along(row, end, now.end[end].arm, now.along);
    }
}

void rigid_spring_force(const struct rigid *rigid, int spring, double force[2], double at[2])
{
    const struct spring_now now = spring_now(rigid, &rigid->spring[spring]);
    for (int c = 0; c < 2; c++) {
        force[c] = -now.tension * now.along[c];
        at[c] = now.end[1].x[c];
    }
}

void rigid_add_spring_energy(const struct rigid *rigid, int k, struct body_energy *sum)
{
    for (int j = 0; j < rigid->n_springs; j++) {
        if (rigid->spring[j].body[0] != k) continue;
        const struct spring_now now = spring_now(rigid, &rigid->spring[j]);
        const bool slack = rigid->spring[j].given->slack && now.elongation <= 0;
        if (!slack) spring_add_energy(rigid->spring[j].given, now.elongation, sum);
    }
}

double rigid_hinge_power(const struct rigid *rigid, int k, double dt)
{
    const struct rigid_body *const body = &rigid->body[k];
    const double *const reaction = rigid->state[k].reaction;
    if (body->hinge_motion < 0) return 0;
    const struct motion_point from = hinge_at(rigid, body, rigid->end - dt),
                              to = hinge_at(rigid, body, rigid->end);
    return 0.5 * (reaction[0] * (from.v[0] + to.v[0]) + reaction[1] * (from.v[1] + to.v[1]));
}

/* What a unit of a force on an end of a spring does to it at most, 1/kg. */
static double end_mobility(const struct rigid *rigid, const struct rigid_spring *spring, int end)
{
    if (spring->body[end] < 0) return 0;
    const double *const mass = rigid->body[spring->body[end]].mass;
    const struct spring_end at = end_at(rigid, spring, end);
    return 1 / mass[0] + (square(at.arm[0]) + square(at.arm[1])) / mass[2];
}

/* The larger slope of a spring's force now and after such a step, if that is finite. */
static double stiffness_in(const struct rigid *rigid, const struct rigid_spring *spring, double dt)
{
    if (!spring->given->force.e[0]) return spring->given->stiffness;
    const struct spring_now now = spring_now(rigid, spring);
    const double slope = spring_slope(spring->given, now.elongation + dt * now.rate);
    return max2(max2(spring_slope(spring->given, now.elongation), 0), isfinite(slope) ? slope : 0);
}

double rigid_spring_rates(const struct rigid *rigid, double dt, double *damping)
{
    double omega2 = 0;
    *damping = 0;
    for (int j = 0; j < rigid->n_springs; j++) {
        const struct rigid_spring *const spring = &rigid->spring[j];
        if (spring->body[1] < 0) continue;
        const double both = end_mobility(rigid, spring, 0) + end_mobility(rigid, spring, 1);
        omega2 += stiffness_in(rigid, spring, dt) * both;
        *damping += spring->given->damping * both;
    }
    return omega2;
}

/* Step for oscillations without fluid and solids, s: a part of their time scale. */
static double part_of_time(double rate2) { return 1e-3 / sqrt(rate2); }

double rigid_spring_step(const struct rigid *rigid, double dt, bool laws_only, int *stiffest)
{
    double rate2 = 0;
    *stiffest = 0;
    for (int j = 0; j < rigid->n_springs; j++) {
        const struct rigid_spring *const spring = &rigid->spring[j];
        for (int end = 0; end < 2 && (spring->given->force.e[0] || !laws_only); end++) {
            const double own =
                2 * stiffness_in(rigid, spring, dt) * end_mobility(rigid, spring, end);
            if (own > rate2) *stiffest = j + 1;
            rate2 = max2(rate2, own);
        }
    }
    return part_of_time(rate2);
}

double rigid_longest_step(const struct rigid *rigid, int *stiffest)
{
    const double *const g = rigid->scene->top.gravity;
    double rate2 = 1; /* for bodies that nothing moves */
    for (int k = 0; k < rigid->n; k++) {
        const struct rigid_body *const body = &rigid->body[k];
        const double *const v = rigid->state[k].v, r2 = body->mass[2] / body->mass[0];
        rate2 = max2(rate2, elementary_hypot(g[0], g[1]) / sqrt(r2));
        rate2 = max2(rate2, (square(v[0]) + square(v[1])) / r2 + square(v[2]));
        rate2 = max2(rate2, body->given->hinge_stiffness / body->mass[2]);
    }
    const double own = part_of_time(rate2), springs = rigid_spring_step(rigid, 0, false, stiffest);
    if (springs > own) *stiffest = 0;
    return min2(own, springs);
}
