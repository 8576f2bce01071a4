/* SPDX-License-Identifier: MIT
 * Sine, exponential, logarithm and their kin with the same bits on every machine: C libraries
 * round them in different ways. Each is computed in pairs of doubles and rounded once, so the
 * error is 0.5001 units of the last place. sqrt, fabs, floor and round are exact in every
 * library.
 *
 * glibc 2.36 differs in the last bit of 0.01 to 0.6 % of the values. In sinh, cosh and tanh it
 * differs by up to two units of the last place, in 11 to 26 %. A call takes 0.02 to 2 us, one of
 * glibc 0.002 to 0.02 us. Calls are rare: all of them are 0.01 % of the instructions of gate.cfg
 * (dp = 2 mm), 0.04 % of hydrostatic_plate.cfg (50 mm) and 0.25 % of channel.cfg, up to 2, 5 and
 * 100 ms (callgrind). */
#pragma once

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
