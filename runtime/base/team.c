#include "runtime/base/team.h"

#include <omp.h>
#include <sched.h>
#include <stdint.h>
#include <stdlib.h>

#include "dsl/base/arena.h"

enum { LINE = 64 };       /* B of memory that processors hand to each other at once */
enum { PATIENCE = 1000 }; /* looks at a number before others get the processor */

typedef struct team_claim {
  _Alignas(LINE) atomic_long round; /* in which the block is next to be done */
} team_claim;

struct team {
  int blocks;
  team_claim *claims;              /* [blocks] */
  _Alignas(LINE) atomic_long done; /* blocks of this round */
  _Alignas(LINE) atomic_long round;
  atomic_int task; /* of this round */
};

static void *new_lines(size_t size) {
  return must_align(LINE, size);
}

team *team_new(int blocks) {
  team *t = new_lines(sizeof *t);
  t->blocks = blocks;
  t->claims = new_lines((size_t)blocks * sizeof *t->claims);
  atomic_init(&t->done, 0);
  atomic_init(&t->round, 0);
  atomic_init(&t->task, TEAM_END);
  for (int b = 0; b < blocks; b++)
    atomic_init(&t->claims[b].round, 0);
  return t;
}

void team_free(team *t) {
  if (t) free(t->claims);
  free(t);
}

void team_begin(team *t, int task) {
  atomic_store(&t->task, task);
}

/* A thread that comes late still believes in an earlier round, of which no block is left. */
static void do_block(team *t, const team_work *work, long round, int task, int block) {
  long expected = round;
  if (!atomic_compare_exchange_strong(&t->claims[block].round, &expected, round + 1)) return;
  work->block(work->of, task, block);
  if (atomic_fetch_add(&t->done, 1) < t->blocks - 1) return;
  atomic_store(&t->done, 0);
  atomic_store(&t->task, work->next(work->of, task));
  atomic_store(&t->round, round + 1);
}

bool team_is_first(team_errand *e, long round) {
  long expected = round;
  if (atomic_compare_exchange_strong(&e->begun, &expected, round + 1)) return true;
  for (int looks = 0; atomic_load(&e->done) <= round; looks++)
    if (looks > PATIENCE) sched_yield();
  return false;
}

void team_did(team_errand *e, long round) {
  atomic_store(&e->done, round + 1);
}

static bool is_over(team *t, long round) {
  return atomic_load(&t->round) != round;
}

/* Rounds are short, so that waiting is first a look at a number. Then what others have not begun is
   done for them, and at last the processor is left to them. */
static void see_to_end(team *t, const team_work *work, long round, int task, int me) {
  for (int looks = 0; looks < PATIENCE; looks++)
    if (is_over(t, round)) return;
  for (int k = 1; k < t->blocks; k++)
    do_block(t, work, round, task, (me + k) % t->blocks);
  for (int looks = 0; !is_over(t, round); looks++)
    if (looks > PATIENCE) sched_yield();
}

void team_join(team *t, const team_work *work) {
  const int me = omp_get_thread_num(), threads = omp_get_num_threads();
  for (;;) {
    const long round = atomic_load(&t->round);
    const int task = atomic_load(&t->task);
    if (task == TEAM_END) return;
    for (int b = me; b < t->blocks; b += threads)
      do_block(t, work, round, task, b);
    see_to_end(t, work, round, task, me);
  }
}
