/* Passes with links of a window of rows, in one stage: each pass follows the one before as soon as
   that has done all rows in reach, some rows at a time; so links are needed of few rows, and stay
   in a cache. */
#ifndef PERILAT_RUNTIME_FAMILY_WINDOW_H
#define PERILAT_RUNTIME_FAMILY_WINDOW_H

#include "runtime/interaction/family_run.h"

typedef struct family_window family_window;

/* NULL where rows reach too far for the blocks. Memory of its own for each block. */
family_window *family_windows(sweep *w, const family *f);
void family_windows_free(const sweep *w, family_window *v);
/* All passes. With `move` the inner rows of the block move as soon as nothing needs their present
   state. */
void family_window_run(sweep *w, const pl_program *program, int block,
                       void (*move)(sweep *, int block, int first, int last));
/* Force on the particles of a row that is to move, from its first site on. */
const double *family_window_force(const sweep *w, int block, int row, int component);
/* Rows of a block whose present state no other block needs. */
void family_window_inner(const sweep *w, int block, int *first, int *last);

#endif
