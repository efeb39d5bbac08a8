/* A study's deck, to be asked for single values: with what is set in all runs, as --set would take
   them. */
#ifndef PERILAT_GENERATOR_STUDY_DECK_H
#define PERILAT_GENERATOR_STUDY_DECK_H

#include "generator/study/study_case.h"

typedef struct study_deck {
  source_set sources;
  int file;
  study_setting *settings; /* [setting_count] */
  int setting_count;
} study_deck;

/* False after a message. To be closed in either case. */
bool study_deck_open(study_deck *t, study_request *r, const study_text *path);
void study_deck_close(study_deck *t);
/* "-42 kN/m" of "force.per_length". NULL where the deck gives none, or after messages, which are
   printed; then *good is false, which else stays. */
const char *study_deck_value(const study_deck *t, study_request *r, const char *name, bool *good);

/* Plain numbers are in SI: says so, once a key, where what is set in the cases has no unit, but the
   deck's own value has one. The cases have been checked. */
void study_warn_of_units(study_request *r, const study_case *cases, int count);

#endif
