#include "runtime/filling/linked.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/filling/bar_line.h"
#include "runtime/lattice/near_particles.h"
#include "runtime/lattice/scattered.h"
#include "runtime/filling/tied.h"
#include "runtime/particles/site_marks.h"

/* A place is reached that is further by so much: rounding. */
#define REACH_TOLERANCE 1e-6
/* Links that are shorter than that part of a spacing are stiff. */
#define SHORT_LINK 0.1

typedef struct linker {
  const deck *deck;
  const deck_lattice *link;
  const rows *bar, *body;
  bar_line line;
  double reach;      /* m */
  int32_t *copied;   /* [particles of the body] number among the copies, or -1 */
  rows_copy *copies; /* [count] of the bar first */
  long count;
  point_pair *pairs; /* [pair_count] of copies */
  long pair_count, pair_room;
  long cut;        /* more would cross notches */
  double shortest; /* m */
} linker;

static rows_copy copy_of(int32_t lattice, int32_t particle) {
  return (rows_copy){.lattice = lattice, .count = 1, .particle = {particle}, .weight = {1}};
}

static int32_t copy_of_body(linker *l, int32_t particle) {
  if (l->copied[particle] < 0) {
    l->copied[particle] = (int32_t)l->count;
    l->copies[l->count++] = copy_of(l->link->of_around, particle);
  }
  return l->copied[particle];
}

static void add_pair(linker *l, int32_t i, int32_t j, double length) {
  if (l->pair_count == l->pair_room) {
    l->pair_room = 2 * l->pair_room + 64;
    l->pairs = must_realloc(l->pairs, (size_t)l->pair_room * sizeof *l->pairs);
  }
  l->pairs[l->pair_count++] = (point_pair){i, j};
  l->shortest = pl_fmin(l->shortest, length);
}

/* What stands on one place is not joined (Gerstle et al. 2013, section 4). */
static bool is_joined(linker *l, const double from[3], const near_particle *p) {
  const double rounding = REACH_TOLERANCE * l->body->spacing;
  double to[3];
  if (sqrt(p->square) <= rounding) return false;
  rows_place(l->body, l->body->particle_site[p->particle], to);
  const bool cut =
      site_notch_between(l->deck, &l->deck->lattices[l->link->of_around], from, to, rounding);
  l->cut += cut;
  return !cut;
}

static void join(linker *l, int32_t of_bar, near_particles *near) {
  const int32_t here = (int32_t)l->count;
  bool joined = false;
  double from[3];
  rows_place(l->bar, l->bar->particle_site[of_bar], from);
  near_particles_find(near, from);
  for (long n = 0; n < near->count; n++) {
    if (!is_joined(l, from, &near->found[n])) continue;
    if (!joined) l->copies[l->count++] = copy_of(l->link->of_bar, of_bar);
    joined = true;
    add_pair(l, here, copy_of_body(l, near->found[n].particle), sqrt(near->found[n].square));
  }
}

static void linker_free(linker *l) {
  bar_line_end(&l->line);
  free(l->copied);
  free(l->copies);
  free(l->pairs);
}

static void find(linker *l) {
  const size_t most = (size_t)l->bar->particle_count + (size_t)l->body->particle_count;
  near_particles near = near_particles_of(l->body, l->reach);
  l->copied = must_alloc(most * sizeof *l->copied);
  l->copies = must_calloc(most, sizeof *l->copies);
  l->shortest = INFINITY;
  for (long p = 0; p < l->body->particle_count; p++)
    l->copied[p] = -1;
  for (int32_t p = 0; p < l->bar->particle_count; p++)
    if (bar_line_chooses(&l->line, p)) join(l, p, &near);
  near_particles_end(&near);
}

/* Those of the bar and of the body take turns in `copies`; lists do not mind. */
static rows *rows_of(const linker *l, long *crowded) {
  const rows *g = l->body;
  double *at[3] = {NULL, NULL, NULL}, *measure = must_calloc((size_t)l->count + 1, sizeof *measure);
  for (int a = 0; a < g->dimensions; a++)
    at[a] = must_calloc((size_t)l->count + 1, sizeof **at);
  for (long n = 0; n < l->count; n++) {
    const rows *of = l->copies[n].lattice == l->link->of_around ? l->body : l->bar;
    double place_of[3];
    rows_place(of, of->particle_site[l->copies[n].particle[0]], place_of);
    for (int a = 0; a < g->dimensions; a++)
      at[a][n] = place_of[a];
    measure[n] = g->site_area > 0 ? g->site_area : g->volume;
  }
  const scattered from = {.points = {g->dimensions, l->count, {at[0], at[1], at[2]}},
                          .measure = measure,
                          .spacing = g->spacing,
                          .bonds = l->pairs,
                          .bond_count = l->pair_count,
                          .stiffness_thickness = g->stiffness_thickness,
                          .mass_thickness = g->site_area > 0 ? g->volume / g->site_area : 0};
  rows *w = scattered_rows(&from, crowded);
  for (int a = 0; a < g->dimensions; a++)
    free(at[a]);
  free(measure);
  return w;
}

