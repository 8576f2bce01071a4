/* SPDX-License-Identifier: MIT
 * Arithmetic, units and dimensions of case files. */
#include "expr/expr.h"
#include "case/scene.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static char why[EXPR_WHY];

/* Two names: L, a length of 2 m, and n, the plain number 3. */
static bool find(void *context, const char *name, struct quantity *q, char reason[EXPR_WHY])
{
    (void)context, (void)reason;
    if (strcmp(name, "L") == 0)
        *q = (struct quantity){2, {DIM_KNOWN, {0, 1, 0}}};
    else if (strcmp(name, "n") == 0)
        *q = (struct quantity){3, {DIM_PLAIN, {0, 0, 0}}};
    else
        return false;
    return true;
}

static const struct expr_names names = {.find = find, .scope = EXPR_IN_SPACE};

static struct quantity value_of(const char *text)
{
    struct quantity q = {0, {DIM_PLAIN, {0, 0, 0}}};
    why[0] = '\0';
    const bool good = expr_value((struct slice){text, strlen(text)}, &names, &q, why);
    TEST_ASSERT_TRUE_MESSAGE(good, why);
    return q;
}

static void is(double expected, const char *unit, const char *text)
{
    const struct quantity q = value_of(text);
    TEST_ASSERT_EQUAL_DOUBLE(expected, q.value);
    TEST_ASSERT_TRUE_MESSAGE(dim_fits(&q.dim, unit), text);
}

void setUp(void) {}

void tearDown(void) {}

static void test_precedence(void)
{
    is(7, "1", "1 + 2*3");
    is(9, "1", "(1 + 2)*3");
    is(-4, "1", "-2^2");
    is(512, "1", "2^3^2");
    is(0.25, "1", "2^-2");
    is(1, "1", "8/4/2");
    is(-4, "1", "1 - 2 - 3");
    is(3, "1", "--3");
    is(1250, "1", "1.25e3");
    is(0.5, "1", ".5");
}

static void test_functions(void)
{
    is(3, "1", "sqrt(9)");
    is(1, "1", "cosh(0) + sinh(0) + tanh(0) + sin(0) + tan(0)");
    is(1, "1", "log(exp(1))");
    is(2, "1", "min(2, 3)");
    is(3, "1", "max(2, n)");
    is(5, "1", "abs(-5)");
    is(3, "1", "round(2.5)");
    is(-3, "1", "round(-2.6)");
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, -1, value_of("cos(pi)").value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.5, value_of("sin(30 deg)").value);
}

static void test_units_give_the_double_that_si_gives(void)
{
    is(0.14, "m", "140 mm");
    is(0.0005, "m", "0.5 mm");
    is(0.079, "m", "79 mm");
    is(0.05, "m", "5 cm");
    is(2000, "m", "2 km");
    is(1e-6, "m", "1 um");
    is(0.4, "s", "400 ms");
    is(120, "s", "2 min");
    is(7.8e6, "Pa", "7.8 MPa");
    is(67.5e9, "Pa", "67.5 GPa");
    is(1373.4, "Pa", "1.3734 kPa");
    is(1000, "kg/m^3", "1 g/cm^3");
    is(9.81, "m/s^2", "9.81 m/s^2");
    is(0.002, "m/s", "2 mm/s");
    is(50, "1", "50");
    is(0.5, "1", "50 %");
    is(10, "Pa", "10 N/m^2");
    is(20, "m", "20m");
}

static void test_a_unit_belongs_to_its_number(void)
{
    is(2, "m", "4 m/2");
    is(0.25, "1/m", "1/4 m");
    is(4, "m", "L*2");
    is(25e-6, "m^2", "(5 mm)^2");
    is(2, "m/s", "4 m / 2 s");
    is(3, "s", "3*s");
    is(120, "s", "2 min");
    is(1, "m", "1 m * min(1, 2)");
}

static void test_dimensions_follow_arithmetic(void)
{
    is(sqrt(2 * 9.81), "m/s", "sqrt(9.81 m/s^2*L)");
    is(1, "1", "L/2 m");
    is(3, "m", "L + 1 m");
    is(3, "m", "L + 1");
    is(8, "m^3", "L^3");
    is(2, "m", "max(L, 0)");
    is(6, "m", "n*L");
}

static void wrong(const char *expected, const char *text)
{
    struct quantity q;
    TEST_ASSERT_FALSE_MESSAGE(expr_value((struct slice){text, strlen(text)}, &names, &q, why),
                              text);
    TEST_ASSERT_EQUAL_STRING(expected, why);
}

static void test_what_makes_no_sense(void)
{
    wrong("a value is missing", "");
    wrong("a value is missing", "1 +");
    wrong("`*` where a value is expected", "*2");
    wrong("`(` after sqrt is not closed", "sqrt(2");
    wrong("min has too many values", "min(1, 2, 3)");
    wrong("`)` without `(`", "2)");
    wrong("division by zero", "1/(n - 3)");
    wrong("the result is not a finite number", "log(0)");
    wrong("the result is not a finite number", "1e308*10");
    wrong("a length (m) and a time (s) cannot be added or compared", "max(L, 1 s)");
    wrong("the power of a length (m); it needs a number without a unit", "2^L");
    wrong("the exponent of a unit must be a number from -9 to 9", "2 m^99");
    wrong("a quantity with a unit has an exponent outside the range -9 to 9", "L^99");
    wrong("a character outside ASCII, such as a no-break space, a typographic minus or a micro "
          "sign, where an operator is expected",
          "2\xC8");
    wrong("`x` is known only in keys that take an expression in x and y", "x");
    wrong("unknown name `q`", "q");
    wrong("unknown function `L`", "L(2)");
    wrong("unknown name `g`", "g");
}

