/* Vectors and tensors that need not be symmetric in laws: their products, sums, choices and
   derivatives against values by hand, of numbers and of parameters; what parameters vectors are. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"
#include "generator/ir/interpret.h"
#include "generator/lower/lower.h"

typedef struct reading {
  arena *memory;
  source_set sources;
  diagnostics said;
  law *law;
  ir *g;
  lowered_law out;
} reading;

/* A law of points with these lines and one output. */
static void read_law(reading *r, const char *lines, const char *output) {
  *r = (reading){.memory = arena_new(), .g = ir_new()};
  diag_begin(&r->said, &r->sources);
  const char *text = arena_printf(r->memory,
                                  "model m\nlaw continuum\nfor space, anisotropic\n"
                                  "parameter a = (1, -2, 3)\nparameter b = (0.5, 4)\n"
                                  "parameter E = 2 [Pa]\n%s\nstress sigma = E*strain\n"
                                  "output o = %s + 0*(a[x] + b[y])\nend model\n",
                                  lines, output);
  const int file = source_add(&r->sources, "law", text, strlen(text));
  tree *t = parse_model(r->memory, &r->sources, file, NULL, &r->said);
  r->law = law_check(r->memory, t, &r->sources, NULL, 0, &r->said);
  const bool good = r->law && lower_law(r->law, r->g, LOWER_STEP, r->memory, &r->out, &r->said);
  if (!good) diag_print(&r->said, stderr);
  assert_true(good);
}

static void forget(reading *r) {
  ir_free(r->g);
  diag_clear(&r->said);
  source_clear(&r->sources);
  arena_free(r->memory);
}

/* Value of the output with the parameters at their defaults. */
static double value_of(reading *r) {
  const double *parameters[16], strain = 0;
  const double *strains[16];
  double value;
  for (int k = 0; k < r->law->parameters.count; k++)
    parameters[k] = &r->law->parameters.items[k]->initial;
  for (int k = 0; k < 16; k++)
    strains[k] = &strain;
  const interpreter_inputs in = {
      .values = {[IR_FROM_PARAMETER] = parameters, [IR_FROM_POINT] = strains}};
  interpreter *p = interpreter_new(r->g, r->out.outputs, 1);
  interpreter_run(p, &in, 1, &(double *){&value});
  interpreter_free(p);
  return value;
}

/* a = (1, -2, 3), b = (0.5, 4, 0). */
static void products_have_their_values(void **state) {
  (void)state;
  static const struct {
    const char *lines, *output;
    double value;
  } cases[] = {
      {"", "dot(a, b)", -7.5},
      {"", "a : b", -7.5},
      {"", "dot((1, 2, 3), (4, 5, 6))", 32},
      {"", "dot((1, 2), vector(3, 4))", 11},
      {"c = cross(a, b)", "100*c[x] + 10*c[y] + c[z]", -1200 + 15 + 5},
      {"c = cross((1, 0, 0), (0, 1, 0))", "c[z] + 10*c[x] + 100*c[y]", 1},
      {"c = cross(a, b) + cross(b, a)", "norm(c)", 0},
      {"", "norm((2, 3, 6))", 7},
      {"", "norm(a)**2", 14},
      {"c = a - 2*b", "c[x] + 10*c[y] + 100*c[z]", 0 - 100 + 300},
      {"c = -b/4", "c[x] + 10*c[y] + 100*c[z]", -0.125 - 10},
      {"c = (| a when E < 1 [Pa] | b when E < 3 [Pa] | 0 otherwise)", "c[y]", 4},
      {"c = (| 0 when E > 1 [Pa] | b otherwise)", "c[y] + norm(c)", 0},
      {"function mix(v, w) = v*dot(v, w)\nc = mix(a, b)", "c[z]", -22.5},
      {"constant e = a/norm(a)", "dot(e, a)/sqrt(14)", 1},
      {"t = dyad(a, b)", "t[x,x] + 10*t[x,y] + 100*t[y,z] + 1000*t[z,z]",
       0.5 + 10 * (4 - 1) / 2. + 100 * 12 / 2.},
      {"t = dyad(a, a)", "trace(t) + t[x,z]", 14 + 3},
      {"t = dyad(a, b)", "t : tensor(1, 2, 3, 4, 5, 6)",
       0.5 + 2 * -8 + 2 * (4 * 1.5 + 5 * 6 + 6 * 0.75)},
      {"g = diff(dot(a, b), a)", "g[x] + 10*g[y] + 100*g[z]", 0.5 + 40},
      {"g = diff(dot(a, a)*E, a)", "(g[x] + 10*g[y] + 100*g[z])/(1 [Pa])", 4 - 80 + 1200},
      {"g = diff(norm(a), a)", "dot(g, a)/norm(a) + dot(g, g)", 2},
      {"g = diff(a*E**2, E)", "g[z]/(1 [Pa])", 12},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    reading r;
    read_law(&r, cases[k].lines, cases[k].output);
    const double value = value_of(&r);
    if (!(fabs(value - cases[k].value) <= 1e-13 * fmax(1, fabs(cases[k].value))))
      fail_msg("%s, %s: %.17g, not %.17g", cases[k].lines, cases[k].output, value, cases[k].value);
    forget(&r);
  }
}

/* F has the rows (2, 1, 1/4), (-1, 3, 1/2), (3/4, 0, 4), S the rows (1, 4, 6), (4, 2, 5),
   (6, 5, 3). */
