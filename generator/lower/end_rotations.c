#include "generator/lower/end_rotations.h"

#include "generator/lower/kinematics.h"

typedef struct vector {
  ir_node of[3];
} vector;

static vector from(const ir_node *components) {
  return (vector){{components[0], components[1], components[2]}};
}

static vector sum(ir *g, vector a, vector b) {
  for (int k = 0; k < 3; k++)
    a.of[k] = ir_add(g, a.of[k], b.of[k]);
  return a;
}

static vector difference(ir *g, vector a, vector b) {
  for (int k = 0; k < 3; k++)
    a.of[k] = ir_sub(g, a.of[k], b.of[k]);
  return a;
}

static vector times(ir *g, ir_node n, vector a) {
  for (int k = 0; k < 3; k++)
    a.of[k] = ir_mul(g, n, a.of[k]);
  return a;
}

static ir_node dot(ir *g, vector a, vector b) {
  ir_node n = ir_mul(g, a.of[0], b.of[0]);
  for (int k = 1; k < 3; k++)
    n = ir_add(g, n, ir_mul(g, a.of[k], b.of[k]));
  return n;
}

static vector cross(ir *g, vector a, vector b) {
  vector v;
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const ir_node first = ir_mul(g, a.of[i], b.of[j]), second = ir_mul(g, a.of[j], b.of[i]);
    v.of[k] = ir_sub(g, first, second);
  }
  return v;
}

static void keep(ir *g, ir_node *to, vector v, const char *const *names) {
  for (int k = 0; k < 3; k++) {
    ir_set_name(g, v.of[k], names[k], (span){0, 0, 0});
    to[k] = v.of[k];
  }
}

/* --- near ------------------------------------------------------------------------------------- */

static ir_node polynomial(ir *g, ir_node x, const double *c, int count) {
  ir_node sum = ir_constant(g, c[count - 1]);
  for (int k = count - 2; k >= 0; k--) {
    sum = ir_mul(g, sum, x);
    sum = ir_add(g, ir_constant(g, c[k]), sum);
  }
  return sum;
}

/* What is near if `expected` holds; IR_NONE: always the other. */
static ir_node choose(ir *g, ir_node expected, ir_node near, ir_node far) {
  return expected == IR_NONE ? far : ir_select(g, expected, near, far);
}

static ir_node at_least(ir *g, ir_node n, double least) {
  return ir_binary(g, IR_MAX, n, ir_constant(g, least));
}

/* --- a particle's rotation -------------------------------------------------------------------- */

typedef struct quaternion {
  ir_node w;
  vector v;
} quaternion;

/* Of the rotation vector: (cos(|r|/2), r sin(|r|/2)/|r|), for |r| < 1/4 Taylor's series. */
static quaternion quaternion_of(ir *g, vector r, ir_node square, ir_node expected) {
  static const double of_cosine[] =
      {1, -1.0 / 8, 1.0 / 384, -1.0 / 46080, 1.0 / 10321920, -1.0 / 3715891200},
                      of_sine[] = {1.0 / 2, -1.0 / 48, 1.0 / 3840, -1.0 / 645120, 1.0 / 185794560};
  const ir_node length = at_least(g, ir_unary(g, IR_SQRT, square), 1e-100);
  const ir_node half = ir_mul(g, ir_constant(g, 0.5), length);
  const ir_node sine = ir_div(g, ir_unary(g, IR_SIN, half), length);
  const ir_node near_sine = polynomial(g, square, of_sine, 5);
  const ir_node near_cosine = polynomial(g, square, of_cosine, 6);
  const ir_node scale = choose(g, expected, near_sine, sine);
  return (quaternion){choose(g, expected, near_cosine, ir_unary(g, IR_COS, half)),
                      times(g, scale, r)};
}

/* By how much the unit vector n turns: 2 (w v x n + v x (v x n)). */
static vector turned_by(ir *g, quaternion q, vector n) {
  const vector once = cross(g, q.v, n), again = cross(g, q.v, once);
  return times(g, ir_constant(g, 2), sum(g, times(g, q.w, once), again));
}

/* From one end to the other. */
static quaternion relative(ir *g, quaternion i, quaternion j) {
  const ir_node w = ir_add(g, ir_mul(g, i.w, j.w), dot(g, i.v, j.v));
  const vector apart = difference(g, times(g, i.w, j.v), times(g, j.w, i.v));
  return (quaternion){w, sum(g, apart, cross(g, i.v, j.v))};
}

