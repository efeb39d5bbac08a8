#include "runtime/continuum/tip_laws.h"

#include <string.h>

#include "runtime/continuum/node_stencil.h"

/* The cell around a tip; of one on an edge that inside. */
static int cell_of(const mesh_tip *p, const mesh *m) {
  return mesh_cell_of(m, p->now.at);
}

static bool has_linear_law(const mesh_tip *p, const unsigned char *linear, const mesh *m,
                           diagnostics *d) {
  const int cell = cell_of(p, m);
  if (cell < 0 || linear[cell] != NO_LINEAR_LAW) return true;
  diag_report(d, DIAG_CONFLICT, deck_where(&p->of->item, "points"),
              "the tip at (%.6g, %.6g) mm is in a region whose law is not linear: stress "
              "intensities are those of linear laws",
              1e3 * p->now.at[0], 1e3 * p->now.at[1]);
  diag_hint(d, "make the region smaller, so that the cells around the tip have a law such as "
               "`elastic`");
  return false;
}

static bool has_same_law(const tips *t, const mesh_tip *p, const cell_laws *where, const mesh *m,
                         diagnostics *d) {
  const int cell = cell_of(p, m);
  if (cell < 0 || cell_laws_at(where, cell) == t->law) return true;
  diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&p->of->item, "points"),
              "the tip at (%.6g, %.6g) mm is in another material than the first tip of this mesh",
              1e3 * p->now.at[0], 1e3 * p->now.at[1]);
  diag_hint(d, "all tips of a mesh are in one material; take a run for each");
  return false;
}

/* A law that is not linear, in cells that cracks may cut. */
static bool stands_in_elements(const deck_crack *c, const unsigned char *linear, const mesh *m,
                               diagnostics *d) {
  for (int cell = 0; cell < mesh_cell_count(m); cell++) {
    if (linear[cell] != NO_LINEAR_LAW || m->cell[cell] == CELL_ELEMENT ||
        m->cell[cell] == CELL_ABSENT)
      continue;
    double at[2];
    int corner[4];
    mesh_corners(m, cell, corner);
    mesh_place(m, corner[0], at);
    diag_report(d, DIAG_CONFLICT, c->item.where,
                "in a mesh with a crack a law that is not linear is for finite elements: the cell "
                "at (%.6g, %.6g) mm is none",
                1e3 * at[0], 1e3 * at[1]);
    diag_hint(d,
              "make the region's nodes finite elements: &zone mesh = '%s' method = "
              "'finite_elements' ..., or give its material a linear law",
              c->mesh);
    return false;
  }
  return true;
}

static void warn_of_box(const tips *t, const mesh_tip *p, const cell_laws *where, const mesh *m,
                        diagnostics *d) {
  const tip_box b = tips_box(t, p);
  double lower[2], upper[2];
  tip_box_extent(&b, lower, upper);
  for (int cell = 0; cell < mesh_cell_count(m); cell++) {
    int corner[4];
    double low[2], high[2];
    if (m->cell[cell] == CELL_ABSENT || cell_laws_at(where, cell) == t->law) continue;
    mesh_corners(m, cell, corner);
    mesh_place(m, corner[0], low);
    mesh_place(m, corner[3], high);
    if (low[0] >= upper[0] || high[0] <= lower[0] || low[1] >= upper[1] || high[1] <= lower[1])
      continue;
    diag_report(d, DIAG_DECK_WARNING, deck_where(&p->of->item, "points"),
                "the box around the tip at (%.6g, %.6g) mm reaches into another material: its "
                "stress intensities will be wrong",
                1e3 * p->now.at[0], 1e3 * p->now.at[1]);
    diag_hint(d, "it reaches %.4g mm to each side; make `half_size` of &tips smaller",
              1e3 * b.across);
    return;
  }
}

bool tip_laws_fit(tips *t, const deck *k, const char *name, const cell_laws *where,
                  const unsigned char *linear, const mesh *m, diagnostics *d) {
  int first = 0;
  if (where->count == 1) return true;
  bool good = true;
  const int cell = t->count > 0 ? cell_of(&t->items[0], m) : -1;
  t->law = cell < 0 ? 0 : cell_laws_at(where, cell);
  while (strcmp(k->cracks[first].mesh, name) != 0)
    first++;
  if (!stands_in_elements(&k->cracks[first], linear, m, d)) return false;
  for (int n = 0; n < t->count && good; n++)
    good = has_linear_law(&t->items[n], linear, m, d) && has_same_law(t, &t->items[n], where, m, d);
  for (int n = 0; n < t->count && good; n++)
    warn_of_box(t, &t->items[n], where, m, d);
  return good;
}
