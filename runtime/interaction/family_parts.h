/* Inside of the engine for laws of families: family.c sets it up, moves particles and takes samples; family_stages.c,
   family_window.c and family_pairs.c are three ways to run the passes of a program over the rows of a body. */
#ifndef PERILAT_RUNTIME_FAMILY_PARTS_H
#define PERILAT_RUNTIME_FAMILY_PARTS_H

#include "runtime/interaction/family.h"
#include "runtime/interaction/sweep_parts.h"

enum { SHAPE_PLANES = PL_SHAPE_PLANES(3) }; /* the most */
enum { FAMILY_MOST_PASSES = 16 };
enum { FAMILY_ROWS_ALIKE = 2 }; /* rows to the next in which neighbours may stand alike */

typedef struct family_block { /* pointers to the run at hand, for the law */
  bool observing;             /* the observe program reads the fields that the step program has just found */
  const double **old_field;
  double **new_field, **link, **bond_link, **observed;
  const double *shape[SHAPE_PLANES];
  double *force[3];
  char apart[SWEEP_APART];
} family_block;

typedef struct family_window family_window;
typedef struct family_pairs family_pairs;

typedef struct family {
  int neighbours, reach;       /* rows between a particle and its farthest neighbour */
  double *uniforms;            /* [neighbours][uniform_count]; lists: [uniform_count] */
  double **link;               /* [links][size]; NULL where blocks have windows */
  double **bond_link;          /* [bond_links][neighbours * size]; the same */
  double **observed;           /* [1 + outputs][planes * size] */
  double *shape[SHAPE_PLANES]; /* [size]; NULL unless the law reads them */
  family_block *blocks;        /* [block_count] */
  family_window *windows;      /* [block_count]; NULL: links of the whole body are kept */
  family_pairs *pairs;         /* NULL unless bonds add to both ends */
} family;

static inline int least(int a, int b) {
  return a < b ? a : b;
}

static inline family *family_of(const sweep *w) {
  return w->engine.own;
}

/* What a pass reads and writes, all but links: what is the same for all rows, once before some runs, and from the first site
   of a row on. A short row takes little longer than a fresh pl_family would. */
void family_begin_runs(const sweep *w, const pl_program *program, int block, pl_family *run);
void family_turn_to_row(const sweep *w, int block, int row, pl_family *run);

/* The latter, and links of the whole body. */
void family_turn_with_links(const sweep *w, int block, int row, pl_family *run);

/* The time that a pass takes, from its beginning on; only kept when the sweep is timed. */
double family_pass_begins(const sweep *w);
void family_pass_ends(const sweep *w, int block, int pass, double begun);

/* --- family_stages.c: links of the whole body; a stage for each pass ---------------------------- */

/* Pass after pass on what can be done without other blocks, then, stage by stage, on the rest. */
void family_stage(const sweep *w, const pl_program *program, int stage, int block);

/* --- family_pairs.c: bonds add to both ends; a stage for each pass, links of the whole body ------- */

/* NULL where the law has no sums. */
family_pairs *family_pairs_new(sweep *w, const family *f);
void family_pairs_free(const sweep *w, family_pairs *p);
/* A pass of a step. */
void family_pairs_stage(const sweep *w, int pass, int block);
/* Fields were set from outside; old and new ones have changed places. */
void family_pairs_fields_set(const sweep *w);
void family_pairs_turn(family_pairs *p);

/* --- family_window.c: links of some rows; one stage ---------------------------------------------- */

/* NULL where rows reach too far for the blocks. Memory of its own for each block. */
family_window *family_windows(sweep *w, const family *f);
void family_windows_free(const sweep *w, family_window *v);
/* All passes. With `move` the inner rows of the block move as soon as nothing needs their present state. */
void family_window_run(sweep *w, const pl_program *program, int block,
                       void (*move)(sweep *, int block, int first, int last));
/* Force on the particles of a row that is to move, from its first site on. */
const double *family_window_force(const sweep *w, int block, int row, int component);
/* Rows of a block whose present state no other block needs. */
void family_window_inner(const sweep *w, int block, int *first, int *last);

#endif
