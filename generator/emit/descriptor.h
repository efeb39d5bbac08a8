/* The table of facts that a kernel hands to its host (pl_law): names, units, sizes and functions.
   It is C of the host, whatever the target of the functions is. */
#ifndef PERILAT_GENERATOR_DESCRIPTOR_H
#define PERILAT_GENERATOR_DESCRIPTOR_H

#include "generator/plan/passes.h"
#include "generator/target/c_text.h"

/* Parameters, fields and outputs, before the functions; the table itself behind them. */
void descriptor_lists(const kernel_plan *p, c_text *out);
void descriptor_entry(const kernel_plan *p, const char *key, c_text *out);

#endif
