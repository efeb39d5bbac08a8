/* What a law is told by the records that the time loop hands it: how long they are, the deck's time
   of the places, and the step. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/runtime/family_law.h"
#include "tests/runtime/small_run.h"

/* Of the calls since `calls` was 0; the run has one thread. */
typedef struct told {
  const pl_law *law; /* that does the work */
  double first, last, step;
  long calls, too_short;
} told;

static void note(const pl_law *law, bool whole, double time, double step) {
  told *t = (told *)law->context;
  if (t->calls++ == 0) t->first = time;
  t->last = time;
  t->step = step;
  t->too_short += !whole;
}

static const pl_law *inner(const pl_law *law) {
  return ((const told *)law->context)->law;
}

static void told_prepare(const pl_law *law, const double *parameters, const pl_bond_class *bonds,
                         double *uniforms) {
  ((told *)law->context)->too_short += !PL_HAS(bonds, weight);
  inner(law)->prepare(inner(law), parameters, bonds, uniforms);
}

static void told_rows(const pl_law *law, const double *u, const pl_strip *s) {
  note(law, PL_HAS(s, time_step), s->time, s->time_step);
  inner(law)->rows(inner(law), u, s);
}

static void told_observe(const pl_law *law, const double *u, const pl_strip *s) {
  note(law, PL_HAS(s, time_step), s->time, s->time_step);
  inner(law)->rows_observe(inner(law), u, s);
}

static void told_fields_pass(const pl_law *law, const double *u, const pl_family *f) {
  note(law, PL_HAS(f, settled), f->time, f->time_step);
  family_fields_pass(inner(law), u, f);
}

static void told_force_pass(const pl_law *law, const double *u, const pl_family *f) {
  note(law, PL_HAS(f, settled), f->time, f->time_step);
  family_force_pass(inner(law), u, f);
}

static const char deck_text[] =
    "&simulation end_time = 1e-3 threads = 1 step = 1e-6 /\n"
    "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
    "&material lattice = 'c' model = 'm' /\n"
    "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"
    "&output sample = 4e-6 frames = 0 energy = .false. /\n";

/* A step begins with the law at the places of its beginning; what is looked at is of its end, in
   every fourth. */
static void assert_told(const pl_law *law, told *t) {
  small_run r;
  small_open(&r, law, deck_text);
  small_print(&r);
  assert_non_null(r.simulation);
  for (int k = 0; k < 12; k++) {
    t->calls = 0;
    assert_int_equal(simulation_advance(r.simulation, 1, NULL), STEP_OK);
    assert_true(t->calls > 0 && t->step > 0);
    if (t->first != k * t->step) fail_msg("step %d begins at %.17g s", k, t->first);
    const double end = (k % 4 == 3 ? k + 1 : k) * t->step;
    if (t->last != end) fail_msg("step %d ends at %.17g s, not %.17g s", k, t->last, end);
  }
  assert_int_equal(t->too_short, 0);
  small_close(&r);
}

static void strips_have_the_time_of_their_places(void **state) {
  (void)state;
  told t = {.law = &elastic_bar};
  pl_law law = elastic_bar;
  law.context = &t;
  law.prepare = told_prepare;
  law.rows = told_rows;
  law.rows_observe = told_observe;
  assert_told(&law, &t);
}

/* Increments take many steps; the deck's time goes through them without a jump, to the end. */
static void quasi_static_runs_tell_the_time_of_the_deck(void **state) {
  (void)state;
  told t = {.law = &elastic_bar};
  pl_law law = elastic_bar;
  law.context = &t;
  law.prepare = told_prepare;
  law.rows = told_rows;
  law.rows_observe = told_observe;
  small_run r;
  small_open(
      &r, &law,
      "&simulation end_time = 1 threads = 1 /\n&relaxation increments = 4 tolerance = 1e-6 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
      "&material lattice = 'c' model = 'm' /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"
      "&output frames = 0 energy = .false. /\n");
  small_print(&r);
  assert_non_null(r.simulation);
  double before = 0;
  step_status status;
  do {
    t.calls = 0;
    status = simulation_advance(r.simulation, 1, NULL);
    if (!(t.first >= before && t.last >= t.first && t.last - before < 0.2))
      fail_msg("from %g s to %g s, then %g s", before, t.first, t.last);
    before = t.last;
  } while (status == STEP_OK);
  assert_int_equal(status, STEP_END);
  assert_true(fabs(t.last - 1) < 1e-12);
  small_close(&r);
}

static void families_have_the_time_of_their_places(void **state) {
  (void)state;
  static const pl_family_function step[] = {told_fields_pass, told_force_pass};
  told t = {.law = &family_hexagon};
  pl_law law = family_hexagon;
  law.context = &t;
  law.prepare = told_prepare;
  law.step = (pl_program){2, step, 0, 0, 0, NULL};
  assert_told(&law, &t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(strips_have_the_time_of_their_places),
      cmocka_unit_test(quasi_static_runs_tell_the_time_of_the_deck),
      cmocka_unit_test(families_have_the_time_of_their_places),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
