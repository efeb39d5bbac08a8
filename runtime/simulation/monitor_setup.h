/* What monitors watch of a deck's bodies and links: whether these have it, where it stands, when
   it is known. */
#ifndef PERILAT_RUNTIME_MONITOR_SETUP_H
#define PERILAT_RUNTIME_MONITOR_SETUP_H

#include "runtime/simulation/monitor.h"

/* False with diagnostics where the deck watches what particles of the laws do not have. */
bool monitors_check(const deck *k, const run_body *bodies, int count, diagnostics *d);
/* Of a deck that was checked; bodies and links must stay. NULL with a diagnostic when a mean does
   not fit into memory. */
monitors *monitors_new(const deck *k, const run_body *bodies, int count, const run_link *links,
                       int link_count, const run_stamps *stamps, double interval, diagnostics *d);
void monitors_free(monitors *m);

#endif
