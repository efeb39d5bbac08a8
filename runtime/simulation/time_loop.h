/* The time loop: steps, what is done between them, samples. */
#ifndef PERILAT_RUNTIME_TIME_LOOP_H
#define PERILAT_RUNTIME_TIME_LOOP_H

#include "runtime/simulation/simulation_state.h"

/* Up to `steps` more steps, or to the next frame (simulation_advance). */
step_status time_loop_run(simulation *s, long steps, const volatile sig_atomic_t *interrupted);
/* Makes sure that the run has begun and that its present state is the one observed; outside of the
   loop. */
void time_loop_observe(simulation *s);

#endif
