#include "runtime/geometry/gmsh_mesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "runtime/geometry/cell_overlap.h"
#include "runtime/geometry/gmsh_text.h"
#include "runtime/geometry/hilbert.h"

typedef struct maker {
  gmsh_text *t;
  gmsh_mesh *m;
  arena *memory;
  diagnostics *d;
  int32_t *by_tag;  /* [t->node_count] nodes of the text by their tags */
  int32_t *number;  /* [t->node_count] in the mesh, -1 of nodes without a cell */
  int32_t *element; /* [cells] of the text */
} maker;

static const double ONE_PLACE = 1e-6; /* of the shortest side: nodes that near are twins */

static span line_of(const maker *k, uint32_t at) {
  return file_text_line(&k->t->file, k->t->file.text + at, k->d);
}

static span line_of_cell(const maker *k, int cell) {
  return line_of(k, k->t->elements[k->element[cell]].where);
}

/* --- nodes by their tags ---------------------------------------------------------------------- */

typedef struct tagged {
  int64_t tag;
  int32_t node;
} tagged;

static int by_tag(const void *p, const void *q) {
  const tagged *a = p, *b = q;
  if (a->tag != b->tag) return a->tag < b->tag ? -1 : 1;
  return (a->node > b->node) - (a->node < b->node);
}

static bool sort_nodes(maker *k) {
  const int count = k->t->node_count;
  tagged *all = must_calloc((size_t)count + 1, sizeof *all);
  bool good = true;
  for (int n = 0; n < count; n++)
    all[n] = (tagged){k->t->nodes[n].tag, n};
  qsort(all, (size_t)count, sizeof *all, by_tag);
  for (int n = 0; n < count; n++) {
    k->by_tag[n] = all[n].node;
    if (!good || n == 0 || all[n].tag != all[n - 1].tag) continue;
    good = false;
    diag_report(k->d, DIAG_DUPLICATE_NAME, line_of(k, k->t->nodes[all[n].node].where),
                "there are two nodes %lld", (long long)all[n].tag);
    diag_note(k->d, line_of(k, k->t->nodes[all[n - 1].node].where), "the other one is here");
  }
  free(all);
  return good;
}

/* -1: none has that tag. */
static int32_t find_node(const maker *k, int64_t tag) {
  int low = 0, high = k->t->node_count;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (k->t->nodes[k->by_tag[middle]].tag < tag)
      low = middle + 1;
    else
      high = middle;
  }
  return low < k->t->node_count && k->t->nodes[k->by_tag[low]].tag == tag ? k->by_tag[low] : -1;
}

/* The tags of nodes in elements become their numbers in the text. */
static bool find_nodes(maker *k) {
  for (int n = 0; n < k->t->element_count; n++) {
    gmsh_element *e = &k->t->elements[n];
    for (int q = 0; q < e->nodes; q++) {
      const int32_t node = find_node(k, e->node[q]);
      if (node < 0) {
        diag_report(k->d, DIAG_FILE, line_of(k, e->where),
                    "element %lld has the node %lld, which the file has not", (long long)e->tag,
                    (long long)e->node[q]);
        return false;
      }
      e->node[q] = node;
    }
  }
  return true;
}

/* --- numbers ---------------------------------------------------------------------------------- */

static bool is_cell(const gmsh_element *e) {
  return e->dimension == 2;
}

/* Nodes of cells, and how many cells there are. */
static long mark_nodes(const maker *k, unsigned char *used) {
  long cells = 0;
  for (int n = 0; n < k->t->element_count; n++) {
    const gmsh_element *e = &k->t->elements[n];
    if (!is_cell(e)) continue;
    cells++;
    for (int q = 0; q < e->nodes; q++)
      used[e->node[q]] = 1;
  }
  return cells;
}

/* Along the curve; order[count]: nodes of the text. */
static void order_nodes(const maker *k, const int32_t *nodes, int count, int32_t *order) {
  double *at[2];
  for (int a = 0; a < 2; a++) {
    at[a] = must_calloc((size_t)count + 1, sizeof(double));
    for (int n = 0; n < count; n++)
      at[a][n] = k->t->nodes[nodes[n]].at[a];
  }
  const point_cloud cloud = {.dimensions = 2, .count = count, .at = {at[0], at[1]}};
  hilbert_order(&cloud, order);
  for (int n = 0; n < count; n++)
    order[n] = nodes[order[n]];
  free(at[0]);
  free(at[1]);
}

