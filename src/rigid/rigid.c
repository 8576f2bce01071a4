/* SPDX-License-Identifier: MIT
 * The step of rigid bodies, and what they exchange with walls, fluid and solids. */
#include "geometry/motion.h"
#include "rigid/forces.h"

enum err rigid_create(struct rigid *rigid, struct arena *a, const struct scene *scene,
                      const struct wall_motion *motion, struct particles *walls, bool mid_step,
                      struct diag *d)
{
    *rigid = (struct rigid){.n = scene->n_rigid, .scene = scene, .walls = walls};
    rigid->mid_step = mid_step;
    rigid->impedance = scene->rho0 * scene->c0;
    rigid->mean_time = scene->n_fluid > 0 ? scene->h / scene->c0 : 0;
    TRY(arena_array(a, &rigid->body, rigid->n, "rigid bodies", d));
    TRY(arena_array(a, &rigid->state, rigid->n, "rigid bodies", d));
    TRY(arena_array(a, &rigid->eq, rigid->n, "rigid bodies", d));
    for (int k = 0; k < rigid->n; k++) {
        const struct rigid_mass *const m = &scene->rigid_mass[k];
        rigid->body[k] = (struct rigid_body){.given = &scene->rigid[k],
                                             .mass = {m->mass, m->mass, m->inertia},
                                             .centre = {m->centre[0], m->centre[1]}};
        for (int b = 0; b < motion->n; b++)
            if (motion->wall[b].section == scene_rigid_wall(scene, k))
                rigid->body[k].wall = &motion->wall[b];
        rigid->state[k] =
            (struct rigid_state){.v = {scene->rigid[k].velocity[0], scene->rigid[k].velocity[1],
                                       scene->rigid[k].spin},
                                 .exchange_time = rigid->mean_time}; /* longer than any step */
    }
    TRY(rigid_hinges_create(rigid, a, d));
    TRY(rigid_springs_create(rigid, a, d));
    for (int k = 0; k < rigid->n; k++) rigid_hold(rigid, k, 0, 0);
    TRY(rigid_contact_create(rigid, a, d));
    rigid_add_hinges(rigid, 0);
    rigid_hinges_hold(rigid, 0, 0);
    return ERR_OK;
}

/* What a value with a rate is at the end of a step of dt. */
static void at_end(const struct rigid *rigid, double dt, const double value[3],
                   const double rate[3], double end[3])
{
    for (int c = 0; c < 3; c++) end[c] = value[c] + (rigid->mid_step ? 0 : 0.5 * dt * rate[c]);
}

void rigid_publish(const struct rigid *rigid, double time, double dt)
{
    for (int k = 0; k < rigid->n; k++) {
        const struct rigid_state *const s = &rigid->state[k];
        struct motion_state *const now = &rigid->scene->rigid_motion[k].now;
        double v[3];
        at_end(rigid, dt, s->v, s->last, v);
        *now =
            (struct motion_state){.angle = s->x[2],
                                  .rate = v[2],
                                  .angular_acceleration = s->a[2],
                                  .centre = {rigid->body[k].centre[0], rigid->body[k].centre[1]}};
        memcpy(now->d, s->x, sizeof now->d);
        memcpy(now->v, v, sizeof now->v);
        memcpy(now->a, s->a, sizeof now->a);
        rigid->scene->rigid_motion[k].time = time;
    }
}

/* --- the fluid --- */

/* The generalised vector of a vector w at a point: with its moment about the centre of mass. */
static void with_moment(const struct motion_state *m, double x, double y, double wx, double wy,
                        double to[3])
{
    to[0] = wx;
    to[1] = wy;
    to[2] = (x - m->centre[0] - m->d[0]) * wy - (y - m->centre[1] - m->d[1]) * wx;
}

