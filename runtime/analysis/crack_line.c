#include "runtime/analysis/crack_line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/eigen.h"
#include "runtime/filling/tied.h"

enum { PARTS = 4 /* a spacing */, MOST_SITES = 2 * ROWS_MOST_COPIED, STRAINS = 6 };

/* --- stations --------------------------------------------------------------------------------- */

static bool take_station(line_station *s, near_particles *near, const double at[3]) {
  rows_copy cell;
  if (!tied_cell(near, NULL, NULL, at, &cell)) return false;
  s->count = cell.count;
  for (int k = 0; k < cell.count; k++) {
    s->site[k] = near->body->particle_site[cell.particle[k]];
    s->weight[k] = cell.weight[k];
  }
  return true;
}

/* False where some place of the line is in no cell: the first one is in outside[3] then. */
static bool take_stations(crack_line *l, const double from[3], const double to[3],
                          double outside[3]) {
  near_particles near = tied_near(l->of->lattice);
  bool inside = true;
  l->stations = must_calloc((size_t)l->parts + 1, sizeof *l->stations);
  for (long n = 0; n <= l->parts && inside; n++) {
    for (int a = 0; a < 3; a++)
      outside[a] = from[a] + (double)n / (double)l->parts * (to[a] - from[a]);
    inside = take_station(&l->stations[n], &near, outside);
  }
  near_particles_end(&near);
  return inside;
}

/* --- bonds ------------------------------------------------------------------------------------ */

/* Sites of both stations of a part, each once. */
static int sites_of(const crack_line *l, long part, int32_t sites[MOST_SITES]) {
  int count = 0;
  for (long n = part; n <= part + 1; n++)
    for (int k = 0; k < l->stations[n].count; k++) {
      bool there = false;
      for (int m = 0; m < count; m++)
        there = there || sites[m] == l->stations[n].site[k];
      if (!there) sites[count++] = l->stations[n].site[k];
    }
  return count;
}

/* Number of the bond at one of its ends that owns it; -1: these two have none. */
static int direction_to(const rows *g, int32_t owner, int32_t partner) {
  for (int k = 0; k < g->directions; k++)
    if (rows_has_bond(g, owner, k) && rows_partner(g, owner, k) == partner) return k;
  return -1;
}

static double distance_between(const rows *g, int32_t i, int32_t j) {
  double a[3], b[3];
  rows_place(g, i, a);
  rows_place(g, j, b);
  return bravais_distance(a, b);
}

/* So near to each other sites are joined, unless something cut them apart. */
static double reach_of(const rows *g, int32_t i, int32_t j) {
  const double spacing = pl_fmin(rows_spacing(g, i), rows_spacing(g, j));
  const bool on_lattice = !g->list || g->infinite.axes > 0;
  return (on_lattice ? g->horizon : spacing) * (1 - 1e-6);
}

static void add_pair(crack_line *l, long part, int32_t i, int32_t j) {
  const rows *g = l->of->lattice;
  int k = direction_to(g, i, j);
  if (k < 0) {
    const int32_t first = i;
    k = direction_to(g, j, i);
    i = j;
    j = first;
  }
  const double length = distance_between(g, i, j);
  if (k < 0) {
    l->cut[part] = l->cut[part] || length < reach_of(g, i, j);
    return;
  }
  l->bonds[l->first[part + 1]++] =
      (line_bond){.i = i,
                  .j = j,
                  .bond = {g->site_particle[i], g->site_particle[j], (int64_t)k * g->size + i},
                  .length = length};
}

/* Monomials of a direction, so that e.n = strain along it for the strain e. */
static void monomials(const double direction[3], double n[STRAINS]) {
  for (int a = 0; a < 3; a++) {
    n[a] = direction[a] * direction[a];
    n[3 + a] = sqrt(2) * direction[a] * direction[(a + 1) % 3];
  }
}

