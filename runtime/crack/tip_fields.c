#include "runtime/crack/tip_fields.h"

#include <math.h>

#include "dsl/base/elementary.h"

typedef struct tip_motion {
  double a_d, a_s, D; /* of a speed */
} tip_motion;

static tip_motion motion_of(const crack_medium *m, double v) {
  return (tip_motion){sqrt(1 - v * v / (m->c_d * m->c_d)), sqrt(1 - v * v / (m->c_s * m->c_s)),
                      rayleigh_function(m, v)};
}

/* A displacement is the real or imaginary part of p S_d + q S_s. */
typedef struct component {
  double p, q;
  int imaginary;
} component;

static component component_of(const tip_motion *t, int mode, int i) {
  const double s = 1 + t->a_s * t->a_s;
  if (mode == 1)
    return i == 0 ? (component){s, -2 * t->a_d * t->a_s, 0}
                  : (component){-t->a_d * s, 2 * t->a_d, 1};
  return i == 0 ? (component){2 * t->a_s, -t->a_s * s, 1} : (component){2 * t->a_s * t->a_d, -s, 0};
}

/* By hand: libraries differ in the last bits of complex roots. */
typedef struct complex_number {
  double re, im;
} complex_number;

static complex_number times(complex_number a, complex_number b) {
  return (complex_number){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

/* Principal root. */
static complex_number root(double re, double im) {
  const double size = pl_hypot(re, im);
  const double large = sqrt(0.5 * (size + fabs(re)));
  if (large == 0) return (complex_number){0, 0};
  const double small = 0.5 * fabs(im) / large, sign = signbit(im) ? -1 : 1;
  return re >= 0 ? (complex_number){large, sign * small} : (complex_number){small, sign * large};
}

/* S = sqrt(x + i a y) with its first and second derivative by x. */
typedef struct tip_root {
  complex_number value, slope, second;
} tip_root;

static tip_root root_of(double x, double a_y) {
  const complex_number s = root(x, a_y);
  const double square = s.re * s.re + s.im * s.im;
  const complex_number inverse = {s.re / square, -s.im / square};
  const complex_number cube = times(inverse, times(inverse, inverse));
  return (tip_root){s, {0.5 * inverse.re, 0.5 * inverse.im}, {-0.25 * cube.re, -0.25 * cube.im}};
}

static double part(const component *c, complex_number d, complex_number s) {
  return c->imaginary ? c->p * d.im + c->q * s.im : c->p * d.re + c->q * s.re;
}

/* i a z. */
static complex_number turned(double a, complex_number z) {
  return (complex_number){-a * z.im, a * z.re};
}

tip_field tip_field_at(const crack_medium *m, int mode, double v, double x, double y) {
  const tip_motion t = motion_of(m, v);
  const tip_root d = root_of(x, t.a_d * y), s = root_of(x, t.a_s * y);
  const double C = 2 / (m->mu * t.D * sqrt(2 * M_PI));
  tip_field f;
  for (int k = 0; k < 2; k++) {
    const component c = component_of(&t, mode, k);
    f.u[k] = C * part(&c, d.value, s.value);
    f.gradient[k][0] = C * part(&c, d.slope, s.slope);
    f.gradient[k][1] = C * part(&c, turned(t.a_d, d.slope), turned(t.a_s, s.slope));
    const double second = C * part(&c, d.second, s.second);
    f.velocity[k] = -v * f.gradient[k][0];
    f.velocity_slope[k] = -v * second;
    f.acceleration[k] = v * v * second;
  }
  f.stress[0] = m->D11 * f.gradient[0][0] + m->D12 * f.gradient[1][1];
  f.stress[1] = m->D12 * f.gradient[0][0] + m->D11 * f.gradient[1][1];
  f.stress[2] = m->mu * (f.gradient[0][1] + f.gradient[1][0]);
  return f;
}

double tip_energy_release(const crack_medium *m, double v, const double K[2]) {
  const tip_motion t = motion_of(m, v);
  return v * v / (2 * m->mu * m->c_s * m->c_s * t.D) * (t.a_d * K[0] * K[0] + t.a_s * K[1] * K[1]);
}

double tip_factor(const crack_medium *m, int mode, double v) {
  const tip_motion t = motion_of(m, v);
  return m->mu * m->c_s * m->c_s * t.D / (v * v * (mode == 1 ? t.a_d : t.a_s));
}
