/* Groups of a lattice: its sites, its material, and the random fields of its parameters. */
#ifndef PERILAT_RUNTIME_GROUP_LATTICE_H
#define PERILAT_RUNTIME_GROUP_LATTICE_H

#include "runtime/deck/deck_schema.h"

extern const deck_group_info deck_group_lattice, deck_group_material, deck_group_field;
/* Keys of the group that are no keys of every material: values of parameters, choices of options.
   False after messages. */
bool deck_assignments_read(arena *a, const namelist_group *g, const deck_group_info *info,
                           deck_material *m, diagnostics *d);

#endif
