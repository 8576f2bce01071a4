/* SPDX-License-Identifier: MIT
 * Beams in fluid: lines and dummies that follow them, force and resistance of the fluid, and
 * the impulse that it has still to receive (T-105, T-111a). */
#include "beam/beam.h"

static double impedance(const struct beams *beams) { return beams->scene->rho0 * beams->scene->c0; }

/* T-111a: the first node that is held or on a rigid body carries the beam along. Without any, each
 * node does by its mass, and less for a beam lighter than a particle of fluid. */
static void find_carriers(const struct beams *beams, const struct beam *b)
{
    double mass = 0, *const carries = beams->carries;
    for (int k = b->first_node; k < b->end_node; k++) mass += beams->node[k].mass[0];
    for (int k = b->first_node; k < b->end_node; k++) {
        if (beams->node[k].unknown[0] < 0 || beams->node[k].body >= 0) {
            memset(&carries[b->first_node], 0, (size_t)(k - b->first_node) * sizeof *carries);
            carries[k] = 1;
            return;
        }
        carries[k] =
            beams->node[k].mass[0] / max2(mass, beams->scene->rho0 * square(beams->scene->top.dp));
    }
}

enum err beams_wet_create(struct beams *beams, struct arena *a, struct lines *lines,
                          struct particles *walls, double stage, bool alternates, struct diag *d)
{
    static const char what[] = "beams";
    beams->stage = stage;
    beams->alternates = alternates;
    const size_t n = (size_t)beams->n_elements;
    beams->walls = walls;
    TRY(arena_array(a, &beams->added, n, what, d));
    TRY(arena_array(a, &beams->line, beams->n, what, d));
    TRY(arena_array(a, &beams->carries, beams->n_nodes, what, d));
    for (int k = 0; k < lines->n; k++) {
        const int beam = lines->line[k].given->wall - scene_beam_wall(beams->scene, 0);
        if (beam < 0) continue;
        beams->line[beam] = &lines->line[k];
        beams->line[beam]->bends = true;
        find_carriers(beams, &beams->beam[beam]);
    }
    /* Longer than any step. */
    for (int k = 0; k < beams->n_nodes; k++)
        beams->state[k].exchange_time = beams->scene->h / beams->scene->c0;
    beams_place(beams, 0);
    return ERR_OK;
}

/* --- the beam as the fluid sees it --- */

static void place_end(const struct beams *beams, const struct beam_element *e, int last,
                      double since, struct line_end *end)
{
    const struct beam_node *const node = &beams->node[e->node[last]];
    const struct beam_state *const s = &beams->state[e->node[last]];
    double x[3];
    for (int c = 0; c < 3; c++) x[c] = s->x[c] + since * s->w[c];
    const double cosine = elementary_cos(x[2]), sine = elementary_sin(x[2]);
    const double t[2] = {e->between[0] / e->length, e->between[1] / e->length};
    *end = (struct line_end){
        .x = {node->X[0] + x[0], node->X[1] + x[1]},
        .normal = {-(sine * t[0] + cosine * t[1]), cosine * t[0] - sine * t[1]},
        .v = {s->w[0], s->w[1]},
        .rate = s->w[2],
        .a = {s->a[0], s->a[1]},
        .angular_acceleration = s->a[2],
    };
}

/* The largest displacement of a dummy of a line from one place of its end to the other, m. */
static double displacement_between(const struct beams *beams, const struct scene_thin_line *line,
                                   const struct line_end *from, const struct line_end *to)
{
    const double deep = max2(line->half, KERNEL_REACH * beams->scene->h + beams->scene->top.dp);
    return elementary_hypot(to->x[0] - from->x[0], to->x[1] - from->x[1]) +
           2 * deep *
               elementary_hypot(to->normal[0] - from->normal[0], to->normal[1] - from->normal[1]);
}

/* The squared radius of gyration of a node's own mass, m^2. It is 0 where the mass of a beam is
 * given. The least value keeps the division by the inertia of a single node finite. */
static double gyration2(const struct beam_node *node)
{
    return max2(node->mass[2] / node->mass[0], 1e-30);
}

/* From the centre of a beam's carrier to a node. */
static void arm_to(const struct beams *beams, const struct line_carrier *carrier, int node,
                   double arm[2])
{
    for (int c = 0; c < 2; c++)
        arm[c] = beams->node[node].X[c] + beams->state[node].x[c] - carrier->x[c];
}

