/* How long a run takes compared with others of its study, so that the longest begin first: bonds
   times steps, from the deck alone. Only ratios mean anything; what ends a run early is not
   known. */
#ifndef PERILAT_GENERATOR_STUDY_COST_H
#define PERILAT_GENERATOR_STUDY_COST_H

#include "runtime/deck/deck.h"

double study_cost(const deck *k);

#endif