/* Force of the fluid on a body, and its impedance Z: rho0 c0 on the wetted surface (T-95). */
static void find_fluid(const struct rigid *rigid, const struct rigid_body *body, double force[3],
                       double impedance[3][3])
{
    const struct particles *const p = rigid->walls;
    memset(force, 0, 3 * sizeof *force);
    memset(impedance, 0, 9 * sizeof **impedance);
    for (int64_t i = body->wall->first; i < body->wall->end; i++) {
        const double wet = sqrt(square(p->wet_x[i]) + square(p->wet_y[i]));
        double f[3], normal[3];
        with_moment(&body->wall->placed, p->x[i], p->y[i], p->fx[i], p->fy[i], f);
        for (int c = 0; c < 3; c++) force[c] += f[c];
        if (!(wet > 0)) continue;
        with_moment(&body->wall->placed, p->x[i], p->y[i], p->wet_x[i], p->wet_y[i], normal);
        for (int c = 0; c < 3; c++)
            for (int e = 0; e < 3; e++)
                impedance[c][e] += rigid->impedance / wet * normal[c] * normal[e];
    }
}

/* T-97: the pressure that gives the fluid the impulse: `left` of that before, and a new one;
 * `excess` is the velocity beyond the expected one. */
static void add_pressure(const struct rigid *rigid, const struct rigid_body *body, double left,
                         const double excess[3])
{
    struct particles *const p = rigid->walls;
    for (int64_t i = body->wall->first; i < body->wall->end; i++) {
        const double wet = sqrt(square(p->wet_x[i]) + square(p->wet_y[i]));
        double normal[3], along = 0;
        with_moment(&body->wall->placed, p->x[i], p->y[i], p->wet_x[i], p->wet_y[i], normal);
        for (int c = 0; c < 3 && wet > 0; c++) along += normal[c] / wet * excess[c];
        p->interface_pressure[i] = left * p->interface_pressure[i] - 2 * rigid->impedance * along;
    }
}

/* --- a step --- */

/* The part of the waiting impulse that the fluid receives in a kick (T-97). */
static double received_part(const struct rigid *rigid, int k, double rates_time)
{
    return rigid->mean_time > 0 ? rates_time / rigid->state[k].exchange_time : 0;
}

static void prepare_body(struct rigid *rigid, int k, const double gravity[2], double now, double dt,
                         double rates_time)
{
    const struct rigid_body *const body = &rigid->body[k];
    struct rigid_state *const s = &rigid->state[k];
    struct rigid_equations *const eq = &rigid->eq[k];
    const double after = exchange_time_after(s->exchange_time, dt),
                 part = received_part(rigid, k, rates_time);
    double force[3], impedance[3][3];
    memcpy(eq->start, s->v, sizeof eq->start);
    memcpy(eq->at_start, rigid->scene->rigid_motion[k].now.v, 2 * sizeof(double));
    eq->at_start[2] = rigid->scene->rigid_motion[k].now.rate;
    find_fluid(rigid, body, force, impedance);
    /* The body resists all that the hinge's velocity changes in the step (T-99). */
    rigid_hold(rigid, k, now, rigid->end - dt);
    for (int c = 0; c < 3; c++) {
        const double heavy = c < 2 && body->given->gravity ? body->mass[c] * gravity[c] : 0;
        eq->before[c] = s->v[c];
        eq->from_fluid[c] = rates_time * force[c] - part * s->impulse[c];
        eq->impulse[c] = eq->from_fluid[c] + rates_time * heavy;
        for (int e = 0; e < 3; e++) eq->resisting[c][e] = after * impedance[c][e];
    }
}

/* T-102a: the change of the velocity by an impulse, with the fluid's resistance. */
static void velocity_by(const struct rigid_equations *eq, const double impulse[3], double change[3])
{
    for (int c = 0; c < 3; c++) {
        change[c] = 0;
        for (int e = 0; e < 3; e++) change[c] += eq->mobility[c][e] * impulse[e];
    }
}

void rigid_add_impulse(struct rigid *rigid, int k, const double impulse[3])
{
    struct rigid_equations *const eq = &rigid->eq[k];
    double change[3];
    velocity_by(eq, impulse, change);
    for (int c = 0; c < 3; c++) {
        eq->impulse[c] += impulse[c];
        eq->change[c] += change[c];
        eq->excess[c] += change[c];
    }
}

/* What solids change in the velocity after the forces of a step that act at its start. */
static double change_by_solids(const struct rigid *rigid, int k, int c)
{
    return rigid->mid_step ? 0 : rigid->eq[k].push_change[c];
}

