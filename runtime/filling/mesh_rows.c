#include "runtime/filling/mesh_rows.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "runtime/geometry/quadrilateral.h"
#include "runtime/lattice/rows_select.h"
#include "runtime/mesh/node_layout.h"

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
  return m->corners ? quadrilateral_area((const double(*)[2])m->corners) : m->size[0] * m->size[1];
}

static void place_nodes(rows *w, const deck_mesh *m, const node_layout *l) {
  for (long q = 0; q < w->size; q++) {
    w->site_particle[q] = -1;
    w->x[q] = m->corner[0];
    w->y[q] = m->corner[1];
  }
  for (int n = 0; n < w->particle_count; n++) {
    const long site = node_layout_at(l, n);
    w->present[site] = 1;
    w->site_particle[site] = n;
    w->particle_site[n] = (int32_t)site;
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
  const double area = area_of(m) / ((nodes[0] - 1.0) * (nodes[1] - 1.0));
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
              .particle_count = (long)nodes[0] * nodes[1]};
  w->row_class = must_calloc((size_t)(nodes[1] + 2 * l.reach), 1);
  w->particle_site = must_alloc(((size_t)w->particle_count + 1) * sizeof *w->particle_site);
  if (!rows_new_sites(w)) {
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&m->item, "nodes"),
                "there is not enough memory for %d x %d nodes", nodes[0], nodes[1]);
    rows_free(w);
    return NULL;
  }
  place_nodes(w, m, &l);
  rows_find_extent(w);
  return w;
}