/* Shares of the bonds: those of the smallest strain that fits all stretches best. */
static void find_shares(crack_line *l, long part) {
  const rows *g = l->of->lattice;
  double sum[STRAINS][STRAINS] = {{0}}, values[STRAINS], vectors[STRAINS][STRAINS], most = 0,
         along[STRAINS], (*n)[STRAINS];
  const long first = l->first[part], count = l->first[part + 1] - first;
  n = must_calloc((size_t)count + 1, sizeof *n);
  for (long b = 0; b < count; b++) {
    double from[3], to[3];
    rows_place(g, l->bonds[first + b].i, from);
    rows_place(g, l->bonds[first + b].j, to);
    for (int a = 0; a < 3; a++)
      to[a] = (to[a] - from[a]) / l->bonds[first + b].length;
    monomials(to, n[b]);
    for (int r = 0; r < STRAINS; r++)
      for (int c = 0; c < STRAINS; c++)
        sum[r][c] += n[b][r] * n[b][c];
  }
  eigen_symmetric(STRAINS, sum, values, vectors);
  monomials(l->along, along);
  for (int m = 0; m < STRAINS; m++)
    most = pl_fmax(most, values[m]);
  for (int m = 0; m < STRAINS; m++) {
    if (!(values[m] > 1e-6 * most)) continue;
    double onto = 0;
    for (int r = 0; r < STRAINS; r++)
      onto += vectors[m][r] * along[r];
    for (long b = 0; b < count; b++)
      for (int r = 0; r < STRAINS; r++)
        l->bonds[first + b].share += onto / values[m] * vectors[m][r] * n[b][r];
  }
  free(n);
}

static void take_bonds(crack_line *l) {
  enum { MOST_PAIRS = MOST_SITES * (MOST_SITES - 1) / 2 };
  l->first = must_calloc((size_t)l->parts + 1, sizeof *l->first);
  l->bonds = must_calloc((size_t)l->parts * MOST_PAIRS + 1, sizeof *l->bonds);
  l->cut = must_calloc((size_t)l->parts + 1, sizeof *l->cut);
  for (long part = 0; part < l->parts; part++) {
    int32_t sites[MOST_SITES];
    const int count = sites_of(l, part, sites);
    l->first[part + 1] = l->first[part];
    for (int a = 0; a < count; a++)
      for (int b = a + 1; b < count; b++)
        add_pair(l, part, sites[a], sites[b]);
    find_shares(l, part);
  }
}

crack_line *crack_line_new(const body *of, const damage_law *laws, int law_count,
                           const double from[3], const double to[3], double above,
                           double outside[3]) {
  crack_line *l = must_calloc(1, sizeof *l);
  const double length = bravais_distance(from, to);
  const rows *g = of->lattice;
  *l = (crack_line){.of = of,
                    .law_count = law_count,
                    .above = above,
                    .parts = (long)pl_fmax(1, round(PARTS * length / g->spacing))};
  l->laws = must_calloc((size_t)law_count + 1, sizeof *laws);
  memcpy(l->laws, laws, (size_t)law_count * sizeof *laws);
  memcpy(outside, to, 3 * sizeof *to); /* of what is longer than the body */
  if (length > g->width + g->height + g->depth + g->spacing ||
      !take_stations(l, from, to, outside)) {
    crack_line_free(l);
    return NULL;
  }
  l->part = length / (double)l->parts;
  for (int a = 0; a < 3; a++)
    l->along[a] = (to[a] - from[a]) / length;
  take_bonds(l);
  l->what = must_calloc((size_t)l->parts, sizeof *l->what);
  l->opening = must_calloc((size_t)l->parts, sizeof *l->opening);
  l->owner = must_calloc((size_t)l->parts, sizeof *l->owner);
  l->away = must_calloc((size_t)l->parts, sizeof *l->away);
  l->cracks = must_calloc((size_t)crack_line_most(l), sizeof *l->cracks);
  return l;
}

void crack_line_free(crack_line *l) {
  if (!l) return;
  free(l->laws);
  free(l->stations);
  free(l->first);
  free(l->bonds);
  free(l->cut);
  free(l->what);
  free(l->opening);
  free(l->owner);
  free(l->away);
  free(l->cracks);
  free(l);
}

/* --- openings --------------------------------------------------------------------------------- */

static void way_of(const crack_line *l, long station, double way[3]) {
  const line_station *s = &l->stations[station];
  memset(way, 0, 3 * sizeof *way);
  for (int d = 0; d < l->of->dimensions; d++)
    for (int k = 0; k < s->count; k++)
      way[d] += s->weight[k] * l->of->displacement[d][s->site[k]];
}

/* The line's present direction. */
static void find_direction(const crack_line *l, double now[3]) {
  double first[3], last[3], square = 0;
  way_of(l, 0, first);
  way_of(l, l->parts, last);
  for (int a = 0; a < 3; a++) {
    now[a] = l->along[a] * l->part * (double)l->parts + last[a] - first[a];
    square += now[a] * now[a];
  }
  for (int a = 0; a < 3; a++)
    now[a] /= sqrt(square);
}

/* The largest that a law says; of laws with damage on particles alone that of the worse end. */
static double damage_between(const crack_line *l, const line_bond *b) {
  double most = 0;
  for (int n = 0; n < l->law_count; n++) {
    const sweep *of = l->laws[n].of;
    most = pl_fmax(most, damage_on_bonds(of->law)
                             ? damage_of_bond(of, &b->bond)
                             : pl_fmax(damage_of_site(of, b->i), damage_of_site(of, b->j)));
  }
  return most;
}