static bool has_pairs(const linker *l, diagnostics *d) {
  const deck_lattice *k = l->link;
  if (l->pair_count > 0) return true;
  if (l->cut > 0) {
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&k->item, "within"),
                "the link `%s` joins nothing: each of its bonds would cross a notch", k->name);
    diag_hint(d, "move the bar or the notch; a larger `within` may reach around it");
    return false;
  }
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&k->item, "within"),
              "the link `%s` joins nothing: no particle of `%s` is within %.4g mm of one of the "
              "bar `%s`",
              k->name, k->around, 1e3 * l->reach, k->bar);
  diag_hint(d, "does the bar lie in the body? `within` counts spacings of the lattice");
  return false;
}

static void warn_of_cut(const linker *l, diagnostics *d) {
  if (l->cut == 0) return;
  diag_report(d, DIAG_DECK_WARNING, l->link->item.where,
              "notches of `%s` cut %ld bond%s of the link `%s`", l->link->around, l->cut,
              l->cut == 1 ? "" : "s", l->link->name);
  diag_hint(d, "the bar itself goes through a notch whole");
}

static void warn_of_short(const linker *l, diagnostics *d) {
  if (l->shortest >= SHORT_LINK * l->body->spacing) return;
  diag_report(d, DIAG_DECK_WARNING, l->link->item.where,
              "the shortest bond of the link `%s` is %.3g mm, %.2g of a spacing: it is stiff, and "
              "may shorten the step",
              l->link->name, 1e3 * l->shortest, l->shortest / l->body->spacing);
  diag_hint(d, "move the bar a little, or link other particles of it (`first`)");
}

static bool is_crowded(const linker *l, diagnostics *d) {
  int32_t *bonds = must_calloc((size_t)l->count + 1, sizeof *bonds), most = 0;
  for (long n = 0; n < l->pair_count; n++) {
    bonds[l->pairs[n].i]++;
    bonds[l->pairs[n].j]++;
  }
  for (long n = 0; n < l->count; n++)
    most = bonds[n] > most ? bonds[n] : most;
  free(bonds);
  if (most <= ROWS_MAX_NEIGHBOURS) return false;
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&l->link->item, "within"),
              "with this `within` a particle has %d bonds of the link `%s`, more than the %d there "
              "can be",
              most, l->link->name, ROWS_MAX_NEIGHBOURS);
  diag_hint(d, "a smaller `within` takes fewer");
  return true;
}

static bool has_first(const deck_link *link, const bar_line *line, const deck_bar *bar,
                      diagnostics *d) {
  if (link->first < line->each) return true;
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&link->item, "first"),
              "%sthe bar `%s` has %ld particles: there is none with the number %d",
              bar->copies > 1 ? "each copy of " : "", link->bar, line->each, link->first);
  diag_hint(d, "they are counted from 0");
  return false;
}

/* A bar lies in a body, and is thinner than that. */
static bool is_thinner(const linker *l, const deck_bar *bar, diagnostics *d) {
  const rows *g = l->body;
  double least = pl_fmin(g->width, g->height);
  if (g->dimensions == 3) least = pl_fmin(least, g->depth);
  least += g->spacing;
  if (bar->diameter < least) return true;
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&l->link->item, "bar"),
              "the bar `%s` is %.4g mm thick, but `%s`, in which it lies, only %.4g mm", bar->name,
              1e3 * bar->diameter, l->link->around, 1e3 * least);
  diag_hint(d, "are the bar's `diameter` or `area` and the bodies in the units that they say?");
  return false;
}

static void say_missed(const linker *l, long missed, long chosen, int32_t first, diagnostics *d) {
  const int copies = l->deck->lattices[l->link->of_bar].copies;
  char text[ROWS_PLACE_TEXT];
  double at[3];
  rows_place(l->bar, l->bar->particle_site[first], at);
  rows_place_text(l->bar->dimensions, at, text);
  diag_report(
      d, DIAG_DECK_WARNING, deck_where(&l->link->item, "bar"),
      "%ld of the %ld particles of the bar `%s` that the link `%s` chooses are not joined to "
      "`%s`: they lie outside of it, or notches are between",
      missed, chosen, l->link->bar, l->link->name, l->link->around);
  if (copies > 1)
    diag_hint(d, "the first is at %s, in copy %ld of %d", text, first / l->line.each + 1, copies);
  else
    diag_hint(d, "the first is at %s", text);
}

