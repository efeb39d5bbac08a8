#include "generator/study/study_deck.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/units.h"
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

/* --- numbers without unit --------------------------------------------------------------------- */

/* "5", but for 0, which is the same in all units. */
static bool is_plain(const char *text) {
  double number;
  const char *unit_text;
  return study_split_number(text, &number, &unit_text) && !*unit_text && number != 0;
}

/* The unit of a number of the deck; NULL where it has none, or is an angle, whose plain numbers are
   in degrees. */
static const char *unit_of(const char *own, unit *u) {
  double number;
  const char *unit_text, *bad;
  size_t length;
  if (!own || !study_split_number(own, &number, &unit_text) || !*unit_text ||
      !unit_parse(unit_text, strlen(unit_text), u, &bad, &length) ||
      dim_equal(u->dim, (unit){.factor = 1}.dim))
    return NULL;
  return unit_text;
}

static void warn_of(study_request *r, const study_deck *t, const study_setting *s) {
  bool good = true;
  unit u = {.factor = 1};
  char si[64];
  const char *own = study_deck_value(t, r, s->key, &good), *unit_text = unit_of(own, &u);
  if (!unit_text) return;
  dim_unit(u.dim, si, sizeof si);
  if (u.factor == 1) return;
  diag_report(&r->said, DIAG_DECK_WARNING, s->value_where,
              "`%s` has no unit and is read as %s %s; the deck's own `%s` is %s", s->value,
              s->value, si, s->key, own);
  diag_hint(&r->said, "write `%s %s` if that is meant, or else `%s %s`", s->value, unit_text,
            s->value, si);
}

static bool is_told(const study_setting *const *told, int count, const char *key) {
  for (int k = 0; k < count; k++)
    if (study_same_key(told[k]->key, key)) return true;
  return false;
}

void study_warn_of_units(study_request *r, const study_case *cases, int count) {
  study_deck t;
  const study_setting **told = NULL;
  int told_count = 0;
  if (!study_deck_open(&t, r, &r->decks.items[0])) return;
  t.setting_count = 0; /* the deck's own values */
  for (int c = 0; c < count; c++)
    for (int k = 0; k < cases[c].setting_count; k++) {
      const study_setting *s = &cases[c].settings[k];
      if (!is_plain(s->value) || is_told(told, told_count, s->key)) continue;
      told = arena_room(r->memory, told, told_count, sizeof *told);
      told[told_count++] = s;
      warn_of(r, &t, s);
    }
  study_deck_close(&t);
  study_warn(r);
}