static bool are_plane(const maker *k) {
  const gmsh_mesh *m = k->m;
  double size = 0;
  for (int n = 0; n < m->node_count; n++)
    size = pl_max(size, pl_max(fabs(m->at[n][0]), fabs(m->at[n][1])));
  for (int n = 0; n < k->t->node_count; n++) {
    const gmsh_node *node = &k->t->nodes[n];
    if (k->number[n] < 0 || fabs(node->at[2]) <= 1e-9 * size) continue;
    diag_report(k->d, DIAG_OUT_OF_BOUNDS, line_of(k, node->where),
                "node %lld stands at z = %.6g mm: a mesh lies in the plane z = 0",
                (long long)node->tag, 1e3 * node->at[2]);
    return false;
  }
  return true;
}

static bool number_nodes(maker *k) {
  gmsh_mesh *m = k->m;
  const size_t all = (size_t)k->t->node_count + 1;
  unsigned char *used = must_calloc(all, 1);
  m->cell_count = (int)mark_nodes(k, used);
  int32_t *nodes = must_alloc(all * sizeof *nodes), *order = must_alloc(all * sizeof *order);
  for (int n = 0; n < k->t->node_count; n++) {
    k->number[n] = -1;
    if (used[n]) nodes[m->node_count++] = n;
  }
  const bool good = m->node_count <= GMSH_MOST_NODES;
  if (good) {
    order_nodes(k, nodes, m->node_count, order);
    m->at = arena_alloc(k->memory, ((size_t)m->node_count + 1) * sizeof *m->at);
    m->tag = arena_alloc(k->memory, ((size_t)m->node_count + 1) * sizeof *m->tag);
  }
  for (int n = 0; n < m->node_count && good; n++) {
    const gmsh_node *from = &k->t->nodes[order[n]];
    k->number[order[n]] = n;
    memcpy(m->at[n], from->at, sizeof m->at[n]);
    m->tag[n] = from->tag;
  }
  free(used);
  free(nodes);
  free(order);
  if (good) return are_plane(k);
  diag_report(k->d, DIAG_OUT_OF_BOUNDS, line_of(k, 0), "a mesh has at most %d nodes, these are %d",
              GMSH_MOST_NODES, m->node_count);
  return false;
}

/* --- cells ------------------------------------------------------------------------------------ */

typedef struct placed_cell {
  int32_t first, element; /* its least node */
} placed_cell;

static int by_first_node(const void *p, const void *q) {
  const placed_cell *a = p, *b = q;
  if (a->first != b->first) return a->first < b->first ? -1 : 1;
  return (a->element > b->element) - (a->element < b->element);
}

static void number_cells(maker *k) {
  gmsh_mesh *m = k->m;
  const size_t count = (size_t)m->cell_count + 1;
  placed_cell *all = must_calloc(count, sizeof *all);
  int at = 0;
  for (int n = 0; n < k->t->element_count; n++) {
    const gmsh_element *e = &k->t->elements[n];
    if (!is_cell(e)) continue;
    int32_t least = INT32_MAX;
    for (int q = 0; q < e->nodes; q++)
      if (k->number[e->node[q]] < least) least = k->number[e->node[q]];
    all[at++] = (placed_cell){least, n};
  }
  qsort(all, (size_t)at, sizeof *all, by_first_node);
  m->nodes = arena_alloc(k->memory, count);
  m->cell = arena_alloc(k->memory, count * sizeof *m->cell);
  m->cell_tag = arena_alloc(k->memory, count * sizeof *m->cell_tag);
  k->element = must_alloc(count * sizeof *k->element);
  for (int c = 0; c < at; c++) {
    const gmsh_element *e = &k->t->elements[all[c].element];
    k->element[c] = all[c].element;
    m->nodes[c] = e->nodes;
    m->cell_tag[c] = e->tag;
    for (int q = 0; q < e->nodes; q++)
      m->cell[c][q] = k->number[e->node[q]];
  }
  free(all);
}

