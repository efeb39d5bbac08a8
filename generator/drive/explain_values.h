/* The values that a law names, one after the other, where something went wrong; what lines are
   named by. */
#ifndef PERILAT_GENERATOR_EXPLAIN_VALUES_H
#define PERILAT_GENERATOR_EXPLAIN_VALUES_H

#include <stdio.h>

#include "generator/ir/interpret.h"
#include "generator/plan/plan.h"

typedef struct explained {
  ir_node *named;  /* [count] in the order of evaluation */
  double **values; /* [count][1] */
  int count;
  int bad; /* the first that is not finite; `count`: all are */
} explained;

/* Of named values that a program of one segment needs. An unnamed one may be infinite and yet not
   matter: it may stand in a case that is not taken. To be freed. */
explained explain_values(const kernel_plan *p, program_task task, const interpreter_inputs *in);
void explained_free(explained *e);
/* "  FILE:LINE: the law's `NAME` WHAT there" */
void explain_line(const kernel_plan *p, ir_node n, const char *what, FILE *out);

#endif
