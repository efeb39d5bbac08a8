/* Branch-free elementary functions for all of perilat and, as text, for every emitted kernel: the
   same source compiled with -ffp-contract=off gives the same bits with every compiler, on every
   processor. C's library does not: its bits differ with its version and with the processor.
   Accuracy over the stated ranges is tested.

   Selects only, no tables, no calls, so that loops over them vectorise. A fused multiply-add is
   written out where it is meant; it rounds once on every machine, in hardware or not. Largest
   errors measured against 64-bit-mantissa references, in ulp of the result:

     exp 1.0, log 0.9, log10 0.9, pow 1.0, cbrt 0.5, inverse_root 1.0, hypot 1.2, sin and cos 0.8,
     tan 2.2, asin 1.2, acos 0.8, sinh 1.1, cosh 1.0, tanh 1.7, atan2 1.3 (0.5 for angles up
     to 1e-6 rad);
     wrap_angle 5e-16 rad for |x| <= 1e4 rad, exact for |x| <= pi.

   Ranges: all finite arguments, subnormal ones included, and infinities and NaN as in C's library,
   but sin, cos and tan are NaN beyond |x| = 2^30, where a law has lost its angle anyway, and
   inverse_root is NaN of all but normal positive numbers.

   Coefficients are weighted minimax fits (Remez 1934) of the expressions named beside them, made
   for this file; the reductions by exact multiples of a constant in parts follow Cody and Waite
   (1980), error terms Dekker (1971). */
#ifndef PERILAT_DSL_ELEMENTARY_H
#define PERILAT_DSL_ELEMENTARY_H

#include <stdint.h>

#if defined(__GNUC__)
#define PL_ELEMENTARY static inline __attribute__((always_inline, unused))
#else
#define PL_ELEMENTARY static inline
#endif

#define PL_INFINITY __builtin_inf()
#define PL_NAN      __builtin_nan("")

/* Adding it rounds |x| < 2^51 to the nearest integer, even on a tie, and leaves the integer in the
 * low bits. */
#define PL_ROUNDER 0x1.8p52

/* Parts of constants: HI is the nearest double, LO the nearest to what is left, and so on. */
#define PL_LN2_HI      0x1.62e42fefa39efp-1
#define PL_LN2_LO      0x1.abc9e3b39803fp-56
#define PL_LN2_SHORT   0x1.62e42fefa3800p-1 /* 42 bits: exact when multiplied by an exponent */
#define PL_LN2_REST    0x1.ef35793c76730p-45
#define PL_LG2_SHORT   0x1.34413509f7800p-2 /* of log10(2): 43 bits */
#define PL_LG2_REST    0x1.fef311f12b358p-46
#define PL_LGE_HI      0x1.bcb7b1526e50ep-2 /* of log10(e) */
#define PL_LGE_LO      0x1.95355baaafad3p-57
#define PL_HALF_PI_HI  0x1.921fb54442d18p+0
#define PL_HALF_PI_LO  0x1.1a62633145c07p-54
#define PL_HALF_PI_LO2 (-0x1.f1976b7ed8fbcp-110)

typedef union pl_double_bits {
  double value;
  uint64_t bits;
} pl_double_bits;

PL_ELEMENTARY uint64_t pl_to_bits(double x) {
  pl_double_bits u;
  u.value = x;
  return u.bits;
}

PL_ELEMENTARY double pl_from_bits(uint64_t bits) {
  pl_double_bits u;
  u.bits = bits;
  return u.value;
}

PL_ELEMENTARY double pl_fma(double a, double b, double c) {
  return __builtin_fma(a, b, c);
}
PL_ELEMENTARY double pl_abs(double x) {
  return __builtin_fabs(x);
}
PL_ELEMENTARY double pl_sqrt(double x) {
  return __builtin_sqrt(x);
}

/* Smaller and larger of two; NaN if either is NaN. The second where they are equal (which matters
 * for -0 only). */
PL_ELEMENTARY double pl_min(double a, double b) {
  const double least = a < b ? a : b;
  return a != a ? a : least;
}

PL_ELEMENTARY double pl_max(double a, double b) {
  const double most = a > b ? a : b;
  return a != a ? a : most;
}

/* The other where one is NaN, as C's fmin and fmax; the first of 0 and -0, which these leave to the
 * compiler. */
