/* Parameters that a deck gives by formulas of the place: the same forces, bit by bit, as by regions
   where these can say it; a graded bar against its closed form; and what a deck may not say. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/material_cases.h"

/* --- against regions -------------------------------------------------------------------------- */

static void check_halves(const char *model_name, const char *kind, const char *more) {
  char text[2][1024];
  snprintf(
      text[0], sizeof text[0],
      DISC("%s",
           "%s") "&region name = 'right' shape = 'rectangle' corner = '7 mm', -1 size = 2, 2 /\n"
                 "&material lattice = 'l' model = '%s' E = '30 GPa' /\n"
                 "&material lattice = 'l' region = 'right' model = '%s' E = '50 GPa' /\n",
      kind, more, model_name, model_name);
  snprintf(
      text[1], sizeof text[1],
      DISC("%s",
           "%s") "&material lattice = 'l' model = '%s' E = '| 30 [GPa] when x < 7 [mm] | 50 [GPa] "
                 "otherwise' /\n",
      kind, more, model_name);
  long count[2];
  double *f[2], most = 0;
  for (int k = 0; k < 2; k++)
    f[k] = forces_of(text[k], &count[k]);
  assert_int_equal(count[0], count[1]);
  assert_memory_equal(f[0], f[1], (size_t)count[0] * sizeof(double));
  for (long k = 0; k < count[0]; k++)
    most = fmax(most, fabs(f[0][k]));
  assert_true(most > 0);
  free(f[0]);
  free(f[1]);
}

static void formulas_say_what_regions_do(void **state) {
  (void)state;
  check_halves("elastic_central", "hexagonal", "");
  check_halves("splm_elastic", "hexagonal", "");
  check_halves("elastic_central", "square", "");
  check_halves("lps", "square", "horizon = 2.015");
  check_halves("lps", "blue_noise", "");
}

/* --- a graded bar ----------------------------------------------------------------------------- */

/* E = E0 (1 + x/L) at the ends: a bond has the value of its middle. */
static void check_bar(const char *text) {
  enum { PARTICLES = 20 };
  double stretch[PARTICLES], borne;
  for (int p = 0; p < PARTICLES; p++)
    stretch[p] = 1e-4 / (1 + (p - 0.5) * 5 / 95);
  const double left = left_in_a_row(text, stretch, &borne);
  assert_true(borne > 0 && left < 1e-11);
}

static void a_graded_bar_bears_one_force(void **state) {
  (void)state;
  check_bar(CHAIN("hexagonal") "&material lattice = 'l' model = 'elastic_central' E = '10 [GPa]*(1 "
                               "+ x/95 [mm])' "
                               "/\n");
  /* of a region, on a material of one value */
  check_bar(
      CHAIN("hexagonal") "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
                         "&material lattice = 'l' model = 'elastic_central' E = '5 GPa' /\n"
                         "&material lattice = 'l' region = 'all' model = 'elastic_central' E = '10 "
                         "[GPa]*(1 + x/95 [mm])' /\n");
}

/* --- what may not be -------------------------------------------------------------------------- */

#define GRADED(more) "&material lattice = 'l' model = 'elastic_central' " more " /\n"

static void what_cannot_be_is_told(void **state) {
  (void)state;
  refuse(GRADED("E = '10 [GPa]*(1 - x/50 [mm])'"), "is not in (0, inf), the range of the law");
  refuse(GRADED("E = '10 [N]*x/1 [mm]'"), "`E` needs a stress (Pa), this is a force (N)");
  refuse(GRADED("E = '10 [GPa]*t'"), "there is no quantity `t`");
  refuse(GRADED("E = '10 [GPa]*(1 + x/1 [m])'") "&field parameter = 'E' distribution = 'normal' cv "
                                                "= 0.1 /\n",
         "`E` differs at random, and the material gives it by a formula");
  refuse(GRADED("E = '10 [GPa]*(1 - x/100 [mm])*(1 - x/95 [mm])/(1 - x/95 [mm])'"),
         "`E` has no finite value in the bond from (90, 0) mm to (95, 0) mm");
}

/* Nobody asks for the value in the middle but the particles there. */
static void the_middle_may_be_forbidden(void **state) {
  (void)state;
  deck_case c;
  assert_true(deck_case_text(&c, CHAIN("hexagonal") GRADED("E = '10 [GPa]*abs(x/47.5 [mm] - 1)'")));
  deck_case_close(&c);
  assert_true(deck_case_text(&c, CHAIN("hexagonal") GRADED("E = '10 [GPa]/abs(x/47.5 [mm] - 1)'")));
  deck_case_close(&c);
}

/* A run does not go on with another file. */
static void other_files_are_told_from_each_other(void **state) {
  (void)state;
  uint64_t prints[3];
  for (int k = 0; k < 3; k++) {
    deck_case c;
    FILE *out = fopen("stiffness.csv", "w");
    assert_non_null(out);
    fputs("x [mm], y, E [GPa]\n", out);
    for (int p = 0; p < 20; p++)
      fprintf(out, "%d, 0, %.17g\n", 5 * p, 30 + (k == 2 && p == 7 ? 1e-9 : 0));
    fclose(out);
    deck_case_open(&c, CHAIN("hexagonal") GRADED("E = 'stiffness.csv'"));
    prints[k] = parameter_planes_fingerprint(simulation_planes(c.simulation, 0));
    deck_case_close(&c);
  }
  assert_true(prints[0] != 0 && prints[0] == prints[1] && prints[0] != prints[2]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(formulas_say_what_regions_do),
                                     cmocka_unit_test(a_graded_bar_bears_one_force),
                                     cmocka_unit_test(other_files_are_told_from_each_other),
                                     cmocka_unit_test(the_middle_may_be_forbidden),
                                     cmocka_unit_test(what_cannot_be_is_told)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
