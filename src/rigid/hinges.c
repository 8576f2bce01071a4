/* SPDX-License-Identifier: MIT
 * Hinges between rigid bodies, and what acts in any hinge: spring, damper, friction, drive. */
#include "rigid/forces.h"

#include <math.h>
#include <string.h>

#include "base/elementary.h"
#include "geometry/motion.h"

enum { HINGE_X, HINGE_Y, HINGE_SPRING, HINGE_FRICTION, HINGE_ROWS };

/* A hinge of a body on another one, a wall or a place. */
struct rigid_hinge {
    const struct scene_rigid *given;
    const double *at;           /* at the start, m */
    int body[2];                /* the second is -1 if it is none */
    int wall_motion, drive;     /* of the wall, and of the angle; -1: none */
    double along[3][2][3];      /* what unit forces and a unit moment are to both bodies */
    double impulse[HINGE_ROWS]; /* in a step */
    double angle, rate;         /* of the first relative to the second, before the step */
    double wall_rate;           /* of the second if it is a wall, 1/s */
    double end_angle, end_rate; /* of the first after the step, if driven */
};

static int motion_named(const struct scene *scene, const char *name)
{
    return *name ? scene_find_motion(scene, name) : -1;
}

enum err rigid_hinges_create(struct rigid *rigid, struct arena *a, struct diag *d)
{
    const struct scene *const scene = rigid->scene;
    int n = 0;
    for (int k = 0; k < rigid->n; k++) n += scene->rigid[k].hinge.n;
    rigid->hinge = arena_alloc(a, (size_t)n, sizeof *rigid->hinge, "hinges", d);
    if (!rigid->hinge) return ERR_MEMORY;
    for (int k = 0; k < rigid->n; k++) {
        struct rigid_body *const body = &rigid->body[k];
        body->hinge_motion = -1;
        for (int j = 0; j < body->given->hinge.n; j++) {
            const struct hinge_point *const point = &body->given->hinge.item[j];
            const int wall = *point->other ? scene_find_wall(scene, point->other) : -1;
            struct rigid_hinge *const hinge = &rigid->hinge[rigid->n_hinges++];
            *hinge = (struct rigid_hinge){.given = body->given,
                                          .at = point->at,
                                          .body = {k, wall - scene_rigid_wall(scene, 0)},
                                          .wall_motion = -1,
                                          .drive = motion_named(scene, body->given->hinge_motion)};
            if (hinge->body[1] >= 0) continue;
            hinge->body[1] = -1;
            body->fixed = point;
            if (wall >= 0)
                body->hinge_motion = hinge->wall_motion =
                    motion_named(scene, scene->wall[wall].motion);
        }
    }
    return ERR_OK;
}

static bool joins_bodies(const struct rigid_hinge *h) { return h->body[1] >= 0; }

static struct rigid_row row_along(const struct rigid_hinge *h, int row)
{
    return (struct rigid_row){h->body, h->along[row < HINGE_SPRING ? row : 2]};
}

/* From the centre of mass to the point when the body is at an angle. */
static void arm_at(const struct rigid_body *body, const double at[2], double angle, double arm[2])
{
    const double x = at[0] - body->centre[0], y = at[1] - body->centre[1];
    const double c = elementary_cos(angle), s = elementary_sin(angle);
    arm[0] = c * x - s * y;
    arm[1] = s * x + c * y;
}

