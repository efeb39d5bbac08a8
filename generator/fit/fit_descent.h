/* To the bottom of the valley that a search has found: steps of Gauss and Newton with several
   dampings (Levenberg 1944, Marquardt 1963), as long as one of them gains. A search by values alone
   stops in a narrow valley, where two parameters make up for each other; the derivatives of the
   residuals, which the intervals need anyway, tell the way along it. */
#ifndef PERILAT_GENERATOR_FIT_DESCENT_H
#define PERILAT_GENERATOR_FIT_DESCENT_H

#include "generator/fit/fit_search.h"

/* Goes on from what is found, with the runs that are left of the problem's. */
void fit_descend(const fit_problem *problem, fit_found *found);

#endif
