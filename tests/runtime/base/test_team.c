/* Teams of threads: each block is done once a round, rounds come one after the other, a thread that
   does not come holds up nobody, and what several blocks need is done once, before any of them goes
   on. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <omp.h>
#include <sched.h>
#include <stdbool.h>
#include <string.h>

#include "runtime/base/team.h"

enum { BLOCKS = 7, ROUNDS = 3000, TASKS = 3 };

typedef struct diary {
  long rounds;
  atomic_int done[BLOCKS]; /* times in this round */
  long total[BLOCKS];      /* by whoever does the block: no two at a time, or sums go astray */
  team_errand errand[BLOCKS];
  long errands[BLOCKS]; /* done */
  atomic_int wrong;
  atomic_bool finished;
} diary;

static void run_errand(diary *d, int k) {
  if (team_is_first(&d->errand[k], d->rounds)) {
    d->errands[k]++;
    team_did(&d->errand[k], d->rounds);
  }
  if (d->errands[k] != d->rounds + 1) d->wrong++;
}

/* A block needs two errands, and each is needed by two blocks. */
static void do_block(void *of, int task, int block) {
  diary *d = of;
  run_errand(d, block);
  run_errand(d, (block + 1) % BLOCKS);
  if (task != (int)(d->rounds % TASKS)) d->wrong++;
  d->done[block]++;
  d->total[block] += d->rounds;
}

static int next(void *of, int task) {
  diary *d = of;
  for (int b = 0; b < BLOCKS; b++)
    if (atomic_exchange(&d->done[b], 0) != 1) d->wrong++;
  d->rounds++;
  if (d->rounds == ROUNDS) d->finished = true;
  return d->rounds == ROUNDS ? TEAM_END : (task + 1) % TASKS;
}

static void assert_good(const diary *d) {
  assert_int_equal(d->wrong, 0);
  assert_int_equal(d->rounds, ROUNDS);
  for (int b = 0; b < BLOCKS; b++)
    assert_int_equal(d->total[b], (long)ROUNDS * (ROUNDS - 1) / 2);
}

static void run(team *t, diary *d, int threads, int absent) {
  const team_work work = {.of = d, .block = do_block, .next = next};
  memset(d, 0, sizeof *d);
  team_begin(t, 0);
#pragma omp parallel num_threads(threads)
  {
    while (omp_get_thread_num() < absent && !d->finished)
      sched_yield();
    team_join(t, &work);
  }
  assert_good(d);
}

static void each_block_is_done_once_a_round(void **state) {
  (void)state;
  team *t = team_new(BLOCKS);
  diary d;
  for (int threads = 1; threads <= BLOCKS; threads++)
    run(t, &d, threads, 0);
  team_free(t);
}

/* The first threads come when all is done: the last one does the blocks of all. */
static void an_absent_thread_holds_up_nobody(void **state) {
  (void)state;
  team *t = team_new(BLOCKS);
  diary d;
  for (int threads = 2; threads <= BLOCKS; threads++)
    run(t, &d, threads, threads - 1);
  team_free(t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_block_is_done_once_a_round),
      cmocka_unit_test(an_absent_thread_holds_up_nobody),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
