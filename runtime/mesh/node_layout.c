#include "runtime/mesh/node_layout.h"

#include <math.h>

#include "runtime/kernel.h"

static long whole_lanes(long count) {
  return (count + PL_LANES - 1) / PL_LANES * PL_LANES;
}

node_layout node_layout_of(const int nodes[2], double support) {
  node_layout l = {.nodes = {nodes[0], nodes[1]}, .reach = (int)ceil(2 * support) - 1};
  const long margin = whole_lanes(l.reach);
  l.padded = whole_lanes(nodes[0]);
  l.stride = l.padded + margin;
  l.origin = l.reach * l.stride + margin;
  l.size = l.stride * (nodes[1] + 2 * l.reach) + 2 * margin;
  return l;
}
