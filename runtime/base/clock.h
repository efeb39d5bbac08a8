/* Time that passes while the program runs. */
#ifndef PERILAT_RUNTIME_CLOCK_H
#define PERILAT_RUNTIME_CLOCK_H

/* s since some moment; only differences mean anything. */
double monotonic_seconds(void);

#endif
