/* A mesh of Gmsh. A mesh and errors exclude each other; its numbers name what is there, its cells
   have an area, and places of messages lie in the text. */
#include <math.h>
#include <string.h>

#include "runtime/geometry/gmsh_mesh.h"
#include "tests/fuzz/fuzz.h"

static void check_cells(const gmsh_mesh *m) {
  for (int c = 0; c < m->cell_count; c++) {
    double at[ELEMENT_MOST_NODES][2], u[2];
    MUST(m->nodes[c] == 3 || m->nodes[c] == 4 || m->nodes[c] == 6);
    for (int q = 0; q < m->nodes[c] && q < ELEMENT_MOST_NODES; q++) {
      MUST(m->cell[c][q] >= 0 && m->cell[c][q] < m->node_count);
      memcpy(at[q], m->at[m->cell[c][q]], sizeof at[q]);
    }
    MUST(element_is_sound(m->nodes[c], (const double(*)[2])at, u));
  }
  for (int s = 0; s < m->side_count; s++)
    for (int q = 0; q < m->sides[s].nodes; q++)
      MUST(m->sides[s].node[q] >= 0 && m->sides[s].node[q] < m->node_count &&
           m->sides[s].cell < m->cell_count);
}

static void check_groups(const gmsh_mesh *m) {
  for (int k = 0; k < m->group_count; k++) {
    const gmsh_group *g = &m->groups[k];
    const int most = g->dimension == 2 ? m->cell_count : m->side_count;
    for (int n = 0; n < g->node_count; n++)
      MUST(g->nodes[n] >= 0 && g->nodes[n] < m->node_count);
    for (int n = 0; n < g->item_count && g->dimension > 0; n++)
      MUST(g->items[n] >= 0 && g->items[n] < most);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  enum { LONGEST = 65536 };
  if (size > LONGEST) return 0;
  source_set sources = {0};
  diagnostics d;
  arena *memory = arena_new();
  char *text = calloc(size + 1, 1), *path = strdup("fuzz.msh");
  MUST(text && path);
  memcpy(text, data, size);
  diag_begin(&d, &sources);
  source_add(&sources, path, text, size);
  const gmsh_mesh *m = gmsh_mesh_read(memory, path, 1e-3, source_whole(&sources, 0), &d);
  MUST((m == NULL) == (d.errors > 0));
  for (int n = 0; n < d.count; n++)
    MUST(d.items[n].where.file < sources.count && d.items[n].where.end <= size);
  if (m) {
    MUST(m->cell_count > 0 && m->area > 0 && isfinite(m->area) && m->least > 0);
    check_cells(m);
    check_groups(m);
  }
  diag_clear(&d);
  source_clear(&sources);
  arena_free(memory);
  free(text);
  return 0;
}
