/* Pages of `perilat report`: of one result, of two side by side, of a study. */
#ifndef PERILAT_GENERATOR_PAGE_H
#define PERILAT_GENERATOR_PAGE_H

#include <stdbool.h>
#include <stdio.h>

/* Both read all before anything is written to `out`, which is a text in memory. Exit status: 0, or
   1 after messages. `command` as the person typed it. */
int page_of_results(FILE *out, const char *command, const char *const *paths, int count);

#endif
