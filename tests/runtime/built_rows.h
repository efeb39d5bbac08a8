/* A deck's text as its deck, and the sites of its first lattice. */
#ifndef PERILAT_TESTS_BUILT_ROWS_H
#define PERILAT_TESTS_BUILT_ROWS_H

#include <stdio.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/deck/deck_read.h"
#include "runtime/filling/lattice.h"

typedef struct built_rows {
  arena *memory;
  source_set sources;
  diagnostics said;
  const deck *deck;
  rows *rows;
} built_rows;

/* NULL stays for what the text does not give; why is in b->said. */
static inline void read_deck(built_rows *b, const char *text) {
  *b = (built_rows){.memory = arena_new()};
  diag_begin(&b->said, &b->sources);
  const int file = source_add(&b->sources, "deck.nml", text, strlen(text));
  b->deck = deck_read(b->memory, &b->sources, file, NULL, 0, &b->said);
}

static inline void build_rows(built_rows *b, const char *text) {
  read_deck(b, text);
  if (b->deck) b->rows = lattice_build(b->deck, 0, &b->said);
  if (!b->rows) diag_print(&b->said, stderr);
  assert_non_null(b->rows);
}

static inline void built_end(built_rows *b) {
  rows_free(b->rows);
  diag_clear(&b->said);
  source_clear(&b->sources);
  arena_free(b->memory);
}

#endif
