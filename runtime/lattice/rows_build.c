#include "runtime/lattice/rows_build.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "runtime/geometry/shape.h"
#include "runtime/particles/site_marks.h"

typedef struct builder {
  const deck *deck;
  const deck_lattice *lattice;
  bravais infinite;
  bravais_neighbour family[PL_MAX_DIRECTIONS];
  int directions;
  int reach[3]; /* columns, rows, layers to the farthest neighbour in each */
  long before;  /* absent sites before the first column of a row */
  site_marks marks;
  diagnostics *d;
} builder;

/* --- the lattice ------------------------------------------------------------------------------ */

/* Columns from a site of a row with that shift to its neighbour. */
static int columns_to(const bravais *b, const bravais_neighbour *n, int shift) {
  const int there = (shift + bravais_shift(b, n->row, n->layer)) & 1;
  return (n->halves + shift - there) / 2;
}

static bravais_neighbour opposite(bravais_neighbour n) {
  return (bravais_neighbour){-n.halves, -n.row, -n.layer, n.square, n.shell};
}

static void grow(int *reach, int steps) {
  if (abs(steps) > *reach) *reach = abs(steps);
}

static void find_reach(builder *b) {
  for (int k = 0; k < b->directions; k++) {
    const bravais_neighbour n = b->family[k], m = opposite(n);
    for (int shift = 0; shift < ROWS_CLASSES; shift++) {
      grow(&b->reach[BRAVAIS_COLUMN], columns_to(&b->infinite, &n, shift));
      grow(&b->reach[BRAVAIS_COLUMN], columns_to(&b->infinite, &m, shift));
    }
    grow(&b->reach[BRAVAIS_ROW], n.row);
    grow(&b->reach[BRAVAIS_LAYER], n.layer);
  }
}

static bool family_is_sound(builder *b) {
  const deck_lattice *l = b->lattice;
  const char *key = l->horizon > 0 ? "horizon" : "shells";
  b->directions = bravais_family(&b->infinite, l->horizon, l->shells, b->family);
  if (b->directions == 0) {
    diag_report(b->d, DIAG_OUT_OF_BOUNDS, deck_where(&l->item, "horizon"),
                "a horizon of %.6g spacings reaches no neighbour", l->horizon);
    return false;
  }
  if (b->directions <= PL_MAX_DIRECTIONS) return true;
  diag_report(b->d, DIAG_OUT_OF_BOUNDS, deck_where(&l->item, key),
              "with this `%s` a particle has more than %d neighbours, the most there can be", key,
              ROWS_MAX_NEIGHBOURS);
  return false;
}

static bool lattice_is_sound(builder *b) {
  const deck_lattice *l = b->lattice;
  if (!bravais_of(l, &b->infinite)) {
    diag_report(b->d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "kind"),
                "there is no lattice of kind '%s'", l->kind);
    diag_hint(b->d, "the kinds that have sites are %s", LATTICE_KINDS_OF_SITES);
    return false;
  }
  if (!(l->spacing > 0) || !isfinite(l->spacing)) {
    diag_report(b->d, DIAG_BAD_VALUE, deck_where(&l->item, "spacing"),
                "the spacing of a lattice must be positive");
    return false;
  }
  if (!family_is_sound(b)) return false;
  find_reach(b);
  return true;
}

/* --- storage ---------------------------------------------------------------------------------- */

static long whole_lanes(long columns) {
  return (columns + PL_LANES - 1) / PL_LANES * PL_LANES;
}

/* Rows a multiple of 4 KiB apart would share one cache set. */
static long pitch_for(long columns) {
  const long pitch = whole_lanes(columns);
  return pitch % 512 == 0 ? pitch + PL_LANES : pitch;
}

/* In spacings: as the deck says, or the distance of the last shell. */
static double horizon_of(const builder *b) {
  return b->lattice->horizon > 0 ? b->lattice->horizon : sqrt(b->family[b->directions - 1].square);
}

/* Part of a neighbour's volume that lies within the horizon when its extent of a spacing along the
   bond counts. */
static double weight_of(const builder *b, double length) {
  const double horizon = horizon_of(b);
  if (b->lattice->volume_correction == VOLUME_WHOLE) return 1;
  return pl_fmin(pl_fmax(horizon + 0.5 - length, 0), 1);
}

static void set_directions(rows *w, const builder *b) {
  w->directions = b->directions;
  w->horizon = horizon_of(b) * w->spacing;
  for (int k = 0; k < w->directions; k++) {
    const bravais_neighbour n = b->family[k], pair[2] = {n, opposite(n)};
    const double length = sqrt(n.square);
    bravais_chord(&b->infinite, &n, w->chord[k]);
    w->length[k] = length * w->spacing;
    w->weight[k] = weight_of(b, length);
    w->shell[k] = n.shell;
    for (int end = 0; end < 2; end++)
      for (int shift = 0; shift < ROWS_CLASSES; shift++)
        w->offset[shift][k + end * w->directions] =
            ((long)pair[end].layer * w->layer_rows + pair[end].row) * w->pitch +
            columns_to(&b->infinite, &pair[end], shift);
  }
}

