#include "runtime/simulation/profile.h"

#include <string.h>

const char *const profile_names[PROFILE_PART_COUNT] = {
#define X(code, name) [PROFILE_##code] = name,
    PROFILE_PARTS(X)
#undef X
};

static void add_block(profile *p, const body_block *b, double share) {
  double *part = p->part;
  part[PROFILE_LAW] += share * (b->stepping - b->moving);
  part[PROFILE_PARTICLES] += share * b->moving;
  part[PROFILE_LOADS] += share * b->loading;
  part[PROFILE_SAMPLING] += share * b->observing;
  for (int n = 0; n < BODY_TIMED_PASSES; n++)
    p->pass[n] += share * b->passes[n];
}

/* Of all blocks, a thread's share; when it does not work, it waits. */
void profile_sum(profile *p, const run_body *bodies, int count, int threads) {
  double *part = p->part;
  part[PROFILE_LAW] = part[PROFILE_PARTICLES] = 0;
  part[PROFILE_SAMPLING] = p->sampled;
  part[PROFILE_LOADS] = p->loaded;
  memset(p->pass, 0, sizeof p->pass);
  for (int b = 0; b < count; b++)
    for (int k = 0; k < bodies[b].body->block_count; k++)
      add_block(p, &bodies[b].body->blocks[k], 1.0 / threads);
  part[PROFILE_WAITING] = p->elapsed - part[PROFILE_LAW] - part[PROFILE_PARTICLES] -
                          part[PROFILE_SAMPLING] - part[PROFILE_LOADS];
}