static void places_of(const gmsh_mesh *m, int cell, double corner[][2]) {
  for (int q = 0; q < m->nodes[cell] && q < ELEMENT_MOST_NODES; q++)
    memcpy(corner[q], m->at[m->cell[cell][q]], sizeof corner[q]);
}

/* --- orientation ------------------------------------------------------------------------------ */

static void turn_cell(gmsh_mesh *m, int c) {
  int32_t *node = m->cell[c];
  const int last = m->nodes[c] == 4 ? 3 : 2;
  int32_t kept = node[1];
  node[1] = node[last];
  node[last] = kept;
  if (m->nodes[c] != 6) return;
  kept = node[3];
  node[3] = node[5];
  node[5] = kept;
}

/* Twice the area between the corners. */
static double signed_area(const gmsh_mesh *m, int c) {
  const int corners = element_corners(m->nodes[c]);
  double sum = 0;
  for (int k = 0; k < corners; k++) {
    const double *a = m->at[m->cell[c][k]], *b = m->at[m->cell[c][(k + 1) % corners]],
                 *o = m->at[m->cell[c][0]];
    sum += (a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1]);
  }
  return sum;
}

static int by_surface(const void *p, const void *q) {
  const tagged *a = p, *b = q;
  return by_tag(a, b);
}

/* Surfaces that are clockwise as a whole are turned: in a plane their normal says nothing. */
static void turn_surfaces(maker *k) {
  gmsh_mesh *m = k->m;
  tagged *cell = must_calloc((size_t)m->cell_count + 1, sizeof *cell);
  for (int c = 0; c < m->cell_count; c++)
    cell[c] = (tagged){k->t->elements[k->element[c]].entity, c};
  qsort(cell, (size_t)m->cell_count, sizeof *cell, by_surface);
  for (int c = 0, next; c < m->cell_count; c = next) {
    bool clockwise = true;
    for (next = c; next < m->cell_count && cell[next].tag == cell[c].tag; next++)
      clockwise = clockwise && signed_area(m, cell[next].node) < 0;
    for (int n = c; n < next && clockwise; n++)
      turn_cell(m, cell[n].node);
  }
  free(cell);
}

static const char *kind_of(int nodes) {
  return nodes == 4 ? "quadrilateral" : "triangle";
}

static bool is_repeated(const gmsh_mesh *m, int c) {
  for (int p = 0; p < m->nodes[c]; p++)
    for (int q = 0; q < p; q++)
      if (m->cell[c][p] == m->cell[c][q]) return true;
  return false;
}

static bool cell_is_sound(const maker *k, int c) {
  const gmsh_mesh *m = k->m;
  double corner[ELEMENT_MOST_NODES][2], u[2], at[2];
  places_of(m, c, corner);
  const bool repeated = is_repeated(m, c);
  if (!repeated && element_is_sound(m->nodes[c], (const double(*)[2])corner, u)) return true;
  if (repeated)
    diag_report(k->d, DIAG_BAD_VALUE, line_of_cell(k, c), "%s %lld has a node twice",
                kind_of(m->nodes[c]), (long long)m->cell_tag[c]);
  else {
    const double turn = element_map(m->nodes[c], (const double(*)[2])corner, u, at, NULL);
    diag_report(k->d, DIAG_BAD_VALUE, line_of_cell(k, c),
                "%s %lld is %s at (%.6g, %.6g) mm: its Jacobian is %.3g mm^2 there",
                kind_of(m->nodes[c]), (long long)m->cell_tag[c],
                signed_area(m, c) < 0 ? "inverted"
                : turn < 0            ? "folded"
                                      : "degenerate",
                1e3 * at[0], 1e3 * at[1], 1e6 * turn);
  }
  diag_hint(k->d, m->nodes[c] == 6
                      ? "let Gmsh mend it (Mesh.HighOrderOptimize = 2), or take a finer mesh there"
                      : "look at the mesh in Gmsh (Tools, Statistics, quality), and mesh it anew");
  return false;
}

