#include "generator/kinematics.h"

#include "dsl/builtins.h"

const ends_origin ends_origins[ENDS_COUNT] = {
#define X(code, name, array, owner, component) [ENDS_##code] = {name, array, owner, component},
    ENDS_INPUTS(X)
#undef X
};

ir_node kinematics_input(ir *g, ends_input which) {
  const ends_origin *o = &ends_origins[which];
  const bool of_particle =
      o->array == FROM_HELD || o->array == FROM_VOLUME || o->array == FROM_MASS;
  placement on = o->array == FROM_CLASS            ? ON_BODY
                 : of_particle && o->owner == OF_I ? ON_PARTICLE
                                                   : ON_BOND;
  ir_node n = ir_input(g, IR_FROM_ENDS, (int)which, o->name, on);
  return o->array == FROM_CLASS ? ir_mark_class(g, n) : n;
}

/* Names are for readers of dumps and of generated C; these values have no line in a model. */
static ir_node named(ir *g, ir_node n, const char *name) {
  ir_set_name(g, n, name, (span){0, 0, 0});
  return n;
}

typedef struct vector {
  ir_node x, y;
} vector;

static vector inputs(ir *g, ends_input x, ends_input y) {
  vector v = {kinematics_input(g, x), kinematics_input(g, y)};
  return v;
}

static vector difference(ir *g, vector a, vector b, const char *name_x, const char *name_y) {
  vector v = {named(g, ir_sub(g, a.x, b.x), name_x), named(g, ir_sub(g, a.y, b.y), name_y)};
  return v;
}

static vector sum(ir *g, vector a, vector b) {
  vector v = {ir_add(g, a.x, b.x), ir_add(g, a.y, b.y)};
  return v;
}

/* Nodes are made one statement at a time: C leaves the order of arguments open, and the graph shall
   not depend on who compiled this. */
static ir_node dot(ir *g, vector a, vector b) {
  ir_node x = ir_mul(g, a.x, b.x);
  ir_node y = ir_mul(g, a.y, b.y);
  return ir_add(g, x, y);
}

static ir_node cross(ir *g, vector a, vector b) {
  ir_node xy = ir_mul(g, a.x, b.y);
  ir_node yx = ir_mul(g, a.y, b.x);
  return ir_sub(g, xy, yx);
}

/* Rotation of an end less the chord's. The chord's rotation comes from C x d (d: relative
   displacement), which equals C x c but does not cancel when d is small. */
static void end_rotations(ir *g, bond_kinematics *k, vector chord, vector d, vector now) {
  ir_node phi = ir_make(g, IR_ATAN2, cross(g, chord, d), dot(g, chord, now), IR_NONE);
  named(g, phi, "chord_rotation");
  ir_node phi_i = kinematics_input(g, ENDS_PHI_I), phi_j = kinematics_input(g, ENDS_PHI_J);
  k->theta_i = ir_make(g, IR_WRAP_ANGLE, ir_sub(g, phi_i, phi), IR_NONE, IR_NONE);
  k->theta_j = ir_make(g, IR_WRAP_ANGLE, ir_sub(g, phi_j, phi), IR_NONE, IR_NONE);
  named(g, k->theta_i, "theta_i");
  named(g, k->theta_j, "theta_j");
}

static void rotation_rates(ir *g, bond_kinematics *k, vector e, vector dv) {
  ir_node chord_rate = ir_mul(g, cross(g, e, dv), k->per_length);
  named(g, chord_rate, "chord_rotation_rate");
  k->theta_rate_i = ir_sub(g, kinematics_input(g, ENDS_OMEGA_I), chord_rate);
  k->theta_rate_j = ir_sub(g, kinematics_input(g, ENDS_OMEGA_J), chord_rate);
}

/* Costs one square root and two divisions where the chord is uniform (three otherwise): 1/L and the
   stretch share the reciprocal of L s (L + s), and the angle needs one inside atan2. Divisions are
   what this loop is made of. */
bond_kinematics kinematics_bond(ir *g, bool rotations, bool uniform_chord) {
  bond_kinematics k = {0};
  vector chord = uniform_chord ? inputs(g, ENDS_CLASS_CHORD_X, ENDS_CLASS_CHORD_Y)
                               : inputs(g, ENDS_CHORD_X, ENDS_CHORD_Y);
  k.s = uniform_chord ? ir_input(g, IR_FROM_QUANTITY, QUANTITY_S, "s", ON_BODY)
                      : named(g, ir_make(g, IR_SQRT, dot(g, chord, chord), IR_NONE, IR_NONE), "s");
  vector d =
      difference(g, inputs(g, ENDS_U_JX, ENDS_U_JY), inputs(g, ENDS_U_IX, ENDS_U_IY), "d_x", "d_y");
  vector now = sum(g, chord, d);
  named(g, now.x, "c_x");
  named(g, now.y, "c_y");
  k.length = named(g, ir_make(g, IR_SQRT, dot(g, now, now), IR_NONE, IR_NONE), "length");

  ir_node one = ir_constant(g, 1);
  ir_node twice_s_mean = ir_mul(g, k.s, ir_add(g, k.length, k.s)); /* s (L + s), m^2 */
  ir_node shared = named(g, ir_div(g, one, ir_mul(g, k.length, twice_s_mean)), "shared");
  k.per_length = named(g, ir_mul(g, shared, twice_s_mean), "per_length");
  ir_node growth = dot(g, d, sum(g, chord, now)); /* L^2 - s^2 */
  k.stretch = named(g, ir_mul(g, growth, ir_mul(g, shared, k.length)), "stretch");
  vector e = {ir_mul(g, now.x, k.per_length), ir_mul(g, now.y, k.per_length)};
  k.e_x = named(g, e.x, "e_x");
  k.e_y = named(g, e.y, "e_y");

  vector dv = difference(g, inputs(g, ENDS_V_JX, ENDS_V_JY), inputs(g, ENDS_V_IX, ENDS_V_IY),
                         "dv_x", "dv_y");
  k.stretch_rate = named(g, ir_mul(g, dot(g, e, dv), ir_div(g, one, k.s)), "stretch_rate");
  k.theta_i = k.theta_j = k.theta_rate_i = k.theta_rate_j = IR_NONE;
  if (rotations) {
    end_rotations(g, &k, chord, d, now);
    rotation_rates(g, &k, e, dv);
  }
  return k;
}

