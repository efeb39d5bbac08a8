/* The second way to the forces of a mesh, for laws that are not linear or have states: in each step
   every point of integration is asked for its stress, f = sum B^T sigma w t (Hughes 1987, 4.2).

   A strip is a few groups of cells of a row (cell_strips.h): strains of all their points, one call
   of the law, forces. Rows of cells push nodes of several rows; each has planes of its own for
   that, and these are added in one order. So results do not depend on threads.

   Where a row is nothing but rectangles, and the law has a loop from their nodes to their nodes
   (rectangle.h), strains and stresses stay in registers and forces need no planes: they are summed
   from row to row as far as rows are such and one thread finds them (rectangle_rows). The order is
   the same, and so are the bits.

   States stand at points, old ones and new ones, and change places after a step.

   A cell all of whose points have failed is dead: it pushes nothing and strains no more, so that
   nodes that fly away from it do no harm. Which cells these are the states tell at any time. */
#ifndef PERILAT_RUNTIME_POINT_FORCES_H
#define PERILAT_RUNTIME_POINT_FORCES_H

#include "runtime/base/pool.h"
#include "runtime/kernel.h"
#include "runtime/mesh/point_strips.h"
#include "runtime/mesh/point_values.h"

/* What is known of a row of cells in the state observed, J; and how much stiffer than at rest one
   of its points is: the largest eigenvalue of the tangent by that at rest. */
typedef struct point_row {
  double stored, state, rate, given, pending, stiffness;
} point_row;

typedef struct point_forces {
  const mesh *of;
  const integration_points *points;
  const pl_law *law;
  double *uniforms;
  cell_strips strips;
  pool *memory;
  bool loses; /* the law has states or rates, and energies are kept */
  /* [fields][strips.count] SI, when the step begins and after it */
  double *old_field, *new_field;
  double *lost;      /* [PL_LOSSES][strips.count] J/m^3 since the start; NULL unless it loses */
  double *lost_now;  /* [PL_LOSSES][strips.count] by the state observed */
  double *observed;  /* [1 + outputs][strips.count] in the state observed: J/m^3, then outputs */
  double *stress;    /* [PL_STRESSES(2)][strips.count] Pa, in the state observed */
  double *pushed[2]; /* [cell_strips_pushed] N */
  double *size;      /* [strips.count] m: of the points' cells */
  double *parameter; /* [varying][strips.count] SI: those that differ in space */
  point_values shapes;
  double scale[3][3]; /* Pa^(-1/2): L^-1 of the tangent at rest, L L^T */
  double strip;       /* Pa: element_strip_stiffness of that tangent */
  /* Of element_modes.h; NULL without. Mean dilatation: [groups][PL_LANES] 1 where a cell takes it,
     and [strips.count] the point's part of its cell. Hourglass modes: [groups][5][PL_LANES] gamma
     of the corners, and C, N/m. */
  double *mean, *part, *hourglass;
  point_row *rows;               /* [strips.rows] */
  point_strips *parts;           /* groups that are found together */
  unsigned char *whole;          /* [strips.rows] all rectangles, whose law has a loop for them */
  unsigned char *placed;         /* [strips.rows] what pushes its lower nodes is among the forces */
  unsigned char *summed;         /* [strips.rows] and so is what the row below pushes them by */
  int failed;                    /* the law's field that tells so; -1: points do not fail */
  long *dead;                    /* [strips.rows] dead cells after the step */
  double first_death;            /* s: of the first one; negative: all are alive */
  struct point_scratch *scratch; /* [blocks] */
  int blocks;
  long doubles; /* of arrays */
} point_forces;

/* Tangent at rest (Pa), or how the stress there follows the strain rate (Pa s), xx, yy, xy by xx,
   yy, xy; of a law that reads the size of a cell that of the cell where its trace is largest.
   own[cells] marks cells of the law; NULL: all are. */
void point_forces_rest(const mesh *m, const unsigned char *own, const pl_law *law,
                       const double *parameters, bool viscous, double tangent[3][3]);

/* `blocks` threads at most; `ledger`: energies are kept. What is pointed to must outlive it. */
point_forces *point_forces_new(const mesh *m, const unsigned char *own, const integration_points *p,
                               const pl_law *law, const double *parameters, int blocks,
                               bool ledger);
void point_forces_free(point_forces *p);

/* Values of law->varying[k] from now on: nodes[nodes of the mesh], SI. A point has what its shape
   functions make of them; before the first call that of the parameters. Nothing is allocated. */
void point_forces_give(point_forces *p, int k, const double *nodes);

/* The motion that points see: displacements of the present state and velocities half a step before,
   laid out as node_layout. */
typedef struct point_motion {
  const double *const *displacement, *const *velocity; /* [2] m, m/s */
  double time, time_step, advance;                     /* s; `dt` of laws */
} point_motion;

/* Stresses and new states of the points of the rows of cells from <= j < to, and what they push.
   `seen`: of the present state, and not for a step: energies, outputs and stresses are kept, and so
   is how stiff the rows are. force[2]: the planes of the layout that point_forces_take will have,
   where these forces are alone there: some are written at once; NULL: there are others, too. */
void point_forces_find(point_forces *p, int block, int from, int to, const point_motion *at,
                       bool seen, double *const force[2]);
/* N: adds up what pushes a row of nodes, when all blocks have found theirs; force[2]: planes of the
   layout. `more`: to what is there of others. */
void point_forces_take(const point_forces *p, int row, bool more, double *const force[2]);
/* After a step to that time: new states are old ones. */
void point_forces_turn(point_forces *p, double time);

/* Whether a cell of the law is dead, by the states after the last step or by those observed since;
   and how many are. */
bool point_forces_dead(const point_forces *p, int cell);
long point_forces_deaths(const point_forces *p);

/* Whether a cell is of this law and has points. */
static inline bool point_forces_has(const point_forces *p, int cell) {
  return p->strips.of_cell[cell] >= 0;
}
/* Mean of a plane [strips.count] over the points around a node, by their areas; NaN without. */
double point_forces_mean(const point_forces *p, const double *plane, int node);
/* Over the points of a cell; NaN of a cell that is not of the law. */
double point_forces_cell_mean(const point_forces *p, const double *plane, int cell);
/* The node's part of what the cells around it hold, a plane [strips.count] per m^3: their corners
   that are there have equal parts. What a cell without any holds is no node's. */
double point_forces_share(const point_forces *p, const double *plane, int node);

/* How a point is. */
typedef struct point_state {
  int cell[2];                 /* i, j; of a mesh of lists its number and -1 */
  double at[2];                /* m */
  double strain[3], stress[4]; /* Pa */
  double size;                 /* m: of its cell */
  double *field;               /* [fields] of before the step; the caller's memory */
} point_state;
/* Of the points that push a node that with the largest stress, or without a finite one: its square,
   Pa^2; -1: there is none. */
double point_forces_worst(point_forces *p, int node, const point_motion *at, point_state *out);

/* B held, shape tables included. */
long point_forces_bytes(const point_forces *p);

#endif
