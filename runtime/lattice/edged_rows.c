#include "runtime/lattice/edged_rows.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/deck/bravais.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/lattice/rows_build.h"
#include "runtime/lattice/scattered.h"
#include "runtime/particles/particle_set.h"
#include "runtime/particles/site_marks.h"

#define TIE          1e-6 /* of a distance: neighbours that differ by less are equally far away */
#define ACROSS_NOTCH 1e-6 /* spacings deep */

enum { MOST_NEAR = ROWS_MAX_NEIGHBOURS * ROWS_MAX_NEIGHBOURS };

/* Another particle that a particle may be joined to. */
typedef struct candidate {
  double distance; /* m */
  int32_t particle;
} candidate;

typedef struct builder {
  const deck *deck;
  const deck_lattice *lattice;
  const rows *of; /* the lattice's own particles and bonds */
  particle_set *set;
  point_pair *pairs;
  long pair_count, pair_room;
  candidate near[MOST_NEAR];
  int near_count;
  int32_t *seen; /* [particles] 1 + the last one that it was looked at for */
  diagnostics *d;
} builder;

static void place_of(const builder *b, long particle, double at[3]) {
  rows_place(b->of, b->of->particle_site[particle], at);
}

static void place_particles(builder *b) {
  b->set = particle_set_new(b->of->dimensions, b->of->particle_count);
  b->set->spacing = b->of->spacing;
  for (long p = 0; p < b->set->count; p++) {
    double at[3];
    place_of(b, p, at);
    for (int a = 0; a < b->set->dimensions; a++)
      b->set->at[a][p] = at[a];
  }
}

/* --- bonds ------------------------------------------------------------------------------------ */

static void add_pair(builder *b, int32_t i, int32_t j) {
  if (b->pair_count == b->pair_room) {
    b->pair_room += b->pair_room / 2 + 64;
    b->pairs = must_realloc(b->pairs, (size_t)b->pair_room * sizeof *b->pairs);
  }
  b->pairs[b->pair_count++] = (point_pair){i < j ? i : j, i < j ? j : i};
}

static void take_bonds(builder *b) {
  rows_bond *bonds = rows_bonds(b->of);
  for (long m = 0; m < b->of->bond_count; m++)
    add_pair(b, bonds[m].i, bonds[m].j);
  free(bonds);
}

/* The neighbour of a particle in that direction, or -1. */
static int32_t neighbour_of(const rows *w, long particle, int direction) {
  const long site = w->particle_site[particle];
  if (!rows_has_neighbour(w, site, direction)) return -1;
  return w->site_particle[rows_partner(w, site, direction)];
}

static void note_candidate(builder *b, long particle, int32_t other) {
  double from[3], to[3], square = 0;
  if (other < 0 || b->seen[other] == particle + 1) return;
  b->seen[other] = (int32_t)particle + 1;
  place_of(b, particle, from);
  place_of(b, other, to);
  if (site_notch_between(b->deck, b->lattice, from, to, ACROSS_NOTCH * b->of->spacing)) return;
  for (int a = 0; a < 3; a++)
    square += (to[a] - from[a]) * (to[a] - from[a]);
  b->near[b->near_count++] = (candidate){sqrt(square), other};
}

static int by_distance(const void *a, const void *b) {
  const candidate *p = a, *q = b;
  if (p->distance != q->distance) return p->distance < q->distance ? -1 : 1;
  return p->particle < q->particle ? -1 : p->particle > q->particle;
}

static void note_neighbours(builder *b, long particle, long of) {
  for (int n = 0; n < 2 * b->of->directions && b->near_count < MOST_NEAR; n++)
    note_candidate(b, particle, neighbour_of(b->of, of, n));
}

/* The neighbours of its neighbours, and theirs as long as there are fewer than `least`: what a gap
   parts stays apart. Nearest first. */
static void find_candidates(builder *b, long particle, int least) {
  const int directions = 2 * b->of->directions;
  b->near_count = 0;
  b->seen[particle] = (int32_t)particle + 1;
  for (int n = 0; n < directions; n++) {
    const int32_t next = neighbour_of(b->of, particle, n);
    if (next >= 0) b->seen[next] = (int32_t)particle + 1;
  }
  for (int n = 0; n < directions; n++) {
    const int32_t next = neighbour_of(b->of, particle, n);
    if (next >= 0) note_neighbours(b, particle, next);
  }
  for (int from = 0, to = b->near_count; to < least && from < to; to = b->near_count)
    for (; from < to; from++)
      note_neighbours(b, particle, b->near[from].particle);
  qsort(b->near, (size_t)b->near_count, sizeof *b->near, by_distance);
}

/* To as many as a whole family has, and to the usual number if these are more. Whole shells, so
   that what is symmetric stays so. */
static void join_further(builder *b, long particle) {
  const int whole = 2 * b->of->directions, usual = lattice_usual_neighbours(b->of->dimensions);
  const int degree = rows_degree(b->of, b->of->particle_site[particle]);
  const int missing = (whole > usual ? whole : usual) - degree;
  double reach = 0;
  if (degree == whole) return;
  find_candidates(b, particle, whole - degree);
  for (int k = 0; k < b->near_count; k++) {
    if (k >= missing && b->near[k].distance > reach * (1 + TIE)) return;
    reach = b->near[k].distance;
    add_pair(b, (int32_t)particle, b->near[k].particle);
  }
}

