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

/* v + a x b, with a rounding for each product. These begin with b, as those of v = b' x a' do: so
   what the ends of a bond exchange looks alike. */
static vector cross_added(ir *g, vector v, vector a, vector b) {
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const ir_node first = ir_mul(g, b.of[j], a.of[i]), second = ir_mul(g, b.of[i], a.of[j]);
    v.of[k] = ir_sub(g, ir_add(g, v.of[k], first), second);
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
static quaternion quaternion_of(ir *g, vector r, bool near) {
  static const char *const names[] = {"turned_x", "turned_y", "turned_z"};
  static const double of_cosine[] =
      {1, -1.0 / 8, 1.0 / 384, -1.0 / 46080, 1.0 / 10321920, -1.0 / 3715891200},
                      of_sine[] = {1.0 / 2, -1.0 / 48, 1.0 / 3840, -1.0 / 645120, 1.0 / 185794560};
  const ir_node square = dot(g, r, r), limit = ir_constant(g, 1.0 / 16);
  const ir_node expected = near ? ir_expect(g, ir_binary(g, IR_LT, square, limit)) : IR_NONE;
  const ir_node length = at_least(g, ir_unary(g, IR_SQRT, square), 1e-100);
  const ir_node half = ir_mul(g, ir_constant(g, 0.5), length);
  const ir_node sine = ir_div(g, ir_unary(g, IR_SIN, half), length);
  const ir_node near_sine = polynomial(g, square, of_sine, 5);
  const ir_node near_cosine = polynomial(g, square, of_cosine, 6);
  const ir_node w = choose(g, expected, near_cosine, ir_unary(g, IR_COS, half));
  quaternion q = {w, times(g, choose(g, expected, near_sine, sine), r)};
  ir_set_name(g, w, "turned_w", (span){0, 0, 0});
  keep(g, q.v.of, q.v, names);
  return q;
}

/* Half of what is added to the unit vector n as it turns: w v x n + v x (v x n). */
static vector turned_by(ir *g, quaternion q, vector n) {
  const vector once = cross(g, q.v, n), again = cross(g, q.v, once);
  return sum(g, times(g, q.w, once), again);
}

/* From one end to the other. */
static quaternion relative(ir *g, quaternion i, quaternion j) {
  const ir_node along = dot(g, i.v, j.v), w = ir_add(g, ir_mul(g, i.w, j.w), along);
  const vector less = times(g, j.w, i.v), apart = difference(g, times(g, i.w, j.v), less);
  return (quaternion){w, cross_added(g, apart, i.v, j.v)};
}

/* --- an end against the bond ------------------------------------------------------------------ */

typedef struct end {
  vector sine; /* e x t */
  ir_node cosine;
} end;

/* e x t without cancellation, since the reference chord is along its own direction n:
   e x (n + dn) = d x n/L + e x dn. */
static end end_of(ir *g, const moving_chord *c, quaternion q) {
  const vector n = from(c->reference), e = from(c->e), half = turned_by(g, q, n);
  const vector twice = times(g, ir_constant(g, 2), e);
  const vector moved = times(g, c->per_length, cross(g, from(c->d), n));
  const ir_node straight = dot(g, e, n);
  return (end){cross_added(g, moved, twice, half), ir_add(g, straight, dot(g, twice, half))};
}

/* theta, h and k. (1 - |x| cot|x|)/x^2 = 1/3 + x^2/45 + ... */
static void find_bending(ir *g, const end *t, ir_node expected, vector *theta, ir_node *h,
                         ir_node *k) {
  static const double series[] = {1.0 / 3, 1.0 / 45, 2.0 / 945, 1.0 / 4725};
  const ir_node one = ir_constant(g, 1), square = dot(g, t->sine, t->sine);
  const ir_node sine = at_least(g, ir_unary(g, IR_SQRT, square), 1e-100);
  const ir_node far = ir_div(g, ir_binary(g, IR_ATAN2, sine, t->cosine), sine);
  const ir_node near = kinematics_arc_sine_ratio(g, square);
  const ir_node ratio = choose(g, expected, near, far);
  *theta = times(g, ratio, t->sine);
  *h = ir_mul(g, ratio, t->cosine);
  const ir_node angle = dot(g, *theta, *theta);
  const ir_node below = at_least(g, angle, 1e-200);
  const ir_node k_far = ir_div(g, ir_sub(g, one, *h), below);
  *k = choose(g, expected, polynomial(g, angle, series, 4), k_far);
}

/* twist, along and turn; q and -q are one rotation. (1 - x^2)^(-1/2) = 1 + x^2/2 + ... */
static void find_twist(ir *g, const moving_chord *c, quaternion q, ir_node expected,
                       end_rotations *r) {
  static const double series[] = {1,          1.0 / 2,    3.0 / 8,     5.0 / 16,
                                  35.0 / 128, 63.0 / 256, 231.0 / 1024};
  static const char *const names[] = {"turn_x", "turn_y", "turn_z"};
  const ir_node one = ir_constant(g, 1), zero = ir_constant(g, 0);
  const ir_node back = ir_constant(g, -1);
  const ir_node other = ir_select(g, ir_binary(g, IR_LT, q.w, zero), back, one);
  const ir_node side = choose(g, expected, one, other), w = ir_mul(g, side, q.w);
  const vector v = times(g, side, q.v), e = from(c->e);
  const ir_node sine = dot(g, v, e), square = ir_mul(g, sine, sine);
  const ir_node rest = at_least(g, ir_sub(g, one, square), 1e-30);
  const ir_node far = ir_binary(g, IR_ATAN2, sine, ir_unary(g, IR_SQRT, rest));
  const ir_node near = ir_mul(g, kinematics_arc_sine_ratio(g, square), sine);
  r->twist = ir_scaled(g, 2, choose(g, expected, near, far));
  const ir_node u_far = ir_unary(g, IR_INVERSE_ROOT, rest);
  const ir_node u = choose(g, expected, polynomial(g, square, series, 7), u_far);
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
  const quaternion q_i = quaternion_of(g, r_i, near), q_j = quaternion_of(g, r_j, near),
                   q = relative(g, q_i, q_j);
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

bond_actions end_actions_in_plane(ir *g, const lowered_law *p, const ir_node *e,
                                  ir_node per_length) {
  bond_actions a = {.force = {ir_mul(g, p->N, e[0]), ir_mul(g, p->N, e[1]), IR_NONE},
                    .moment = {p->M_i[0]}};
  const ir_node sum = ir_add(g, p->M_i[0], p->M_j[0]);
  const ir_node shear = ir_mul(g, sum, per_length); /* along n = (-e_y, e_x), on j */
  a.force[0] = ir_add(g, a.force[0], ir_mul(g, shear, e[1]));
  a.force[1] = ir_sub(g, a.force[1], ir_mul(g, shear, e[0]));
  return a;
}

/* v + A M. */
static vector carried(ir *g, vector v, vector moment, vector theta, ir_node h, ir_node k) {
  const ir_node along = ir_mul(g, k, dot(g, moment, theta));
  const vector by_theta = times(g, along, theta);
  return sum(g, sum(g, v, times(g, h, moment)), by_theta);
}

bond_actions end_actions_in_space(ir *g, const lowered_law *p, const ir_node *direction,
                                  ir_node per_length, const end_rotations *r) {
  const ir_node zero = ir_constant(g, 0), half = ir_constant(g, 0.5);
  const vector e = from(direction), M_i = from(p->M_i), M_j = from(p->M_j),
               theta_i = from(r->theta_i), theta_j = from(r->theta_j);
  const vector turning = cross_added(g, cross(g, M_i, theta_i), theta_j, M_j);
  ir_node about = ir_mul(g, half, dot(g, turning, e));
  vector twisting = {{zero, zero, zero}};
  if (p->T != IR_NONE) {
    about = ir_add(g, ir_mul(g, p->T, r->along), about);
    twisting = times(g, p->T, from(r->turn));
  }
  const vector of_i = carried(g, twisting, M_i, theta_i, r->h[0], r->k[0]),
               of_j = carried(g, twisting, M_j, theta_j, r->h[1], r->k[1]);
  const vector couple = cross(g, sum(g, of_i, of_j), e), along = times(g, about, e);
  const vector shear = times(g, per_length, couple);
  const vector force = difference(g, times(g, p->N, e), shear);
  const vector moment = difference(g, of_i, along);
  bond_actions a;
  for (int k = 0; k < 3; k++) {
    a.force[k] = force.of[k];
    a.moment[k] = moment.of[k];
  }
  return a;
}