/* T-111a: the rigid motion with the momentum and the angular momentum of the masses c_i. */
static struct line_carrier carrier_of(const struct beams *beams, const struct beam *b)
{
    struct line_carrier carrier = {0};
    double sum = 0, second = 0, arm[2];
    for (int m = b->first_node; m < b->end_node; m++) sum += beams->carries[m];
    for (int m = b->first_node; m < b->end_node; m++)
        for (int c = 0; c < 2; c++) {
            const double share = beams->carries[m];
            carrier.x[c] += share / sum * (beams->node[m].X[c] + beams->state[m].x[c]);
            carrier.v[c] += share * beams->state[m].w[c];
            carrier.a[c] += share * beams->state[m].a[c];
        }
    for (int m = b->first_node; m < b->end_node; m++) {
        const double share = beams->carries[m], own = gyration2(&beams->node[m]);
        const double *const w = beams->state[m].w, *const a = beams->state[m].a;
        arm_to(beams, &carrier, m, arm);
        second += share * (square(arm[0]) + square(arm[1]) + own);
        carrier.spin += share * (arm[0] * w[1] - arm[1] * w[0] + own * w[2]);
        carrier.spin_rate += share * (arm[0] * a[1] - arm[1] * a[0] + own * a[2]);
    }
    carrier.mass_over_inertia = sum / second;
    carrier.spin *= carrier.mass_over_inertia;
    carrier.spin_rate *= carrier.mass_over_inertia;
    return carrier;
}

double beams_place(struct beams *beams, double since)
{
    double largest = 0;
    for (int k = 0; k < beams->n; k++) {
        const struct beam *const b = &beams->beam[k];
        struct thin_line *const line = beams->line[k];
        line->carrier = carrier_of(beams, b);
        for (int m = b->first_element; m < b->end_element; m++)
            for (int last = 0; last < 2; last++) {
                struct line_end *const end = &line->end[2 * (m - b->first_element) + last],
                                       before = *end;
                place_end(beams, &beams->element[m], last, since, end);
                largest = max2(largest, displacement_between(beams, line->given, &before, end));
            }
        line_place(line, beams->walls, since != 0);
    }
    return largest;
}

/* --- exchange --- */

/* The nodes of the part of dummy j, and its element. */
static int element_of(const struct beams *beams, int beam, int64_t j)
{
    return beams->beam[beam].first_element + beams->line[beam]->given->dummy[j].part;
}

/* The part across the beam of a vector at a dummy, to its ends; adds that along it, and its moment
 * about the centre of the carrier, to `along`. */
static void across(const struct thin_line *line, int64_t j, double x, double y, double to[6],
                   double along[3])
{
    double t[2], foot[2];
    line_tangent(line, j, t);
    line_foot(line, j, foot);
    const double part = x * t[0] + y * t[1], *const centre = line->carrier.x;
    for (int c = 0; c < 2; c++) along[c] += part * t[c];
    along[2] += part * ((foot[0] - centre[0]) * t[1] - (foot[1] - centre[1]) * t[0]);
    line_at_ends(line, j, x - part * t[0], y - part * t[1], to);
}

/* The part across the beam of a dummy's wetted normal, at its ends; returns its area, m. */
static double wetted(const struct thin_line *line, int64_t j, const struct particles *p,
                     double normal[6])
{
    const int64_t i = line->first + j;
    double along[3] = {0};
    across(line, j, p->wet_x[i], p->wet_y[i], normal, along);
    const double area = elementary_hypot(p->wet_x[i], p->wet_y[i]);
    for (int r = 0; r < 6; r++) normal[r] /= max2(area, 1e-300);
    return area;
}

/* `along`: the pressure's force and moment that the carrier takes. */
static void add_dummy(struct beams *beams, int beam, int64_t j, double along[3])
{
    const struct thin_line *const line = beams->line[beam];
    const struct particles *const p = beams->walls;
    const int64_t i = line->first + j;
    const int element = element_of(beams, beam, j), *const node = beams->element[element].node;
    double force[6], drag[6], normal[6];
    across(line, j, p->fx[i] - p->drag_x[i], p->fy[i] - p->drag_y[i], force, along);
    line_at_ends(line, j, p->drag_x[i], p->drag_y[i], drag);
    for (int r = 0; r < 6; r++) beams->step[node[r / 3]].fluid[r % 3] += force[r] + drag[r];
    const double by = impedance(beams) * wetted(line, j, p, normal);
    for (int r = 0; r < 6; r++)
        for (int c = 0; c < 6; c++) beams->added[element][r][c] += by * normal[r] * normal[c];
}

