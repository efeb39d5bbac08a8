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

/* The `&study` of a file alone, or its defaults where it has none; *whole: the file has other
   groups, too. NULL after messages. */
const deck_study *deck_read_study(arena *a, source_set *sources, int file, bool *whole,
                                  diagnostics *d);

/* What the deck, with its overrides, gives for "group.key", as --set would take it: "-42 kN/m".
   NULL where it gives none, or after messages. */
const char *deck_read_value(arena *a, source_set *sources, int file, const deck_override *overrides,
                            int override_count, const char *name, diagnostics *d);

C_LINKAGE_END

#endif
