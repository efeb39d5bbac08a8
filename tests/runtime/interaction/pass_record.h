/* A law of families whose three passes find nothing, but keep which rows they were called with, and
   check that the pass before was done on all rows in reach: whatever schedule runs them. */
#ifndef PERILAT_TESTS_PASS_RECORD_H
#define PERILAT_TESTS_PASS_RECORD_H

#include <stdlib.h>

#include "runtime/interaction/family_run.h"
#include "runtime/interaction/interaction.h"
#include "tests/runtime/built_rows.h"
#include "tests/runtime/family_law.h"

enum { RECORD_PASSES = 3, RECORD_MOST_ROWS = 200 };

typedef struct pass_record {
  const sweep *w;
  void (*look)(struct pass_record *r, const pl_family *f, int pass, int row); /* or NULL */
  int now;                                                                    /* rows done so far */
  /* of a row and pass: how often it was done; after how many rows last; 0: not yet */
  int times[RECORD_PASSES][RECORD_MOST_ROWS], last[RECORD_PASSES][RECORD_MOST_ROWS];
} pass_record;

static inline int record_count(const pass_record *r) {
  return r->w->body->lattice->row_count;
}

/* The row holds sites, and its particles may be neighbours of those of row `from`. */
static inline bool record_reaches(const pass_record *r, int from, int row) {
  return abs(row - from) <= family_of(r->w)->reach && r->w->body->count[row] > 0;
}

static inline void record_row(pass_record *r, const pl_family *f, int pass, int row) {
  assert_true(row >= 0 && row < record_count(r));
  for (int k = 0; k < record_count(r) && pass > 0; k++)
    if (record_reaches(r, row, k) && r->times[pass - 1][k] == 0)
      fail_msg("pass %d on row %d needs the pass before on row %d", pass, row, k);
  if (r->look) r->look(r, f, pass, row);
  r->times[pass][row]++;
  r->last[pass][row] = ++r->now;
}

/* A run is rows that go on in memory as one begins, or every other row from it on. */
static inline void record_run(const pl_law *law, const pl_family *f, int pass) {
  pass_record *r = (pass_record *)law->context;
  const rows *g = r->w->body->lattice;
  const int row = rows_row(g, f->bonds - g->bonds);
  for (int k = 0; k < f->rows; k++)
    for (int n = 0; n * g->pitch < f->count; n++)
      record_row(r, f, pass, row + k * FAMILY_ROWS_ALIKE + n);
}

static inline void record_first(const pl_law *law, const double *u, const pl_family *f) {
  (void)u;
  record_run(law, f, 0);
}

static inline void record_second(const pl_law *law, const double *u, const pl_family *f) {
  (void)u;
  record_run(law, f, 1);
}

static inline void record_third(const pl_law *law, const double *u, const pl_family *f) {
  (void)u;
  record_run(law, f, 2);
}

static inline pl_law recording_law(const pass_record *r) {
  static const pl_family_function passes[RECORD_PASSES] = {record_first, record_second,
                                                           record_third};
  pl_law law = family_hexagon;
  law.reads_shape = 0;
  law.step = law.observe = (pl_program){.pass_count = RECORD_PASSES, .pass = passes};
  law.context = r;
  return law;
}

/* From the beginning, for a body in so many blocks. */
static inline sweep *record_begin(pass_record *r, const rows *g, const pl_law *law, int blocks,
                                  bool forces) {
  double parameters[FAMILY_PARAMETERS];
  for (int p = 0; p < FAMILY_PARAMETERS; p++)
    parameters[p] = family_parameters[p].initial;
  memset(r->times, 0, sizeof r->times);
  memset(r->last, 0, sizeof r->last);
  r->now = 0;
  assert_true(g->row_count <= RECORD_MOST_ROWS);
  sweep *w = interaction_new(g, law, parameters, 1e-7, blocks, false, forces);
  r->w = w;
  assert_int_equal(w->body->block_count, blocks);
  return w;
}

/* A disc, whose rows are of all lengths and some alike. */
#define DISC(keys, radius)                                                                         \
  "&simulation end_time = 1e-3 /\n&material lattice = 'c' model = 'm' /\n"                         \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 " keys " /\n"             \
  "&body lattice = 'c' shape = 'disc' centre = 0.003, 0.001 radius = " radius " /\n"

#endif
