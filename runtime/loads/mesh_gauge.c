#include "runtime/loads/mesh_gauge.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/continuum/node_fields.h"
#include "runtime/continuum/point_law.h"
#include "runtime/mesh/mesh_fields.h"

typedef struct node_weight { /* of a node in the mean over the places */
  int32_t site;
  double n, nx, ny; /* of its value; of its part in the gradient, 1/m */
} node_weight;

struct mesh_gauge {
  const deck_monitor *deck;
  const cells *of;
  const loads *loads;
  const body *w;
  point_law *law; /* of a stress; else NULL */
  double *states; /* [law's fields] of the point of integration that is nearest */
  /* [place_count] m, and the node that stands there, or -1 */
  double (*places)[2];
  int *nodes;
  long place_count;
  double *planes[3];    /* of a stress or strain of a region: that of all nodes */
  node_weight *weights; /* [count] with the cracks as they were when there were `pieces` */
  int count, pieces;
};

/* --- set-up ----------------------------------------------------------------------------------- */

static bool has_place(mesh_gauge *g, diagnostics *d) {
  const mesh *m = &g->of->mesh;
  const double *at = g->places[0];
  const int cell = mesh_cell_of(m, at);
  const bool in_hole = holes_hold(&m->holes, at);
  if (cell >= 0 && m->cell[cell] != CELL_ABSENT && !in_hole) return true;
  diag_report(d, DIAG_EMPTY_REGION, deck_where(&g->deck->item, "at"),
              in_hole ? "the place (%.6g, %.6g) mm is in a hole of the mesh"
                      : "the place (%.6g, %.6g) mm is not in the mesh",
              1e3 * at[0], 1e3 * at[1]);
  return false;
}

static bool is_tensor(const deck_monitor *m) {
  return m->kind == MONITOR_STRAIN || m->kind == MONITOR_STRESS;
}

static bool is_of_region(const mesh_gauge *g) {
  return is_tensor(g->deck) && !g->deck->placed;
}

/* What a stress is found with, or fields of a region. */
static void take_law(mesh_gauge *g) {
  if (is_of_region(g))
    for (int k = 0; k < 3; k++)
      g->planes[k] = must_calloc((size_t)g->of->nodes->size, sizeof(double));
  if (is_of_region(g) || g->deck->kind != MONITOR_STRESS) return;
  const cells_law *l = cells_law_at(g->of, mesh_cell_of(&g->of->mesh, g->places[0]));
  g->law = point_law_new(l->law, l->parameters);
  g->states = must_calloc((size_t)l->law->field_count + 1, sizeof *g->states);
}

mesh_gauge *mesh_gauge_new(const deck_monitor *m, const int32_t *sites, long count, const cells *c,
                           const loads *l, const body *w, diagnostics *d) {
  mesh_gauge *g = must_calloc(1, sizeof *g);
  *g = (mesh_gauge){.deck = m, .of = c, .loads = l, .w = w, .pieces = -1};
  g->place_count = m->placed ? 1 : count;
  g->places = must_calloc((size_t)g->place_count + 1, sizeof *g->places);
  g->nodes = must_calloc((size_t)g->place_count + 1, sizeof *g->nodes);
  for (long k = 0; k < g->place_count; k++) {
    g->nodes[k] = m->placed ? -1 : cells_node(c, sites[k]);
    if (m->placed)
      memcpy(g->places[k], m->at, sizeof g->places[k]);
    else
      mesh_place(&c->mesh, g->nodes[k], g->places[k]);
  }
  if (!m->placed || has_place(g, d)) {
    take_law(g);
    return g;
  }
  mesh_gauge_free(g);
  return NULL;
}

void mesh_gauge_free(mesh_gauge *g) {
  if (!g) return;
  point_law_free(g->law);
  free(g->states);
  for (int k = 0; k < 3; k++)
    free(g->planes[k]);
  free(g->places);
  free(g->nodes);
  free(g->weights);
  free(g);
}

/* --- weights ---------------------------------------------------------------------------------- */

/* The value of a node of finite elements is the field there, and its own. */
static bool is_own(const mesh_gauge *g, long k) {
  return g->nodes[k] >= 0 && !g->of->mesh.element_free[g->nodes[k]];
}

