/* A law of families as programs. A program is a row of passes over all particles: what a pass needs
   of a neighbour's present step, an earlier pass has left as a link, a value of the particle. A
   pass is a row of segments over a chunk of particles: particle by particle, neighbour by neighbour
   with sums into slots, or bond by bond, which is over the neighbours whose bonds the particle
   owns; such a loop may also add to sums of both ends (SHARE_PAIRS). What is dear and the same from
   either end of a bond is computed once, by the owner in the first pass, and shared by both ends
   from then on. The emitter writes segments as loops, the interpreter runs them.

   An example, where no lattice is known (`perilat check law.plm --dump=passes` prints it):

       theta            = mean(stretch[j])
       force state F[j] = E*spacing*t*(stretch[j] + theta)

   The force of a bond is the mean of what both ends say, so that a particle needs theta of its
   neighbour. Only the neighbour can add up its own family: theta is a link.

       pass 0  neighbour by neighbour  slot 0 += 1
               particle by particle    link 1 = 1/slot 0 (1 for no bonds), link 2 = its divisor
               bond by bond            shared 0 = 1/length           dear, the same for both ends
       pass 1  neighbour by neighbour  slot 0 += stretch             made of shared 0
               particle by particle    link 0 = theta                of slot 0 and links 1, 2
       pass 2  neighbour by neighbour  slots 0, 1 += F e_x, F e_y    of theta, theta_j and shared 0
               particle by particle    force x = slot 0, force y = slot 1

   Passes follow from levels: a value that needs a neighbour's link comes one pass after it. */
#ifndef PERILAT_GENERATOR_PROGRAM_H
#define PERILAT_GENERATOR_PROGRAM_H

#include "dsl/base/arena.h"
#include "generator/plan/segment.h"

/* Quantities of a bond's motion and what takes their place. */
typedef struct program_motion {
  const ir_node *from, *to;
  int count;
} program_motion;

/* Makes a program of the roots of `wanted`, over particles and over neighbours, which speak of one
   particle and of the bond to one neighbour in the terms of lower.h.
   IR_NEIGHBOUR(x) becomes what the neighbour computes for x, to the bit: values of particles that
   go over a family are links, and so are values toward a neighbour that are dear; all others are
   evaluated again with both sides exchanged. Motion is substituted after that, since stretch and
   length are the same from either side. `memory` holds the program; *links is raised to what it
   needs. What is the same from either end of a bond, or differs by its sign, is evaluated once
   where that pays, as `sharing` says. */
void program_build(kernel_program *out, const char *name, ir *g, arena *memory,
                   const segment *wanted, const program_motion *motion, program_sharing sharing,
                   program_links *links);

#endif
