/* The text of a law of a continuum on one point: its stress with all fields held, and what the
   rules of the fields give. */
#ifndef PERILAT_GENERATOR_POINT_TEXT_H
#define PERILAT_GENERATOR_POINT_TEXT_H

#include "generator/check/physics_point_bench.h"
#include "generator/ir/interpret.h"
#include "generator/lower/lower.h"

typedef struct point_text {
  arena *memory;
  ir *graph;
  lowered_law step, frozen;
  interpreter *program;
  int count;           /* of its results: LOWERED_STRESSES, then the rules of the fields */
  double *room, **out; /* [count] */
  const double **field, **parameter; /* as inputs */
} point_text;

/* In the bench's setting; false after a message where it cannot be lowered. To be closed either
   way. */
bool point_text_open(point_text *t, point_bench *p);
void point_text_close(point_text *t);
/* out[count] at the strain[strains] (1), with the bench's fields, at rest. */
void point_text_run(point_text *t, const point_bench *p, const double *strain, double *out);
/* Whether the text lets field k follow what the point undergoes. */
bool point_text_moves(const point_text *t, const point_bench *p, int k);

#endif
