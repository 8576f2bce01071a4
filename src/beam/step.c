/* SPDX-License-Identifier: MIT
 * Implicit steps of beams (T-104): the midpoint rule with forces of which the work is exactly the
 * change of energy, solved by Newton's method. */
#include "beam/beam.h"
#include "geometry/motion.h"

#include <float.h>

/* Newton's method ends at this residual over the largest force; round-off over that stiffness. */
#define TOLERANCE 1e-9
#define ROUNDING (64 * DBL_EPSILON)

/* Limits of the effort before the step is halved, and before the run stops. */
enum { ITERATIONS = 40, HALVINGS = 6 };

/* --- outside --- */

/* What acts from outside, with the values at the middle of the step. Dead loads. */
static void find_loads(struct beams *beams, double middle)
{
    double gravity[2];
    scene_gravity_at(beams->scene, middle, gravity);
    for (int k = 0; k < beams->n_nodes; k++) {
        const struct beam_node *const node = &beams->node[k];
        const bool heavy = beams->beam[node->beam].given->gravity;
        double *const load = beams->step[k].load;
        for (int c = 0; c < 2; c++) load[c] = heavy ? node->mass[c] * gravity[c] : 0;
        load[2] = 0;
    }
    for (int n = 0; n < beams->n_loads; n++) {
        const struct beam_load *const l = &beams->load[n];
        const struct scene_load *const from = &beams->scene->load[l->section];
        const struct scene_expr *const value = from->traction.e[0] ? &from->traction : &from->force;
        const double *const X = beams->node[l->node].X, t = max2(middle, 0);
        const double factor = from->history.e[0] ? expr_at_arg(from->history.e[0], t) : 1;
        double own[3] = {0};
        for (int c = 0; c < 2 && value->e[c]; c++)
            own[c] = factor * (from->traction.e[0] ? l->length : l->part) *
                     expr_at_time(value->e[c], X[0], X[1], t);
        if (from->moment.e[0])
            own[2] = factor * l->part * expr_at_time(from->moment.e[0], X[0], X[1], t);
        for (int c = 0; c < 3; c++) beams->step[l->node].load[c] += own[c];
        if (!isfinite(own[0] + own[1] + own[2])) beams->infinite = l->section + 1;
    }
}

/* Where a clamp or hinge has its node at a time, relative to the start. */
static void place_held(const struct beams *beams, int k, double time, double x[3], double v[3])
{
    const struct beam_node *const node = &beams->node[k];
    memset(x, 0, 3 * sizeof *x);
    memset(v, 0, 3 * sizeof *v);
    if (node->mover < 0) return;
    const struct motion_state m = motion_at(beams->scene, node->mover, time);
    const struct motion_point at = motion_of_point(&m, node->X[0], node->X[1]);
    for (int c = 0; c < 2; c++) {
        x[c] = at.x[c] - node->X[c];
        v[c] = at.v[c];
    }
    x[2] = m.angle;
    v[2] = m.rate;
}

/* --- equations --- */

/* The largest of residual and forces, moments by the length of an element, N/m. */
struct largest {
    double off, force, rounding;
};

static void find_start(struct beams *beams)
{
    for (int m = 0; m < beams->n_elements; m++) {
        const struct beam_element *const e = &beams->element[m];
        struct beam_start *const to = &beams->start[m];
        const double *const q[2] = {beams->state[e->node[0]].x, beams->state[e->node[1]].x};
        beam_strain(e, q, to->strain, to->turn);
        for (int c = 0; c < 2; c++) to->apart[c] = e->between[c] + (q[1][c] - q[0][c]);
    }
}

/* Adds the derivative of an element's forces to the matrix. */
static void add_matrix(const struct beams *beams, const struct beam_element *e, double matrix[6][6])
{
    for (int r = 0; r < 6; r++)
        for (int c = 0; c < 6; c++) {
            const int64_t row = beams->node[e->node[r / 3]].unknown[r % 3],
                          column = beams->node[e->node[c / 3]].unknown[c % 3];
            if (row >= 0 && column >= 0 && column <= row)
                envelope_add(&beams->matrix, row, column, matrix[r][c]);
        }
}

