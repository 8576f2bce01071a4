/* SPDX-License-Identifier: MIT
 * Sine, exponential, logarithm and their kin with the same bits on every machine: C libraries round them in
 * different ways. Each is computed in pairs of doubles and rounded once, so the error is 0.5001 units of the
 * last place. sqrt, fabs, floor and round are exact in every library. */
#ifndef SPHFSI_BASE_ELEMENTARY_H
#define SPHFSI_BASE_ELEMENTARY_H

double elementary_sin(double x);
double elementary_cos(double x);
double elementary_tan(double x);
double elementary_sinh(double x);
double elementary_cosh(double x);
double elementary_tanh(double x);
double elementary_exp(double x);
double elementary_log(double x);
double elementary_pow(double x, double y);
double elementary_atan2(double y, double x);
double elementary_hypot(double x, double y);

#endif
