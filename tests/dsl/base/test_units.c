/* Units and dimensions against their definitions (SI brochure 2019; inch, pound and foot exact). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/units.h"

static unit read_unit(const char *text) {
  unit u = {DIMENSIONLESS, 0};
  const char *bad;
  size_t length;
  if (!unit_parse(text, strlen(text), &u, &bad, &length)) fail_msg("`%s` is not read", text);
  return u;
}

static void is_unit(const char *text, double factor, int m, int kg, int s, int K) {
  unit u = read_unit(text);
  int exponents[4] = {m, kg, s, K};
  for (int i = 0; i < 4; i++)
    if (u.dim.twelfths[i] != 12 * exponents[i]) fail_msg("`%s`: exponent %d", text, i);
  if (fabs(u.factor / factor - 1) > 4e-16) fail_msg("`%s` is %.17g", text, u.factor);
}

static void units_have_their_values(void **state) {
  (void)state;
  is_unit("m", 1, 1, 0, 0, 0);
  is_unit("mm", 1e-3, 1, 0, 0, 0);
  is_unit("GPa", 1e9, -1, 1, -2, 0);
  is_unit("N", 1, 1, 1, -2, 0);
  is_unit("kg/m^3", 1, -3, 1, 0, 0);
  is_unit("t/m**3", 1e3, -3, 1, 0, 0);
  is_unit("1/s", 1, 0, 0, -1, 0);
  is_unit("s^-1", 1, 0, 0, -1, 0);
  is_unit("N*m", 1, 2, 1, -2, 0);
  is_unit("N m", 1, 2, 1, -2, 0);
  is_unit("N.m", 1, 2, 1, -2, 0);
  is_unit("N\xC2\xB7m", 1, 2, 1, -2, 0);
  is_unit("kg m^-1 s^-2", 1, -1, 1, -2, 0);
  is_unit(" kN / m ", 1e3, 0, 1, -2, 0);
  is_unit("J/(kg*K)", 1, 2, 0, -2, -1);
  is_unit("J/(kg K)", 1, 2, 0, -2, -1);
  is_unit("N/m/s", 1, 0, 1, -3, 0);
  is_unit("N/m*s", 1, 0, 1, -1, 0); /* from left to right, as in the language */
  is_unit("(m/s)^2", 1, 2, 0, -2, 0);
  is_unit("kW*h", 3.6e6, 2, 1, -2, 0);
  is_unit("%", 0.01, 0, 0, 0, 0);
  is_unit("1", 1, 0, 0, 0, 0);
  is_unit("\xC2\xB5m", 1e-6, 1, 0, 0, 0);
  is_unit("deg", acos(-1.0) / 180, 0, 0, 0, 0);
  is_unit("in", 0.0254, 1, 0, 0, 0);
  is_unit("ft", 12 * 0.0254, 1, 0, 0, 0);
  is_unit("GN", 1e9, 1, 1, -2, 0);
  is_unit("lbf", 0.45359237 * 9.80665, 1, 1, -2, 0);
  is_unit("psi", 0.45359237 * 9.80665 / (0.0254 * 0.0254), -1, 1, -2, 0);
  is_unit("ksi", 1000 * 0.45359237 * 9.80665 / (0.0254 * 0.0254), -1, 1, -2, 0);
}

static void exponents_may_be_fractions(void **state) {
  (void)state;
  unit decimal = read_unit("MPa*m^0.5"), fraction = read_unit("MPa m^(1/2)");
  assert_true(dim_equal(decimal.dim, fraction.dim));
  assert_int_equal(decimal.dim.twelfths[0], -6);
  assert_true(decimal.factor == 1e6);
  assert_int_equal(read_unit("m^(-1/3)").dim.twelfths[0], -4);
  assert_true(dim_equal(decimal.dim, read_unit("MPa*sqrt(m)").dim));
  assert_true(read_unit("MPa*sqrt(m)").factor == 1e6 &&
              read_unit("sqrt(km*m)").factor == sqrt(1e3));
  assert_int_equal(read_unit("sqrt(m)^3").dim.twelfths[0], 18);
  assert_int_equal(read_unit("N/sqrt(sqrt(m))").dim.twelfths[0], 9);
  assert_true(fabs(read_unit("mm^0.5").factor - sqrt(1e-3)) < 1e-17);
}

