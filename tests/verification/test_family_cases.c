/* Cases of laws of families against theory, from the decks of examples/ on coarser lattices:
   elastic constants of a cube, a pulse along a bar, a running crack, a beam in space; and what a
   crack through cohesive bonds in space costs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/family_cases.h"

static void a_cube_has_the_constants_of_the_solid(void **state) {
  (void)state;
  check_cube("lattice.spacing=10 mm");
}

static void pulses_travel_along_a_bar(void **state) {
  (void)state;
  check_pulses((const char *const[]){"lattice.spacing=5 mm", "lattice.origin=2.5 mm, 2.5 mm"},
               (const char *const[]){"lattice.spacing=2.5 mm", "lattice.origin=1.25 mm, 1.25 mm"},
               0.1);
}

static void a_crack_runs_below_the_rayleigh_speed(void **state) {
  (void)state;
  check_crack((const char *const[]){"lattice.spacing=1 mm", "lattice.origin=0, 0.5 mm"});
}

static void a_beam_in_space_breaks(void **state) {
  (void)state;
  check_beam("lattice.spacing=8 mm");
}

/* --- cohesive bonds in space ------------------------------------------------------------------ */

static const char *const layers =
    "&simulation end_time = '30 ms' step_safety = 0.8 /\n"
    "&lattice name = 'l' kind = 'fcc' shells = 2 spacing = '5 mm' /\n"
    "&material lattice = 'l' model = 'cohesive' /\n"
    "&body lattice = 'l' shape = 'box' corner = '-21 mm', '-21 mm', '-8 mm' size = '42 mm', "
    "'42 mm', '19 mm' /\n"
    "&region name = 'low' shape = 'box' corner = '-1 m', '-1 m', '-1 m' size = '2 m', '2 m', "
    "'1.001 m' /\n"
    "&region name = 'top' shape = 'box' corner = '-1 m', '-1 m', '2 mm' size = '2 m', '2 m', '1 m' "
    "/\n"
    "&support region = 'low' fix = 'xyz' /\n&support region = 'top' fix = 'xy' /\n"
    "&drive region = 'top' component = 'z' velocity = '1 mm/s' rise = '1 ms' /\n"
    "&output frames = 1 sample = '0.05 ms' /\n";

/* Bonds that cross the plane between the layers z = 0 and z = 3.5 mm, by shells. */
static void count_crossing(const rows *w, long count[2]) {
  count[0] = count[1] = 0;
  for (long q = 0; q < w->size; q++)
    for (int k = 0; k < w->directions; k++) {
      if (!(w->bonds[q] >> k & 1)) continue;
      const double from = w->z[q] - 1e-3, to = from + w->chord[k][2];
      if ((from > 0) != (to > 0)) count[w->shell[k] - 1]++;
    }
}

/* Half a crystal lifted off the other along a cube face costs what its bonds cost; on an endless
   plane that is G_f. */
static void a_crack_through_the_crystal_costs_G_f(void **state) {
  (void)state;
  deck_case l, c;
  long crossing[2];
  const double E = 30e9, f_t = 3e6, G_f = 80, s = 5e-3;
  const double last = 5 / (1 + 4 * sqrt(2)) * G_f / f_t; /* opening at separation */
  const double k_1 = 4 / (5 * sqrt(2)) * E * s * s, k_2 = E * s * s / 5;
  const double g_1 = k_1 * f_t / E * last / 2, g_2 = k_2 * f_t / E * last / 2;
  is_within("cost of an endless plane over G_f", (4 * g_1 + 2 * g_2) / (s * s) / G_f, 1 - 1e-12,
            1 + 1e-12);
  assert_true(deck_case_lattice(&l, layers));
  count_crossing(l.lattice, crossing);
  deck_case_close(&l);
  assert_true(deck_case_text(&c, layers));
  assert_int_equal(deck_case_go(&c), STEP_END);
  is_within("cost over that of the bonds cut",
            deck_case_last(&c, "energy/dissipated_damage") /
                ((double)crossing[0] * g_1 + (double)crossing[1] * g_2),
            0.999, 1.001);
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_cube_has_the_constants_of_the_solid),
      cmocka_unit_test(pulses_travel_along_a_bar),
      cmocka_unit_test(a_crack_runs_below_the_rayleigh_speed),
      cmocka_unit_test(a_beam_in_space_breaks),
      cmocka_unit_test(a_crack_through_the_crystal_costs_G_f),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
