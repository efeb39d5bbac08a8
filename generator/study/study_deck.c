#include "generator/study/study_deck.h"

#include <stdlib.h>
#include <string.h>

#include "generator/kernel/model.h"
#include "generator/run/run.h"
#include "runtime/deck/deck_read.h"

bool study_deck_open(study_deck *t, study_request *r, const study_text *path) {
  char error[4096];
  size_t length;
  *t = (study_deck){.setting_count = r->set.count};
  char *text = read_text_file(path->text, DECK_LIMIT, &length, error, sizeof error);
  if (!text) {
    diag_report(&r->said, DIAG_FILE, path->where, "%s", error);
    return false;
  }
  t->file = source_add(&t->sources, path->text, text, length);
  t->settings = arena_alloc(r->memory, ((size_t)r->set.count + 1) * sizeof *t->settings);
  for (int k = 0; k < r->set.count; k++)
    t->settings[k] = study_set_text(r->memory, &r->set.items[k]);
  free(text);
  return true;
}

void study_deck_close(study_deck *t) {
  source_clear(&t->sources);
}

const char *study_deck_value(const study_deck *t, study_request *r, const char *name, bool *good) {
  source_set sources = {NULL, 0}; /* reading adds to them */
  const source *own = &t->sources.items[t->file];
  diagnostics said;
  diag_begin(&said, &sources);
  const int file = source_add(&sources, own->name, own->text, own->length);
  const deck_override *overrides = study_overrides(r->memory, t->settings, t->setting_count);
  const char *value =
      deck_read_value(r->memory, &sources, file, overrides, t->setting_count, name, &said);
  study_place(&r->sources, t->settings, &said);
  diag_print(&said, stderr);
  *good = *good && said.errors == 0;
  diag_clear(&said);
  source_clear(&sources);
  return value;
}