static double stretch_of(const crack_line *l, const line_bond *b) {
  const body *of = l->of;
  double from[3], to[3], square = 0;
  rows_place(of->lattice, b->i, from);
  rows_place(of->lattice, b->j, to);
  for (int d = 0; d < of->dimensions; d++) {
    const double chord = to[d] - from[d] + of->displacement[d][b->j] - of->displacement[d][b->i];
    square += chord * chord;
  }
  return sqrt(square) / b->length - 1;
}

/* How far a part opens, m, and whether it is the middle of a crack. */
static double open_part(const crack_line *l, long part, const double now[3], line_part *what) {
  double elastic = 0, opening = -l->part, most = l->cut[part] ? 1 : 0, start[3], end[3];
  for (long b = l->first[part]; b < l->first[part + 1]; b++) {
    const line_bond *at = &l->bonds[b];
    const double damage = damage_between(l, at), stretch = stretch_of(l, at);
    most = pl_fmax(most, damage);
    elastic += at->share * (stretch > 0 ? (1 - damage) * stretch : stretch);
  }
  *what = most > l->above ? PART_CORE : most > 0 ? PART_DAMAGED : PART_WHOLE;
  if (*what == PART_WHOLE) return 0;
  way_of(l, part, start);
  way_of(l, part + 1, end);
  for (int a = 0; a < 3; a++)
    opening += now[a] * (l->along[a] * l->part + end[a] - start[a]);
  return opening - l->part * elastic;
}

/* Numbers of the cracks whose cores parts are; damaged ones behind them are theirs, too. Returns
   how many. */
static long own_forward(crack_line *l) {
  long count = 0, core = -1; /* the last one with nothing whole behind it */
  for (long n = 0; n < l->parts; n++) {
    l->owner[n] = -1;
    if (l->what[n] == PART_WHOLE) core = -1;
    if (l->what[n] == PART_CORE) {
      count += n == 0 || l->what[n - 1] != PART_CORE;
      core = n;
    }
    if (core < 0) continue;
    l->owner[n] = count - 1;
    l->away[n] = n - core;
  }
  return count;
}

/* Those nearer to the next core are that one's. */
static void own_backward(crack_line *l) {
  long core = -1;
  for (long n = l->parts - 1; n >= 0; n--) {
    if (l->what[n] == PART_WHOLE) core = -1;
    if (l->what[n] == PART_CORE) core = n;
    if (core >= 0 && (l->owner[n] < 0 || core - n < l->away[n])) l->owner[n] = l->owner[core];
  }
}

/* Sums of openings and of their moments about the beginning of the line. */
static void add_parts(const crack_line *l, crack *cracks) {
  for (long n = 0; n < l->parts; n++) {
    if (l->owner[n] < 0) continue;
    const double opening = pl_fmax(l->opening[n], 0);
    cracks[l->owner[n]].place += opening * ((double)n + 0.5) * l->part;
    cracks[l->owner[n]].width += l->opening[n];
    cracks[l->owner[n]].weight += opening;
  }
}

/* Where nothing opens a crack is in the middle of its core. */
static double middle_of(const crack_line *l, long number) {
  long first = 0, last;
  while (l->owner[first] != number || l->what[first] != PART_CORE)
    first++;
  for (last = first; last + 1 < l->parts && l->what[last + 1] == PART_CORE; last++)
    ;
  return 0.5 * (double)(first + last + 1) * l->part;
}

const crack *crack_line_find(crack_line *l, long *count) {
  double now[3];
  find_direction(l, now);
  for (long n = 0; n < l->parts; n++)
    l->opening[n] = open_part(l, n, now, &l->what[n]);
  *count = own_forward(l);
  own_backward(l);
  memset(l->cracks, 0, (size_t)*count * sizeof *l->cracks);
  add_parts(l, l->cracks);
  for (long k = 0; k < *count; k++) {
    crack *c = &l->cracks[k];
    c->place = c->weight > 0 ? c->place / c->weight : middle_of(l, k);
    c->width = pl_fmax(c->width, 0);
  }
  return l->cracks;
}

double crack_line_widest(crack_line *l) {
  long count;
  double widest = 0;
  const crack *cracks = crack_line_find(l, &count);
  for (long k = 0; k < count; k++)
    widest = pl_fmax(widest, cracks[k].width);
  return widest;
}

long crack_line_most(const crack_line *l) {
  return (l->parts + 1) / 2;
}
