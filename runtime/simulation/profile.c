#include "runtime/simulation/profile.h"

#include <string.h>

const char *const profile_names[PROFILE_PART_COUNT] = {
#define X(code, name) [PROFILE_##code] = name,
    PROFILE_PARTS(X)
#undef X
};

/* Of all blocks, a thread's share; when it does not work, it waits. */
void profile_sum(profile *p, const body *w) {
  const double share = 1.0 / w->block_count;
  double *part = p->part;
  part[PROFILE_LAW] = part[PROFILE_PARTICLES] = 0;
  part[PROFILE_SAMPLING] = p->sampled;
  part[PROFILE_LOADS] = p->loaded;
  memset(p->pass, 0, sizeof p->pass);
  for (int k = 0; k < w->block_count; k++) {
    const body_block *b = &w->blocks[k];
    part[PROFILE_LAW] += share * (b->stepping - b->moving);
    part[PROFILE_PARTICLES] += share * b->moving;
    part[PROFILE_LOADS] += share * b->loading;
    part[PROFILE_SAMPLING] += share * b->observing;
    for (int n = 0; n < BODY_TIMED_PASSES; n++)
      p->pass[n] += share * b->passes[n];
  }
  part[PROFILE_WAITING] = p->elapsed - part[PROFILE_LAW] - part[PROFILE_PARTICLES] -
                          part[PROFILE_SAMPLING] - part[PROFILE_LOADS];
}