PL_ELEMENTARY double pl_fmin(double a, double b) {
  return ((a <= b) | (b != b)) ? a : b;
}

PL_ELEMENTARY double pl_fmax(double a, double b) {
  return ((a >= b) | (b != b)) ? a : b;
}

/* Smaller and larger, but b where either is NaN. */
PL_ELEMENTARY double pl_smaller(double a, double b) {
  return a < b ? a : b;
}

PL_ELEMENTARY double pl_larger(double a, double b) {
  return a > b ? a : b;
}

/* -1, 0 or 1; NaN of NaN. */
PL_ELEMENTARY double pl_sign(double x) {
  return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : x);
}

PL_ELEMENTARY double pl_copy_sign(double size, double sign) {
  return __builtin_copysign(size, sign);
}

/* 2^k for the integer that PL_ROUNDER was added to, -1022 <= k <= 1023. */
PL_ELEMENTARY double pl_two_to(double rounded) {
  return pl_from_bits((pl_to_bits(rounded) << 52) + UINT64_C(0x3ff0000000000000));
}

/* exp(r) - 1 for |r| <= 0.35: fit of (exp(r) - 1 - r)/r^2. */
PL_ELEMENTARY double pl_exp_reduced(double r) {
  double p = 0x1.1f8b52a3be241p-29;
  p = pl_fma(p, r, 0x1.af4df5e04471ap-26);
  p = pl_fma(p, r, 0x1.27e4ccc920a20p-22);
  p = pl_fma(p, r, 0x1.71de022b9aeffp-19);
  p = pl_fma(p, r, 0x1.a01a01acfd415p-16);
  p = pl_fma(p, r, 0x1.a01a01abe9e59p-13);
  p = pl_fma(p, r, 0x1.6c16c16c151f4p-10);
  p = pl_fma(p, r, 0x1.11111111100d8p-7);
  p = pl_fma(p, r, 0x1.5555555555558p-5);
  p = pl_fma(p, r, 0x1.5555555555557p-3);
  p = pl_fma(p, r, 0x1.0000000000000p-1);
  return pl_fma(r * r, p, r);
}

/* exp(x + tail), |tail| far below |x|. Scaled by 2^k in two factors, so that subnormal results
 * round once. */
PL_ELEMENTARY double pl_exp_sum(double x, double tail) {
  const double low = x < -750.0 ? -750.0 : x;
  const double held = low > 710.0 ? 710.0 : low;
  const double k = (held * 0x1.71547652b82fep+0 + PL_ROUNDER) - PL_ROUNDER;
  const double near = pl_fma(-k, PL_LN2_HI, held); /* exact */
  const double r = near + pl_fma(-k, PL_LN2_LO, tail);
  const double half = k * 0.5 + PL_ROUNDER;
  const double rest = (k - (half - PL_ROUNDER)) + PL_ROUNDER;
  return (1.0 + pl_exp_reduced(r)) * pl_two_to(half) * pl_two_to(rest);
}

PL_ELEMENTARY double pl_exp(double x) {
  return pl_exp_sum(x, 0.0);
}

/* x > 0 as 2^exponent (1 + fraction), sqrt(1/2) <= 1 + fraction < sqrt(2). */
typedef struct pl_parts {
  double exponent, fraction;
} pl_parts;

PL_ELEMENTARY pl_parts pl_take_apart(double x) {
  const int subnormal = x < 0x1p-1022;
  const double normal = subnormal ? x * 0x1p54 : x;
  const uint64_t root_half = UINT64_C(0x3fe6a09e667f3bcd);
  const uint64_t shifted = pl_to_bits(normal) + (UINT64_C(0x3ff0000000000000) - root_half);
  const double exponent =
      pl_from_bits((shifted >> 52) | UINT64_C(0x4330000000000000)) - (0x1p52 + 1023.0);
  pl_parts parts;
  parts.exponent = subnormal ? exponent - 54.0 : exponent;
  parts.fraction = pl_from_bits((shifted & UINT64_C(0x000fffffffffffff)) + root_half) - 1.0;
  return parts;
}

/* f - log(1 + f), where log(1 + f) = 2 atanh(s), s = f/(2 + f); fit of (atanh(s)/s - 1)/s^2 in s^2.
 */
