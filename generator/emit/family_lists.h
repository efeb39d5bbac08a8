/* Neighbours of particles with lists. Where those of some particles stand alike (pl_family.alike),
   as inside of a lattice, a loop reads them with unit stride, and what follows from the bond's
   reference geometry is the same for all of them; elsewhere it goes by the list. Both loops are
   written from the same nodes, and give the same bits.

       for each neighbour k {
         for each span of particles, from .. until, that are alike {
           if (they have no such neighbour) continue;
           if (they have one way) { n_x = way->chord[0]/way->length; for (q = ...) ... u_j[q + to] }
           else for (q = ...) ... u_j[q + to[q]]
         }
       } */
#ifndef PERILAT_GENERATOR_FAMILY_LISTS_H
#define PERILAT_GENERATOR_FAMILY_LISTS_H

#include "generator/target/expression.h"

/* What the passes call. */
void family_lists_functions(emitter *e);

/* Around the segments of a pass. */
void family_lists_begin(emitter *e, const program_pass *p);
void family_lists_end(emitter *e);
void family_lists_neighbours(emitter *e, const segment *a);

#endif
