#include "runtime/simulation/modes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/lowest_modes.h"
#include "runtime/base/random_number.h"
#include "runtime/simulation/simulation_state.h"

/* Small against any strain that a law makes a difference at. */
static const double tiny = 1e-7; /* spacings, or rad */
/* An eigenvalue less than this part of the largest, or than what the two halves of the matrix
   differ by, is what rounding leaves of 0. */
static const double nothing = 1e-13;

typedef struct freedom { /* a component of a particle that nothing holds */
  int body, component;
  long site;
  double scale; /* 1/sqrt(mass) */
} freedom;

typedef struct whole { /* all bodies: what forces are found of */
  run_body *bodies;
  int body_count;
  run_link *links;
  int link_count;
  long *first_node; /* [body_count + 1] its particles, but of links, are nodes */
  long *first;      /* [nodes + 1] the freedoms of a node */
  freedom *freedoms;
  double **kept;     /* [2 body_count] places and velocities, all components */
  long **freedom_at; /* [body_count][dof * size] or -1 */
} whole;

/* --- what is free ----------------------------------------------------------------------------- */

static size_t values_of(const run_body *b) {
  return (size_t)(b->body->dof * b->lattice_rows->size);
}

static void number_nodes(whole *w) {
  w->first_node = must_calloc((size_t)w->body_count + 1, sizeof *w->first_node);
  for (int b = 0; b < w->body_count; b++)
    w->first_node[b + 1] = w->first_node[b] + run_body_particles(&w->bodies[b]);
}

/* Held components are -1, all others 0. */
static long *mark_held(const run_body *b) {
  long *at = must_calloc(values_of(b) + 1, sizeof *at);
  for (long i = 0; i < b->loads->constraint_count; i++) {
    const constraint *c = &b->loads->constraints[i];
    at[c->component * b->lattice_rows->size + c->site] = -1;
  }
  return at;
}

static void number_freedoms(whole *w) {
  const long nodes = w->first_node[w->body_count];
  size_t most = 1;
  for (int b = 0; b < w->body_count; b++)
    most += (size_t)(w->bodies[b].body->dof * run_body_particles(&w->bodies[b]));
  w->first = must_calloc((size_t)nodes + 1, sizeof *w->first);
  w->freedoms = must_alloc(most * sizeof *w->freedoms);
  w->freedom_at = must_calloc((size_t)w->body_count, sizeof *w->freedom_at);
  long count = 0;
  for (int b = 0; b < w->body_count; b++) {
    const run_body *of = &w->bodies[b];
    w->freedom_at[b] = mark_held(of);
    for (long p = 0; p < run_body_particles(of); p++) {
      const long site = of->lattice_rows->particle_site[p];
      for (int d = 0; d < of->body->dof; d++) {
        long *at = &w->freedom_at[b][d * of->lattice_rows->size + site];
        if (*at < 0) continue;
        w->freedoms[ *at = count++] = (freedom){b, d, site, 1 / sqrt(body_mass(of->body, d, site))};
      }
      w->first[w->first_node[b] + p + 1] = count;
    }
  }
}

/* --- who feels whom --------------------------------------------------------------------------- */

typedef struct pair_list {
  int32_t (*pairs)[2];
  long count, room;
} pair_list;

static void add_pair(pair_list *l, long a, long b) {
  if (l->count == l->room) {
    l->room = 2 * l->room + 1024;
    l->pairs = must_realloc(l->pairs, (size_t)l->room * sizeof *l->pairs);
  }
  l->pairs[l->count][0] = (int32_t)a;
  l->pairs[l->count++][1] = (int32_t)b;
}

/* Over so many bonds the forces of the laws reach at most. */
static int longest_reach(const whole *w) {
  int most = 1;
  for (int b = 0; b < w->body_count; b++)
    for (int n = 0; n < w->bodies[b].law_count; n++) {
      const pl_law *law = w->bodies[b].laws[n].law;
      if (law->kind == PL_STATE && !law->pairwise && law->step.pass_count > most)
        most = law->step.pass_count;
    }
  return most;
}

/* Among a body's own particles. */
static sparse_graph graph_of(const run_body *b, int steps) {
  rows_bond *bonds = rows_bonds(b->lattice_rows);
  pair_list l = {.count = 0};
  for (long m = 0; m < b->lattice_rows->bond_count; m++)
    add_pair(&l, bonds[m].i, bonds[m].j);
  sparse_graph one = sparse_graph_new(b->lattice_rows->particle_count, l.pairs, l.count);
  sparse_graph reach = sparse_graph_reach(&one, steps);
  sparse_graph_free(&one);
  free(l.pairs);
  free(bonds);
  return reach;
}

enum { MOST_FOLLOWED = ROWS_MOST_COPIED + 3 };

