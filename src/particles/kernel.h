/* SPDX-License-Identifier: MIT
 * The smoothing kernel: Wendland C2 in two dimensions (Wendland 1995; [39] of the article),
 *   W(q) = alpha_D (1 - q/2)^4 (2q + 1),  0 <= q = r/h <= 2,  alpha_D = 7/(4 pi h^2),
 *   grad_a W_ab = -(5 alpha_D/h^2) (1 - q/2)^3 x_ab,
 * so the gradient needs no division by r. */
#pragma once

#include "base/base.h"

/* Reach of the kernel in units of h. */
#define KERNEL_REACH 2.0
/* alpha_D h^2, and the factor of the gradient: grad W = -KERNEL_SLOPE/h^4 (1 - q/2)^3 x. */
#define KERNEL_NORM (7 / (4 * PI))
#define KERNEL_SLOPE (5 * KERNEL_NORM)

/* W, 1/m^2. */
SPHFSI_INLINE double kernel_w(double r, double h)
{
    const double q = r / h, t = max2(0, 1 - 0.5 * q);
    return KERNEL_NORM / (h * h) * (t * t) * (t * t) * (2 * q + 1);
}

/* The factor f of grad_a W_ab = f x_ab, 1/m^4. */
SPHFSI_INLINE double kernel_slope(double r, double h)
{
    const double t = max2(0, 1 - 0.5 * r / h);
    return -KERNEL_SLOPE / square(h * h) * (t * t * t);
}

/* - sum of dp^2 x^2 f over a square lattice of spacing dp, 1 in the limit h/dp -> infinity. */
SPHFSI_INLINE double kernel_second_moment(double dp, double h)
{
    const int reach = (int)(KERNEL_REACH * h / dp);
    double sum = 0;
    for (int i = -reach; i <= reach; i++)
        for (int j = -reach; j <= reach; j++)
            sum -= square(dp * dp * i) * kernel_slope(dp * sqrt(i * i + j * j), h);
    return sum;
}
