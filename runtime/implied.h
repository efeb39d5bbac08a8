/* What a law implies for a perfect lattice made of it: elastic constants and strength under uniform strain, from the
   law's own functions. Small strain; particle rotation in moment balance for the elastic constants, zero for strength. */
#ifndef PERILAT_RUNTIME_IMPLIED_H
#define PERILAT_RUNTIME_IMPLIED_H

#include <stdbool.h>

#include "runtime/kernel.h"
#include "runtime/rows.h"

typedef struct implied_elasticity {
  double D[3][3];      /* Pa: (s_xx, s_yy, s_xy) = D (e_xx, e_yy, 2 e_xy) */
  double asymmetry;    /* Pa: |s_xy - s_yx| left over; rounding */
  double E[2], nu[2];  /* Pa, 1: loaded along x, along y; the other direction free */
  double G;            /* Pa */
} implied_elasticity;

/* False when the lattice has no stiffness (singular D). */
bool implied_elastic(const pl_law *law, const double *parameters, const rows *w, implied_elasticity *out);

/* Largest stress (Pa) along direction `component` (0 x, 1 y) under growing uniform strain along it, the other strains
   held at zero; *strain receives where. Infinite (strain NaN) when the stress only grows up to a strain of 1. */
double implied_strength(const pl_law *law, const double *parameters, const rows *w, int component, double *strain);

#endif
