#include "runtime/lattice/scattered.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/hilbert.h"
#include "runtime/geometry/shape.h"
#include "runtime/lattice/bond_numbers.h"
#include "runtime/lattice/bond_ways.h"
#include "runtime/lattice/list_lines.h"
#include "runtime/lattice/list_ways.h"
#include "runtime/lattice/shape_matrix.h"
#include "runtime/particles/gradation.h"
#include "runtime/particles/particle_set.h"
#include "runtime/particles/site_marks.h"

enum { ROW_SITES = 512 };

/* --- particles to sites ----------------------------------------------------------------------- */

typedef struct builder {
  const scattered *from;
  int32_t *order; /* [count] particles along the curve */
  double *at[3];  /* [count] their places, in that order */
  point_cloud points;
  point_pairs pairs; /* of these */
  bond_ways ways;    /* of these; without `of` where most have their own */
  int32_t *site;     /* [count] of the particles in that order */
  long pitch, row_count;
  unsigned char *is_line; /* [row_count] the row is a line; NULL: there are none */
  rows *rows;
} builder;

/* Where missing neighbours of the site stand. */
static long absent_of(const rows *w, long site) {
  return site / w->pitch * w->pitch + w->pitch - 1;
}

static void order_points(builder *b) {
  const point_cloud *given = &b->from->points;
  const size_t n = (size_t)given->count + 1;
  b->order = must_alloc(n * sizeof *b->order);
  hilbert_order(given, b->order);
  b->points = *given;
  for (int a = 0; a < given->dimensions; a++) {
    b->points.at[a] = b->at[a] = must_alloc(n * sizeof(double));
    for (long r = 0; r < given->count; r++)
      b->at[a][r] = given->at[a][b->order[r]];
  }
}

static void free_builder(builder *b) {
  for (int a = 0; a < 3; a++)
    free(b->at[a]);
  free(b->order);
  free(b->site);
  free(b->is_line);
  free(b->pairs.items);
  bond_ways_free(&b->ways);
}

/* Summed along the curve: the same to the last bit for other numbers. */
static double mean_measure(const builder *b) {
  double sum = 0;
  for (long r = 0; r < b->points.count; r++)
    sum += b->from->measure[b->order[r]];
  return sum / (double)b->points.count;
}

/* Of a disc or a sphere of so many particles. */
static double radius_of(int dimensions, double measure) {
  return dimensions == 2 ? sqrt(measure / M_PI) : pl_cbrt(0.75 * measure / M_PI);
}

static double longest_given(const scattered *from) {
  double longest = 0;
  for (long k = 0; k < from->bond_count; k++) {
    double square = 0;
    for (int a = 0; a < from->points.dimensions; a++) {
      const double *at = from->points.at[a];
      const double way = at[from->bonds[k].j] - at[from->bonds[k].i];
      square += way * way;
    }
    longest = pl_fmax(longest, sqrt(square));
  }
  return longest;
}

static double horizon_of(const builder *b) {
  if (b->from->horizon > 0) return b->from->horizon;
  if (b->from->bonds) return longest_given(b->from);
  const int dimensions = b->points.dimensions;
  const double each =
      b->from->own_size ? particle_measure(dimensions, b->from->spacing) : mean_measure(b);
  return radius_of(dimensions, (b->from->neighbours + 1) * each);
}

static bool allocate(rows *w, bool graded) {
  const long planes = 2 * (long)w->directions * w->size;
  neighbour_list *l = w->list = must_calloc(1, sizeof *l);
  w->row_class = must_calloc((size_t)w->row_count + 1, 1);
  l->neighbour = rows_array(planes, sizeof *l->neighbour);
  l->incoming = rows_array(w->size, sizeof *l->incoming);
  l->length = rows_array(planes, sizeof *l->length);
  w->site_volume = rows_array(w->size, sizeof *w->site_volume);
  w->site_mass = rows_array(w->size, sizeof *w->site_mass);
  if (graded) w->own_size = rows_array(w->size, sizeof *w->own_size);
  bool good = l->neighbour && l->incoming && l->length && w->site_volume && w->site_mass &&
              (!graded || w->own_size);
  for (int a = 0; a < w->dimensions; a++)
    good = (l->chord[a] = rows_array(planes, sizeof(double))) && good;
  return rows_new_sites(w) && good;
}

