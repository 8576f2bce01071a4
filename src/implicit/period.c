/* SPDX-License-Identifier: MIT
 * The longest period of solids, which sets the implicit step where there is no fluid (T-93). */
#include "implicit/implicit.h"

#include <float.h>

double implicit_period(struct solid *solid, struct particles *particles)
{
    struct implicit *const implicit = solid->implicit;
    const double rounding = 8 * DBL_EPSILON * square(solid->omega_max);
    double low = rounding, high = square(solid->omega_max);
    if (implicit->n == 0) return (double)INFINITY;
    solid_gradient(solid, particles);
    while (high > 1.01 * low) {
        const double middle = sqrt(low * high);
        const int64_t below =
            implicit_factor(solid, particles, (double)INFINITY, -middle, NULL, NULL);
        *(below > 3 * implicit->n_free ? &high : &low) = middle;
    }
    implicit->factored = false;
    return high > 2 * rounding ? 2 * M_PI / sqrt(high) : (double)INFINITY;
}
