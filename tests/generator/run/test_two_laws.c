/* Several laws on one lattice: by region, and on the bonds between two regions. Two copies of one
   law are that law; springs in a row bear one force; forces are slopes of the energy; the same bits
   whatever the threads and after a resume; the file, a solver, and what a deck may not say. */
#define _GNU_SOURCE /* nftw */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/ir/random_values.h"
#include "runtime/interaction/joint.h"
#include "runtime/parts/ledger.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"
#include "tests/generator/command_tools.h"
#include "tests/verification/case.h"
#include "tests/verification/same_bits.h"

#define START "&simulation end_time = '0.05 ms' /\n&output frames = 0 energy = .false. /\n"
#define ROW                                                                                        \
  START "&lattice name = 'l' kind = 'hexagonal' spacing = '5 mm' thickness = '10 mm' /\n"          \
        "&body lattice = 'l' shape = 'rectangle' corner = 0, '-1 mm' size = '95 mm', '2 mm' /\n"   \
        "&region name = 'left' shape = 'rectangle' corner = '-1 mm', '-1 mm' size = '49 mm', "     \
        "'2 mm' /\n"                                                                               \
        "&region name = 'right' shape = 'rectangle' corner = '49 mm', '-1 mm' size = '50 mm', "    \
        "'2 mm' /\n"
#define DISC(kind, more)                                                                           \
  START "&lattice name = 'l' kind = '" kind "' spacing = '5 mm' thickness = '10 mm' " more " /\n"  \
        "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = '40 mm' /\n" HALVES
#define BALL                                                                                       \
  START "&lattice name = 'l' kind = 'fcc' shells = 2 spacing = '5 mm' /\n"                         \
        "&body lattice = 'l' shape = 'sphere' centre = 3*0 radius = '16 mm' /\n"                   \
        "&region name = 'a' shape = 'box' corner = 0, -1, -1 size = 1, 2, 2 /\n"
#define HALVES                                                                                     \
  "&region name = 'a' lattice = 'l' shape = 'rectangle' corner = 0, -1 size = 1, 2 /\n"            \
  "&region name = 'b' lattice = 'l' shape = 'rectangle' corner = -1, -1 size = '0.999 m', 2 /\n"
#define WHOLE(model)  "&material lattice = 'l' model = '" model "' /\n"
#define RIGHT(model)  "&material lattice = 'l' region = 'a' model = '" model "' /\n"
#define COPY(model)   RIGHT(SOURCE_DIR "/models/" model ".plm")
#define ACROSS(model) "&material lattice = 'l' between = 'a', 'b' model = '" model "' /\n"

/* --- a law is the sum of its copies ----------------------------------------------------------- */

/* Forces after random motions, [dof * particles]; to be freed. */
static double *forces_of(const char *text, int laws, long *count) {
  deck_case c;
  int parts = 1;
  deck_case_open(&c, text);
  sweep *w = simulation_state(c.simulation, 0);
  const rows *g = w->body->lattice;
  const int dof = w->body->dof;
  *count = dof * g->particle_count;
  assert_true((joint_parts(w, &parts) != NULL) == (laws > 1) && parts == laws);
  double *forces = must_calloc((size_t)*count, sizeof *forces);
  uint64_t seed = 5;
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < dof; d++)
      w->body->displacement[d][g->particle_site[p]] =
          draw_uniform(&seed, -5e-8, 5e-8) * (d < g->dimensions ? 1 : 100);
  sweep_find_forces(w);
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < dof; d++)
      forces[dof * p + d] = w->body->force[d][g->particle_site[p]];
  deck_case_close(&c);
  return forces;
}

static void check_copies(const char *name, const char *one, const char *two) {
  long count, same;
  double *f = forces_of(one, 1, &count), *g = forces_of(two, 2, &same), most = 0, gap = 0;
  assert_int_equal(count, same);
  for (long k = 0; k < count; k++) {
    most = fmax(most, fabs(f[k]));
    gap = fmax(gap, fabs(f[k] - g[k]));
  }
  print_message("%s: %.1e off the law alone\n", name, gap / most);
  assert_true(most > 0 && gap < 1e-12 * most);
  free(f);
  free(g);
}

