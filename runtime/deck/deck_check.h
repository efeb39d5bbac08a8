/* What the checks of groups share: names that must exist, directions, places, keys that exclude
   each other. All report at the deck's line. */
#ifndef PERILAT_RUNTIME_DECK_CHECK_H
#define PERILAT_RUNTIME_DECK_CHECK_H

#include "runtime/deck/deck_schema.h"
#include "runtime/kernel.h"

/* Where each component of a region is held or driven first; an empty span: nowhere. */
typedef struct deck_motions {
  span of[PL_MAX_DOF];
} deck_motions;

typedef struct deck_reader {
  arena *memory;
  diagnostics *d;
  deck *k;
  /* false when some name could not be read: then unknown names are not reported */
  bool names_known;
  deck_motions *motions; /* [regions] */
} deck_reader;

/* The name that an item's key gives must be that of a lattice (bars and links are some), of a bar,
   of a link, or of a region. */
bool deck_lattice_known(deck_reader *r, const deck_item *item, const char *name);
bool deck_lattice_known_at(deck_reader *r, span where, const char *name);
bool deck_bar_known(deck_reader *r, const deck_item *item, const char *name);
bool deck_link_known(deck_reader *r, const deck_item *item, const char *name);
bool deck_mesh_known(deck_reader *r, const deck_item *item, const char *name);
/* Zones, holes, cracks: what the mesh of a file does not have. */
void deck_refuse_of_file(deck_reader *r, const deck_item *item, const char *mesh, const char *what);
bool deck_region_known(deck_reader *r, span where, const char *name);
bool deck_item_region_known(deck_reader *r, const deck_item *item, const char *name);
bool deck_monitor_known(deck_reader *r, span where, const char *name);
bool deck_stamp_known(deck_reader *r, const deck_item *item, const char *name);
/* Particles of that lattice (-1: it is not known) move by themselves: it is no link. */
bool deck_moves(deck_reader *r, span where, int lattice);
/* Both of a region's. */
bool deck_moving_region_known(deck_reader *r, const deck_item *item, const char *name);
/* A name is new, and fits into the paths of a result. `first`: the item that has it already, or
   NULL. */
void deck_check_name(deck_reader *r, const char *kind, const char *name, const deck_item *item,
                     const deck_item *first);
/* The same of a lattice, a bar or a link, which stand side by side in results. */
void deck_check_lattice_name(deck_reader *r, const deck_lattice *item);
/* Monitors and cracks, which stand side by side in results: the name of one of `kind` is not that
   of `other`, of the kind `its_kind`; NULL: there is no such. */
void deck_check_not_both(deck_reader *r, const char *kind, const deck_item *item,
                         const char *its_kind, const char *name, const deck_item *other);
/* Names of faulty items may be missing. */
bool deck_same_name(const char *a, const char *b);
bool deck_is_one_of(const char *name, const char *const *words, int count);

void deck_refuse_both(deck_reader *r, const namelist_group *from, const char *a, const char *b);
/* Places have two or three coordinates, as the lattice has dimensions: all DECK_PLACE of the
   group. */
void deck_check_places(deck_reader *r, const namelist_group *from, const deck_group_info *info,
                       int dimensions);
/* Dimensions of the lattice of that name, or of the only one; 0 when it is not known which. */
int deck_dimensions_of(const deck_reader *r, const char *lattice);
int deck_dimensions_of_region(const deck_reader *r, const char *region);
int deck_lattice_of_region(const deck_reader *r, const char *region); /* -1: it is not known */

/* Directions as written; their positions are those of DECK_FIXED's bits, too. */
#define DECK_COMPONENTS "x|y|z|rotation|rotation_x|rotation_y|rotation_z"
enum { DECK_WRITTEN_Z = 2, DECK_WRITTEN_ROTATION = 3, DECK_WRITTEN_COUNT = 7 };
/* The degree of freedom of a direction as written. -1 after a message: it is none of the region's
   particles. */
int deck_component(deck_reader *r, span where, const char *region, int written);
/* The same where the dimensions are known, or 0. */
int deck_component_in(deck_reader *r, span where, int dimensions, int written);
/* The same for the item's key `component`, in place. False after a message. */
bool deck_take_component(deck_reader *r, const deck_item *item, const char *region, int *component);
/* Bits 1 << component of directions as written, bits 1 << direction: `rotation` is all rotations
   that there are. Of none of the region's particles: 0 bits, after a message. */
int deck_components(deck_reader *r, span where, const char *region, int written);
bool deck_is_rotation(const deck_reader *r, const char *region, int component);
const char *deck_component_of(const deck_reader *r, const char *region, int component);

/* A time that is not before the end of the run is worth a warning. */
void deck_warn_late(deck_reader *r, const deck_item *item, const char *key, double time);

#endif
