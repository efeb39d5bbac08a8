/* For tests: a run that stops and goes on in another one, through a checkpoint. Include after
   cmocka.h. */
#ifndef PERILAT_TESTS_HAND_OVER_H
#define PERILAT_TESTS_HAND_OVER_H

#include <stdlib.h>
#include <unistd.h>

#include "runtime/simulation/simulation.h"
#include "runtime/simulation/simulation_save.h"

/* `first` goes up to step `stop`, `second`, made from the same deck, is then where `first` is. */
static inline void hand_over(simulation *first, long stop, simulation *second) {
  char path[] = "/tmp/perilat-state-XXXXXX", error[256] = "";
  const frame_mark before = {3, 7};
  frame_mark after = {-1, 0};
  const int file = mkstemp(path);
  assert_true(file >= 0);
  close(file);
  while (simulation_step_done(first) < stop)
    simulation_advance(first, stop - simulation_step_done(first), NULL);
  if (!simulation_save(first, path, "one deck, one law", &before, error, sizeof error) ||
      !simulation_restore(second, path, "one deck, one law", &after, error, sizeof error))
    fail_msg("%s", error);
  assert_true(after.count == before.count && after.sum == before.sum);
  assert_int_equal(simulation_step_done(second), stop);
  unlink(path);
}

#endif
