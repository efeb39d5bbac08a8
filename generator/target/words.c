#include "generator/target/words.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/plan/plan.h"

static const char *const c_words[] = {
#define X(name, text) [SAY_##name] = text,
    C_WORDS(X)
#undef X
};

void words_add(c_text *out, word w, const char *const *pieces) {
  const char *text = c_words[w];
  for (const char *hole = strchr(text, '$'); hole; hole = strchr(text, '$')) {
    const char *piece = pieces[hole[1] - '0'];
    assert(piece);
    c_text_add(out, "%.*s%s", (int)(hole - text), text, piece);
    text = hole + 2;
  }
  c_text_add(out, "%s", text);
}

const char *words_text(arena *memory, word w, const char *const *pieces) {
  c_text t = {0};
  words_add(&t, w, pieces);
  const char *text = arena_text(memory, t.text ? t.text : "", t.length);
  free(t.text);
  return text;
}

const char *words_join(arena *memory, const char *list, const char *separator, const char *item) {
  return list ? arena_printf(memory, "%s%s%s", list, separator, item) : item;
}

void words_reserve(c_names *names) {
  static const char *const own[] = {
      "law",         "uniforms",      "strip",         "count",         "q",
      "flags",       "given",         "bonds",         "present",       "lower",
      "upper",       "low_open",      "high_open",     "parameters",    "family",
      "present_bit", "protected_bit", "first",         "lanes",         "k",
      "to",          "half",          "back",          "last",          "kept",
      "unusual",     "owned",         "owner",         "sign",          "zeros",
      "got",         "link_to",       "changed",       "constant",      "above",
      "large",       "told",          "before",        "group",         "lent",
      "UNIFORMS",    "are_equal",     "some_marked",   "store_at_ends", "changes",
      "bits",        "changed_plane", "changed_marks", "cells",         "slopes",
      "push",        "stride",        "lane",          "low",           "high",
      "cell_stress", "pushed",        "cell_strain",   "cell_rate",
      "from",        "until",         "span",          "which",         "way",
      "alike",       "alike_toward",  "end_of_alike"};
  for (size_t k = 0; k < sizeof own / sizeof *own; k++)
    c_names_reserve(names, own[k]);
#define X(task, member) c_names_reserve(names, #member "_unusual");
  STRIP_PROGRAMS(X)
#undef X
}
