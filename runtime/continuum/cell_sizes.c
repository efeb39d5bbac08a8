#include "runtime/continuum/cell_sizes.h"

#include <math.h>
#include <stdio.h>

#include "runtime/lattice/rows.h"

static const double MM = 1e-3;

/* "at (x, y) mm" */
static void name_cell(const mesh *m, int cell, char text[ROWS_PLACE_TEXT]) {
  int node[ELEMENT_MOST_NODES];
  const int count = mesh_cell_nodes(m, cell, node);
  double middle[3] = {0}, at[2];
  for (int k = 0; k < count; k++) {
    mesh_place(m, node[k], at);
    middle[0] += at[0] / count;
    middle[1] += at[1] / count;
  }
  rows_place_text(2, middle, text);
}

static bool is_of_law(const mesh *m, const unsigned char *own, int cell) {
  return m->cell[cell] != CELL_ABSENT && (!own || own[cell]);
}

/* What stands in no finite element has no size that the work of fracture could be smeared over. */
static bool has_size(const mesh *m, const unsigned char *own, const pl_law *law, span where,
                     diagnostics *d) {
  for (int cell = 0; cell < mesh_cell_count(m); cell++) {
    if (!is_of_law(m, own, cell) || m->cell[cell] == CELL_ELEMENT) continue;
    char there[ROWS_PLACE_TEXT];
    name_cell(m, cell, there);
    diag_report(d, DIAG_CONFLICT, where,
                "the law `%s` reads the size `h` of cells, but the cell at %s is element-free and "
                "has none",
                law->name, there);
    diag_hint(d, "such a law is for finite elements: method = 'finite_elements'");
    return false;
  }
  return true;
}

typedef struct size_range {
  double low, high;
  unsigned char low_open, high_open;
} size_range;

/* How far a size is beyond its range, as a factor; 0 inside. */
static double excess(const size_range *r, double h) {
  const bool above = r->low_open ? h > r->low : h >= r->low;
  const bool below = r->high_open ? h < r->high : h <= r->high;
  if (above && below) return 0;
  return !above ? r->low / h : r->high > 0 ? h / r->high : INFINITY;
}

static void report_size(const mesh *m, int cell, const pl_law *law, const size_range *r, span where,
                        diagnostics *d) {
  const double h = mesh_cell_size(m, cell);
  char there[ROWS_PLACE_TEXT];
  name_cell(m, cell, there);
  const bool large = !(h < r->high);
  diag_report(d, DIAG_OUT_OF_BOUNDS, where,
              "the cell at %s is %.4g mm across, but the law `%s` holds for %s than %.4g mm%s%s",
              there, h / MM, law->name, large ? "less" : "more", (large ? r->high : r->low) / MM,
              law->size_reason ? ": " : "", law->size_reason ? law->size_reason : "");
  diag_hint(d, large ? "make the mesh finer, or the parameters such that the limit is higher"
                     : "make the mesh coarser, or the parameters such that the limit is lower");
}

bool cell_sizes_fit(const mesh *m, const unsigned char *own, const pl_law *law,
                    const double *parameters, span where, diagnostics *d) {
  if (PL_HAS(law, reads_size) && law->reads_size && !has_size(m, own, law, where, d)) return false;
  if (!PL_HAS(law, size_bounds) || !law->size_bounds) return true;
  size_range r;
  law->size_bounds(law, parameters, &r.low, &r.high, &r.low_open, &r.high_open);
  int worst = -1;
  double most = 0;
  for (int cell = 0; cell < mesh_cell_count(m); cell++) {
    if (!is_of_law(m, own, cell)) continue;
    const double by = excess(&r, mesh_cell_size(m, cell));
    if (by <= most) continue;
    most = by;
    worst = cell;
  }
  if (worst < 0) return true;
  report_size(m, worst, law, &r, where, d);
  return false;
}
