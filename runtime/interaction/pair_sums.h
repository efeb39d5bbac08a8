/* What laws need whose bonds add to both ends (pl_law.sum_count): sums that wait for particles
   ahead, of each thread its own, and marks of where fields toward neighbours are not 0. */
#ifndef PERILAT_RUNTIME_PAIR_SUMS_H
#define PERILAT_RUNTIME_PAIR_SUMS_H

#include "runtime/interaction/sweep.h"

typedef struct pair_sums { /* of one thread */
  int before, last;        /* rows before .. last-1 are its own and those that reach them */
  long base;               /* site that the sums begin with */
  long size;               /* sites, up to where bonds of its rows reach */
  double **sum, **at_run;  /* [sum_count][size]; where the sums of the run at hand begin */
} pair_sums;

/* `reach`: rows that a bond reaches ahead, at most. */
pair_sums pair_sums_new(sweep *w, const body_block *b, int reach);
void pair_sums_free(pair_sums *s);
/* Points at the sums of a run that begins at that site. */
double *const *pair_sums_at(const sweep *w, pair_sums *s, long start);
/* After a pass: forgets what was for the particles of others. */
void pair_sums_clear_ahead(const sweep *w, pair_sums *s);

/* [fields][size/PL_LANES] words of zeros for fields toward neighbours (pl_family.old_filled); NULL
   for the others. */
uint64_t **pair_marks_new(sweep *w);
void pair_marks_free(const sweep *w, uint64_t **marks);
/* Marks where the field's values are not 0; and where two fields have the same. */
void pair_marks_filled(const sweep *w, double *const *field, uint64_t **marks);
void pair_marks_settled(const sweep *w, double *const *field, double *const *other,
                        uint64_t **marks);

#endif
