/* Parameters that a deck gives by formulas of the place: the same forces, bit by bit, as by regions
   where these can say it; a graded bar against its closed form; and what a deck may not say. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "generator/ir/random_values.h"
#include "runtime/interaction/sweep.h"
#include "tests/verification/case.h"

#define START "&simulation end_time = '0.05 ms' /\n&output frames = 0 energy = .false. /\n"

static void open_text(deck_case *c, const char *text) {
  if (!deck_case_text(c, text)) diag_print(&c->model.said, stderr);
  assert_non_null(c->simulation);
}

/* --- against regions -------------------------------------------------------------------------- */

/* Forces after random displacements, [2 * particles]; to be freed. */
static double *forces_of(const char *text, long *count) {
  deck_case c;
  open_text(&c, text);
  sweep *w = simulation_state(c.simulation, 0);
  const rows *g = w->body->lattice;
  double *forces = must_calloc((size_t)(2 * g->particle_count), sizeof *forces);
  uint64_t seed = 5;
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < 2; d++)
      w->body->displacement[d][g->particle_site[p]] = draw_uniform(&seed, -5e-6, 5e-6);
  sweep_find_forces(w);
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < 2; d++)
      forces[2 * p + d] = w->body->force[d][g->particle_site[p]];
  *count = 2 * g->particle_count;
  deck_case_close(&c);
  return forces;
}

#define DISC                                                                                       \
  START "&lattice name = 'l' kind = '%s' spacing = '5 mm' thickness = '10 mm' %s /\n"              \
        "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = '40 mm' /\n"

static void check_halves(const char *model_name, const char *kind, const char *more) {
  char text[2][1024];
  snprintf(text[0], sizeof text[0],
           DISC "&region name = 'right' shape = 'rectangle' corner = '7 mm', -1 size = 2, 2 /\n"
                "&material lattice = 'l' model = '%s' E = '30 GPa' /\n"
                "&material lattice = 'l' region = 'right' model = '%s' E = '50 GPa' /\n",
           kind, more, model_name, model_name);
  snprintf(text[1], sizeof text[1],
           DISC "&material lattice = 'l' model = '%s' E = '| 30 [GPa] when x < 7 [mm] | 50 [GPa] "
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

/* Springs in a row with E = E0 (1 + x/L) at the ends: a bond has the value of its middle. */
static void check_bar(const char *text) {
  deck_case c;
  open_text(&c, text);
  sweep *w = simulation_state(c.simulation, 0);
  const rows *g = w->body->lattice;
  double u = 0, borne = 0, left = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const double x = ((double)p - 0.5) * g->spacing;
    u += p ? 1e-4 * g->spacing / (1 + x / 0.095) : 0;
    w->body->displacement[0][g->particle_site[p]] = u;
  }
  sweep_find_forces(w);
  for (long p = 0; p < g->particle_count; p++) {
    const double f = w->body->force[0][g->particle_site[p]];
    if (p == 0) borne = f;
    if (p > 0 && p < g->particle_count - 1) left = fmax(left, fabs(f));
  }
  assert_true(borne > 0 && left < 1e-11 * borne);
  deck_case_close(&c);
}

#define CHAIN                                                                                      \
  START "&lattice name = 'l' kind = 'hexagonal' spacing = '5 mm' thickness = '10 mm' /\n"          \
        "&body lattice = 'l' shape = 'rectangle' corner = 0, '-1 mm' size = '95 mm', '2 mm' /\n"

static void a_graded_bar_bears_one_force(void **state) {
  (void)state;
  check_bar(CHAIN
            "&material lattice = 'l' model = 'elastic_central' E = '10 [GPa]*(1 + x/95 [mm])' "
            "/\n");
  /* of a region, on a material of one value */
  check_bar(CHAIN "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
                  "&material lattice = 'l' model = 'elastic_central' E = '5 GPa' /\n"
                  "&material lattice = 'l' region = 'all' model = 'elastic_central' E = '10 "
                  "[GPa]*(1 + x/95 [mm])' /\n");
}

/* --- what may not be -------------------------------------------------------------------------- */

static bool is_said(const diagnostics *d, const char *message) {
  for (int k = 0; k < d->count; k++)
    if (strstr(d->items[k].message, message)) return true;
  return false;
}

static void refuse(const char *material, const char *message) {
  char text[2048];
  deck_case c;
  snprintf(text, sizeof text, CHAIN "%s", material);
  assert_false(deck_case_text(&c, text));
  if (!is_said(&c.said, message) && !is_said(&c.model.said, message))
    fail_msg("not said: %s", message);
  deck_case_close(&c);
}

#define GRADED(more) "&material lattice = 'l' model = 'elastic_central' " more " /\n"

static void what_cannot_be_is_told(void **state) {
  (void)state;
  refuse(GRADED("E = '10 [GPa]*(1 - x/50 [mm])'"), "is not in (0, inf), the range of the law");
  refuse(GRADED("E = '10 [N]*x/1 [mm]'"), "`E` needs a stress (Pa), this is a force (N)");
  refuse(GRADED("E = '10 [GPa]*t'"), "there is no quantity `t`");
  refuse(GRADED("rho = '2000 [kg/m^3]*(1 + x/1 [m])'"), "`rho` cannot differ from place to place");
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
  assert_true(deck_case_text(&c, CHAIN GRADED("E = '10 [GPa]*abs(x/47.5 [mm] - 1)'")));
  deck_case_close(&c);
  assert_true(deck_case_text(&c, CHAIN GRADED("E = '10 [GPa]/abs(x/47.5 [mm] - 1)'")));
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(formulas_say_what_regions_do),
                                     cmocka_unit_test(a_graded_bar_bears_one_force),
                                     cmocka_unit_test(the_middle_may_be_forbidden),
                                     cmocka_unit_test(what_cannot_be_is_told)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
