/* The table of facts that a kernel hands to its host (pl_law): names, units, sizes and functions.
   It is C of the host, whatever the target of the functions is. */
#ifndef PERILAT_GENERATOR_DESCRIPTOR_H
#define PERILAT_GENERATOR_DESCRIPTOR_H

#include "generator/plan/plan.h"
#include "generator/target/c_text.h"

/* Parameters, fields and outputs, before the functions; the table itself behind them. */
void descriptor_lists(const kernel_plan *p, c_text *out);
void descriptor_entry(const kernel_plan *p, c_text *out);
/* The text of a kernel, whose key is empty, with its key, the toolchain_key of that text;
   malloc'ed. */
char *descriptor_keyed(const char *unkeyed, const char *key);

#endif
