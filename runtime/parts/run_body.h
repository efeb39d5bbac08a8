/* A body of a run: the particles of one of the deck's lattices, with the laws at work on their
   bonds, what loads them, and what is known of them. Bodies know nothing of each other: a run with
   several is as many runs in step. A body has one law as a rule; where the deck has others for
   parts of it, or for the bonds between parts, they act on the same particles (joint.h). */
#ifndef PERILAT_RUNTIME_RUN_BODY_H
#define PERILAT_RUNTIME_RUN_BODY_H

#include "dsl/base/diagnostics.h"
#include "runtime/analysis/step_limit.h"
#include "runtime/continuum/cells.h"
#include "runtime/continuum/mesh_ties.h"
#include "runtime/interaction/damage.h"
#include "runtime/interaction/sweep.h"
#include "runtime/lattice/law_parts.h"
#include "runtime/lattice/parameter_planes.h"
#include "runtime/loads/loads.h"
#include "runtime/loads/mesh_rest.h"
#include "runtime/parts/ledger.h"

typedef struct run_law { /* a law at work on a body: an interaction of the run */
  const deck_interaction *from;
  const pl_law *law;
  bool fits;                       /* the law suits the lattice */
  double *parameters;              /* the caller's; those of random fields become their mean */
  const regional_values *regional; /* [regional_count] the caller's */
  int regional_count;
  parameter_planes *planes; /* what differs in space; NULL without */
  double
      *stiffest; /* of a mesh whose law is given fields: where it is stiffest at rest, else NULL */
  const rows *rows;         /* the body's, with the bonds that the law has a part in */
  const unsigned char *own; /* [size] 1 where a particle is of this law; NULL of the only one */
  const double *share;      /* as sweep.share */
  sweep *state;             /* the law's own fields */
  rows_bond *bonds;         /* of `rows` */
} run_law;

/* Of a body that goes on from another run: what of its particles and of the bonds of all its laws
   does, what begins as it is made, what of the other run is not here any more. */
typedef struct run_going {
  long particles, new_particles, gone_particles, bonds, new_bonds, gone_bonds;
} run_going;

typedef struct run_body {
  int lattice;        /* its number in the deck */
  const char *name;   /* the lattice's */
  rows *lattice_rows; /* owned */
  run_law *laws;      /* [law_count] the first is that of the lattice without region */
  int law_count;
  law_part *parts;   /* [law_count] what belongs to each of several laws; NULL of one */
  bool fits;         /* all laws suit the lattice */
  const pl_law *law; /* the first, for what all have alike: kind, dimensions, dof */
  sweep *state;      /* what moves the body: that of its law, or all of them together */
  body *body;        /* of the state */
  loads *loads;
  cells *cells;          /* of a mesh; else NULL */
  mesh_rest *rest;       /* of a mesh in a static run; else NULL */
  const tip_law *cracks; /* [cracks of the deck] their laws */
  mesh_tie *ties;        /* [tie_count] of a lattice to meshes */
  int tie_count;
  bool tied;        /* a tie is between this one and another body */
  step_limit limit; /* of this body alone at rest; `step` is the present one of the run */
  /* Where the step may shrink: the square of the largest frequency over that at rest, at least 1;
     of a mesh its limit with as many pieces of cracks (s, 0: not known) */
  double stiffened, cracked_limit;
  int64_t cracked_pieces;
  ledger ledger;
  ledger_laws energies;
  load_look look;         /* of the state observed last */
  run_going going;        /* all 0 of one that begins at rest */
  int32_t first_particle; /* its number in results; of no use of a link */
  int first_block;        /* of the team: the block that its first one belongs to */
} run_body;

/* Its particles are copies of those of others, which a link joins (run_link.h): nothing moves
   them by itself. */
static inline bool run_body_is_link(const run_body *b) {
  return b->lattice_rows->copies != NULL;
}
/* [size] 1 where a particle is tied to a mesh; malloc'ed. */
unsigned char *run_body_tied_sites(const run_body *b);
/* Bonds that end at a tied particle and have a damage of 0.5 or more. */
long run_body_damaged_ties(const run_body *b);
/* In results, where a particle stands once. */
static inline long run_body_particles(const run_body *b) {
  return run_body_is_link(b) ? 0 : b->lattice_rows->particle_count;
}

/* `built` [lattice_count] has the deck's lattices so far; the body's own is built where it is NULL,
   and its own from then on. `lattice`, `laws` and what the caller has of these are set. What of the
   deck does not fit this lattice and these laws is reported; false after errors. Laws and
   parameters may be missing where they are wrong themselves: then the deck is checked as far as it
   does not depend on them. */
bool run_body_open(run_body *b, const deck *k, rows **built, diagnostics *d);
/* What the laws are given in place and time, at that time (s). */
void run_body_go_to(run_body *b, double time);
/* A step ends: what they are given now was given a step ago. */
void run_body_turn(run_body *b);
/* The state at rest, with the step that the run takes. False with a diagnostic where it cannot
   begin so. */
bool run_body_begin(run_body *b, const deck *k, double step, diagnostics *d);
/* [law_count] to be freed. */
damage_law *run_body_damages(const run_body *b);
/* s: the longest stable step as cracks are now; of other bodies that of the start. */
double run_body_limit_now(const run_body *b);
/* s: the same in the present state. Of a mesh that was observed: what its points are like counts,
   too; *cracked: it is its cracks that have shortened it. A lattice is looked at, and is to be
   observed again. */
double run_body_limit_here(run_body *b, bool *cracked);
/* rad/s: above which it has none in the state observed, as far as this is known. */
double run_body_highest_frequency(const run_body *b);
void run_body_free(run_body *b);
double run_body_memory(const run_body *b); /* bytes */

#endif
