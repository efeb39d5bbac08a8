/* Parameters by region and at random in decks, for laws of bonds and of families on any lattice:
   a bond has the mean of its ends, a family its own particle's; the same bits whatever the threads
   and after a resume; what a deck may not say. */
#define _GNU_SOURCE /* nftw */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/result/result_fields.h"
#include "runtime/result/result_file.h"
#include "tests/generator/command_tools.h"
#include "tests/generator/material_cases.h"
#include "tests/runtime/hand_over.h"

/* --- bonds ------------------------------------------------------------------------------------ */

/* Between E and 3 E stands a bond of 2 E. Strips on the hexagon, families on the square lattice. */
static void check_chain(const char *kind, const char *text) {
  enum { LEFT = 10, PARTICLES = 20 };
  double stretch[PARTICLES], borne;
  for (int p = 0; p < PARTICLES; p++)
    stretch[p] = 1e-4 * (p < LEFT ? 1 : p == LEFT ? 1.0 / 2 : 1.0 / 3);
  const double left = left_in_a_row(text, stretch, &borne);
  print_message("%s: %.1e of the force is left in a row of springs\n", kind, left);
  assert_true(borne > 0 && left < 1e-11);
}

#define STIFF_RIGHT                                                                                \
  "&material lattice = 'l' model = 'elastic_central' E = '10 GPa' /\n"                             \
  "&region name = 'right' shape = 'rectangle' corner = '49 mm', '-1 mm' size = '50 mm', '2 mm' "   \
  "/\n&material lattice = 'l' region = 'right' model = 'elastic_central' E = '30 GPa' /\n"

static void a_bond_has_the_mean_of_its_ends(void **state) {
  (void)state;
  check_chain("hexagonal", CHAIN("hexagonal") STIFF_RIGHT);
  check_chain("square", CHAIN("square") STIFF_RIGHT);
}

/* --- families --------------------------------------------------------------------------------- */

/* A region of all particles, at the region's value and without one, and at random without spread:
   the uniform law, but for what is rounded otherwise. */
static void check_uniform(const char *model_name, const char *kind, const char *more) {
  char text[3][1024];
  const char *const head = DISC("%s", "%s") "&material lattice = 'l' model = '%s' E = '%s' /\n%s";
  static const char all[] =
      "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
      "&material lattice = 'l' region = 'all' model = '%s' E = '60 GPa' /\n";
  char region[512];
  snprintf(region, sizeof region, all, model_name);
  snprintf(text[0], sizeof text[0], head, kind, more, model_name, "60 GPa", "");
  snprintf(text[1], sizeof text[1], head, kind, more, model_name, "20 GPa", region);
  snprintf(text[2], sizeof text[2], head, kind, more, model_name, "60 GPa",
           "&field parameter = 'E' distribution = 'normal' cv = 1e-200 /\n");
  double *f[3], most = 0, gap = 0;
  long count = 0;
  for (int k = 0; k < 3; k++)
    f[k] = forces_of(text[k], &count);
  for (long k = 0; k < count; k++) {
    most = fmax(most, fabs(f[0][k]));
    gap = fmax(gap, fmax(fabs(f[1][k] - f[0][k]), fabs(f[2][k] - f[0][k])));
  }
  print_message("%s, %s: %.1e off the uniform law\n", model_name, kind, gap / most);
  assert_true(most > 0 && gap < 1e-12 * most);
  for (int k = 0; k < 3; k++)
    free(f[k]);
}

static void a_region_of_all_is_uniform(void **state) {
  (void)state;
  check_uniform("elastic_central", "hexagonal", "");
  check_uniform("splm_elastic", "hexagonal", "");
  check_uniform("lps", "square", "horizon = 2.015");
  check_uniform("lps", "blue_noise", "");
}

/* Work of forces: a force is the slope of the stored energy where parameters differ, too. */
static void forces_are_slopes_of_the_energy(void **state) {
  (void)state;
  static const char *const laws[] = {"splm_elastic", "lps", "pmb"};
  for (int l = 0; l < 3; l++) {
    char text[1024];
    deck_case c;
    snprintf(text, sizeof text,
             DISC("square",
                  "horizon = 2.015") "&material lattice = 'l' model = '%s' /\n"
                                     "&field parameter = 'E' distribution = 'uniform' cv = 0.3 /\n",
             laws[l]);
    deck_case_open(&c, text);
    sweep *w = simulation_state(c.simulation, 0);
    const rows *g = w->body->lattice;
    const long site = g->particle_site[g->particle_count / 3];
    uint64_t seed = 5;
    for (long p = 0; p < g->particle_count; p++)
      for (int d = 0; d < 2; d++)
        w->body->displacement[d][g->particle_site[p]] = draw_uniform(&seed, -5e-7, 5e-7);
    double energy[2] = {0, 0};
    const double step = 2e-7, here = w->body->displacement[0][site];
    for (int side = 0; side < 2; side++) {
      w->body->displacement[0][site] = here + (side ? step : -step);
      sweep_observe(w);
      for (int row = 0; row < g->row_count; row++)
        energy[side] += w->body->observed[row].stored;
    }
    w->body->displacement[0][site] = here;
    sweep_find_forces(w);
    const double slope = -(energy[1] - energy[0]) / (2 * step), force = w->body->force[0][site];
    print_message("%s: force %.6g N, slope of the energy %.6g N\n", laws[l], force, slope);
    assert_true(fabs(slope / force - 1) < 1e-4); /* the bonds are not quite linear */
    deck_case_close(&c);
  }
}