static void find_rows(const struct rigid *rigid, struct rigid_hinge *h)
{
    memset(h->along, 0, sizeof h->along);
    for (int side = 0; side < 2; side++) {
        if (h->body[side] < 0) continue;
        const double sign = side ? -1 : 1;
        double arm[2];
        arm_at(&rigid->body[h->body[side]], h->at, rigid->state[h->body[side]].x[2], arm);
        h->along[0][side][0] = h->along[1][side][1] = h->along[2][side][2] = sign;
        h->along[0][side][2] = -sign * arm[1];
        h->along[1][side][2] = sign * arm[0];
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

static bool is_driven(const struct rigid_hinge *h, int row)
{
    return row == HINGE_SPRING && h->drive >= 0;
}

void rigid_hinges_begin(struct rigid *rigid, double time)
{
    for (int k = 0; k < rigid->n_hinges; k++) {
        struct rigid_hinge *const h = &rigid->hinge[k];
        const struct motion_state wall = motion_at(rigid->scene, h->wall_motion, time);
        memset(h->impulse, 0, sizeof h->impulse);
        find_rows(rigid, h);
        find_drive(rigid, h);
        h->angle = -wall.angle;
        h->rate = -wall.rate;
        h->wall_rate = wall.rate;
        for (int side = 0; side < 2; side++) {
            if (h->body[side] < 0) continue;
            h->angle += (side ? -1 : 1) * rigid->state[h->body[side]].x[2];
            h->rate += (side ? -1 : 1) * rigid->eq[h->body[side]].before[2];
        }
    }
}

/* Where a step takes the point of a hinge on a body. */
static void place_after(const struct rigid *rigid, int k, const double at[2], double late,
                        double place[2])
{
    const struct rigid_body *const body = &rigid->body[k];
    double x[3], arm[2];
    for (int c = 0; c < 3; c++) x[c] = rigid->state[k].x[c] + rigid_way(rigid, k, c, late);
    if (body->fixed) rigid_follow_hinge(rigid, k, rigid->end, x);
    arm_at(body, at, x[2], arm);
    for (int c = 0; c < 2; c++) place[c] = body->centre[c] + x[c] + arm[c];
}

/* T-99a: what is left of the distance of both places, or of the driven angle, after the step, as a
 * velocity. */
static double left_over(const struct rigid *rigid, const struct rigid_hinge *h, int row,
                        double late)
{
    double left = row == HINGE_SPRING ? -h->end_angle : 0;
    for (int side = 0; side < 2; side++) {
        const int k = h->body[side];
        if (k < 0) continue;
        double place[3] = {0, 0, rigid->state[k].x[2] + rigid_way(rigid, k, 2, late)};
        if (row < HINGE_SPRING) place_after(rigid, k, h->at, late, place);
        left += side ? -place[row] : place[row];
    }
    return left / late;
}

/* Changes of the relative velocity below this are round-off: of velocities and places. */
static double round_off(const struct rigid *rigid, struct rigid_row r,
                        const struct rigid_step *step)
{
    double speed = 0, size = 0;
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < 3 && r.body[side] >= 0; c++) {
            const struct rigid_equations *const eq = &rigid->eq[r.body[side]];
            const struct rigid_body *const body = &rigid->body[r.body[side]];
            speed += fabs(r.along[side][c]) * (fabs(eq->before[c]) + fabs(eq->change[c]));
            size += fabs(rigid->state[r.body[side]].x[c]) + (c < 2 ? fabs(body->centre[c]) : 0);
        }
    return 1e-15 * (speed + size / step->late);
}

/* Changes one impulse to what its own equation asks for. Returns the change of the velocity. */
static double relax_row(struct rigid *rigid, struct rigid_hinge *h, int row, enum rigid_stage stage,
                        const struct rigid_step *step)
{
    const struct rigid_row r = row_along(h, row);
    const double a = rigid_row_yields(rigid, r, stage),
                 most = step->kick * h->given->hinge_friction;
    double more;
    if (!(a > 0)) return 0;
    if (stage != RIGID_STEP) {
        more = -rigid_row_change(rigid, r, stage) / a;
    } else if (row < HINGE_SPRING || is_driven(h, row)) {
        more = -left_over(rigid, h, row, step->late) / a;
    } else if (row == HINGE_SPRING) {
        const double K = h->given->hinge_stiffness, C = h->given->hinge_damping;
        const double e = step->kick * (0.25 * step->dt * K + 0.5 * C);
        const double change = rigid_row_rate(rigid, r, stage) - h->wall_rate - h->rate;
        more = -(h->impulse[row] + step->kick * (K * h->angle + C * h->rate) + e * change) /
               (1 + e * a);
    } else {
        const double rate = rigid_row_rate(rigid, r, stage) - h->wall_rate;
        more = max2(-most, min2(most, h->impulse[row] - rate / a)) - h->impulse[row];
    }
    rigid_row_push(rigid, r, stage, more);
    if (stage != RIGID_PUSH) h->impulse[row] += more;
    return max2(0, fabs(more) * a - round_off(rigid, r, step));
}

static bool has_row(const struct rigid_hinge *h, int row, enum rigid_stage stage)
{
    const struct scene_rigid *const given = h->given;
    if (row < HINGE_SPRING) return joins_bodies(h);
    if (is_driven(h, row)) return true;
    if (stage != RIGID_STEP) return false;
    return row == HINGE_SPRING ? given->hinge_stiffness > 0 || given->hinge_damping > 0
                               : given->hinge_friction > 0;
}

double rigid_hinges_relax(struct rigid *rigid, enum rigid_stage stage,
                          const struct rigid_step *step)
{
    double largest = 0;
    for (int k = 0; k < rigid->n_hinges; k++)
        for (int row = 0; row < HINGE_ROWS; row++)
            if (has_row(&rigid->hinge[k], row, stage))
                largest = max2(largest, relax_row(rigid, &rigid->hinge[k], row, stage, step));
    return largest;
}

/* The force of a hinge is a reaction of the body that has it, and a load of the other. */
void rigid_hinges_load(struct rigid *rigid)
{
    for (int k = 0; k < rigid->n_hinges; k++) {
        const struct rigid_hinge *const h = &rigid->hinge[k];
        for (int row = 0; row < HINGE_ROWS; row++)
            for (int side = row < HINGE_SPRING || is_driven(h, row); side < 2; side++)
                for (int c = 0; c < 3 && h->body[side] >= 0; c++)
                    rigid->eq[h->body[side]].impulse[c] +=
                        h->impulse[row] * row_along(h, row).along[side][c];
    }
}

/* The reaction of the second body is that of its own hinge. */
static void hold_row(struct rigid *rigid, struct rigid_row r, double impulse, double kick)
{
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < 3 && r.body[side] >= 0; c++) {
            struct rigid_state *const s = &rigid->state[r.body[side]];
            for (int e = 0; e < 3; e++)
                s->v[c] += rigid->eq[r.body[side]].alone[c][e] * r.along[side][e] * impulse;
            if (side && kick > 0) s->reaction[c] -= r.along[side][c] * impulse / kick;
        }
}

