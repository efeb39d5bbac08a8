/* Groups that have a shape: bodies, notches, the regions that name particles, zones of meshes,
   stamps; masses that regions carry. */
#ifndef PERILAT_RUNTIME_GROUP_BODY_H
#define PERILAT_RUNTIME_GROUP_BODY_H

#include "runtime/deck/deck_schema.h"

extern const deck_group_info deck_group_body, deck_group_notch, deck_group_region, deck_group_zone,
    deck_group_point_mass, deck_group_stamp;

#endif
