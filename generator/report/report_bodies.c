#include "generator/report/report_bodies.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "runtime/continuum/mesh_ties.h"
#include "runtime/filling/bar_placing.h"
#include "runtime/geometry/polyline.h"
#include "runtime/lattice/edged_rows.h"
#include "runtime/lattice/notch_depth.h"

static void announce_notch(const notch_depth *n, int number, bool only) {
  char name[24] = "notch";
  if (!only) snprintf(name, sizeof name, "notch %d", number);
  printf("  %-10s ", name);
  if (n->kind == NOTCH_THROUGH)
    printf("%.4g mm deep: it cuts the body through\n", 1e3 * n->drawn);
  else if (n->kind == NOTCH_INSIDE)
    printf("%.4g mm long as drawn, %.4g mm from bond to bond; ligaments %.4g and %.4g mm\n",
           1e3 * n->drawn, 1e3 * n->cut, 1e3 * n->ligament[0], 1e3 * n->ligament[1]);
  else
    printf("%.4g mm deep as drawn, %.4g mm to the first bond left; ligament %.4g mm\n",
           1e3 * n->drawn, 1e3 * n->cut, 1e3 * n->ligament[0]);
}

void announce_notches(const run *r, int lattice) {
  enum { MOST = 8 };
  const deck *k = r->deck;
  int said = 0, left = 0;
  for (int n = 0; n < k->notch_count; n++) {
    if (strcmp(k->notchs[n].lattice, k->lattices[lattice].name) != 0) continue;
    if (said == MOST) {
      left++;
      continue;
    }
    const notch_depth depth =
        notch_depth_of(simulation_rows(r->simulation, lattice), &k->notchs[n].shape);
    if (depth.kind == NOTCH_NONE) continue;
    announce_notch(&depth, n + 1, k->notch_count == 1);
    said++;
  }
  if (left > 0) printf("             and %d more\n", left);
}

static void announce_particles(const run *r, int lattice) {
  const rows *w = simulation_rows(r->simulation, lattice);
  const deck_lattice *k = &r->deck->lattices[lattice];
  char depth[32] = "", sizes[64];
  int fewest = ROWS_MAX_NEIGHBOURS, most = 0;
  if (w->dimensions == 3) snprintf(depth, sizeof depth, " x %.5g", 1e3 * w->depth);
  for (long p = 0; p < w->particle_count; p++) {
    const int degree = rows_degree(w, w->particle_site[p]);
    fewest = degree < fewest ? degree : fewest;
    most = degree > most ? degree : most;
  }
  if (w->own_size)
    snprintf(sizes, sizeof sizes, "%.4g to %.4g", 1e3 * w->spacing, 1e3 * rows_largest_spacing(w));
  else
    snprintf(sizes, sizeof sizes, "%.6g", 1e3 * w->spacing);
  printf("  particles  %s: %ld of %s, spacing %s mm, %.5g x %.5g%s mm between outermost ones\n"
         "  neighbours %d to %d, mean %.4g, %ld bonds\n",
         k->name, w->particle_count, k->file ? k->file : "blue noise", sizes, 1e3 * w->width,
         1e3 * w->height, depth, fewest, most,
         2 * (double)w->bond_count / (double)w->particle_count, w->bond_count);
}

static bool some_link_joins(const deck *k, int bar, int around) {
  for (int n = 0; n < k->lattice_count; n++) {
    const deck_link *link = &k->lattices[n];
    if (deck_lattice_is_link(link) && link->of_bar == bar && link->of_around == around) return true;
  }
  return false;
}

/* "placing    of 61 particles of bottom 59 lie in concrete, 0 to 5.8 mm from the nearest site, in
   the mean 2.7 mm; no link joins them" */
static void announce_placing(const run *r, int lattice) {
  const deck *k = r->deck;
  const rows *bar = simulation_rows(r->simulation, lattice);
  for (int n = 0; n < k->lattice_count; n++) {
    const rows *w = simulation_rows(r->simulation, n);
    if (deck_lattice_is_bar(&k->lattices[n]) || w->copies || w->dimensions != bar->dimensions)
      continue;
    const bar_placing p = bar_placing_in(bar, w);
    printf("  placing    of %ld particles of %s %ld lie in %s", bar->particle_count,
           k->lattices[lattice].name, p.inside, k->lattices[n].name);
    if (p.inside)
      printf(", %.3g to %.3g mm from the nearest %s, in the mean %.3g mm", 1e3 * p.least,
             1e3 * p.most, w->list ? "particle" : "site", 1e3 * p.mean);
    if (p.inside && !some_link_joins(k, lattice, n)) fputs("; no link joins them", stdout);
    putchar('\n');
  }
}

/* "15 copies, each (80, 0) mm from the one before, " */
static void announce_copies(const deck_bar *k, int dimensions) {
  char text[ROWS_PLACE_TEXT];
  if (k->copies > 1)
    printf("%d copies, each %s from the one before, ", k->copies,
           rows_place_text(dimensions, k->shift, text));
}

