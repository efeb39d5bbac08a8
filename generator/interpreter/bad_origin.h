/* Where a value of a law that is no number comes from: the operation of its text that was the first
   to give none. */
#ifndef PERILAT_GENERATOR_BAD_ORIGIN_H
#define PERILAT_GENERATOR_BAD_ORIGIN_H

#include "generator/ir/interpret.h"
#include "generator/plan/plan.h"

typedef enum bad_origin_kind {
  BAD_NOWHERE,  /* all values are finite */
  BAD_DIVISION, /* `of` divides by 0 */
  BAD_RETURN,   /* a flow that is solved for does not come back */
  BAD_OTHER     /* a root, a logarithm, a power, or an operation that is not in the text */
} bad_origin_kind;

typedef struct bad_origin {
  bad_origin_kind kind;
  const expr *of; /* of BAD_DIVISION; NULL else */
} bad_origin;

/* Of the stress and the new states of a point of the law (lone_point.h) with these inputs. */
bad_origin bad_origin_of_point(const law *l, const interpreter_inputs *in);

#endif
