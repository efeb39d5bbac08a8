/* Bodies that harden while they are brought to rest: the time step, which the virgin body has
   given, becomes too long. Theory: what comes under a load F at the age t stretches by F/k(t), and
   what solidifies later carries nothing of it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

/* Loads come in the first and in the last of eight hours; k grows ninefold. */
static void open_plate(deck_case *c, const char *more, int increments) {
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation end_time = '8 h' %s /\n&relaxation increments = %d tolerance = 1e-7 /\n"
           "&lattice name = 'l' kind = 'hexagonal' spacing = '10 mm' thickness = '100 mm' /\n"
           "&material lattice = 'l' model = '" SOURCE_DIR
           "/tests/generator/run/ageing/hardening_bond.plm' rate = '1 1/h' /\n"
           "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '100 mm', '60 mm' /\n"
           "&region name = 'left' shape = 'rectangle' corner = -1, -1 size = '1.006 m', 2 /\n"
           "&region name = 'right' shape = 'rectangle' corner = '94 mm', -1 size = 1, 2 /\n"
           "&support region = 'left' fix = 'x' /\n"
           "&force region = 'right' component = 'x' total = '1 kN' times = 0, '1 h', '7 h', '8 h' "
           "values = 0, 1, 1, 2 /\n"
           "&monitor name = 'u' kind = 'displacement' region = 'right' component = 'x' /\n",
           more, increments);
  deck_case_open(c, text);
}

static void steps_shrink_as_a_body_hardens(void **state) {
  (void)state;
  double u[2];
  for (int careful = 0; careful < 2; careful++) {
    deck_case c;
    open_plate(&c, careful ? "step_safety = 0.2" : "", 80);
    assert_int_equal(deck_case_go(&c), STEP_END);
    const double planned = simulation_step_limit(c.simulation)->step,
                 step = simulation_step_now(c.simulation);
    u[careful] = deck_case_last(&c, "u");
    print_message("step %.4g us of %.4g; %.3g times as stiff; u %.10g um\n", 1e6 * step,
                  1e6 * planned, simulation_stiffened(c.simulation), 1e6 * u[careful]);
    assert_true(careful ? step == planned : fabs(step / planned - 1. / 3) < 0.03);
    if (!careful) {
      const double first = deck_case_series(&c, "u")[10], second = u[0] - first,
                   theory = log(9. / 8) / log(2); /* loads that grow evenly while k = 1 + t */
      print_message("the second load moves it %.4g of the first, theory %.4g\n", second / first,
                    theory);
      assert_true(fabs(second / first / theory - 1) < 0.05);
    }
    deck_case_close(&c);
  }
  assert_true(fabs(u[0] / u[1] - 1) < 1e-3); /* loads come in other steps */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_shrink_as_a_body_hardens),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
