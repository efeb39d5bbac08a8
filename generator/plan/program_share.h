/* What both ends of a bond share: values whose mirror image is the value itself, or its opposite. */
#ifndef PERILAT_GENERATOR_PROGRAM_SHARE_H
#define PERILAT_GENERATOR_PROGRAM_SHARE_H

#include "generator/plan/program_builder.h"

/* Values that the ends of bonds share become inputs of the roots, as b->sharing says. */
void program_share(builder *b, segment_root *roots, int root_count);

#endif
