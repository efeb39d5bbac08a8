/* Largest stable time step of a law on a perfect infinite lattice, from its waves (waves.h). The
   force constants of laws of bonds come from the law's own tangent (stiffness and rate terms),
   translations and rotations together; those of laws of families from its step (stencil.h). On lists the
   body as it stands is looked at (body_limit.h). */
#ifndef PERILAT_RUNTIME_STABILITY_H
#define PERILAT_RUNTIME_STABILITY_H

#include "runtime/kernel.h"
#include "runtime/rows.h"
#include "runtime/simulation.h"

/* Fills limit, omega_max, damping_ratio, mode as waves_limit does. w->mass and w->inertia must be
   set. A law that gives no finite tangent at rest has limit 0.
   Rate terms of laws of bonds are looked at between the largest shortening and stretch without
   damage (at most 1 %). Those that stay below the elastic force however large the rate
   (friction-like) are exempt; any other counts with its largest slope. Those of laws of families
   are looked at at rest. */
void stability_limit(const pl_law *law, const double *parameters, const rows *w, step_limit *out);

/* Largest frequency (rad/s) of all branches at wave vector k (1/m), undamped; NaN when the tangent is not finite. */
double stability_omega(const pl_law *law, const double *parameters, const rows *w, double kx,
                       double ky);

#endif
