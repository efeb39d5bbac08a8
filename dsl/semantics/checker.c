#include "dsl/semantics/checker.h"

#include <stdarg.h>
#include <stdio.h>

enum { LONGEST_QUOTE = 40 };

bool is_single(const checker *ck) {
  return ck->tree->law != LAW_STATE;
}

placement natural_place(const checker *ck) {
  if (ck->tree->law == LAW_CONTINUUM) return ON_POINT;
  if (ck->tree->law == LAW_CRACK) return ON_TIP;
  return is_single(ck) ? ON_BOND : ON_PARTICLE;
}

const char *law_word(const checker *ck) {
  if (ck->tree->law == LAW_CONTINUUM) return "continuum";
  if (ck->tree->law == LAW_CRACK) return "crack";
  if (ck->tree->law == LAW_SLIP_BOND) return "slip";
  return is_single(ck) ? "bond" : "state";
}

void complain(checker *ck, diag_code code, span where, const char *format, ...) {
  char text[1024];
  va_list values;
  va_start(values, format);
  vsnprintf(text, sizeof(text), format, values);
  va_end(values);
  if (ck->call_depth == 0) {
    diag_report(ck->d, code, where, "%s", text);
    return;
  }
  const char *name = ck->function->symbol.name;
  diag_report(ck->d, code, ck->call_where, "in `%s`: %s", name, text);
  diag_note(ck->d, where, "this is the place in `%s`", name);
}

const char *written(checker *ck, const expr *e, const char *otherwise) {
  span at = e->where;
  if (at.file >= ck->sources->count || at.end <= at.begin) return otherwise;
  const source *s = &ck->sources->items[at.file];
  if (at.end > s->length || at.end - at.begin > LONGEST_QUOTE) return otherwise;
  for (uint32_t i = at.begin; i < at.end; i++)
    if ((unsigned char)s->text[i] < ' ') return otherwise;
  return arena_text(ck->memory, s->text + at.begin, at.end - at.begin);
}
