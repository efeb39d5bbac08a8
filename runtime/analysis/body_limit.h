/* Largest stable time step of the particles at hand, all of them as they stand: where no lattice
   repeats itself, or where a free surface may move faster than any wave inside. Forces come from
   the law's own step in the virgin state; both ends of the spectrum of M^-1/2 K M^-1/2 by the
   method of Lanczos (1950), from the same start every time. K is taken to be symmetric, as it is
   where forces follow from an energy. */
#ifndef PERILAT_RUNTIME_BODY_LIMIT_H
#define PERILAT_RUNTIME_BODY_LIMIT_H

#include "runtime/analysis/step_limit.h"
#include "runtime/kernel.h"
#include "runtime/lattice/rows.h"

/* Of the largest eigenvalue, a frequency's square. */
#define BODY_ACCURACY 1e-3

/* Fills limit, omega_max, damping_ratio and mode as waves_limit does, and `least`. A limit that out
   has already, that of waves inside (0: none), is where the search for a damped one begins and may
   end. The masses of w must be set; `varying` [law->varying_count][directions * size] are
   parameters that differ from bond to bond (NULL: none). omega_max is at most 0.05 % too large, and
   the limit as much too small; rate terms count with their slope at rest. With any number of
   threads the result is the same. A law that gives no finite forces has limit 0. */
void body_limit(const pl_law *law, const double *parameters, double *const *varying, const rows *w,
                step_limit *out);
struct sweep;
/* 1/s^2: the largest eigenvalue of M^-1 K in the present state of a body at work, supports left
   out, its masses as they are; found from below, by few vectors: near where some mode is faster
   than the others. Places are as before, forces on particles are not. NaN where some are no
   number. */
double body_stiffness_now(struct sweep *of);
struct interaction_law;
/* The same of several laws at work on the particles. */
void body_limit_joint(const struct interaction_law *laws, int count, const rows *w,
                      step_limit *out);

#endif