static void find_area(gmsh_mesh *m) {
  for (int c = 0; c < m->cell_count; c++) {
    double corner[ELEMENT_MOST_NODES][2];
    places_of(m, c, corner);
    m->area += element_area(m->nodes[c], (const double(*)[2])corner);
  }
}

static bool cells_are_sound(const maker *k) {
  enum { MOST_TOLD = 5 };
  int bad = 0;
  for (int c = 0; c < k->m->cell_count && bad < MOST_TOLD; c++)
    bad += !cell_is_sound(k, c);
  return bad == 0;
}

/* --- sides ------------------------------------------------------------------------------------ */

typedef struct cell_side { /* of a cell, from -> to; the node between, or -1 */
  int32_t low, high, between;
  int cell;
  bool turned; /* from is the higher one */
} cell_side;

static int by_ends(const void *p, const void *q) {
  const cell_side *a = p, *b = q;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->cell > b->cell) - (a->cell < b->cell);
}

static cell_side *sides_of(const gmsh_mesh *m, int *count) {
  cell_side *all = must_calloc(4 * (size_t)m->cell_count + 1, sizeof *all);
  *count = 0;
  for (int c = 0; c < m->cell_count; c++) {
    const int corners = element_corners(m->nodes[c]);
    for (int q = 0; q < corners; q++) {
      const int32_t from = m->cell[c][q], to = m->cell[c][(q + 1) % corners];
      all[(*count)++] = (cell_side){from < to ? from : to, from < to ? to : from,
                                    m->nodes[c] == 6 ? m->cell[c][3 + q] : -1, c, from > to};
    }
  }
  qsort(all, (size_t)*count, sizeof *all, by_ends);
  return all;
}

static bool same_ends(const cell_side *a, const cell_side *b) {
  return a->low == b->low && a->high == b->high;
}

static int by_number(const void *p, const void *q) {
  const int32_t a = *(const int32_t *)p, b = *(const int32_t *)q;
  return (a > b) - (a < b);
}

static bool same_nodes(const gmsh_mesh *m, int a, int b) {
  int32_t x[ELEMENT_MOST_NODES], y[ELEMENT_MOST_NODES];
  const size_t size = m->nodes[a] * sizeof *x;
  if (m->nodes[a] != m->nodes[b]) return false;
  memcpy(x, m->cell[a], size);
  memcpy(y, m->cell[b], size);
  qsort(x, m->nodes[a], sizeof *x, by_number);
  qsort(y, m->nodes[b], sizeof *y, by_number);
  return memcmp(x, y, size) == 0;
}

/* Cells on both sides of a line have it in opposite directions. */
static bool pair_fits(const maker *k, const cell_side *a, const cell_side *b) {
  const gmsh_mesh *m = k->m;
  const long long first = (long long)m->cell_tag[a->cell], second = (long long)m->cell_tag[b->cell];
  if (a->turned != b->turned && a->between == b->between) return true;
  const span where = line_of_cell(k, b->cell);
  if (same_nodes(m, a->cell, b->cell)) {
    diag_report(k->d, DIAG_DUPLICATE_NAME, where, "cells %lld and %lld have the same nodes", first,
                second);
    diag_hint(k->d, "is a surface there twice? In Gmsh: `Coherence`, or BooleanFragments");
  } else if (a->turned == b->turned) {
    diag_report(
        k->d, DIAG_BAD_VALUE, where,
        "cells %lld and %lld lie over each other: both are on the same side of the line from "
        "node %lld to %lld",
        first, second, (long long)m->tag[a->low], (long long)m->tag[a->high]);
  } else {
    diag_report(k->d, DIAG_BAD_VALUE, where,
                "cells %lld and %lld do not fit: one has a node between node %lld and %lld, the "
                "other has not",
                first, second, (long long)m->tag[a->low], (long long)m->tag[a->high]);
    diag_hint(k->d, "cells of 6 nodes have neighbours of 6 nodes alone");
  }
  diag_note(k->d, line_of_cell(k, a->cell), "cell %lld is here", first);
  return false;
}

