/* SPDX-License-Identifier: MIT
 * The element of a beam: strain (T-103), and force and matrix over a step (T-104). */
#include "beam/beam.h"

static double cross_product(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}
static double along(const double a[2], const double b[2]) { return a[0] * b[0] + a[1] * b[1]; }

void beam_strain(const struct beam_element *e, const double *const q[2], double strain[3],
                 double turn[2])
{
    const double angle = 0.5 * (q[0][2] + q[1][2]);
    const double c = elementary_cos(angle), s = elementary_sin(angle);
    const double apart[2] = {e->between[0] + (q[1][0] - q[0][0]),
                             e->between[1] + (q[1][1] - q[0][1])};
    turn[0] = (c * e->between[0] - s * e->between[1]) / e->length;
    turn[1] = (s * e->between[0] + c * e->between[1]) / e->length;
    strain[0] = along(turn, apart) / e->length - 1;
    strain[1] = cross_product(turn, apart) / e->length;
    strain[2] = (q[1][2] - q[0][2]) / e->length;
}

/* The series is exact to round-off. */
double beam_atan_over(double z)
{
    const double z2 = z * z;
    if (z2 > 4e-4) return elementary_atan2(z, 1) / z;
    return 1 - z2 * (1.0 / 3 - z2 * (1.0 / 5 - z2 * (1.0 / 7 - z2 * (1.0 / 9 - z2 / 11))));
}

/* T-104a, T-104b: the mean of the middle's position, its tangent after half of the rotation, and
 * the exact change of the three strains as B d. */
struct middle {
    double mean[2], tangent[2], normal[2], share[2], B[3][6];
};

static struct middle find_middle(const struct beam_element *e, const struct beam_start *start,
                                 const double *const d[2])
{
    struct middle m;
    const double half[2] = {0.5 * d[0][2], 0.5 * d[1][2]};
    const double cosine[2] = {1 / sqrt(1 + square(half[0])), 1 / sqrt(1 + square(half[1]))};
    for (int k = 0; k < 2; k++) {
        m.share[k] = cosine[k] / (cosine[0] + cosine[1]);
        m.mean[k] = start->apart[k] + 0.5 * (d[1][k] - d[0][k]);
    }
    const double tangent = m.share[0] * half[0] + m.share[1] * half[1];
    const double c = 1 / sqrt(1 + square(tangent)), s = tangent * c;
    m.tangent[0] = c * start->turn[0] - s * start->turn[1];
    m.tangent[1] = s * start->turn[0] + c * start->turn[1];
    m.normal[0] = -m.tangent[1];
    m.normal[1] = m.tangent[0];
    const double both = 1 + half[0] * half[1];
    const double bend = beam_atan_over((half[1] - half[0]) / both) / both / e->length;
    const double by_turn[2] = {cross_product(m.tangent, m.mean), -along(m.tangent, m.mean)};
    const double *const axis[2] = {m.tangent, m.normal};
    memset(m.B, 0, sizeof m.B);
    for (int k = 0; k < 2; k++) {
        const double sign = k ? 1 : -1;
        for (int i = 0; i < 2; i++) {
            for (int x = 0; x < 2; x++) m.B[i][3 * k + x] = sign * c / e->length * axis[i][x];
            m.B[i][3 * k + 2] = c / e->length * by_turn[i] * m.share[k];
        }
        m.B[2][3 * k + 2] = sign * bend;
    }
    return m;
}

/* The derivative of the force, but for shares and cosine, which vanish with the step. Symmetric. */
static void find_matrix(const struct beam_element *e, const struct middle *m, const double N[3],
                        double weight, const double force[2][3], double matrix[6][6])
{
    const double *const a = force[1], turned[2] = {-a[1], a[0]};
    for (int r = 0; r < 6; r++)
        for (int c = 0; c < 6; c++) {
            matrix[r][c] = 0;
            for (int i = 0; i < 3; i++)
                matrix[r][c] += e->length * e->stiffness[i] * weight * m->B[i][r] * m->B[i][c];
        }
    for (int k = 0; k < 2 && (N[0] != 0 || N[1] != 0); k++)
        for (int l = 0; l < 2; l++) {
            matrix[3 * k + 2][3 * l + 2] -= 0.5 * along(a, m->mean) * m->share[k] * m->share[l];
            for (int x = 0; x < 2; x++) {
                const double change = (k ? 0.5 : -0.5) * turned[x] * m->share[l];
                matrix[3 * k + x][3 * l + 2] += change;
                matrix[3 * l + 2][3 * k + x] += change;
            }
        }
}

/* T-104d: with this share of the stiffness, unresolved motions decay fastest, to -1/3 a step. */
#define FADES (1.0 / 16)

void beam_force(const struct beam_element *e, const struct beam_start *start,
                const double *const d[2], const double *const w[2], double dt, double force[2][3],
                double matrix[6][6])
{
    const struct middle m = find_middle(e, start, d);
    const double fades = w ? FADES : 0, weight = 0.5 + e->damping_time / dt + fades;
    double N[3];
    memset(force, 0, 6 * sizeof(double));
    for (int i = 0; i < 3; i++) {
        double change = 0, before = 0;
        for (int k = 0; k < 2; k++)
            for (int x = 0; x < 3; x++) {
                change += m.B[i][3 * k + x] * d[k][x];
                before += w ? m.B[i][3 * k + x] * dt * w[k][x] : 0;
            }
        N[i] = e->stiffness[i] * (start->strain[i] + weight * change - fades * before);
        for (int k = 0; k < 2; k++)
            for (int x = 0; x < 3; x++) force[k][x] += e->length * N[i] * m.B[i][3 * k + x];
    }
    find_matrix(e, &m, N, weight, force, matrix);
}
