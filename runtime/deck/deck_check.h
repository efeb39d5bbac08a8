/* What a group's keys mean together: shapes, loads, names that must exist, conflicts. Called group
   by group in the order of DECK_GROUPS, so that names are known before they are used. */
#ifndef PERILAT_RUNTIME_DECK_CHECK_H
#define PERILAT_RUNTIME_DECK_CHECK_H

#include "runtime/deck/deck_table.h"
#include "runtime/deck/namelist.h"

/* Where each component of a region is held or driven first; an empty span: nowhere. */
typedef struct deck_motions {
  span of[3];
} deck_motions;

typedef struct deck_reader {
  arena *memory;
  diagnostics *d;
  deck *k;
  bool
      names_known; /* false when some name could not be read: then unknown names are not reported */
  deck_motions *motions; /* [regions] */
  int moved;             /* components of any region, a bit each */
} deck_reader;

/* Completes one item from its group; its plain keys have been read without error. The item is not
   yet counted in the deck. */
#define X(group, identity, single, open, doc)                                                      \
  void deck_check_##group(deck_reader *r, const namelist_group *from, deck_##group *item);
DECK_GROUPS(X)
#undef X

/* What only the whole deck can tell. */
void deck_check_whole(deck_reader *r);

#endif
