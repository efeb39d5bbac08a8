/* A program over points of a continuum as C: one loop over arrays of one value a point. */
#ifndef PERILAT_GENERATOR_POINT_LOOPS_H
#define PERILAT_GENERATOR_POINT_LOOPS_H

#include "generator/target/expression.h"

/* All programs of a plan of points, or of tips, which the text calls points, too. */
void point_loops(emitter *e);

#endif
