/* A run of particles as the passes of a law of families see it: where arrays, links and neighbours
   stand for the particles of a row. Below family.c, which marches, and the three ways to run the
   passes of a program over the rows of a body: family_stages.h, family_window.h, family_pairs.h. */
#ifndef PERILAT_RUNTIME_FAMILY_RUN_H
#define PERILAT_RUNTIME_FAMILY_RUN_H

#include "runtime/body/motion.h"
#include "runtime/interaction/sweep.h"

enum { SHAPE_PLANES = PL_SHAPE_PLANES(3) }; /* the most */
enum { FAMILY_MOST_PASSES = 16 };
enum { FAMILY_ROWS_ALIKE = 2 }; /* rows to the next in which neighbours may stand alike */

typedef struct family_block { /* pointers to the run at hand, for the law */
  bool observing; /* the observe program reads the fields that the step program has just found */
  const double **old_field;
  double **new_field, **link, **bond_link, **observed;
  const double **parameter;
  const double *shape[SHAPE_PLANES];
  double *force[PL_MAX_DOF];
  char apart[BODY_APART];
} family_block;

struct family_window;
struct family_pairs;

typedef struct family {
  const pl_program *march;       /* of the law: `step`, or in its place `ledger` */
  int neighbours, reach;         /* rows between a particle and its farthest neighbour */
  double *uniforms;              /* [neighbours][uniform_count]; lists: [uniform_count] */
  double **link;                 /* [links][size]; NULL where blocks have windows */
  double **bond_link;            /* [bond_links][neighbours * size]; the same */
  double **observed;             /* [1 + outputs][planes * size] */
  double *shape[SHAPE_PLANES];   /* [size]; NULL unless the law reads them */
  double *whole;                 /* [size] 1, the share or size of all particles; NULL as before */
  double *mass;                  /* [size] kg, where all particles are alike; NULL as before */
  family_block *blocks;          /* [block_count] */
  struct family_window *windows; /* [block_count]; NULL: links of the whole body are kept */
  struct family_pairs *pairs;    /* NULL unless bonds add to both ends */
} family;

static inline int least(int a, int b) {
  return a < b ? a : b;
}

static inline family *family_of(const sweep *w) {
  return w->engine.own;
}

/* What a pass reads and writes, all but links: what is the same for all rows, once before some
   runs, and from the first site of a row, or of a part of it, on. A short row takes little longer
   than a fresh pl_family would. */
void family_run_begin(const sweep *w, const pl_program *program, int block, pl_family *run);
void family_run_row(const sweep *w, int block, int row, pl_family *run);
void family_run_part(const sweep *w, int block, const row_part *at, pl_family *run);

/* The latter, and links of the whole body. */
void family_run_row_with_links(const sweep *w, int block, int row, pl_family *run);

/* The time that a pass takes, from its beginning on; only kept when the sweep is timed. */
double family_run_pass_begins(const sweep *w);
void family_run_pass_ends(const sweep *w, int block, int pass, double begun);

#endif
