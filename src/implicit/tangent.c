/* SPDX-License-Identifier: MIT
 * The matrix of T-92 and its factors. */
#include "implicit/implicit.h"
#include "implicit/stress.h"

/* dP/dF of one particle, Pa, in the order xx, xy, yx, yy. */
struct tangent {
    double of[4][4];
};

/* T-92: dP = dF S + F (dS/dE : sym(F^T dF)); `viscous` adds to dS/dE what a damping_time does over
 * the step, times the same tensor. */
static void find_tangents(const struct solid_body *body, struct vtensor2 U, double viscous,
                          int lanes, struct tangent *tangent)
{
    const struct vtensor2 F = deformation(U), E = green_lagrange(U), S = stress_of_strain(body, E);
    const vreal zero = vset(0);
    const vreal strain[3][4] = {{F.xx, zero, F.yx, zero},
                                {zero, F.xy, zero, F.yy},
                                {F.xy, F.xx, F.yy, F.yx}};
    vreal D[3][3];
    for (int c = 0; c < 3; c++) {
        const vreal x = vset(c == 0), y = vset(c == 1), both = vset(0.5 * (c == 2));
        const struct vtensor2 rate =
            scale(vset(1 + viscous), stress_rate(body, E, S, (struct vtensor2){x, both, both, y}));
        D[0][c] = rate.xx;
        D[1][c] = rate.yy;
        D[2][c] = rate.xy;
    }
    const vreal stress[2][2] = {{S.xx, S.xy}, {S.xy, S.yy}};
    for (int r = 0; r < 4; r++)
        for (int c = 0; c <= r; c++) {
            vreal sum = r / 2 == c / 2 ? stress[r % 2][c % 2] : zero;
            for (int m = 0; m < 3; m++)
                for (int n = 0; n < 3; n++)
                    sum = sum + strain[m][r] * (0.5 * (D[m][n] + D[n][m])) * strain[n][c];
            for (int l = 0; l < lanes; l++) tangent[l].of[r][c] = tangent[l].of[c][r] = sum[l];
        }
}

/* Adds V g_m . dP/dF . g_n for each two of the particles that the gradient depends on. */
static void add_particle(const struct implicit *implicit, int64_t i, double volume,
                         const struct tangent *tangent)
{
    const struct implicit_links *const links = &implicit->links;
    for (int64_t n = links->first[i]; n < links->first[i + 1]; n++) {
        const int64_t column = implicit->order[links->node[n]];
        if (column < 0) continue;
        const double gx = volume * links->gx[n], gy = volume * links->gy[n];
        double to[2][4];
        for (int c = 0; c < 2; c++)
            for (int r = 0; r < 4; r++)
                to[c][r] = tangent->of[r][2 * c] * gx + tangent->of[r][2 * c + 1] * gy;
        for (int64_t m = links->first[i]; m < links->first[i + 1]; m++) {
            const int64_t row = implicit->order[links->node[m]];
            if (row < column) continue;
            const double hx = links->gx[m], hy = links->gy[m];
            for (int r = 0; r < 2; r++)
                for (int c = 0; c < (row == column ? r + 1 : 2); c++)
                    envelope_add(&implicit->matrix, 2 * row + r, 2 * column + c,
                                 hx * to[c][2 * r] + hy * to[c][2 * r + 1]);
        }
    }
}

/* The matrix of T-92 without inertia: of the stress at the present gradients and of springs. */
static void add_stiffness(struct solid *solid, const struct particles *particles, double dt)
{
    struct implicit *const implicit = solid->implicit;
    struct tangent tangent[LANES];
    double *const gradient[] = {particles->Uxx, particles->Uxy, particles->Uyx, particles->Uyy};
    envelope_clear(&implicit->matrix);
    for (int64_t k = 0; k < solid->n_packs; k++) {
        const struct solid_pack *const pack = &solid->pack[k];
        const struct solid_body *const body = &solid->body[pack->body];
        find_tangents(body, load_tensor(gradient, pack->i), 2 * body->damping_time / dt,
                      pack->lanes, tangent);
        for (int l = 0; l < pack->lanes; l++)
            add_particle(implicit, pack->i + l, square(body->dp), &tangent[l]);
    }
    const struct envelope *const from = &implicit->springs;
    for (int64_t row = 0; row < from->n; row++)
        for (int c = 0; c < 2; c++) {
            for (int64_t column = from->first[row]; column < row; column++) {
                const double value = from->value[from->start[row] + column - from->first[row]];
                if (value != 0) envelope_add(&implicit->matrix, 2 * row + c, 2 * column + c, value);
            }
            envelope_add(&implicit->matrix, 2 * row + c, 2 * row + c, from->pivot[row]);
        }
}

int64_t implicit_factor(struct solid *solid, const struct particles *particles, double dt,
                        double shift, const double *nx, const double *ny)
{
    struct implicit *const implicit = solid->implicit;
    add_stiffness(solid, particles, dt);
    for (int64_t i = 0; i < particles->n; i++) {
        const struct solid_body *const body = &solid->body[particles->body[i]];
        const int64_t row = 2 * (int64_t)implicit->order[i];
        const double per_dt = 2 / dt, rate = body->mass * per_dt;
        if (row < 0) continue;
        for (int c = 0; c < 2; c++)
            implicit->matrix.pivot[row + c] +=
                rate * (per_dt + body->mass_damping) + shift * body->mass;
        if (!nx) continue;
        implicit->matrix.pivot[row] += rate * square(nx[i]);
        implicit->matrix.pivot[row + 1] += rate * square(ny[i]);
        envelope_add(&implicit->matrix, row + 1, row, rate * nx[i] * ny[i]);
    }
    const int64_t negative = envelope_factor(&implicit->matrix);
    implicit->factored = negative >= 0;
    if (implicit->factored && solid->hinges) constraint_factor(implicit, solid->hinges);
    return negative;
}
