/* Ctrl-C, the end of a batch job, a closed terminal: a run, or a study of many, is asked to
   stop. */
#ifndef PERILAT_GENERATOR_STOPPING_H
#define PERILAT_GENERATOR_STOPPING_H

#include <signal.h>

enum { STOPPING_SIGNALS = 3 };

typedef struct stopping { /* what was done on these signals before */
  struct sigaction before[STOPPING_SIGNALS];
} stopping;

/* The first one that came since they are caught; 0: none. */
extern volatile sig_atomic_t stopping_signal;

/* What is ignored, as nohup wants it, stays so. */
void stopping_catch(stopping *s);
void stopping_release(const stopping *s);
/* No such signal comes until `as_it_was` is the mask again. */
void stopping_hold(sigset_t *as_it_was);

#endif
