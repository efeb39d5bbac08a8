/* Cracks through particles whose size is a formula of the place cost as much as among particles of
   one size: laws with a fracture energy are told a particle's own size. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"
#include "tests/verification/page.h"

/* Two halves are drawn apart as they are, so that all bonds between them break, each at its own
   critical stretch: what that costs over the area. */
static double cost_of_parting(const char *spacing, const char *keys) {
  deck_case c;
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation end_time = '4 ms' step = '1 us' /\n"
           "&lattice name = 'l' kind = 'blue_noise' spacing = '%s' thickness = '100 mm' %s /\n"
           "&material lattice = 'l' model = 'pmb' E = '25 GPa' G_0 = '100 N/m' "
           "rho = '2.4e6 kg/m^3' /\n"
           "&body lattice = 'l' shape = 'rectangle' corner = '-50 mm', '-25 mm' "
           "size = '100 mm', '50 mm' /\n"
           "&region name = 'lower' shape = 'rectangle' corner = '-50 mm', '-25 mm' "
           "size = '100 mm', '25 mm' /\n"
           "&region name = 'upper' shape = 'rectangle' corner = '-50 mm', 0 "
           "size = '100 mm', '25 mm' /\n"
           "&support region = 'lower' fix = 'x', 'y' /\n&support region = 'upper' fix = 'x' /\n"
           "&drive region = 'upper' component = 'y' velocity = '0.1 m/s' /\n",
           spacing, keys);
  deck_case_open(&c, text);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double cost = deck_case_last(&c, "energy/dissipated_damage") / (0.1 * 0.1);
  const double work =
      (deck_case_last(&c, "energy/external") - deck_case_last(&c, "energy/kinetic")) / (0.1 * 0.1);
  print_message("parting at %-30s %-14s costs %.1f N/m by the law, %.1f N/m of work\n", spacing,
                keys, cost, work);
  assert_true(fabs(work / cost - 1) < 0.02);
  deck_case_close(&c);
  return cost;
}

/* All three figures stand in that line of the reference. */
static void page_says(const char *line, int digits, const char *unit_text,
                      const double figures[3]) {
  for (int k = 0; k < 3; k++) {
    char text[32];
    snprintf(text, sizeof text, " %.*f %s", digits, figures[k], unit_text);
    page_line_says("runtime/README.md", line, text);
  }
}

/* G_0 = 100 N/m goes into s_0 with the horizon, which is a particle's own. */
static void a_crack_costs_as_much(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    const char *keys = k ? "neighbours = 18" : "horizon = 3";
    const double fine = cost_of_parting("1.5 mm", keys), coarse = cost_of_parting("4 mm", keys),
                 graded = cost_of_parting("1.5 [mm] + 0.045*(x + 50 [mm])", keys);
    assert_true(fabs(graded / (0.5 * (fine + coarse)) - 1) < 0.05);
    if (k == 0) page_says("and a horizon of 3, ", 1, "N/m", (double[]){fine, coarse, graded});
  }
}

/* A prism with a weak layer, drawn apart: what the law takes until it is in two, over the section
   and G_f. A family of blue noise smears a crack over more than the width that the law counts on,
   whatever its size is. */
static double cost_of_breaking(const char *spacing) {
  deck_case c;
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation end_time = '14 ms' step_safety = 0.5 /\n"
           "&lattice name = 'l' kind = 'blue_noise' spacing = '%s' thickness = '100 mm' /\n"
           "&material lattice = 'l' model = 'splm_concrete' G_f = '81.43 N/m' "
           "f_t = '| 2.6168 [MPa] when abs(y) < 15 [mm] | 5 [MPa] otherwise' /\n"
           "&body lattice = 'l' shape = 'rectangle' corner = 0, '-60 mm' "
           "size = '120 mm', '120 mm' /\n"
           "&region name = 'top' shape = 'rectangle' corner = 0, '40 mm' "
           "size = '120 mm', '20 mm' /\n"
           "&region name = 'bottom' shape = 'rectangle' corner = 0, '-60 mm' "
           "size = '120 mm', '20 mm' /\n"
           "&support region = 'bottom' fix = 'y' /\n"
           "&drive region = 'top' component = 'y' displacement = '0.4 mm' history = 'cosine' "
           "rise = '12 ms' /\n"
           "&protect region = 'top' /\n&protect region = 'bottom' /\n"
           "&damping kind = 'mass' rate = '3000 1/s' /\n",
           spacing);
  deck_case_open(&c, text);
  const long particles = simulation_rows(c.simulation, 0)->particle_count;
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double cost = deck_case_last(&c, "energy/dissipated_damage") / (0.12 * 0.1) / 81.43;
  print_message("a weak layer through %4ld particles at %-16s costs %.2f G_f\n", particles, spacing,
                cost);
  deck_case_close(&c);
  return cost;
}

static void concrete_costs_as_much(void **state) {
  (void)state;
  const double fine = cost_of_breaking("6 mm"), coarse = cost_of_breaking("12 mm"),
               graded = cost_of_breaking("6 [mm] + 0.1*x");
  assert_true(fabs(coarse / fine - 1) < 0.06);
  assert_true(fabs(graded / (0.5 * (fine + coarse)) - 1) < 0.05);
  page_says("[splm_concrete](../models/README.md#splm_concrete) that breaks", 2, "G_f",
            (double[]){fine, coarse, graded});
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_crack_costs_as_much),
      cmocka_unit_test(concrete_costs_as_much),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
