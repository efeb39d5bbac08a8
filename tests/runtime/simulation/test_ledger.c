/* The energy ledger: it closes as steps get shorter, and what it says of laws and of steps that
   are too long. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/filling/lattice.h"
#include "runtime/interaction/sweep.h"
#include "runtime/parts/ledger.h"
#include "tests/runtime/simulation/chain.h"

typedef struct balance {
  double imbalance, external, damage;
} balance;

/* Largest imbalance of a driven block over the run. */
static balance driven_block(double safety, const char *material) {
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 2e-4 step_safety = %g /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 10 /\n"
           "&material lattice = 'c' model = 'm' %s /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.06 /\n"
           "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = 0.015, 0.1 /\n"
           "&region name = 'right' shape = 'rectangle' corner = 0.185, 0 size = 0.015, 0.1 /\n"
           "&support region = 'left' fix = 'x', 'y' /\n"
           "&drive region = 'right' component = 'x' velocity = 0.1 rise = 5e-5 /\n"
           "&drive region = 'right' component = 'y' velocity = 0.2 rise = 5e-5 /\n"
           "&damping rate = 2000 until = 1e-4 /\n"
           "&output frames = 0 sample = 1e-6 /\n",
           safety, material);
  small_run r;
  must_open(&r, &elastic_beam, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double *imbalance;
  const long samples = simulation_history(r.simulation, NULL);
  simulation_series(r.simulation, small_series(&r, "energy/imbalance"), NULL, &imbalance);
  balance b = {0, small_last(&r, "energy/external"), small_last(&r, "energy/dissipated_damage")};
  for (long k = 0; k < samples; k++)
    b.imbalance = fmax(b.imbalance, fabs(imbalance[k]));
  small_close(&r);
  return b;
}

static void the_ledger_closes_for_an_elastic_block(void **state) {
  (void)state;
  const balance coarse = driven_block(0.5, ""), fine = driven_block(0.25, "");
  print_message("elastic block: imbalance %.2e and %.2e of the work at 0.5 and 0.25 of the limit\n",
                coarse.imbalance / coarse.external, fine.imbalance / fine.external);
  assert_true(coarse.imbalance < 1e-4 * coarse.external);
  assert_true(fine.imbalance < 0.4 * coarse.imbalance);
}

static void the_ledger_closes_with_dissipation(void **state) {
  (void)state;
  const balance coarse = driven_block(0.4, "tau = 2e-7"), fine = driven_block(0.2, "tau = 2e-7");
  print_message("viscous block: imbalance %.2e and %.2e of the work\n",
                coarse.imbalance / coarse.external, fine.imbalance / fine.external);
  assert_true(fine.imbalance < 0.01 * fine.external && fine.imbalance < 0.7 * coarse.imbalance);
  const balance a = driven_block(0.4, "S_t = 1e-4"), b = driven_block(0.1, "S_t = 1e-4");
  print_message("damaged block: imbalance %.2e and %.2e of the work, %.2f lost to damage\n",
                a.imbalance / a.external, b.imbalance / b.external, b.damage / b.external);
  assert_true(b.damage > 0.05 * b.external);
  assert_true(b.imbalance < 0.01 * b.external && b.imbalance < 0.7 * a.imbalance);
}

/* --- long steps ------------------------------------------------------------------------------- */

enum { LONG_RUN = 40 };
static const double phase =
    1.15; /* omega dt of the pair; the lattice that it is part of bears 2/sqrt(3) */

static double pair_frequency(void) {
  return sqrt(2 * rigidity_axial(0.2) / SPACING / particle_mass());
}

/* A free pair that swings by a thousandth of its length, with every step sampled. */
static void open_swinging_pair(small_run *r, int steps) {
  const double step = phase / pair_frequency();
  char text[1024];
  snprintf(text, sizeof text,
           "&simulation end_time = %.17g step = %.17g /\n" CHAIN
           "&material lattice = 'c' model = 'm' /\n&output frames = 0 sample = %.17g /\n",
           (steps - 0.01) * step, step, 1.0 * SPACING, step);
  must_open(r, &elastic_bar, text);
  sweep *w = simulation_state(r->simulation, 0);
  const double speed = 0.5e-3 * SPACING * pair_frequency() / 1e3;
  w->body->velocity[0][w->body->lattice->particle_site[0]] = -speed;
  w->body->velocity[0][w->body->lattice->particle_site[1]] = speed;
}

static const double *series_of(const small_run *r, ledger_term term) {
  const double *values;
  simulation_series(r->simulation, small_series(r, ledger_names[term]), NULL, &values);
  return values;
}

