/* What a run says: before, during, after. */
#ifndef PERILAT_GENERATOR_RUN_REPORT_H
#define PERILAT_GENERATOR_RUN_REPORT_H

#include "generator/run/run_state.h"

/* What is about to be done. */
void announce(const run *r);
/* "t = 25 ms, load 3100 N (peak 11020), cmod 0.12 mm": the first monitors at the last sample. */
void describe_monitors(const run *r, char *text, size_t size);
/* Why and where a run went bad; leaves a path that drives the bond at fault. */
void report_bad(const run *r);
/* The command that goes on from the checkpoint. */
void print_resume(const run *r, FILE *out);
/* What the checkpoint belongs to and this run is not, when that is why it does not fit. */
void print_misfit(const run *r);
/* What came out. */
void conclude(const run *r, double seconds, long steps);
/* Which &stop ended the run early. */
void print_stop(const run *r);
/* "end of the run", "stopped by &stop: load was below 5 % of its peak": how a run ended. */
void describe_end(const run *r, const run_end *end, char *text, size_t size);

#endif
