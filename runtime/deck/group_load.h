/* Groups of what holds, moves and loads particles, and of contact between them. */
#ifndef PERILAT_RUNTIME_GROUP_LOAD_H
#define PERILAT_RUNTIME_GROUP_LOAD_H

#include "runtime/deck/deck_schema.h"

extern const deck_group_info deck_group_support, deck_group_drive, deck_group_force,
    deck_group_traction, deck_group_end_moment, deck_group_protect, deck_group_damping,
    deck_group_gravity, deck_group_contact, deck_group_initial_velocity,
    deck_group_initial_displacement;

#endif