/* Leapfrog steps of linear springs: half m v- v+ and the energy stored keep their sum, and the
   first may be negative, but never by more than (omega dt/2)^2 of what is stored. */
static void energies_of_long_steps_keep_their_sum(void **state) {
  (void)state;
  small_run r;
  open_swinging_pair(&r, LONG_RUN);
  assert_int_equal(small_go(&r), STEP_END);
  const double *kinetic = series_of(&r, LEDGER_KINETIC), *stored = series_of(&r, LEDGER_STORED);
  const double sum = kinetic[0] + stored[0];
  double least = 0;
  assert_int_equal(simulation_history(r.simulation, NULL), LONG_RUN + 1);
  assert_true(sum > 0);
  for (int k = 0; k <= LONG_RUN; k++) {
    assert_true(fabs(kinetic[k] + stored[k] - sum) <
                1e-5 * sum); /* strains of 1e-6 are nearly linear */
    if (stored[k] > 0) least = fmin(least, kinetic[k] / stored[k]);
  }
  assert_true(least < -0.5 * phase * phase / 4 && least > -(phase * phase / 4) * (1 + 1e-5));
  small_close(&r);
}

/* Of a state with negative kinetic energy: sound for the frequency that the step was chosen by,
   and energy from nothing if the step were short for it. */
static void steps_that_make_energy_are_told(void **state) {
  (void)state;
  small_run r;
  open_swinging_pair(&r, LONG_RUN);
  assert_int_equal(small_go(&r), STEP_END);
  const double *kinetic = series_of(&r, LEDGER_KINETIC), *stored = series_of(&r, LEDGER_STORED);
  int negative = 2;
  while (negative < LONG_RUN && !(kinetic[negative] < -0.1 * stored[negative]))
    negative++;
  small_close(&r);
  assert_true(negative < LONG_RUN);
  open_swinging_pair(&r, negative);
  assert_int_equal(small_go(&r), STEP_END);
  const sweep *w = simulation_state(r.simulation, 0);
  rows *lattice = lattice_build(r.deck, 0, &r.said);
  loads *l = loads_new(r.deck, 0, lattice, "m", 2, &r.said);
  ledger g = {0};
  ledger_laws of = {.unchecked = NULL};
  ledger_add_law(&of, w->law, true);
  double terms[LEDGER_COUNT];
  assert_true(ledger_sample(&g, &of, w->body, l, &(load_look){0}, pair_frequency(), terms));
  assert_true(terms[LEDGER_KINETIC] < 0 &&
              terms[LEDGER_KINETIC] == small_last(&r, "energy/kinetic"));
  assert_true(terms[LEDGER_STORED] == small_last(&r, "energy/stored"));
  assert_true(terms[LEDGER_IMBALANCE] == 0); /* it begins with this sample */
  assert_false(ledger_sample(&g, &of, w->body, l, &(load_look){0}, 0.1 * pair_frequency(), terms));
  loads_free(l);
  rows_free(lattice);
  small_close(&r);
}

/* --- laws ------------------------------------------------------------------------------------- */

/* The imbalance judges laws whose own losses are counted. */
static void some_laws_are_not_judged(void **state) {
  (void)state;
  pl_law law = elastic_bar;
  assert_null(ledger_unchecked(&law, true));
  law.stores = 0;
  assert_non_null(strstr(ledger_unchecked(&law, true), "does not say all that its bonds store"));
  law = elastic_bar;
  law.kind = PL_STATE;
  law.reads_rates = 0;
  assert_non_null(strstr(ledger_unchecked(&law, true), "does not say what it takes"));
  law.ledger.pass_count = 1;
  assert_null(ledger_unchecked(&law, true));
  assert_non_null(strstr(ledger_unchecked(&law, false), "losses = .true."));
  law.size = (uint32_t)offsetof(pl_law, ledger); /* of a host before there were losses */
  assert_non_null(strstr(ledger_unchecked(&law, true), "does not say what it takes"));
  law.field_count = 0;
  assert_null(ledger_unchecked(&law, true));
  law.reads_rates = 1;
  assert_non_null(strstr(ledger_unchecked(&law, true), "does not say what it takes"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_ledger_closes_for_an_elastic_block),
      cmocka_unit_test(the_ledger_closes_with_dissipation),
      cmocka_unit_test(energies_of_long_steps_keep_their_sum),
      cmocka_unit_test(steps_that_make_energy_are_told),
      cmocka_unit_test(some_laws_are_not_judged),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
