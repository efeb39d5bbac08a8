/* What is watched: reactions, displacements, openings, counts of damaged bonds, the law's values on particles; their running
   means, zeros and peaks, and the &stop conditions on them. A value belongs to the state after a
   step; a reaction is that of the step just done.

   A value is (mean over the window - value at zero_at, from then on) times scale. The window holds
   the steps of the last `average` seconds, the present one included, or all there were so far.
   Counts are taken as they are. */
#ifndef PERILAT_RUNTIME_MONITOR_H
#define PERILAT_RUNTIME_MONITOR_H

#include "dsl/diagnostics.h"
#include "runtime/deck.h"
#include "runtime/loads.h"
#include "runtime/sweep.h"

typedef struct monitor_state { /* what a later step depends on */
  double zero;                 /* value subtracted */
  double peak, peak_time;      /* largest absolute value sampled, its sign kept, and when */
  int64_t filled;              /* values pushed since the start */
} monitor_state;

typedef struct monitor {
  const deck_monitor *deck;
  const char *unit;
  monitor_state state;
  int32_t *indices[2]; /* sites, or constraints of a reaction (second list: of the second region) */
  long index_count[2];
  int field;      /* of a field monitor: the law's field, or field_count + output */
  double *ring;   /* [window] the last values, value of push k at k % window */
  long window;    /* steps; 1: no averaging */
  long zero_step; /* -1: never */
} monitor;

typedef struct monitors {
  double interval; /* s between two monitors_step */
  monitor *items;
  int count;
  const deck *deck;
  sweep *state;
  const loads *loads;
  const rows_bond *bonds; /* [lattice->bond_count], not owned */
  double *values;         /* [size] an output while it is looked at */
  bool outputs_found;     /* those of the present state */
  double *ring_memory;    /* all rings in one */
  long ring_size;
} monitors;

/* False with diagnostics where the deck watches what particles of the law do not have. */
bool monitors_check(const deck *k, const pl_law *law, diagnostics *d);
/* Of a deck that was checked. NULL with a diagnostic when a mean does not fit into memory. */
monitors *monitors_new(const deck *k, sweep *state, const loads *l, const rows_bond *bonds,
                       double interval, diagnostics *d);
void monitors_free(monitors *m);

/* After every step, of quasi-static runs after every increment (and once at the start): rings and
   zeros. */
void monitors_step(monitors *m, long step);
/* Values of all monitors now; remembers peaks. `observed`: the present state was (sweep_observe). */
void monitors_sample(monitors *m, double time, bool observed, double *values);
/* The first &stop of the deck that applies to values just sampled, or NULL. */
const deck_stop *monitors_stop(const monitors *m, double time, const double *values);

#endif
