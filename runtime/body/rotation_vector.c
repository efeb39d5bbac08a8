#include "runtime/body/rotation_vector.h"

#include <math.h>
#include <stdbool.h>

#include "dsl/base/elementary.h"
#include "runtime/base/lane_sum.h"

#define INLINE static inline __attribute__((always_inline))

INLINE double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Of a rotation vector, half the angle's cosine, and its sine over the angle: the unit quaternion
   is (cosine, sine_ratio r). */
typedef struct half_turn {
  double cosine, sine_ratio;
} half_turn;

INLINE half_turn half_of(const double r[3]) {
  const double angle = pl_fmax(sqrt(dot(r, r)), 1e-150);
  return (half_turn){pl_cos(0.5 * angle), pl_sin(0.5 * angle) / angle};
}

/* The same below a quarter of a radian, by Taylor's series. */
INLINE half_turn half_of_small(const double r[3]) {
  const double z = dot(r, r);
  double c = pl_fma(-1.0 / 3715891200, z, 1.0 / 10321920), s = 1.0 / 185794560;
  c = pl_fma(c, z, -1.0 / 46080), s = pl_fma(s, z, -1.0 / 645120);
  c = pl_fma(c, z, 1.0 / 384), s = pl_fma(s, z, 1.0 / 3840);
  c = pl_fma(c, z, -1.0 / 8), s = pl_fma(s, z, -1.0 / 48);
  return (half_turn){pl_fma(c, z, 1), pl_fma(s, z, 0.5)};
}

/* The product of the quaternions of a and r: its vector; returns its scalar. */
INLINE double product(const double r[3], half_turn of_r, const double a[3], half_turn of_a,
                      double v[3]) {
  const double both = of_r.sine_ratio * of_a.sine_ratio;
  const double of = of_a.cosine * of_r.sine_ratio, by = of_r.cosine * of_a.sine_ratio;
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    v[k] = of * r[k] + by * a[k] + both * (a[l] * r[m] - a[m] * r[l]);
  }
  return of_r.cosine * of_a.cosine - both * dot(r, a);
}

/* What makes a rotation vector of the quaternion's vector v. */
INLINE double scale_of(const double r[3], const double a[3], const double v[3], double cosine) {
  const double sine = pl_fmax(sqrt(dot(v, v)), 1e-150);
  const double angle = 2 * pl_atan2(sine, cosine);
  const double along = (dot(v, r) + dot(v, a)) / sine;
  const double turns = (along - angle) / (2 * M_PI) + PL_ROUNDER - PL_ROUNDER;
  return (angle + turns * (2 * M_PI)) / sine;
}

/* 2 asin(x)/x, |x| < 1/4: through Chebyshev's points, to 2^-57. */
INLINE double scale_of_small(const double v[3]) {
  static const double fit[] = {0x1.d5d1dd468133fp-7, 0x1.bfee93fe05a45p-7, 0x1.1c918d6b44a69p-6,
                               0x1.6e89a83cbf463p-6, 0x1.f1c7248fc2413p-6, 0x1.6db6db65902ffp-5,
                               0x1.33333333364fdp-4, 0x1.5555555555552p-3};
  const double z = dot(v, v);
  double ratio = fit[0];
  for (int k = 1; k < 8; k++)
    ratio = pl_fma(ratio, z, fit[k]);
  return 2 * pl_fma(ratio, z, 1);
}

INLINE bool is_small(const double r[3], const double a[3]) {
  return (dot(r, r) < 1.0 / 16) & (dot(a, a) < 1.0 / 16);
}

/* Then half the angle of both is below a quarter of a radian, too. With `small` this is known. */
INLINE void turn(double r[3], const double a[3], bool small) {
  double v[3], w[3];
  product(r, half_of_small(r), a, half_of_small(a), v);
  double scale = scale_of_small(v);
  if (!small) {
    const bool near = is_small(r, a);
    const double cosine = product(r, half_of(r), a, half_of(a), w);
    const double far = scale_of(r, a, w, cosine);
    scale = near ? scale : far;
    for (int k = 0; k < 3; k++)
      v[k] = near ? v[k] : w[k];
  }
  for (int k = 0; k < 3; k++)
    r[k] = scale * v[k];
}

void rotation_vector_turn(double r[3], const double a[3]) {
  turn(r, a, false);
}

typedef struct turning {
  double step;
  const double *rate[3];
  double *r[3];
} turning;

INLINE void find(const turning *t, long q, double r[3], double a[3]) {
  for (int k = 0; k < 3; k++) {
    r[k] = t->r[k][q];
    a[k] = t->step * t->rate[k][q];
  }
}

