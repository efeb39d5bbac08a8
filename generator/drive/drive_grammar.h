/* The groups of a path for `perilat drive`, with their keys: a namelist file, read and described
   as decks are. */
#ifndef PERILAT_GENERATOR_DRIVE_GRAMMAR_H
#define PERILAT_GENERATOR_DRIVE_GRAMMAR_H

#include "runtime/deck/deck_schema.h"

/* X(name, single, open, doc) */
#define DRIVE_GROUPS(X)                                                                            \
  X(simulation, true, false, "The drive as a whole.")                                              \
  X(bond, true, false, "The bond that is driven.")                                                 \
  X(particle, true, false, "The particle of a law of families that is driven.")                    \
  X(point, true, false, "The point of a law of a continuum that is driven.")                       \
  X(material, true, true, "The law: every key but `model` sets a parameter or an option.")         \
  X(initial, true, true, "State and damage at the start, where not the law's own.")                \
  X(path, false, false, "What the bond, the particle or the point undergoes. At least one.")       \
  X(output, true, false, "What is written.")                                                       \
  X(expect, false, false, "What should come out. Give `value` or `formula`.")

enum {
#define X(name, single, open, doc) DRIVE_GROUP_##name,
  DRIVE_GROUPS(X)
#undef X
      DRIVE_GROUP_COUNT
};

/* The groups that a path may hold. */
extern const deck_grammar drive_grammar;
/* The group of paths with that name (without &), or NULL. */
const deck_group_info *drive_group(const char *name);

/* True when `file` has a group that only paths have; that only decks have. */
bool drive_is_path(const char *file);
bool drive_is_deck(const char *file);
/* True, after a sentence on the standard error stream, when `file` is a path for `perilat drive`
   and not the deck that `perilat COMMAND` needs. */
bool drive_refuse_path(const char *command, const char *file);

#endif