/* --- the same bits ---------------------------------------------------------------------------- */

#define TORN                                                                                       \
  "&simulation end_time = '0.2 ms' threads = %d /\n"                                               \
  "&lattice name = 'l' kind = '%s' spacing = '5 mm' thickness = '10 mm' /\n"                       \
  "&material lattice = 'l' model = 'splm_concrete' /\n"                                            \
  "&field parameter = 'E' distribution = 'lognormal' cv = 0.1 correlation_length = '20 mm' /\n"    \
  "&field parameter = 'f_t' distribution = 'weibull' cv = 0.2 /\n"                                 \
  "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '100 mm', '60 mm' /\n"             \
  "&region name = 'low' shape = 'rectangle' corner = -1, -1 size = 2, '1.006 m' /\n"               \
  "&region name = 'top' shape = 'rectangle' corner = -1, '54 mm' size = 2, 1 /\n"                  \
  "&support region = 'low' fix = 'xy' /\n"                                                         \
  "&drive region = 'top' component = 'y' velocity = '200 mm/s' rise = '0.02 ms' /\n"               \
  "&monitor name = 'load' kind = 'reaction' region = 'top' component = 'y' /\n"                    \
  "&output frames = 0 sample = '0.02 ms' /\n"

static void open_torn(deck_case *c, const char *kind, int threads) {
  char text[2048];
  snprintf(text, sizeof text, TORN, threads, kind);
  deck_case_open(c, text);
}

static void threads_and_a_resume_give_the_same_bits(void **state) {
  (void)state;
  static const char *const kinds[] = {"hexagonal", "blue_noise"};
  for (int k = 0; k < 2; k++) {
    deck_case one, more, first, second;
    open_torn(&one, kinds[k], 1);
    assert_int_equal(deck_case_go(&one), STEP_END);
    open_torn(&more, kinds[k], 3);
    assert_int_equal(deck_case_go(&more), STEP_END);
    assert_same_motion(&one, &more);
    open_torn(&first, kinds[k], 1);
    open_torn(&second, kinds[k], 2);
    hand_over(first.simulation, simulation_step_count(one.simulation) / 2, second.simulation);
    assert_int_equal(deck_case_go(&second), STEP_END);
    assert_same_motion(&one, &second);
    deck_case_close(&one);
    deck_case_close(&more);
    deck_case_close(&first);
    deck_case_close(&second);
  }
}

/* --- what a deck may not say ------------------------------------------------------------------ */

#define TWO_REGIONS                                                                                \
  "&region name = 'a' shape = 'disc' centre = 0, 0 radius = '20 mm' /\n"                           \
  "&region name = 'b' shape = 'disc' centre = '10 mm', 0 radius = '20 mm' /\n"                     \
  "&region name = 'c' shape = 'disc' centre = 1, 1 radius = '1 mm' /\n"

static void slips_are_told_at_their_line(void **state) {
  workplace *w = *state;
  static const struct {
    const char *groups, *said, *line;
  } slips[] = {{"&material lattice = 'l' region = 'a' model = 'lps' E = '1 GPa' /\n"
                "&material lattice = 'l' region = 'b' model = 'lps' E = '2 GPa' /\n",
                "has two materials: it is in the region `a`, too", "region = 'b'"},
               {"&material lattice = 'l' region = 'c' model = 'lps' E = '1 GPa' /\n",
                "region `c` holds no particle", "name = 'c'"},
               {"&material lattice = 'l' region = 'd' model = 'lps' E = '1 GPa' /\n",
                "there is no region `d`", "region = 'd'"},
               {"&material lattice = 'l' region = 'a' model = 'lps' rho = 0 /\n",
                "`rho` = 0 kg/m^3 is not in (0, inf)", "rho = 0"},
               {"&material lattice = 'l' region = 'a' model = 'lps' E = '-1 GPa' /\n",
                "is not in (0, inf)", "E = '-1 GPa'"},
               {"&material lattice = 'l' region = 'a' model = 'lps' E = '1 GPa' /\n"
                "&field parameter = 'E' distribution = 'normal' cv = 0.1 /\n",
                "`E` differs at random, and the material of the region `a` gives it a value",
                "&field parameter"}};
  for (size_t k = 0; k < sizeof slips / sizeof *slips; k++) {
    char text[2048];
    snprintf(text, sizeof text,
             DISC("square",
                  "horizon = 2.015") "&material lattice = 'l' model = 'lps' /\n" TWO_REGIONS "%s",
             slips[k].groups);
    write_text(w, "slip.nml", text);
    assert_int_equal(shell(w, "\"$P\" check slip.nml"), 1);
    if (!strstr(w->said, slips[k].said) || !strstr(w->said, slips[k].line))
      fail_msg("expected `%s` in\n%s", slips[k].said, w->said);
  }
}

