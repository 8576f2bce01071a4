/* SPDX-License-Identifier: MIT
 * Tait's equation of state (Eq. 2) with gamma = 7, in terms of dens = rho/rho0 - 1, which keeps the
 * digits that rho itself would lose. */
#pragma once

#include "base/base.h"

#define EOS_GAMMA 7.0

/* (1 + d)^7 - 1, without cancellation for small d, of a number or a vector. */
#define EOS_POWER(d) \
    ((d) * (7 + (d) * (21 + (d) * (35 + (d) * (35 + (d) * (21 + (d) * (7 + (d))))))))
SPHFSI_INLINE double eos_power(double d) { return EOS_POWER(d); }

/* Eq. 2: pressure, Pa. */
SPHFSI_INLINE double eos_pressure(double dens, double rho0, double c0)
{
    return c0 * c0 * rho0 / EOS_GAMMA * eos_power(dens);
}

/* Eq. 20: dens d of a given pressure. The start for (1 + d)^7 - 1 = z is the diagonal Pade
 * approximant of (1 + z)^(1/7) of second order, with an error of 8e-4 z^5 for small z. Newton
 * iterations follow, each with three times the square of the error: one suffices in water, five for
 * -0.9 < z < 10. Plain arithmetic: the bits do not depend on a library's pow. */
enum { EOS_ROUNDS = 5 };

SPHFSI_INLINE double eos_z(double pressure, double rho0, double c0)
{
    return max2(-0.9, pressure * EOS_GAMMA / (c0 * c0 * rho0));
}

SPHFSI_INLINE double eos_start(double z) { return z * (14 + 7 * z) / (98 + z * (91 + 13 * z)); }

/* The correction of d by one iteration; and whether another one is needed. */
SPHFSI_INLINE double eos_round(double d, double z)
{
    const double s = 1 + d, s3 = s * s * s;
    return (eos_power(d) - z) / (EOS_GAMMA * s3 * s3);
}

SPHFSI_INLINE bool eos_goes_on(double d, double last)
{
    return last * last > 1e-17 * (d < 0 ? -d : d);
}

SPHFSI_INLINE double eos_dens(double pressure, double rho0, double c0)
{
    const double z = eos_z(pressure, rho0, c0);
    double d = eos_start(z), last = 1;
    for (int k = 0; k < EOS_ROUNDS && eos_goes_on(d, last); k++) {
        last = eos_round(d, z);
        d -= last;
    }
    return d;
}

/* eos_dens for blocks, whose iterations hide each other's latency: the same values. */
enum { EOS_BLOCK = 16 };
SPHFSI_INLINE void eos_dens_of_block(const double *pressure, double rho0, double c0, double *d)
{
    double z[EOS_BLOCK], last[EOS_BLOCK];
    int going = EOS_BLOCK;
#pragma omp simd
    for (int r = 0; r < EOS_BLOCK; r++) {
        z[r] = eos_z(pressure[r], rho0, c0);
        d[r] = eos_start(z[r]);
        last[r] = 1;
    }
    for (int k = 0; k < EOS_ROUNDS && going > 0; k++) {
        going = 0;
#pragma omp simd reduction(+ : going)
        for (int r = 0; r < EOS_BLOCK; r++) {
            last[r] = eos_goes_on(d[r], last[r]) ? eos_round(d[r], z[r]) : 0;
            d[r] -= last[r];
            going += eos_goes_on(d[r], last[r]);
        }
    }
}

/* Compression energy per mass, J/kg: the integral of P/rho^2 over rho from rho0. */
SPHFSI_INLINE double eos_energy(double d, double c0)
{
    const double sixth = d * d * (5.0 / 2 + d * (10.0 / 3 + d * (5.0 / 2 + d * (1 + d / 6))));
    return c0 * c0 / EOS_GAMMA * (sixth + d * d / (1 + d));
}
