#include "runtime/deck/bravais.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

enum { FARTHEST_NEIGHBOUR = 8 }; /* spacings: beyond, a family has more than it may */

int bravais_dimensions(const char *kind) {
  const lattice_kind *k = lattice_kind_find(kind);
  return k ? k->dimensions : 0;
}

/* The coordinate axes, turned about `about` (Rodrigues); 0, 0, 0 is z. */
static void turn_axes(double angle, const double about[3], double axis[3][3]) {
  const double size = pl_hypot(pl_hypot(about[0], about[1]), about[2]);
  const double n[3] = {size > 0 ? about[0] / size : 0, size > 0 ? about[1] / size : 0,
                       size > 0 ? about[2] / size : 1};
  const double c = pl_cos(angle), s = pl_sin(angle);
  const double cross[3][3] = {{0, n[2], -n[1]}, {-n[2], 0, n[0]}, {n[1], -n[0], 0}};
  for (int a = 0; a < 3; a++)
    for (int k = 0; k < 3; k++)
      axis[a][k] = (a == k ? c : 0) + s * cross[a][k] + (1 - c) * n[a] * n[k];
}

bool bravais_of(const deck_lattice *l, bravais *b) {
  const lattice_kind *k = lattice_kind_find(l->kind);
  if (!k || k->dimensions == 0) return false;
  *b = (bravais){.dimensions = k->dimensions,
                 .axes = lattice_kind_axes(k),
                 .spacing = l->spacing,
                 .site_measure = 1};
  memcpy(b->origin, l->origin, sizeof b->origin);
  memcpy(b->square, k->square, sizeof b->square);
  memcpy(b->shift_by, k->shift_by, sizeof b->shift_by);
  turn_axes(l->rotation, l->axis, b->axis);
  for (int c = 0; c < b->axes; c++) {
    b->step[c] = l->spacing * sqrt(k->square[c]);
    b->site_measure *= b->step[c];
  }
  return true;
}

int bravais_shift(const bravais *b, long row, long layer) {
  return (int)((b->shift_by[0] * row + b->shift_by[1] * layer) & 1);
}

static void add_steps(const bravais *b, double along, double across, double above, double at[3]) {
  for (int c = 0; c < 3; c++)
    at[c] = at[c] + along * b->axis[0][c] + across * b->axis[1][c] + above * b->axis[2][c];
}

void bravais_place(const bravais *b, long column, long row, long layer, double at[3]) {
  const double shift = 0.5 * bravais_shift(b, row, layer);
  memcpy(at, b->origin, sizeof b->origin);
  add_steps(b, ((double)column + shift) * b->step[0], (double)row * b->step[1],
            (double)layer * b->step[2], at);
}

void bravais_coordinates(const bravais *b, const double at[3], double out[3]) {
  for (int a = 0; a < 3; a++) {
    out[a] = 0;
    for (int c = 0; c < b->dimensions; c++)
      out[a] += b->axis[a][c] * (at[c] - b->origin[c]);
    out[a] = a < b->axes ? out[a] / b->step[a] : 0;
  }
}

double bravais_distance(const double p[3], const double q[3]) {
  return pl_hypot(pl_hypot(q[0] - p[0], q[1] - p[1]), q[2] - p[2]);
}

/* --- neighbours ------------------------------------------------------------------------------- */

static int by_order(const void *p, const void *q) {
  const bravais_neighbour *a = p, *b = q;
  if (a->square != b->square) return a->square < b->square ? -1 : 1;
  if (a->layer != b->layer) return a->layer - b->layer;
  return a->row != b->row ? a->row - b->row : b->halves - a->halves;
}

static bool is_owned(int halves, int row, int layer) {
  return layer != 0 ? layer > 0 : row != 0 ? row > 0 : halves > 0;
}

/* The owned neighbours within `reach` spacings, in order; malloc'ed. */
static bravais_neighbour *collect(const bravais *b, double reach, int *count) {
  int most[3] = {0, 0, 0};
  for (int c = 0; c < b->axes; c++)
    most[c] = (int)floor(reach / sqrt(b->square[c]));
  const size_t room = (size_t)(2 * most[0] + 2) * (size_t)(2 * most[1] + 1) * (size_t)(most[2] + 1);
  bravais_neighbour *all = must_calloc(room, sizeof *all);
  *count = 0;
  for (int layer = 0; layer <= most[2]; layer++)
    for (int row = -most[1]; row <= most[1]; row++) {
      const int shift = bravais_shift(b, row, layer);
      for (int halves = -2 * most[0] - shift; halves <= 2 * most[0] + shift; halves += 2) {
        const double square = 0.25 * halves * halves * b->square[0] + row * row * b->square[1] +
                              layer * layer * b->square[2];
        if (square > reach * reach || !is_owned(halves, row, layer)) continue;
        all[(*count)++] = (bravais_neighbour){halves, row, layer, square, 0};
      }
    }
  qsort(all, (size_t)*count, sizeof *all, by_order);
  return all;
}

int bravais_family(const bravais *b, double horizon, int shells,
                   bravais_neighbour list[PL_MAX_DIRECTIONS]) {
  const double reach = horizon > 0 ? horizon * (1 + BRAVAIS_REACH_TOLERANCE) : FARTHEST_NEIGHBOUR;
  const int last = horizon > 0 ? INT32_MAX : shells > 0 ? shells : 1;
  int found, count = 0, shell = 0;
  bravais_neighbour *all = collect(b, pl_fmin(reach, FARTHEST_NEIGHBOUR), &found);
  for (int k = 0; k < found; k++) {
    shell += k == 0 || all[k].square > all[k - 1].square;
    if (shell > last) break;
    all[k].shell = shell;
    if (count < PL_MAX_DIRECTIONS) list[count] = all[k];
    count++;
  }
  free(all);
  return count;
}

void bravais_chord(const bravais *b, const bravais_neighbour *n, double chord[3]) {
  chord[0] = chord[1] = chord[2] = 0;
  add_steps(b, 0.5 * n->halves * b->step[0], n->row * b->step[1], n->layer * b->step[2], chord);
}

bool bravais_is_hexagon(const deck_lattice *l) {
  bravais_neighbour family[PL_MAX_DIRECTIONS];
  bravais b;
  return strcmp(l->kind, "hexagonal") == 0 && bravais_of(l, &b) &&
         bravais_family(&b, l->horizon, l->shells, family) == 3;
}
