/* Values by node, for a graph that grows while they are found. */
#ifndef PERILAT_GENERATOR_NODE_MAP_H
#define PERILAT_GENERATOR_NODE_MAP_H

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/ir/ir.h"

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

#endif
