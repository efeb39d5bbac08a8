#include "runtime/continuum/cell_laws.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/geometry/gmsh_mesh.h"
#include "runtime/lattice/rows_select.h"
#include "runtime/mesh/node_layout.h"

/* --- cells of regions ------------------------------------------------------------------------- */

/* [nodes] 1 where the material's region holds the node, or that is not there. */
static unsigned char *nodes_of(const deck *k, const deck_material *m, const rows *nodes,
                               const mesh *of) {
  const node_layout l = node_layout_of(of->nodes, of->support);
  unsigned char *inside = must_calloc((size_t)mesh_node_count(of), 1);
  int32_t *particles;
  const long count =
      rows_select(nodes, &k->regions[deck_find_region(k, m->region)].shape, &particles);
  memcpy(inside, of->gone, (size_t)mesh_node_count(of));
  for (long n = 0; n < count; n++)
    inside[node_layout_node(&l, nodes->particle_site[particles[n]])] = 1;
  free(particles);
  return inside;
}

static bool holds_cell(const mesh *m, const unsigned char *inside, int cell) {
  int corner[ELEMENT_MOST_NODES], there = 0, held = 0;
  if (m->cell[cell] == CELL_ABSENT) return false;
  const int count = mesh_cell_nodes(m, cell, corner);
  for (int n = 0; n < count; n++) {
    held += inside[corner[n]] != 0;
    there += !m->gone[corner[n]];
  }
  return held == count && there > 0;
}

static bool report_no_cell(const deck_material *m, const mesh *of, diagnostics *d) {
  diag_report(d, DIAG_EMPTY_REGION, deck_where(&m->item, "region"),
              "this material is for nothing: the region `%s` holds no cell of `%s`", m->region,
              m->mesh);
  diag_hint(d,
            "a cell is of a region that holds all of its corners: these are %.6g mm by %.6g mm "
            "apart; make the region larger, or take more nodes",
            1e3 * of->spacing[0], 1e3 * of->spacing[1]);
  return false;
}

/* Its cells are of that law from now on. */
static bool take_region(cell_laws *l, const deck *k, const deck_material *m, int law,
                        const rows *nodes, const mesh *of, diagnostics *d) {
  const gmsh_group *group = k->regions[deck_find_region(k, m->region)].group;
  if (group && group->dimension == 2) {
    for (int n = 0; n < group->item_count; n++)
      l->of_cell[group->items[n]] = (unsigned char)law;
    return group->item_count > 0 || report_no_cell(m, of, d);
  }
  unsigned char *inside = nodes_of(k, m, nodes, of);
  long count = 0;
  for (int c = 0; c < mesh_cell_count(of); c++) {
    if (!holds_cell(of, inside, c)) continue;
    l->of_cell[c] = (unsigned char)law;
    count++;
  }
  free(inside);
  return count > 0 || report_no_cell(m, of, d);
}

/* Later materials may have taken all that a law had. */
static bool has_cell(const cell_laws *l, int law, const deck_material *m, const mesh *of,
                     diagnostics *d) {
  for (int c = 0; c < mesh_cell_count(of); c++)
    if (l->of_cell[c] == law && of->cell[c] != CELL_ABSENT) return true;
  diag_report(d, DIAG_EMPTY_REGION, m->item.where,
              "this material is for nothing: all of its cells are in regions of later materials");
  diag_hint(d, "leave it out, or give the regions of later ones smaller shapes");
  return false;
}

/* --- what belongs to a law -------------------------------------------------------------------- */

static void find_parts(cell_laws *l, int law, const rows *nodes, const mesh *m) {
  const node_layout layout = node_layout_of(m->nodes, m->support);
  l->cells[law] = must_calloc((size_t)mesh_cell_count(m) + 1, 1);
  l->sites[law] = must_calloc((size_t)nodes->size, 1);
  l->share[law] = must_calloc((size_t)nodes->size, sizeof(double));
  for (int c = 0; c < mesh_cell_count(m); c++)
    l->cells[law][c] = l->of_cell[c] == law && m->cell[c] != CELL_ABSENT;
  for (int n = 0; n < mesh_node_count(m); n++) {
    int around[ELEMENT_MOST_AROUND];
    double own = 0, all = 0;
    const int count = mesh_cells_around(m, n, around);
    for (int k = 0; k < count; k++) {
      const double h = mesh_cell_size(m, around[k]);
      all += h * h;
      own += l->cells[law][around[k]] ? h * h : 0;
    }
    if (!(own > 0) || m->gone[n]) continue;
    l->sites[law][node_layout_at(&layout, n)] = 1;
    l->share[law][node_layout_at(&layout, n)] = own / all;
  }
}

static const deck_interaction *first_of(const deck *k, int lattice, int *count) {
  int first = 0;
  while (k->interactions[first].lattice != lattice)
    first++;
  *count = 0;
  while (first + *count < k->interaction_count &&
         k->interactions[first + *count].lattice == lattice)
    ++*count;
  return &k->interactions[first];
}

static bool are_few(const deck_interaction *laws, int count, diagnostics *d) {
  if (count <= CELL_LAWS_MOST) return true;
  diag_report(d, DIAG_NOT_SUPPORTED, laws[CELL_LAWS_MOST].material->item.where,
              "a mesh has at most %d materials, this one %d", CELL_LAWS_MOST, count);
  diag_hint(d, "put regions of one material together, or take several meshes");
  return false;
}

bool cell_laws_open(cell_laws *l, const deck *k, int lattice, const rows *nodes, const mesh *m,
                    diagnostics *d) {
  int count;
  const deck_interaction *laws = first_of(k, lattice, &count);
  *l = (cell_laws){.count = count};
  if (count == 1) return true;
  if (!are_few(laws, count, d)) return false;
  bool good = true;
  l->of_cell = must_calloc((size_t)mesh_cell_count(m) + 1, 1);
  for (int law = 1; law < count; law++)
    good = take_region(l, k, laws[law].material, law, nodes, m, d) && good;
  for (int law = 0; law < count && good; law++)
    good = has_cell(l, law, laws[law].material, m, d) && good;
  l->cells = must_calloc((size_t)count, sizeof *l->cells);
  l->sites = must_calloc((size_t)count, sizeof *l->sites);
  l->share = must_calloc((size_t)count, sizeof *l->share);
  for (int law = 0; law < count; law++)
    find_parts(l, law, nodes, m);
  return good;
}

void cell_laws_close(cell_laws *l) {
  for (int law = 0; law < l->count && l->cells; law++) {
    free(l->cells[law]);
    free(l->sites[law]);
    free(l->share[law]);
  }
  free(l->cells);
  free(l->sites);
  free(l->share);
  free(l->of_cell);
}