static void two_copies_of_a_law_are_the_law(void **state) {
  (void)state;
#define CHECK(head, model, more) check_copies(model, head WHOLE(model), head WHOLE(model) more)
  CHECK(DISC("hexagonal", ""), "lps", COPY("lps"));
  CHECK(DISC("square", "horizon = 2.015"), "splm_concrete", COPY("splm_concrete"));
  CHECK(DISC("blue_noise", ""), "lps", COPY("lps"));
  CHECK(BALL, "lps", COPY("lps"));
  CHECK(DISC("square", "horizon = 2.015"), "pmb", COPY("pmb"));
  CHECK(DISC("hexagonal", ""), "mplm_bilinear", COPY("mplm_bilinear"));
  CHECK(DISC("square", "shells = 2"), "mplm_concrete", COPY("mplm_concrete"));
  CHECK(BALL, "mplm_space", COPY("mplm_space"));
  CHECK(DISC("hexagonal", ""), "elastic_central", ACROSS("elastic_central"));
}

/* --- whose a bond is -------------------------------------------------------------------------- */

/* Each spring is stretched as it is soft: `softness` of those left, across and right. `beside`: of
   which of these are the laws beside the first one, 1 and 2; 0: there are no more. */
static void check_row(const char *text, const double softness[3], const int beside[2]) {
  enum { LEFT = 10, PARTICLES = 20 };
  deck_case c;
  deck_case_open(&c, text);
  sweep *w = simulation_state(c.simulation, 0);
  const rows *g = w->body->lattice;
  double u = 0, left = 0;
  assert_int_equal(g->particle_count, PARTICLES);
  for (int p = 0; p < PARTICLES; p++) {
    u += p ? softness[p < LEFT ? 0 : p == LEFT ? 1 : 2] * 1e-7 * g->spacing : 0;
    w->body->displacement[0][g->particle_site[p]] = u;
  }
  sweep_find_forces(w);
  const double borne = w->body->force[0][g->particle_site[0]];
  for (int p = 1; p < PARTICLES - 1; p++)
    left = fmax(left, fabs(w->body->force[0][g->particle_site[p]]));
  print_message("%.1e of the force is left in a row of springs\n", left / borne);
  assert_true(borne > 0 && left < 1e-8 * borne); /* of strains of 1e-7 */
  sweep_observe(w);
  for (int k = 0; k < 2 && beside[k]; k++) { /* half the force times what they are stretched by */
    const int bonds = beside[k] == 1 ? 1 : PARTICLES - LEFT - 1;
    const double stored = 0.5 * borne * bonds * softness[beside[k]] * 1e-7 * g->spacing;
    const sweep *beside_it = simulation_law_state(c.simulation, 1 + k);
    assert_true(fabs(ledger_stored_by(beside_it) / stored - 1) < 1e-6 &&
                ledger_stored_by(beside_it) > 0);
  }
  deck_case_close(&c);
}

static void a_bond_has_the_law_of_both_ends_or_none(void **state) {
  (void)state;
#define SOFT "&material lattice = 'l' model = 'elastic_micropolar' E = '10 GPa' /\n"
#define STIFF                                                                                      \
  "&material lattice = 'l' region = 'right' model = 'mplm_bilinear' E = '30 GPa' S_t = 0.1 /\n"
#define WEAK                                                                                       \
  "&material lattice = 'l' between = 'right', 'left' model = 'elastic_micropolar' E = '4 GPa' /\n"
  check_row(ROW SOFT STIFF, (double[]){1, 1, 1.0 / 3}, (int[]){2, 0});
  check_row(ROW SOFT STIFF WEAK, (double[]){1, 2.5, 1.0 / 3}, (int[]){2, 1});
  check_row(ROW SOFT WEAK, (double[]){1, 2.5, 1}, (int[]){1, 0});
}

/* --- energy ----------------------------------------------------------------------------------- */