/* Without bonds there still is one number, so that no array is empty. */
static bool new_rows(builder *b, int numbers) {
  const scattered *from = b->from;
  const bool plane = from->points.dimensions == 2 && from->area == 0;
  const double measure = mean_measure(b);
  rows *w = b->rows = must_calloc(1, sizeof *w);
  *w = (rows){.infinite = {.dimensions = from->points.dimensions, .spacing = from->spacing},
              .dimensions = from->points.dimensions,
              .row_count = (int)b->row_count,
              .layer_rows = (int)b->row_count,
              .pitch = b->pitch,
              .size = b->row_count * b->pitch,
              .directions = numbers > 0 ? numbers : 1,
              .horizon = horizon_of(b),
              .spacing = from->spacing,
              .volume = measure * (plane ? from->mass_thickness : 1),
              .site_area = plane ? measure : 0,
              .stiffness_thickness = plane ? from->stiffness_thickness : 0,
              .area = from->area,
              .particle_count = from->points.count};
  for (int k = 0; k < w->directions; k++) { /* what laws are told of all bonds together */
    w->chord[k][0] = w->length[k] = from->spacing;
    w->weight[k] = w->shell[k] = 1;
  }
  return allocate(w, from->own_size != NULL);
}

static void place_particles(builder *b) {
  rows *w = b->rows;
  const double thickness = w->site_area > 0 ? b->from->mass_thickness : 1;
  double *const at[3] = {w->x, w->y, w->z};
  w->particle_site = must_alloc(((size_t)w->particle_count + 1) * sizeof *w->particle_site);
  for (long q = 0; q < w->size; q++) {
    w->site_particle[q] = -1;
    w->site_volume[q] = w->volume; /* of absent sites, so that nothing is divided by 0 */
    if (w->own_size) w->own_size[q] = 1;
    for (int a = 0; a < w->dimensions; a++)
      at[a][q] = b->at[a][0];
  }
  for (long r = 0; r < w->particle_count; r++) {
    const long site = b->site[r];
    const int32_t particle = b->order[r];
    w->present[site] = 1;
    w->site_particle[site] = particle;
    w->particle_site[particle] = (int32_t)site;
    w->site_volume[site] = b->from->measure[particle] * thickness;
    if (w->own_size) w->own_size[site] = b->from->own_size[particle];
    if (w->own_size) w->largest_size = pl_fmax(w->largest_size, w->own_size[site]);
    for (int a = 0; a < w->dimensions; a++)
      at[a][site] = b->at[a][r];
  }
  rows_find_extent(w);
}

/* --- bonds ------------------------------------------------------------------------------------ */

/* As if no neighbour were there. */
static void clear_neighbours(rows *w) {
  for (long k = 0; k < 2 * w->directions; k++)
    for (long q = 0; q < w->size; q++) {
      w->list->neighbour[k * w->size + q] = (int32_t)(absent_of(w, q) - q);
      w->list->length[k * w->size + q] = w->list->chord[0][k * w->size + q] = w->spacing;
    }
}

static void set_neighbour(rows *w, long here, long there, int number, const double chord[3],
                          double sign) {
  const long slot = number * w->size + here;
  double square = 0;
  for (int a = 0; a < w->dimensions; a++) {
    w->list->chord[a][slot] = sign * chord[a];
    square += chord[a] * chord[a];
  }
  w->list->length[slot] = sqrt(square);
  w->list->neighbour[slot] = (int32_t)(there - here);
}