PL_ELEMENTARY double pl_log_less(double f) {
  const double s = f / (2.0 + f);
  const double z = s * s;
  double p = 0x1.0c11348cee62ap-4;
  p = pl_fma(p, z, 0x1.0fbd3d1a064d2p-4);
  p = pl_fma(p, z, 0x1.3b1c42bf11682p-4);
  p = pl_fma(p, z, 0x1.745cf8c2a17edp-4);
  p = pl_fma(p, z, 0x1.c71c7201ff537p-4);
  p = pl_fma(p, z, 0x1.2492492476692p-3);
  p = pl_fma(p, z, 0x1.9999999999a3ap-3);
  p = pl_fma(p, z, 0x1.5555555555555p-2);
  return s * (f - 2.0 * z * p);
}

/* A logarithm of x whose value is `sum` where x is positive and finite. */
PL_ELEMENTARY double pl_log_ends(double x, double sum) {
  const double at_end = x == 0.0 ? -PL_INFINITY : (x < 0.0 ? PL_NAN : x);
  return x > 0.0 ? (x < PL_INFINITY ? sum : x) : at_end;
}

PL_ELEMENTARY double pl_log(double x) {
  const pl_parts parts = pl_take_apart(x);
  const double f = parts.fraction, less = pl_log_less(f);
  return pl_log_ends(x, parts.exponent * PL_LN2_SHORT +
                            (f - pl_fma(-parts.exponent, PL_LN2_REST, less)));
}

/* log(1 + f) as a sum of two doubles, times log10(e). Of powers of ten it is whole. */
PL_ELEMENTARY double pl_log10(double x) {
  const pl_parts parts = pl_take_apart(x);
  const double f = parts.fraction, less = pl_log_less(f);
  const double l = f - less, l_tail = (f - l) - less;
  const double g = l * PL_LGE_HI;
  const double g_tail = pl_fma(l, PL_LGE_HI, -g) + pl_fma(l, PL_LGE_LO, l_tail * PL_LGE_HI);
  const double whole = parts.exponent * PL_LG2_SHORT; /* exact */
  const double sum = whole + g, tail = (whole - sum) + g;
  return pl_log_ends(x, sum + (tail + pl_fma(parts.exponent, PL_LG2_REST, g_tail)));
}

/* x^y for x > 0: the logarithm as a sum of two doubles (relative error 2^-65), times y, then exp.
 */
PL_ELEMENTARY double pl_pow_positive(double x, double y) {
  const pl_parts parts = pl_take_apart(x);
  const double f = parts.fraction;
  const double d = 2.0 + f, d_tail = f - (d - 2.0);
  const double inverse = 1.0 / d;
  const double s = f * inverse;
  const double s_tail = (pl_fma(-s, d, f) - s * d_tail) * inverse;
  const double z = s * s;
  const double z_tail = pl_fma(s, s, -z) + 2.0 * s * s_tail;
  double p = 0x1.e045d4712d5fcp-5; /* fit of ((atanh(s)/s - 1)/s^2 - 1/3)/s^2 in s^2 */
  p = pl_fma(p, z, 0x1.df7a766f361a5p-5);
  p = pl_fma(p, z, 0x1.1118d37799539p-4);
  p = pl_fma(p, z, 0x1.3b139598fbdcep-4);
  p = pl_fma(p, z, 0x1.745d177b266f6p-4);
  p = pl_fma(p, z, 0x1.c71c71c6e9f38p-4);
  p = pl_fma(p, z, 0x1.2492492492524p-3);
  p = pl_fma(p, z, 0x1.999999999999ap-3);
  const double third = 0x1.5555555555555p-2, third_tail = 0x1.5555555555555p-56;
  const double c = pl_fma(z, p, third);
  const double c_tail = pl_fma(z, p, third - c) + third_tail;
  const double w = s * z;
  const double w_tail = pl_fma(s, z, -w) + (s * z_tail + s_tail * z);
  const double v = w * c;
  const double v_tail = pl_fma(w, c, -v) + (w * c_tail + w_tail * c);
  const double a = s + v; /* atanh(s) */
  const double a_tail = (v - (a - s)) + (s_tail + v_tail);
  const double e = parts.exponent * PL_LN2_SHORT;
  const double l = e + 2.0 * a;
  const double l_tail = (2.0 * a - (l - e)) + pl_fma(parts.exponent, PL_LN2_REST, 2.0 * a_tail);
  const double t = y * l;
  const double t_tail = pl_fma(y, l, -t) + y * l_tail;
  return pl_exp_sum(t, pl_abs(t) < 1000.0 ? t_tail : 0.0);
}