/* Also of a particle at the border, whose bonds are of both laws. */
static void check_slope(const char *text, double size) {
  deck_case c;
  deck_case_open(&c, text);
  sweep *w = simulation_state(c.simulation, 0);
  const rows *g = w->body->lattice;
  uint64_t seed = 5;
  long site = g->particle_site[0];
  for (long p = 0; p < g->particle_count; p++) {
    const long here = g->particle_site[p];
    if (hypot(g->x[here] + 1e-3, g->y[here]) < hypot(g->x[site] + 1e-3, g->y[site])) site = here;
    for (int d = 0; d < 2; d++)
      w->body->displacement[d][here] = draw_uniform(&seed, -size, size);
  }
  double energy[2] = {0, 0};
  const double step = 0.4 * size, here = w->body->displacement[0][site];
  for (int side = 0; side < 2; side++) {
    w->body->displacement[0][site] = here + (side ? step : -step);
    sweep_observe(w);
    for (int row = 0; row < g->row_count; row++)
      energy[side] += w->body->observed[row].stored;
  }
  w->body->displacement[0][site] = here;
  sweep_find_forces(w);
  const double slope = -(energy[1] - energy[0]) / (2 * step), force = w->body->force[0][site];
  print_message("force %.6g N, slope of the energy %.6g N\n", force, slope);
  assert_true(fabs(slope / force - 1) < 1e-4);
  deck_case_close(&c);
}

static void forces_are_slopes_of_the_energy(void **state) {
  (void)state;
  check_slope(DISC("square", "horizon = 2.015") WHOLE("lps") RIGHT("pmb"), 5e-7);
  check_slope(DISC("blue_noise", "") WHOLE("splm_elastic") RIGHT("lps"), 5e-7);
  check_slope(DISC("hexagonal", "") WHOLE("elastic_micropolar") RIGHT("mplm_bilinear")
                  ACROSS("mplm_concrete"),
              5e-9);
}

/* --- masses ----------------------------------------------------------------------------------- */

/* Each particle has the density of its own law, whose bonds read its mass where they ask for it. */
static void check_masses(const char *text) {
  deck_case c;
  deck_case_open(&c, text);
  const sweep *w = simulation_state(c.simulation, 0);
  const rows *g = w->body->lattice;
  for (long p = 0; p < g->particle_count; p++) {
    const long site = g->particle_site[p];
    const double V = g->site_volume ? g->site_volume[site] : g->volume,
                 m = (g->x[site] > -1e-9 ? 7850 : 2300) * V;
    assert_true(fabs(body_mass(w->body, 0, site) / m - 1) < 1e-14);
  }
  deck_case_close(&c);
}

static void particles_have_the_mass_of_their_law(void **state) {
  (void)state;
#define LIGHT(model) "&material lattice = 'l' model = '" model "' rho = 2300 /\n"
#define HEAVY(model) "&material lattice = 'l' region = 'a' model = '" model "' rho = 7850 /\n"
  check_masses(DISC("square", "horizon = 2.015") LIGHT("lps") HEAVY("pmb"));
  check_masses(DISC("blue_noise", "") LIGHT("lps") HEAVY("splm_elastic"));
  check_masses(DISC("hexagonal", "") LIGHT("mplm_bilinear") HEAVY("elastic_micropolar"));
}

/* --- the stable step -------------------------------------------------------------------------- */

