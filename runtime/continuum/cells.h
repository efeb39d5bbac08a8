/* The cells of a mesh with their laws: what a mesh consists of, masses of its nodes, its stiffness
   at rest and the longest stable step; what is known of its points. A mesh may have several laws,
   by cells (cell_laws.h): those that are linear have one stiffness together. What they do in a
   step: cells_engine.h. */
#ifndef PERILAT_RUNTIME_CELLS_H
#define PERILAT_RUNTIME_CELLS_H

#include "dsl/base/diagnostics.h"
#include "runtime/analysis/step_limit.h"
#include "runtime/continuum/cell_laws.h"
#include "runtime/continuum/node_matrix.h"
#include "runtime/continuum/node_stencil.h"
#include "runtime/continuum/point_forces.h"
#include "runtime/continuum/tips.h"
#include "runtime/deck/deck.h"

/* How many times as stiff as at rest the stiffest point is: in the state observed last, and at most
   so far; 1 of linear laws. */
typedef struct cells_stiffened {
  double now, most;
  double since; /* s: the step is longer than is safe for that; -1: never so far */
} cells_stiffened;

/* A law with its parameters, neither owned. */
typedef struct cells_law {
  const pl_law *law;
  const double *parameters;
} cells_law;

typedef struct cells {
  const rows *nodes; /* the mesh's, not owned */
  double beta_1;
  mesh mesh;
  integration_points points;
  cell_laws where;            /* each law has its cells */
  cells_law *laws;            /* [where.count] */
  plane_stiffness *stiffness; /* [where.count] at rest */
  node_stencil stencil;       /* of linear laws; in a mesh of lists */
  node_matrix matrix;
  bool has_stencil, has_matrix;
  unsigned char *linear; /* [cells] where.of_cell, NO_LINEAR_LAW where it is not; NULL of one law */
  point_forces *
      *by_points; /* [where.count] of the others, once the run has begun; NULL of linear ones */
  cells_stiffened stiffened;
  tips *tips; /* of its cracks; NULL without */
} cells;

/* Of the deck's lattice of that number, a &mesh; its nodes learn what volume each stands for.
   NULL with diagnostics. */
cells *cells_new(const deck *k, int lattice, rows *nodes, diagnostics *d);
void cells_free(cells *c);

/* Where a node stands in memory, and which node stands there; its particle, -1 of one in a hole. */
long cells_site(const cells *c, int node);
int cells_node(const cells *c, long site);
int32_t cells_particle(const cells *c, int node);

/* laws[where.count] */
void cells_take_laws(cells *c, const cells_law *laws);
/* density[where.count] kg/m^3; at each site that of its node's mass and volume. */
void cells_densities(const cells *c, const double *density, double *at_site);
/* node[nodes] becomes 1 where cells of laws that are not linear push. */
void cells_mark_pushed(const cells *c, unsigned char *node);
/* Some of the laws are linear, or all. */
bool cells_some_linear(const cells *c);
bool cells_all_linear(const cells *c);
/* A point's strain as the law sees it, in a cell whose dilatation is the mean (element_modes.h);
   displacement: planes of the body. */
void cells_mean_dilatation(const cells *c, int cell, const double *const displacement[2],
                           double strain[3]);
/* The longest stable step at rest; held[2 p + d]: freedoms of particles that do not move by
   themselves. */
void cells_step_limit(const cells *c, const unsigned char *held, step_limit *limit);

/* After a state was observed, at that time: how stiff points are. `part` of the longest step at
   rest is taken. No frequency of the mesh is above the root of `stiffened.now` times the highest at
   rest. */
void cells_watch_stiffness(cells *c, double part, double time);
/* Of the state observed last, with a law that is not linear; false with one that is, whose points
   keep nothing. Stress xx, yy, xy, zz (Pa) at a node: the mean of the points in the law's cells
   around. */
bool cells_mean_stress(const cells *c, int law, int node, double stress[4]);
/* Whether points of some law can fail; whether a cell is dead after the last step, as all of its
   points have failed; how many are, and when the first one died (s; infinite: none did). */
bool cells_can_die(const cells *c);
bool cells_dead(const cells *c, int cell);
long cells_deaths(const cells *c, double *first);
/* Whether a cell and all of its nodes are there: results hold those, in their order; how many
   are. */
bool cells_whole(const cells *c, int cell);
long cells_whole_count(const cells *c);
/* values[whole cells]: of the cells of a law that is not linear the means over their points of a
   state after the last step, or of an output in the state observed last; others are left as they
   are. */
void cells_mean_state(const cells *c, int law, int field, double *values);
void cells_mean_output(const cells *c, int law, int output, double *values);
/* The law of a cell. */
static inline const cells_law *cells_law_at(const cells *c, int cell) {
  return &c->laws[cell_laws_at(&c->where, cell)];
}
/* field[law's fields]: states of the point that is nearest to a place (m) in the mesh. */
bool cells_states_near(const cells *c, const double at[2], double *field);
/* B, of what the body does not count. */
double cells_bytes(const cells *c);

#endif
