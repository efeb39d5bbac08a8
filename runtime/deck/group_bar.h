/* Groups of bars: the line of a bar, and the link that joins it to the lattice around it; and of
   what ties a lattice to a mesh. */
#ifndef PERILAT_RUNTIME_GROUP_BAR_H
#define PERILAT_RUNTIME_GROUP_BAR_H

#include "runtime/deck/deck_schema.h"

extern const deck_group_info deck_group_bar, deck_group_link, deck_group_tie;

#endif