/* A negative x has real powers for whole y only; NaN otherwise. x^0 = 1^y = 1, even of NaN. */
PL_ELEMENTARY double pl_pow(double x, double y) {
  const double size = pl_abs(x), y_size = pl_abs(y);
  const double whole_part = y_size < 0x1p52 ? (y_size + 0x1p52) - 0x1p52 : y_size;
  const double y_half = y_size < 0x1p53 ? y_size * 0.5 : 0.0;
  const double odd = /* 0, or a half */
      whole_part == y_size ? ((y_half + 0x1p52) - 0x1p52) - y_half : 0.0;
  const double grows = y > 0.0 ? PL_INFINITY : 0.0, shrinks = y > 0.0 ? 0.0 : PL_INFINITY;
  const double to_the_infinite = size == 1.0 ? 1.0 : (size > 1.0 ? grows : shrinks);
  double r = pl_pow_positive(size, y);
  r = y_size == PL_INFINITY ? to_the_infinite : r;
  r = size == PL_INFINITY ? grows : r;
  r = size == 0.0 ? shrinks : r;
  r = odd != 0.0 ? pl_copy_sign(r, x) : r;
  const double real = whole_part == y_size ? r : PL_NAN;
  r = ((x < 0.0) & (size < PL_INFINITY)) ? real : r;
  r = ((x != x) | (y != y)) ? x + y : r;
  return ((y == 0.0) | (x == 1.0)) ? 1.0 : r;
}

/* Cube root, of negative numbers too. 1/cbrt by a fit on [1, 2) and one step of third order, then y
   = m/cbrt^2 with one Newton step whose residual is exact. */
PL_ELEMENTARY double pl_cbrt(double x) {
  const double size = pl_abs(x);
  const int subnormal = size < 0x1p-1022;
  const uint64_t bits = pl_to_bits(subnormal ? size * 0x1p54 : size);
  const double e = pl_from_bits((bits >> 52) | UINT64_C(0x4330000000000000)) - (0x1p52 + 1023.0);
  const double rounded = (e - 1.0) * 0x1.5555555555555p-2 + PL_ROUNDER; /* floor(e/3) */
  const double left = e - 3.0 * (rounded - PL_ROUNDER);                 /* 0, 1 or 2 */
  const double one_to_two =
      pl_from_bits((bits & UINT64_C(0x000fffffffffffff)) | UINT64_C(0x3ff0000000000000));
  double r = 0x1.d471ea27097e4p-6; /* fit of m^(-1/3) */
  r = pl_fma(r, one_to_two, -0x1.c51a35f7faa36p-3);
  r = pl_fma(r, one_to_two, 0x1.64175443dd0aep-1);
  r = pl_fma(r, one_to_two, -0x1.2c425f73716fap+0);
  r = pl_fma(r, one_to_two, 0x1.ab85bc816e1bep+0);
  r *= left == 0.0 ? 1.0 : (left == 1.0 ? 0x1.965fea53d6e3dp-1 : 0x1.428a2f98d728bp-1);
  const double m = one_to_two * (left == 0.0 ? 1.0 : (left == 1.0 ? 2.0 : 4.0));
  const double h = pl_fma(-m * r, r * r, 1.0);
  r = pl_fma(r * h, pl_fma(h, 0x1.c71c71c71c71cp-3, 0x1.5555555555555p-2), r);
  const double y = m * r * r;
  const double square = y * y, square_tail = pl_fma(y, y, -square);
  const double residual = pl_fma(-square, y, m) - square_tail * y;
  const double root = pl_fma(residual, r * r * 0x1.5555555555555p-2, y) * pl_two_to(rounded);
  const double finite = pl_copy_sign(subnormal ? root * 0x1p-18 : root, x);
  return ((size > 0.0) & (size < PL_INFINITY)) ? finite : x;
}

/* 1/sqrt(x) of a normal x > 0, without the processor's slow divider: half the exponent with the
   mantissa's bits as a first guess (off by 3.5 %), a fit of (1 - e)^(-1/2) with e = 1 - x guess^2,
   and a step of third order. */
