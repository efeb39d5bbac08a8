#include "runtime/crack/interaction_integral.h"

#include <math.h>

#include "dsl/base/elementary.h"

static const double SLOWEST = 0.01; /* of c_s: at rest the fields are 0/0 */
static const double LEG_USED = 0.95;

tip_box tip_box_of(const double at[2], double angle, double half_size, double last, bool shrink,
                   box_weight weight) {
  tip_box b = {.at = {at[0], at[1]}, .angle = angle, .weight = weight};
  b.behind = b.ahead = b.across = half_size;
  if (last >= half_size) return b;
  if (shrink) {
    b.behind = b.ahead = b.across = last;
  } else {
    b.behind = LEG_USED * last;
    b.ahead = 2 * half_size - b.behind;
  }
  return b;
}

/* From the body's axes to those of the crack. */
static void to_crack(const tip_box *b, const double at[2], double local[2]) {
  const double c = pl_cos(b->angle), s = pl_sin(b->angle),
               d[2] = {at[0] - b->at[0], at[1] - b->at[1]};
  local[0] = c * d[0] + s * d[1];
  local[1] = -s * d[0] + c * d[1];
}

/* At a part r of the way from the tip to the box's side; its slope by r. */
static double weight_of(box_weight kind, double r, double *slope) {
  if (kind == WEIGHT_PYRAMID) {
    *slope = -1;
    return 1 - r;
  }
  *slope = r < 0.5 ? 0 : -2;
  return r < 0.5 ? 1 : 2 - 2 * r;
}

static double weight_along(box_weight kind, double x, double below, double above, double *slope) {
  const double side = x < 0 ? below : above, value = weight_of(kind, fabs(x) / side, slope);
  *slope *= (x < 0 ? -1 : 1) / side;
  return value;
}

double tip_box_weight(const tip_box *b, const double at[2], double gradient[2]) {
  double local[2], along, across;
  to_crack(b, at, local);
  gradient[0] = gradient[1] = 0;
  if (local[0] <= -b->behind || local[0] >= b->ahead || fabs(local[1]) >= b->across) return 0;
  const double x = weight_along(b->weight, local[0], b->behind, b->ahead, &along),
               y = weight_along(b->weight, local[1], b->across, b->across, &across);
  gradient[0] = along * y;
  gradient[1] = x * across;
  return x * y;
}

void tip_box_extent(const tip_box *b, double lower[2], double upper[2]) {
  const double c = pl_cos(b->angle), s = pl_sin(b->angle);
  for (int a = 0; a < 2; a++) {
    const double along = a ? s : c, across = fabs(a ? c : s) * b->across;
    const double back = -b->behind * along, front = b->ahead * along;
    lower[a] = b->at[a] + pl_min(back, front) - across;
    upper[a] = b->at[a] + pl_max(back, front) + across;
  }
}

static void turn_vector(double c, double s, const double v[2], double out[2]) {
  out[0] = c * v[0] + s * v[1];
  out[1] = -s * v[0] + c * v[1];
}

/* R g R^T. */
static void turn_gradient(double c, double s, const double g[2][2], double out[2][2]) {
  double half[2][2];
  for (int k = 0; k < 2; k++) {
    half[0][k] = c * g[0][k] + s * g[1][k];
    half[1][k] = -s * g[0][k] + c * g[1][k];
  }
  for (int k = 0; k < 2; k++) {
    out[k][0] = half[k][0] * c + half[k][1] * s;
    out[k][1] = -half[k][0] * s + half[k][1] * c;
  }
}

/* The point in the axes of the crack. */
static tip_point turned(const tip_box *b, const tip_point *p) {
  const double c = pl_cos(b->angle), s = pl_sin(b->angle);
  const double stress[2][2] = {{p->stress[0], p->stress[2]}, {p->stress[2], p->stress[1]}};
  double local[2][2];
  tip_point t = {.area = p->area};
  to_crack(b, p->at, t.at);
  turn_gradient(c, s, p->gradient, t.gradient);
  turn_gradient(c, s, p->velocity_gradient, t.velocity_gradient);
  turn_gradient(c, s, stress, local);
  t.stress[0] = local[0][0];
  t.stress[1] = local[1][1];
  t.stress[2] = local[0][1];
  turn_vector(c, s, p->velocity, t.velocity);
  turn_vector(c, s, p->acceleration, t.acceleration);
  return t;
}

static double dot(const double a[2], const double b[2]) {
  return a[0] * b[0] + a[1] * b[1];
}

/* s_ij a_i q_,j. */
static double flux(const double s[3], const double a[2], const double q[2]) {
  return (s[0] * a[0] + s[2] * a[1]) * q[0] + (s[2] * a[0] + s[1] * a[1]) * q[1];
}

static double interaction(const crack_medium *m, const tip_point *p, const tip_field *f, double q,
                          const double slope[2]) {
  const double u1[2] = {p->gradient[0][0], p->gradient[1][0]},
               f1[2] = {f->gradient[0][0], f->gradient[1][0]},
               v1[2] = {p->velocity_gradient[0][0], p->velocity_gradient[1][0]};
  const double elastic = p->stress[0] * f->gradient[0][0] + p->stress[1] * f->gradient[1][1] +
                         p->stress[2] * (f->gradient[0][1] + f->gradient[1][0]);
  const double kinetic = m->density * dot(p->velocity, f->velocity);
  const double inertia = dot(f->acceleration, u1) + dot(p->acceleration, f1) -
                         dot(v1, f->velocity) - dot(p->velocity, f->velocity_slope);
  return -(elastic + kinetic) * slope[0] + flux(f->stress, u1, slope) + flux(p->stress, f1, slope) +
         m->density * q * inertia;
}

void tip_intensity(const crack_medium *m, const tip_box *b, const tip_point *points, int count,
                   double speed, double K[2]) {
  const double v = pl_max(speed, SLOWEST * m->c_s);
  double G[2] = {0}, slope[2];
  for (int k = 0; k < count; k++) {
    const double q = tip_box_weight(b, points[k].at, slope);
    if (q == 0 && slope[0] == 0 && slope[1] == 0) continue;
    const tip_point p = turned(b, &points[k]);
    for (int mode = 1; mode <= 2; mode++) {
      const tip_field f = tip_field_at(m, mode, v, p.at[0], p.at[1]);
      G[mode - 1] += p.area * interaction(m, &p, &f, q, slope);
    }
  }
  for (int mode = 1; mode <= 2; mode++)
    K[mode - 1] = tip_factor(m, mode, v) * G[mode - 1];
}