/* The nodes that a particle is, or that a copy follows. */
static int nodes_of(const whole *w, int b, long particle, long nodes[MOST_FOLLOWED]) {
  const rows *g = w->bodies[b].lattice_rows;
  if (!g->copies) {
    nodes[0] = w->first_node[b] + particle;
    return 1;
  }
  const rows_copy *c = &g->copies[particle];
  const long bar = w->first_node[g->copies[0].lattice];
  int count = 0;
  for (int k = 0; k < c->count; k++)
    nodes[count++] = w->first_node[c->lattice] + c->particle[k];
  if (!c->along) return count;
  nodes[count++] = bar + c->at;
  nodes[count++] = bar + c->before;
  nodes[count++] = bar + c->after;
  return count;
}

static void add_pairs(const whole *w, int b, long p, long q, pair_list *l) {
  long near[MOST_FOLLOWED], far[MOST_FOLLOWED];
  const int here = nodes_of(w, b, p, near), there = nodes_of(w, b, q, far);
  for (int i = 0; i < here; i++)
    for (int k = 0; k < there; k++)
      if (near[i] != far[k]) add_pair(l, near[i], far[k]);
}

static sparse_graph graph_of_all(const whole *w, int steps) {
  pair_list l = {.count = 0};
  for (int b = 0; b < w->body_count; b++) {
    sparse_graph own = graph_of(&w->bodies[b], steps);
    for (long p = 0; p < own.count; p++)
      for (long k = own.begin[p]; k < own.begin[p + 1]; k++)
        if (own.near[k] >= p) add_pairs(w, b, p, own.near[k], &l);
    sparse_graph_free(&own);
  }
  const sparse_graph all = sparse_graph_new(w->first_node[w->body_count], l.pairs, l.count);
  free(l.pairs);
  return all;
}

/* --- forces ----------------------------------------------------------------------------------- */

static void keep_state(whole *w) {
  w->kept = must_calloc(2 * (size_t)w->body_count, sizeof *w->kept);
  for (int b = 0; b < w->body_count; b++) {
    const run_body *of = &w->bodies[b];
    const size_t size = (size_t)of->lattice_rows->size;
    for (int rates = 0; rates < 2; rates++) {
      double *const *from = rates ? of->body->velocity : of->body->displacement;
      double *kept = w->kept[2 * b + rates] = must_alloc((values_of(of) + 1) * sizeof *kept);
      for (int d = 0; d < of->body->dof; d++) {
        memcpy(kept + (size_t)d * size, from[d], size * sizeof *kept);
        memset(from[d], 0, size * sizeof *kept);
      }
    }
  }
}

static void put_back(const whole *w) {
  for (int b = 0; b < w->body_count; b++) {
    const run_body *of = &w->bodies[b];
    const size_t size = (size_t)of->lattice_rows->size;
    for (int rates = 0; rates < 2; rates++) {
      double *const *into = rates ? of->body->velocity : of->body->displacement;
      for (int d = 0; d < of->body->dof; d++)
        memcpy(into[d], w->kept[2 * b + rates] + (size_t)d * size, size * sizeof(double));
      free(w->kept[2 * b + rates]);
    }
  }
  for (int k = 0; k < w->link_count; k++)
    w->links[k].known = false;
  free(w->kept);
}

static void find_forces(const whole *w) {
  for (int b = 0; b < w->body_count; b++)
    if (!run_body_is_link(&w->bodies[b])) sweep_find_forces(w->bodies[b].state);
  for (int k = 0; k < w->link_count; k++) {
    w->links[k].known = false;
    run_link_begin(&w->links[k]);
  }
}

static long count_of(const whole *w) {
  return w->first[w->first_node[w->body_count]];
}

/* The longest way of the motion x, in spacings; of a rotation that of what is a spacing off. */
static double longest_way(const whole *w, const double *x) {
  double most = 0;
  for (long k = 0; k < count_of(w); k++) {
    const freedom *f = &w->freedoms[k];
    const body *of = w->bodies[f->body].body;
    const double spaced = body_turns(of, f->component) ? 1 : of->lattice->spacing;
    most = pl_fmax(most, fabs(f->scale * x[k]) / spaced);
  }
  return most;
}

static void move(const whole *w, const double *x, double factor) {
  for (long k = 0; k < count_of(w); k++) {
    const freedom *f = &w->freedoms[k];
    w->bodies[f->body].body->displacement[f->component][f->site] = factor * f->scale * x[k];
  }
}

static void add_forces(const whole *w, double factor, double *y) {
  for (long k = 0; k < count_of(w); k++) {
    const freedom *f = &w->freedoms[k];
    y[k] += factor * f->scale * w->bodies[f->body].body->force[f->component][f->site];
  }
  for (int b = 0; b < w->body_count && w->link_count > 0; b++) {
    const loads *l = w->bodies[b].loads;
    for (long i = 0; i < l->force_count; i++) {
      const applied *f = &l->forces[i];
      const long k = w->freedom_at[b][f->component * w->bodies[b].lattice_rows->size + f->site];
      if (f->link && k >= 0) y[k] += factor * w->freedoms[k].scale * f->share * *f->link;
    }
  }
}

