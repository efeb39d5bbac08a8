#include "runtime/continuum/mesh_ties.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/stability.h"
#include "runtime/continuum/mesh_build.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/mesh/shape_functions.h"

/* In spacings of the lattice: how far outside of the mesh a particle is still on its edge, as decks
   are written with a few digits; and how far from a bond's middle it is looked on which side the
   mesh is. */
static const double ON_EDGE = 2e-3, ASIDE = 0.05;
/* From which distance on, in spacings, a free particle next to the mesh is as it should be. */
static const double BESIDE = 0.7;

typedef struct tier {
  const deck *deck;
  const deck_tie *from;
  rows *lattice;
  mesh mesh;
  mesh_tie *tie;
  int32_t *number; /* [particles of the lattice] of the tied one + 1; 0: free */
  diagnostics *d;
} tier;

static int cell_at(const mesh *m, double x, double y) {
  const int cell = mesh_cell_of(m, (double[2]){x, y});
  return cell >= 0 && m->cell[cell] != CELL_ABSENT ? cell : -1;
}

/* The cell that a particle is in, or on the edge of; -1: none. */
static int cell_of(const tier *t, const double at[3]) {
  const double away = ON_EDGE * t->lattice->spacing;
  int cell = cell_at(&t->mesh, at[0], at[1]);
  for (int j = -1; j <= 1 && cell < 0; j++)
    for (int i = -1; i <= 1 && cell < 0; i++)
      cell = cell_at(&t->mesh, at[0] + i * away, at[1] + j * away);
  return cell;
}

/* Of a disc as wide as a spacing around the particle, on rings of equal areas; no direction of
   points is one of lattices. */
static double part_outside(const tier *t, const double at[3]) {
  enum { RINGS = 6, POINTS = 60 };
  int outside = 0;
  for (int r = 0; r < RINGS; r++) {
    const double radius = 0.5 * t->lattice->spacing * sqrt((r + 0.5) / RINGS);
    for (int p = 0; p < POINTS; p++) {
      const double angle = 2 * M_PI * (p + 0.5) / POINTS;
      outside +=
          cell_at(&t->mesh, at[0] + radius * pl_cos(angle), at[1] + radius * pl_sin(angle)) < 0;
    }
  }
  return (double)outside / (RINGS * POINTS);
}

/* False after a message: no cell of finite elements. */
static bool tie_particle(tier *t, int32_t particle, const double at[3], int cell) {
  point_shape s;
  tied_particle *p = &t->tie->particles[t->tie->count];
  if (t->mesh.cell[cell] != CELL_ELEMENT) {
    char text[ROWS_PLACE_TEXT];
    diag_report(
        t->d, DIAG_NOT_SUPPORTED, t->from->item.where,
        "the particle of `%s` at %s lies in an element-free cell of `%s`: it cannot be tied",
        t->from->lattice, rows_place_text(2, at, text), t->from->mesh);
    diag_hint(t->d,
              "make the cells there finite elements: &zone mesh = '%s' method = "
              "'finite_elements' ...",
              t->from->mesh);
    return false;
  }
  if (t->mesh.lists && t->mesh.lists->nodes[cell] == 6) {
    char text[ROWS_PLACE_TEXT];
    diag_report(
        t->d, DIAG_NOT_SUPPORTED, t->from->item.where,
        "the particle of `%s` at %s lies in a triangle of 6 nodes of `%s`: it cannot be tied, "
        "as its mass would be negative at corners",
        t->from->lattice, rows_place_text(2, at, text), t->from->mesh);
    diag_hint(t->d, "mesh the body with triangles of 3 nodes (Mesh.ElementOrder = 1)");
    return false;
  }
  shape_functions(&t->mesh, cell, at, &s);
  *p = (tied_particle){.particle = particle, .outside = part_outside(t, at)};
  for (int k = 0; k < s.count && p->count < TIED_MOST_NODES; k++) {
    if (fabs(s.n[k]) < 1e-9) continue;
    p->node[p->count] = s.node[k];
    p->weight[p->count++] = s.n[k];
  }
  t->number[particle] = (int32_t)++t->tie->count;
  return true;
}

static bool tie_particles(tier *t) {
  const rows *g = t->lattice;
  t->tie->particles = must_calloc((size_t)g->particle_count + 1, sizeof *t->tie->particles);
  for (long p = 0; p < g->particle_count; p++) {
    double at[3];
    rows_place(g, g->particle_site[p], at);
    const int cell = cell_of(t, at);
    if (cell >= 0 && !tie_particle(t, (int32_t)p, at, cell)) return false;
  }
  if (t->tie->count > 0 && t->tie->count < g->particle_count) return true;
  diag_report(t->d, DIAG_EMPTY_REGION, t->from->item.where,
              t->tie->count > 0 ? "all particles of `%s` lie in the mesh `%s`"
                                : "no particle of `%s` lies in the mesh `%s`, or on its edge",
              t->from->lattice, t->from->mesh);
  diag_hint(t->d, "let a row of the lattice, and no more of it, stand on the edge of the mesh");
  return false;
}

/* --- bonds ------------------------------------------------------------------------------------ */

