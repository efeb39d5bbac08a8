/* Does a law suit its lattice and deck: dimensions, kind of lattice, mass, names of what is stored.
   */
#ifndef PERILAT_RUNTIME_LAW_FITS_H
#define PERILAT_RUNTIME_LAW_FITS_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/kernel.h"
#include "runtime/lattice/rows.h"
#include "runtime/simulation/frame_field.h"

/* Where the deck says which law the lattice has. */
span law_fits_where(const deck *k);

/* A law is of the plane or of space. Laws of bonds run on the hexagonal lattice of nearest
   neighbours. */
bool law_fits_lattice(const pl_law *law, const deck *k, const rows *lattice, diagnostics *d);
/* Particles have a mass: the law has a density. */
bool law_fits_motion(const pl_law *law, const deck *k, diagnostics *d);
/* A warning where the deck protects particles in vain. */
void law_fits_protection(const pl_law *law, const deck *k, diagnostics *d);
/* Fields of the law have other names than what stands beside them in a result. */
bool law_fits_result(const pl_law *law, const deck *k, const frame_field *fields, int count,
                     diagnostics *d);

#endif
