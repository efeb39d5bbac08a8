/* Powers of numbers as people write them, such as (1e-3)^3 and 10^-4: the nearest double but for
   rare cases, where dsl/base/elementary.h may be one off. */
#ifndef PERILAT_DSL_POWERS_H
#define PERILAT_DSL_POWERS_H

/* x^y; whole y from -64 to 64 round once. */
double power_of(double x, double y);

/* The n of the largest 10^n (as a double) that is not above x; x is finite and more than 0. */
int decade_of(double x);

#endif