static struct arena arena;

static double at(const char *text, double x, double y)
{
    struct expr *e;
    struct dim dim;
    struct diag d = {0};
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK,
                                  expr_compile(&e, (struct slice){text, strlen(text)}, &names, &dim,
                                               &arena, why, &d),
                                  why);
    TEST_ASSERT_EQUAL_STRING(text, expr_source(e));
    return expr_at(e, x, y);
}

static void test_fields(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(7, at("x + 2*y", 1, 3));
    TEST_ASSERT_EQUAL_DOUBLE(-2, at("y - x*n", 1, 1));
    TEST_ASSERT_EQUAL_DOUBLE(16, at("n^(x + 1)*4/L - 38", 2, 0));
    TEST_ASSERT_EQUAL_DOUBLE(0, at("max(x, 0)", -1, 0));
    TEST_ASSERT_EQUAL_DOUBLE(5, at("5", 0, 0));
    TEST_ASSERT_EQUAL_DOUBLE(cosh(0.5) - cos(0.5), at("cosh(x/L) - cos(x/L)", 1, 0));
    arena_free(&arena);
}

static void test_length_and_depth_are_bounded(void)
{
    char text[8192];
    memset(text, '(', sizeof text);
    struct quantity q;
    TEST_ASSERT_FALSE(expr_value((struct slice){text, sizeof text}, &names, &q, why));
    TEST_ASSERT_EQUAL_STRING(
        "parentheses or signs are nested more than 64 deep; use [constants] for parts of it", why);
    memset(text, '-', sizeof text);
    TEST_ASSERT_FALSE(expr_value((struct slice){text, sizeof text}, &names, &q, why));
    TEST_ASSERT_EQUAL_STRING(
        "parentheses or signs are nested more than 64 deep; use [constants] for parts of it", why);
    memset(text, '9', sizeof text);
    TEST_ASSERT_FALSE(expr_value((struct slice){text, sizeof text}, &names, &q, why));
    TEST_ASSERT_EQUAL_STRING("the number has more than 60 characters; shorten it", why);
    for (size_t k = 0; k + 1 < sizeof text; k += 2) memcpy(text + k, "x+", 2);
    struct expr *e;
    struct dim dim;
    struct diag d = {0};
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, expr_compile(&e, (struct slice){text, sizeof text - 1}, &names,
                                                  &dim, &arena, why, &d));
    TEST_ASSERT_EQUAL_STRING(
        "the expression has more than 1024 operations; use [constants] for parts of it", why);
}

/* With its time fixed an expression has the same bits everywhere; what has no x or y is a
 * number. */
static void test_at_a_fixed_time(void)
{
    static const char *const texts[] = {"x + y*t",
                                        "2",
                                        "t",
                                        "sin(3*t)^2*x",
                                        "1.5*y*(0.4 - y)*(1 - cos(pi*min(t/0.3, 1)))/0.04",
                                        "max(x, t) - -abs(t - 1)*y^2 + exp(-t)/(1 + t)",
                                        "min(t, y) + (t + (t + x))"};
    const struct expr_names both = {.find = find, .scope = EXPR_IN_BOTH};
    struct arena a = {0};
    struct diag d = {0};
    for (size_t k = 0; k < COUNT_OF(texts); k++) {
        struct expr *e, *fixed;
        struct dim dim = {0};
        const struct slice text = {texts[k], strlen(texts[k])};
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, expr_compile(&e, text, &both, &dim, &a, why, &d),
                                      why);
        TEST_ASSERT_EQUAL_INT(ERR_OK, expr_copy(&fixed, e, &a, &d));
        for (int n = 0; n < 60; n++) {
            const double x = 0.1 * (n % 5), y = 0.07 * (n % 7) - 0.1, t = 0.031 * n;
            expr_fix_time(fixed, e, t);
            TEST_ASSERT_FALSE(expr_varies(fixed));
            const double want = expr_at_time(e, x, y, t);
            const double got = expr_at_time(fixed, x, y, 1e9);
            TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&want, &got, sizeof want, texts[k]);
        }
        const bool local = strchr(texts[k], 'y') || (strchr(texts[k], 'x') && k > 0);
        TEST_ASSERT_EQUAL_INT_MESSAGE(!local, expr_is_number(fixed), texts[k]);
    }
    arena_free(&a);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_precedence);
    RUN_TEST(test_functions);
    RUN_TEST(test_units_give_the_double_that_si_gives);
    RUN_TEST(test_a_unit_belongs_to_its_number);
    RUN_TEST(test_dimensions_follow_arithmetic);
    RUN_TEST(test_what_makes_no_sense);
    RUN_TEST(test_fields);
    RUN_TEST(test_length_and_depth_are_bounded);
    RUN_TEST(test_at_a_fixed_time);
    return UNITY_END();
}
