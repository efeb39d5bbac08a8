/* What is said of slips that the language's own tests do not reach: messages of the compiler, of
   decks with laws, of the checks of mechanics. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"

typedef struct slip {
  const char *lines, *wanted; /* of a law of bonds with k = 10 MN and tau = 2 s */
} slip;

static void laws_are_told_what_to_write(void **state) {
  workplace *w = *state;
  static const slip slips[] = {
      {"  parameter e = (1, 0)\n  force N = k*stretch\n  output v = e*stretch\n",
       "such as `principal(sigma, 1)` or `v[x]`"},
      {"  energy W = k*s*stretch**2/2\n  output q = diff(W, direction)\n",
       "a parameter, a quantity of the motion, a state or a damage; this vector is none"},
      {"  state v on bond = vector 0\n  rate v = cross((0, 0, 1), v)/tau + stretch*direction/tau\n"
       "  force N = k*(stretch - dot(v, direction))\n",
       "one component of this vector depends on others"},
      {"  state p on bond = 0 [Pa]\n  p = (p + 1 [GPa]*stretch)/2\n"
       "  force N = 1 [m^2]*p\n  energy W = 1 [m^3]*p**2/1 [GPa]\n",
       "a force that is a state of its own has none"},
      {"  energy W = k*s*stretch**2/2\n  force N = 2*k*stretch\n",
       "give the energy alone; the forces follow from it"},
  };
  for (size_t k = 0; k < sizeof slips / sizeof *slips; k++) {
    char text[1000];
    snprintf(text, sizeof text,
             "model m\n  law central bond\n  parameter k = 10 [MN] in (0, inf)\n"
             "  parameter tau = 2 [s] in (0, inf)\n"
             "  parameter rho = 2323 [kg/m^3] in (0, inf)\n%send model\n",
             slips[k].lines);
    write_text(w, "m.plm", text);
    expect(w, "check m.plm", 1, slips[k].wanted);
  }
}

/* A number of degrees, of a pure number whose bounds are those of an angle. */
static void angles_are_told_from_numbers(void **state) {
  workplace *w = *state;
  write_text(w, "m.plm",
             "model m\n  law central bond\n  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
             "  parameter phi = 0 in [-3.14, 3.14]\n  parameter nu = 0.2 in [0, 0.5]\n"
             "  force N = 1 [MN]*(1 + nu)*stretch*cos(phi)**2\nend model\n");
  expect(w, "check m.plm --set phi=30", 1, "hint: angles are in radians: `'30 deg'`");
  expect(w, "check m.plm --set nu=20", 1, "is not in [0, 0.5]");
  assert_null(strstr(w->said, "hint"));
  expect(w, "check m.plm --set phi='30 deg'", 0, "no errors");
}

/* What the path gives needs no default, and nothing else is spared one. */
static void a_path_gives_a_field(void **state) {
  workplace *w = *state;
  write_text(w, "m.plm",
             "model m\n  law central bond\n  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
             "  field T [K] on particle in (0, inf)\n  field d on particle = (1, 0)\n"
             "  force N = 1 [MN]*stretch*T/293 [K]*(1 + dot(d, direction)**2)\nend model\n");
#define PATH                                                                                       \
  "&material model = 'm.plm' /\n&path quantity = 'stretch' times = 0, 1 values = 0, 1e-3 /\n"
  write_text(w, "path.nml",
             PATH "&path field = 'T' times = 0, 1 values = '293 K', '586 K' /\n"
                  "&path field = 'd_x' times = 0, 1 values = 1, 2 /\n"
                  "&expect quantity = 'final N' value = '10 kN' tolerance = 1e-12 /\n");
  expect(w, "drive path.nml", 0, "1 of 1 expectations hold");
  write_text(w, "path.nml", PATH);
  expect(w, "drive path.nml", 1, "the law `m` needs a value for `T`");
  write_text(w, "path.nml", PATH "&path field = 'T' times = 0, 1 values = '-1 K', '2 K' /\n");
  expect(w, "drive path.nml", 1, "`T` = -1 K is not in (0, inf)");
  write_text(w, "path.nml", PATH "&path field = 'T' times = 0, 1 values = '1 m', '2 m' /\n");
  expect(w, "drive path.nml", 1, "`T` needs a temperature (K), this is a length (m)");
}

int main(void) {
  const struct CMUnitTest tests[] = {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up_workplace, tear_down_workplace)
      TEST(laws_are_told_what_to_write), TEST(angles_are_told_from_numbers),
      TEST(a_path_gives_a_field)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