/* What a region's material does not say is at random as elsewhere, and it has its lattice's
   density. */
static void a_region_may_leave_things_unsaid(void **state) {
  workplace *w = *state;
  static const char *const materials[] = {"nu = 0.2 /\n", "E = '25 GPa' /\n",
                                          "nu = 0.2 rho = 2000 /\n"};
  for (size_t k = 0; k < sizeof materials / sizeof *materials; k++) {
    char text[2048];
    snprintf(
        text, sizeof text,
        DISC("square",
             "horizon = 2.015") "&region name = 'a' shape = 'disc' centre = 0, 0 radius = '20 mm' "
                                "/\n"
                                "&material lattice = 'l' model = 'lps' E = '25 GPa' rho = 2000 /\n"
                                "&field parameter = 'E' distribution = 'normal' mean = '30 GPa' cv "
                                "= 0.05 /\n"
                                "&material lattice = 'l' region = 'a' model = 'lps' %s",
        materials[k]);
    write_text(w, "unsaid.nml", text);
    if (shell(w, "\"$P\" check unsaid.nml") != 0) fail_msg("%s%s", materials[k], w->said);
  }
}

/* A field of particles for laws of families, of bonds for laws of bonds: with region and mean. */
static void frames_hold_what_differs(void **state) {
  workplace *w = *state;
  char text[2048];
  static const char *const laws[] = {"lps", "elastic_central"};
  for (int k = 0; k < 2; k++) {
    snprintf(text, sizeof text,
             "&simulation end_time = '0.01 ms' /\n"
             "&lattice name = 'l' kind = 'square' spacing = '5 mm' thickness = '10 mm' /\n"
             "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '5 mm', '15 mm' /\n"
             "&material lattice = 'l' model = '%s' E = '20 GPa' /\n"
             "&region name = 'top' shape = 'rectangle' corner = -1, '9 mm' size = 2, 1 /\n"
             "&material lattice = 'l' region = 'top' model = '%s' E = '40 GPa' /\n"
             "&output result = 'held.h5' frames = 1 fields = 'E' /\n",
             laws[k], laws[k]);
    write_text(w, "held.nml", text);
    assert_int_equal(shell(w, "\"$P\" run held.nml"), 0);
    char error[512], unit_text[32];
    long count;
    int components;
    result_file *f = result_read(in_workplace(w, "held.h5"), error, sizeof error);
    assert_non_null(f);
    double *E = result_read_frame(f, k ? "l/E" : "E", -1, &count, &components, unit_text,
                                  sizeof unit_text, error, sizeof error);
    if (!E) fail_msg("%s", error);
    /* two columns of four particles, row by row; bonds in the order of their owners */
    static const double of_particles[] = {20, 20, 20, 20, 40, 40, 40, 40},
                        of_bonds[] = {20, 20, 20, 20, 30, 30, 40, 40, 40, 40};
    assert_int_equal(count, k ? 10 : 8);
    double sum = 0, wanted = 0;
    for (long n = 0; n < count; n++) {
      sum += E[n];
      wanted += 1e9 * (k ? of_bonds : of_particles)[n];
      if (k == 0) assert_true(E[n] == 1e9 * of_particles[n]);
    }
    assert_true(fabs(sum - wanted) < 1e-3);
    free(E);
    result_read_close(f);
  }
}

static void a_solver_keeps_what_differs(void **state) {
  workplace *w = *state;
#if defined(__SANITIZE_ADDRESS__)
  skip(); /* its libraries need the sanitizer's */
#endif
  write_text(w, "two.nml",
             DISC("square", "horizon = 2.015") "&material lattice = 'l' model = 'lps' /\n"
                                               "&region name = 'a' shape = 'disc' centre = 0, 0 "
                                               "radius = '20 mm' /\n&material lattice = 'l' "
                                               "region = 'a' model = 'lps' E = '50 GPa' /\n");
  assert_int_equal(shell(w, "\"$P\" build two.nml -o two"), 0);
  assert_int_equal(shell(w, "./two --set 'material[2].E=40 GPa'"), 0);
  assert_non_null(strstr(w->said, "E differs from region to region: 2.5e+10 to 4e+10 Pa"));
  assert_int_equal(shell(w, "./two --set material[2].nu=0.3"), 1);
  assert_non_null(strstr(w->said, "made for a `nu` that is the same everywhere"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_bond_has_the_mean_of_its_ends),
      cmocka_unit_test(a_region_of_all_is_uniform),
      cmocka_unit_test(forces_are_slopes_of_the_energy),
      cmocka_unit_test(threads_and_a_resume_give_the_same_bits),
      cmocka_unit_test_setup_teardown(slips_are_told_at_their_line, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_region_may_leave_things_unsaid, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(frames_hold_what_differs, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_solver_keeps_what_differs, set_up_workplace,
                                      tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
