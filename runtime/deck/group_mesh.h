/* Groups of meshes: the mesh, its cracks, how it steps. Its zones have shapes (group_body.h). */
#ifndef PERILAT_RUNTIME_GROUP_MESH_H
#define PERILAT_RUNTIME_GROUP_MESH_H

#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_schema.h"

/* What a mesh or a zone says of its elements; the setting is the mesh's. */
typedef struct deck_elements {
  mesh_method method;
  int gauss;
  mesh_dilatation dilatation;
  double hourglass;
  const char *setting;
} deck_elements;
void deck_check_elements(deck_reader *r, const namelist_group *from, const deck_item *item,
                         const deck_elements *e);

extern const deck_group_info deck_group_mesh, deck_group_crack, deck_group_tips, deck_group_newmark;

#endif
