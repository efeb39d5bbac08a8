/* The text of a deck to the deck: groups and their keys read, completed and checked one after the
   other, then the whole. Reading a deck reads the tables of its loads, touches no other file, and
   checks what can be checked without lattices or laws. */
#ifndef PERILAT_RUNTIME_DECK_READ_H
#define PERILAT_RUNTIME_DECK_READ_H

#include "runtime/deck/deck.h"

C_LINKAGE_BEGIN

/* Reads sources->items[file]. NULL on errors (all are reported). Overrides become sources of their
   own, named "--set", so that errors in them point at their text. Tables of loads become sources,
   too, and one that is there already, under its path, is not read from the disk. */
const deck *deck_read(arena *a, source_set *sources, int file, const deck_override *overrides,
                      int override_count, diagnostics *d);
/* The same, but never NULL: of a deck with errors what is right, so that more can be said of it.
   Faulty items are left out, but for materials whose law is known. */
const deck *deck_read_what_is_right(arena *a, source_set *sources, int file,
                                    const deck_override *overrides, int override_count,
                                    diagnostics *d);

C_LINKAGE_END

#endif