/* --- an end against the bond ------------------------------------------------------------------ */

typedef struct end {
  vector sine; /* e x t */
  ir_node cosine;
} end;

/* e x t without cancellation, since the reference chord is along its own direction n:
   (C + d) x (n + dn) = (C + d) x dn + d x n. */
static end end_of(ir *g, const moving_chord *c, quaternion q) {
  const vector n = from(c->reference), e = from(c->e), dn = turned_by(g, q, n);
  const vector across = cross(g, from(c->chord), dn), moved = cross(g, from(c->d), n);
  return (end){times(g, c->per_length, sum(g, across, moved)), dot(g, e, sum(g, n, dn))};
}

/* theta, h and k. (1 - |x| cot|x|)/x^2 = 1/3 + x^2/45 + ... */
static void find_bending(ir *g, const end *t, ir_node expected, vector *theta, ir_node *h,
                         ir_node *k) {
  static const double series[] = {1.0 / 3, 1.0 / 45, 2.0 / 945, 1.0 / 4725, 2.0 / 93555};
  const ir_node one = ir_constant(g, 1), square = dot(g, t->sine, t->sine);
  const ir_node sine = at_least(g, ir_unary(g, IR_SQRT, square), 1e-100);
  const ir_node far = ir_div(g, ir_binary(g, IR_ATAN2, sine, t->cosine), sine);
  const ir_node near = kinematics_arc_sine_ratio(g, square);
  const ir_node ratio = choose(g, expected, near, far);
  *theta = times(g, ratio, t->sine);
  *h = ir_mul(g, ratio, t->cosine);
  const ir_node angle = dot(g, *theta, *theta);
  const ir_node k_far = ir_div(g, ir_sub(g, one, *h), at_least(g, angle, 1e-200));
  *k = choose(g, expected, polynomial(g, angle, series, 5), k_far);
}

/* twist, along and turn; q and -q are one rotation. (1 - x^2)^(-1/2) = 1 + x^2/2 + ... */
static void find_twist(ir *g, const moving_chord *c, quaternion q, ir_node expected,
                       end_rotations *r) {
  static const double series[] = {1,          1.0 / 2,    3.0 / 8,     5.0 / 16,
                                  35.0 / 128, 63.0 / 256, 231.0 / 1024};
  static const char *const names[] = {"turn_x", "turn_y", "turn_z"};
  const ir_node one = ir_constant(g, 1), zero = ir_constant(g, 0);
  const ir_node other = ir_select(g, ir_binary(g, IR_LT, q.w, zero), ir_constant(g, -1), one);
  const ir_node side = choose(g, expected, one, other), w = ir_mul(g, side, q.w);
  const vector v = times(g, side, q.v), e = from(c->e);
  const ir_node sine = dot(g, v, e), square = ir_mul(g, sine, sine);
  const ir_node rest = at_least(g, ir_sub(g, one, square), 1e-30);
  const ir_node far = ir_binary(g, IR_ATAN2, sine, ir_unary(g, IR_SQRT, rest));
  const ir_node near = ir_mul(g, kinematics_arc_sine_ratio(g, square), sine);
  r->twist = ir_mul(g, ir_constant(g, 2), choose(g, expected, near, far));
  const ir_node u =
      choose(g, expected, polynomial(g, square, series, 7), ir_unary(g, IR_INVERSE_ROOT, rest));
  r->along = ir_mul(g, u, w);
  keep(g, r->turn, times(g, u, cross(g, v, e)), names);
  ir_set_name(g, r->twist, "twist", (span){0, 0, 0});
}

static ir_node smaller(ir *g, ir_node a, ir_node b) {
  return ir_binary(g, IR_MIN, a, b);
}