static void general_tensors_have_their_values(void **state) {
  (void)state;
  static const char *const given = "F = tensor(2, 3, 4, 1, 0.5, 0.25, -1, 0, 0.75)\n"
                                   "S = tensor(1, 2, 3, 4, 5, 6)\none = tensor(1, 1, 1, 0)\n"
                                   "Q = tensor(1.5*cos(0.3), 0.7*cos(0.3), 1, -0.7*sin(0.3), 0, 0, "
                                   "1.5*sin(0.3), 0, 0)\n";
  const double e_32 = pow(0.6, 32);
  const struct {
    const char *lines, *output;
    double value;
  } cases[] = {
      {"", "100*F[x,y] + 10*F[y,x] + F[z,x]", 100 - 10 + 0.75},
      {"", "det(F)", 27.8125},
      {"", "det(S)", 101},
      {"", "trace(F)", 9},
      {"", "F : F", 31.875},
      {"", "F : one + S : F - F : S", 9},
      {"", "norm(F)**2", 31.875},
      {"c = F*a", "c[x] + 10*c[y] + 100*c[z]", 0.75 - 55 + 1275},
      {"c = S*a", "c[x] + 10*c[y] + 100*c[z]", 11 + 150 + 500},
      {"c = F*S", "c[x,x] + 10*c[y,z]", 7.5 + 105},
      {"c = S*F", "c[x,y]", 13},
      {"c = F*F", "c[y,x] + 10*c[z,z]", -2 - 3 + 0.375 + 10 * (0.1875 + 16)},
      {"c = F*inverse(F)", "norm(c - one)", 0},
      {"c = inverse(F)*F", "norm(c - one)", 0},
      {"", "inverse(S) : S", 3},
      {"c = transpose(F)", "100*c[x,y] + 10*c[y,x] + c[x,z]", -100 + 10 + 0.75},
      {"c = F - transpose(F)", "c[x,y] + 10*c[y,x] + c[z,z]", 2 - 20},
      {"c = sym(F)", "c[x,y] + 10*c[x,z] + 100*c[y,z] + c[x,x]", 0 + 5 + 25 + 2},
      {"c = -F/2", "c[y,x] + c[z,z]", 0.5 - 2},
      {"c = F + 2*S", "c[x,y] + 10*c[y,x]", 9 + 70},
      {"c = (| F when E < 1 [Pa] | S otherwise)", "c[z,y] + 10*c[y,z]", 55},
      {"c = (| 0 when E > 1 [Pa] | F otherwise)", "norm(c)", 0},
      {"", "diff(det(F*E), E)/(1 [Pa^2])", 3 * 4 * 27.8125},
      {"c = diff(F*E**2, E)", "c[y,x]/(1 [Pa])", -4},
      {"R = rotation(Q)", "R[y,x] - sin(0.3) + R[x,x] - cos(0.3) + R[z,z]", 1},
      {"R = rotation(Q)", "norm(transpose(R)*Q - tensor(1.5, 0.7, 1, 0))", 0},
      {"R = rotation(F/3)", "norm(transpose(R)*R - one)", 0},
      {"R = rotation(F/3)\nU = transpose(R)*F", "norm(U - transpose(U))", 0},
      {"R = rotation(S/20 + one)", "norm(R - one)", 0},
      /* a stretch of 4, after five steps */
      {"R = rotation(4*one + tensor(0, 0, 0, 0, 1e-30, 0))", "1e7*(R[y,y] - 1)",
       1e7 * 2 * e_32 / (1 - e_32)},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    reading r;
    char lines[1000];
    snprintf(lines, sizeof lines, "%s%s", given, cases[k].lines);
    read_law(&r, lines, cases[k].output);
    const double value = value_of(&r);
    if (!(fabs(value - cases[k].value) <=
          1e-8 * (strncmp(cases[k].output, "1e7", 3) == 0) + 1e-13 * fmax(1, fabs(cases[k].value))))
      fail_msg("%s, %s: %.17g, not %.17g", cases[k].lines, cases[k].output, value, cases[k].value);
    forget(&r);
  }
}

/* Parameters are numbers, x, y and z one after the other, with what the vector has. */
static void a_vector_is_three_parameters(void **state) {
  (void)state;
  reading r;
  read_law(&r, "parameter l = (3 [mm], 1 [m]) \"way\"", "l[y]/(1 [m])");
  static const struct {
    const char *name;
    double value;
  } expected[] = {{"a_x", 1}, {"a_y", -2}, {"a_z", 3},    {"b_x", 0.5}, {"b_y", 4},
                  {"b_z", 0}, {"E", 2},    {"l_x", 3e-3}, {"l_y", 1},   {"l_z", 0}};
  assert_int_equal(r.law->parameters.count, sizeof expected / sizeof *expected);
  for (int k = 0; k < r.law->parameters.count; k++) {
    const symbol *s = r.law->parameters.items[k];
    assert_string_equal(s->name, expected[k].name);
    assert_true(s->has_default && s->initial == expected[k].value && s->used);
    assert_int_equal(s->shape, SHAPE_SCALAR);
  }
  assert_true(dim_equal(r.law->parameters.items[9]->dim, dimension_of("m")));
  assert_string_equal(r.law->parameters.items[8]->doc, "way, y");
  forget(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(products_have_their_values),
      cmocka_unit_test(general_tensors_have_their_values),
      cmocka_unit_test(a_vector_is_three_parameters),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
