/* SPDX-License-Identifier: MIT
 * Rigid bodies that beams touch or are joined to, within Newton's method (T-107). */
#include "beam/beam.h"
#include "rigid/forces.h"

static double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static const struct rigid_equations *equations_of(const struct beams *beams,
                                                  const struct beam_body *body)
{
    return &beams->rigid->eq[body - beams->body];
}

enum err beams_bodies_create(struct beams *beams, struct arena *a, struct diag *d)
{
    beams->n_bodies = beams->scene->n_rigid;
    beams->size = beams->matrix.n + ENVELOPE_ALIGN + 3 * beams->n_bodies;
    TRY(arena_array(a, &beams->unknown, beams->size, "beams", d));
    return arena_array(a, &beams->body, beams->n_bodies, "beams", d);
}

void beam_body_place(const struct beam_body *body, double x[3])
{
    for (int c = 0; c < 2; c++) x[c] = body->x[c] + body->d[c];
    x[2] = body->x[2] + body->d[2] * beam_atan_over(0.5 * body->d[2]);
}

/* A hinge in place or on a wall gives the body the place of its angle. */
static void follow_hinge(const struct beams *beams, struct beam_body *body)
{
    const int k = (int)(body - beams->body);
    double x[3];
    if (!beams->rigid->body[k].fixed) return;
    beam_body_place(body, x);
    rigid_follow_hinge(beams->rigid, k, beams->part_end, x);
    for (int c = 0; c < 2; c++) body->d[c] = x[c] - body->x[c];
}

/* --- rows --- */

/* From the centre of mass to the place of a row: at the start of the part, and after it. */
static void find_arms(const struct beams *beams, const struct beam_row *row, double arm[2][2])
{
    const struct beam_body *const body = &beams->body[row->body];
    double x[3];
    beam_body_place(body, x);
    rigid_arm(beams->rigid, row->body, row->X, body->x[2], arm[0]);
    rigid_arm(beams->rigid, row->body, row->X, x[2], arm[1]);
}

void beam_row_aim(const struct beams *beams, struct beam_row *row)
{
    double arm[2][2];
    if (row->body < 0) return;
    find_arms(beams, row, arm);
    const double x = 0.5 * (arm[0][0] + arm[1][0]), y = 0.5 * (arm[0][1] + arm[1][1]);
    memcpy(row->along, row->e, sizeof row->along);
    row->along[2] += x * row->e[1] - y * row->e[0];
}

double beam_row_moved(const struct beams *beams, const struct beam_row *row)
{
    return row->body < 0 ? 0 : dot3(row->along, beams->body[row->body].d);
}

double beam_row_moved_by(const struct beams *beams, const struct beam_row *row,
                         const double *vector)
{
    return row->body < 0 ? 0 : dot3(row->along, &vector[beams_body_row(beams, row->body)]);
}

double beam_row_speed(const struct beams *beams, const struct beam_row *row)
{
    return dot3(row->along, beams->body[row->body].v);
}

double beam_row_compliance(const struct beams *beams, const struct beam_row *row)
{
    const double(*const W)[3] = equations_of(beams, &beams->body[row->body])->mobility;
    double sum = 0;
    for (int c = 0; c < 3; c++) sum += row->along[c] * dot3(W[c], row->along);
    return sum;
}

void beam_row_kick(const struct beams *beams, const struct beam_row *row, double impulse)
{
    struct beam_body *const body = &beams->body[row->body];
    const double(*const W)[3] = equations_of(beams, body)->mobility;
    for (int c = 0; c < 3; c++) {
        body->impulse[c] -= impulse * row->along[c];
        body->v[c] -= impulse * dot3(W[c], row->along);
    }
}

void beam_row_push(const struct beams *beams, struct beam_row *row)
{
    double arm[2][2];
    if (row->body < 0) return;
    struct beam_body *const body = &beams->body[row->body];
    beam_row_aim(beams, row);
    find_arms(beams, row, arm);
    for (int c = 0; c < 3; c++) body->force[c] -= row->force * row->along[c];
    for (int c = 0; c < 2; c++) body->turning += 0.5 * row->force * row->e[c] * arm[1][c];
}

void beam_row_move(const struct beams *beams, const struct beam_row *row, double *vector)
{
    if (row->body < 0) return;
    double *const to = &vector[beams_body_row(beams, row->body)];
    for (int c = 0; c < 3; c++) to[c] -= dot3(beams->body[row->body].compliance[c], row->along);
}

