/* Passes with links of the whole body: a stage for each pass, between which all blocks wait. What
   can be done without other blocks is done in the first stage, pass closely behind pass. */
#ifndef PERILAT_RUNTIME_FAMILY_STAGES_H
#define PERILAT_RUNTIME_FAMILY_STAGES_H

#include "runtime/interaction/family_run.h"

/* Pass after pass on what can be done without other blocks, then, stage by stage, on the rest. */
void family_stage(const sweep *w, const pl_program *program, int stage, int block);

#endif
