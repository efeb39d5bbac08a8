/* How long a step is and how many there are: bars on a hexagonal lattice against the frequency of
   theory, what no step can be chosen for, and the samples of a run. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/parts/step_choice.h"
#include "tests/runtime/built_rows.h"
#include "tests/runtime/elastic_law.h"

typedef struct chosen {
  built_rows rows;
  deck deck; /* may be changed */
  double parameters[ELASTIC_PARAMETERS];
  step_limit limit;
} chosen;

static void open_block(chosen *c) {
  build_rows(&c->rows, "&simulation end_time = 1e-3 /\n"
                       "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
                       "&material lattice = 'c' model = 'm' /\n"
                       "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n");
  c->deck = *c->rows.deck;
  for (int p = 0; p < ELASTIC_PARAMETERS; p++)
    c->parameters[p] = elastic_parameters[p].initial;
  rows_set_density(c->rows.rows, c->parameters[ELASTIC_RHO]);
}

static bool choose(chosen *c) {
  return step_limit_of(&c->deck, 0, &elastic_bar, c->parameters, NULL, c->rows.rows, &c->limit,
                       &c->rows.said) &&
         step_choose(&c->deck, &elastic_bar, NULL, &c->limit, &c->rows.said) &&
         step_fits(&c->deck, &c->limit, &c->rows.said);
}

static void must_refuse(chosen *c, diag_code code, const char *sentence) {
  const int before = c->rows.said.count;
  assert_false(choose(c));
  assert_int_equal(c->rows.said.count, before + 1);
  assert_int_equal(c->rows.said.items[before].code, code);
  if (!strstr(c->rows.said.items[before].message, sentence))
    fail_msg("%s, not: %s", c->rows.said.items[before].message, sentence);
}

/* Springs k = EA/s between nearest neighbours of masses m: the fastest wave, with bonds of one
   direction at rest and those of the two others in opposition, has omega^2 = 6 k/m; central
   differences are stable up to 2/omega. The limit has nine digits. */
static double limit_of_theory(const chosen *c) {
  const double s = 0.01, t = 0.1, rho = c->parameters[ELASTIC_RHO], nu = c->parameters[ELASTIC_NU];
  const double k = c->parameters[ELASTIC_E] * t / (sqrt(3) * (1 - nu)),
               m = rho * sqrt(3) / 2 * s * s * t;
  return 2 / sqrt(6 * k / m);
}

static void the_step_is_a_part_of_the_limit_of_theory(void **state) {
  (void)state;
  static const double stiffer[] = {1, 4, 0.01}, part[] = {0.25, 0.9, 1};
  chosen c;
  open_block(&c);
  for (int k = 0; k < 3; k++) {
    c.parameters[ELASTIC_E] = stiffer[k] * elastic_parameters[ELASTIC_E].initial;
    c.deck.simulation.step_safety = part[k];
    assert_true(choose(&c));
    assert_true(fabs(c.limit.limit / limit_of_theory(&c) - 1) < 1e-8);
    assert_true(c.limit.step == part[k] * c.limit.limit);
    c.deck.simulation.step = c.limit.limit;
    assert_true(choose(&c));
    assert_true(c.limit.step == c.deck.simulation.step);
    c.deck.simulation.step = 0;
  }
  assert_int_equal(c.rows.said.count, 0);
  built_end(&c.rows);
}

static void no_step_is_chosen_where_none_is_stable(void **state) {
  (void)state;
  chosen c;
  open_block(&c);
  const double limit = limit_of_theory(&c), E = c.parameters[ELASTIC_E];
  c.deck.simulation.step = limit * (1 + 1e-6);
  must_refuse(&c, DIAG_UNSTABLE_STEP, "is unstable: the largest stable one");
  c.deck.simulation.step = 0;
  c.deck.simulation.end_time = 0.24 * limit; /* a step is a quarter of the limit */
  must_refuse(&c, DIAG_OUT_OF_BOUNDS, "is shorter than one step");
  c.deck.relaxation.increments = 1; /* time is only an order */
  assert_true(choose(&c));
  c.parameters[ELASTIC_E] = -E;
  must_refuse(&c, DIAG_STIFFNESS, "the virgin body is unstable at rest");
  c.parameters[ELASTIC_E] = 0;
  must_refuse(&c, DIAG_UNSTABLE_STEP, "has no stiffness to choose a step from");
  c.parameters[ELASTIC_E] = NAN;
  must_refuse(&c, DIAG_UNSTABLE_STEP, "has no finite stiffness at rest");
  built_end(&c.rows);
}

