/* Groups of what holds, moves and loads particles, and of contact between them. */
#ifndef PERILAT_RUNTIME_GROUP_LOAD_H
#define PERILAT_RUNTIME_GROUP_LOAD_H

#include "runtime/deck/deck_check.h"

extern const deck_group_info deck_group_support, deck_group_drive, deck_group_force,
    deck_group_traction, deck_group_end_moment, deck_group_protect, deck_group_damping,
    deck_group_gravity, deck_group_contact, deck_group_initial_velocity,
    deck_group_initial_displacement;

/* A displacement that the group gives without a history grows over a quasi-static run; one that
   comes at once is warned of. */
void deck_spread_displacement(deck_reader *r, const namelist_group *from, time_function *f);

#endif
