/* Segments of families as loops: for each chunk of particles the segments one after the other, for
   each neighbour a loop over the particles of the chunk, which is innermost and vectorises; a
   neighbour is an offset.

       d = sum(V_j*stretch)       for each neighbour k {
                                    at_u_jx = family->displacement[0] + first + to; ...
                                    for (q = 0; q < lanes; q++)
                                      to_0[q] = present ? pl_fma(V_j, stretch, to_0[q]) : to_0[q];
                                  } */
#ifndef PERILAT_GENERATOR_FAMILY_LOOPS_H
#define PERILAT_GENERATOR_FAMILY_LOOPS_H

#include "generator/emit/family_arrays.h"

void family_loops_particles(emitter *e, const segment *a);
void family_loops_neighbours(emitter *e, const segment *a);

/* For other forms whose innermost loop is over the particles of a chunk: */
/* names an array before the loop, and takes its value in it (scope); */
void family_loops_declare(emitter *e, ir_node n);
const char *family_loops_input(emitter *e, ir_node n);
/* slots as reductions begin. */
void family_loops_start(emitter *e, const segment *a);

#endif