static void bad_part_is_named(void **state) {
  (void)state;
  static const char *const cases[][2] = {
      {"Gpa", "Gpa"},
      {"kg/qq^3", "qq"},
      {"", ""},
      {"N/", ""},
      {"N**", ""},
      {"m^x", "x"},
      {"m^(1/0)", "m^(1/0)"},
      {"J/kg K", "K"},
      {"(N", "(N"},
      {"N)", ")"},
      {"12", "12"},
      {"1.5", "5"},
      {"m^1/2", "2"},
      {"kg(m)", "(m)"},
      {"m^(1/7)", "m^(1/7)"},
      {"m3", "m3"},
      {"m^999999999999", "m^999999999999"},
      {"*m", "*m"},
      {"N**m", "m"},
  };
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    unit u;
    const char *bad, *text = cases[i][0];
    size_t length;
    if (unit_parse(text, strlen(text), &u, &bad, &length)) fail_msg("`%s` was read", text);
    char part[64];
    snprintf(part, sizeof(part), "%.*s", (int)length, bad);
    assert_string_equal(part, cases[i][1]);
    assert_in_range((uintmax_t)(bad - text), 0, strlen(text));
  }
}

static void any_text_is_survived(void **state) {
  (void)state;
  static const char alphabet[] = "mNkgs1/^*() .-5%\xC2\xB5K";
  uint32_t random = 12345;
  for (int n = 0; n < 200000; n++) {
    char text[24];
    size_t length = 0;
    do {
      random = random * 1664525u + 1013904223u;
      text[length++] = alphabet[(random >> 16) % (sizeof(alphabet) - 1)];
    } while (length < sizeof(text) && (random >> 8) % 12);
    unit u;
    const char *bad;
    size_t bad_length;
    if (unit_parse(text, length, &u, &bad, &bad_length)) {
      assert_true(isfinite(u.factor) && u.factor > 0);
    } else {
      assert_true(bad >= text && bad + bad_length <= text + length);
    }
  }
}

static void dimensions_follow_the_rules_of_exponents(void **state) {
  (void)state;
  dimension force = read_unit("N").dim, length = read_unit("m").dim, stress = read_unit("Pa").dim;
  assert_true(dim_equal(dim_div(force, dim_mul(length, length)), stress));
  dimension root;
  assert_true(dim_pow(dim_mul(length, length), 1, 2, &root) && dim_equal(root, length));
  assert_true(dim_pow(length, 1, 3, &root) && root.twelfths[0] == 4);
  assert_true(dim_pow(force, 0, 1, &root) && dim_is_none(root));
  assert_false(dim_pow(length, 1, 5, &root));
  assert_false(dim_pow(length, 1, 0, &root));
  assert_false(dim_pow(length, 1000000, 1, &root));
}

static void dimensions_are_described(void **state) {
  (void)state;
  static const char *const cases[][2] = {
      {"GPa", "a stress (Pa)"},
      {"1", "a pure number"},
      {"deg", "a pure number"},
      {"kN", "a force (N)"},
      {"J", "an energy or moment (N*m)"},
      {"kN/m", "a stiffness, load per length or fracture energy (N/m)"},
      {"J/m^2", "a stiffness, load per length or fracture energy (N/m)"},
      {"mm/s", "a velocity (m/s)"},
      {"kg/m^3", "a density (kg/m^3)"},
      {"MPa/s", "a stress rate (Pa/s)"},
      {"N/m^6", "a force per volume squared (N/m^6)"},
      {"kg^2*m/s", "a quantity in kg^2*m/s"},
      {"m^(3/2)/kg", "a quantity in m^(3/2)/kg"},
      {"MPa*m^0.5", "a fracture toughness (Pa*sqrt(m))"},
      {"1/kg", "a quantity in 1/kg"},
  };
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    char text[128];
    dim_describe(read_unit(cases[i][0]).dim, text, sizeof(text));
    assert_string_equal(text, cases[i][1]);
  }
  char tiny[6];
  dim_describe(read_unit("Pa").dim, tiny, sizeof(tiny));
  assert_string_equal(tiny, "a str");
}

static void written_units_read_back(void **state) {
  (void)state;
  for (int n = 0; n < 15 * 15 * 15 * 5; n++) {
    dimension d = {{(short)(n % 15 * 4 - 28), (short)(n / 15 % 15 * 6 - 42),
                    (short)(n / 225 % 15 * 12 - 84), (short)(n / 3375 * 12 - 24)}};
    char text[128];
    dim_unit(d, text, sizeof(text));
    unit u = read_unit(text);
    if (!dim_equal(u.dim, d) || u.factor != 1) fail_msg("`%s`", text);
  }
}

static void every_symbol_is_a_unit(void **state) {
  (void)state;
  int count;
  const char *const *symbols = unit_symbols(&count);
  assert_true(count > 40);
  for (int i = 0; i < count; i++) {
    assert_true(read_unit(symbols[i]).factor > 0);
    for (int j = 0; j < i; j++)
      assert_string_not_equal(symbols[i], symbols[j]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(units_have_their_values),
      cmocka_unit_test(exponents_may_be_fractions),
      cmocka_unit_test(bad_part_is_named),
      cmocka_unit_test(any_text_is_survived),
      cmocka_unit_test(dimensions_follow_the_rules_of_exponents),
      cmocka_unit_test(dimensions_are_described),
      cmocka_unit_test(written_units_read_back),
      cmocka_unit_test(every_symbol_is_a_unit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
