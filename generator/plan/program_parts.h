/* Inside of the making of programs: program.c passes and segments; program_mirror.c what the
   neighbour has; program_share.c finds what both ends of a bond
   would compute alike. */
#ifndef PERILAT_GENERATOR_PROGRAM_PARTS_H
#define PERILAT_GENERATOR_PROGRAM_PARTS_H

#include <stdlib.h>

#include "generator/plan/program.h"

/* Values by node, for a graph that grows while they are found. */
typedef struct node_map {
  int *value; /* -1: none yet */
  int room;
} node_map;

static inline int map_get(const node_map *m, ir_node n) {
  return n < m->room ? m->value[n] : -1;
}

static inline void map_set(node_map *m, ir_node n, int value) {
  if (n >= m->room) {
    int room = 2 * n + 64;
    m->value = must_realloc(m->value, (size_t)room * sizeof *m->value);
    for (int k = m->room; k < room; k++)
      m->value[k] = -1;
    m->room = room;
  }
  m->value[n] = value;
}

static inline void map_clear(node_map *m) {
  free(m->value);
  *m = (node_map){0};
}

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
} builder;

static inline bool is_leaf(const ir *g, ir_node n) {
  return ir_arity(ir_operation(g, n)) == 0;
}

static inline bool is_uniform(const ir *g, ir_node n) {
  return ir_place(g, n) <= ON_BODY;
}

static inline bool is_of_particle(const ir *g, ir_node n) {
  return ir_place(g, n) == ON_PARTICLE && !ir_is_of_class(g, n);
}

/* What the other end of a bond computes for a value: 1: the same; -1: the opposite; 0: something
   else, as far as can be seen. */
int program_parity(builder *b, ir_node n);
/* The same, and 0 where the other end would need links that nothing else asks for. */
int program_parity_of_root(builder *b, ir_node n);
/* Chooses b->shared: of what is dear and the same or opposite from either end of a bond, operands first, what is still dear
   given those before. */
void program_choose_shared(builder *b, const segment_root *roots, int root_count);
/* What all components of the force have as a factor, the same from either end, that no earlier pass can know: the force of
   a bond over its length. IR_NONE: nothing that is worth it. */
ir_node program_common_factor(builder *b, const segment_root *roots, int root_count);
/* Puts `input` in its place. */
void program_put_factor(builder *b, segment_root *roots, int root_count, ir_node factor,
                        ir_node input);

/* Finds the sums that need not ask for absent bonds, and the shared values that owners leave as 0 there
   (segment_root.vanishes). */
void program_find_vanishing(const ir *g, family_program *p);

#endif
