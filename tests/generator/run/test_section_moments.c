/* The moment that a body carries through a section: that of all that acts on its near part, for any
   state, law and lattice; of a cantilever in balance P (L - x), and the torque of a bar that is
   twisted. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/section.h"
#include "tests/generator/material_cases.h"

/* --- any state -------------------------------------------------------------------------------- */

#define PLANE(kind, more, law)                                                                     \
  START "&lattice name = 'l' kind = '" kind "' spacing = '5 mm' thickness = '10 mm' " more " /\n"  \
        "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '60 mm', '40 mm' /\n"        \
        "&material lattice = 'l' model = '" law "' /\n"
#define SPACE(kind, more, law)                                                                     \
  START "&lattice name = 'l' kind = '" kind "' spacing = '5 mm' " more " /\n"                      \
        "&body lattice = 'l' shape = 'box' corner = 3*0 size = '40 mm', '20 mm', '25 mm' /\n"      \
        "&material lattice = 'l' model = '" law "' /\n"

static const double at[3] = {0.021, 0.008, 0.003}, normal[3] = {1, 0.3, -0.2};

static bool is_near(const rows *g, long site) {
  double here[3], height = 0;
  rows_place(g, site, here);
  for (int d = 0; d < g->dimensions; d++)
    height += (here[d] - at[d]) * normal[d];
  return height < 0;
}

/* Of the forces that all bonds exert on the near particles: within the near part they leave no
   moment. */
static void moment_of_near_part(const body *w, double moment[3]) {
  const rows *g = w->lattice;
  memset(moment, 0, 3 * sizeof *moment);
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    double arm[3], force[3] = {0, 0, 0};
    if (!is_near(g, q)) continue;
    rows_place(g, q, arm);
    for (int d = 0; d < w->dimensions; d++) {
      arm[d] += w->displacement[d][q] - at[d];
      force[d] = w->force[d][q];
    }
    for (int c = 0; c < 3; c++)
      moment[c] += arm[(c + 1) % 3] * force[(c + 2) % 3] - arm[(c + 2) % 3] * force[(c + 1) % 3];
    for (int d = w->dimensions; d < w->dof; d++)
      moment[w->dimensions == 2 ? 2 : d - 3] += w->force[d][q];
  }
}

static void a_section_carries_what_acts_on_its_near_part(void **state) {
  (void)state;
  static const char *const texts[] = {PLANE("hexagonal", "", "elastic_central"),
                                      PLANE("hexagonal", "", "elastic_micropolar"),
                                      PLANE("square", "horizon = 1.5", "elastic_micropolar"),
                                      PLANE("square", "horizon = 2.015", "lps"),
                                      PLANE("blue_noise", "", "splm_elastic"),
                                      SPACE("fcc", "shells = 2", "cohesive"),
                                      SPACE("fcc", "shells = 2", "mplm_space")};
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    deck_case c;
    deck_case_open(&c, texts[k]);
    sweep *w = simulation_state(c.simulation, 0);
    const body *b = w->body;
    uint64_t seed = 3;
    double carried[3], expected[3], force[3], most = 0, gap = 0;
    for (int d = 0; d < b->dof; d++)
      for (long p = 0; p < b->lattice->particle_count; p++)
        b->displacement[d][b->lattice->particle_site[p]] =
            d < b->dimensions ? draw_uniform(&seed, -5e-6, 5e-6) : draw_uniform(&seed, -1e-3, 1e-3);
    sweep_find_forces(w);
    bond_forces *f = bond_forces_new(w);
    section s = section_new(b, at, b->dimensions == 2 ? (const double[]){1, 0.3, 0} : normal, NULL);
    bond_forces_find(f, -1);
    section_moment(&s, f, carried);
    section_force(&s, f, force);
    moment_of_near_part(b, expected);
    for (int d = 0; d < 3; d++) {
      most = fmax(most, fmax(fabs(expected[d]), 0.02 * fabs(force[d])));
      gap = fmax(gap, fabs(carried[d] - expected[d]));
    }
    print_message("%s: moment (%.3g, %.3g, %.3g) N m, %.1e of it off\n", c.law.law->name,
                  carried[0], carried[1], carried[2], gap / most);
    assert_true(fabs(expected[2]) > 1e-3 * most && gap < 1e-12 * most);
    assert_true(b->dimensions == 3 || (carried[0] == 0 && carried[1] == 0));
    section_free(&s);
    bond_forces_free(f);
    deck_case_close(&c);
  }
}

/* --- in balance ------------------------------------------------------------------------------- */

#define RELAXED                                                                                    \
  "&simulation end_time = 1 /\n&output frames = 0 /\n"                                             \
  "&relaxation increments = 1 tolerance = 1e-13 most_steps = 400000 /\n"
