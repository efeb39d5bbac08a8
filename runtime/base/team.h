/* Threads that go through rounds of work together. A round has blocks; each thread does its own,
   and those of others that are late in beginning theirs; the round is over when all blocks are
   done, whoever did them. So a thread that the system does not let run holds up the others only
   from the middle of a block. Results must not depend on who does a block. */
#ifndef PERILAT_RUNTIME_TEAM_H
#define PERILAT_RUNTIME_TEAM_H

#include <stdatomic.h>
#include <stdbool.h>

typedef struct team team;

enum { TEAM_END = -1 };

typedef struct team_work {
  void *of;
  void (*block)(void *of, int task, int block);
  /* By one thread, while the others wait, after the last block of a round: the task of the next
     one, or TEAM_END. */
  int (*next)(void *of, int task);
} team_work;

/* Blocks per round, at least one. */
team *team_new(int blocks);
void team_free(team *t);
/* Before the threads join: what the first round does. */
void team_begin(team *t, int task);
/* What several blocks of a round need, and who needs it first does for all, in rounds 0, 1, ...
   Zero before the first. */
typedef struct team_errand {
  atomic_long begun, done; /* rounds */
} team_errand;

/* True: the caller has to do it now, without waiting for anything, and then to call team_did.
   False: it is done. */
bool team_is_first(team_errand *e, long round);
void team_did(team_errand *e, long round);

/* Called by all threads of a parallel region, at most as many as there are blocks; returns at
   TEAM_END. */
void team_join(team *t, const team_work *work);

#endif