static void move_body(struct rigid *rigid, int k, const struct rigid_step *step)
{
    struct rigid_body *const body = &rigid->body[k];
    struct rigid_state *const s = &rigid->state[k];
    const struct rigid_equations *const eq = &rigid->eq[k];
    const double rates_time = step->rates_time, part = received_part(rigid, k, rates_time);
    rigid_find_reaction(rigid, k, rates_time);
    body->received = body->through_springs = body->driven = 0;
    for (int c = 0; c < 3; c++) {
        double resisted = 0;
        for (int e = 0; e < 3; e++) resisted += eq->resisting[c][e] * eq->excess[e];
        const double change = rates_time * s->a[c] + eq->excess[c] + eq->touch[RIGID_IMPACT][c];
        body->mean[c] = eq->before[c] + 0.5 * (change - change_by_solids(rigid, k, c));
        body->received += (eq->from_fluid[c] - resisted) * body->mean[c];
        s->rate[c] = -(part * s->impulse[c] + resisted) / rates_time;
        s->impulse[c] += rates_time * s->rate[c];
        s->v[c] = eq->before[c] + change;
        s->x[c] += step->lag * (s->v[c] - eq->push_change[c]) + body->moved[c] +
                   step->dt * eq->touch[RIGID_PUSH][c];
    }
    rigid_hold(rigid, k, rigid->end, rigid->end);
}

/* What follows from the velocity at the end of the step. */
static void end_body(struct rigid *rigid, int k, double dt, double rates_time)
{
    struct rigid_body *const body = &rigid->body[k];
    struct rigid_state *const s = &rigid->state[k];
    const struct rigid_equations *const eq = &rigid->eq[k];
    const double weight = rates_time / (rates_time + rigid->mean_time);
    for (int c = 0; c < 3; c++) {
        const double impact = eq->touch[RIGID_IMPACT][c] / rates_time,
                     push = eq->push_change[c] / rates_time;
        /* An impact is no acceleration that the fluid could expect to go on. */
        const double steady = (s->v[c] - eq->start[c]) / rates_time - impact;
        /* The force that turns the velocity within the step is a reaction, too. */
        s->reaction[c] +=
            body->mass[c] *
            (steady + impact -
             (2 * (body->mean[c] - eq->before[c]) + change_by_solids(rigid, k, c)) / rates_time);
        /* Contact with solids is not half a step behind. */
        s->last[c] = steady - push;
        s->a[c] += weight * (steady - s->a[c]);
    }
    body->driven += rates_time * rigid_hinge_power(rigid, k, dt);
    const double left = (1 - received_part(rigid, k, rates_time)) * s->exchange_time;
    s->exchange_time = exchange_time_after(s->exchange_time, dt);
    if (rigid->impedance > 0) add_pressure(rigid, body, left / s->exchange_time, eq->excess);
}

void rigid_begin(struct rigid *rigid, const double gravity[2], double time, double dt,
                 double rates_time)
{
    const double lag = rigid->mid_step ? 0.5 * dt : dt, now = time + dt - lag;
    rigid->end = time + dt;
    for (int k = 0; k < rigid->n && rigid->mid_step; k++)
        for (int c = 0; c < 3; c++) rigid->state[k].x[c] += 0.5 * dt * rigid->state[k].v[c];
    for (int k = 0; k < rigid->n; k++) {
        struct rigid_body *const body = &rigid->body[k];
        struct motion_state *const published = &rigid->scene->rigid_motion[k].now;
        memset(body->push_impulse, 0, sizeof body->push_impulse);
        memset(body->moved, 0, sizeof body->moved);
        prepare_body(rigid, k, gravity, now, dt, rates_time);
        rigid_solve(rigid, k, rigid->end, rates_time);
        /* The published motion goes on as without contact. */
        for (int c = 0; c < 2; c++) published->a[c] = rigid->eq[k].change[c] / rates_time;
        published->angular_acceleration = rigid->eq[k].change[2] / rates_time;
    }
}

