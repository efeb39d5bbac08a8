/* Subnormal numbers are slow and mean nothing to a run: they count as zero in this thread between
   the two calls. */
#ifndef PERILAT_RUNTIME_SUBNORMALS_H
#define PERILAT_RUNTIME_SUBNORMALS_H

/* What was before, for subnormals_restore. */
unsigned subnormals_off(void);
void subnormals_restore(unsigned before);

#endif