static void warn_of_missed(const linker *l, const rows *w, diagnostics *d) {
  bool *joined = must_calloc((size_t)l->bar->particle_count + 1, sizeof *joined);
  long missed = 0, chosen = 0;
  int32_t first = 0;
  for (long p = 0; p < w->particle_count; p++)
    if (w->copies[p].lattice == l->link->of_bar) joined[w->copies[p].particle[0]] = true;
  for (int32_t p = (int32_t)l->bar->particle_count - 1; p >= 0; p--) {
    if (!bar_line_chooses(&l->line, p)) continue;
    chosen++;
    if (joined[p]) continue;
    missed++;
    first = p;
  }
  free(joined);
  if (missed > 0) say_missed(l, missed, chosen, first, d);
}

static rows *join_sites(linker *l, diagnostics *d) {
  long crowded;
  l->reach = l->link->within * l->body->spacing * (1 + REACH_TOLERANCE);
  find(l);
  rows *w = has_pairs(l, d) && !is_crowded(l, d) ? rows_of(l, &crowded) : NULL;
  if (w) {
    warn_of_short(l, d);
    warn_of_cut(l, d);
    w->copies = l->copies;
    l->copies = NULL;
  }
  return w;
}

rows *linked_build(const deck *k, int lattice, rows *const *built, diagnostics *d) {
  const deck_link *link = &k->lattices[lattice];
  const deck_bar *bar = &k->lattices[link->of_bar];
  linker l = {.deck = k, .link = link, .bar = built[link->of_bar], .body = built[link->of_around]};
  if (!l.bar || !l.body) return NULL; /* what is wrong with these has been said */
  l.line = bar_line_of(bar, link, l.bar);
  rows *w = !has_first(link, &l.line, bar, d) || !is_thinner(&l, bar, d) ? NULL
            : link->to == LINK_TO_PLACE ? tied_build(k, link, &l.line, l.bar, l.body, d)
                                        : join_sites(&l, d);
  if (w) warn_of_missed(&l, w, d);
  linker_free(&l);
  return w;
}

/* What all copies of each of a lattice's particles weigh together. [particle_count] */
static double *weights_of(const rows *link, int lattice, const rows *g) {
  double *sum = must_calloc((size_t)g->particle_count + 1, sizeof *sum);
  for (long p = 0; p < link->particle_count; p++)
    for (int k = 0; k < link->copies[p].count && link->copies[p].lattice == lattice; k++)
      sum[link->copies[p].particle[k]] += link->copies[p].weight[k];
  return sum;
}

static double mass_at(const rows *g, int32_t particle) {
  return g->site_mass ? g->site_mass[g->particle_site[particle]] : g->mass;
}

/* A place moves as easily as its particles, each of which is shared out among the places that it
   carries: so that all of them together are no heavier than it. */
static double mass_of(const rows_copy *c, const rows *g, const double *carried) {
  double mobility = 0;
  if (c->count == 1) return mass_at(g, c->particle[0]) / carried[c->particle[0]];
  for (int k = 0; k < c->count; k++)
    mobility += c->weight[k] * carried[c->particle[k]] / mass_at(g, c->particle[k]);
  return 1 / mobility;
}

/* Copies that turn with a bar have no inertia of their own, and no freedom: as if they were
   heavy. */
static double inertia_of(const rows_copy *c, const rows *g, double mass) {
  static const double heavy = 1e6;
  const long site = g->particle_site[c->particle[0]];
  const double of_one = mass * (g->inertia / g->mass) * rows_radius_square(g, site);
  return c->along ? heavy * of_one : of_one;
}

/* A particle of a list turns as rows_radius_square says. */
bool linked_take_masses(rows *link, rows *const *built) {
  const double half = link->spacing / 2;
  const int bar = link->copies[0].lattice; /* they begin with one of the bar */
  double sum = 0, *of_bar = weights_of(link, bar, built[bar]), *of_body = NULL;
  for (long p = 0; p < link->particle_count; p++) {
    const rows_copy *c = &link->copies[p];
    const rows *g = built[c->lattice];
    if (!(g->mass > 0)) {
      free(of_bar);
      free(of_body);
      return false;
    }
    const long here = link->particle_site[p];
    if (c->lattice != bar && !of_body) of_body = weights_of(link, c->lattice, g);
    const double mass = mass_of(c, g, c->lattice == bar ? of_bar : of_body),
                 inertia = inertia_of(c, g, mass);
    link->site_mass[here] = mass;
    link->site_volume[here] =
        link->volume * pl_pow(inertia / (0.4 * mass * half * half), 0.5 * link->dimensions);
    sum += mass;
  }
  free(of_bar);
  free(of_body);
  link->mass = sum / (double)link->particle_count;
  link->inertia = 0.4 * link->mass * half * half;
  for (long q = 0; q < link->size; q++)
    if (!link->present[q]) link->site_mass[q] = link->mass;
  return true;
}
