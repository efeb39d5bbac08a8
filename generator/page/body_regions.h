/* The regions of a result's deck: which particles they have, and what the deck does there, in
   words. */
#ifndef PERILAT_GENERATOR_PAGE_BODY_REGIONS_H
#define PERILAT_GENERATOR_PAGE_BODY_REGIONS_H

#include <stdio.h>

#include "generator/page/page_result.h"

/* Particles of deck->regions[region], by places [particles][dimensions], m; ascending, to be freed.
   The nearest one of a point. */
long *body_region_particles(const page_result *p, int region, const double *places, long particles,
                            int dimensions, double spacing, long *count);
/* What is said of the region, a phrase each, parted by semicolons: "held along y; monitor `load`".
   Nothing where nothing is done there. */
void body_region_words(FILE *out, const page_result *p, int region, int dimensions);

#endif
