/* What is known of a law, for other programs: into the open object of a document. */
#ifndef PERILAT_GENERATOR_LAW_FACTS_JSON_H
#define PERILAT_GENERATOR_LAW_FACTS_JSON_H

#include "dsl/base/json.h"
#include "generator/facts/law_facts.h"

void law_facts_put(json *j, const law_facts *f);

#endif
