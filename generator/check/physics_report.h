/* What the checks of one law of bonds know of it, and how they say what they find: each breach
   once, with the state that shows it. */
#ifndef PERILAT_GENERATOR_PHYSICS_REPORT_H
#define PERILAT_GENERATOR_PHYSICS_REPORT_H

#include "generator/check/physics_bench.h"

enum { POOL_MOST = 512, SCALES_MOST = 96 };

typedef struct physics {
  bench b;
  diagnostics *said;
  bool failed[DIAG_COUNT]; /* each check speaks once */
  double *pool;            /* [POOL_MOST][width] states that a bond can reach from rest */
  int pool_count;
  motion scales[SCALES_MOST]; /* motions at which guards change */
  int scale_count;
} physics;

extern const char *const physics_force_names[FORCE_COUNT], *const physics_force_units[FORCE_COUNT];

/* "stretch = 1.2e-4, omega = 0.5; with E = 3.1e+10 Pa": what the law reads of the state. */
char *physics_state_text(const physics *p, const double *column);
/* One error or warning of a kind, with the state that shows it (NULL: none) as its note. Later ones
   of the same kind are dropped. */
void physics_say(physics *p, diag_code code, span where, const double *column, const char *format,
                 ...) __attribute__((format(printf, 5, 6)));
/* Whether forces or states need `stretch_rate`. */
bool physics_reads_rate(const physics *p);
/* The statement that gives N, M_i or M_j; of a list of cases the line in force at the state. */
span physics_fault(physics *p, int force, const double *column);

#endif
