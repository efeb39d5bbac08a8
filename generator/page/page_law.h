/* The laws of a result in its page: as equations, with their parameters as the run used them, and
   what one bond, particle or point of each answers. */
#ifndef PERILAT_GENERATOR_PAGE_LAW_H
#define PERILAT_GENERATOR_PAGE_LAW_H

#include <stdio.h>

#include "generator/page/page_result.h"

void page_laws(FILE *out, const page_result *p);

#endif
