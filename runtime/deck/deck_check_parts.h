/* Inside of the checks of a deck, shared by its parts: deck_check_shape.c, deck_check_lattice.c (lattices, their materials and
   random fields) and deck_check.c (all other groups, and the whole). All report at the deck's line. */
#ifndef PERILAT_RUNTIME_DECK_CHECK_PARTS_H
#define PERILAT_RUNTIME_DECK_CHECK_PARTS_H

#include "runtime/deck/deck_check.h"

/* The name that an item's key gives must be that of a lattice, or of a region. */
bool deck_lattice_known(deck_reader *r, const deck_item *item, const char *name);
bool deck_region_known(deck_reader *r, span where, const char *name);
bool deck_item_region_known(deck_reader *r, const deck_item *item, const char *name);
bool deck_monitor_known(deck_reader *r, span where, const char *name);
/* A name is new, and fits into the paths of a result. `first`: the item that has it already, or
   NULL. */
void deck_check_name(deck_reader *r, const char *kind, const char *name, const deck_item *item,
                     const deck_item *first);
/* Names of faulty items may be missing. */
bool deck_same_name(const char *a, const char *b);
bool deck_is_one_of(const char *name, const char *const *words, int count);

void deck_refuse_both(deck_reader *r, const namelist_group *from, const char *a, const char *b);
/* A place has two or three coordinates, as the lattice has dimensions. */
void deck_check_place(deck_reader *r, const namelist_group *from, const char *name, int dimensions);
/* Dimensions of the lattice of that name, or of the only one; 0 when it is not known which. */
int deck_dimensions_of(const deck_reader *r, const char *lattice);

/* Completes a shape in that lattice (NULL: the only one). */
void deck_check_shape(deck_reader *r, const namelist_group *from, const deck_item *item,
                      deck_shape *shape, const char *lattice);
/* Irregular particles fill areas and volumes; a notch may be a slit. */
void deck_check_can_be_filled(deck_reader *r, const deck_item *item, const deck_shape *shape,
                              const char *lattice, bool is_body);

#endif
