/* The keys of one group of a file that is no deck, read by the table that describes them. */
#ifndef PERILAT_GENERATOR_GROUP_KEYS_H
#define PERILAT_GENERATOR_GROUP_KEYS_H

#include "runtime/deck/deck_schema.h"

/* Reads the keys that the table says how to read into `item`, whose defaults are set. False after
   messages: a key that is unknown, given twice, bad, or required and missing. */
bool group_keys_read(arena *a, const namelist_group *from, const deck_group_info *info, void *item,
                     diagnostics *d);
/* Where the group and its keys stand, for messages. */
void group_places(arena *a, const namelist_group *from, deck_item *item);

#endif
