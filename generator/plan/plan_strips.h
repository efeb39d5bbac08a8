/* The programs of a law of bonds: what is done over strips, and state by state. */
#ifndef PERILAT_GENERATOR_PLAN_STRIPS_H
#define PERILAT_GENERATOR_PLAN_STRIPS_H

#include "generator/plan/plan.h"

/* Fills in a plan of strips. False after a diagnostic. */
bool plan_strips(kernel_plan *plan, diagnostics *d);
/* Bounds of parameters and, with the number behind them, of the size of cells, of any law. False
   after a diagnostic. */
bool plan_bounds(kernel_plan *p, diagnostics *d);

#endif
