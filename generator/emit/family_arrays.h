/* Where the values of a segment stand: arrays of pl_family, from the first particle of a chunk on
   and toward a neighbour. */
#ifndef PERILAT_GENERATOR_FAMILY_ARRAYS_H
#define PERILAT_GENERATOR_FAMILY_ARRAYS_H

#include "generator/target/expression.h"

/* How a loop says where it is: what stands for the first particle of a chunk, for the number of the
   neighbour here and there, for the way to it and to its links, and for number and place of the
   bond at its owner. */
typedef struct family_index {
  /* `to` NULL: the loop adds the way */
  const char *first, *k, *back, *to, *link_to, *owned, *owner;
  bool far; /* the bond is the neighbour's, which is known only where families are unrolled */
} family_index;

/* The law is for particles that stand on no lattice: each has its list of neighbours. */
bool family_is_list(const emitter *e);
/* An input that says whether a particle is protected. */
bool family_is_protection(const emitter *e, ir_node n);
/* A value of the neighbour. */
bool family_is_of_neighbour(const emitter *e, ir_node n);
/* Where the array of an input begins: of the chunk's particles, or of their neighbours; on lists
   the loop adds the way to the neighbour. */
const char *family_input_array(const emitter *e, ir_node n, const family_index *at);
/* Length or chord of the way that particles alike have. */
const char *family_way_value(const emitter *e, ir_node n);
/* Where the array of a root begins. Slots and planes are the pass's own. */
const char *family_root_array(const emitter *e, const segment_root *r, const family_index *at);

#endif
