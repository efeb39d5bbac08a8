#include "runtime/filling/mesh_rows.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/geometry/gmsh_mesh.h"
#include "runtime/geometry/quadrilateral.h"
#include "runtime/lattice/rows_select.h"
#include "runtime/mesh/cut_cells.h"
#include "runtime/mesh/node_layout.h"

/* --- holes ------------------------------------------------------------------------------------ */

static bool is_hole_of(const deck_notch *n, const char *of) {
  return n->mesh && strcmp(n->mesh, of) == 0;
}

int mesh_rows_cut(const deck *k, const deck_mesh *l, mesh *m) {
  if (l->method == MESH_ELEMENT_FREE) {
    m->gauss = l->gauss;
    m->gauss_parts = l->parts;
  }
  for (int n = 0; n < k->notch_count; n++)
    if (is_hole_of(&k->notchs[n], l->name)) holes_add(&m->holes, &k->notchs[n].shape);
  return mesh_cut(m);
}

static bool holds_a_cell(const deck_shape *of, const mesh *m) {
  for (int cell = 0; cell < mesh_cell_count(m); cell++) {
    int node[ELEMENT_MOST_NODES], held = 0;
    const int count = mesh_cell_nodes(m, cell, node);
    for (int k = 0; k < count; k++) {
      double at[2];
      mesh_place(m, node[k], at);
      held += shape_contains(of, at, m->holes.tolerance);
    }
    if (held == count) return true;
  }
  return false;
}

/* A hole is to take something of the mesh: a node, or one column of cells. */
static bool takes_something(const deck_notch *n, const mesh *m, diagnostics *d) {
  double lower[3], upper[3], at[2];
  bool meets = true, holds = false;
  shape_box(&n->shape, lower, upper);
  for (int a = 0; a < 2; a++)
    meets = meets && upper[a] > m->corner[a] + m->holes.tolerance &&
            lower[a] < mesh_at(m, a, m->nodes[a] - 1) - m->holes.tolerance;
  if (!meets) {
    diag_report(d, DIAG_EMPTY_REGION, n->item.where, "the hole lies outside the mesh `%s`",
                n->mesh);
    diag_hint(d, "the mesh reaches from (%.6g, %.6g) to (%.6g, %.6g) mm", 1e3 * m->corner[0],
              1e3 * m->corner[1], 1e3 * mesh_at(m, 0, m->nodes[0] - 1),
              1e3 * mesh_at(m, 1, m->nodes[1] - 1));
    return false;
  }
  for (int node = 0; node < mesh_node_count(m) && !holds; node++) {
    mesh_place(m, node, at);
    holds = shape_contains(&n->shape, at, -m->holes.tolerance);
  }
  if (holds || holds_a_cell(&n->shape, m)) return true;
  diag_report(d, DIAG_DECK_WARNING, n->item.where, "the hole holds no node of `%s`", n->mesh);
  diag_hint(d,
            "nodes are %.6g mm by %.6g mm apart: what a hole does that is smaller is felt "
            "coarsely; take more nodes",
            1e3 * m->spacing[0], 1e3 * m->spacing[1]);
  return true;
}

/* None is gone: cells that are cut have to be rectangles. */
static unsigned char *nodes_of_quadrilateral(const deck *k, const deck_mesh *l, const int nodes[2],
                                             diagnostics *d) {
  for (int n = 0; n < k->notch_count; n++) {
    if (!is_hole_of(&k->notchs[n], l->name)) continue;
    diag_report(d, DIAG_NOT_SUPPORTED, k->notchs[n].item.where,
                "`%s` is a quadrilateral: a hole needs a mesh that is a rectangle", l->name);
    diag_hint(d, "give `corner` and `size` of the mesh in place of `corners`");
    return NULL;
  }
  return must_calloc((size_t)nodes[0] * (size_t)nodes[1], 1);
}

/* The last places of a file's, which fill the last row. */
static unsigned char *nodes_of_file(const deck_mesh *l, const int nodes[2]) {
  const size_t all = (size_t)nodes[0] * (size_t)nodes[1], there = (size_t)l->gmsh->node_count;
  unsigned char *gone = must_calloc(all, 1);
  memset(gone + there, 1, all - there);
  return gone;
}