static bool is_tied(const tier *t, long site) {
  const int32_t p = t->lattice->site_particle[site];
  return p >= 0 && t->number[p] > 0;
}

/* On how many sides of the bond's middle the mesh is. */
static int sides_in_mesh(const tier *t, long from, long to) {
  double a[3], b[3];
  rows_place(t->lattice, from, a);
  rows_place(t->lattice, to, b);
  const double x = 0.5 * (a[0] + b[0]), y = 0.5 * (a[1] + b[1]),
               length = pl_hypot(b[0] - a[0], b[1] - a[1]);
  const double away = ASIDE * t->lattice->spacing / length, dx = away * (b[1] - a[1]),
               dy = away * (b[0] - a[0]);
  return (cell_at(&t->mesh, x + dx, y - dy) >= 0) + (cell_at(&t->mesh, x - dx, y + dy) >= 0);
}

static void take_bond_away(rows *g, long site, int direction) {
  g->bonds[site] &= ~(UINT64_C(1) << direction);
  g->held_bonds[site] &= ~(UINT64_C(1) << direction);
  if (g->list) g->list->incoming[rows_partner(g, site, direction)] &= ~(UINT64_C(1) << direction);
}

static void take_half(mesh_tie *tie, long site, int direction) {
  tie->halves = must_realloc(tie->halves, ((size_t)tie->half_count + 1) * sizeof *tie->halves);
  tie->halves[tie->half_count++] = (tied_bond){site, direction};
}

static void sort_bonds(tier *t, bool halves) {
  rows *g = t->lattice;
  for (long p = 0; p < g->particle_count; p++) {
    const long site = g->particle_site[p];
    for (int k = 0; k < g->directions; k++) {
      if (!rows_has_bond(g, site, k)) continue;
      const long other = rows_partner(g, site, k);
      if (!is_tied(t, site) || !is_tied(t, other)) continue;
      const int sides = sides_in_mesh(t, site, other);
      if (sides == 0 || (sides == 1 && !halves)) continue;
      take_bond_away(g, site, k);
      if (sides == 1)
        take_half(t->tie, site, k);
      else
        t->tie->left_out++;
    }
  }
  rows_count_bonds(g);
}

/* Tied particles that lie deeper than on the edge, with bonds to free ones: in between there are
   bonds and cells. */
static void warn_of_overlap(const tier *t) {
  const double on_the_edge = 0.45;
  const rows *g = t->lattice;
  long deep = 0;
  for (long n = 0; n < t->tie->count; n++) {
    const tied_particle *p = &t->tie->particles[n];
    const long site = g->particle_site[p->particle];
    bool bound = false;
    for (int k = 0; k < 2 * g->directions; k++)
      bound = bound || (rows_has_neighbour(g, site, k) && !is_tied(t, rows_partner(g, site, k)));
    deep += bound && p->outside < on_the_edge;
  }
  if (deep == 0) return;
  diag_report(t->d, DIAG_DECK_WARNING, t->from->item.where,
              "%ld particle%s of `%s` that hold%s on to free ones lie%s inside of `%s`, not on its "
              "edge: what "
              "is between counts twice, and waves are thrown back there",
              deep, deep == 1 ? "" : "s", t->from->lattice, deep == 1 ? "s" : "",
              deep == 1 ? "s" : "", t->from->mesh);
  diag_hint(t->d, "let the mesh's edge run along a row of sites: `rotation` turns the lattice");
}

/* Nearer to the mesh than half a row, but not in it. */
static bool is_beside(const tier *t, const double at[3]) {
  enum { POINTS = 48 };
  const double radius = BESIDE * t->lattice->spacing;
  bool beside = false;
  for (int p = 0; p < POINTS && !beside; p++) {
    const double angle = 2 * M_PI * (p + 0.5) / POINTS;
    beside = cell_at(&t->mesh, at[0] + radius * pl_cos(angle), at[1] + radius * pl_sin(angle)) >= 0;
  }
  return beside;
}

static void warn_of_gap(const tier *t) {
  const rows *g = t->lattice;
  long free = 0;
  double at[3], first[3];
  char text[ROWS_PLACE_TEXT];
  for (long p = 0; p < g->particle_count; p++) {
    rows_place(g, g->particle_site[p], at);
    if (t->number[p] > 0 || !is_beside(t, at)) continue;
    if (free++ == 0) memcpy(first, at, sizeof first);
  }
  if (free == 0) return;
  diag_report(
      t->d, DIAG_DECK_WARNING, t->from->item.where,
      "%ld particle%s of `%s`, such as that at %s, %s beside `%s`, but not on its edge: what is "
      "between is in neither",
      free, free == 1 ? "" : "s", t->from->lattice, rows_place_text(2, first, text),
      free == 1 ? "stands" : "stand", t->from->mesh);
  diag_hint(t->d,
            "let a row of sites stand on the edge, or the lattice reach into the mesh: particles "
            "there are tied");
}

/* --- all of them ------------------------------------------------------------------------------ */

