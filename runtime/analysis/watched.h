/* What a monitor watches of a part of a body: accelerations, momenta, energies, stresses, strains,
   the force through a section, that along a bar, the tip of a crack, widths of cracks. */
#ifndef PERILAT_RUNTIME_WATCHED_H
#define PERILAT_RUNTIME_WATCHED_H

#include "dsl/base/arena.h"
#include "dsl/base/diagnostics.h"
#include "runtime/analysis/crack_line.h"
#include "runtime/body/momentum.h"
#include "runtime/deck/deck.h"
#include "runtime/interaction/bond_forces.h"
#include "runtime/interaction/damage.h"

typedef struct watched_part watched_part;

typedef struct watch_instant { /* the state looked at, which was observed */
  velocities_of *velocity;
  const void *velocities;
  bond_forces *forces; /* found; NULL unless asked for */
  bool late;           /* fields are those that the last step has left, not those observed */
  double *scratch;     /* [size] */
} watch_instant;

/* Which of the sites is the nearest to `at`, the first of several; -1 with a diagnostic where it is
   further than a spacing. */
long watched_nearest(const deck_monitor *m, const rows *g, const int32_t *sites, long count,
                     diagnostics *d);
/* Whether the bonds' forces are asked for. */
bool watched_needs_forces(const deck_monitor *m);
/* Sites of the region, or of all particles; `laws`: all at work on these. NULL with a diagnostic
   where nothing is there to watch, and for what monitors watch by themselves. */
watched_part *watched_new(const deck_monitor *m, const int32_t *sites, long count, sweep *state,
                          const damage_law *laws, int law_count, diagnostics *d);
void watched_free(watched_part *w);
double watched_value(const watched_part *w, const watch_instant *at);
/* Of an acceleration: the mean velocity half a step before, m/s. */
double watched_velocity(const watched_part *w);
/* The line across which cracks are measured; NULL of other kinds. */
crack_line *watched_line(const watched_part *w);
/* "stress xx of `middle`" */
char *watched_words(const watched_part *w, arena *a);

#endif
