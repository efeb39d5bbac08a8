/* Does a law suit its lattice and deck, and do laws suit each other: dimensions, kind of lattice,
   mass, names of what is stored. */
#ifndef PERILAT_RUNTIME_LAW_FITS_H
#define PERILAT_RUNTIME_LAW_FITS_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/kernel.h"
#include "runtime/lattice/rows.h"
#include "runtime/parts/run_body.h"

/* Where the deck says which law the lattice of that number has. */
span law_fits_where(const deck *k, int lattice);

/* A law is of the plane or of space. Laws of bonds run on the hexagonal lattice of nearest
   neighbours. `of`: the material that has it; NULL: that of the whole lattice. */
bool law_fits_lattice(const pl_law *law, const deck_material *of, const deck *k, int lattice,
                      const rows *w, diagnostics *d);
/* Particles have a mass: the law has a density. */
bool law_fits_motion(const pl_law *law, const deck *k, int lattice, diagnostics *d);
/* A warning where the deck protects particles of the lattice in vain. */
void law_fits_protection(const pl_law *law, const deck *k, int lattice, diagnostics *d);
/* A warning where elements of a mesh in plane strain lock, as the law at rest hardly changes its
   volume; `number`: of the law in the mesh. */
void law_fits_elements(const pl_law *law, const cells *c, int number, span where, diagnostics *d);
/* Bodies of one run are all of the plane or all in space, and what the result calls after them has
   no other name there. */
bool bodies_fit(const deck *k, const run_body *bodies, int count, diagnostics *d);

#endif
