/* Histories as curves, of one result or of two in each diagram, and energies as a ledger. */
#ifndef PERILAT_GENERATOR_PAGE_CURVES_H
#define PERILAT_GENERATOR_PAGE_CURVES_H

#include <stdio.h>

#include "generator/page/page_result.h"

/* The monitor that the verdict tells of, over what it is usually drawn over; of two results
   both. */
void page_main_curve(FILE *out, const page_result *results, int count, bool large);
/* All monitors over time, one diagram each; of two results those of both. */
void page_monitors(FILE *out, const page_result *results, int count);
/* What was put in, and where it went, as areas; below the imbalance. */
void page_energies(FILE *out, const page_result *p);

#endif