/* T-105: the fluid's resistance at an element. */
static void add_resistance(struct beams *beams, int m, double dt)
{
    const int *const node = beams->element[m].node;
    double matrix[6][6];
    for (int r = 0; r < 6; r++)
        for (int c = 0; c < 6; c++) {
            const struct beam_step *const s = &beams->step[node[c / 3]];
            matrix[r][c] = beams->added[m][r][c] / dt;
            beams->step[node[r / 3]].resisted[r % 3] +=
                matrix[r][c] * (s->d[c % 3] - dt * s->w[c % 3]);
        }
    add_matrix(beams, &beams->element[m], matrix);
}

/* Forces and matrix of all elements for the present displacements. */
static void add_elements(struct beams *beams, double dt, struct largest *most)
{
    envelope_clear(&beams->matrix);
    for (int k = 0; k < beams->n_nodes; k++) {
        memset(beams->step[k].force, 0, sizeof beams->step[k].force);
        memset(beams->step[k].resisted, 0, sizeof beams->step[k].resisted);
    }
    for (int m = 0; m < beams->n_elements; m++) {
        const struct beam_element *const e = &beams->element[m];
        struct beam_step *const at[2] = {&beams->step[e->node[0]], &beams->step[e->node[1]]};
        const double *const w[2] = {at[0]->w, at[1]->w};
        double force[2][3], matrix[6][6];
        beam_force(e, &beams->start[m], (const double *[2]){at[0]->d, at[1]->d},
                   beams->line ? w : NULL, dt, force, matrix);
        for (int r = 0; r < 6; r++) at[r / 3]->force[r % 3] += force[r / 3][r % 3];
        for (int c = 0; c < 2; c++) most->force = max2(most->force, fabs(force[1][c]));
        most->force = max2(most->force, fabs(force[1][2]) / e->length);
        most->rounding = max2(most->rounding, e->stiffness[0] * (1 + fabs(at[1]->x[0] / e->length) +
                                                                 fabs(at[1]->x[1] / e->length)));
        add_matrix(beams, e, matrix);
        if (beams->line) add_resistance(beams, m, dt);
    }
}

/* Inertia and damping by mass of a component of a node against its displacement (T-104). */
static double inertia(const struct beams *beams, int k, int c, double dt)
{
    const struct beam_node *const node = &beams->node[k];
    const struct beam_step *const s = &beams->step[k];
    const double mean = s->d[c] / dt;
    return node->mass[c] *
           (2 * (mean - s->v[c]) / dt + beams->beam[node->beam].given->mass_damping * mean);
}

/* The residual of T-104 to `unknown`, and its matrix. */
static struct largest find_residual(struct beams *beams, double dt)
{
    struct largest most = {0};
    add_elements(beams, dt, &most);
    beams_clear_rows(beams);
    beams_add_pairs(beams);
    beams_add_joints(beams);
    beams_add_springs(beams, dt, &most.rounding);
    memset(beams->unknown, 0, (size_t)beams->size * sizeof *beams->unknown);
    beams_find_bodies(beams, dt);
    for (int k = 0; k < beams->n_nodes; k++) {
        const struct beam_node *const node = &beams->node[k];
        const struct beam_step *const s = &beams->step[k];
        for (int c = 0; c < 3; c++) {
            if (node->unknown[c] < 0) continue;
            const double scale = c < 2 ? 1 : 1 / node->length, push = inertia(beams, k, c, dt);
            const double off =
                s->load[c] + s->fluid[c] + s->touch[c] - s->force[c] - s->resisted[c] - push;
            const double stiff =
                node->mass[c] / dt * (2 / dt + beams->beam[node->beam].given->mass_damping);
            beams->unknown[node->unknown[c]] += off;
            envelope_add(&beams->matrix, node->unknown[c], node->unknown[c], stiff);
            most.force = max2(most.force, scale * max2(fabs(s->load[c] + s->touch[c]), fabs(push)));
            most.force = max2(most.force, scale * max2(fabs(s->fluid[c]), fabs(s->resisted[c])));
            most.rounding =
                max2(most.rounding, scale * stiff * (fabs(s->d[c]) + dt * fabs(s->v[c])));
        }
    }
    for (int k = 0; k < beams->n_nodes; k++)
        for (int c = 0; c < 3; c++) {
            const int64_t row = beams->node[k].unknown[c];
            const double scale = c < 2 ? 1 : 1 / beams->node[k].length;
            const double off = row >= 0 ? scale * fabs(beams->unknown[row]) : 0;
            most.off = isfinite(off) ? max2(off, most.off) : (double)NAN;
        }
    return most;
}