static bool sides_fit(const maker *k, const cell_side *sides, int count) {
  for (int n = 0; n + 1 < count; n++) {
    if (!same_ends(&sides[n], &sides[n + 1])) continue;
    if (!pair_fits(k, &sides[n], &sides[n + 1])) return false;
    if (n + 2 >= count || !same_ends(&sides[n], &sides[n + 2])) continue;
    diag_report(k->d, DIAG_BAD_VALUE, line_of_cell(k, sides[n + 2].cell),
                "three cells meet in the line from node %lld to %lld",
                (long long)k->m->tag[sides[n].low], (long long)k->m->tag[sides[n].high]);
    return false;
  }
  return true;
}

static void find_least(gmsh_mesh *m, const cell_side *sides, int count) {
  m->least = INFINITY;
  for (int n = 0; n < count; n++) {
    const double *a = m->at[sides[n].low], *b = m->at[sides[n].high],
                 length = pl_hypot(a[0] - b[0], a[1] - b[1]);
    m->least = pl_min(m->least, sides[n].between < 0 ? length : 0.5 * length);
  }
}

static const cell_side *find_side(const cell_side *sides, int count, int32_t low, int32_t high) {
  const cell_side key = {.low = low, .high = high, .cell = -1};
  int first = 0, last = count;
  while (first < last) {
    const int middle = first + (last - first) / 2;
    if (by_ends(&sides[middle], &key) < 0)
      first = middle + 1;
    else
      last = middle;
  }
  return first < count && same_ends(&sides[first], &key) ? &sides[first] : NULL;
}

static void say_inside(const maker *k, const cell_overlap *o) {
  const gmsh_mesh *m = k->m;
  int other = o->other;
  for (int c = 0; c < m->cell_count && other < 0; c++)
    for (int q = 0; q < m->nodes[c]; q++)
      if (m->cell[c][q] == o->node) other = c;
  const long long first = (long long)m->cell_tag[o->cell], second = (long long)m->cell_tag[other];
  if (o->node >= 0)
    diag_report(k->d, DIAG_BAD_VALUE, line_of_cell(k, other),
                "cells %lld and %lld lie over each other: node %lld of this one, at (%.6g, %.6g) "
                "mm, is in cell %lld",
                first, second, (long long)m->tag[o->node], 1e3 * m->at[o->node][0],
                1e3 * m->at[o->node][1], first);
  else
    diag_report(k->d, DIAG_BAD_VALUE, line_of_cell(k, other),
                "cells %lld and %lld lie over each other: the middle of this one is in cell "
                "%lld",
                first, second, first);
  diag_hint(k->d,
            "do surfaces lie over each other? In Gmsh: BooleanFragments, or BooleanDifference");
  diag_note(k->d, line_of_cell(k, o->cell), "cell %lld is here", first);
}

static void say_hanging(const maker *k, const cell_overlap *o) {
  const gmsh_mesh *m = k->m;
  const int32_t *cell = m->cell[o->cell], from = cell[o->side],
                to = cell[(o->side + 1) % element_corners(m->nodes[o->cell])];
  diag_report(k->d, DIAG_BAD_VALUE, line_of_cell(k, o->cell),
              "node %lld hangs: it lies at (%.6g, %.6g) mm on the side from node %lld to %lld of "
              "cell %lld, which has it not",
              (long long)m->tag[o->node], 1e3 * m->at[o->node][0], 1e3 * m->at[o->node][1],
              (long long)m->tag[from], (long long)m->tag[to], (long long)m->cell_tag[o->cell]);
  diag_hint(k->d, "neighbours have whole sides in common: `Coherence` or BooleanFragments in Gmsh "
                  "before it meshes; faces of a slit have nodes at the same places");
}

/* Cells lie on both sides of it: what else lies on it lies over one of them. */
static bool is_between(const gmsh_mesh *m, const cell_overlap *o, const cell_side *sides,
                       int count) {
  const int32_t a = m->cell[o->cell][o->side],
                b = m->cell[o->cell][(o->side + 1) % element_corners(m->nodes[o->cell])];
  const cell_side *of = find_side(sides, count, a < b ? a : b, a < b ? b : a);
  return of && of + 1 < sides + count && same_ends(of, of + 1);
}

