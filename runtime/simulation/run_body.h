/* A body of a run: the particles of one of the deck's lattices, with the law at work on their
   bonds, what loads them, and what is known of them. Bodies know nothing of each other: a run with
   several is as many runs in step. */
#ifndef PERILAT_RUNTIME_RUN_BODY_H
#define PERILAT_RUNTIME_RUN_BODY_H

#include "dsl/base/diagnostics.h"
#include "runtime/analysis/step_limit.h"
#include "runtime/interaction/sweep.h"
#include "runtime/lattice/parameter_planes.h"
#include "runtime/simulation/ledger.h"
#include "runtime/simulation/loads.h"

typedef struct run_body {
  int lattice;        /* its number in the deck */
  const char *name;   /* the lattice's, and so that of its bonds in results */
  rows *lattice_rows; /* owned */
  const pl_law *law;
  bool fits;                       /* the law suits the lattice */
  double *parameters;              /* the caller's; those of random fields become their mean */
  const regional_values *regional; /* [regional_count] the caller's */
  int regional_count;
  parameter_planes *planes; /* what differs in space; NULL without */
  sweep *state;
  body *body; /* of the state */
  loads *loads;
  rows_bond *bonds;
  step_limit limit; /* of this body alone; `step` is that of the run */
  ledger ledger;
  load_look look;         /* of the state observed last */
  int32_t first_particle; /* its number in results */
  int first_block;        /* of the team: the block that its first one belongs to */
} run_body;

/* On `lattice`, which is built when NULL. What of the deck does not fit this lattice and law is
   reported; false after errors. Law and parameters may be missing where they are wrong
   themselves: then the deck is checked as far as it does not depend on them. */
bool run_body_open(run_body *b, const deck *k, rows *lattice, diagnostics *d);
/* The state at rest, with the step that the run takes. False with a diagnostic where it cannot
   begin so. */
bool run_body_begin(run_body *b, const deck *k, double step, diagnostics *d);
void run_body_free(run_body *b);
double run_body_memory(const run_body *b); /* bytes */

#endif
