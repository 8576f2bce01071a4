/* SPDX-License-Identifier: MIT
 * The impulses of a step between rigid bodies, walls and places: of contact (T-102), hinges (T-99a)
 * and springs (T-100), found together. */
#include "rigid/forces.h"

/* Changes of the relative velocity below this are round-off: of velocities and places. */
static double round_off(const struct rigid *rigid, const struct rigid_row *row,
                        const struct rigid_step *step)
{
    double speed = 0, size = 0;
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < 3 && row->body[side] >= 0; c++) {
            const struct rigid_equations *const eq = &rigid->eq[row->body[side]];
            const struct rigid_body *const body = &rigid->body[row->body[side]];
            speed += fabs(row->along[side][c]) * (fabs(eq->before[c]) + fabs(eq->change[c]));
            size += fabs(rigid->state[row->body[side]].x[c]) + (c < 2 ? fabs(body->centre[c]) : 0);
        }
    return 1e-15 * (speed + size / step->lag);
}

/* Springs and the friction of hinges are no impacts; friction moves nothing out. */
static bool acts_in(const struct rigid_row *row, enum rigid_stage stage)
{
    switch (row->law) {
    case RIGID_GAP: return true;
    case RIGID_FRICTION:
        return row->friction > 0 && stage != RIGID_PUSH && (!row->hinge || stage == RIGID_STEP);
    case RIGID_SPRING: return stage == RIGID_STEP;
    case RIGID_JOINT: return true;
    }
    return false;
}

/* T-102: the least speed at which a gap may open. */
static double least_rate(const struct rigid_row *row, enum rigid_stage stage, double dt)
{
    const double closes = -(stage == RIGID_PUSH ? row->gap : max2(row->gap, 0)) / dt;
    return stage == RIGID_IMPACT ? max2(row->leave, closes) : closes;
}

/* What a row's own equation adds to its impulse; a: what a unit of that adds to the velocity. */
static double find_more(const struct rigid *rigid, const struct rigid_row *row,
                        enum rigid_stage stage, double a, const struct rigid_step *step)
{
    const double had = row->impulse[stage];
    const double rate =
        rigid_row_rate(rigid, row, stage) + (stage == RIGID_PUSH ? 0 : row->other_rate);
    switch (row->law) {
    case RIGID_GAP: return max2(0, had - (rate - least_rate(row, stage, step->dt)) / a) - had;
    case RIGID_FRICTION: {
        const double normal = row->hinge ? step->rates_time : row[-1].impulse[stage],
                     most = row->friction * normal;
        return max2(-most, min2(most, had - rate / a)) - had;
    }
    case RIGID_SPRING: {
        const double K = row->stiffness, C = row->damping;
        const double e = step->rates_time * (row->theta * step->dt * K + 0.5 * C);
        const double force = row->force + C * row->start_rate;
        const double more =
            -(had + step->rates_time * force + e * (rate - row->start_rate)) / (1 + e * a);
        return row->pulls_only ? max2(-had, more) : more;
    }
    case RIGID_JOINT:
        if (stage == RIGID_STEP) return -rigid_joint_left(rigid, row, step->lag) / a;
        return -rigid_row_change(rigid, row, stage) / a;
    }
    return 0;
}

/* Changes one impulse to what its own equation asks for. Returns the change of the velocity. */
static double solve_row(struct rigid *rigid, struct rigid_row *row, enum rigid_stage stage,
                        const struct rigid_step *step)
{
    const double a = acts_in(row, stage) ? rigid_row_mobility(rigid, row, stage) : 0;
    if (!(a > 0)) return 0;
    const double more = find_more(rigid, row, stage, a, step);
    rigid_row_push(rigid, row, stage, more);
    row->impulse[stage] += more;
    return max2(0, fabs(more) * a - round_off(rigid, row, step));
}

/* Projected Gauss-Seidel, in the order of the rows. */
static void solve_rows(struct rigid *rigid, enum rigid_stage stage, const struct rigid_step *step)
{
    double largest = 1, first = 0;
    for (int turn = 0; turn < 1000 && largest > 1e-12 * first; turn++) {
        largest = 0;
        for (int k = 0; k < rigid->n_rows; k++)
            largest = max2(largest, solve_row(rigid, &rigid->row[k], stage, step));
        if (turn == 0) first = largest;
    }
}

/* What meets in this step rebounds. */
static void find_start(const struct rigid *rigid, double dt)
{
    for (int k = 0; k < rigid->n_rows; k++) {
        struct rigid_row *const row = &rigid->row[k];
        const double rate = rigid_row_rate(rigid, row, RIGID_IMPACT) + row->other_rate;
        const bool meets = rate + max2(row->gap, 0) / dt < 0 && row->restitution > 0;
        row->leave = meets ? -row->restitution * rate : -(double)INFINITY;
        row->start_rate = rate;
    }
}

/* In the whole step. */
static double impulse_of(const struct rigid_row *row)
{
    return row->impulse[RIGID_IMPACT] + row->impulse[RIGID_STEP];
}

/* A joint is a reaction of the body that has the hinge, and a load of the other. */
static void add_load(struct rigid *rigid, const struct rigid_row *row)
{
    for (int side = row->law == RIGID_JOINT; side < 2; side++)
        for (int c = 0; c < 3 && row->body[side] >= 0; c++)
            rigid->eq[row->body[side]].impulse[c] += impulse_of(row) * row->along[side][c];
}

void rigid_find_impulses(struct rigid *rigid, double time, const struct rigid_step *step)
{
    for (int k = 0; k < rigid->n; k++) {
        memset(rigid->eq[k].touch, 0, sizeof rigid->eq[k].touch);
        rigid->eq[k].near = (double)NAN;
    }
    rigid->n_rows = 0;
    rigid_add_pairs(rigid, time);
    rigid_add_hinges(rigid, time);
    rigid_add_springs(rigid, step->dt);
    find_start(rigid, step->dt);
    for (int stage = 0; stage < RIGID_STAGES; stage++)
        solve_rows(rigid, (enum rigid_stage)stage, step);
    for (int k = 0; k < rigid->n; k++) {
        struct rigid_equations *const eq = &rigid->eq[k];
        for (int c = 0; c < 3; c++) {
            eq->change[c] += eq->touch[RIGID_IMPACT][c] + eq->touch[RIGID_STEP][c];
            eq->excess[c] += eq->touch[RIGID_STEP][c];
        }
    }
    for (int k = 0; k < rigid->n_rows; k++) add_load(rigid, &rigid->row[k]);
}

void rigid_impulse_work(struct rigid *rigid)
{
    for (int k = 0; k < rigid->n_rows; k++) {
        const struct rigid_row *const row = &rigid->row[k];
        const int a = row->body[0], b = row->body[1];
        const double impulse = impulse_of(row);
        double work[2] = {0};
        for (int side = 0; side < 2; side++)
            for (int c = 0; c < 3 && row->body[side] >= 0; c++)
                work[side] += impulse * row->along[side][c] * rigid->body[row->body[side]].mean[c];
        const bool drives = row->law == RIGID_JOINT && row->component == 2;
        rigid->body[a < 0 ? b : a].driven +=
            drives ? work[0] + work[1] : -impulse * row->other_rate;
        if (a < 0 || b < 0) continue;
        rigid->body[a].through_springs -= work[1];
        rigid->body[b].through_springs += work[1];
    }
}