static bool correct(struct beams *beams)
{
    envelope_solve(&beams->matrix, beams->unknown);
    beams_correct_joints(beams);
    if (!beams_correct_pairs(beams)) return false;
    for (int k = 0; k < beams->n_nodes; k++)
        for (int c = 0; c < 3; c++)
            if (beams->node[k].unknown[c] >= 0)
                beams->step[k].d[c] += beams->unknown[beams->node[k].unknown[c]];
    beams_move_bodies(beams);
    return true;
}

/* Newton's method; the matrix is found anew for each correction. */
static bool solve(struct beams *beams, double dt)
{
    for (int n = 0; n <= ITERATIONS; n++) {
        const struct largest most = find_residual(beams, dt);
        beams->residual = most.force > 0 ? most.off / most.force : 0;
        if (most.off <= TOLERANCE * most.force + ROUNDING * most.rounding &&
            beams_keep_apart(beams) && beams_stay_joined(beams))
            return true;
        if (n == ITERATIONS || !isfinite(most.off) || envelope_factor(&beams->matrix) < 0)
            return false;
        if (!correct(beams)) return false;
        beams->iterations++;
    }
    return false;
}

/* --- a step --- */

/* The first guess: held nodes where they will be, the others by their present velocity. */
static void begin(struct beams *beams, double time, double dt)
{
    find_start(beams);
    for (int k = 0; k < beams->n_nodes; k++) {
        struct beam_step *const s = &beams->step[k];
        const struct beam_state *const now = &beams->state[k];
        double x[3], v[3];
        memcpy(s->x, now->x, sizeof s->x);
        memcpy(s->v, now->v, sizeof s->v);
        memcpy(s->w, now->w, sizeof s->w);
        place_held(beams, k, time + dt, x, v);
        for (int c = 0; c < 3; c++) {
            s->d[c] = dt * s->v[c];
            if (beams->node[k].unknown[c] >= 0) continue;
            s->d[c] = c < 2 ? x[c] - s->x[c] : 2 * elementary_tan(0.5 * (x[c] - s->x[c]));
        }
    }
    beams_find_pairs(beams, time, dt);
}

/* What a node's clamp or hinge adds to the other forces, and the work of that and of loads. */
static double finish_held(struct beams *beams, int k, const double v[3], double dt)
{
    const struct beam_node *const node = &beams->node[k];
    const struct beam_step *const s = &beams->step[k];
    struct beam_state *const now = &beams->state[k];
    const double damping = beams->beam[node->beam].given->mass_damping;
    double work = 0;
    for (int c = 0; c < 3; c++) {
        if (node->unknown[c] >= 0) continue;
        const double other = s->force[c] + s->resisted[c] - s->fluid[c] - s->load[c] - s->touch[c] +
                             node->mass[c] * damping * s->d[c] / dt;
        now->v[c] = v[c];
        now->reaction[c] = node->mass[c] * (v[c] - s->v[c]) / dt + other;
        work += other * s->d[c] + 0.5 * node->mass[c] * (square(v[c]) - square(s->v[c]));
    }
    return work;
}

static void finish(struct beams *beams, double time, double dt)
{
    const double *const g = beams->scene->top.gravity;
    for (int k = 0; k < beams->n_nodes; k++) {
        const struct beam_node *const node = &beams->node[k];
        const struct beam_step *const s = &beams->step[k];
        struct beam_state *const now = &beams->state[k];
        struct beam *const beam = &beams->beam[node->beam];
        double x[3], v[3];
        for (int c = 0; c < 3; c++) now->v[c] = 2 * s->d[c] / dt - s->v[c];
        for (int c = 0; c < 2; c++) now->x[c] += s->d[c];
        now->x[2] += s->d[2] * beam_atan_over(0.5 * s->d[2]);
        place_held(beams, k, time + dt, x, v);
        for (int c = 0; c < 3; c++) {
            const double heavy = c < 2 && beam->given->gravity ? node->mass[c] * g[c] : 0;
            if (node->unknown[c] < 0) now->x[c] = x[c];
            now->reaction[c] = 0;
            beam->driven += (s->load[c] - heavy) * s->d[c];
        }
        beam->driven += finish_held(beams, k, v, dt);
        for (int c = 0; c < 3 && !beams->line; c++) now->a[c] = (now->v[c] - s->v[c]) / dt;
    }
}

