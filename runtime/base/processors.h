/* How many threads can run at the same moment. */
#ifndef PERILAT_RUNTIME_PROCESSORS_H
#define PERILAT_RUNTIME_PROCESSORS_H

/* Processors that this process may use, at least 1: fewer than the machine has where `taskset`, a
   batch system or the cpuset of a container says so. A container's share of time is not looked
   at. */
int usable_processors(void);
/* From here on this process uses no more than `most`, whatever it may. Returns what it was kept to
   before. */
int processors_keep_to(int most);

#endif