static void add_place(const mesh_gauge *g, long k, node_weight *all) {
  const double part = 1.0 / (double)g->place_count;
  const mesh *m = &g->of->mesh;
  point_shape s;
  if (is_own(g, k)) {
    all[g->nodes[k]].n += part;
    return;
  }
  const int cell = mesh_cell_of(m, g->places[k]);
  double at[2];
  memcpy(at, g->places[k], sizeof at);
  if (is_tensor(g->deck)) mesh_strain_place(m, cell, g->places[k], at);
  shape_functions(m, cell, at, &s);
  for (int q = 0; q < s.count; q++) {
    node_weight *to = &all[s.node[q]];
    to->n += part * s.n[q];
    to->nx += part * s.nx[q];
    to->ny += part * s.ny[q];
  }
}

/* As cracks grow, other nodes act at the places. */
static void find_weights(mesh_gauge *g) {
  const int nodes = mesh_node_count(&g->of->mesh);
  if (g->pieces == g->of->mesh.cracks.count) return;
  g->pieces = g->of->mesh.cracks.count;
  g->count = 0;
  node_weight *all = must_calloc((size_t)nodes, sizeof *all);
  for (long k = 0; k < g->place_count; k++)
    add_place(g, k, all);
  for (int n = 0; n < nodes; n++) {
    if (all[n].n == 0 && all[n].nx == 0 && all[n].ny == 0) continue;
    all[g->count] = all[n];
    all[g->count++].site = (int32_t)cells_site(g->of, n);
  }
  free(g->weights);
  g->weights = all;
}

/* --- values ----------------------------------------------------------------------------------- */

static double mean_of(const mesh_gauge *g, const double *plane) {
  double sum = 0;
  for (int k = 0; k < g->count; k++)
    sum += g->weights[k].n * plane[g->weights[k].site];
  return sum;
}

static double motion(const mesh_gauge *g, long step) {
  const int component = g->deck->component;
  double sum = 0;
  for (int k = 0; k < g->count; k++) {
    const velocity_instant v =
        load_steps_velocities(g->loads, g->w, component, g->weights[k].site, step);
    sum += g->weights[k].n * (g->deck->kind == MONITOR_VELOCITY
                                  ? 0.5 * (v.before + v.after)
                                  : (v.after - v.before) / g->w->time_step);
  }
  return sum;
}

static double tensor(const mesh_gauge *g) {
  const mesh *m = &g->of->mesh;
  double gradient[2][2] = {{0}}, strain[3], stress[4];
  for (int k = 0; k < g->count; k++)
    for (int i = 0; i < 2; i++) {
      const node_weight *of = &g->weights[k];
      gradient[i][0] += of->nx * g->w->displacement[i][of->site];
      gradient[i][1] += of->ny * g->w->displacement[i][of->site];
    }
  mesh_strain(gradient, strain);
  cells_mean_dilatation(g->of, mesh_cell_of(m, g->places[0]),
                        (const double *const *)g->w->displacement, strain);
  if (!g->law) return strain[g->deck->component];
  if (cells_states_near(g->of, g->places[0], g->states)) point_law_states(g->law, g->states);
  point_law_stress(g->law, strain, mesh_cell_size(m, mesh_cell_of(m, g->places[0])), stress);
  return stress[g->deck->component];
}

/* As frames show it at the nodes. */
static double tensor_of_region(const mesh_gauge *g) {
  const double *const at[2] = {g->w->displacement[0], g->w->displacement[1]};
  double sum = 0;
  (g->deck->kind == MONITOR_STRESS ? node_field_stress : node_field_strain)(g->of, at, g->planes);
  for (long k = 0; k < g->place_count; k++)
    sum += g->planes[g->deck->component][cells_site(g->of, g->nodes[k])];
  return sum / (double)g->place_count;
}

double mesh_gauge_value(mesh_gauge *g, long step) {
  if (is_of_region(g)) return tensor_of_region(g);
  find_weights(g);
  if (is_tensor(g->deck)) return tensor(g);
  return g->deck->kind == MONITOR_DISPLACEMENT || g->deck->kind == MONITOR_OPENING
             ? mean_of(g, g->w->displacement[g->deck->component])
             : motion(g, step);
}

double mesh_gauge_velocity(mesh_gauge *g) {
  find_weights(g);
  return mean_of(g, g->w->velocity[g->deck->component]);
}
