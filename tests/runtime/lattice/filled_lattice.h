/* A deck in memory with one lattice, and its sites. */
#ifndef PERILAT_TESTS_FILLED_LATTICE_H
#define PERILAT_TESTS_FILLED_LATTICE_H

#include <string.h>

#include "runtime/filling/lattice.h"

enum { MOST_SHAPES = 8 };

typedef struct filled_lattice {
  deck deck;
  deck_lattice lattice;
  deck_body bodies[MOST_SHAPES];
  deck_notch notches[MOST_SHAPES];
  source_set sources;
  diagnostics d;
} filled_lattice;

static inline void fill_begin(filled_lattice *b, deck_lattice lattice) {
  memset(b, 0, sizeof *b);
  b->lattice = lattice;
  b->deck.lattices = &b->lattice;
  b->deck.lattice_count = 1;
  b->deck.bodys = b->bodies;
  b->deck.notchs = b->notches;
  source_add(&b->sources, "test.nml", "&body /", 7);
  diag_begin(&b->d, &b->sources);
}

static inline void fill_end(filled_lattice *b, rows *w) {
  rows_free(w);
  diag_clear(&b->d);
  source_clear(&b->sources);
}

static inline void add_body(filled_lattice *b, deck_shape shape) {
  b->bodies[b->deck.body_count++] =
      (deck_body){.item = {.where = {0, 5, 0}}, .lattice = b->lattice.name, .shape = shape};
}

static inline void add_notch(filled_lattice *b, deck_shape shape, bool cut_bonds) {
  b->notches[b->deck.notch_count++] = (deck_notch){.item = {.where = {0, 5, 0}},
                                                   .lattice = b->lattice.name,
                                                   .shape = shape,
                                                   .cut_bonds = cut_bonds};
}

static inline rows *fill_rows(filled_lattice *b) {
  rows *w = lattice_build(&b->deck, 0, &b->d);
  for (int k = 0; k < b->d.count; k++)
    print_message("%s\n", b->d.items[k].message);
  assert_non_null(w);
  assert_int_equal(b->d.errors, 0);
  return w;
}

#endif
