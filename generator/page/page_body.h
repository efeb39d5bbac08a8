/* The body of a result as it stood at the beginning, with its regions and what acts on them. */
#ifndef PERILAT_GENERATOR_PAGE_BODY_H
#define PERILAT_GENERATOR_PAGE_BODY_H

#include <stdio.h>

#include "generator/page/page_result.h"

void page_body(FILE *out, const page_result *p);

#endif