bool beam_row_settled(const struct beams *beams, const struct beam_row *row, double kept)
{
    return row->body < 0 || fabs(dot3(row->along, beams->body[row->body].off)) <= kept;
}

/* --- a step --- */

void beams_take_bodies(struct beams *beams, double time, double dt)
{
    for (int k = 0; k < beams->n_bodies; k++) {
        struct beam_body *const body = &beams->body[k];
        rigid_free_motion(beams->rigid, k, time, dt, body->from, body->v, body->mean);
        memcpy(body->x, body->from, sizeof body->x);
        memset(body->impulse, 0, sizeof body->impulse);
        memset(body->push, 0, sizeof body->push);
        for (int c = 0; c < 3; c++) body->a[c] = 2 * (body->mean[c] - body->v[c]) / dt;
    }
}

void beams_return_bodies(struct beams *beams, double dt)
{
    for (int k = 0; k < beams->n_bodies; k++) {
        const struct beam_body *const body = &beams->body[k];
        struct rigid_body *const to = &beams->rigid->body[k];
        const double(*const W)[3] = equations_of(beams, body)->mobility;
        const double lag = beams->rigid->mid_step ? 0.5 * dt : dt;
        bool acts = false;
        for (int c = 0; c < 3; c++) acts |= body->impulse[c] != 0 || body->push[c] != 0;
        if (!acts) continue;
        for (int c = 0; c < 3; c++) {
            to->moved[c] +=
                body->x[c] - (body->from[c] + dt * body->mean[c] + lag * dot3(W[c], body->impulse));
            to->push_impulse[c] += body->push[c];
        }
        rigid_add_impulse(beams->rigid, k, body->impulse);
        beams->has_pushed_body = true;
    }
}

/* --- a part of the step --- */

void beams_begin_bodies(struct beams *beams, double time, double dt)
{
    beams->part_end = time + dt;
    for (int k = 0; k < beams->n_bodies; k++) {
        struct beam_body *const body = &beams->body[k];
        for (int c = 0; c < 3; c++) body->d[c] = dt * (body->v[c] + 0.5 * dt * body->a[c]);
        follow_hinge(beams, body);
    }
}

void beams_clear_rows(struct beams *beams)
{
    for (int k = 0; k < beams->n_nodes; k++)
        memset(beams->step[k].touch, 0, sizeof beams->step[k].touch);
    for (int k = 0; k < beams->n_bodies; k++) {
        memset(beams->body[k].force, 0, sizeof beams->body[k].force);
        beams->body[k].turning = 0;
    }
}

void beams_find_bodies(struct beams *beams, double dt)
{
    const double share = 0.5 * dt * dt;
    for (int k = 0; k < beams->n_bodies; k++) {
        struct beam_body *const body = &beams->body[k];
        const double(*const W)[3] = equations_of(beams, body)->mobility;
        const double stiff = share * body->turning / (1 + 0.25 * square(body->d[2])),
                     rest = 1 - stiff * W[2][2], beta = rest > 0.1 ? stiff / rest : 0;
        for (int c = 0; c < 3; c++) {
            body->off[c] =
                dt * body->v[c] + share * (body->a[c] + dot3(W[c], body->force)) - body->d[c];
            for (int e = 0; e < 3; e++)
                body->compliance[c][e] = share * (W[c][e] + beta * W[c][2] * W[2][e]);
        }
        const double turn = body->off[2];
        for (int c = 0; c < 2 && beams->rigid->body[k].fixed; c++)
            body->off[c] = turn * W[c][2] / W[2][2];
        for (int c = 0; c < 3; c++) body->off[c] += beta * W[c][2] * turn;
        memcpy(&beams->unknown[beams_body_row(beams, k)], body->off, sizeof body->off);
    }
}

void beams_move_bodies(struct beams *beams)
{
    for (int k = 0; k < beams->n_bodies; k++) {
        for (int c = 0; c < 3; c++)
            beams->body[k].d[c] += beams->unknown[beams_body_row(beams, k) + c];
        follow_hinge(beams, &beams->body[k]);
    }
}

void beams_finish_bodies(struct beams *beams, double dt)
{
    for (int k = 0; k < beams->n_bodies; k++) {
        struct beam_body *const body = &beams->body[k];
        beam_body_place(body, body->x);
        for (int c = 0; c < 3; c++) body->v[c] = 2 * body->d[c] / dt - body->v[c];
    }
}
