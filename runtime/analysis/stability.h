/* Largest stable time step of a law on a body: the one place that decides it. It is that of small
   strains about the virgin body.

   Waves of the perfect infinite lattice (waves.h) give it for laws of bonds whose forms are
   positive semidefinite (bond_forms.h): no body cut from the lattice is faster. Laws of families
   may be stiffer where families are not whole; there, for other laws of bonds and on lists the body
   as it stands is looked at, too (body_limit.h), and rules where it is faster than the lattice by
   more than that is accurate. Force constants of laws of families come from the law's own step
   (stencil.h). */
#ifndef PERILAT_RUNTIME_STABILITY_H
#define PERILAT_RUNTIME_STABILITY_H

#include "runtime/analysis/step_limit.h"
#include "runtime/kernel.h"
#include "runtime/lattice/parameter_planes.h"
#include "runtime/lattice/rows.h"

/* Fills limit, omega_max, damping_ratio, mode as waves_limit does, and at_surface and least. The
   masses of w must be set. `fields` (NULL: none): parameters that differ from bond to bond; the
   limit is then that of a lattice in which no bond is softer than any of these. A law that gives no
   finite tangent at rest has limit 0. The limit has nine significant digits (stability_rounded). */
void stability_limit(const pl_law *law, const double *parameters, const parameter_planes *fields,
                     const rows *w, step_limit *out);

struct interaction_law;
/* The same of several laws at work on one body (joint.h): always of the body as it stands. */
void stability_limit_joint(const struct interaction_law *laws, int count, const rows *w,
                           step_limit *out);

/* A virgin body with a smaller eigenvalue, over the largest, flies apart; what rounding leaves of
   rigid motions is larger. */
#define STABILITY_LEAST (-1e-6)

/* The same, of a body whose bonds carry forces at rest (`rest stretch`): these resist or help a
   bond that turns, by N/L to its EA/L, and a rigid rotation, too, until the body has come to its
   rest lengths. A free triangle of springs with rest stretch p has least = -p and a prestrain of
   0.58 p, a long chain -p and 0.25 p. */
bool stability_at_rest(const step_limit *limit);

/* Largest number of nine significant digits that is not above x by more than a part in 1e12. The
   last digits of x, which differ between processors and libraries, are lost: all arrive at one
   decimal number. */
double stability_rounded(double x);

/* Largest frequency (rad/s) of all branches at wave vector k (1/m), undamped; NaN when the tangent
   is not finite. */
double stability_omega(const pl_law *law, const double *parameters, const rows *w, double kx,
                       double ky);

#endif
