/* Groups of what is watched: monitors, and stops and frames that a monitor decides. */
#ifndef PERILAT_RUNTIME_GROUP_MONITOR_H
#define PERILAT_RUNTIME_GROUP_MONITOR_H

#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_schema.h"

extern const deck_group_info deck_group_monitor, deck_group_stop, deck_group_frame;

/* Unit of its values; "1" where the law says. `rotates`: its component is a rotation. */
const char *deck_monitor_unit(const deck_monitor *m, bool rotates);

/* A result of this deck has a history of that name, or a folder of histories, whatever is
   watched. */
bool deck_is_history_name(const deck *k, const char *name);
/* Of a `kind` of item whose name is that of a folder of histories: a message where it cannot be. */
void deck_check_folder_name(deck_reader *r, const char *kind, const deck_item *item,
                            const char *name);

#endif