static bool cells_are_apart(const maker *k, const cell_side *sides, int count) {
  const gmsh_mesh *m = k->m;
  const overlap_cells all = {.node_count = m->node_count,
                             .count = m->cell_count,
                             .at = (const double(*)[2])m->at,
                             .nodes = m->nodes,
                             .cell = (const int32_t(*)[ELEMENT_MOST_NODES])m->cell,
                             .same = ONE_PLACE * m->least};
  cell_overlap found;
  if (!cell_overlap_find(&all, &found)) return true;
  if (found.side < 0 || is_between(m, &found, sides, count))
    say_inside(k, &found);
  else
    say_hanging(k, &found);
  return false;
}

/* The file's lines; numbers of elements that are lines: [side_count]. */
static void take_sides(maker *k, const cell_side *sides, int count, int32_t *line) {
  gmsh_mesh *m = k->m;
  m->sides = arena_alloc(k->memory, ((size_t)k->t->element_count + 1) * sizeof *m->sides);
  for (int n = 0; n < k->t->element_count; n++) {
    const gmsh_element *e = &k->t->elements[n];
    bool there = e->dimension == 1;
    gmsh_side side = {.nodes = e->nodes, .cell = -1};
    for (int q = 0; q < e->nodes && there; q++) {
      side.node[q] = k->number[e->node[q]];
      there = side.node[q] >= 0;
    }
    if (!there) continue;
    const bool back = side.node[0] > side.node[1];
    const cell_side *of = find_side(sides, count, side.node[back], side.node[!back]);
    if (of && of->between == (side.nodes == 3 ? side.node[2] : -1)) {
      const bool both = of + 1 < sides + count && same_ends(of, of + 1);
      if (both && of->turned != back) of++;
      side.cell = of->cell;
      side.turned = of->turned != back;
    }
    line[m->side_count] = n;
    m->sides[m->side_count++] = side;
  }
}

/* --- groups ----------------------------------------------------------------------------------- */

static int by_dimension_and_tag(const void *p, const void *q) {
  const gmsh_entity *a = p, *b = q;
  if (a->dimension != b->dimension) return a->dimension - b->dimension;
  return (a->tag > b->tag) - (a->tag < b->tag);
}

/* Of the text, whose entities are sorted. */
static const gmsh_entity *entity_of(const gmsh_text *t, const gmsh_element *e) {
  const gmsh_entity key = {.dimension = e->dimension, .tag = e->entity};
  return t->entities
             ? bsearch(&key, t->entities, (size_t)t->entity_count, sizeof key, by_dimension_and_tag)
             : NULL;
}

static bool is_in(const gmsh_text *t, const gmsh_entity *e, const gmsh_name *group) {
  for (int k = 0; e && k < e->group_count; k++) {
    const int64_t tag = t->groups[e->first_group + k];
    /* a curve that is turned has the sign; INT64_MIN has no opposite */
    if (tag == group->tag || (tag != INT64_MIN && -tag == group->tag)) return true;
  }
  return false;
}

static void take_node(gmsh_group *g, unsigned char *in, int32_t node) {
  if (node < 0 || in[node]) return;
  in[node] = 1;
  g->nodes[g->node_count++] = node;
}

/* Items of a dimension, by their elements of the text: [count]. */
static void take_items(maker *k, const gmsh_name *of, const int32_t *elements, int count,
                       gmsh_group *g, unsigned char *in) {
  for (int n = 0; n < count; n++) {
    const gmsh_element *e = &k->t->elements[elements[n]];
    if (e->dimension != of->dimension || !is_in(k->t, entity_of(k->t, e), of)) continue;
    g->items[g->item_count++] = n;
    for (int q = 0; q < e->nodes; q++)
      take_node(g, in, k->number[e->node[q]]);
  }
}

static void *kept(arena *a, const int32_t *items, int count) {
  int32_t *copy = arena_alloc(a, ((size_t)count + 1) * sizeof *copy);
  if (count > 0) memcpy(copy, items, (size_t)count * sizeof *copy);
  return copy;
}