static step_plan plan_of(double end, double step, double sample) {
  const deck k = {.simulation.end_time = end, .output.sample = sample};
  const step_limit limit = {.step = step};
  diagnostics d = {0};
  step_plan plan;
  assert_true(step_plan_make(&k, &limit, &plan, &d));
  return plan;
}

/* The run ends with the first step at or past its end; a part of 1e-9 of a step is rounding. */
static void steps_reach_the_end(void **state) {
  (void)state;
  assert_int_equal(plan_of(1, 0.125, 0).step_count, 8);
  assert_int_equal(plan_of(1, 0.1, 0).step_count, 10);
  assert_int_equal(plan_of(1, 0.3, 0).step_count, 4);
  assert_int_equal(plan_of(1, 1.0 / (7 + 1e-10), 0).step_count, 7);
  assert_int_equal(plan_of(1, 1.0 / (7 + 1e-8), 0).step_count, 8);
  assert_int_equal(plan_of(1, 100, 0).step_count, 1);
}

/* As the deck asks, but no more than one a step; else 2000 of a long run, and one in 200 steps of a
   short one. There is room for all of them and for those at the start and at either end. */
static void samples_have_room(void **state) {
  (void)state;
  assert_true(plan_of(1, 1e-3, 0.05).sample_interval == 0.05);
  assert_int_equal(plan_of(1, 1e-3, 0.05).history_capacity, 20 + 3);
  assert_true(plan_of(1, 1e-3, 1e-5).sample_interval == 1e-3);
  assert_int_equal(plan_of(1, 1e-3, 1e-5).history_capacity, 1000 + 3);
  assert_true(plan_of(1, 1e-3, 0).sample_interval == 0.2);
  assert_true(plan_of(1, 1e-7, 0).sample_interval == 1.0 / 2000);
  assert_int_equal(plan_of(1, 1e-7, 0).history_capacity, 2000 + 3);
}

static void increments_take_the_steps_they_need(void **state) {
  (void)state;
  const deck k = {.simulation.end_time = 3, .relaxation.increments = 12};
  const step_limit limit = {.step = 1e-30};
  diagnostics d = {0};
  step_plan plan;
  assert_true(step_plan_make(&k, &limit, &plan, &d));
  assert_true(plan.sample_interval == 0.25);
  assert_true(plan.step_count > INT64_C(1000000000000));
  assert_int_equal(plan.history_capacity, 12 + 3);
}

static void too_many_steps_are_refused(void **state) {
  (void)state;
  static const double too_short[] = {0.99e-12, 0, NAN};
  chosen c;
  open_block(&c);
  c.deck.simulation.end_time = 1;
  step_plan plan;
  c.limit.step = 1.01e-12;
  assert_true(step_plan_make(&c.deck, &c.limit, &plan, &c.rows.said));
  for (int k = 0; k < 3; k++) {
    c.limit.step = too_short[k];
    assert_false(step_plan_make(&c.deck, &c.limit, &plan, &c.rows.said));
    assert_int_equal(c.rows.said.count, k + 1);
    assert_non_null(strstr(c.rows.said.items[k].message, "the run would take"));
    assert_non_null(strstr(c.rows.said.items[k].message, "the most is 1e+12"));
    assert_non_null(strstr(c.rows.said.items[k].hint, "&relaxation"));
  }
  built_end(&c.rows);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_step_is_a_part_of_the_limit_of_theory),
      cmocka_unit_test(no_step_is_chosen_where_none_is_stable),
      cmocka_unit_test(steps_reach_the_end),
      cmocka_unit_test(samples_have_room),
      cmocka_unit_test(increments_take_the_steps_they_need),
      cmocka_unit_test(too_many_steps_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
