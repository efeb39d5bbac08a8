/* What a study sets in a deck, and where that was asked for. The deck reader knows such texts as
   those of --set; what it says of them is shown where they stand. */
#ifndef PERILAT_GENERATOR_STUDY_SETTING_H
#define PERILAT_GENERATOR_STUDY_SETTING_H

#include "generator/study/study_axis.h"
#include "runtime/deck/deck.h"

typedef struct study_setting {
  const char *key, *value; /* "lattice.spacing", "20 mm" */
  const char *text;        /* of both, as --set takes it */
  span key_where, value_where;
} study_setting;

study_setting study_set(arena *a, const char *key, const char *value, span key_where,
                        span value_where);
/* Of "group.key=value" as it was given. */
study_setting study_set_text(arena *a, const study_text *given);

deck_override *study_overrides(arena *a, const study_setting *settings, int count);
/* Moves what was said of a deck that was read with these overrides, and of no other, to where they
   stand in the sources `from`. */
void study_place(const source_set *from, const study_setting *settings, diagnostics *said);

#endif