static gmsh_group make_group(maker *k, const gmsh_name *of, const int32_t *line,
                             const int32_t *all) {
  const size_t most = (size_t)k->t->element_count + 1;
  unsigned char *in = must_calloc((size_t)k->m->node_count + 1, 1);
  gmsh_group g = {.name = arena_text(k->memory, of->name, strlen(of->name)),
                  .dimension = of->dimension,
                  .where = line_of(k, of->at),
                  .nodes = must_alloc(((size_t)k->m->node_count + 1) * sizeof(int32_t)),
                  .items = must_alloc(most * sizeof(int32_t))};
  int32_t *nodes = g.nodes, *items = g.items;
  if (of->dimension == 2)
    take_items(k, of, k->element, k->m->cell_count, &g, in);
  else if (of->dimension == 1)
    take_items(k, of, line, k->m->side_count, &g, in);
  else if (of->dimension == 0)
    take_items(k, of, all, k->t->element_count, &g, in);
  qsort(nodes, (size_t)g.node_count, sizeof *nodes, by_number);
  g.nodes = kept(k->memory, nodes, g.node_count);
  g.items = kept(k->memory, items, g.item_count);
  free(nodes);
  free(items);
  free(in);
  return g;
}

static bool names_differ(const maker *k) {
  for (int n = 0; n < k->t->name_count; n++)
    for (int q = 0; q < n; q++) {
      if (strcmp(k->t->names[n].name, k->t->names[q].name) != 0) continue;
      diag_report(k->d, DIAG_DUPLICATE_NAME, line_of(k, k->t->names[n].at),
                  "there are two physical groups `%s`", k->t->names[n].name);
      diag_note(k->d, line_of(k, k->t->names[q].at), "the other one is here");
      return false;
    }
  return true;
}

static void take_groups(maker *k, const int32_t *line) {
  gmsh_text *t = k->t;
  gmsh_mesh *m = k->m;
  int32_t *all = must_alloc(((size_t)t->element_count + 1) * sizeof *all);
  for (int n = 0; n < t->element_count; n++)
    all[n] = n;
  if (t->entity_count > 0)
    qsort(t->entities, (size_t)t->entity_count, sizeof *t->entities, by_dimension_and_tag);
  m->groups = arena_alloc(k->memory, ((size_t)t->name_count + 1) * sizeof *m->groups);
  for (int n = 0; n < t->name_count; n++)
    m->groups[m->group_count++] = make_group(k, &t->names[n], line, all);
  free(all);
}

/* --- the mesh --------------------------------------------------------------------------------- */

/* Nodes at one place are apart, which is seldom meant. */
static void warn_of_twins(const maker *k) {
  const gmsh_mesh *m = k->m;
  double *at[2];
  for (int a = 0; a < 2; a++) {
    at[a] = must_calloc((size_t)m->node_count + 1, sizeof(double));
    for (int n = 0; n < m->node_count; n++)
      at[a][n] = m->at[n][a];
  }
  const point_cloud cloud = {.dimensions = 2, .count = m->node_count, .at = {at[0], at[1]}};
  const point_pairs twins = pairs_within(&cloud, ONE_PLACE * m->least, 64);
  if (twins.count > 0) {
    const point_pair *p = &twins.items[0];
    diag_report(k->d, DIAG_DECK_WARNING, line_of(k, 0),
                "%ld pair%s of nodes stand at one place, as %lld and %lld at (%.6g, %.6g) mm: the "
                "mesh is apart there",
                twins.count, twins.count == 1 ? "" : "s", (long long)m->tag[p->i],
                (long long)m->tag[p->j], 1e3 * m->at[p->i][0], 1e3 * m->at[p->i][1]);
    diag_hint(k->d, "if it is to hold together: `Coherence` or BooleanFragments in Gmsh");
  }
  free(twins.items);
  free(at[0]);
  free(at[1]);
}

