/* The page of a study: its table, and the curves of its cases in one diagram. */
#ifndef PERILAT_GENERATOR_PAGE_STUDY_H
#define PERILAT_GENERATOR_PAGE_STUDY_H

#include <stdio.h>

/* As those of page.h. */
int page_of_study(FILE *out, const char *path);

#endif