/* From owner to other; that of its way, where there is one. */
static void chord_of(const builder *b, long bond, long owner, long other, double chord[3]) {
  const int way = b->ways.of ? abs(b->ways.of[bond]) - 1 : -1;
  double from[3], to[3], along = 0;
  rows_place(b->rows, owner, from);
  rows_place(b->rows, other, to);
  for (int a = 0; a < 3; a++) {
    chord[a] = to[a] - from[a];
    along += way < 0 ? 0 : chord[a] * b->ways.chord[way][a];
  }
  for (int a = 0; a < 3 && way >= 0; a++)
    chord[a] = along < 0 ? -b->ways.chord[way][a] : b->ways.chord[way][a];
}

static void join_neighbours(builder *b, const numbered_bond *bonds) {
  rows *w = b->rows;
  clear_neighbours(w);
  for (long m = 0; m < b->pairs.count; m++) {
    const long owner = b->site[bonds[m].owner], other = b->site[bonds[m].other];
    const uint64_t bit = UINT64_C(1) << bonds[m].number;
    double chord[3];
    chord_of(b, m, owner, other, chord);
    w->bonds[owner] |= bit;
    w->list->incoming[other] |= bit;
    set_neighbour(w, owner, other, bonds[m].number, chord, 1);
    set_neighbour(w, other, owner, bonds[m].number + w->directions, chord, -1);
  }
  w->bond_count = b->pairs.count;
}

typedef struct packed { /* a particle of a row, by the numbers of its bonds */
  int32_t rank;
  int highest;
} packed;

static int by_highest(const void *a, const void *b) {
  const packed *p = a, *q = b;
  if (p->highest != q->highest) return p->highest < q->highest ? -1 : 1;
  return p->rank < q->rank ? -1 : 1;
}

/* Particles along the curve change places: that now at place r was p[r].rank. */
static void renumber(builder *b, const packed *p, int32_t *moved) {
  const size_t n = (size_t)b->points.count + 1;
  int32_t *order = must_alloc(n * sizeof *order);
  for (long r = 0; r < b->points.count; r++) {
    moved[p[r].rank] = (int32_t)r;
    order[r] = b->order[p[r].rank];
  }
  free(b->order);
  b->order = order;
  for (int a = 0; a < b->points.dimensions; a++)
    for (long r = 0; r < b->points.count; r++)
      b->at[a][r] = b->from->points.at[a][order[r]];
}

/* Particles take their places p[] along the curve, and bonds go with them. */
static void move_particles(builder *b, const packed *p, numbered_bond *bonds) {
  int32_t *moved = must_alloc(((size_t)b->points.count + 1) * sizeof *moved);
  renumber(b, p, moved);
  for (long m = 0; m < b->pairs.count; m++) {
    bonds[m].owner = moved[bonds[m].owner];
    bonds[m].other = moved[bonds[m].other];
  }
  free(moved);
}

/* The highest number that a particle has a bond of. */
static void find_highest(const builder *b, const numbered_bond *bonds, int32_t *highest) {
  for (long m = 0; m < b->pairs.count; m++) {
    int32_t *const ends[] = {&highest[bonds[m].owner], &highest[bonds[m].other]};
    for (int side = 0; side < 2; side++)
      if (bonds[m].number > *ends[side]) *ends[side] = bonds[m].number;
  }
}

/* Particles of a row that need as many numbers stand together: loops over some of them leave out
   the numbers that none of these has. */
static void pack_rows(builder *b, numbered_bond *bonds) {
  const long count = b->points.count;
  packed *p = must_alloc(((size_t)count + 1) * sizeof *p);
  int32_t *highest = must_calloc((size_t)count + 1, sizeof *highest);
  find_highest(b, bonds, highest);
  for (long r = 0; r < count; r++)
    p[r] = (packed){(int32_t)r, highest[r]};
  for (long r = 0; r < count; r += ROW_SITES)
    qsort(p + r, (size_t)(count - r < ROW_SITES ? count - r : ROW_SITES), sizeof *p, by_highest);
  move_particles(b, p, bonds);
  free(highest);
  free(p);
}

