/* What is known of a law, for people. */
#ifndef PERILAT_GENERATOR_LAW_FACTS_TEXT_H
#define PERILAT_GENERATOR_LAW_FACTS_TEXT_H

#include "generator/facts/law_facts.h"

void law_facts_print(const law_facts *f);

#endif
