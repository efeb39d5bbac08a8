/* Groups of meshes: the mesh, its cracks, how it steps. Its zones have shapes (group_body.h). */
#ifndef PERILAT_RUNTIME_GROUP_MESH_H
#define PERILAT_RUNTIME_GROUP_MESH_H

#include "runtime/deck/deck_schema.h"

extern const deck_group_info deck_group_mesh, deck_group_crack, deck_group_tips, deck_group_newmark;

#endif