static void place_in_rows(builder *b) {
  b->pitch = ROW_SITES + PL_LANES;
  b->row_count = (b->points.count + ROW_SITES - 1) / ROW_SITES;
  for (long r = 0; r < b->points.count; r++)
    b->site[r] = (int32_t)(r / ROW_SITES * b->pitch + r % ROW_SITES);
}

/* --- lines as rows ---------------------------------------------------------------------------- */

static void stand_in_lines(builder *b, const list_lines *l, numbered_bond *bonds) {
  const size_t count = (size_t)b->points.count + 1;
  packed *p = must_calloc(count, sizeof *p);
  int32_t *highest = must_calloc(count, sizeof *highest);
  for (long r = 0; r < b->points.count; r++)
    p[r].rank = l->order[r];
  move_particles(b, p, bonds);
  find_highest(b, bonds, highest);
  b->pitch = l->pitch;
  b->row_count = list_lines_place(l, highest, b->ways.common, b->site, &b->is_line);
  free(highest);
  free(p);
}

/* Particles with bonds that go no common way. */
static long count_aside(const builder *b, const numbered_bond *bonds) {
  int32_t *highest = must_calloc((size_t)b->points.count + 1, sizeof *highest);
  long aside = 0;
  find_highest(b, bonds, highest);
  for (long r = 0; r < b->points.count; r++)
    aside += highest[r] >= b->ways.common;
  free(highest);
  return aside;
}

/* Where most bonds go common ways and lines pay: bonds by their ways, particles in lines. Returns
   how many numbers there are, or 0: nothing is done. */
static int line_up(builder *b, numbered_bond *bonds) {
  if (!bond_ways_find(&b->points, &b->pairs, b->from->spacing, &b->ways)) return 0;
  int numbers = bond_numbers_by_ways(&b->pairs, b->points.count, &b->ways, bonds);
  if (numbers > 0) {
    list_lines l = list_lines_find(&b->ways, &b->points, b->from->spacing);
    if (list_lines_pay(&l, b->points.count, count_aside(b, bonds)))
      stand_in_lines(b, &l, bonds);
    else
      numbers = 0;
    list_lines_free(&l);
  }
  if (numbers == 0) bond_ways_free(&b->ways);
  return numbers;
}

static int by_rank(const void *a, const void *b) {
  const point_pair *p = a, *q = b;
  if (p->i != q->i) return p->i < q->i ? -1 : 1;
  return p->j < q->j ? -1 : p->j > q->j;
}

/* Those given, of ranks along the curve and in their order: nothing depends on numbers. */
static point_pairs given_pairs(const builder *b) {
  const scattered *from = b->from;
  point_pairs pairs = {.count = from->bond_count, .crowded = -1};
  int32_t *rank = must_alloc(((size_t)from->points.count + 1) * sizeof *rank);
  pairs.items = must_alloc(((size_t)pairs.count + 1) * sizeof *pairs.items);
  for (long r = 0; r < from->points.count; r++)
    rank[b->order[r]] = (int32_t)r;
  for (long k = 0; k < pairs.count; k++) {
    const int32_t i = rank[from->bonds[k].i], j = rank[from->bonds[k].j];
    pairs.items[k] = (point_pair){i < j ? i : j, i < j ? j : i};
  }
  qsort(pairs.items, (size_t)pairs.count, sizeof *pairs.items, by_rank);
  free(rank);
  return pairs;
}

static point_pairs pairs_by_sizes(const builder *b) {
  double *reach = must_alloc(((size_t)b->points.count + 1) * sizeof *reach);
  for (long r = 0; r < b->points.count; r++)
    reach[r] = b->from->horizon * b->from->own_size[b->order[r]];
  const point_pairs pairs = pairs_within_own(&b->points, reach, ROWS_MAX_NEIGHBOURS);
  free(reach);
  return pairs;
}

