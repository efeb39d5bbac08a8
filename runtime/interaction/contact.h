/* Contact between particles of bodies that no bond joins, or joins no longer: those nearer than d
   push each other apart,

     f = k (d - r),   W = k (d - r)^2/2,            o <-- f -- o        r: between their places
                                                       r < d
   d is the mean of the spacings of both bodies; less where they began nearer than that, so that
   nothing pushes at rest, and where their bond was lost while they were nearer, so that no force
   jumps. Where bonds that have failed press on, those that they joined never touch.

   Pairs near enough to matter soon are listed; the list is found anew when some particle has gone
   half of what it reaches further than d. Forces are added in the order of the particles, and do
   not depend on what else is listed. Only new lists may ask for memory, which is kept. */
#ifndef PERILAT_RUNTIME_CONTACT_H
#define PERILAT_RUNTIME_CONTACT_H

#include "runtime/interaction/damage.h"

typedef struct contact_law { /* at work on a body */
  const sweep *of;
  const rows *rows; /* with the bonds that the law has a part in */
  const rows_bond *bonds;
} contact_law;

typedef struct contact_body {
  body *of;
  contact_law *laws; /* [law_count] the contact's from then on */
  int law_count;
  double stiffness; /* k of two of its particles, N/m; of two particles the smaller one counts */
  bool by_size;     /* that is k of the smallest, and it grows with a particle's own spacing */
} contact_body;

typedef struct contact contact;

/* Of each body with all others, and with itself where it is the only one or `selves` says so. The
   bodies have outer forces (body_add_outer). Places are those at rest. */
contact *contact_new(const contact_body *bodies, int count, bool selves);
void contact_free(contact *c);
/* From now on contact_near also knows of pairs that are that much further apart than d, as a part
   of the smallest spacing: less than CONTACT_MOST_AHEAD. */
#define CONTACT_MOST_AHEAD 0.2
void contact_look_ahead(contact *c, double part);

/* Bonds lost since the last time are taken note of, then the forces at the present places are added
   to the bodies' outer ones. */
void contact_find(contact *c);
/* Of the forces found last: J stored; pairs that touch, and the largest force between two, N. */
double contact_stored(const contact *c);
long contact_touching(const contact *c, double *largest);
/* Some pair touches, or is near to (contact_look_ahead). */
bool contact_near(const contact *c);
/* W: what these do with the present velocities; of each body is added to power[count]. Returns the
   sum. */
double contact_power(const contact *c, double *power);

/* Where no contact has kept them apart: pairs of particles nearer than `part` of d at the present
   places. Finds no forces; where bonds were lost is not known: they count as lost at rest. */
typedef struct contact_overlap {
  long pairs;
  double nearest; /* r/d of the nearest pair, */
  int body[2];    /* and which it is */
  int32_t site[2];
} contact_overlap;
contact_overlap contact_overlaps(contact *c, double part);
/* The same of particles of different bodies, nearer than `part` of the mean of their spacings:
   bodies that lie over each other, as they may from the beginning. */
contact_overlap contact_drawn_over(contact *c, double part);

/* For saving a run: distances (m) at which the bonds of a body were lost, *count of them; NULL
   where none is. */
double *contact_lost(contact *c, int body, size_t *count);
double contact_memory(const contact *c); /* bytes */

#endif