static int by_ends(const void *a, const void *b) {
  const point_pair *p = a, *q = b;
  if (p->i != q->i) return p->i < q->i ? -1 : 1;
  return p->j < q->j ? -1 : p->j > q->j;
}

/* Of two particles at an edge each may have joined the other. */
static void drop_doubles(builder *b) {
  long kept = 0;
  qsort(b->pairs, (size_t)b->pair_count, sizeof *b->pairs, by_ends);
  for (long k = 0; k < b->pair_count; k++)
    if (kept == 0 || by_ends(&b->pairs[kept - 1], &b->pairs[k]) != 0)
      b->pairs[kept++] = b->pairs[k];
  b->pair_count = kept;
}

static void find_pairs(builder *b) {
  take_bonds(b);
  b->seen = must_calloc((size_t)b->set->count + 1, sizeof *b->seen);
  for (long p = 0; p < b->set->count; p++)
    join_further(b, p);
  free(b->seen);
  drop_doubles(b);
}

static bool few_enough(const builder *b) {
  int *degree = must_calloc((size_t)b->set->count + 1, sizeof *degree), most = 0;
  for (long m = 0; m < b->pair_count; m++) {
    const int i = ++degree[b->pairs[m].i], j = ++degree[b->pairs[m].j];
    most = i > most ? i : most;
    most = j > most ? j : most;
  }
  free(degree);
  if (most <= ROWS_MAX_NEIGHBOURS) return true;
  diag_report(b->d, DIAG_OUT_OF_BOUNDS, deck_where(&b->lattice->item, "edges"),
              "with further ones at edges a particle has %d neighbours; the most there can be are "
              "%d",
              most, ROWS_MAX_NEIGHBOURS);
  diag_hint(b->d, "fewer shells, or a smaller `horizon`, leave room for them");
  return false;
}

/* --- volumes ---------------------------------------------------------------------------------- */

static bool find_volumes(builder *b) {
  char text[ROWS_PLACE_TEXT];
  particle_set_measure(b->set, b->deck, (int)(b->lattice - b->deck->lattices));
  for (long p = 0; p < b->set->count; p++) {
    double at[3];
    if (b->set->volume[p] > 0) continue;
    place_of(b, p, at);
    diag_report(b->d, DIAG_EMPTY_REGION, b->lattice->item.where,
                "the cell of the particle at %s has no part in the bodies of lattice '%s'",
                rows_place_text(b->set->dimensions, at, text), b->lattice->name);
    return false;
  }
  return true;
}

/* --- rows ------------------------------------------------------------------------------------- */

static rows *as_list(const builder *b) {
  const particle_set *set = b->set;
  const scattered from = {
      .points = {set->dimensions, set->count, {set->at[0], set->at[1], set->at[2]}},
      .measure = set->volume,
      .spacing = set->spacing,
      .bonds = b->pairs,
      .bond_count = b->pair_count,
      .stiffness_thickness = b->lattice->stiffness_thickness,
      .mass_thickness = b->lattice->mass_thickness};
  long crowded;
  rows *w = scattered_rows(&from, &crowded);
  if (!w) {
    diag_report(b->d, DIAG_OUT_OF_BOUNDS, b->lattice->item.where,
                "there is not enough memory for %ld particles and their neighbours", set->count);
    return NULL;
  }
  w->horizon = b->of->horizon;
  scattered_warn_unresolved(w, b->lattice, b->d);
  return w;
}

rows *edged_rows(const deck *k, int lattice, diagnostics *d) {
  rows *of = rows_build(k, lattice, d), *w = NULL;
  if (!of) return NULL;
  builder *b = must_calloc(1, sizeof *b);
  *b = (builder){.deck = k, .lattice = &k->lattices[lattice], .of = of, .d = d};
  place_particles(b);
  find_pairs(b);
  if (few_enough(b) && find_volumes(b)) w = as_list(b);
  free(b->pairs);
  particle_set_free(b->set);
  free(b);
  rows_free(of);
  return w;
}

/* --- what is said of them --------------------------------------------------------------------- */

/* Counts the site's own half of its bonds. */
static void look_at(const rows *w, long site, edged_rows_facts *f) {
  int near = 0;
  for (int n = 0; n < 2 * w->directions; n++) {
    double chord[3];
    if (!rows_has_neighbour(w, site, n)) continue;
    const bool is_near =
        rows_chord(w, site, n, chord) <= w->horizon * (1 + BRAVAIS_REACH_TOLERANCE);
    near += is_near;
    f->further += !is_near && n < w->directions;
  }
  f->short_of += near < f->whole;
}

edged_rows_facts edged_rows_look(const rows *w, const deck_lattice *l) {
  bravais_neighbour family[PL_MAX_DIRECTIONS];
  bravais b;
  edged_rows_facts f = {.least = INFINITY};
  if (!bravais_of(l, &b)) return f;
  f.whole = 2 * bravais_family(&b, l->horizon, l->shells, family);
  const double site = b.site_measure * (w->dimensions == 2 ? l->mass_thickness : 1);
  for (long p = 0; p < w->particle_count; p++) {
    const double part = w->site_volume[w->particle_site[p]] / site;
    look_at(w, w->particle_site[p], &f);
    f.least = pl_fmin(f.least, part);
    f.most = pl_fmax(f.most, part);
  }
  return f;
}
