/* SPDX-License-Identifier: MIT
 * Springs and mooring lines from a beam to a place (T-108). */
#include "beam/beam.h"

/* The vector from the end in place to a displaced node; returns its length. */
static double reach_of(const struct beams *beams, const struct beam_spring *s, const double x[2],
                       double reach[2])
{
    for (int c = 0; c < 2; c++) reach[c] = beams->node[s->node].X[c] + x[c] - s->given->to[c];
    return max2(elementary_hypot(reach[0], reach[1]), 1e-300);
}

/* A line that only pulls has no energy while it is slack. */
static double elongation_of(const struct beam_spring *s, double length)
{
    const double elongation = length - s->length;
    return s->given->slack ? max2(elongation, 0) : elongation;
}

/* Adds stiffnesses along a direction and across it. */
static void add_stiffness(struct beams *beams, int k, const double along[2], double stiff,
                          double across)
{
    const struct beam_node *const node = &beams->node[k];
    for (int c = 0; c < 2; c++)
        for (int e = 0; e <= c; e++) {
            const double own = along[c] * along[e];
            if (node->unknown[c] >= 0 && node->unknown[e] >= 0)
                envelope_add(&beams->matrix, node->unknown[c], node->unknown[e],
                             stiff * own + across * ((c == e) - own));
        }
}

void beams_stiffen(struct beams *beams)
{
    for (int k = 0; k < beams->n_springs; k++) {
        const struct beam_spring *const s = &beams->spring[k];
        double along[2];
        if (s->node < 0) continue;
        const double length = reach_of(beams, s, beams->state[s->node].x, along),
                     elongation = elongation_of(s, length);
        for (int c = 0; c < 2; c++) along[c] /= length;
        add_stiffness(beams, s->node, along, 0.5 * spring_slope(s->given, elongation),
                      0.5 * max2(spring_force(s->given, elongation), 0) / length);
    }
}

/* Below omega^2 m, for the mass m of the whole beam, a spring moves its lowest frequency little. */
void beams_set_stiffness(struct beams *beams, int spring, double omega2)
{
    struct beam_spring *const s = &beams->spring[spring];
    double reach[2], mass = 0;
    if (s->node < 0) return;
    for (int k = 0; k < beams->n_nodes; k++)
        if (beams->node[k].beam == beams->node[s->node].beam) mass += beams->node[k].mass[0];
    const double elongation = elongation_of(s, reach_of(beams, s, beams->state[s->node].x, reach));
    s->stiffness = max2(spring_slope(s->given, elongation), omega2 * mass);
}

/* Springs r times as stiff raise no frequency by more than sqrt(r). */
double beams_stiffer_step(const struct beams *beams)
{
    double most = 1, reach[2];
    for (int k = 0; k < beams->n_springs; k++) {
        const struct beam_spring *const s = &beams->spring[k];
        if (s->node < 0 || !s->given->force.e[0]) continue;
        const double elongation =
            elongation_of(s, reach_of(beams, s, beams->state[s->node].x, reach));
        most = max2(most, spring_slope(s->given, elongation) / s->stiffness);
    }
    return 1 / sqrt(most);
}

/* T-108 */
static void add_spring(struct beams *beams, struct beam_spring *s, double dt, double *rounding)
{
    struct beam_step *const step = &beams->step[s->node];
    const double after[2] = {step->x[0] + step->d[0], step->x[1] + step->d[1]};
    double reach[2][2], along[2];
    const double l0 = reach_of(beams, s, step->x, reach[0]),
                 l1 = reach_of(beams, s, after, reach[1]);
    const double e0 = elongation_of(s, l0), e1 = elongation_of(s, l1);
    const double taut = l0 == l1 ? e1 != 0 || !s->given->slack : (e1 - e0) / (l1 - l0),
                 stiff = 0.5 * taut * spring_slope(s->given, e1), damp = s->given->damping / dt,
                 tension = spring_mean(s->given, e0, e1, taut) + damp * (l1 - l0);
    s->elongation = e1;
    if (s->given->slack && (taut == 0 || tension <= 0)) return;
    for (int c = 0; c < 2; c++) {
        along[c] = (reach[0][c] + reach[1][c]) / (l0 + l1);
        step->touch[c] -= tension * along[c];
    }
    *rounding =
        max2(*rounding, (stiff + damp) * (l1 + fabs(s->given->to[0]) + fabs(s->given->to[1])));
    add_stiffness(beams, s->node, along, stiff + damp, max2(tension, 0) / (l0 + l1));
}

void beams_add_springs(struct beams *beams, double dt, double *rounding)
{
    for (int k = 0; k < beams->n_springs; k++)
        if (beams->spring[k].node >= 0) add_spring(beams, &beams->spring[k], dt, rounding);
}

void beam_add_spring_energy(const struct beams *beams, int beam, struct body_energy *sum)
{
    double reach[2];
    for (int k = 0; k < beams->n_springs; k++) {
        const struct beam_spring *const s = &beams->spring[k];
        if (s->node < 0 || beams->node[s->node].beam != beam) continue;
        const double length = reach_of(beams, s, beams->state[s->node].x, reach);
        spring_add_energy(s->given, elongation_of(s, length), sum);
    }
}

bool beam_spring_force(const struct beams *beams, int spring, double force[2])
{
    double reach[2], rate = 0;
    if (spring >= beams->n_springs || beams->spring[spring].node < 0) return false;
    const struct beam_spring *const s = &beams->spring[spring];
    const struct beam_state *const now = &beams->state[s->node];
    const double length = reach_of(beams, s, now->x, reach), elongation = elongation_of(s, length);
    for (int c = 0; c < 2; c++) rate += reach[c] / length * now->v[c];
    const double tension = spring_force(s->given, elongation) + s->given->damping * rate;
    const bool loose = s->given->slack && (elongation == 0 || tension <= 0);
    for (int c = 0; c < 2; c++) force[c] = loose ? 0 : tension * reach[c] / length;
    return true;
}
