/* A program while it is made: what its passes leave to each other, and what is known of each value
   so far. */
#ifndef PERILAT_GENERATOR_PROGRAM_BUILDER_H
#define PERILAT_GENERATOR_PROGRAM_BUILDER_H

#include "generator/plan/node_map.h"
#include "generator/plan/segment.h"

enum { MOST_LINKS = 4096, MOST_SHARED = 64 };

typedef struct builder {
  ir *g;
  arena *memory;
  ir_node *link;    /* [link_count] what each link holds, in the terms of the particle itself */
  int *link_number; /* [link_count] among those of particles, or those of bonds */
  int link_count;
  program_links links; /* how many of either */
  program_sharing sharing;
  ir_node *shared; /* [shared_count] values that the ends share, numbered from first_shared */
  int shared_count, first_shared, round;
  node_map resolved, mirrored, linked, reduced, sided, level, parity, plain, counted, users;
  node_map partner, partner_sign; /* a node that the other end has for it, and +1 with which sign */
  node_map far, far_sign;         /* the same, made where there was none */
} builder;

static inline bool is_leaf(const ir *g, ir_node n) {
  return ir_arity(ir_operation(g, n)) == 0;
}

/* Not of the body as a whole. */
static inline bool is_of_one_particle(const ir *g, ir_node n) {
  return ir_is_of_particle(g, n) && !ir_is_uniform(g, n);
}

#endif
