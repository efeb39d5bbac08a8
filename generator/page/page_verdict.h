/* The head of a page: what came out, and whether it is to be trusted. */
#ifndef PERILAT_GENERATOR_PAGE_VERDICT_H
#define PERILAT_GENERATOR_PAGE_VERDICT_H

#include <stdio.h>

#include "generator/page/page_result.h"

/* Peak, when, why it ended, imbalance; what is wrong stands out. */
void page_verdict(FILE *out, const page_result *p);
/* What the run warned of, and what the deck's text alone cannot tell. Nothing where there is
   nothing. */
void page_warnings(FILE *out, const page_result *p);

#endif