static point_pairs find_pairs(const builder *b) {
  const scattered *from = b->from;
  if (from->bonds) return given_pairs(b);
  if (from->horizon > 0 && from->own_size) return pairs_by_sizes(b);
  return from->horizon > 0 ? pairs_within(&b->points, from->horizon, ROWS_MAX_NEIGHBOURS)
                           : pairs_of_nearest(&b->points, from->neighbours, ROWS_MAX_NEIGHBOURS);
}

rows *scattered_rows(const scattered *from, long *crowded) {
  builder b = {.from = from};
  *crowded = -1;
  order_points(&b);
  b.pairs = find_pairs(&b);
  if (b.pairs.crowded >= 0) {
    *crowded = b.order[b.pairs.crowded];
    free_builder(&b);
    return NULL;
  }
  if (b.pairs.count > INT32_MAX) { /* bonds have 32-bit numbers */
    free_builder(&b);
    return NULL;
  }
  numbered_bond *bonds = must_alloc(((size_t)b.pairs.count + 1) * sizeof *bonds);
  b.site = must_alloc(((size_t)b.points.count + 1) * sizeof *b.site);
  int numbers = line_up(&b, bonds);
  if (numbers == 0) {
    numbers = bond_numbers(&b.pairs, b.points.count, bonds);
    pack_rows(&b, bonds);
    place_in_rows(&b);
  }
  const bool good = new_rows(&b, numbers);
  if (good) {
    place_particles(&b);
    join_neighbours(&b, bonds);
    if (b.is_line) list_ways_find(b.rows, b.is_line);
  } else {
    rows_free(b.rows);
    b.rows = NULL;
  }
  free(bonds);
  free_builder(&b);
  return b.rows;
}

/* --- from a deck ------------------------------------------------------------------------------ */

static double longest_bond(const rows *w) {
  double longest = 0;
  for (long q = 0; q < w->size; q++)
    for (int k = 0; k < w->directions; k++)
      if (rows_has_bond(w, q, k)) longest = pl_fmax(longest, w->list->length[k * w->size + q]);
  return longest;
}

/* A notch does nothing when no particle stands near it: around those that it has removed there are
   others. */
static void cut_notch(rows *w, const deck_notch *notch, const deck_lattice *l, double longest,
                      diagnostics *d) {
  double lower[3], upper[3];
  long near = 0, cut = 0;
  shape_box(&notch->shape, lower, upper);
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    double at[3];
    bool inside = true;
    rows_place(w, site, at);
    for (int a = 0; a < w->dimensions; a++)
      inside = inside && at[a] >= lower[a] - longest && at[a] <= upper[a] + longest;
    if (!inside) continue;
    near++;
    if (notch->cut_bonds) cut += rows_cut(w, site, &notch->shape);
  }
  if (cut > 0 || (near > 0 && !notch->cut_bonds)) return;
  const double wide =
      pl_fmax(pl_fmax(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
  if (near > 0 && wide > longest) return; /* what it has removed leaves no bond to cut */
  diag_report(d, DIAG_DECK_WARNING, notch->item.where,
              "the notch removes no particle%s of lattice '%s'",
              notch->cut_bonds ? " and cuts no bond" : "", l->name);
}

static bool has_bonds(const rows *w, const deck_lattice *l, diagnostics *d) {
  if (w->bond_count > 0) return true;
  const char *key = l->horizon > 0 ? "horizon" : l->file ? "file" : "spacing";
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&l->item, key),
              "no two particles of lattice '%s' are neighbours", l->name);
  diag_hint(d, l->horizon > 0 ? "a larger `horizon` reaches more particles"
               : l->file      ? "a single particle has none"
                              : "a single particle has none; a smaller `spacing` makes more");
  return false;
}

