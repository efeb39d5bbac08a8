/* What is watched: reactions, displacements, openings, slips, forces of contact, counts of damaged
   bonds, the law's values on particles, and what watched.h has; their running means, zeros and
   peaks, and the &stop conditions on them. All values at a sample are of one instant: the state
   observed (sweep.h).

   A value is (mean over the window - value at zero_at, from then on) times scale. The window holds
   the states of the last `average` seconds, the present one included, or all there were so far; of
   velocities the steps that led there, so that their mean is way over time, and that of
   accelerations velocity over time. Counts are taken as they are. Of the way of a crack's tip in
   the window its speed is the slope of the straight line that fits it best.

   Set up by monitor_setup.h; values at an instant: monitor_values.h; in words: monitor_words.h. */
#ifndef PERILAT_RUNTIME_MONITOR_H
#define PERILAT_RUNTIME_MONITOR_H

#include "dsl/base/diagnostics.h"
#include "runtime/analysis/watched.h"
#include "runtime/deck/deck.h"
#include "runtime/loads/mesh_gauge.h"
#include "runtime/parts/run_body.h"
#include "runtime/parts/run_link.h"
#include "runtime/parts/run_stamp.h"

typedef struct monitor_state { /* what a later step depends on */
  double zero;                 /* value subtracted */
  double peak, peak_time;      /* largest absolute value sampled, its sign kept, and when */
  int64_t filled;              /* values pushed since the start */
  double parts;                /* sum over those of the present step */
} monitor_state;

/* When a value for the window is known. */
typedef enum monitor_time {
  KNOWN_AFTER_STEP,   /* places, and velocities over the step */
  KNOWN_ONE_LATE,     /* of the state that a step has left: reactions, fields, tips */
  KNOWN_WHEN_OBSERVED /* outputs, sums over motions and forces; in quasi-static runs all */
} monitor_time;

typedef struct monitor {
  const deck_monitor *deck;
  /* of its regions; NULL where it has none and counts in all bodies */
  const run_body *of[2];
  const char *unit;
  monitor_state state;
  /* sites, constraints of a reaction, or places of a link (second list: of the second region) */
  int32_t *indices[2];
  long index_count[2];
  const run_law *law;   /* of a field monitor: that whose field it is */
  int field;            /* of a field monitor: the law's field, or field_count + output */
  const run_link *link; /* of a slip monitor */
  int stamp;            /* of those of stamps: which */
  mesh_gauge *gauge[2]; /* of fields of a mesh, of both regions; NULL of other bodies and kinds */
  const tips *tips;     /* of a crack monitor: those of the mesh, */
  int tip;              /* and which */
  watched_part *own;    /* NULL of kinds that are not watched.h's */
  double *ring;         /* [window] the last values, value of push k at k % window */
  long window;          /* steps; 1: no averaging */
  monitor_time known;
  long zero_step; /* -1: never */
} monitor;

typedef struct monitors {
  double interval; /* s between two monitors_step */
  monitor *items;
  int count;
  const deck *deck;
  const run_body *bodies; /* [body_count] */
  int body_count;
  const run_link *links; /* [link_count] */
  int link_count;
  const run_stamps *stamps;
  double *values;       /* of the largest body: an output while it is looked at */
  bond_forces **forces; /* [body_count] NULL unless some monitor asks for them */
  double *ring_memory;  /* all rings in one */
  long ring_size;
} monitors;

/* It watches this body, or all. */
static inline bool monitor_watches(const monitors *all, const monitor *m, int b) {
  return !m->of[0] || m->of[0] == &all->bodies[b];
}

/* In dynamic runs once at the start and after every step: into the windows what is known;
   velocities
   are means over the `parts` that the step was done in (run_clock.h). `step` counts parts here and
   where values are asked for. monitors_part: after each part that does not end a step; after the
   `first` what is known late of the state that the step began with. */
void monitors_part(monitors *m, long step, bool first);
void monitors_step(monitors *m, long step, long parts);
/* The state at that position is to be observed for a window or a zero. */
bool monitors_due(const monitors *m, long position);
/* The state after `step` steps was observed: windows and zeros. `position` counts steps, in
   quasi-static runs increments. */
void monitors_look(monitors *m, long step, long position);
/* Values of all monitors in the state observed; remembers peaks. */
void monitors_sample(monitors *m, long step, double time, double *values);
/* Whether it applies to values just sampled. */
bool monitors_meet(const monitors *m, const deck_stop *event, double time, const double *values);
/* Which &stop of the deck is the first that applies to values just sampled; -1: none. */
int monitors_stop(const monitors *m, double time, const double *values);

#endif
