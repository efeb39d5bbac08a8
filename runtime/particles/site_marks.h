/* Which sites of an infinite lattice the bodies and notches of a deck take. */
#ifndef PERILAT_RUNTIME_SITE_MARKS_H
#define PERILAT_RUNTIME_SITE_MARKS_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/bravais.h"
#include "runtime/deck/deck.h"

#define SITE_OUTLINE_TOLERANCE 1e-6 /* spacings: a site this near to an outline lies on it */
#define SITE_TIE_TOLERANCE     1e-9 /* spacings: of sites equally near a point the first is taken */
#define SITE_MOST              2e8  /* with absent ones: site numbers and memory stay in bounds */

/* Columns, rows and layers of the infinite lattice, ends included; empty where first > last. */
typedef struct site_range {
  long first[3], last[3];
} site_range;

double site_range_count(const site_range *r);
/* The range without what lies out of `to`. */
void site_range_clip(site_range *r, const site_range *to);
/* Numbers of the sites that may lie in the shape's box. False when it is too far away to be
   numbered. */
bool site_range_of(const bravais *b, const deck_shape *shape, site_range *out);

typedef struct site_marks {
  site_range span; /* what bodies reach */
  site_range left; /* the sites that stand, no row, column or layer more */
  unsigned char *bits;
  long *removed; /* [notches of the deck] sites that each notch takes from the bodies */
} site_marks;

/* False with diagnostics: no body, a body without sites, too many sites, nothing left by the
   notches. To be freed in either case. */
bool site_marks_make(site_marks *m, const bravais *b, const deck *k, const deck_lattice *l,
                     diagnostics *d);
void site_marks_free(site_marks *m);
/* The site of the span is in a body and in no notch. */
bool site_marks_stands(const site_marks *m, long column, long row, long layer);

/* True for a group without a lattice's name, or with this one's. */
bool site_of_lattice(const deck_lattice *l, const char *name);
/* The straight line between two places crosses a notch of the lattice deeper than `tolerance` (m),
   whether that has taken particles or bonds. */
bool site_notch_between(const deck *k, const deck_lattice *l, const double from[3],
                        const double to[3], double tolerance);
/* How far from a point shape its site may stand, the tolerance included. */
double site_point_reach(const deck_shape *shape, double spacing);
/* The deck's line on sites that cannot be stored. */
bool site_too_many(const deck_lattice *l, double sites, diagnostics *d);

#endif
