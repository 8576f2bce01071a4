/* SPDX-License-Identifier: MIT
 * Argument reduction and series of each function, in pairs of doubles. */
#include "base/elementary.h"
#include "base/base.h"

/* The number hi + lo, hi its nearest double (Dekker 1971): relative errors of some 2^-104. */
struct dd {
    double hi, lo;
};

static const struct dd half_pi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
static const struct dd ln_2 = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};
static const double half_pi_rest = -0x1.f1976b7ed8fbcp-110;

/* Sum of two doubles, without rounding. */
static struct dd sum(double a, double b)
{
    const double s = a + b, b_in_s = s - a;
    return (struct dd){s, (a - (s - b_in_s)) + (b - b_in_s)};
}
static struct dd product(double a, double b)
{
    const double p = a * b;
    return (struct dd){p, __builtin_fma(a, b, -p)};
}

static struct dd add(struct dd a, struct dd b)
{
    const struct dd high = sum(a.hi, b.hi), low = sum(a.lo, b.lo);
    const struct dd middle = sum(high.hi, high.lo + low.hi);
    return sum(middle.hi, middle.lo + low.lo);
}
static struct dd scaled(struct dd a, double b) { return (struct dd){a.hi * b, a.lo * b}; }
static struct dd times(struct dd a, struct dd b)
{
    const struct dd p = product(a.hi, b.hi);
    return sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}
static struct dd over(struct dd a, struct dd b)
{
    const double q = a.hi / b.hi;
    const struct dd rest = add(a, scaled(times((struct dd){q, 0}, b), -1));
    return sum(q, (rest.hi + rest.lo) / b.hi);
}
static struct dd by(struct dd a, double b)
{
    const double q = a.hi / b;
    return sum(q, (__builtin_fma(-q, b, a.hi) + a.lo) / b);
}

/* 1 + s z/(n + 1)(n + 2) (1 + s z/(n + 3)(n + 4) (1 + ...)), z = x^2, |x| < 1. With s = -1 that
 * is cos x for n = 0 and sin x/x for n = 1, with s = 1 it is cosh x and sinh x/x. */
static struct dd series(struct dd x, int n, double s)
{
    enum { TERMS = 11 };
    const struct dd z = scaled(times(x, x), s), one = {1, 0};
    struct dd value = one;
    for (int k = 2 * TERMS + n; k > n; k -= 2) value = add(one, by(times(z, value), k * (k - 1)));
    return value;
}

/* --- sine and cosine --- */

/* Beyond this, quarter turns are not counted exactly, and the library's function is taken. */
static bool too_large(double x) { return !(fabs(x) < 0x1p50); }

/* sin(x + quarters pi/2). */
static struct dd turned_sine(double x, int quarters)
{
    const double n = nearbyint(x / half_pi.hi);
    struct dd r = add((struct dd){x, 0}, scaled(product(n, half_pi.hi), -1));
    r = add(r, scaled(product(n, half_pi.lo), -1));
    r = add(r, (struct dd){-n * half_pi_rest, 0});
    const int quadrant = (int)(n - 4 * floor(n / 4)) + quarters;
    const struct dd value = quadrant & 1 ? series(r, 0, -1) : times(r, series(r, 1, -1));
    return quadrant & 2 ? scaled(value, -1) : value;
}

double elementary_sin(double x)
{
    /* Keeps the sign of a zero. */
    return x == 0 ? x : too_large(x) ? sin(x) : turned_sine(x, 0).hi;
}

double elementary_cos(double x) { return too_large(x) ? cos(x) : turned_sine(x, 1).hi; }

double elementary_tan(double x)
{
    if (x == 0 || too_large(x)) return tan(x);
    return over(turned_sine(x, 0), turned_sine(x, 1)).hi;
}

/* --- exponential and logarithm --- */

/* e^x = 2^n (1 + r/m + ...)^m with m = 2^HALVINGS, |x| < 800. The power n is kept apart. */
static struct dd exponential(struct dd x, int *n)
{
    enum { HALVINGS = 8, TERMS = 10 };
    const struct dd one = {1, 0};
    const double power = nearbyint(x.hi / ln_2.hi);
    const struct dd whole = times((struct dd){power, 0}, ln_2);
    const struct dd r = scaled(add(x, scaled(whole, -1)), 1.0 / (1 << HALVINGS));
    struct dd value = one;
    for (int k = TERMS; k > 0; k--) value = add(one, by(times(r, value), k));
    for (int k = 0; k < HALVINGS; k++) value = times(value, value);
    *n = (int)power;
    return value;
}

static double exponential_of(struct dd x)
{
    int n;
    if (!(fabs(x.hi) < 800)) return exp(x.hi); /* 0, infinity or not a number */
    const double value = exponential(x, &n).hi;
    return ldexp(value, n);
}