/* Between that of either law alone; and a body that rings at 0.999 of it keeps its energy. */
static void the_step_is_that_of_both(void **state) {
  (void)state;
#define RINGS                                                                                      \
  "&lattice name = 'l' kind = 'square' horizon = 2.015 spacing = '5 mm' thickness = '10 mm' /\n"   \
  "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = '40 mm' /\n" HALVES                   \
  "&simulation end_time = '2 ms' step_safety = 0.999 /\n&output frames = 0 /\n"                    \
  "&initial_velocity region = 'b' component = 'x' value = 'sin(x/1.3 [mm]) * 1e-3 [m/s]' /\n"
#define PMB "&material lattice = 'l' %s model = 'pmb' E = '25 GPa' G_0 = 1e6 rho = 2300 /\n"
#define LPS "&material lattice = 'l' %s model = 'lps' E = '75 GPa' rho = 2300 /\n"
  static const char *const texts[] = {RINGS PMB, RINGS LPS, RINGS PMB LPS};
  double limit[3];
  for (int k = 0; k < 3; k++) {
    char text[2048];
    deck_case c;
    snprintf(text, sizeof text, texts[k], "", "region = 'a'");
    deck_case_open(&c, text);
    limit[k] = simulation_step_limit(c.simulation)->limit;
    if (k == 2) {
      assert_int_equal(deck_case_go(&c), STEP_END);
      const double *time, *kinetic = deck_case_series(&c, "energy/kinetic"),
                          *stored = deck_case_series(&c, "energy/stored");
      const long last = simulation_history(c.simulation, &time) - 1;
      print_message("%ld steps: %.9g of the energy is there\n", simulation_step_done(c.simulation),
                    (kinetic[last] + stored[last]) / kinetic[0]);
      assert_true(fabs((kinetic[last] + stored[last]) / kinetic[0] - 1) < 0.01);
    }
    deck_case_close(&c);
  }
  print_message("stable steps %.4g, %.4g and %.4g us\n", 1e6 * limit[0], 1e6 * limit[1],
                1e6 * limit[2]);
  assert_true(limit[2] < limit[0] && limit[2] > 0.999 * limit[1]);
}

/* --- the same bits ---------------------------------------------------------------------------- */

#define TORN                                                                                       \
  "&simulation end_time = '0.2 ms' threads = %d /\n"                                               \
  "&lattice name = 'l' kind = '%s' spacing = '5 mm' thickness = '10 mm' /\n"                       \
  "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '100 mm', '60 mm' /\n"             \
  "&region name = 'a' shape = 'rectangle' corner = '50 mm', -1 size = 2, 2 /\n"                    \
  "&region name = 'low' shape = 'rectangle' corner = -1, -1 size = 2, '1.006 m' /\n"               \
  "&region name = 'top' shape = 'rectangle' corner = -1, '54 mm' size = 2, 1 /\n"                  \
  "&support region = 'low' fix = 'xy' /\n"                                                         \
  "&drive region = 'top' component = 'y' velocity = '200 mm/s' rise = '0.02 ms' /\n"               \
  "&monitor name = 'load' kind = 'reaction' region = 'top' component = 'y' /\n"                    \
  "&output frames = 0 sample = '0.02 ms' /\n%s"

static void open_torn(deck_case *c, size_t k, int threads) {
  static const struct {
    const char *kind, *materials;
  } runs[] = {{"hexagonal", WHOLE("mplm_bilinear") RIGHT("mplm_concrete")},
              {"square", WHOLE("splm_concrete") RIGHT("lps")},
              {"blue_noise", WHOLE("pmb") RIGHT("splm_concrete")}};
  char text[4096];
  snprintf(text, sizeof text, TORN, threads, runs[k].kind, runs[k].materials);
  deck_case_open(c, text);
}

static void threads_and_a_resume_give_the_same_bits(void **state) {
  (void)state;
  for (size_t k = 0; k < 3; k++)
    assert_same_bits_of(open_torn, k);
}

/* --- the file --------------------------------------------------------------------------------- */

/* A plate whose halves are held together by a plane that breaks. */
#define SPLIT                                                                                      \
  "&simulation end_time = '0.1 ms' /\n"                                                            \
  "&lattice name = 'l' kind = 'hexagonal' spacing = '5 mm' thickness = '10 mm' /\n"                \
  "&body lattice = 'l' shape = 'rectangle' corner = '-40 mm', 0 size = '80 mm', '30 mm' "          \
  "/\n" HALVES WHOLE("elastic_micropolar")                                                         \
      ACROSS("mplm_bilinear") "&initial_velocity region = 'a' component = 'x' value = '2 m/s' /\n" \
                              "&monitor name = 'torn' kind = 'damaged' above = 0.5 /\n"            \
                              "&monitor name = 'way' kind = 'tip' at = 0, 0 direction = 0, 1 "     \
                              "above = 0.5 /\n"                                                    \
                              "&monitor name = 'through' kind = 'force' at = 0, '15 mm' normal = " \
                              "1, 0 /\n"                                                           \
                              "&monitor name = 'all' kind = 'momentum' component = 'x' /\n"        \
                              "&output frames = 4 losses = T fields = 'displacement', "            \
                              "'damage', 'stress' /\n"

