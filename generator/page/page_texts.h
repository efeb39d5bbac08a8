/* What a page holds in words: the deck in sentences as the run said them, the texts that the result
   keeps, folded, and where the result comes from. */
#ifndef PERILAT_GENERATOR_PAGE_TEXTS_H
#define PERILAT_GENERATOR_PAGE_TEXTS_H

#include <stdio.h>

#include "generator/page/page_result.h"

/* What the run said before it began and at its end. */
void page_sentences(FILE *out, const page_result *p);
/* Deck, --set, laws, tables; all folded. */
void page_inputs(FILE *out, const page_result *p);
/* Version, compiler, threads, when; and the command that repeats the run. */
void page_provenance(FILE *out, const page_result *p);

#endif
