/* SPDX-License-Identifier: MIT
 * Hinges between rigid bodies, and what acts in any hinge: spring, damper, friction, drive. */
#include "rigid/forces.h"
#include "geometry/motion.h"

/* A hinge of a body on another one, a wall or a place. */
struct rigid_hinge {
    const struct scene_rigid *given;
    const double *at;           /* at the start, m */
    int body[2];                /* the second is -1 if it is none */
    int wall_motion, drive;     /* of the wall, and of the angle; -1: none */
    double end_angle, end_rate; /* of the first after the step, if driven */
};

enum err rigid_hinges_create(struct rigid *rigid, struct arena *a, struct diag *d)
{
    const struct scene *const scene = rigid->scene;
    int n = 0;
    for (int k = 0; k < rigid->n; k++) n += scene->rigid[k].hinge.n;
    TRY(arena_array(a, &rigid->hinge, n, "hinges", d));
    for (int k = 0; k < rigid->n; k++) {
        struct rigid_body *const body = &rigid->body[k];
        body->hinge_motion = -1;
        for (int j = 0; j < body->given->hinge.n; j++) {
            const struct hinge_point *const point = &body->given->hinge.item[j];
            const int wall = scene_find(scene, SECTION_wall, point->other);
            struct rigid_hinge *const hinge = &rigid->hinge[rigid->n_hinges++];
            *hinge = (struct rigid_hinge){.given = body->given,
                                          .at = point->at,
                                          .body = {k, wall - scene_rigid_wall(scene, 0)},
                                          .wall_motion = -1,
                                          .drive = scene_find(scene, SECTION_motion,
                                                              body->given->hinge_motion)};
            if (hinge->body[1] >= 0) continue;
            hinge->body[1] = -1;
            body->fixed = point;
            body->hinge_motion = hinge->wall_motion = scene_wall_motion(scene, wall);
        }
    }
    return ERR_OK;
}

static bool joins_bodies(const struct rigid_hinge *h) { return h->body[1] >= 0; }

/* What a unit force along an axis, or a unit moment, is to both bodies. */
static void find_along(const struct rigid *rigid, struct rigid_row *row)
{
    const int c = row->component;
    for (int side = 0; side < 2; side++) {
        const int k = row->body[side];
        double arm[2];
        if (k < 0) continue;
        row->along[side][2] = side ? -1 : 1;
        if (c == 2) continue;
        rigid_arm(rigid, k, row->hinge->at, rigid->state[k].x[2], arm);
        rigid_row_along(row, side, arm, (const double[]){c == 0, c == 1});
    }
}

/* The angle of the drive at the end of the step, and its rate. */
static void find_drive(const struct rigid *rigid, struct rigid_hinge *h)
{
    const struct motion_state wall = motion_at(rigid->scene, h->wall_motion, rigid->end),
                              drive = motion_at(rigid->scene, h->drive, rigid->end);
    h->end_angle = wall.angle + drive.angle - motion_at(rigid->scene, h->drive, 0).angle;
    h->end_rate = wall.rate + drive.rate;
}

static struct rigid_row *add_row(struct rigid *rigid, const struct rigid_hinge *h,
                                 enum rigid_law law, int component)
{
    struct rigid_row *const row = rigid_add_row(rigid, law, h->body);
    row->hinge = h;
    row->component = component;
    find_along(rigid, row);
    return row;
}

/* The angle of the first body relative to the second or the wall. */
static double angle_of(const struct rigid *rigid, const struct rigid_hinge *h, double wall_angle)
{
    const double other = joins_bodies(h) ? rigid->state[h->body[1]].x[2] : wall_angle;
    return rigid->state[h->body[0]].x[2] - other;
}

void rigid_add_hinges(struct rigid *rigid, double time)
{
    for (int k = 0; k < rigid->n_hinges; k++) {
        struct rigid_hinge *const h = &rigid->hinge[k];
        const struct scene_rigid *const given = h->given;
        const struct motion_state wall = motion_at(rigid->scene, h->wall_motion, time);
        find_drive(rigid, h);
        for (int c = 0; c < 2 && joins_bodies(h); c++) add_row(rigid, h, RIGID_JOINT, c);
        if (h->drive >= 0) add_row(rigid, h, RIGID_JOINT, 2);
        if (given->hinge_stiffness > 0 || given->hinge_damping > 0) {
            struct rigid_row *const row = add_row(rigid, h, RIGID_SPRING, 2);
            row->stiffness = given->hinge_stiffness;
            row->damping = given->hinge_damping;
            row->theta = 0.25;
            row->force = given->hinge_stiffness * angle_of(rigid, h, wall.angle);
            row->other_rate = -wall.rate;
        }
        if (given->hinge_friction > 0) {
            struct rigid_row *const row = add_row(rigid, h, RIGID_FRICTION, 2);
            row->friction = given->hinge_friction;
            row->other_rate = -wall.rate;
        }
    }
}

/* Cosine and sine of the angle to which a step turns a body: to round-off by those of an angle near
 * it, since the sweeps change the angle little. */
static void turn_after(const struct rigid *rigid, int k, double lag, double turn[2])
{
    struct rigid_equations *const eq = &rigid->eq[k];
    const double angle = rigid->state[k].x[2] + rigid_displacement(rigid, k, 2, lag);
    double off = angle - eq->near;
    if (!(fabs(off) < 1e-6)) {
        eq->near = angle;
        eq->turn[0] = elementary_cos(angle);
        eq->turn[1] = elementary_sin(angle);
        off = 0;
    }
    const double cosine = 1 - 0.5 * square(off);
    turn[0] = cosine * eq->turn[0] - off * eq->turn[1];
    turn[1] = cosine * eq->turn[1] + off * eq->turn[0];
}

