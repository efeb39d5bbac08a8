#include "runtime/continuum/cell_sizes.h"

#include <math.h>
#include <stdio.h>

#include "runtime/continuum/point_law.h"
#include "runtime/lattice/rows.h"

static const double MM = 1e-3, SLENDER = 1.5;

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

/* A band runs along or across slender cells: as wide as their shorter or longer side, not h. */
static void warn_of_slender(const mesh *m, const unsigned char *own, const pl_law *law, span where,
                            diagnostics *d) {
  int worst = -1;
  double most = SLENDER;
  for (int cell = 0; cell < mesh_cell_count(m); cell++) {
    const double by = is_of_law(m, own, cell) ? mesh_cell_slender(m, cell) : 0;
    if (by <= most) continue;
    most = by;
    worst = cell;
  }
  if (worst < 0) return;
  char there[ROWS_PLACE_TEXT];
  name_cell(m, worst, there);
  diag_report(d, DIAG_DECK_WARNING, where,
              "the cell at %s is %.3g times longer than wide, but the law `%s` knows one size "
              "`h`: a band across or along such cells takes up to %.3g times more or less work",
              there, most, law->name, sqrt(most));
  diag_hint(d, "make cells as wide as they are high where it may crack");
}

bool cell_sizes_fit(const mesh *m, const unsigned char *own, const pl_law *law,
                    const double *parameters, span where, diagnostics *d) {
  const bool reads = point_law_reads_size(law);
  if (reads && !has_size(m, own, law, where, d)) return false;
  if (reads) warn_of_slender(m, own, law, where, d);
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