static ir_node dot_of(ir *g, int dimensions, const ir_node *a, const ir_node *b) {
  ir_node sum = ir_mul(g, a[0], b[0]);
  for (int d = 1; d < dimensions; d++)
    sum = ir_add(g, sum, ir_mul(g, a[d], b[d]));
  return sum;
}

/* Both ends compute the same bits: exchanging them changes signs only. */
family_kinematics kinematics_family(ir *g, int dimensions) {
  static const ends_input u_i[] = {ENDS_U_IX, ENDS_U_IY, ENDS_U_IZ},
                          u_j[] = {ENDS_U_JX, ENDS_U_JY, ENDS_U_JZ},
                          v_i[] = {ENDS_V_IX, ENDS_V_IY, ENDS_V_IZ},
                          v_j[] = {ENDS_V_JX, ENDS_V_JY, ENDS_V_JZ},
                          chord_of[] = {ENDS_CLASS_CHORD_X, ENDS_CLASS_CHORD_Y, ENDS_CLASS_CHORD_Z};
  static const char *const d_names[] = {"d_x", "d_y", "d_z"}, *const e_names[] = {"e_x", "e_y",
                                                                                  "e_z"};
  family_kinematics k = {0};
  ir_node chord[3] = {IR_NONE, IR_NONE, IR_NONE}, d[3] = {IR_NONE, IR_NONE, IR_NONE};
  ir_node dv[3] = {IR_NONE, IR_NONE, IR_NONE}, now[3] = {IR_NONE, IR_NONE, IR_NONE};
  ir_node both[3] = {IR_NONE, IR_NONE, IR_NONE};
  ir_node s = ir_input(g, IR_FROM_QUANTITY, QUANTITY_S, "s", ON_BODY), one = ir_constant(g, 1);
  ir_mark_class(g, s);
  for (int c = 0; c < dimensions; c++) {
    chord[c] = kinematics_input(g, chord_of[c]);
    ir_node from = kinematics_input(g, u_i[c]), to = kinematics_input(g, u_j[c]);
    d[c] = named(g, ir_sub(g, to, from), d_names[c]);
    now[c] = ir_add(g, chord[c], d[c]);
    both[c] = ir_add(g, chord[c], now[c]);
    from = kinematics_input(g, v_i[c]), to = kinematics_input(g, v_j[c]);
    dv[c] = ir_sub(g, to, from);
    k.reference[c] = ir_div(g, chord[c], s);
  }
  k.length = ir_make(g, IR_SQRT, dot_of(g, dimensions, now, now), IR_NONE, IR_NONE);
  named(g, k.length, "length");
  ir_node twice_s_mean = ir_mul(g, s, ir_add(g, k.length, s)); /* s (L + s), m^2 */
  ir_node shared = named(g, ir_div(g, one, ir_mul(g, k.length, twice_s_mean)), "shared");
  ir_node per_length = named(g, ir_mul(g, shared, twice_s_mean), "per_length");
  ir_node growth = dot_of(g, dimensions, d, both); /* L^2 - s^2 */
  k.stretch = named(g, ir_mul(g, growth, ir_mul(g, shared, k.length)), "stretch");
  for (int c = 0; c < dimensions; c++)
    k.now[c] = named(g, ir_mul(g, now[c], per_length), e_names[c]);
  ir_node rate = dot_of(g, dimensions, k.now, dv);
  k.stretch_rate = named(g, ir_mul(g, rate, ir_div(g, one, s)), "stretch_rate");
  return k;
}

bond_forces kinematics_forces(ir *g, const bond_kinematics *k, ir_node N, ir_node M_i,
                              ir_node M_j) {
  bond_forces f = {ir_mul(g, N, k->e_x), ir_mul(g, N, k->e_y), IR_NONE, IR_NONE};
  if (M_i != IR_NONE) {
    /* n = (-e_y, e_x) */
    ir_node shear = named(g, ir_mul(g, ir_add(g, M_i, M_j), k->per_length), "V");
    f.f_x = ir_add(g, f.f_x, ir_mul(g, shear, k->e_y));
    f.f_y = ir_sub(g, f.f_y, ir_mul(g, shear, k->e_x));
    f.moment_i = named(g, ir_neg(g, M_i), "moment_i");
    f.moment_j = named(g, ir_neg(g, M_j), "moment_j");
  }
  named(g, f.f_x, "f_x");
  named(g, f.f_y, "f_y");
  return f;
}