static bool open_tie(tier *t, bool halves) {
  t->tie->mesh = deck_find_lattice(t->deck, t->from->mesh);
  if (t->tie->mesh < 0) return false;
  diagnostics quiet;
  diag_begin(&quiet, t->d->sources);
  const bool built = mesh_build(t->deck, t->tie->mesh, &t->mesh, &quiet);
  diag_clear(&quiet);
  const bool good = built && tie_particles(t);
  if (good) {
    sort_bonds(t, halves);
    warn_of_overlap(t);
    warn_of_gap(t);
  }
  mesh_close(&t->mesh);
  return good;
}

/* A particle goes with one mesh. */
static bool none_twice(const tier *t, unsigned char *taken) {
  for (long n = 0; n < t->tie->count; n++) {
    const int32_t p = t->tie->particles[n].particle;
    if (taken[p]) {
      double at[3];
      char text[ROWS_PLACE_TEXT];
      rows_place(t->lattice, t->lattice->particle_site[p], at);
      diag_report(t->d, DIAG_CONFLICT, t->from->item.where,
                  "the particle of `%s` at %s lies in two meshes: it cannot be tied to both",
                  t->from->lattice, rows_place_text(2, at, text));
      diag_hint(t->d, "meshes do not touch each other: let lattice be between them");
      return false;
    }
    taken[p] = 1;
  }
  return true;
}

void mesh_ties_free(mesh_tie *ties, int count) {
  for (int n = 0; n < count; n++) {
    free(ties[n].particles);
    free(ties[n].halves);
  }
  free(ties);
}

mesh_tie *mesh_ties_new(const deck *k, int lattice, rows *w, bool halves, int *count,
                        diagnostics *d) {
  mesh_tie *ties = must_calloc((size_t)k->tie_count + 1, sizeof *ties);
  const size_t particles = (size_t)w->particle_count + 1;
  unsigned char *taken = must_calloc(particles, 1);
  bool good = true;
  *count = 0;
  for (int n = 0; n < k->tie_count && good; n++) {
    if (strcmp(k->ties[n].lattice, k->lattices[lattice].name) != 0) continue;
    tier t = {.deck = k, .from = &k->ties[n], .lattice = w, .tie = &ties[*count], .d = d};
    t.tie->from = t.from;
    t.number = must_calloc(particles, sizeof *t.number);
    ++*count;
    good = open_tie(&t, halves) && none_twice(&t, taken);
    free(t.number);
  }
  free(taken);
  if (good && *count > 0) return ties;
  mesh_ties_free(ties, *count);
  *count = 0;
  return NULL;
}

/* --- masses and the step ---------------------------------------------------------------------- */

static double mass_of(const rows *w, const tied_particle *p) {
  return w->site_mass ? w->site_mass[w->particle_site[p->particle]] : w->mass;
}

double mesh_tie_mass(const mesh_tie *t, const rows *w) {
  double sum = 0;
  for (long n = 0; n < t->count; n++)
    sum += t->particles[n].outside * mass_of(w, &t->particles[n]);
  return sum;
}

/* Of functions that are negative somewhere, too: (sum N u)^2 <= sum |N| sum |N| u^2. */
void mesh_tie_add(const mesh_tie *t, const rows *w, tied_node *node) {
  for (long n = 0; n < t->count; n++) {
    const tied_particle *p = &t->particles[n];
    double size = 0;
    for (int k = 0; k < p->count; k++)
      size += fabs(p->weight[k]);
    for (int k = 0; k < p->count; k++) {
      node[p->node[k]].added += p->outside * p->weight[k] * mass_of(w, p);
      node[p->node[k]].whole += size * fabs(p->weight[k]) * mass_of(w, p);
    }
  }
}

/* omega^2 (1/s^2) and damping c (1/s) of a limit: the step is 2/p with p^2 = omega^2 + p c. */
static void rates_of(const step_limit *l, double *square, double *damping) {
  const double p = 2 / l->limit;
  *square = pl_fmin(l->omega_max * l->omega_max, p * p);
  *damping = (p * p - *square) / p;
}

bool mesh_tie_limit(const tied_node *node, int nodes, const step_limit *of_mesh,
                    const step_limit *of_lattice, step_limit *together) {
  double square[2], damping[2], most[2];
  rates_of(of_mesh, &square[0], &damping[0]);
  rates_of(of_lattice, &square[1], &damping[1]);
  most[0] = square[1];
  most[1] = damping[1];
  for (int n = 0; n < nodes; n++) {
    const double mass = node[n].mass + node[n].added;
    if (!(mass > 0)) continue;
    most[0] = pl_fmax(most[0], (square[0] * node[n].mass + square[1] * node[n].whole) / mass);
    most[1] = pl_fmax(most[1], (damping[0] * node[n].mass + damping[1] * node[n].whole) / mass);
  }
  const double fastest = 0.5 * (most[1] + sqrt(most[1] * most[1] + 4 * most[0]));
  const double limit = stability_rounded(2 / fastest);
  if (!(limit < together->limit)) return false;
  together->limit = limit;
  together->omega_max = sqrt(most[0]);
  together->damping_ratio = most[1] / (2 * together->omega_max);
  return true;
}