/* "bar        bottom: 58 particles, 57 bonds, 1.14 m long, spacing 20 mm, area 126.68 mm^2" */
static void announce_bar(const run *r, int lattice) {
  const rows *w = simulation_rows(r->simulation, lattice);
  const deck_bar *k = &r->deck->lattices[lattice];
  const polyline p = {w->dimensions, k->value_count / w->dimensions, k->points, k->closed};
  double shortest = INFINITY, longest = 0;
  for (int leg = 0; leg < polyline_legs(&p); leg++) {
    const double *from, *to;
    const double part =
        polyline_leg(&p, leg, &from, &to) / (double)polyline_parts(&p, leg, k->spacing);
    shortest = pl_fmin(shortest, part);
    longest = pl_fmax(longest, part);
  }
  printf("  bar        %s: ", k->name);
  announce_copies(k, w->dimensions);
  printf("%s%ld particles, %ld bonds, %s%.6g mm long, area %.6g mm^2, spacing %.6g",
         k->closed ? "closed, " : "", w->particle_count, w->bond_count,
         k->copies > 1 ? "each " : "", 1e3 * polyline_length(&p), 1e6 * k->area, 1e3 * shortest);
  if (longest > shortest * (1 + POLYLINE_ROUNDING)) printf(" to %.6g", 1e3 * longest);
  fputs(" mm", stdout);
  if (pl_fmax(longest - k->spacing, k->spacing - shortest) > POLYLINE_ROUNDING * k->spacing)
    printf(": legs are no multiples of %.6g mm", 1e3 * k->spacing);
  putchar('\n');
  announce_placing(r, lattice);
}

/* "link       bond: 116 bonds of 2.5 to 20 mm join 29 particles of bottom to 60 of concrete" */
static void announce_link(const run *r, int lattice) {
  const rows *w = simulation_rows(r->simulation, lattice);
  const deck_link *k = &r->deck->lattices[lattice];
  double shortest = INFINITY, longest = 0, chord[3];
  long of_bar = 0;
  for (long p = 0; p < w->particle_count; p++) {
    of_bar += w->copies[p].lattice == k->of_bar;
    for (int n = 0; n < 2 * w->directions; n++) {
      if (!rows_has_neighbour(w, w->particle_site[p], n)) continue;
      const double length = rows_chord(w, w->particle_site[p], n, chord);
      shortest = pl_fmin(shortest, length);
      longest = pl_fmax(longest, length);
    }
  }
  if (k->to == LINK_TO_PLACE) {
    printf("  link       %s: %ld particles of %s tied to places in %s, every %.6g mm\n", k->name,
           w->bond_count, k->bar, k->around, 1e3 * k->spacing);
    return;
  }
  printf("  link       %s: %ld bonds of %.4g to %.4g mm join %ld particles of %s to %ld of %s\n",
         k->name, w->bond_count, 1e3 * shortest, 1e3 * longest, of_bar, k->bar,
         w->particle_count - of_bar, k->around);
}

/* "edges      exact: 138 particles lack neighbours and have 211 bonds to further ones; a particle
   has 0.42 to 1.37 of a site's volume" */
static void announce_exact_edges(const edged_rows_facts *f) {
  printf("  edges      exact: %ld particles lack neighbours and have %ld bonds to further ones; a "
         "particle has %.3g to %.3g of a site's volume\n",
         f->short_of, f->further, f->least, f->most);
}

static void announce_lattice(const run *r, int lattice) {
  const rows *w = simulation_rows(r->simulation, lattice);
  const deck_lattice *k = &r->deck->lattices[lattice];
  const bool exact = k->edges == EDGES_EXACT;
  const edged_rows_facts edges = exact ? edged_rows_look(w, k) : (edged_rows_facts){0};
  const int whole = exact ? edges.whole : 2 * w->directions;
  char depth[32] = "", family[64] = "";
  if (w->dimensions == 3) snprintf(depth, sizeof depth, " x %.5g", 1e3 * w->depth);
  if (exact ? k->horizon > 0 || k->shells > 1 : w->shell[w->directions - 1] > 1)
    snprintf(family, sizeof family, ", %d neighbours", whole);
  printf(
      "  lattice    %s: %s, spacing %.6g mm%s, %ld particles, %ld bonds, %.5g x %.5g%s mm between "
      "outermost sites\n",
      k->name, k->kind, 1e3 * w->spacing, family, w->particle_count, w->bond_count, 1e3 * w->width,
      1e3 * w->height, depth);
  if (exact) announce_exact_edges(&edges);
}

/* "tie        core to left: 17 particles, 0.31 kg of which goes to 18 nodes; 16 bonds count by
   halves" */
void announce_ties(const run *r, int lattice) {
  int count;
  const mesh_tie *ties = simulation_ties(r->simulation, lattice, &count);
  for (int n = 0; n < count; n++) {
    const mesh_tie *t = &ties[n];
    printf("  tie        %s to %s: %ld particles, %.4g kg of them goes to its nodes",
           t->from->lattice, t->from->mesh, t->count,
           mesh_tie_mass(t, simulation_rows(r->simulation, lattice)));
    if (t->half_count > 0) printf("; %ld bonds along its edge count by halves", t->half_count);
    if (t->left_out > 0) printf("; %ld bonds inside it are left out", t->left_out);
    putchar('\n');
  }
}

void announce_body(const run *r, int lattice) {
  const deck_lattice *k = &r->deck->lattices[lattice];
  if (deck_lattice_is_bar(k))
    announce_bar(r, lattice);
  else if (deck_lattice_is_link(k))
    announce_link(r, lattice);
  else if (deck_lattice_is_irregular(k))
    announce_particles(r, lattice);
  else
    announce_lattice(r, lattice);
}