/* Where a step takes the point of a hinge on a body. */
static void place_after(const struct rigid *rigid, int k, const double at[2], double lag,
                        double place[2])
{
    const struct rigid_body *const body = &rigid->body[k];
    const double *const from = body->fixed ? body->fixed->at : body->centre;
    const double x = at[0] - from[0], y = at[1] - from[1];
    double turn[2];
    turn_after(rigid, k, lag, turn);
    for (int c = 0; c < 2; c++)
        place[c] = from[c] + rigid->state[k].x[c] + rigid_displacement(rigid, k, c, lag);
    if (body->fixed) {
        const struct motion_state m = motion_at(rigid->scene, body->hinge_motion, rigid->end);
        memcpy(place, motion_of_point(&m, from[0], from[1]).x, 2 * sizeof *place);
    }
    place[0] += turn[0] * x - turn[1] * y;
    place[1] += turn[1] * x + turn[0] * y;
}

double rigid_joint_left(const struct rigid *rigid, const struct rigid_row *row, double lag)
{
    const bool turns = row->component == 2;
    double left = turns ? -row->hinge->end_angle : 0;
    for (int side = 0; side < 2; side++) {
        const int k = row->body[side];
        if (k < 0) continue;
        double place[3] = {0, 0, rigid->state[k].x[2] + rigid_displacement(rigid, k, 2, lag)};
        if (!turns) place_after(rigid, k, row->hinge->at, lag, place);
        left += side ? -place[row->component] : place[row->component];
    }
    return left / lag;
}

/* Changes velocities to what a row allows after the step. The reaction of the second body is that
 * of its own hinge. Returns the change of the velocity, 0: below round-off. */
static double hold_row(struct rigid *rigid, struct rigid_row *row, double rates_time)
{
    const double a = rigid_row_mobility(rigid, row, RIGID_IMPACT);
    double rate = row->component == 2 ? -row->hinge->end_rate : 0, speed = fabs(rate);
    if (!(a > 0)) return 0;
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < 3 && row->body[side] >= 0; c++) {
            const double v = row->along[side][c] * rigid->state[row->body[side]].v[c];
            rate += v;
            speed += fabs(v);
        }
    const double impulse = -rate / a;
    row->impulse[RIGID_STEP] += impulse;
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < 3 && row->body[side] >= 0; c++) {
            struct rigid_state *const s = &rigid->state[row->body[side]];
            for (int e = 0; e < 3; e++)
                s->v[c] +=
                    rigid->eq[row->body[side]].mobility_dry[c][e] * row->along[side][e] * impulse;
            if (side && rates_time > 0)
                s->reaction[c] -= row->along[side][c] * impulse / rates_time;
        }
    return max2(0, fabs(rate) - 1e-15 * speed);
}

/* T-99a: velocities after the step, which the hinges allow where the bodies are. */
void rigid_hinges_hold(struct rigid *rigid, double time, double rates_time)
{
    double largest = 1, first = 0;
    for (int k = 0; k < rigid->n_rows; k++) {
        struct rigid_row *const row = &rigid->row[k];
        if (row->hinge) find_along(rigid, row);
    }
    for (int k = 0; k < rigid->n && rigid->n_hinges; k++) rigid_find_mobility_dry(rigid, k, time);
    for (int turn = 0; turn < 1000 && largest > 1e-12 * first; turn++) {
        largest = 0;
        for (int k = 0; k < rigid->n_rows; k++)
            if (rigid->row[k].law == RIGID_JOINT)
                largest = max2(largest, hold_row(rigid, &rigid->row[k], rates_time));
        if (turn == 0) first = largest;
    }
}

double rigid_hinge_gap(const struct rigid *rigid, int *worst)
{
    double largest = 0;
    for (int j = 0; j < rigid->n_hinges; j++) {
        const struct rigid_hinge *const h = &rigid->hinge[j];
        const struct rigid_body *const body = &rigid->body[h->body[0]];
        double place[2][2] = {{0}}, off = 0;
        for (int side = 0; side < 2 && joins_bodies(h); side++) {
            const int k = h->body[side];
            rigid_arm(rigid, k, h->at, rigid->state[k].x[2], place[side]);
            for (int c = 0; c < 2; c++)
                place[side][c] += rigid->body[k].centre[c] + rigid->state[k].x[c];
        }
        if (h->drive >= 0) off = angle_of(rigid, h, 0) - h->end_angle;
        const double gap =
            max2(fabs(off) * sqrt(body->mass[2] / body->mass[0]),
                 elementary_hypot(place[0][0] - place[1][0], place[0][1] - place[1][1]));
        if (gap > largest) *worst = h->body[0];
        largest = max2(largest, gap);
    }
    return largest;
}

bool rigid_share_hinge(const struct rigid *rigid, int one, int other)
{
    for (int k = 0; k < rigid->n_hinges; k++) {
        const int *const body = rigid->hinge[k].body;
        if ((body[0] == one && body[1] == other) || (body[0] == other && body[1] == one))
            return true;
    }
    return false;
}

double rigid_hinge_energy(const struct rigid *rigid, int k)
{
    double sum = 0;
    for (int j = 0; j < rigid->n_hinges; j++) {
        const struct rigid_hinge *const h = &rigid->hinge[j];
        if (h->body[0] != k) continue;
        const double time = rigid->scene->rigid_motion[k].time;
        const double wall = motion_at(rigid->scene, h->wall_motion, time).angle;
        sum += 0.5 * h->given->hinge_stiffness * square(angle_of(rigid, h, wall));
    }
    return sum;
}
