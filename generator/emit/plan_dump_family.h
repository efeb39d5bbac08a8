/* Programs of families as text: what each segment reads, writes and costs; its nodes. */
#ifndef PERILAT_GENERATOR_PLAN_DUMP_FAMILY_H
#define PERILAT_GENERATOR_PLAN_DUMP_FAMILY_H

#include "generator/plan/passes.h"

void plan_dump_programs(const kernel_plan *p, FILE *out);
void plan_dump_programs_ir(const kernel_plan *p, FILE *out);

#endif
