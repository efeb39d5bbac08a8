#include "runtime/lattice/rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/base/hash.h"
#include "runtime/geometry/neighbour_search.h"
#include "runtime/geometry/shape.h"
#include "runtime/lattice/rows_parts.h"
#include "runtime/particles/site_marks.h"

#define CHORD_TOLERANCE 1e-9 /* spacings: a chord must enter a notch deeper than this to be cut */

enum { COLUMN, ROW, LAYER };

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

/* --- the lattice --------------------------------------------------------------------------------
 */

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
      grow(&b->reach[COLUMN], columns_to(&b->infinite, &n, shift));
      grow(&b->reach[COLUMN], columns_to(&b->infinite, &m, shift));
    }
    grow(&b->reach[ROW], n.row);
    grow(&b->reach[LAYER], n.layer);
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
    diag_hint(b->d,
              "the kinds are 'hexagonal' and 'square' in the plane, 'cubic' and 'fcc' in space");
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

/* --- storage ------------------------------------------------------------------------------------
 */

void *rows_array(long count, size_t each) {
  const size_t bytes = (size_t)count * each;
  const size_t whole = (bytes + PL_ALIGNMENT - 1) / PL_ALIGNMENT * PL_ALIGNMENT;
  void *p = aligned_alloc(PL_ALIGNMENT, whole);
  return p != NULL ? memset(p, 0, whole) : NULL;
}

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

/* Part of a neighbour's volume that lies within the horizon when its extent of a spacing along the bond counts. */
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

/* Numbers of a row in the infinite lattice. Empty rows before the first layer and behind the last go on with these. */
static void row_numbers(const rows *w, const builder *b, int row, long *number, long *layer) {
  const site_range *left = &b->marks.left;
  const long top = left->last[LAYER] - left->first[LAYER];
  const long rise = row < 0 ? 0 : row / w->layer_rows < top ? row / w->layer_rows : top;
  *layer = left->first[LAYER] + rise;
  *number = left->first[ROW] + row - rise * w->layer_rows;
}

bool rows_new_sites(rows *w) {
  w->bonds = rows_array(w->size, sizeof *w->bonds);
  w->held_bonds = rows_array(w->size, sizeof *w->held_bonds);
  w->held = rows_array(w->size, sizeof *w->held);
  w->present = rows_array(w->size, 1);
  w->x = rows_array(w->size, sizeof *w->x);
  w->y = rows_array(w->size, sizeof *w->y);
  if (w->dimensions == 3) w->z = rows_array(w->size, sizeof *w->z);
  w->site_particle = rows_array(w->size, sizeof *w->site_particle);
  return w->bonds && w->held_bonds && w->held && w->present && w->x && w->y &&
         (w->z || w->dimensions == 2) && w->site_particle;
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
  return b->marks.left.last[COLUMN] - b->marks.left.first[COLUMN] + 1;
}

/* The next row's absent sites serve a row's last columns, too. One column more stays empty: where rows are shifted
   against each other, an absent site beside one row would else be a neighbour of particles of another. */
static long pitch_with(const builder *b, long before) {
  return pitch_for(before + columns_of(b) + 1);
}

/* As many as neighbours reach; and whole lanes, so that rows begin with one, unless that makes rows longer. */
static long before_columns(const builder *b) {
  const long reach = b->reach[COLUMN], lanes = whole_lanes(reach);
  return pitch_with(b, lanes) > pitch_with(b, reach) ? reach : lanes;
}

static rows *rows_new(const builder *b) {
  const deck_lattice *l = b->lattice;
  const long *first = b->marks.left.first, *last = b->marks.left.last;
  const long per_layer = last[ROW] - first[ROW] + 1;
  const long layer_rows = per_layer + b->reach[ROW];
  const long row_count = (last[LAYER] - first[LAYER]) * layer_rows + per_layer;
  const long margin = b->reach[LAYER] * layer_rows + b->reach[ROW];
  const long pitch = pitch_with(b, b->before), ends = whole_lanes(b->reach[COLUMN]);
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
              .stiffness_thickness = l->stiffness_thickness};
  w->site_area = w->dimensions == 2 ? b->infinite.site_measure : 0;
  w->volume = b->infinite.site_measure * (w->dimensions == 2 ? l->mass_thickness : 1);
  set_directions(w, b);
  return allocate(w, b);
}