/* [nodes] 1: no node, as a hole has taken it. NULL after a message. */
static unsigned char *nodes_gone(const deck *k, const deck_mesh *l, const int nodes[2],
                                 diagnostics *d) {
  mesh m;
  bool good = true;
  if (l->gmsh) return nodes_of_file(l, nodes);
  if (l->corners) return nodes_of_quadrilateral(k, l, nodes, d);
  mesh_open(&m, nodes, l->corner, l->size, l->thickness, l->support);
  const int left = mesh_rows_cut(k, l, &m);
  const deck_notch *last = NULL;
  for (int n = 0; n < k->notch_count; n++) {
    if (!is_hole_of(&k->notchs[n], l->name)) continue;
    last = &k->notchs[n];
    good = takes_something(last, &m, d) && good;
  }
  if (good && left == 0) {
    diag_report(d, DIAG_EMPTY_REGION, last->item.where, "the holes leave nothing of the mesh `%s`",
                l->name);
    good = false;
  }
  unsigned char *gone = m.gone;
  m.gone = NULL;
  mesh_close(&m);
  if (good) return gone;
  free(gone);
  return NULL;
}

/* --- rows ------------------------------------------------------------------------------------- */

/* Where the quadrilateral's map puts the node. */
static void place_mapped(rows *w, const deck_mesh *m, const node_layout *l, int n) {
  const double u[2] = {(double)(n % l->nodes[0]) / (l->nodes[0] - 1),
                       (double)(n / l->nodes[0]) / (l->nodes[1] - 1)};
  double at[2], slope[2][2];
  quadrilateral_map((const double(*)[2])m->corners, u, at, slope);
  w->x[node_layout_at(l, n)] = at[0];
  w->y[node_layout_at(l, n)] = at[1];
}

/* m^2 */
static double area_of(const deck_mesh *m) {
  if (m->gmsh) return m->gmsh->area;
  return m->corners ? quadrilateral_area((const double(*)[2])m->corners) : m->size[0] * m->size[1];
}

static void place_nodes(rows *w, const deck_mesh *m, const node_layout *l,
                        const unsigned char *gone) {
  long count = 0;
  for (long q = 0; q < w->size; q++) {
    w->site_particle[q] = -1;
    w->x[q] = m->corner[0];
    w->y[q] = m->corner[1];
  }
  for (int n = 0; n < l->nodes[0] * l->nodes[1]; n++) {
    const long site = node_layout_at(l, n);
    w->present[site] = !gone[n];
    if (!gone[n]) {
      w->site_particle[site] = (int32_t)count;
      w->particle_site[count++] = (int32_t)site;
    }
    if (m->gmsh) {
      const double *at = m->gmsh->at[gone[n] ? m->gmsh->node_count - 1 : n];
      w->x[site] = at[0];
      w->y[site] = at[1];
      continue;
    }
    if (m->corners) {
      place_mapped(w, m, l, n);
      continue;
    }
    w->x[site] = m->corner[0] + m->size[0] * (n % l->nodes[0]) / (l->nodes[0] - 1);
    w->y[site] = m->corner[1] + m->size[1] * (n / l->nodes[0]) / (l->nodes[1] - 1);
  }
}

rows *mesh_rows(const deck *k, int lattice, diagnostics *d) {
  const deck_mesh *m = &k->lattices[lattice];
  const int nodes[2] = {(int)m->nodes[0], (int)m->nodes[1]};
  const node_layout l = node_layout_of(nodes, m->support);
  unsigned char *gone = nodes_gone(k, m, nodes, d);
  if (!gone) return NULL;
  const double parts = m->gmsh ? m->gmsh->node_count : (nodes[0] - 1.0) * (nodes[1] - 1.0),
               area = area_of(m) / parts;
  rows *w = must_calloc(1, sizeof *w);
  *w = (rows){.infinite = {.dimensions = 2, .spacing = m->spacing},
              .dimensions = 2,
              .row_count = nodes[1],
              .layer_rows = nodes[1],
              .margin = l.reach,
              .pitch = l.stride,
              .first = l.origin,
              .size = l.size,
              .spacing = m->spacing,
              .volume = area * m->thickness,
              .site_area = area,
              .stiffness_thickness = m->thickness,
              .particle_count = 0};
  for (long n = 0; n < (long)nodes[0] * nodes[1]; n++)
    w->particle_count += !gone[n];
  w->row_class = must_calloc((size_t)(nodes[1] + 2 * l.reach), 1);
  w->particle_site = must_alloc(((size_t)w->particle_count + 1) * sizeof *w->particle_site);
  if (!rows_new_sites(w)) {
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&m->item, "nodes"),
                "there is not enough memory for %d x %d nodes", nodes[0], nodes[1]);
    rows_free(w);
    free(gone);
    return NULL;
  }
  place_nodes(w, m, &l, gone);
  free(gone);
  rows_find_extent(w);
  return w;
}
