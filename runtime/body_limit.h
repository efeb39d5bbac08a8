/* Largest stable time step of a law of families on the particles at hand, all of them as they stand: where no lattice repeats
   itself there is no wave to look for. Forces come from the law's own step in the virgin state; the largest frequency is the
   largest eigenvalue of M^-1/2 K M^-1/2 by the method of Lanczos (1950), from the same start every time. K is taken to be
   symmetric, as it is where forces follow from an energy. */
#ifndef PERILAT_RUNTIME_BODY_LIMIT_H
#define PERILAT_RUNTIME_BODY_LIMIT_H

#include "runtime/kernel.h"
#include "runtime/rows.h"
#include "runtime/simulation.h"

/* Fills limit, omega_max, damping_ratio and mode as waves_limit does. The masses of w must be set. omega_max is at most 0.05 %
   too large, and the limit as much too small; rate terms count with their slope at rest. With any number of threads the result
   is the same. A law that gives no finite forces has limit 0. */
void body_limit(const pl_law *law, const double *parameters, const rows *w, step_limit *out);

#endif