#define CLAMPED(kind, more, law, size)                                                             \
  RELAXED "&lattice name = 'l' kind = '" kind "' spacing = '10 mm' " more " /\n"                   \
          "&material lattice = 'l' model = '" law "' /\n"                                          \
          "&body lattice = 'l' shape = 'rectangle' corner = 0, '-1 mm' size = " size " /\n"        \
          "&region name = 'left' shape = 'rectangle' corner = -1, -1 size = 1.006, 2 /\n"          \
          "&region name = 'tip' shape = 'rectangle' corner = '114 mm', -1 size = 1, 2 /\n"         \
          "&support region = 'left' fix = 'xy' /\n"                                                \
          "&force region = 'tip' component = 'y' total = '-20 N' /\n"                              \
          "&monitor name = 'm1' kind = 'moment' at = '15 mm', '3 mm' normal = 1, 0 /\n"            \
          "&monitor name = 'm2' kind = 'moment' at = '52 mm', '3 mm' normal = 1, 0.2 /\n"          \
          "&monitor name = 'm3' kind = 'moment' at = '95 mm', '3 mm' normal = 1, 0 /\n"
#define TURNS "&support region = 'left' fix = 'rotation' /\n"

/* Of the force -P at the tip where that now is. */
static double moment_of_tip(const body *w, double x) {
  double sum = 0;
  long count = 0;
  for (long p = 0; p < w->lattice->particle_count; p++) {
    const long q = w->lattice->particle_site[p];
    if (w->lattice->x[q] < 0.114) continue;
    sum += w->lattice->x[q] + w->displacement[0][q] - x;
    count++;
  }
  return -20 * sum / (double)count;
}

static void a_cantilever_carries_the_moment_of_its_tip(void **state) {
  (void)state;
  static const char *const texts[] = {
      CLAMPED("chain", "area = '100 mm^2'", "beam", "'120 mm', '2 mm'") TURNS,
      CLAMPED("hexagonal", "thickness = '10 mm'", "elastic_central", "'120 mm', '40 mm'"),
      CLAMPED("hexagonal", "thickness = '10 mm'", "elastic_micropolar", "'120 mm', '40 mm'") TURNS};
  static const double places[] = {0.015, 0.052, 0.095};
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    deck_case c;
    deck_case_open(&c, texts[k]);
    assert_int_equal(deck_case_go(&c), STEP_END);
    const body *w = simulation_state(c.simulation, 0)->body;
    const long last = simulation_history(c.simulation, NULL) - 1;
    for (int m = 0; m < 3; m++) {
      const char name[] = {'m', (char)('1' + m), 0};
      const double carried = deck_case_series(&c, name)[last],
                   expected = moment_of_tip(w, places[m]);
      print_message("%s at %.0f mm: %.12g N m, %.1e of P L off\n", c.law.law->name, 1e3 * places[m],
                    carried, fabs(carried - expected) / (20 * 0.12));
      assert_true(fabs(carried - expected) < 1e-10 * 20 * 0.12);
    }
    deck_case_close(&c);
  }
}

/* Couples about x on the end of a bar: every section carries them about its normal. */
static void a_twisted_bar_carries_its_torque(void **state) {
  (void)state;
  deck_case c;
  deck_case_open(
      &c, RELAXED
      "&lattice name = 'l' kind = 'cubic' shells = 2 spacing = '10 mm' /\n"
      "&material lattice = 'l' model = 'mplm_space' /\n"
      "&body lattice = 'l' shape = 'box' corner = 3*0 size = '60 mm', '21 mm', '21 mm' /\n"
      "&region name = 'left' shape = 'box' corner = 3*-1 size = 1.001, 2, 2 /\n"
      "&region name = 'right' shape = 'box' corner = '59 mm', -1, -1 size = 1, 2, 2 /\n"
      "&support region = 'left' fix = 'xyz' /\n&support region = 'left' fix = 'rotation' /\n"
      "&force region = 'right' component = 'rotation_x' moment = '0.5 N*m' /\n"
      "&monitor name = 'torque' kind = 'moment' at = '32 mm', '10 mm', '10 mm' normal = 1, 0, 0 /\n"
      "&monitor name = 'same' kind = 'moment' component = 'x' at = '18 mm', 0, 0 normal = 1, 0, 0 "
      "/\n&monitor name = 'none' kind = 'moment' component = 'y' at = '18 mm', 0, 0 normal = 1, 0, "
      "0 /\n");
  assert_int_equal(deck_case_go(&c), STEP_END);
  const long last = simulation_history(c.simulation, NULL) - 1;
  const double torque = deck_case_series(&c, "torque")[last],
               same = deck_case_series(&c, "same")[last], none = deck_case_series(&c, "none")[last];
  print_message("torque %.12g and %.12g of 0.5 N m, %.1e about y\n", torque, same, none);
  assert_true(fabs(torque - 0.5) < 0.5e-10 && fabs(same - 0.5) < 0.5e-10 && fabs(none) < 0.5e-10);
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_section_carries_what_acts_on_its_near_part),
                                     cmocka_unit_test(a_cantilever_carries_the_moment_of_its_tip),
                                     cmocka_unit_test(a_twisted_bar_carries_its_torque)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
