/* What a run says at its end: speed, increments, monitors, contacts, energies, cracks, deaths; and
   why it ended. */
#ifndef PERILAT_GENERATOR_REPORT_END_H
#define PERILAT_GENERATOR_REPORT_END_H

#include "generator/report/run_state.h"

/* What came out, to stdout, and how far it is to be trusted, to stderr. */
void conclude(const run *r, double seconds, long steps);
/* Where it is. */
void tell_result(const run *r);
/* Which &stop ended the run early. */
void print_stop(const run *r);
/* Whether and when what each &frame with a monitor waits for came. */
void print_frames(const run *r);
/* "end of the run", "stopped by &stop: load was below 5 % of its peak": how a run ended. */
void describe_end(const run *r, const run_end *end, char *text, size_t size);

#endif