/* T-36a: the force in the middle of the step, with all that the fluid gets for `rates_time`. */
static void extrapolate(struct beams *beams, const struct beam_times *times)
{
    const struct force_weights weights =
        force_weights(times->rates_time / times->dt, 0.5 - beams->stage, beams->alternates);
    for (int k = 0; k < beams->n_nodes; k++)
        for (int c = 0; c < 3; c++) {
            double *const force = &beams->step[k].fluid[c];
            *force = extrapolated_force(&weights, *force, *force, !(times->last > 0),
                                        &beams->state[k].pushed[c]);
        }
}

/* Gives the nodes what their carrier takes. */
static void share_out(struct beams *beams, int beam, const double along[3])
{
    const struct line_carrier *const carrier = &beams->line[beam]->carrier;
    const double turning = carrier->mass_over_inertia * along[2];
    for (int m = beams->beam[beam].first_node; m < beams->beam[beam].end_node; m++) {
        double arm[2], *const force = beams->step[m].fluid;
        arm_to(beams, carrier, m, arm);
        force[0] += beams->carries[m] * (along[0] - turning * arm[1]);
        force[1] += beams->carries[m] * (along[1] + turning * arm[0]);
        force[2] += beams->carries[m] * turning * gyration2(&beams->node[m]);
    }
}

void beams_find_fluid(struct beams *beams, const struct beam_times *times)
{
    for (int k = 0; k < beams->n_nodes; k++) {
        const struct beam_state *const now = &beams->state[k];
        for (int c = 0; c < 3; c++) beams->step[k].fluid[c] = -now->impulse[c] / now->exchange_time;
    }
    memset(beams->added, 0, (size_t)beams->n_elements * sizeof *beams->added);
    for (int k = 0; k < beams->n; k++) {
        double along[3] = {0};
        for (int64_t j = 0; j < beams->line[k]->given->n_dummies; j++)
            add_dummy(beams, k, j, along);
        share_out(beams, k, along);
    }
    extrapolate(beams, times);
}

/* T-105b: the pressure that gives the fluid the impulse: `left` of that before, and a new one in
 * the time T_e. */
static void add_pressure(struct beams *beams, int beam, int64_t j, double left, double part)
{
    const struct thin_line *const line = beams->line[beam];
    struct particles *const p = beams->walls;
    const int64_t i = line->first + j;
    const int *const node = beams->element[element_of(beams, beam, j)].node;
    double normal[6], excess = 0;
    wetted(line, j, p, normal);
    for (int r = 0; r < 6; r++) excess += normal[r] * beams->step[node[r / 3]].excess[r % 3];
    p->interface_pressure[i] =
        left * p->interface_pressure[i] - 2 * part * impedance(beams) * excess;
}

void beams_return_impulse(struct beams *beams, const struct beam_times *times)
{
    const double dt = times->dt, before = beams->state[0].exchange_time,
                 after = exchange_time_after(before, dt), left = 1 - times->rates_time / before,
                 weight =
                     acceleration_weight(beams->scene->h / beams->scene->c0, 1 + beams->stage, dt);
    for (int k = 0; k < beams->n_nodes; k++) {
        struct beam_state *const now = &beams->state[k];
        struct beam_step *const s = &beams->step[k];
        now->exchange_time = after;
        for (int c = 0; c < 3; c++) {
            now->impulse[c] = left * now->impulse[c] - dt * s->resisted[c];
            beams->beam[beams->node[k].beam].received += (s->fluid[c] - s->resisted[c]) * s->d[c];
            now->w[c] = s->d[c] / dt;
            s->excess[c] = now->w[c] - s->w[c];
            now->a[c] += weight * (s->excess[c] / (0.5 * (times->last + dt)) - now->a[c]);
        }
    }
    for (int k = 0; k < beams->n; k++)
        for (int64_t j = 0; j < beams->line[k]->given->n_dummies; j++)
            add_pressure(beams, k, j, left * before / after, dt / after);
}