/* A step, or two of half its length where it has no solution. */
static bool step(struct beams *beams, double time, const struct beam_times *times, int halvings)
{
    const double dt = times->dt;
    find_loads(beams, time + 0.5 * dt);
    if (beams->line) beams_find_fluid(beams, times);
    beams_begin_joints(beams);
    beams_begin_bodies(beams, time, dt);
    begin(beams, time, dt);
    if (solve(beams, dt)) {
        finish(beams, time, dt);
        beams_finish_pairs(beams, dt);
        beams_finish_joints(beams, dt);
        beams_finish_bodies(beams, dt);
        if (beams->line) beams_return_impulse(beams, times);
        return true;
    }
    if (halvings == 0) return false;
    const double half = 0.5 * dt, rates_time = 0.5 * times->rates_time;
    return step(beams, time, &(struct beam_times){half, times->last, rates_time}, halvings - 1) &&
           step(beams, time + half, &(struct beam_times){half, half, rates_time}, halvings - 1);
}

void beams_advance(struct beams *beams, double time, const struct beam_times *times)
{
    beams->iterations = 0;
    for (int k = 0; k < beams->n; k++) beams->beam[k].driven = beams->beam[k].received = 0;
    beams_give_rest(beams, times->last);
    beams_take_bodies(beams, time, times->dt);
    beams->failed |= !step(beams, time, times, HALVINGS);
    beams_return_joints(beams, times->dt);
    beams_return_bodies(beams, times->dt);
}

/* --- the longest period --- */

/* Motions that bend nothing, of beams that are not joined. */
static int64_t count_free(const struct beams *beams)
{
    int64_t n = 0;
    for (int k = 0; k < beams->n; k++) {
        int hinges = 0, clamps = 0;
        for (int j = beams->beam[k].first_node; j < beams->beam[k].end_node; j++) {
            hinges += beams->node[j].unknown[0] < 0;
            clamps += beams->node[j].unknown[2] < 0;
        }
        n += clamps || hinges > 1 ? 0 : hinges ? 1 : 3;
    }
    return n;
}

/* Frequencies below omega, of beams as at the start (Sylvester), with springs or without. */
static int64_t count_below(struct beams *beams, double omega2, bool springs)
{
    struct largest most = {0};
    for (int k = 0; k < beams->n_nodes; k++) memset(beams->step[k].d, 0, sizeof *beams->step[k].d);
    add_elements(beams, (double)INFINITY, &most);
    if (springs) beams_stiffen(beams);
    for (int k = 0; k < beams->n_nodes; k++)
        for (int c = 0; c < 3; c++) {
            const int64_t row = beams->node[k].unknown[c];
            if (row >= 0)
                envelope_add(&beams->matrix, row, row, -0.5 * omega2 * beams->node[k].mass[c]);
        }
    return envelope_factor(&beams->matrix);
}

/* As of solids, a hundredth of the longest period (T-93): that which bends beams without springs,
 * or that of beams with springs if this is shorter. Soft springs add long periods, in which beams
 * move as a whole. Stiff ones shorten those that bend. */
double beams_longest_step(struct beams *beams)
{
    enum { PARTS = 100 };
    bool joined = false;
    const double *const g = beams->scene->top.gravity;
    double high = 0, length = 0;
    find_start(beams);
    for (int m = 0; m < beams->n_elements; m++) {
        const struct beam_element *const e = &beams->element[m];
        const double mass = min2(beams->node[e->node[0]].mass[0], beams->node[e->node[1]].mass[0]);
        high = max2(high, 4 * e->stiffness[0] / (e->length * mass));
        length += e->length;
    }
    double low = ROUNDING * high;
    for (int k = 0; k < beams->n_nodes; k++) joined |= beams->node[k].joined[0] >= 0;
    const int64_t free[] = {joined ? count_below(beams, low, false) : count_free(beams),
                            count_below(beams, low, true)};
    while (high > 1.01 * low) {
        const double middle = sqrt(low * high);
        const bool above = count_below(beams, middle, false) > free[0] &&
                           (beams->n_springs == 0 || count_below(beams, middle, true) > free[1]);
        *(above ? &high : &low) = middle;
    }
    for (int k = 0; k < beams->n_springs; k++) beams_set_stiffness(beams, k, high);
    const double swing = max2(elementary_hypot(g[0], g[1]) / length, 1e-300);
    return min2(2 * PI / sqrt(high), 2 * PI / sqrt(swing)) / PARTS;
}
