/* Largest stable time step of a law on a perfect infinite lattice: Bloch waves over the Brillouin zone, with the law's
   own tangent (stiffness and rate terms), translations and rotations together.
     omega_max = max over k of sqrt(largest eigenvalue of M^-1/2 K(k) M^-1/2)
     dt = 2/omega (sqrt(1 + xi^2) - xi) for the worst mode (Asadollahi 2014, eq 2.75) */
#ifndef PERILAT_RUNTIME_STABILITY_H
#define PERILAT_RUNTIME_STABILITY_H

#include "runtime/kernel.h"
#include "runtime/rows.h"
#include "runtime/simulation.h"

/* Fills limit, omega_max, damping_ratio, mode (step stays as it is). w->mass and w->inertia must be set.
   limit is exact for the coupled, damped lattice: the largest step with dt^2 K(k) + 2 dt C(k) <= 4 M at every k.
   omega_max is undamped; damping_ratio and mode are of the wave that rules the limit. Stiffness that is negative at
   rest counts as none (the checks of a law report it). Without stiffness and damping the limit is infinite; a law
   that gives no finite tangent at rest has limit 0.
   Rate terms are looked at between the largest shortening and stretch without damage (at most 1 %). Those that stay
   below the elastic force however large the rate (friction-like) are exempt; any other counts with its largest slope. */
void stability_limit(const pl_law *law, const double *parameters, const rows *w, step_limit *out);

/* Largest frequency (rad/s) of all branches at wave vector k (1/m), undamped; NaN when the tangent is not finite. */
double stability_omega(const pl_law *law, const double *parameters, const rows *w, double kx,
                       double ky);

#endif