/* A side that is so short rules how long a step may be, and is seldom meant. */
static void warn_of_short_side(const maker *k, const cell_side *sides, int count) {
  const gmsh_mesh *m = k->m;
  const double mean = sqrt(m->area / m->cell_count);
  int shortest = -1;
  double length = 0.02 * mean;
  for (int n = 0; n < count; n++) {
    const double *a = m->at[sides[n].low], *b = m->at[sides[n].high],
                 here = pl_hypot(a[0] - b[0], a[1] - b[1]);
    if (!(here < length)) continue;
    length = here;
    shortest = n;
  }
  if (shortest < 0) return;
  const cell_side *s = &sides[shortest];
  diag_report(
      k->d, DIAG_DECK_WARNING, line_of_cell(k, s->cell),
      "the side from node %lld to %lld at (%.6g, %.6g) mm is only %.3g mm long, cells are %.3g "
      "mm wide in the mean",
      (long long)m->tag[s->low], (long long)m->tag[s->high], 1e3 * m->at[s->low][0],
      1e3 * m->at[s->low][1], 1e3 * length, 1e3 * mean);
  diag_hint(k->d, "steps are as short as the smallest cell asks for; is a short curve in the "
                  "drawing meant?");
}

/* No node has more cells than there is room for. */
static bool is_not_crowded(const maker *k) {
  int *around = must_calloc((size_t)k->m->node_count + 1, sizeof *around), bad = -1;
  for (int c = 0; c < k->m->cell_count; c++)
    for (int q = 0; q < k->m->nodes[c]; q++)
      if (++around[k->m->cell[c][q]] > ELEMENT_MOST_AROUND) bad = c;
  free(around);
  if (bad < 0) return true;
  diag_report(k->d, DIAG_OUT_OF_BOUNDS, line_of_cell(k, bad),
              "more than %d cells meet in a node of this one", ELEMENT_MOST_AROUND);
  return false;
}

static bool has_cells(const maker *k, span where) {
  if (k->m->cell_count > 0) return true;
  diag_report(k->d, DIAG_EMPTY_REGION, where, "`%s` has no cells in the plane", k->m->path);
  diag_hint(k->d,
            "mesh the surface, `gmsh -2`; where there are physical groups Gmsh saves only what "
            "belongs to one: give the surface one, too");
  return false;
}

static bool make(maker *k, span where) {
  if (!sort_nodes(k) || !find_nodes(k) || !names_differ(k) || !number_nodes(k)) return false;
  if (!has_cells(k, where)) return false;
  number_cells(k);
  turn_surfaces(k);
  if (!cells_are_sound(k) || !is_not_crowded(k)) return false;
  int count;
  cell_side *sides = sides_of(k->m, &count);
  int32_t *line = must_alloc(((size_t)k->t->element_count + 1) * sizeof *line);
  bool good = sides_fit(k, sides, count);
  if (good) {
    find_least(k->m, sides, count);
    good = cells_are_apart(k, sides, count);
  }
  if (good) {
    find_area(k->m);
    take_sides(k, sides, count, line);
    take_groups(k, line);
    warn_of_twins(k);
    warn_of_short_side(k, sides, count);
  }
  free(sides);
  free(line);
  return good;
}

const gmsh_mesh *gmsh_mesh_read(arena *a, char *path, double unit, span where, diagnostics *d) {
  gmsh_text t;
  gmsh_mesh *m = arena_alloc(a, sizeof *m);
  bool good = gmsh_text_read(&t, path, unit, where, d);
  if (good) {
    const size_t nodes = (size_t)t.node_count + 1;
    m->path = arena_text(a, path, strlen(path));
    file_text_source(&t.file, d); /* it is a source from now on: groups point into it */
    maker k = {.t = &t,
               .m = m,
               .memory = a,
               .d = d,
               .by_tag = must_alloc(nodes * sizeof(int32_t)),
               .number = must_alloc(nodes * sizeof(int32_t))};
    good = make(&k, where);
    free(k.by_tag);
    free(k.number);
    free(k.element);
  }
  gmsh_text_free(&t);
  return good ? m : NULL;
}

const gmsh_group *gmsh_mesh_group(const gmsh_mesh *m, const char *name) {
  for (int k = 0; k < m->group_count; k++)
    if (strcmp(m->groups[k].name, name) == 0) return &m->groups[k];
  return NULL;
}