/* Numbers of a row in the infinite lattice. Empty rows before the first layer and behind the last
   go on with these. */
static void row_numbers(const rows *w, const builder *b, int row, long *number, long *layer) {
  const site_range *left = &b->marks.left;
  const long top = left->last[BRAVAIS_LAYER] - left->first[BRAVAIS_LAYER];
  const long rise = row < 0 ? 0 : row / w->layer_rows < top ? row / w->layer_rows : top;
  *layer = left->first[BRAVAIS_LAYER] + rise;
  *number = left->first[BRAVAIS_ROW] + row - rise * w->layer_rows;
}

static rows *allocate(rows *w, const builder *b) {
  w->row_class = must_calloc((size_t)(w->row_count + 2 * w->margin), 1);
  if (rows_new_sites(w)) return w;
  diag_report(b->d, DIAG_OUT_OF_BOUNDS, deck_where(&b->lattice->item, "spacing"),
              "there is not enough memory for %ld sites", w->size);
  rows_free(w);
  return NULL;
}

static long columns_of(const builder *b) {
  return b->marks.left.last[BRAVAIS_COLUMN] - b->marks.left.first[BRAVAIS_COLUMN] + 1;
}

/* The next row's absent sites serve a row's last columns, too. One column more stays empty: where
   rows are shifted against each other, an absent site beside one row would else be a neighbour of
   particles of another. */
static long pitch_with(const builder *b, long before) {
  return pitch_for(before + columns_of(b) + 1);
}

/* As many as neighbours reach; and whole lanes, so that rows begin with one, unless that makes rows
   longer. */
static long before_columns(const builder *b) {
  const long reach = b->reach[BRAVAIS_COLUMN], lanes = whole_lanes(reach);
  return pitch_with(b, lanes) > pitch_with(b, reach) ? reach : lanes;
}

/* What a site's share of the lattice is multiplied by to be a volume. */
static double section_of(const builder *b) {
  return b->infinite.axes == 1   ? b->lattice->area
         : b->infinite.axes == 2 ? b->lattice->mass_thickness
                                 : 1;
}

static rows *rows_new(const builder *b) {
  const deck_lattice *l = b->lattice;
  const long *first = b->marks.left.first, *last = b->marks.left.last;
  const long per_layer = last[BRAVAIS_ROW] - first[BRAVAIS_ROW] + 1;
  const long layer_rows = per_layer + b->reach[BRAVAIS_ROW];
  const long row_count = (last[BRAVAIS_LAYER] - first[BRAVAIS_LAYER]) * layer_rows + per_layer;
  const long margin = b->reach[BRAVAIS_LAYER] * layer_rows + b->reach[BRAVAIS_ROW];
  const long pitch = pitch_with(b, b->before), ends = whole_lanes(b->reach[BRAVAIS_COLUMN]);
  const double size = ((double)row_count + 2 * (double)margin) * (double)pitch + 2 * (double)ends;
  if (site_too_many(l, size, b->d)) return NULL;
  rows *w = must_calloc(1, sizeof *w);
  *w = (rows){.infinite = b->infinite,
              .dimensions = b->infinite.dimensions,
              .row_count = (int)row_count,
              .layer_rows = (int)layer_rows,
              .margin = (int)margin,
              .pitch = pitch,
              .first = margin * pitch + ends,
              .size = (long)size,
              .spacing = l->spacing,
              .stiffness_thickness = l->stiffness_thickness,
              .area = l->area};
  w->site_area = b->infinite.axes == 2 ? b->infinite.site_measure : 0;
  w->volume = b->infinite.site_measure * section_of(b);
  set_directions(w, b);
  return allocate(w, b);
}

static void place_row(rows *w, const builder *b, int row) {
  const site_range *left = &b->marks.left;
  long number, layer;
  row_numbers(w, b, row, &number, &layer);
  w->row_class[row + w->margin] = (unsigned char)bravais_shift(&b->infinite, number, layer);
  const bool stored =
      row >= 0 && number >= left->first[BRAVAIS_ROW] && number <= left->last[BRAVAIS_ROW];
  for (long k = 0; k < w->pitch; k++) {
    const long column = left->first[BRAVAIS_COLUMN] + k - b->before, site = rows_start(w, row) + k;
    double at[3];
    bravais_place(&b->infinite, column, number, layer, at);
    w->x[site] = at[0];
    w->y[site] = at[1];
    if (w->z) w->z[site] = at[2];
    if (!stored || column < left->first[BRAVAIS_COLUMN] || column > left->last[BRAVAIS_COLUMN])
      continue;
    w->present[site] = site_marks_stands(&b->marks, column, number, layer);
    w->particle_count += w->present[site];
  }
}