static bool are_small(const turning *t, long first, long end) {
  int64_t large = 0;
  INDEPENDENT
  for (long q = first; q < end; q++) {
    double r[3], a[3];
    find(t, q, r, a);
    large |= is_small(r, a) ? INT64_C(0) : INT64_C(1);
  }
  return !large;
}

INLINE void turn_part(const turning *t, long first, long end, bool small) {
  INDEPENDENT
  for (long q = first; q < end; q++) {
    double r[3], a[3];
    find(t, q, r, a);
    turn(r, a, small);
    for (int k = 0; k < 3; k++)
      t->r[k][q] = r[k];
  }
}

void rotation_vector_turn_all(long count, double step, const double *const rate[3],
                              double *const r[3]) {
  enum { PART = 64 };
  const turning t = {step, {rate[0], rate[1], rate[2]}, {r[0], r[1], r[2]}};
  for (long first = 0; first < count; first += PART) {
    const long end = first + PART < count ? first + PART : count;
    if (are_small(&t, first, end))
      turn_part(&t, first, end, true);
    else
      turn_part(&t, first, end, false);
  }
}

/* --- components that are held ----------------------------------------------------------------- */

/* b of the header, for |r| < 1/4 by its series. */
static double bend_of(double square) {
  static const double series[] = {1.0 / 47900160, 1.0 / 1209600, 1.0 / 30240, 1.0 / 720, 1.0 / 12};
  const double half = 0.5 * sqrt(square);
  double sum = 0;
  if (square >= 1.0 / 16) return (1 - half * pl_cos(half) / pl_sin(half)) / square;
  for (int k = 0; k < 5; k++)
    sum = sum * square + series[k];
  return sum;
}

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    c[k] = a[l] * b[m] - a[m] * b[l];
  }
}

/* g_c; of components that are not held 0. */
static void find_gradients(const double r[3], int held, double g[3][3]) {
  const double bend = bend_of(dot(r, r));
  for (int c = 0; c < 3; c++) {
    double e[3] = {c == 0, c == 1, c == 2}, once[3], twice[3];
    cross(r, e, once);
    cross(r, once, twice);
    for (int k = 0; k < 3; k++)
      g[c][k] = held >> c & 1 ? e[k] + 0.5 * once[k] + bend * twice[k] : 0;
  }
}

/* Factors x with sum over d of (g_c . g_d) x_d = b_c of what is held, of the others 0. By
   elimination: no pivot of such a matrix is 0. */
static void solve(const double g[3][3], int held, const double b[3], double x[3]) {
  double a[3][4];
  for (int c = 0; c < 3; c++) {
    for (int d = 0; d < 3; d++)
      a[c][d] = dot(g[c], g[d]) + (c == d && !(held >> c & 1));
    a[c][3] = held >> c & 1 ? b[c] : 0;
  }
  for (int c = 0; c < 3; c++)
    for (int row = c + 1; row < 3; row++) {
      const double factor = a[row][c] / a[c][c];
      for (int d = c; d < 4; d++)
        a[row][d] -= factor * a[c][d];
    }
  for (int c = 2; c >= 0; c--) {
    x[c] = a[c][3];
    for (int d = c + 1; d < 3; d++)
      x[c] -= a[c][d] * x[d];
    x[c] /= a[c][c];
  }
}

static void add_along(const double g[3][3], const double x[3], double factor, double to[3]) {
  for (int c = 0; c < 3; c++)
    for (int k = 0; k < 3; k++)
      to[k] += factor * x[c] * g[c][k];
}

/* Newton's method with the gradients at r: each turn brings the components nearer by as much as the
   step is small, until rounding is left. */
void rotation_vector_reach(const double r[3], double step, int held, const double target[3],
                           double w[3]) {
  enum { MOST = 40 };
  double g[3][3], before = INFINITY;
  find_gradients(r, held, g);
  for (int n = 0; n < MOST; n++) {
    double after[3] = {r[0], r[1], r[2]}, off[3], x[3], most = 0;
    const double turn[3] = {step * w[0], step * w[1], step * w[2]};
    rotation_vector_turn(after, turn);
    for (int c = 0; c < 3; c++) {
      off[c] = target[c] - after[c];
      if (held >> c & 1) most = pl_fmax(most, fabs(off[c]));
    }
    if (!(most > 0 && most < 0.5 * before)) return;
    before = most;
    solve(g, held, off, x);
    add_along(g, x, 1 / step, w);
  }
}

void rotation_vector_release(const double r[3], int held, double moment[3]) {
  double g[3][3], along[3], x[3];
  find_gradients(r, held, g);
  for (int c = 0; c < 3; c++)
    along[c] = dot(g[c], moment);
  solve(g, held, along, x);
  add_along(g, x, -1, moment);
}
