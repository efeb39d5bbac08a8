/* Does a law obey mechanics? Drives a law on the interpreter through many states, seeded,
   and reports each breach with the state that shows it. */
#ifndef PERILAT_GENERATOR_PHYSICS_H
#define PERILAT_GENERATOR_PHYSICS_H

#include "dsl/law.h"
#include "runtime/kernel.h"

typedef struct physics_options {
  const double *parameters;   /* SI, in the law's order: only these; NULL: around the defaults */
  const pl_bond_class *bonds; /* NULL: hexagonal lattices of a few millimetres to centimetres */
  const struct deck_lattice *lattice; /* laws of families; NULL: hexagonal, in space fcc with second
                                         neighbours, spacing 10 mm */
  double effort;                      /* share of the usual number of states; 0: 1 */
  uint64_t seed;                      /* 0: the usual one */
} physics_options;

typedef struct physics_report {
  int guards, guards_reached; /* conditions of case lines and flows that vary with the state; seen
                                 both true and false */
  double states;              /* evaluated */
  double seconds;
} physics_report;

/* Everything found goes to `d`, one
   diagnostic a check. Returns false when there were errors among them. `report` may be NULL. */
bool physics_check(const law *l, const physics_options *o, diagnostics *d, physics_report *report);

#endif
