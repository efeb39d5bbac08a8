#include "generator/lower/kinematics.h"

#include <math.h>

#include "dsl/semantics/builtins.h"

const ends_origin ends_origins[ENDS_COUNT] = {
#define X(code, name, array, owner, component) [ENDS_##code] = {name, array, owner, component},
    ENDS_INPUTS(X)
#undef X
};

ir_node kinematics_input(ir *g, ends_input which) {
  const ends_origin *o = &ends_origins[which];
  const bool of_particle = o->array == FROM_HELD || o->array == FROM_VOLUME ||
                           o->array == FROM_MASS || o->array == FROM_SHARE || o->array == FROM_SIZE;
  placement on = o->array == FROM_CLASS            ? ON_BODY
                 : of_particle && o->owner == OF_I ? ON_PARTICLE
                                                   : ON_BOND;
  ir_node n = ir_input(g, IR_FROM_ENDS, (int)which, o->name, on);
  return o->array == FROM_CLASS ? ir_mark_class(g, n) : n;
}

ir_node kinematics_advance(ir *g, placement on) {
  return ir_input(g, IR_FROM_ENDS, ENDS_ADVANCE, ends_origins[ENDS_ADVANCE].name, on);
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

/* (asin(x)/x - 1)/x^2 of z = x^2 for |x| < 1/16, through Chebyshev's points, to 2^-52. */
static ir_node arc_sine_series(ir *g, ir_node z) {
  ir_node linear = ir_mul(g, z, ir_constant(g, 0x1.3333334a3f0fap-4));
  ir_node low = ir_add(g, ir_constant(g, 0x1.5555555554f92p-3), linear);
  linear = ir_mul(g, z, ir_constant(g, 0x1.f4a7447a72cffp-6));
  ir_node high = ir_add(g, ir_constant(g, 0x1.6db5f5154638dp-5), linear);
  return ir_add(g, low, ir_mul(g, ir_mul(g, z, z), high));
}

static ir_node arc_sine_near_zero(ir *g, ir_node x) {
  ir_node z = ir_mul(g, x, x);
  ir_node series = arc_sine_series(g, z);
  return ir_add(g, x, ir_mul(g, ir_mul(g, x, z), series));
}

ir_node kinematics_arc_sine_ratio(ir *g, ir_node square) {
  const ir_node more = ir_mul(g, square, arc_sine_series(g, square));
  return ir_add(g, ir_constant(g, 1), more);
}

/* How a bond's chord moves. */
typedef struct chord_motion {
  vector chord, d, now; /* reference chord, relative displacement, their sum */
  /* Expected: |d| < s/16, so that |L/s - 1| and the sine of the chord's rotation are below 1/16.
     IR_NONE: nothing is expected. */
  ir_node near;
  ir_node growth; /* L^2 - s^2 */
} chord_motion;

/* The angle of which C x d/(s L) is the sine; d: relative displacement. C x d equals C x c, but
   does not cancel when d is small. */
static ir_node chord_rotation(ir *g, ir_node s, ir_node per_length, const chord_motion *m) {
  const ir_node per_s = ir_div(g, ir_constant(g, 1), s);
  const vector reference = {ir_mul(g, m->chord.x, per_s), ir_mul(g, m->chord.y, per_s)};
  ir_node across = cross(g, reference, m->d), along = dot(g, reference, m->now);
  if (m->near == IR_NONE)
    return named(g, ir_make(g, IR_ATAN2, across, along, IR_NONE), "chord_rotation");
  ir_node sine = named(g, ir_mul(g, across, per_length), "sine");
  ir_node near = arc_sine_near_zero(g, sine), far = ir_make(g, IR_ATAN2, across, along, IR_NONE);
  return named(g, ir_select(g, m->near, near, far), "chord_rotation");
}

/* An end's rotation less the chord's, within half a turn. */
static ir_node end_rotation(ir *g, const chord_motion *m, ir_node small, ir_node end,
                            ir_node of_chord, const char *name) {
  const ir_node turned = ir_sub(g, end, of_chord);
  const ir_node wrapped = ir_make(g, IR_WRAP_ANGLE, turned, IR_NONE, IR_NONE);
  if (m->near == IR_NONE) return named(g, wrapped, name);
  const ir_node near = ir_select(g, small, turned, wrapped);
  return named(g, ir_select(g, m->near, near, wrapped), name);
}

/* Up to half a turn wrapping changes nothing. The chord of a bond that is near turns by little, so
   that one question about both ends is left; loops over strips ask for sizes of 2 or more of many
   bonds at once. */
static void find_end_rotations(ir *g, ir_node s, ir_node per_length, const chord_motion *m,
                               ir_node *theta_i, ir_node *theta_j) {
  const ir_node of_chord = chord_rotation(g, s, per_length, m);
  const ir_node i = kinematics_input(g, ENDS_PHI_I), j = kinematics_input(g, ENDS_PHI_J);
  const ir_node size_i = ir_make(g, IR_ABS, i, IR_NONE, IR_NONE);
  const ir_node size_j = ir_make(g, IR_ABS, j, IR_NONE, IR_NONE);
  const ir_node larger = ir_make(g, IR_MAX, size_i, size_j, IR_NONE);
  const ir_node small = ir_expect(g, ir_make(g, IR_LT, larger, ir_constant(g, 2), IR_NONE));
  *theta_i = end_rotation(g, m, small, i, of_chord, "theta_i");
  *theta_j = end_rotation(g, m, small, j, of_chord, "theta_j");
}

static void rates_against_chord(ir *g, vector e, vector dv, ir_node per_length, ir_node *of_i,
                                ir_node *of_j) {
  ir_node chord_rate = ir_mul(g, cross(g, e, dv), per_length);
  named(g, chord_rate, "chord_rotation_rate");
  *of_i = ir_sub(g, kinematics_input(g, ENDS_OMEGA_I), chord_rate);
  *of_j = ir_sub(g, kinematics_input(g, ENDS_OMEGA_J), chord_rate);
}

/* The stretch e/s with e = L - s: from L^2 - s^2 = 2 s e + e^2 follows e = (L^2 - s^2 - e^2)/(2 s).
   With L - s, which is as good as L, for the small e on the right the left one is as good as the
   displacements are, and needs no division. */
static ir_node stretch_of(ir *g, ir_node s, ir_node half_per_square, ir_node length,
                          ir_node growth) {
  const ir_node rough = ir_sub(g, length, s), square = ir_mul(g, rough, rough);
  return ir_mul(g, ir_sub(g, growth, square), half_per_square);
}

/* Expected of a chord that has moved by the root of `square`. */
static ir_node is_near(ir *g, ir_node s, ir_node square) {
  const ir_node part = ir_constant(g, 1.0 / 256), limit = ir_mul(g, ir_mul(g, s, s), part);
  return ir_expect(g, ir_make(g, IR_LT, square, limit, IR_NONE));
}

static chord_motion motion_of_chord(ir *g, ir_node s) {
  const ir_node two = ir_constant(g, 2);
  chord_motion m = {.chord = inputs(g, ENDS_CLASS_CHORD_X, ENDS_CLASS_CHORD_Y)};
  const vector u_i = inputs(g, ENDS_U_IX, ENDS_U_IY);
  m.d = difference(g, inputs(g, ENDS_U_JX, ENDS_U_JY), u_i, "d_x", "d_y");
  m.now = sum(g, m.chord, m.d);
  named(g, m.now.x, "c_x");
  named(g, m.now.y, "c_y");
  const ir_node square = dot(g, m.d, m.d);
  m.near = is_near(g, s, square);
  const vector twice = {ir_mul(g, two, m.chord.x), ir_mul(g, two, m.chord.y)};
  m.growth = named(g, ir_add(g, dot(g, twice, m.d), square), "growth");
  return m;
}

/* 1/L near s: (1 + h)^(-1/2) with h = growth/s^2 through Chebyshev's points of |d| < s/16 (off by
   2^-16.8 at most), and a step of fourth order in e = 1 - (L guess)^2. */
static ir_node inverse_length_near(ir *g, ir_node s, ir_node growth, ir_node square) {
  static const double fit[] = {0x1.fffeea82e2b64p-1, -0x1.000362b9619cdp-1, 0x1.845e31a3a4243p-2,
                               -0x1.3f8feaf7101d7p-2};
  const ir_node one = ir_constant(g, 1), per_square = ir_div(g, one, ir_mul(g, s, s));
  ir_node c[4], scale = ir_div(g, one, s);
  for (int k = 0; k < 4; k++, scale = ir_mul(g, scale, per_square))
    c[k] = ir_mul(g, ir_constant(g, fit[k]), scale);
  const ir_node low = ir_add(g, c[0], ir_mul(g, growth, c[1]));
  const ir_node high = ir_add(g, c[2], ir_mul(g, growth, c[3]));
  const ir_node guess = ir_add(g, low, ir_mul(g, ir_mul(g, growth, growth), high));
  const ir_node e = ir_sub(g, one, ir_mul(g, ir_mul(g, square, guess), guess));
  ir_node series = ir_mul(g, e, ir_constant(g, 0.3125));
  series = ir_mul(g, e, ir_add(g, ir_constant(g, 0.375), series));
  series = ir_add(g, ir_constant(g, 0.5), series);
  return ir_add(g, guess, ir_mul(g, ir_mul(g, guess, e), series));
}

/* Bonds of central laws may stretch as they like; of those with rotations nearly all stay near
   their reference. */
static void find_length(ir *g, bond_kinematics *k, const chord_motion *m, bool near) {
  ir_node square = dot(g, m->now, m->now);
  if (near) square = ir_select(g, m->near, ir_add(g, ir_mul(g, k->s, k->s), m->growth), square);
  named(g, square, "square");
  k->per_length = ir_make(g, IR_INVERSE_ROOT, square, IR_NONE, IR_NONE);
  if (near) {
    const ir_node quick = inverse_length_near(g, k->s, m->growth, square);
    k->per_length = ir_select(g, m->near, quick, k->per_length);
  }
  named(g, k->per_length, "per_length");
  k->length = named(g, ir_mul(g, square, k->per_length), "length");
}

/* Divisions are what such loops spend their time on: here there is none. */
bond_kinematics kinematics_bond(ir *g, bool rotations, bool twists) {
  bond_kinematics k = {0};
  k.s = ir_input(g, IR_FROM_QUANTITY, QUANTITY_S, "s", ON_BODY);
  const chord_motion m = motion_of_chord(g, k.s);
  find_length(g, &k, &m, rotations);
  const ir_node below = ir_mul(g, k.s, k.s);
  const ir_node half_per_square = ir_div(g, ir_constant(g, 0.5), below);
  k.stretch = named(g, stretch_of(g, k.s, half_per_square, k.length, m.growth), "stretch");
  vector e = {ir_mul(g, m.now.x, k.per_length), ir_mul(g, m.now.y, k.per_length)};
  k.e_x = named(g, e.x, "e_x");
  k.e_y = named(g, e.y, "e_y");

  const vector v_i = inputs(g, ENDS_V_IX, ENDS_V_IY);
  vector dv = difference(g, inputs(g, ENDS_V_JX, ENDS_V_JY), v_i, "dv_x", "dv_y");
  const ir_node per_s = ir_div(g, ir_constant(g, 1), k.s);
  k.stretch_rate = named(g, ir_mul(g, dot(g, e, dv), per_s), "stretch_rate");
  k.theta_i = k.theta_j = k.theta_rate_i = k.theta_rate_j = IR_NONE;
  k.twist = k.twist_rate = IR_NONE;
  if (rotations) {
    find_end_rotations(g, k.s, k.per_length, &m, &k.theta_i, &k.theta_j);
    rates_against_chord(g, e, dv, k.per_length, &k.theta_rate_i, &k.theta_rate_j);
  }
  if (twists) {
    ir_node i = kinematics_input(g, ENDS_PHI_IX), j = kinematics_input(g, ENDS_PHI_JX);
    k.twist = named(g, ir_sub(g, j, i), "twist");
    i = kinematics_input(g, ENDS_OMEGA_IX), j = kinematics_input(g, ENDS_OMEGA_JX);
    k.twist_rate = ir_sub(g, j, i);
  }
  return k;
}

static ir_node dot_of(ir *g, int dimensions, const ir_node *a, const ir_node *b) {
  ir_node sum = ir_mul(g, a[0], b[0]);
  for (int d = 1; d < dimensions; d++)
    sum = ir_add(g, sum, ir_mul(g, a[d], b[d]));
  return sum;
}

/* The length of a family's bond and its stretch from what has been found of its chord. */
static void find_stretch(ir *g, family_kinematics *k, int dimensions, ir_node s,
                         ir_node half_per_square, const ir_node *d) {
  ir_node both[3] = {IR_NONE, IR_NONE, IR_NONE};
  for (int c = 0; c < dimensions; c++)
    both[c] = ir_add(g, k->reference_chord[c], k->chord[c]);
  ir_node square = named(g, dot_of(g, dimensions, k->chord, k->chord), "square");
  k->per_length = named(g, ir_make(g, IR_INVERSE_ROOT, square, IR_NONE, IR_NONE), "per_length");
  k->length = named(g, ir_mul(g, square, k->per_length), "length");
  ir_node growth = dot_of(g, dimensions, d, both); /* L^2 - s^2 */
  k->stretch = named(g, stretch_of(g, s, half_per_square, k->length, growth), "stretch");
}

/* (1 - (1 + h)^(-1/2))/h for |h| < 1/128 through Chebyshev's points, to 2^-56. */
static ir_node shortening_near(ir *g, ir_node h) {
  static const double fit[] = {0x1p-1,
                               -0x1.8000000000058p-2,
                               0x1.4000000000053p-2,
                               -0x1.17fffff5006fep-2,
                               0x1.f7ffffeb39b59p-3,
                               -0x1.ce0aff8156949p-3,
                               0x1.ad0a63171877fp-3};
  enum { TERMS = sizeof fit / sizeof *fit };
  ir_node series = ir_constant(g, fit[TERMS - 1]);
  for (int k = TERMS - 2; k >= 0; k--) {
    const ir_node higher = ir_mul(g, series, h);
    series = ir_add(g, ir_constant(g, fit[k]), higher);
  }
  return ir_mul(g, h, series);
}

/* The same, for as few operations as can be, where nearly all bonds are nearly as long as at first:
   with growth h = (L/s)^2 - 1 and 1/L = (1 - r)/s the stretch is h - r (1 + h). */
static void find_stretch_near(ir *g, family_kinematics *k, int dimensions, ir_node s,
                              const ir_node *d) {
  const ir_node one = ir_constant(g, 1), per_s = ir_div(g, one, s);
  const ir_node per_square = ir_div(g, one, ir_mul(g, s, s));
  ir_node slope[3] = {IR_NONE, IR_NONE, IR_NONE};
  for (int c = 0; c < dimensions; c++) {
    const ir_node at_rest =
        ir_mul(g, ir_mul(g, ir_constant(g, 2), k->reference_chord[c]), per_square);
    slope[c] = ir_add(g, at_rest, ir_mul(g, d[c], per_square));
  }
  const ir_node growth = named(g, dot_of(g, dimensions, d, slope), "growth");
  const ir_node change = ir_make(g, IR_ABS, growth, IR_NONE, IR_NONE);
  const ir_node near = ir_expect(g, ir_make(g, IR_LT, change, ir_constant(g, 1.0 / 128), IR_NONE));
  const ir_node square = ir_add(g, one, growth), shorter = shortening_near(g, growth);
  /* of a bond that is nearly closed 1 + growth would have no digit left */
  const ir_node far_square = ir_mul(g, dot_of(g, dimensions, k->chord, k->chord), per_square);
  const ir_node root = ir_make(g, IR_INVERSE_ROOT, far_square, IR_NONE, IR_NONE);
  const ir_node ratio = ir_mul(g, far_square, root), rough = ir_sub(g, ratio, one);
  const ir_node far_growth = ir_sub(g, growth, ir_mul(g, rough, rough));
  const ir_node far = ir_mul(g, ir_constant(g, 0.5), far_growth);
  const ir_node quick = ir_sub(g, growth, ir_mul(g, shorter, square));
  k->stretch = named(g, ir_select(g, near, quick, far), "stretch");
  const ir_node per_near = ir_sub(g, per_s, ir_mul(g, per_s, shorter));
  k->per_length = named(g, ir_select(g, near, per_near, ir_mul(g, per_s, root)), "per_length");
  const ir_node near_length = ir_add(g, s, ir_mul(g, s, quick));
  k->length = named(g, ir_select(g, near, near_length, ir_mul(g, s, ratio)), "length");
}

/* With `near` as of strips. */
static void rotations_in_plane(ir *g, family_kinematics *k, ir_node s, bool near,
                               const ir_node *dv) {
  chord_motion m = {.chord = {k->reference_chord[0], k->reference_chord[1]},
                    .d = {k->d[0], k->d[1]},
                    .now = {k->chord[0], k->chord[1]},
                    .near = IR_NONE};
  if (near) m.near = is_near(g, s, dot(g, m.d, m.d));
  find_end_rotations(g, s, k->per_length, &m, &k->theta_i, &k->theta_j);
  rates_against_chord(g, (vector){k->now[0], k->now[1]}, (vector){dv[0], dv[1]}, k->per_length,
                      &k->theta_rate[0], &k->theta_rate[1]);
}

/* Both ends compute the same bits: exchanging them changes signs only. */
family_kinematics kinematics_family(ir *g, int dimensions, bool rotations, bool near, bool listed) {
  static const ends_input u_i[] = {ENDS_U_IX, ENDS_U_IY, ENDS_U_IZ},
                          u_j[] = {ENDS_U_JX, ENDS_U_JY, ENDS_U_JZ},
                          v_i[] = {ENDS_V_IX, ENDS_V_IY, ENDS_V_IZ},
                          v_j[] = {ENDS_V_JX, ENDS_V_JY, ENDS_V_JZ},
                          chord_of[] = {ENDS_CLASS_CHORD_X, ENDS_CLASS_CHORD_Y, ENDS_CLASS_CHORD_Z};
  static const char *const d_names[] = {"d_x", "d_y", "d_z"}, *const e_names[] = {"e_x", "e_y",
                                                                                  "e_z"};
  family_kinematics k = {.theta_i = IR_NONE, .theta_j = IR_NONE};
  ir_node dv[3] = {IR_NONE, IR_NONE, IR_NONE};
  ir_node s = ir_input(g, IR_FROM_QUANTITY, QUANTITY_S, "s", ON_BODY);
  ir_mark_class(g, s);
  ir_node per_s = ir_div(g, ir_constant(g, 1), s);
  for (int c = 0; c < dimensions; c++) {
    k.reference_chord[c] = kinematics_input(g, chord_of[c]);
    ir_node from = kinematics_input(g, u_i[c]), to = kinematics_input(g, u_j[c]);
    k.d[c] = named(g, ir_sub(g, to, from), d_names[c]);
    k.chord[c] = ir_add(g, k.reference_chord[c], k.d[c]);
    from = kinematics_input(g, v_i[c]), to = kinematics_input(g, v_j[c]);
    dv[c] = ir_sub(g, to, from);
    k.reference[c] =
        listed ? ir_mul(g, k.reference_chord[c], per_s) : ir_div(g, k.reference_chord[c], s);
  }
  const ir_node half = ir_constant(g, 0.5), square = ir_mul(g, s, s);
  if (near)
    find_stretch_near(g, &k, dimensions, s, k.d);
  else
    find_stretch(g, &k, dimensions, s,
                 listed ? ir_mul(g, ir_mul(g, half, per_s), per_s) : ir_div(g, half, square), k.d);
  for (int c = 0; c < dimensions; c++)
    k.now[c] = named(g, ir_mul(g, k.chord[c], k.per_length), e_names[c]);
  ir_node rate = dot_of(g, dimensions, k.now, dv);
  k.stretch_rate = named(g, ir_mul(g, rate, per_s), "stretch_rate");
  if (rotations) rotations_in_plane(g, &k, s, near, dv);
  return k;
}

bond_forces kinematics_forces(ir *g, const bond_kinematics *k, ir_node N, ir_node M_i,
                              ir_node M_j) {
  bond_forces f = {ir_mul(g, N, k->e_x), ir_mul(g, N, k->e_y), IR_NONE, IR_NONE, IR_NONE};
  if (M_i != IR_NONE) {
    /* n = (-e_y, e_x) */
    ir_node shear = named(g, ir_mul(g, ir_add(g, M_i, M_j), k->per_length), "V");
    f.f_x = ir_add(g, f.f_x, ir_mul(g, shear, k->e_y));
    f.f_y = ir_sub(g, f.f_y, ir_mul(g, shear, k->e_x));
    f.moment_i = M_i;
    f.moment_j = M_j;
  }
  named(g, f.f_x, "f_x");
  named(g, f.f_y, "f_y");
  return f;
}
