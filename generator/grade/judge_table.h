/* A table of answers judged beside the solution's. */
#ifndef PERILAT_GENERATOR_JUDGE_TABLE_H
#define PERILAT_GENERATOR_JUDGE_TABLE_H

#include "generator/grade/judge.h"

/* As judge_answer, of an exercise that asks for such a table. */
void judge_table(const judge_request *q, FILE *out);

#endif
