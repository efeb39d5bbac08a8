/* The programs of a law of a continuum: stress and new fields of points, their energies, the
   tangent; and what the setting makes of the third direction.

       plane strain   strain_zz = 0
       plane stress   strain_zz such that sigma_zz = 0, by Newton's method:
                      z <- z - sigma_zz/(d sigma_zz/dz), once where sigma_zz is affine in z, else
                      by a search (ir_search)
                      tangent D_ab - D_az D_zb/D_zz, rate of z: -sum_b D_zb/D_zz rate_b

   A law that gives no energy stores sigma : strain/2 where the stress is homogeneous of degree one
   in the strain (linear, also piecewise); else the work of the straight path from rest (Gauss, 4
   points: exact for stresses up to degree 7). Where states move the strain without stress
   (point_rest.h) it is sigma : C^-1 : sigma/2, C the same for all states and strains, else an
   error: the law has to give its energy. */
#ifndef PERILAT_GENERATOR_PLAN_POINTS_H
#define PERILAT_GENERATOR_PLAN_POINTS_H

#include "generator/plan/plan.h"

/* Fills in a plan of points. False after a diagnostic. */
bool plan_points(kernel_plan *plan, diagnostics *d);
/* The same of tips of cracks: what they do, new fields, outputs. */
bool plan_tips(kernel_plan *plan, diagnostics *d);

/* Whether a kernel has RECTANGLE_PROGRAMS: laws of the plane that cost little, so that moving
   strains and stress through memory counts, and search for nothing. */
bool plan_has_rectangles(const kernel_plan *p);

#endif