end_rotations end_rotations_in_space(ir *g, const moving_chord *c, bool near) {
  static const ends_input phi_i[] = {ENDS_PHI_IX, ENDS_PHI_IY, ENDS_PHI_IZ},
                          phi_j[] = {ENDS_PHI_JX, ENDS_PHI_JY, ENDS_PHI_JZ};
  static const char *const i_names[] = {"theta_ix", "theta_iy", "theta_iz"}, *const j_names[] = {
                                                                                 "theta_jx",
                                                                                 "theta_jy",
                                                                                 "theta_jz"};
  vector r_i, r_j, theta_i, theta_j;
  for (int k = 0; k < 3; k++) {
    r_i.of[k] = kinematics_input(g, phi_i[k]);
    r_j.of[k] = kinematics_input(g, phi_j[k]);
  }
  const ir_node square_i = dot(g, r_i, r_i), square_j = dot(g, r_j, r_j);
  const ir_node larger = ir_binary(g, IR_MAX, square_i, square_j);
  const ir_node small =
      near ? ir_expect(g, ir_binary(g, IR_LT, larger, ir_constant(g, 1.0 / 16))) : IR_NONE;
  const quaternion q_i = quaternion_of(g, r_i, square_i, small),
                   q_j = quaternion_of(g, r_j, square_j, small), q = relative(g, q_i, q_j);
  const end t_i = end_of(g, c, q_i), t_j = end_of(g, c, q_j);
  const ir_node least = smaller(g, smaller(g, t_i.cosine, t_j.cosine), q.w);
  const ir_node along =
      near ? ir_expect(g, ir_binary(g, IR_LT, ir_constant(g, 1 - 1.0 / 512), least)) : IR_NONE;
  end_rotations r;
  find_bending(g, &t_i, along, &theta_i, &r.h[0], &r.k[0]);
  find_bending(g, &t_j, along, &theta_j, &r.h[1], &r.k[1]);
  keep(g, r.theta_i, theta_i, i_names);
  keep(g, r.theta_j, theta_j, j_names);
  find_twist(g, c, q, along, &r);
  return r;
}

/* --- what acts -------------------------------------------------------------------------------- */

static ir_node half_of(ir *g, ir_node n) {
  return ir_mul(g, ir_constant(g, 0.5), n);
}

bond_actions end_actions_in_plane(ir *g, const lowered_law *p, const ir_node *e,
                                  ir_node per_length) {
  bond_actions a = {.force = {ir_mul(g, p->N, e[0]), ir_mul(g, p->N, e[1]), IR_NONE}};
  const ir_node sum = ir_add(g, p->M_i[0], p->M_j[0]), apart = ir_sub(g, p->M_i[0], p->M_j[0]);
  const ir_node shear = ir_mul(g, sum, per_length); /* along n = (-e_y, e_x), on j */
  a.force[0] = ir_add(g, a.force[0], ir_mul(g, shear, e[1]));
  a.force[1] = ir_sub(g, a.force[1], ir_mul(g, shear, e[0]));
  a.even[0] = half_of(g, sum);
  a.odd[0] = half_of(g, apart);
  return a;
}

/* A M. */
static vector carried(ir *g, vector moment, vector theta, ir_node h, ir_node k) {
  const ir_node along = ir_mul(g, k, dot(g, moment, theta));
  return sum(g, times(g, h, moment), times(g, along, theta));
}

bond_actions end_actions_in_space(ir *g, const lowered_law *p, const ir_node *direction,
                                  ir_node per_length, const end_rotations *r) {
  const vector e = from(direction), M_i = from(p->M_i), M_j = from(p->M_j),
               theta_i = from(r->theta_i), theta_j = from(r->theta_j);
  const vector m_i = carried(g, M_i, theta_i, r->h[0], r->k[0]);
  const vector m_j = carried(g, M_j, theta_j, r->h[1], r->k[1]);
  const vector across_i = cross(g, theta_i, e), across_j = cross(g, theta_j, e);
  const ir_node of_i = dot(g, M_i, across_i), of_j = dot(g, M_j, across_j);
  const ir_node half = ir_constant(g, 0.5);
  ir_node about = ir_mul(g, half, ir_sub(g, of_i, of_j));
  vector even = times(g, half, sum(g, m_i, m_j)), odd = times(g, half, difference(g, m_i, m_j));
  if (p->T != IR_NONE) {
    about = ir_add(g, ir_mul(g, p->T, r->along), about);
    even = sum(g, times(g, p->T, from(r->turn)), even);
  }
  odd = difference(g, odd, times(g, about, e));
  const vector couple = times(g, ir_mul(g, ir_constant(g, 2), per_length), cross(g, even, e));
  const vector force = difference(g, times(g, p->N, e), couple);
  bond_actions a;
  for (int k = 0; k < 3; k++) {
    a.force[k] = force.of[k];
    a.even[k] = even.of[k];
    a.odd[k] = odd.of[k];
  }
  return a;
}
