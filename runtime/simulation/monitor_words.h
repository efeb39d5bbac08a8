/* Monitors in words, as results describe their series. */
#ifndef PERILAT_RUNTIME_MONITOR_WORDS_H
#define PERILAT_RUNTIME_MONITOR_WORDS_H

#include "runtime/simulation/monitor.h"

/* "reaction along y of `loader`, times -1, mean over 0.0001 s": what a monitor watches. */
char *monitor_words(const monitors *m, int index, arena *a);

#endif
