#include "runtime/continuum/mesh_build.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/filling/mesh_rows.h"
#include "runtime/geometry/gmsh_mesh.h"

static const double ON_OUTLINE = 1e-6; /* spacings: a node is on a zone's outline */

/* Cells all of whose corners are a zone's, as elements: what it says of them. */
static void take_rule(mesh *m, const unsigned char *in_zone, const deck_zone *z) {
  int corner[4];
  for (int c = 0; c < mesh_cell_count(m); c++) {
    mesh_corners(m, c, corner);
    int inside = 0;
    for (int n = 0; n < 4; n++)
      inside += in_zone[corner[n]];
    if (inside < 4) continue;
    m->element_gauss[c] = (unsigned char)z->gauss;
    m->mean_dilatation[c] = z->dilatation == DILATATION_MEAN;
    m->hourglass[c] = z->hourglass;
  }
}

static bool take_zone(const deck_zone *z, double spacing, mesh *m, diagnostics *d) {
  unsigned char *in_zone = must_calloc((size_t)mesh_node_count(m), 1);
  long count = 0;
  double at[2];
  for (int n = 0; n < mesh_node_count(m); n++) {
    mesh_place(m, n, at);
    if (!shape_contains(&z->shape, at, ON_OUTLINE * spacing)) continue;
    m->element_free[n] = z->method == MESH_ELEMENT_FREE;
    in_zone[n] = 1;
    count++;
  }
  if (z->method == MESH_FINITE_ELEMENTS) take_rule(m, in_zone, z);
  free(in_zone);
  if (count > 0) return true;
  diag_report(d, DIAG_EMPTY_REGION, z->item.where, "the zone holds no node of `%s`", z->mesh);
  diag_hint(d, "nodes are %.6g mm apart; a zone has those inside or on its shape", 1e3 * spacing);
  return false;
}

bool mesh_build(const deck *k, int lattice, mesh *out, diagnostics *d) {
  const deck_mesh *l = &k->lattices[lattice];
  const int nodes[2] = {(int)l->nodes[0], (int)l->nodes[1]};
  bool good = true;
  if (l->gmsh)
    mesh_open_lists(out, nodes,
                    cell_lists_new(l->gmsh->node_count, (const double(*)[2])l->gmsh->at,
                                   l->gmsh->cell_count, l->gmsh->nodes,
                                   (const cell_nodes *)l->gmsh->cell),
                    l->gmsh->least, l->thickness, l->support);
  else if (l->corners)
    mesh_open_mapped(out, nodes, (const double(*)[2])l->corners, l->thickness, l->support);
  else
    mesh_open(out, nodes, l->corner, l->size, l->thickness, l->support);
  out->smooth_ramp = l->smooth;
  out->enriched = l->rich * out->spacing[0];
  if (l->method == MESH_FINITE_ELEMENTS) {
    memset(out->element_free, 0, (size_t)mesh_node_count(out));
    memset(out->element_gauss, l->gauss, (size_t)mesh_cell_count(out));
    memset(out->mean_dilatation, l->dilatation == DILATATION_MEAN, (size_t)mesh_cell_count(out));
    for (int c = 0; c < mesh_cell_count(out); c++)
      out->hourglass[c] = l->hourglass;
  }
  for (int n = 0; n < k->zone_count; n++)
    if (strcmp(k->zones[n].mesh, l->name) == 0)
      good = take_zone(&k->zones[n], l->spacing, out, d) && good;
  mesh_rows_cut(k, l, out);
  mesh_settle(out);
  return good;
}
