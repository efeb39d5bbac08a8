/* A law of a continuum at a single point in the plane: stress, stored energy, tangent. Points in
   strips are what steps use; this is for what is asked now and then. */
#ifndef PERILAT_RUNTIME_POINT_LAW_H
#define PERILAT_RUNTIME_POINT_LAW_H

#include <stdbool.h>

#include "runtime/kernel.h"

/* Which of the law's fields is 1 where a point has failed; -1: points do not fail. */
int point_law_failed(const pl_law *law);

/* Whether it asks how large the cell of a point is. */
bool point_law_reads_size(const pl_law *law);

typedef struct point_law point_law;

/* parameters[law->parameter_count], SI. Both must outlive it. */
point_law *point_law_new(const pl_law *law, const double *parameters);
void point_law_free(point_law *p);

/* States from now on, [law->field_count] SI; NULL: those of a virgin point, as at first. */
void point_law_states(point_law *p, const double *field);

/* All at a strain xx, yy, xy (of tensors), at rest, in a cell of the size h (m). */
/* Stress xx, yy, xy, zz, Pa. */
void point_law_stress(point_law *p, const double strain[3], double h, double stress[4]);
/* Stored energy, J/m^3, and the law's outputs: observed[1 + law->output_count]. */
void point_law_observe(point_law *p, const double strain[3], double h, double *observed);
/* xx, yy, xy by xx, yy, xy, Pa; shears of strains are those of engineers. */
void point_law_tangent(point_law *p, const double strain[3], double h, double tangent[3][3]);
/* How the stress at rest, without strain, follows the strain rate, Pa s: as a tangent. */
void point_law_viscosity(point_law *p, double h, double viscosity[3][3]);

#endif