void rigid_advance(struct rigid *rigid, double time, double dt, double rates_time)
{
    const struct rigid_step step = {dt, rates_time, .lag = rigid->mid_step ? 0.5 * dt : dt};
    const double now = time + dt - step.lag;
    for (int k = 0; k < rigid->n; k++) {
        velocity_by(&rigid->eq[k], rigid->body[k].push_impulse, rigid->eq[k].push_change);
        rigid_add_impulse(rigid, k, rigid->body[k].push_impulse);
    }
    rigid_find_impulses(rigid, now, &step);
    for (int k = 0; k < rigid->n; k++) move_body(rigid, k, &step);
    if (rigid->mid_step) rigid_hinges_hold(rigid, rigid->end, rates_time);
    for (int k = 0; k < rigid->n; k++) end_body(rigid, k, dt, rates_time);
    rigid_impulse_work(rigid);
}

/* --- contact with solids --- */

void rigid_clear_push(struct rigid *rigid)
{
    for (int k = 0; k < rigid->n; k++) memset(rigid->body[k].push, 0, sizeof rigid->body[k].push);
}

void rigid_push(struct rigid *rigid, int k, const struct motion_state *m, const double at[2],
                const double force[2])
{
    double w[3];
    with_moment(m, at[0], at[1], force[0], force[1], w);
    for (int c = 0; c < 3; c++) rigid->body[k].push[c] += w[c];
}

void rigid_kick(struct rigid *rigid, double time, double dt)
{
    for (int k = 0; k < rigid->n; k++) {
        struct rigid_body *const body = &rigid->body[k];
        struct rigid_motion *const motion = &rigid->scene->rigid_motion[k];
        double impulse[3], change[3];
        for (int c = 0; c < 3; c++) impulse[c] = dt * body->push[c];
        velocity_by(&rigid->eq[k], impulse, change);
        motion->now = motion_at(rigid->scene, scene_rigid_motion(rigid->scene, k), time);
        motion->time = time;
        motion->now.v[0] += change[0];
        motion->now.v[1] += change[1];
        motion->now.rate += change[2];
        for (int c = 0; c < 3; c++) {
            body->push_impulse[c] += impulse[c];
            body->moved[c] += (rigid->end - time) * change[c];
        }
    }
}

/* --- beams on bodies --- */

void rigid_free_motion(const struct rigid *rigid, int k, double time, double dt, double x[3],
                       double v[3], double mean[3])
{
    const struct rigid_body *const body = &rigid->body[k];
    const struct rigid_equations *const eq = &rigid->eq[k];
    const double moved = rigid->mid_step ? 0.5 : 0;
    memcpy(x, rigid->state[k].x, sizeof rigid->state[k].x);
    velocity_by(eq, body->push_impulse, v);
    for (int c = 0; c < 3; c++) {
        x[c] -= moved * dt * eq->start[c];
        v[c] += eq->at_start[c];
        mean[c] = moved * eq->start[c] + (1 - moved) * (eq->before[c] + eq->change[c]) +
                  body->moved[c] / dt;
    }
    if (body->fixed) rigid_follow_hinge(rigid, k, time, x);
}

/* --- energy --- */

struct body_energy rigid_energy(const struct rigid *rigid, int k, double dt)
{
    const struct rigid_body *const body = &rigid->body[k];
    const struct rigid_state *const s = &rigid->state[k];
    const double *const g = rigid->scene->top.gravity;
    struct body_energy e = {.mass = body->mass[0]};
    double v[3], impulse[3];
    at_end(rigid, dt, s->v, s->last, v);
    at_end(rigid, dt, s->impulse, s->rate, impulse);
    for (int c = 0; c < 3; c++) {
        e.kinetic += 0.5 * body->mass[c] * square(v[c]);
        e.undelivered += impulse[c] * v[c];
        if (c == 2) continue;
        e.momentum[c] = body->mass[c] * v[c] - impulse[c];
        e.potential -=
            body->given->gravity ? body->mass[c] * g[c] * (body->centre[c] + s->x[c]) : 0;
    }
    e.elastic = rigid_hinge_energy(rigid, k);
    rigid_add_spring_energy(rigid, k, &e);
    return e;
}
