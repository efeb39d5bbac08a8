/* The strain at which a point of a continuum has no stress: what strains it beside that, and
   whether states move it at all. */
#ifndef PERILAT_GENERATOR_POINT_REST_H
#define PERILAT_GENERATOR_POINT_REST_H

#include "generator/plan/plan.h"

/* elastic[count] (1): the strains, as kernels read them, that stresses [count] (Pa) of a plan's
   graph take from where they are 0, sigma = D:elastic. False where D depends on the strain or on
   states. */
bool point_elastic_strain(const kernel_plan *plan, const ir_node *stress, const ir_node *strain,
                          int count, ir_node *elastic);

/* Whether what a stress is without strain is 0 (Pa) in whatever state: the graph need not show it,
   as of sqrt(x**2) - x, so numbers tell. */
bool point_rest_is_none(const kernel_plan *plan, ir_node rest);

#endif
