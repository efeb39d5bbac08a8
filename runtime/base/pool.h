/* Memory of the arrays that a run works on: given as they are asked for, taken back together. A
   processor finds its way in few large pages sooner than in many small ones, so arrays stand one
   behind the other in pieces of such pages. */
#ifndef PERILAT_RUNTIME_POOL_H
#define PERILAT_RUNTIME_POOL_H

typedef struct pool pool;

pool *pool_new(void);
void pool_free(pool *p);
/* `count` zeros, aligned to PL_ALIGNMENT. Running out of memory ends the program with a message. */
double *pool_doubles(pool *p, long count);
#endif