PL_ELEMENTARY double pl_inverse_root(double x) {
  const double halved = pl_from_bits(UINT64_C(0x5fe6eb50c7b537a9) - (pl_to_bits(x) >> 1));
  const double guess = ((x >= 0x1p-1022) & (x < PL_INFINITY)) ? halved : PL_NAN;
  const double e = pl_fma(-(x * guess), guess, 1.0);
  double p = 0x1.3fb9f447738bep-2;
  p = pl_fma(p, e, 0x1.814ff73d7fbbep-2);
  p = pl_fma(p, e, 0x1.0000591eb5bddp-1);
  p = pl_fma(p, e, 0x1.ffffe6d78db8bp-1);
  const double near = guess * p;
  const double rest = pl_fma(-(x * near), near, 1.0);
  return pl_fma(near * rest, pl_fma(0.375, rest, 0.5), near);
}

/* sqrt(x^2 + y^2), both scaled by a power of two near the larger. */
PL_ELEMENTARY double pl_hypot(double x, double y) {
  const double x_size = pl_abs(x), y_size = pl_abs(y);
  const double larger = x_size > y_size ? x_size : y_size;
  const uint64_t scale =
      UINT64_C(0x7fd0000000000000) - (pl_to_bits(larger) & UINT64_C(0x7fc0000000000000));
  const double a = x * pl_from_bits(scale), b = y * pl_from_bits(scale);
  const double root = pl_sqrt(a * a + b * b) * pl_from_bits(UINT64_C(0x7fe0000000000000) - scale);
  return ((x_size == PL_INFINITY) | (y_size == PL_INFINITY)) ? PL_INFINITY : root;
}

/* x = quarter pi/2 + angle + tail, |angle| <= pi/4. */
typedef struct pl_quarter_turn {
  double angle, tail;
  uint64_t quarter;
} pl_quarter_turn;

PL_ELEMENTARY pl_quarter_turn pl_take_quarters(double x) {
  const double held = pl_abs(x) <= 0x1p30 ? x : PL_NAN;
  const double rounded = held * 0x1.45f306dc9c883p-1 + PL_ROUNDER;
  const double k = rounded - PL_ROUNDER;
  const double near = pl_fma(-k, PL_HALF_PI_HI, held); /* exact */
  const double less = -k * PL_HALF_PI_LO, less_tail = pl_fma(-k, PL_HALF_PI_LO, -less);
  const double sum = near + less,
               part = sum - near; /* near a multiple of pi/2 either may be the larger */
  pl_quarter_turn turn;
  turn.angle = sum;
  turn.tail = ((near - (sum - part)) + (less - part)) + pl_fma(-k, PL_HALF_PI_LO2, less_tail);
  turn.quarter = pl_to_bits(rounded);
  return turn;
}

/* Sine of a reduced angle after `more` further quarter turns. Fits of (sin(r)/r - 1)/r^2 and
 * (cos(r) - 1 + r^2/2)/r^4. */
PL_ELEMENTARY double pl_turned_sine(pl_quarter_turn turn, uint64_t more) {
  const double r = turn.angle, z = r * r;
  const uint64_t quarter = turn.quarter + more;
  double s = 0x1.5e0b069c6721dp-33;
  s = pl_fma(s, z, -0x1.ae600ad40ebbcp-26);
  s = pl_fma(s, z, 0x1.71de379665975p-19);
  s = pl_fma(s, z, -0x1.a01a019e8396cp-13);
  s = pl_fma(s, z, 0x1.1111111110bb2p-7);
  s = pl_fma(s, z, -0x1.5555555555555p-3);
  double c = -0x1.907d8dea09a9fp-37;
  c = pl_fma(c, z, 0x1.1eeb68cea0ff7p-29);
  c = pl_fma(c, z, -0x1.27e4fa17c446ap-22);
  c = pl_fma(c, z, 0x1.a01a019f4ea2ep-16);
  c = pl_fma(c, z, -0x1.6c16c16c16967p-10);
  c = pl_fma(c, z, 0x1.5555555555555p-5);
  const double sine = r + pl_fma(r * z, s, pl_fma(-0.5 * z, turn.tail, turn.tail));
  const double head = pl_fma(-0.5, z, 1.0);
  const double cosine = head + (pl_fma(-0.5, z, 1.0 - head) + pl_fma(z * z, c, -r * turn.tail));
  const double size = (quarter & 1) ? cosine : sine;
  return pl_from_bits(pl_to_bits(size) ^ ((quarter & 2) << 62));
}