/* Returns the change of the velocity, 0: below round-off. */
static double hold_hinge(struct rigid *rigid, struct rigid_hinge *h, int row, double kick)
{
    const struct rigid_row r = row_along(h, row);
    const double a = rigid_row_yields(rigid, r, RIGID_IMPACT);
    double rate = row == HINGE_SPRING ? -h->end_rate : 0, speed = fabs(rate);
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < 3 && h->body[side] >= 0; c++) {
            const double v = r.along[side][c] * rigid->state[h->body[side]].v[c];
            rate += v;
            speed += fabs(v);
        }
    if (!(a > 0)) return 0;
    hold_row(rigid, r, -rate / a, kick);
    h->impulse[row] -= rate / a;
    return max2(0, fabs(rate) - 1e-15 * speed);
}

/* T-99a: velocities after the step, which the hinges allow where the bodies are. */
void rigid_hinges_hold(struct rigid *rigid, double time, double kick)
{
    double largest = 1, first = 0;
    for (int k = 0; k < rigid->n_hinges; k++) {
        find_rows(rigid, &rigid->hinge[k]);
        find_drive(rigid, &rigid->hinge[k]);
    }
    for (int k = 0; k < rigid->n && rigid->n_hinges; k++) rigid_find_alone(rigid, k, time);
    for (int turn = 0; turn < 1000 && largest > 1e-12 * first; turn++) {
        largest = 0;
        for (int k = 0; k < rigid->n_hinges; k++)
            for (int row = 0; row <= HINGE_SPRING; row++)
                if (has_row(&rigid->hinge[k], row, RIGID_PUSH))
                    largest = max2(largest, hold_hinge(rigid, &rigid->hinge[k], row, kick));
        if (turn == 0) first = largest;
    }
}

void rigid_hinges_work(struct rigid *rigid)
{
    for (int k = 0; k < rigid->n_hinges; k++) {
        const struct rigid_hinge *const h = &rigid->hinge[k];
        for (int row = 0; row < HINGE_ROWS; row++) {
            double work[2] = {0};
            for (int side = 0; side < 2; side++)
                for (int c = 0; c < 3 && h->body[side] >= 0; c++)
                    work[side] += h->impulse[row] * row_along(h, row).along[side][c] *
                                  rigid->body[h->body[side]].mean[c];
            if (is_driven(h, row))
                rigid->body[h->body[0]].driven += work[0] + work[1];
            else if (row >= HINGE_SPRING)
                rigid->body[h->body[0]].driven += h->impulse[row] * h->wall_rate;
            if (!joins_bodies(h)) continue;
            rigid->body[h->body[0]].passed -= work[1];
            rigid->body[h->body[1]].passed += work[1];
        }
    }
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
        const double other = joins_bodies(h) ? rigid->state[h->body[1]].x[2]
                                             : motion_at(rigid->scene, h->wall_motion, time).angle;
        sum += 0.5 * h->given->hinge_stiffness * square(rigid->state[k].x[2] - other);
    }
    return sum;
}
