/* Groups of a namelist by themselves, without a deck: their text read, and what was said of them.
   */
#ifndef PERILAT_TESTS_NOTATION_H
#define PERILAT_TESTS_NOTATION_H

#include <stdio.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/namelist.h"

typedef struct notation {
  arena *memory;
  source_set sources;
  diagnostics said;
  namelist *groups;
} notation;

static inline void read_text(notation *n, const char *text) {
  *n = (notation){.memory = arena_new()};
  diag_begin(&n->said, &n->sources);
  n->groups = namelist_read(n->memory, &n->sources,
                            source_add(&n->sources, "t.nml", text, strlen(text)), &n->said);
  assert_int_equal(n->said.errors, 0);
}

static inline void forget(notation *n) {
  diag_clear(&n->said);
  source_clear(&n->sources);
  arena_free(n->memory);
}

static inline void assert_last(const notation *n, diag_code code, const char *message) {
  assert_true(n->said.count > 0);
  const diagnostic *last = &n->said.items[n->said.count - 1];
  if (last->code != code || !strstr(last->message, message)) {
    diag_print(&n->said, stderr);
    fail_msg("expected \"%s\"", message);
  }
}

#endif