/* y = M^-1/2 K M^-1/2 x, by central differences. */
static void multiply(void *of, const double *x, double *y) {
  const whole *w = of;
  const double size = tiny / longest_way(w, x);
  memset(y, 0, (size_t)count_of(w) * sizeof *y);
  for (int side = 1; side >= -1; side -= 2) {
    move(w, x, side * size);
    find_forces(w);
    add_forces(w, -side / (2 * size), y);
  }
  move(w, x, 0);
}

/* The matrix makes of a motion of all particles what the laws make of it. */
static bool is_whole(whole *w, const sparse_matrix *m) {
  static const double same = 1e-8;
  const size_t count = (size_t)m->order;
  double *x = must_alloc(count * sizeof *x), *y = must_alloc(count * sizeof *y),
         *z = must_alloc(count * sizeof *z), gap = 0, size = 0;
  for (size_t k = 0; k < count; k++)
    x[k] = random_unit(random_mix((uint64_t)k)) - 0.5;
  multiply(w, x, y);
  sparse_multiply(m, x, z);
  for (size_t k = 0; k < count; k++) {
    gap += (y[k] - z[k]) * (y[k] - z[k]);
    size += y[k] * y[k];
  }
  free(x);
  free(y);
  free(z);
  return gap <= same * same * size;
}

/* Few passes of a law reach over a further bond: longer reaches are tried as they are needed. */
static sparse_matrix stiffness_of(whole *w) {
  const int most = longest_reach(w);
  sparse_matrix m;
  keep_state(w);
  for (int steps = 1;; steps++) {
    sparse_graph graph = graph_of_all(w, steps);
    m = sparse_probe(&graph, w->first, multiply, w);
    sparse_graph_free(&graph);
    if (steps == most || is_whole(w, &m)) break;
    sparse_matrix_free(&m);
  }
  put_back(w);
  return m;
}

/* --- modes ------------------------------------------------------------------------------------ */

/* The last digits differ between libraries: all arrive at one decimal number. */
static double rounded(double omega) {
  char digits[40];
  snprintf(digits, sizeof digits, "%.5e", omega);
  return strtod(digits, NULL);
}

static void take_shape(const whole *w, const double *x, mode *m) {
  double largest = 0;
  m->shape = must_calloc((size_t)w->body_count, sizeof *m->shape);
  for (int b = 0; b < w->body_count; b++)
    m->shape[b] = must_calloc(values_of(&w->bodies[b]) + 1, sizeof(double));
  for (long k = 0; k < count_of(w); k++)
    if (fabs(x[k]) > fabs(largest)) largest = x[k];
  for (long k = 0; k < count_of(w); k++) {
    const freedom *f = &w->freedoms[k];
    const rows *g = w->bodies[f->body].lattice_rows;
    m->shape[f->body][f->component * g->size + f->site] = (largest < 0 ? -1 : 1) * f->scale * x[k];
    m->share[f->component < g->dimensions ? f->component : MODES_SHARES - 1] += x[k] * x[k];
  }
}

static mode mode_of(const whole *w, const lowest_mode *from) {
  mode m = {.omega = rounded(sqrt(from->value)), .residual = 0.5 * from->residual / from->value};
  take_shape(w, from->vector, &m);
  return m;
}

static const char *find(whole *w, int most, mode *modes, mode_count *count) {
  sparse_matrix a = stiffness_of(w);
  lowest_mode *lowest = must_calloc((size_t)most + 1, sizeof *lowest);
  const char *why = !isfinite(a.size) ? "the laws give no finite forces"
                    : a.size == 0     ? "nothing holds their particles together"
                                      : NULL;
  if (!why)
    why = lowest_modes_find(&a, nothing * a.size + a.asymmetry, most, lowest, &count->found,
                            &count->rigid);
  for (int k = 0; k < count->found; k++)
    modes[k] = mode_of(w, &lowest[k]);
  lowest_modes_free(lowest, count->found);
  free(lowest);
  sparse_matrix_free(&a);
  return why;
}

_Static_assert((int)MODES_MOST_RIGID == (int)LOWEST_MOST_ZEROS, "as many are counted");

static bool has_mesh(const simulation *s) {
  for (int b = 0; b < s->body_count; b++)
    if (s->bodies[b].cells) return true;
  return false;
}

const char *modes_find(simulation *s, int most, mode *modes, mode_count *count) {
  if (has_mesh(s)) {
    *count = (mode_count){0};
    return "modes of meshes are not sought";
  }
  whole w = {.bodies = s->bodies,
             .body_count = s->body_count,
             .links = s->links,
             .link_count = s->link_count};
  number_nodes(&w);
  number_freedoms(&w);
  *count = (mode_count){.freedoms = count_of(&w)};
  const char *why = count->freedoms == 0 ? "nothing can move" : find(&w, most, modes, count);
  for (int b = 0; b < w.body_count; b++)
    free(w.freedom_at[b]);
  free(w.freedom_at);
  free(w.first_node);
  free(w.first);
  free(w.freedoms);
  return why;
}

void modes_free(mode *modes, int count, int body_count) {
  for (int k = 0; k < count; k++) {
    for (int b = 0; b < body_count; b++)
      free(modes[k].shape[b]);
    free(modes[k].shape);
  }
}
