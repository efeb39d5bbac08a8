/* What a law implies for a perfect lattice made of it: elastic constants and strength under uniform
   strain, from the law's own functions (laws of families: elastic constants alone, from long
   waves). Small strain; particle rotation in moment balance for the elastic constants, zero for
   strength. */
#ifndef PERILAT_RUNTIME_IMPLIED_H
#define PERILAT_RUNTIME_IMPLIED_H

#include <stdbool.h>

#include "runtime/kernel.h"
#include "runtime/lattice/rows.h"

typedef struct implied_elasticity {
  double D[3][3];     /* Pa: (s_xx, s_yy, s_xy) = D (e_xx, e_yy, 2 e_xy), all other strains 0 */
  double asymmetry;   /* Pa: |s_xy - s_yx| left over; rounding */
  double E[2], nu[2]; /* Pa, 1: loaded along x, along y; the other direction free */
  double G;           /* Pa; of a chain all but E[0], which is along it, is NAN */
} implied_elasticity;

/* False when the lattice has no stiffness (singular D). */
bool implied_elastic(const pl_law *law, const double *parameters, const rows *w,
                     implied_elasticity *out);

/* Largest stress (Pa) along direction `component` (0 x, 1 y) under growing uniform strain along it,
   the other strains held at zero; *strain receives where. Infinite (strain NaN) when the stress
   only grows up to a strain of 1, and for laws of families, whose strength is not looked for. */
double implied_strength(const pl_law *law, const double *parameters, const rows *w, int component,
                        double *strain);

/* A piece of a perfect lattice to ask about: kind, spacing, horizon or shells, rotation,
   thicknesses and setting of `l`; masses from rho (kg/m^3; 0: none). NULL when there is no such
   lattice. Freed with rows_free. */
rows *implied_lattice_like(const deck_lattice *l, double rho);

/* The hexagonal one in plane stress with rows along x; spacing and thickness in m. */
rows *implied_lattice(double spacing, double thickness, double rho);

/* One bond of direction `direction`, drawn out slowly without rotation from the virgin state. */
typedef struct implied_bond {
  double peak_force;      /* N; infinite when the force only grows */
  double stretch_at_peak; /* NaN then */
  bool separates;         /* the force falls to nothing */
  double energy;          /* J: work until then; infinite when it does not separate */
  /* N/m: energy over the bond's share of a crack straight across it, s t times sqrt(3)/2 on the
     hexagon: what the literature counts by aligned bonds alone */
  double row_energy;
} implied_bond;
void implied_bond_curve(const pl_law *law, const double *parameters, const rows *w, int direction,
                        implied_bond *out);

/* N/m: work per area of a straight crack that opens along `component` (0 x, 1 y): both halves of
   the lattice are drawn apart without turning, and every bond that the crack cuts counts. Of
   central bonds of energy g each: 2 g/(sqrt(3)/2 s t) across the rows, 2 g/(s t) along them.
   Infinite when a bond does not separate. */
double implied_crack_energy(const pl_law *law, const double *parameters, const rows *w,
                            int component);

/* Long waves in the virgin lattice, m/s: along x, along y (sqrt(D_xx/rho) and sqrt(D_yy/rho),
   transverse sqrt(G/rho); of a chain along it, and NAN); frequency below which no rotation wave
   runs, rad/s (0 for central laws). w->mass must be set. */
typedef struct implied_waves {
  double longitudinal[2], transverse, rotation_cutoff;
} implied_waves;
void implied_wave_speeds(const pl_law *law, const double *parameters, const rows *w,
                         const implied_elasticity *e, implied_waves *out);

#endif
