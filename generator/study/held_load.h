/* Is a load that is held borne? Gerstle, Honarvar Gheitanbaf and Asadollahi (2013, section 5) let it
   grow, hold it, and look: here the deflections of the two halves of the hold are compared.

       |u|      ___ first    _____ second half of the hold
        |    /\/   \/\/\/\/\/
        |   /      :         :         :
        +--/-------+---------+---------+-- t
                held      middle      end                                            */
#ifndef PERILAT_GENERATOR_HELD_LOAD_H
#define PERILAT_GENERATOR_HELD_LOAD_H

#include <stdbool.h>

typedef enum held_verdict {
  HELD_BORNE,     /* the halves agree, but for `growth` */
  HELD_UNDECIDED, /* the second is smaller: still coming to rest, a longer hold may tell */
  HELD_COLLAPSED, /* the second is larger, or it passes the limit */
  HELD_CUT        /* the run ended before the hold did: nobody knows */
} held_verdict;

typedef struct held_load {
  double first, second; /* the largest sizes in the halves */
  held_verdict verdict;
} held_load;

/* Of a monitor u(t), [count] samples, with the load held from the time `held` until `end`. Samples
   that are no number are a collapse. */
held_load held_load_judge(const double *time, const double *u, long count, double held, double end,
                          double growth, double limit);

#endif
