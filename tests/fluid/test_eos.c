/* SPDX-License-Identifier: MIT
 * Tait's equation of state against long double powers, its inverse, and its energy. */
#include "fluid/eos.h"

#include "rig.h"
#include "unity.h"

#include <float.h>
#include <math.h>

void setUp(void) {}
void tearDown(void) {}

/* From -25 % to +30 %, and down to 1e-14 on both sides: six roundings of Horner's rule, none of
 * which cancels for small d. */
static void test_power_keeps_its_digits(void)
{
    for (double d = 0.3; d > 1e-14; d *= 0.7) {
        for (int sign = -1; sign <= 1; sign += 2) {
            const double s = sign < 0 ? -0.8 * d : d;
            const long double exact = expm1l(7 * log1pl((long double)s));
            assert_near(20 * DBL_EPSILON * fabs((double)exact), (double)exact, eos_power(s),
                        "(1 + d)^7 - 1");
        }
    }
    TEST_ASSERT_TRUE(eos_power(0) == 0);
}

/* Eq. 2 with c0 = 20 m/s, rho0 = 1000: rho = 1010 gives 400000/7 (1.01^7 - 1) =
 * 57142.857142857 * 0.0721353521070 = 4122.02012040 Pa. */
static void test_pressure_by_hand(void)
{
    assert_near(1e-7, 4122.0201204, eos_pressure(0.01, 1000, 20), "P");
    TEST_ASSERT_TRUE(eos_pressure(0, 1000, 20) == 0);
    TEST_ASSERT_TRUE(eos_pressure(-0.01, 1000, 20) < 0);
}

/* dP/drho at rest is c0^2. */
static void test_slope_is_the_speed_of_sound(void)
{
    const double e = 1e-6;
    const double slope = (eos_pressure(e, 1000, 20) - eos_pressure(-e, 1000, 20)) / (2 * e * 1000);
    assert_near(400 * 1e-9, 400, slope, "dP/drho");
}

static void test_inverse_round_trip(void)
{
    const double rho0 = 1000, c0 = 20, B = rho0 * c0 * c0 / 7;
    for (double d = 0.3; d > 1e-14; d *= 0.7)
        for (int sign = -1; sign <= 1; sign += 2)
            assert_near(20 * DBL_EPSILON * d, sign * 0.8 * d,
                        eos_dens(eos_pressure(sign * 0.8 * d, rho0, c0), rho0, c0), "d");
    TEST_ASSERT_TRUE(eos_dens(0, rho0, c0) == 0);
    /* Over the whole range that is promised, against the seventh root. */
    for (double z = -0.89; z < 10; z += 0.0371) {
        const double exact = (double)expm1l(log1pl((long double)z) / 7);
        assert_near(20 * DBL_EPSILON * (fabs(exact) + DBL_EPSILON), exact,
                    eos_dens(z * B, rho0, c0), "d of z");
    }
}

/* Below z = -0.9 the pressure is cut off: finite, and the density of z = -0.9. */
static void test_tension_beyond_the_law_stays_finite(void)
{
    const double lowest = pow(0.1, 1.0 / 7) - 1;
    assert_near(1e-14, lowest, eos_dens(-1e9, 1000, 20), "d");
}

/* To the bit, in blocks whose values need one round up to all of them, and with what is not a
 * number among them. */
static void test_a_block_is_as_one_by_one(void)
{
    const double rho0 = 1000, c0 = 20, B = rho0 * c0 * c0 / 7;
    double pressure[EOS_BLOCK], d[EOS_BLOCK];
    uint64_t seed = 3;
    for (int k = 0; k < 400; k++) {
        for (int r = 0; r < EOS_BLOCK; r++)
            pressure[r] = B * pow(10, -8 + 4.5 * (1 + noise(&seed))) * noise(&seed);
        pressure[k % EOS_BLOCK] = k % 3 ? 0 : k % 2 ? -(double)INFINITY : (double)NAN;
        eos_dens_of_block(pressure, rho0, c0, d);
        for (int r = 0; r < EOS_BLOCK; r++) {
            const double one = eos_dens(pressure[r], rho0, c0);
            TEST_ASSERT_TRUE(isnan(one) ? isnan(d[r]) : one == d[r]);
        }
    }
}

/* d(energy)/d(rho) = P/rho^2: central difference of relative step 1e-5, error of the order of its
 * square; and the leading term c0^2 d^2/2 for small d. */
static void test_energy_is_the_integral_of_pressure(void)
{
    const double rho0 = 1000, c0 = 20, e = 1e-5;
    for (double d = -0.2; d < 0.3; d += 0.013) {
        const double rho = rho0 * (1 + d), slope = eos_pressure(d, rho0, c0) / (rho * rho);
        const double difference = (eos_energy(d + e, c0) - eos_energy(d - e, c0)) / (2 * e * rho0);
        assert_near(1e-8 * c0 * c0 / rho0, slope, difference, "d energy/d rho");
    }
    for (double d = 1e-4; d > 1e-12; d *= 0.1)
        assert_near(3 * d, 1, eos_energy(d, c0) / (0.5 * c0 * c0 * d * d), "energy of small d");
    TEST_ASSERT_TRUE(eos_energy(0, c0) == 0);
    TEST_ASSERT_TRUE(eos_energy(-0.1, c0) > 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_power_keeps_its_digits);
    RUN_TEST(test_pressure_by_hand);
    RUN_TEST(test_slope_is_the_speed_of_sound);
    RUN_TEST(test_inverse_round_trip);
    RUN_TEST(test_tension_beyond_the_law_stays_finite);
    RUN_TEST(test_a_block_is_as_one_by_one);
    RUN_TEST(test_energy_is_the_integral_of_pressure);
    return UNITY_END();
}