static double last_of(result_file *f, const char *name) {
  char error[512], unit_text[32];
  long count;
  double *values =
      result_read_series(f, name, &count, unit_text, sizeof unit_text, error, sizeof error);
  if (!values) fail_msg("%s", error);
  const double last = values[count - 1];
  free(values);
  return last;
}

static void a_weak_plane_breaks(void **state) {
  workplace *w = *state;
  char error[512], unit_text[32];
  int components;
  long count;
  write_text(w, "split.nml", SPLIT);
  expect(w, "run split.nml", 0, "mplm_bilinear");
  assert_non_null(strstr(w->said, "bonds as `l.a-b`"));
  result_file *f = result_read(in_workplace(w, "split.h5"), error, sizeof error);
  if (!f) fail_msg("%s", error);
  double *omega = result_read_frame(f, "l.a-b/omega", -1, &count, &components, unit_text,
                                    sizeof unit_text, error, sizeof error);
  if (!omega) fail_msg("%s", error);
  long broken = 0, across = 0;
  for (long b = 0; b < count; b++) { /* those of other laws have no omega */
    broken += omega[b] > 0.5;
    across += !isnan(omega[b]);
  }
  assert_int_equal(across, 13); /* of seven rows: one along each, one up or down between them */
  assert_int_equal(broken, 13);
  assert_int_equal(last_of(f, "torn"), 13);
  assert_true(last_of(f, "way") > 25e-3);
  const double taken = last_of(f, "l.a-b/dissipated_damage"); /* by the plane alone */
  assert_true(taken > 0 && fabs(taken / last_of(f, "energy/dissipated_damage") - 1) < 1e-9);
  assert_true(last_of(f, "l.a-b/stored") < last_of(f, "energy/stored"));
  free(omega);
  result_read_close(f);
  expect(w, "plot split.h5 --map damage -o split.png", 0, "written");
  expect(w, "compare split.h5 split.h5", 0, "none differs");
  expect(w, "info split.h5", 0, "l.a-b");
}

static void a_solver_has_both_laws(void **state) {
  workplace *w = *state;
#if defined(__SANITIZE_ADDRESS__)
  skip(); /* its libraries need the sanitizer's */
#endif
  write_text(w, "split.nml", SPLIT);
  assert_int_equal(shell(w, "\"$P\" build split.nml -o split"), 0);
  assert_int_equal(shell(w, "./split && mv split.h5 solver.h5"), 0);
  assert_int_equal(shell(w, "\"$P\" run split.nml"), 0);
  expect(w, "compare split.h5 solver.h5", 0, "none differs");
}

/* --- what a deck may not say ------------------------------------------------------------------ */