double elementary_exp(double x) { return exponential_of((struct dd){x, 0}); }

/* x = 2^n m, log m = 2 artanh z with z = (m - 1)/(m + 1), |z| < 0.172; x > 0 and finite. */
static struct dd logarithm(double x)
{
    enum { TERMS = 15 };
    const struct dd one = {1, 0};
    int n;
    double m = frexp(x, &n);
    if (m < 0.70710678118654752) m *= 2, n--;
    const struct dd z = over((struct dd){m - 1, 0}, sum(m, 1)), z2 = times(z, z);
    struct dd value = {0, 0};
    for (int k = TERMS; k >= 0; k--) value = add(by(one, 2 * k + 1), times(z2, value));
    return add(times((struct dd){n, 0}, ln_2), scaled(times(z, value), 2));
}

double elementary_log(double x) { return x > 0 && isfinite(x) ? logarithm(x).hi : log(x); }

double elementary_pow(double x, double y)
{
    const bool whole = y == floor(y), odd = whole && fmod(y, 2) != 0;
    if (y == 0 || x == 0 || !isfinite(x) || !isfinite(y) || (x < 0 && !whole)) return pow(x, y);
    const double value = exponential_of(times((struct dd){y, 0}, logarithm(fabs(x))));
    return x < 0 && odd ? -value : value;
}

/* --- hyperbolic functions --- */

static struct dd hyperbolic_sine(double x)
{
    int n;
    if (fabs(x) < 0.5) return times((struct dd){x, 0}, series((struct dd){x, 0}, 1, 1));
    const struct dd e = exponential((struct dd){x, 0}, &n), one = {1, 0};
    const struct dd less = scaled(over(one, e), ldexp(1, -2 * n));
    return scaled(add(e, scaled(less, -1)), ldexp(0.5, n));
}

static struct dd hyperbolic_cosine(double x)
{
    int n;
    const struct dd e = exponential((struct dd){x, 0}, &n), one = {1, 0};
    return scaled(add(e, scaled(over(one, e), ldexp(1, -2 * n))), ldexp(0.5, n));
}

/* From here on e^-x is below the last place of e^x. */
static const double alone = 40;

double elementary_sinh(double x)
{
    if (fabs(x) > alone) return copysign(0.5, x) * elementary_exp(fabs(x));
    return x == 0 || x != x ? x : hyperbolic_sine(x).hi;
}

double elementary_cosh(double x)
{
    if (fabs(x) > alone) return 0.5 * elementary_exp(fabs(x));
    return x != x ? x : hyperbolic_cosine(x).hi;
}

double elementary_tanh(double x)
{
    if (fabs(x) > alone) return copysign(1, x);
    return x == 0 || x != x ? x : over(hyperbolic_sine(x), hyperbolic_cosine(x)).hi;
}

/* --- geometry --- */

/* The angle of (x, y), 0 < y <= x. A polynomial gives a first value t, which is corrected three
 * times: it lacks e - e^3/3 + ..., with e = (y cos t - x sin t)/(x cos t + y sin t). */
static struct dd angle_below_45(double y, double x)
{
    const double q = y / x;
    struct dd t = {q * (1 - q * q * (0.31 - 0.1 * q * q)), 0};
    for (int k = 0; k < 3; k++) {
        const struct dd c = turned_sine(t.hi, 1), s = turned_sine(t.hi, 0);
        const struct dd across = add(times((struct dd){y, 0}, c), times((struct dd){-x, 0}, s));
        const struct dd along = add(times((struct dd){x, 0}, c), times((struct dd){y, 0}, s));
        const struct dd e = over(across, along), cubic = {-e.hi * e.hi * e.hi / 3, 0};
        t = add((struct dd){t.hi, 0}, add(e, cubic));
    }
    return t;
}

double elementary_atan2(double y, double x)
{
    const double a = fabs(y), b = fabs(x);
    if (y == 0 || x == 0 || !isfinite(x) || !isfinite(y)) return atan2(y, x);
    struct dd t = a <= b ? angle_below_45(a, b) : add(half_pi, scaled(angle_below_45(b, a), -1));
    if (x < 0) t = add(scaled(half_pi, 2), scaled(t, -1));
    return copysign(t.hi, y);
}

double elementary_hypot(double x, double y)
{
    const double top = max2(fabs(x), fabs(y));
    if (!(top > 0x1p-400 && top < 0x1p400)) return hypot(x, y); /* the squares would be 0 or inf */
    const struct dd square = add(product(x, x), product(y, y));
    const double root = sqrt(square.hi);
    const struct dd rest = add(square, scaled(product(root, root), -1));
    return root + (rest.hi + rest.lo) / (2 * root);
}
