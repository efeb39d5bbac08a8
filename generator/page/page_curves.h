/* Histories of a result as curves, and its energies as a ledger. */
#ifndef PERILAT_GENERATOR_PAGE_CURVES_H
#define PERILAT_GENERATOR_PAGE_CURVES_H

#include <stdio.h>

#include "generator/page/page_result.h"

/* The monitor that the verdict tells of, over what it is usually drawn over. */
void page_main_curve(FILE *out, const page_result *p);
/* All monitors over time, one diagram each. */
void page_monitors(FILE *out, const page_result *p);
/* What was put in, and where it went, as areas; below the imbalance. */
void page_energies(FILE *out, const page_result *p);

#endif