static void place_row(rows *w, const builder *b, int row) {
  const site_range *left = &b->marks.left;
  long number, layer;
  row_numbers(w, b, row, &number, &layer);
  w->row_class[row + w->margin] = (unsigned char)bravais_shift(&b->infinite, number, layer);
  const bool stored = row >= 0 && number >= left->first[ROW] && number <= left->last[ROW];
  for (long k = 0; k < w->pitch; k++) {
    const long column = left->first[COLUMN] + k - b->before, site = rows_start(w, row) + k;
    double at[3];
    bravais_place(&b->infinite, column, number, layer, at);
    w->x[site] = at[0];
    w->y[site] = at[1];
    if (w->z) w->z[site] = at[2];
    if (!stored || column < left->first[COLUMN] || column > left->last[COLUMN]) continue;
    w->present[site] = site_marks_stands(&b->marks, column, number, layer);
    w->particle_count += w->present[site];
  }
}

static void place_sites(rows *w, const builder *b) {
  for (int row = -w->margin; row < w->row_count + w->margin; row++)
    place_row(w, b, row);
}

void rows_find_extent(rows *w) {
  double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (long p = 0; p < w->particle_count; p++) {
    double at[3];
    rows_place(w, w->particle_site[p], at);
    for (int c = 0; c < 3; c++) {
      lower[c] = pl_fmin(lower[c], at[c]);
      upper[c] = pl_fmax(upper[c], at[c]);
    }
  }
  w->width = upper[0] - lower[0];
  w->height = upper[1] - lower[1];
  w->depth = upper[2] - lower[2];
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

void rows_count_bonds(rows *w) {
  w->bond_count = 0;
  for (long p = 0; p < w->particle_count; p++)
    w->bond_count += __builtin_popcountll(w->bonds[w->particle_site[p]]);
}

/* --- notches ------------------------------------------------------------------------------------
 */

static bool chord_cut(const rows *w, long site, int k, const deck_shape *shape) {
  double a[3], c[3];
  rows_place(w, site, a);
  rows_place(w, rows_partner(w, site, k), c);
  return shape_crossed(shape, a, c, CHORD_TOLERANCE * w->spacing);
}

static void cut_bond(rows *w, long site, int k) {
  const uint64_t bit = UINT64_C(1) << k;
  w->bonds[site] &= ~bit;
  if (w->list) w->list->incoming[rows_partner(w, site, k)] &= ~bit;
}

long rows_cut(rows *w, long site, const deck_shape *shape) {
  long count = 0;
  for (int k = 0; k < w->directions && w->present[site]; k++) {
    if (!w->present[rows_partner(w, site, k)] || !chord_cut(w, site, k, shape)) continue;
    cut_bond(w, site, k);
    count++;
  }
  return count;
}

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
  for (long layer = near.first[LAYER]; layer <= near.last[LAYER]; layer++)
    for (long row = near.first[ROW]; row <= near.last[ROW]; row++) {
      const long stored = (layer - left->first[LAYER]) * w->layer_rows + row - left->first[ROW];
      const long start = rows_start(w, (int)stored) + b->before - left->first[COLUMN];
      for (long column = near.first[COLUMN]; column <= near.last[COLUMN]; column++)
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

static void free_list(neighbour_list *l) {
  if (l == NULL) return;
  free(l->neighbour);
  free(l->incoming);
  free(l->length);
  for (int a = 0; a < 3; a++)
    free(l->chord[a]);
  free(l);
}

void rows_free(rows *w) {
  if (w == NULL) return;
  free_list(w->list);
  free(w->site_volume);
  free(w->site_mass);
  free(w->row_class);
  free(w->bonds);
  free(w->held_bonds);
  free(w->held);
  free(w->present);
  free(w->x);
  free(w->y);
  free(w->z);
  free(w->particle_site);
  free(w->site_particle);
  free(w);
}

int rows_degree(const rows *w, long site) {
  int count = __builtin_popcountll(w->bonds[site]);
  if (w->list) return count + __builtin_popcountll(w->list->incoming[site]);
  for (int k = w->directions; k < 2 * w->directions; k++)
    count += rows_has_neighbour(w, site, k);
  return count;
}

void rows_set_density(rows *w, double rho) {
  const double half = w->spacing / 2;
  w->mass = rho * w->volume;
  for (long q = 0; w->site_mass && q < w->size; q++)
    w->site_mass[q] = rho * w->site_volume[q];
  w->inertia = 0.4 * w->mass * half * half;
}

/* Bonds of a full family; on lists their mean. */
static double family_size(const rows *w) {
  if (!w->list) return 2 * w->directions;
  return round(2 * (double)w->bond_count / (double)w->particle_count);
}

pl_bond_class rows_bond_class(const rows *w, int direction) {
  const int k = direction % w->directions;
  const double sign = direction < w->directions || w->list ? 1 : -1;
  return (pl_bond_class){
      .s = w->length[k],
      .spacing = w->spacing,
      .t = w->stiffness_thickness,
      .V = w->volume,
      .mass_i = w->mass,
      .mass_j = w->mass,
      .shell = w->shell[k],
      .n = family_size(w),
      .chord = {sign * w->chord[k][0], sign * w->chord[k][1], sign * w->chord[k][2]},
      .horizon = w->horizon,
      .weight = w->weight[k]};
}

uint64_t rows_fingerprint(const rows *w) {
  uint64_t hash = HASH_START;
  if (!w->list) return 0;
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    double of[4] = {0, 0, 0, w->site_volume[site]};
    const uint64_t bonds[2] = {w->bonds[site], w->list->incoming[site]};
    rows_place(w, site, of);
    hash = hash_words(hash, of, 4);
    hash = hash_words(hash, bonds, 2);
  }
  return hash ? hash : 1;
}

const char *rows_place_text(int dimensions, const double at[3], char text[ROWS_PLACE_TEXT]) {
  if (dimensions == 2)
    snprintf(text, ROWS_PLACE_TEXT, "(%.6g, %.6g) mm", 1e3 * at[0], 1e3 * at[1]);
  else
    snprintf(text, ROWS_PLACE_TEXT, "(%.6g, %.6g, %.6g) mm", 1e3 * at[0], 1e3 * at[1], 1e3 * at[2]);
  return text;
}

/* --- regions ------------------------------------------------------------------------------------
 */

static long select_nearest(const rows *w, const deck_shape *shape, int32_t *list) {
  double best = INFINITY;
  for (long p = 0; p < w->particle_count; p++) {
    double at[3];
    rows_place(w, w->particle_site[p], at);
    const double distance = bravais_distance(at, shape->at);
    if (distance >= best - SITE_TIE_TOLERANCE * w->spacing) continue;
    best = distance;
    list[0] = (int32_t)p;
  }
  return best <= site_point_reach(shape, w->spacing) ? 1 : 0;
}

long rows_select(const rows *w, const deck_shape *shape, int32_t **list) {
  int32_t *chosen = must_alloc((size_t)w->particle_count * sizeof *chosen);
  long count = 0;
  *list = chosen;
  if (shape->kind == SHAPE_POINT) return select_nearest(w, shape, chosen);
  for (long p = 0; p < w->particle_count; p++) {
    double at[3];
    rows_place(w, w->particle_site[p], at);
    if (shape_contains(shape, at, SITE_OUTLINE_TOLERANCE * w->spacing))
      chosen[count++] = (int32_t)p;
  }
  return count;
}

void rows_bodies(const rows *w, const deck *k, int lattice, int32_t *body) {
  memset(body, 0, (size_t)w->particle_count * sizeof *body);
  for (int b = k->body_count - 1; b >= 0; b--) { /* the first has the last word */
    if (strcmp(k->bodys[b].lattice, k->lattices[lattice].name) != 0) continue;
    int32_t *list;
    const long count = rows_select(w, &k->bodys[b].shape, &list);
    for (long p = 0; p < count; p++)
      body[list[p]] = b;
    free(list);
  }
}

/* Columns of the row within `reach` (m) of the site: +1 at the first, -1 behind the last. */
static void add_interval(const rows *w, long site, int row, double reach, int32_t *steps) {
  const double *step = w->infinite.step;
  const int own = rows_row(w, site);
  const double across = (row % w->layer_rows - own % w->layer_rows) * step[ROW];
  const double above = (row / w->layer_rows - own / w->layer_rows) * step[LAYER];
  const double square = across * across + above * above;
  if (square > reach * reach) return;
  const double half = sqrt(reach * reach - square) / step[COLUMN];
  const int shift = w->row_class[row + w->margin] - w->row_class[own + w->margin];
  const double middle = (double)(site - rows_start(w, own)) - 0.5 * shift;
  const double first = pl_fmax(ceil(middle - half), 0);
  const double last = pl_fmin(floor(middle + half), (double)w->pitch - 1);
  if (first > last) return;
  steps[rows_start(w, row) + (long)first]++;
  steps[rows_start(w, row) + (long)last + 1]--;
}

static int steps_within(double reach, double step, int most) {
  return step > 0 ? (int)pl_fmin(ceil(reach / step), most) : 0;
}

/* On lists. */
static unsigned char *mark_points_near(const rows *w, const int32_t *particles, long count,
                                       double reach) {
  const point_cloud all = {w->dimensions, w->size, {w->x, w->y, w->z}};
  unsigned char *near = must_calloc((size_t)w->size, 1);
  int32_t *sites = must_alloc(((size_t)count + 1) * sizeof *sites);
  for (long p = 0; p < count; p++)
    sites[p] = w->particle_site[particles[p]];
  points_near(&all, sites, count, reach, near);
  free(sites);
  return near;
}

/* Sites within `reach` of the particles; intervals a row, so that a wide reach costs rows and not sites. */
static unsigned char *mark_near(const rows *w, const int32_t *particles, long count, double reach) {
  int32_t *steps = must_calloc((size_t)w->size + 1, sizeof *steps);
  unsigned char *near = must_calloc((size_t)w->size, 1);
  const int rise = steps_within(reach, w->infinite.step[ROW], w->layer_rows);
  const int climb = steps_within(reach, w->infinite.step[LAYER], w->row_count / w->layer_rows);
  for (long p = 0; p < count; p++) {
    const long site = w->particle_site[particles[p]];
    const int own = rows_row(w, site), in_layer = own % w->layer_rows;
    for (int layer = own - in_layer - climb * w->layer_rows;
         layer <= own - in_layer + climb * w->layer_rows; layer += w->layer_rows)
      for (int row = in_layer - rise; row <= in_layer + rise; row++)
        if (row >= 0 && row < w->layer_rows && layer >= 0 && layer + row < w->row_count)
          add_interval(w, site, layer + row, reach, steps);
  }
  int32_t depth = 0;
  for (long site = 0; site < w->size; site++) {
    depth += steps[site];
    near[site] = depth > 0;
  }
  free(steps);
  return near;
}

void rows_protect(rows *w, const int32_t *particles, long count, double radius) {
  const double reach = pl_fmax(radius, 0) + SITE_OUTLINE_TOLERANCE * w->spacing;
  unsigned char *near = w->list ? mark_points_near(w, particles, count, reach)
                                : mark_near(w, particles, count, reach);
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    if (near[site]) w->held[site] = 1;
    for (int k = 0; k < w->directions; k++)
      if (rows_has_bond(w, site, k) && (near[site] || near[rows_partner(w, site, k)]))
        w->held_bonds[site] |= UINT64_C(1) << k;
  }
  free(near);
}

rows_bond *rows_bonds(const rows *w) {
  rows_bond *bonds = must_alloc(((size_t)w->bond_count + 1) * sizeof *bonds);
  long next = 0;
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    for (int k = 0; k < w->directions; k++) {
      if (!rows_has_bond(w, site, k)) continue;
      bonds[next++] = (rows_bond){.i = (int32_t)p,
                                  .j = w->site_particle[rows_partner(w, site, k)],
                                  .slot = (int64_t)k * w->size + site};
    }
  }
  return bonds;
}
