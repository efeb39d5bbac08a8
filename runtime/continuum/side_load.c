#include "runtime/continuum/side_load.h"

#include "dsl/base/elementary.h"
#include "runtime/mesh/gauss_rule.h"

enum { POINTS = 4 };

/* Functions of a line's nodes at -1 <= u <= 1, and their slopes; the third stands between. */
static void line_functions(int nodes, double u, double n[3], double slope[3]) {
  n[0] = nodes == 2 ? 0.5 * (1 - u) : 0.5 * u * (u - 1);
  n[1] = nodes == 2 ? 0.5 * (1 + u) : 0.5 * u * (u + 1);
  n[2] = 1 - u * u;
  slope[0] = nodes == 2 ? -0.5 : u - 0.5;
  slope[1] = nodes == 2 ? 0.5 : u + 0.5;
  slope[2] = -2 * u;
}

static double visit_side(const mesh *m, const gmsh_side *side, side_visitor *visit, void *context) {
  double u[MESH_MOST_GAUSS], weight[MESH_MOST_GAUSS], length = 0;
  gauss_rule(POINTS, u, weight);
  for (int k = 0; k < POINTS; k++) {
    point_shape s = {.count = side->nodes};
    double slope[3], n[3], at[2] = {0}, along[2] = {0};
    line_functions(side->nodes, u[k], n, slope);
    for (int q = 0; q < side->nodes; q++) {
      double node[2];
      mesh_place(m, side->node[q], node);
      s.node[q] = side->node[q];
      s.n[q] = n[q];
      for (int a = 0; a < 2; a++) {
        at[a] += n[q] * node[a];
        along[a] += slope[q] * node[a];
      }
    }
    const double size = pl_hypot(along[0], along[1]), part = weight[k] * size,
                 out = side->turned ? -1 : 1;
    const double normal[2] = {out * along[1] / size, -out * along[0] / size};
    visit(context, at, normal, m->thickness * part, &s);
    length += part;
  }
  return length;
}

double sides_visit(const mesh *m, const gmsh_mesh *file, const gmsh_group *group,
                   side_visitor *visit, void *context) {
  double length = 0;
  for (int k = 0; k < group->item_count; k++)
    length += visit_side(m, &file->sides[group->items[k]], visit, context);
  return length;
}