static void slips_are_told_at_their_line(void **state) {
  workplace *w = *state;
  static const struct {
    const char *groups, *said, *line;
  } slips[] = {
      {WHOLE("lps") RIGHT("pmb") "&region name = 'c' shape = 'disc' centre = 0, 0 radius = 1 /\n"
                                 "&material lattice = 'l' region = 'c' model = 'splm_elastic' /\n",
       "has two materials: it is in the region `a`, too", "region = 'c'"},
      {WHOLE("lps") RIGHT("pmb") RIGHT("splm_elastic"), "the region `a` has a material already",
       "model = 'splm_elastic'"},
      {WHOLE("lps") ACROSS("pmb"), "`between` is for laws of bonds", "between = 'a', 'b'"},
      {WHOLE("lps") RIGHT("elastic_central"), "one is a law of bonds, the other one of families",
       "model = 'elastic_central'"},
      {WHOLE("elastic_micropolar") RIGHT("elastic_central"),
       "their particles have not the same rotations", "model = 'elastic_central'"},
      {WHOLE("elastic_central") ACROSS("elastic_central") ACROSS("elastic_central"),
       "have a material already", "between = 'a', 'b'"},
      {WHOLE("elastic_central") "&material lattice = 'l' between = 'a', 'a' model = "
                                "'elastic_central' /\n",
       "joins two regions", "between = 'a', 'a'"},
      {WHOLE("elastic_central") "&material lattice = 'l' between = 'a', 'd' model = "
                                "'elastic_central' /\n",
       "there is no region `d`", "between = 'a', 'd'"},
      {WHOLE("elastic_central") "&region name = 'c' shape = 'point' at = '-30 mm', 0 /\n"
                                "&material lattice = 'l' between = 'a', 'c' model = "
                                "'elastic_central' /\n",
       "no bond joins `a` with `c`", "between = 'a', 'c'"},
      {WHOLE("elastic_central") ACROSS("elastic_central") "&region name = 'c' shape = 'rectangle' "
                                                          "corner = -1, -1 size = 0.999, 1 /\n"
                                                          "&material lattice = 'l' between = 'a', "
                                                          "'c' model = 'elastic_central' /\n",
       "has two materials: it joins other regions, too", "between = 'a', 'c'"},
      {WHOLE("elastic_central") "&region name = 'c' shape = 'disc' centre = 0, 0 radius = 1 /\n"
                                "&material lattice = 'l' between = 'a', 'c' model = "
                                "'elastic_central' /\n",
       "is in both regions, `a` and `c`", "between = 'a', 'c'"},
      {WHOLE(
           "elastic_micropolar") "&region name = 'c' shape = 'point' at = 0, 0 /\n"
                                 "&material lattice = 'l' region = 'c' model = 'mplm_concrete' /\n",
       "no bond has both ends in the region `c`", "region = 'c'"},
      {WHOLE(
           "elastic_micropolar") "&region name = 'c' shape = 'disc' centre = 0, 0 radius = 1 /\n"
                                 "&material lattice = 'l' region = 'c' model = 'mplm_concrete' /\n",
       "all bonds of `l` belong to other materials", "model = 'elastic_micropolar'"},
      {WHOLE(
           "elastic_central") "&lattice name = 'l.a-b' kind = 'hexagonal' spacing = 1 thickness = "
                              "1 /\n&body lattice = 'l.a-b' shape = 'rectangle' corner = 9, 9 "
                              "size = 9, 9 /\n&material lattice = 'l.a-b' model = "
                              "'elastic_central' /\n" ACROSS("elastic_central"),
       "as others are named already", "between = 'a', 'b'"}};
  for (size_t k = 0; k < sizeof slips / sizeof *slips; k++) {
    char text[4096];
    snprintf(text, sizeof text, "%s%s", DISC("hexagonal", ""), slips[k].groups);
    write_text(w, "slip.nml", text);
    if (shell(w, "\"$P\" check slip.nml") != 1) fail_msg("%s\n%s", slips[k].groups, w->said);
    if (!strstr(w->said, slips[k].said) || !strstr(w->said, slips[k].line))
      fail_msg("expected `%s` in\n%s", slips[k].said, w->said);
  }
}

int main(void) {
#define ONE(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(two_copies_of_a_law_are_the_law),
      cmocka_unit_test(a_bond_has_the_law_of_both_ends_or_none),
      cmocka_unit_test(forces_are_slopes_of_the_energy),
      cmocka_unit_test(particles_have_the_mass_of_their_law),
      cmocka_unit_test(the_step_is_that_of_both),
      cmocka_unit_test(threads_and_a_resume_give_the_same_bits),
      ONE(a_weak_plane_breaks),
      ONE(a_solver_has_both_laws),
      ONE(slips_are_told_at_their_line),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