static void place_sites(rows *w, const builder *b) {
  for (int row = -w->margin; row < w->row_count + w->margin; row++)
    place_row(w, b, row);
}

static void number_particles(rows *w) {
  int32_t next = 0;
  w->particle_site = must_alloc((size_t)w->particle_count * sizeof *w->particle_site);
  for (long site = 0; site < w->size; site++) {
    w->site_particle[site] = w->present[site] ? next : -1;
    if (w->present[site]) w->particle_site[next++] = (int32_t)site;
  }
  rows_find_extent(w);
}

/* To the neighbours of a site. */
static const long *offsets_of(const rows *w, long site) {
  return w->offset[w->row_class[rows_row(w, site) + w->margin]];
}

static void join_neighbours(rows *w) {
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    const long *offset = offsets_of(w, site);
    for (int k = 0; k < w->directions; k++)
      w->bonds[site] |= (uint64_t)w->present[site + offset[k]] << k;
  }
}

/* --- notches ---------------------------------------------------------------------------------- */

static long cut_bonds(rows *w, const builder *b, const deck_shape *shape) {
  const site_range *left = &b->marks.left;
  site_range near;
  long count = 0;
  if (!site_range_of(&b->infinite, shape, &near)) return 0;
  for (int c = 0; c < 3; c++) { /* owners lie this far away */
    near.first[c] -= b->reach[c];
    near.last[c] += b->reach[c];
  }
  site_range_clip(&near, left);
  for (long layer = near.first[BRAVAIS_LAYER]; layer <= near.last[BRAVAIS_LAYER]; layer++)
    for (long row = near.first[BRAVAIS_ROW]; row <= near.last[BRAVAIS_ROW]; row++) {
      const long stored =
          (layer - left->first[BRAVAIS_LAYER]) * w->layer_rows + row - left->first[BRAVAIS_ROW];
      const long start = rows_start(w, (int)stored) + b->before - left->first[BRAVAIS_COLUMN];
      for (long column = near.first[BRAVAIS_COLUMN]; column <= near.last[BRAVAIS_COLUMN]; column++)
        count += rows_cut(w, start + column, shape);
    }
  return count;
}

static void cut_notches(rows *w, const builder *b) {
  for (int k = 0; k < b->deck->notch_count; k++) {
    const deck_notch *notch = &b->deck->notchs[k];
    if (!site_of_lattice(b->lattice, notch->lattice)) continue;
    const long cut = notch->cut_bonds ? cut_bonds(w, b, &notch->shape) : 0;
    if (b->marks.removed[k] + cut > 0) continue;
    diag_report(b->d, DIAG_DECK_WARNING, notch->item.where,
                "the notch removes no particle%s of lattice '%s'",
                notch->cut_bonds ? " and cuts no bond" : "", b->lattice->name);
  }
}

/* Points may stand alone; another body without a bond is a slip. */
static bool has_bonds(const rows *w, const builder *b) {
  bool extended = false;
  for (int k = 0; k < b->deck->body_count; k++)
    extended = extended || (site_of_lattice(b->lattice, b->deck->bodys[k].lattice) &&
                            b->deck->bodys[k].shape.kind != SHAPE_POINT);
  if (!extended) return true;
  for (long p = 0; p < w->particle_count; p++)
    if (w->bonds[w->particle_site[p]]) return true;
  diag_report(
      b->d, DIAG_OUT_OF_BOUNDS, deck_where(&b->lattice->item, "spacing"),
      "no two particles of lattice '%s' are neighbours: its spacing of %.6g mm is too large "
      "for its bodies",
      b->lattice->name, 1e3 * w->spacing);
  diag_hint(b->d, "a number without a unit is in m; millimetres are written '6.35 mm'");
  return false;
}

rows *rows_build(const deck *k, int lattice, diagnostics *d) {
  builder b = {.deck = k, .lattice = &k->lattices[lattice], .d = d};
  if (!lattice_is_sound(&b)) return NULL;
  rows *w = NULL;
  if (site_marks_make(&b.marks, &b.infinite, k, b.lattice, d)) {
    b.before = before_columns(&b);
    w = rows_new(&b);
  }
  if (w) {
    place_sites(w, &b);
    number_particles(w);
    join_neighbours(w);
    if (!has_bonds(w, &b)) {
      rows_free(w);
      w = NULL;
    }
  }
  if (w) {
    cut_notches(w, &b);
    rows_count_bonds(w);
  }
  site_marks_free(&b.marks);
  return w;
}
