/* What is dear in the rules of states and damage, and needed only where these grow: one condition
   of a loop, that nothing does, is expected, and a loop that relies on it leaves the rest out.

       k, D: D = max(D_old, k <= k0 ? 0 : 1 - k0/k*exp(...))     expected: k <= k0

   A rule is a chain of cases, and a case is known from the conditions before it. Where those of all
   rules choose a number or what the field was, no function behind another case is chosen: then a
   chain without these cases has the same value, and the choice between the two is one of equals. It
   holds for any numbers, NaN too, since it is the very comparisons of the law that choose.
   Monotony of a rule, or that a field keeps what its rule once gave, is not asked for. */
#ifndef PERILAT_GENERATOR_SELDOM_H
#define PERILAT_GENERATOR_SELDOM_H

#include "generator/plan/plan.h"

/* In the steps and ledgers of points and strips, in the steps of families: once all else has been
   rewritten, and before uniforms are chosen. */
void plan_seldom(kernel_plan *p);

#endif
