#include "runtime/crack/tip_fields.h"

#include <complex.h>
#include <math.h>

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

static double part(const component *c, double complex d, double complex s) {
  const double complex sum = c->p * d + c->q * s;
  return c->imaginary ? cimag(sum) : creal(sum);
}

tip_field tip_field_at(const crack_medium *m, int mode, double v, double x, double y) {
  const tip_motion t = motion_of(m, v);
  const double complex i = CMPLX(0, 1);
  const double complex d = csqrt(CMPLX(x, t.a_d * y)), s = csqrt(CMPLX(x, t.a_s * y));
  const double complex d1 = 0.5 / d, s1 = 0.5 / s;                           /* by x */
  const double complex d11 = -0.25 / (d * d * d), s11 = -0.25 / (s * s * s); /* twice */
  const double C = 2 / (m->mu * t.D * sqrt(2 * M_PI));
  tip_field f;
  for (int k = 0; k < 2; k++) {
    const component c = component_of(&t, mode, k);
    f.u[k] = C * part(&c, d, s);
    f.gradient[k][0] = C * part(&c, d1, s1);
    f.gradient[k][1] = C * part(&c, i * t.a_d * d1, i * t.a_s * s1);
    const double second = C * part(&c, d11, s11);
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
