/* Does a law obey mechanics? The room: a law is driven on the interpreter through many states,
   seeded, and each breach is reported with the state that shows it. To add a check: a code, its
   page, a function, a row of the table in physics.c. */
#ifndef PERILAT_GENERATOR_PHYSICS_H
#define PERILAT_GENERATOR_PHYSICS_H

#include "dsl/semantics/law.h"
#include "runtime/kernel.h"

/* Of the work done: laws that are conservative only while whole, as they say with
   `nonconservative`, may gain it on a way around, again and again; more is an error. */
static const double GAIN_OF_NONCONSERVATIVE = 0.1;

typedef struct physics_options {
  const double *parameters; /* SI, in the law's order: only these; NULL: around the defaults */
  /* That of a deck: only its bonds. NULL: the hexagon of nearest neighbours, in space fcc with its
     second ones, of 10 mm (and 100 mm of thickness); laws of bonds on lattices of a quarter to four
     times as much, too, with unequal masses. */
  const struct deck_lattice *lattice;
  double effort; /* share of the usual number of states; 0: 1 */
  uint64_t seed; /* 0: the usual one */
  bool strict;   /* what the law accepts counts all the same */
} physics_options;

typedef struct physics_report {
  int guards, guards_reached; /* conditions of case lines and flows that vary with the state; seen
                                 both true and false */
  double states;              /* evaluated */
  double seconds;
} physics_report;

/* Everything found goes to `d`, one diagnostic a check. Returns false when there were errors among
   them. `report` may be NULL. */
bool physics_check(const law *l, const physics_options *o, diagnostics *d, physics_report *report);

#endif
