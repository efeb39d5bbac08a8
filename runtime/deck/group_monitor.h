/* Groups of what is watched: monitors, and stops and frames that a monitor decides. */
#ifndef PERILAT_RUNTIME_GROUP_MONITOR_H
#define PERILAT_RUNTIME_GROUP_MONITOR_H

#include "runtime/deck/deck_schema.h"

extern const deck_group_info deck_group_monitor, deck_group_stop, deck_group_frame;

/* Unit of its values; "1" where the law says. `rotates`: its component is a rotation. */
const char *deck_monitor_unit(const deck_monitor *m, bool rotates);

/* A result has a history of that name, or a folder of histories, whatever the deck says. */
bool deck_is_history_name(const char *name);

#endif
