/* Passes whose bonds add to both of their ends (pl_law.sum_count): a stage for each pass, links of
   the whole body, sums that run ahead (pair_sums.h). */
#ifndef PERILAT_RUNTIME_FAMILY_PAIRS_H
#define PERILAT_RUNTIME_FAMILY_PAIRS_H

#include "runtime/interaction/family_run.h"

typedef struct family_pairs family_pairs;

/* NULL where the law has no sums. */
family_pairs *family_pairs_new(sweep *w, const family *f);
void family_pairs_free(const sweep *w, family_pairs *p);
/* A pass of a step. */
void family_pairs_stage(const sweep *w, int pass, int block);
/* Fields were set from outside; old and new ones have changed places. */
void family_pairs_fields_set(const sweep *w);
void family_pairs_turn(family_pairs *p);

#endif
