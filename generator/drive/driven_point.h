/* One point of a continuum under the programs that a mesh runs, compiled or on the interpreter.
   Its old fields stay as they are until a step is accepted. */
#ifndef PERILAT_GENERATOR_DRIVEN_POINT_H
#define PERILAT_GENERATOR_DRIVEN_POINT_H

#include "runtime/kernel.h"

/* Components stand in the order of pl_points; shears are those of the tensors. */
typedef struct strained {
  double strain[PL_MAX_STRAINS], rate[PL_MAX_STRAINS]; /* 1, 1/s */
  double step;                                         /* s: how long it took to get there */
  double advance; /* s: the same, but 0 where states stay as they are: at the beginning */
} strained;

typedef struct stressed {
  double stress[PL_MAX_STRAINS]; /* Pa; in the plane zz stands behind xy */
  double lost[PL_LOSSES];        /* J/m^3 in this step */
} stressed;

typedef struct driven_point {
  const pl_law *kernel;
  int strains, stresses; /* components */
  double *uniforms, *space;
  double **old_field, **new_field, **observed; /* [fields], [fields], [1 + outputs][PL_LANES] */
  double *strain[PL_MAX_STRAINS], *rate[PL_MAX_STRAINS], *cell_size;
  double *stress[PL_MAX_STRAINS], *tangent[PL_MAX_STRAINS * PL_MAX_STRAINS], *lost[PL_LOSSES];
} driven_point;

void driven_point_open(driven_point *p, const pl_law *kernel, const double *parameters,
                       double cell_size);
void driven_point_close(driven_point *p);
/* With other parameters from now on. */
void driven_point_take(driven_point *p, const double *parameters);

void driven_point_set(driven_point *p, int field, double value);
/* Stress and losses; what the fields become waits to be accepted. */
stressed driven_point_step(driven_point *p, const strained *to);
void driven_point_accept(driven_point *p);
/* Stored energy, J/m^3; outputs stand in `observed`. */
double driven_point_observe(driven_point *p, const strained *at);
/* Pa, by the strains, where shears are those of engineers. */
void driven_point_tangent(driven_point *p, const strained *at,
                          double tangent[PL_MAX_STRAINS][PL_MAX_STRAINS]);

/* "xx", ...: of component k of the stresses. */
const char *point_component_name(int dimensions, int k);
/* Whether it is one of shear. */
int point_is_shear(int dimensions, int k);

#endif