static void report_failure(const deck_lattice *l, const particle_set *set, long crowded,
                           diagnostics *d) {
  const char *key = l->horizon > 0 ? "horizon" : "neighbours";
  char text[ROWS_PLACE_TEXT];
  if (crowded < 0) {
    diag_report(d, DIAG_OUT_OF_BOUNDS, l->item.where,
                "there is not enough memory for %ld particles and their neighbours", set->count);
    return;
  }
  double at[3] = {0, 0, 0};
  for (int a = 0; a < set->dimensions; a++)
    at[a] = set->at[a][crowded];
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&l->item, key),
              "with this `%s` a particle has more than %d neighbours, the most there can be", key,
              ROWS_MAX_NEIGHBOURS);
  diag_hint(d, "it is the one at %s; a smaller `%s` takes fewer",
            rows_place_text(set->dimensions, at, text), key);
}

static double mean_nearest(const rows *w) {
  double sum = 0;
  for (long p = 0; p < w->particle_count; p++) {
    double nearest = INFINITY, chord[3];
    for (int n = 0; n < 2 * w->directions; n++)
      if (rows_has_neighbour(w, w->particle_site[p], n))
        nearest = pl_fmin(nearest, rows_chord(w, w->particle_site[p], n, chord));
    sum += isfinite(nearest) ? nearest : w->spacing;
  }
  return sum / (double)w->particle_count;
}

/* Particles of a file as far apart as they are large: volumes in another unit than the file says
   are the usual slip. */
static void compare_sizes(const rows *w, const deck_lattice *l, diagnostics *d) {
  if (w->own_size) return;
  const double apart = mean_nearest(w), ratio = apart / w->spacing;
  if (ratio > 0.3 && ratio < 2) return;
  diag_report(d, DIAG_DECK_WARNING, deck_where(&l->item, "file"),
              "particles are %.4g mm from their nearest neighbours in the mean, but are as large "
              "as those of a "
              "lattice with a spacing of %.4g mm",
              1e3 * apart, 1e3 * w->spacing);
  diag_hint(d, "are volumes and `spacing` in the units that they say?%s",
            w->dimensions == 2 ? " In the plane a volume counts the thickness" : "");
}

/* A few at corners and slits are no matter. */
void scattered_warn_unresolved(const rows *w, const deck_lattice *l, diagnostics *d) {
  const char *key = l->horizon > 0 ? "horizon" : l->shells > 0 ? "shells" : "neighbours";
  const long count = shape_unresolved(w, NULL);
  if (100 * count <= w->particle_count) return;
  diag_report(
      d, DIAG_DECK_WARNING, deck_where(&l->item, key),
      "%ld of %ld particles have too few bonds to tell all strains apart: the body may fall "
      "to pieces or move without force",
      count, w->particle_count);
  diag_hint(d, "12 neighbours in the plane and 18 in space do");
}

rows *scattered_build(const deck *k, int lattice, diagnostics *d) {
  const deck_lattice *l = &k->lattices[lattice];
  particle_set *set = particle_set_make(k, lattice, d);
  if (!set) return NULL;
  for (long n = 0; set->own && n < set->count; n++)
    set->own[n] /= set->spacing;
  long crowded;
  const scattered from = {
      .points = {set->dimensions, set->count, {set->at[0], set->at[1], set->at[2]}},
      .measure = set->volume,
      .spacing = set->spacing,
      .own_size = set->own,
      .horizon = l->horizon * (1 + BRAVAIS_REACH_TOLERANCE) * set->spacing,
      .neighbours = l->neighbours,
      .stiffness_thickness = l->stiffness_thickness,
      .mass_thickness = l->mass_thickness};
  rows *w = scattered_rows(&from, &crowded);
  if (!w) report_failure(l, set, crowded, d);
  particle_set_free(set);
  if (w && !has_bonds(w, l, d)) {
    rows_free(w);
    return NULL;
  }
  if (!w) return NULL;
  if (l->horizon > 0) w->horizon = l->horizon * w->spacing;
  const double longest = longest_bond(w);
  for (int n = 0; n < k->notch_count; n++)
    if (site_of_lattice(l, k->notchs[n].lattice)) cut_notch(w, &k->notchs[n], l, longest, d);
  rows_count_bonds(w);
  compare_sizes(w, l, d);
  scattered_warn_unresolved(w, l, d);
  return w;
}
