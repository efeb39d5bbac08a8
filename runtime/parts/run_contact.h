/* Contacts of a run at work (contact.h): which bodies touch, how stiff they are there, and what of
   it the ledger has.

   Forces are found when a step has taken all bodies to t_(n+1); they act in the coming step, and
   are part of what is observed. Their work on each body is work from outside; that on the contact
   itself has the opposite sign, so that in sum it goes out and what is stored is left.

   The stiffness of two particles is k = E V/s^2: of a particle as a piece of a bar, as long as the
   spacing s, of its volume V and of the lattice's Young's modulus E. On the hexagon with central
   bonds it is that of a bond; a layer of contacts is about as stiff as a layer of the body. Of two
   lattices the softer one counts. Graded particles have a k of their own: the same in the plane, in
   space in proportion to the spacing; of two the smaller one counts.

   The largest frequencies: with k |(u_i - u_j) n|^2 <= 2 k (|u_i n|^2 + |u_j n|^2) for each pair,
   and at most six contacts evenly around a particle in the plane, twelve in space (sum of n n^T =
   3, 4), contact adds at most 2 * 3 k/m or 2 * 4 k/m to the square of the body's own. */
#ifndef PERILAT_RUNTIME_RUN_CONTACT_H
#define PERILAT_RUNTIME_RUN_CONTACT_H

#include "runtime/interaction/contact.h"
#include "runtime/parts/link_limit.h"
#include "runtime/parts/run_body.h"

typedef struct contact_peaks { /* of all states so far */
  int64_t pairs;               /* that touch at a time */
  double force, stored;        /* N, of a pair; J */
} contact_peaks;

typedef struct run_contact {
  const deck_contact *from;
  int *of; /* [count] numbers of the bodies */
  int count;
  double *stiffness; /* [count] N/m */
  contact *found;
  double work; /* J: done on it, by the ways that its particles have gone */
  ledger ledger;
  contact_peaks peaks;
} run_contact;

typedef struct run_contacts {
  run_contact *items; /* [count] */
  int count;
  run_body *bodies;
  int64_t step; /* whose forces are known; -1: of none */
  bool near;    /* some particles touch then, or are near to */
  double *power;
} run_contacts;

/* Which bodies, and how stiff; their masses are known. touching[body_count]: what contact adds to
   the square of the largest frequency of each. False with diagnostics where a stiffness
   cannot be told. */
bool run_contacts_open(run_contacts *c, const deck *k, run_body *bodies, int body_count,
                       touch_rates *touching, diagnostics *d);
/* When the bodies have begun. `near` comes as early as that part of the smallest spacing before
   particles touch. */
void run_contacts_begin(run_contacts *c, double ahead);
void run_contacts_free(run_contacts *c);

/* N/m: k = E V/s^2 by the softest law of a lattice, of the smallest particles; NaN where one has
   no Young's modulus. */
double run_contact_stiffness(const run_body *b, const deck *k);
/* k grows with a particle's own spacing, and is that of the smallest: of graded particles in space,
   where the deck gives no stiffness (`given` is 0). */
bool run_contact_by_size(const rows *g, double given);
/* kg: of its lightest particle; `by_size`: over the particle's spacing as a part of the smallest,
   so that no k/m is larger than that of the smallest k with it. */
double run_contact_lightest(const rows *g, bool by_size);

/* Forces at the present places, after `step` steps. */
void run_contacts_find(run_contacts *c, int64_t step);
/* Of a deck without contact: particles that lie over each other, nearer than half of what contact
   would keep them at. Of lattices, by their numbers in `body`; none of a single one whose bonds all
   hold. The state observed last is to be observed again. */
contact_overlap run_contacts_overlap(const deck *k, const run_body *bodies);
/* Warns at the deck's lines of bodies that it draws over each other. */
void run_contacts_warn(const deck *k, const run_body *bodies, diagnostics *d);
double run_contacts_memory(const run_contacts *c); /* bytes */

#endif