PL_ELEMENTARY double pl_sin(double x) {
  const double y = pl_turned_sine(pl_take_quarters(x), 0);
  return x == 0.0 ? x : y;
}
PL_ELEMENTARY double pl_cos(double x) {
  return pl_turned_sine(pl_take_quarters(x), 1);
}

PL_ELEMENTARY double pl_tan(double x) {
  const pl_quarter_turn turn = pl_take_quarters(x);
  const double y = pl_turned_sine(turn, 0) / pl_turned_sine(turn, 1);
  return x == 0.0 ? x : y;
}

/* Half of exp(x) as a sum of two doubles, for x >= 0; infinite from 711 on. */
typedef struct pl_grown {
  double half, tail;
} pl_grown;

PL_ELEMENTARY pl_grown pl_half_exp(double x) {
  const double held = x > 711.0 ? 711.0 : x;
  const double k = (held * 0x1.71547652b82fep+0 + PL_ROUNDER) - PL_ROUNDER;
  const double r = pl_fma(-k, PL_LN2_LO, pl_fma(-k, PL_LN2_HI, held));
  const double q = pl_exp_reduced(r), one = 1.0 + q, one_tail = q - (one - 1.0);
  const double first = k * 0.5 + PL_ROUNDER;
  const double rest = (k - 1.0 - (first - PL_ROUNDER)) + PL_ROUNDER;
  const double scale = pl_two_to(first), more = pl_two_to(rest);
  pl_grown grown;
  grown.half = one * scale * more;
  grown.tail = one_tail * scale * more;
  return grown;
}

/* Up to |x| = 1 a fit of (sinh(x)/x - 1)/x^2 in x^2; beyond, e - 1/(4 e) with e = exp(|x|)/2. */
PL_ELEMENTARY double pl_sinh(double x) {
  const double size = pl_abs(x), z = x * x;
  double p = 0x1.b4c75a357a601p-41;
  p = pl_fma(p, z, 0x1.611a561f36ba1p-33);
  p = pl_fma(p, z, 0x1.ae64671b14757p-26);
  p = pl_fma(p, z, 0x1.71de3a465b241p-19);
  p = pl_fma(p, z, 0x1.a01a01a02899dp-13);
  p = pl_fma(p, z, 0x1.11111111110a6p-7);
  p = pl_fma(p, z, 0x1.5555555555556p-3);
  const double near = pl_fma(x * z, p, x);
  const pl_grown e = pl_half_exp(size);
  const double far = e.half + (e.tail - 0.25 / e.half);
  return size <= 1.0 ? near : pl_copy_sign(far, x);
}

PL_ELEMENTARY double pl_cosh(double x) {
  const pl_grown e = pl_half_exp(pl_abs(x));
  return e.half + (e.tail + 0.25 / e.half);
}

/* t/(t + 2) with t = exp(2|x|) - 1; 1 from |x| = 22 on. */
PL_ELEMENTARY double pl_tanh(double x) {
  const double size = pl_abs(x);
  const double twice = 2.0 * (size > 22.0 ? 22.0 : size);
  const double rounded = twice * 0x1.71547652b82fep+0 + PL_ROUNDER;
  const double k = rounded - PL_ROUNDER;
  const double r = pl_fma(-k, PL_LN2_LO, pl_fma(-k, PL_LN2_HI, twice));
  const double scale = pl_two_to(rounded);
  const double q = pl_exp_reduced(r);
  const double t = pl_fma(scale, q, scale - 1.0), t_tail = pl_fma(scale, q, (scale - 1.0) - t);
  const double d = t + 2.0, d_tail = t - (d - 2.0);
  const double inverse = 1.0 / d;
  const double y = t * inverse;
  const double residual = pl_fma(-y, d, t) + (pl_fma(-y, t_tail, t_tail) - y * d_tail);
  return pl_copy_sign(pl_fma(residual, inverse, y), x);
}

/* Angle of the vector (x, y), -pi to pi, with the signs of C's atan2 at the ends.
   The smaller over the larger component is at most 1; above tan(pi/8) pi/4 is taken off before the
   one division, t = (small - large)/(small + large), whose rounding errors are carried along. Fit
   of (atan(t)/t - 1)/t^2 in t^2. The result is a whole number of quarters of pi, in two parts, plus
   or minus atan(t). */
