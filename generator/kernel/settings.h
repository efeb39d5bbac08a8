/* `--set name=value` of the commands that ask about a law: parameters and options as a &material
 * gives them. */
#ifndef PERILAT_GENERATOR_SETTINGS_H
#define PERILAT_GENERATOR_SETTINGS_H

#include "runtime/deck/deck.h"
#include "runtime/base/namelist.h"

/* Adds to m->assignments what the texts set, e.g. "E=40 GPa" or "softening=exponential"; what
   was assigned to such a name before is replaced; "E=" takes it back to the law's default. Each
   text becomes a source named "--set", so that messages point into it. False on errors. */
bool settings_read(arena *a, source_set *sources, const char *const *texts, int count,
                   deck_material *m, diagnostics *d);

/* The assignments of a namelist group in which every key but `lattice` and `model` is one. False on
 * errors. */
bool settings_of_group(arena *a, const namelist_group *g, deck_material *m, diagnostics *d);

#endif
