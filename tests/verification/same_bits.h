/* For tests: a deck's run has the same bits whatever the threads, and when it is interrupted and
   gone on with by other threads. */
#ifndef PERILAT_TESTS_SAME_BITS_H
#define PERILAT_TESTS_SAME_BITS_H

#include "tests/runtime/hand_over.h"
#include "tests/runtime/same_runs.h"
#include "tests/verification/case.h"

/* Opens deck k of a test, to be run by so many threads. */
typedef void (*case_opener)(deck_case *c, size_t k, int threads);

static inline void run_to_end(deck_case *c, case_opener open_case, size_t k, int threads) {
  open_case(c, k, threads);
  assert_int_equal(deck_case_go(c), STEP_END);
}

/* One thread beside three, and beside one that hands over to two in the middle. */
static inline void assert_same_bits_of(case_opener open_case, size_t k) {
  deck_case one, more, first, second;
  run_to_end(&one, open_case, k, 1);
  run_to_end(&more, open_case, k, 3);
  same_runs(one.simulation, more.simulation);
  open_case(&first, k, 1);
  open_case(&second, k, 2);
  hand_over(first.simulation, simulation_step_done(one.simulation) / 2, second.simulation);
  assert_int_equal(deck_case_go(&second), STEP_END);
  same_runs(one.simulation, second.simulation);
  deck_case_close(&one);
  deck_case_close(&more);
  deck_case_close(&first);
  deck_case_close(&second);
}

#endif