PL_ELEMENTARY double pl_atan2(double y, double x) {
  const double y_size = pl_abs(y), x_size = pl_abs(x);
  const int steep = y_size > x_size;
  double large = steep ? y_size : x_size;
  double small = steep ? x_size : y_size;
  /* infinities become 1 and 0 or 1; the origin 0/1; both are scaled by a power of two to keep 1/d
   * in range */
  small = large == PL_INFINITY ? (small == PL_INFINITY ? 1.0 : small * 0.0) : small;
  large = ((large == PL_INFINITY) | (large == 0.0)) ? 1.0 : large;
  const double scale = pl_from_bits(UINT64_C(0x7fd0000000000000) -
                                    (pl_to_bits(large) & UINT64_C(0x7fc0000000000000)));
  small *= scale;
  large *= scale;
  const int diagonal = small > 0x1.a827999fcef32p-2 * large;
  const double taken = diagonal ? large : 0.0, added = diagonal ? small : 0.0;
  const double n = small - taken, n_tail = small - (n + taken);
  const double d = large + added, d_tail = (large - d) + added;
  const double inverse = 1.0 / d;
  const double t = n * inverse;
  const double t_tail = (pl_fma(-t, d, n) + (n_tail - t * d_tail)) * inverse;
  const double z = t * t;
  const double zz = z * z; /* two chains, even and odd: half the latency */
  double p = pl_fma(-0x1.3b02b8b76b805p-6, zz, -0x1.a0ba7877adae3p-5);
  double q = pl_fma(0x1.41bca36edd44fp-5, zz, 0x1.dfecf0372d6d7p-5);
  p = pl_fma(p, zz, -0x1.10fadfd8bd436p-4);
  q = pl_fma(q, zz, 0x1.3b126ae978013p-4);
  p = pl_fma(p, zz, -0x1.745d0b85c3571p-4);
  q = pl_fma(q, zz, 0x1.c71c7187b4f76p-4);
  p = pl_fma(p, zz, -0x1.249249243a5ffp-3);
  q = pl_fma(q, zz, 0x1.99999999993a7p-3);
  p = pl_fma(p, zz, -0x1.5555555555555p-2);
  const double arc_tail = pl_fma(t * z, pl_fma(q, z, p), t_tail);
  const double side = pl_copy_sign(1.0, x); /* -1 of -0 too */
  double quarters = diagonal ? 1.0 : 0.0;
  quarters = steep ? 2.0 - quarters : quarters;
  quarters = side < 0.0 ? 4.0 - quarters : quarters;
  const double turn = steep ? -side : side;
  const double arc = pl_fma(quarters, 0.5 * PL_HALF_PI_LO, turn * (t + arc_tail));
  return pl_copy_sign(pl_fma(quarters, 0.5 * PL_HALF_PI_HI, arc), y);
}

/* asin(r) = r + r z P(z), z = r^2, of r = |x| up to 1/2, and beyond it of r = sqrt((1 - |x|)/2), as
   r + rest: then asin|x| = pi/2 - 2 (r + rest). Fit of (asin(r)/r - 1)/r^2 in r^2. NaN for
   |x| > 1. */
typedef struct pl_arc {
  double r, rest;
  int folded;
} pl_arc;

PL_ELEMENTARY pl_arc pl_arc_sine(double x) {
  const double size = pl_abs(x);
  const int folded = size > 0.5;
  const double z = folded ? 0.5 * (1.0 - size) : x * x; /* exact where it is folded */
  const double r = folded ? pl_sqrt(z) : size;
  const double left = folded ? pl_fma(-r, r, z) : 0.0;
  const double tail = left / (2.0 * (r > 0.0 ? r : 1.0));
  double p = 0x1.0b4abd1c08af5p-5;
  p = pl_fma(p, z, -0x1.580b058e1966bp-6);
  p = pl_fma(p, z, 0x1.63a69db8b2212p-6);
  p = pl_fma(p, z, 0x1.e5d1cbd888482p-9);
  p = pl_fma(p, z, 0x1.613f179f0c481p-7);
  p = pl_fma(p, z, 0x1.75850bb687461p-7);
  p = pl_fma(p, z, 0x1.ca1f9e4c44745p-7);
  p = pl_fma(p, z, 0x1.1c49ef94f8477p-6);
  p = pl_fma(p, z, 0x1.6e8bdeecd6434p-6);
  p = pl_fma(p, z, 0x1.f1c71a946e2fap-6);
  p = pl_fma(p, z, 0x1.6db6db721412bp-5);
  p = pl_fma(p, z, 0x1.333333332e103p-4);
  p = pl_fma(p, z, 0x1.5555555555577p-3);
  pl_arc arc;
  arc.r = r;
  arc.rest = pl_fma(r * z, p, tail);
  arc.folded = folded;
  return arc;
}

