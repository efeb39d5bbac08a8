/* Plans as text: what each pass reads, writes and costs, and how its loops are cut; its nodes, with
   their names and lines. */
#ifndef PERILAT_GENERATOR_PLAN_DUMP_H
#define PERILAT_GENERATOR_PLAN_DUMP_H

#include "generator/plan/passes.h"

void plan_dump(const kernel_plan *p, FILE *out);    /* --dump=passes */
void plan_dump_ir(const kernel_plan *p, FILE *out); /* --dump=ir */

#endif