PL_ELEMENTARY double pl_asin(double x) {
  const pl_arc arc = pl_arc_sine(x);
  const double near = arc.r + arc.rest;
  const double far = PL_HALF_PI_HI - (2.0 * arc.r - (PL_HALF_PI_LO - 2.0 * arc.rest));
  return x != x ? x : pl_copy_sign(arc.folded ? far : near, x);
}

/* pi/2 - asin(x); near 1 twice the folded angle itself, so that small angles keep their digits. */
PL_ELEMENTARY double pl_acos(double x) {
  const pl_arc arc = pl_arc_sine(x);
  const double r = pl_copy_sign(arc.r, x), rest = pl_copy_sign(1.0, x) * arc.rest;
  const double near = PL_HALF_PI_HI - (r - (PL_HALF_PI_LO - rest));
  const double twice = 2.0 * (arc.r + arc.rest);
  const double back = 2.0 * (PL_HALF_PI_HI - (arc.r - (PL_HALF_PI_LO - arc.rest)));
  const double far = x > 0.0 ? twice : back;
  return x != x ? x : (arc.folded ? far : near);
}

/* Where a search for the root of a rising function is: at z, the root between low and high, by a
   step of Newton's of the size `last` and a move as large as `move`; going 0: it has ended. */
typedef struct pl_search_place {
  double z, low, high, last, move, going;
} pl_search_place;

#define PL_SEARCH_STEPS 100 /* at most */

PL_ELEMENTARY pl_search_place pl_search_from(double z) {
  const pl_search_place at = {z, -PL_INFINITY, PL_INFINITY, PL_INFINITY, 0.0, 1.0};
  return at;
}

/* On by Newton's step; halfway between low and high where that leads out or is more than half the
   last one; while one of them is not known, four times the last move where it is more than 3/4 of
   the last one (a function that is flat here). Where nothing is `open` it takes the step and ends.
   */
PL_ELEMENTARY pl_search_place pl_search(pl_search_place at, double step, double open) {
  const double size = pl_abs(step), newton = at.z + step;
  const double low = step > 0.0 ? at.z : at.low, high = step < 0.0 ? at.z : at.high;
  const double middle = 0.5 * (low + high), far = at.z + pl_copy_sign(4.0 * at.move, step);
  const double below = newton < high ? 1.0 : 0.0, inside = newton > low ? below : 0.0;
  const double held = 2.0 * size <= at.last ? inside : 0.0;
  const double between = held != 0.0 ? newton : middle;
  const double beyond = 4.0 * size <= 3.0 * at.last ? newton : far;
  const double next = high - low < PL_INFINITY ? between : beyond;
  const double end = inside != 0.0 ? newton : at.z;
  const double z = open != 0.0 ? next : end;
  const double moves = z != at.z ? open : 0.0, goes_on = step == step ? moves : 0.0;
  pl_search_place to;
  to.z = at.going != 0.0 ? z : at.z;
  to.low = at.going != 0.0 ? low : at.low;
  to.high = at.going != 0.0 ? high : at.high;
  to.last = at.going != 0.0 ? size : at.last;
  to.move = at.going != 0.0 ? pl_abs(z - at.z) : at.move;
  to.going = at.going != 0.0 ? goes_on : 0.0;
  return to;
}

/* x less whole turns, in (-pi, pi] as far as doubles can tell: at most the double nearest to pi in
 * size. */
PL_ELEMENTARY double pl_wrap_angle(double x) {
  const double pi = 2.0 * PL_HALF_PI_HI, turn = 4.0 * PL_HALF_PI_HI,
               turn_tail = 4.0 * PL_HALF_PI_LO;
  const double k = (x * 0x1.45f306dc9c883p-3 + PL_ROUNDER) - PL_ROUNDER;
  const double angle = pl_fma(-k, turn_tail, pl_fma(-k, turn, x)); /* the inner one is exact */
  const double below =
      angle > pi ? (angle - turn) - turn_tail : angle; /* k was rounded at the cut */
  return below < -pi ? (below + turn) + turn_tail : below;
}

#endif
