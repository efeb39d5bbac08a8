/* The particles of a link between a bar and the places that it lies at in a lattice, whether there
   are sites or not. Each chosen particle of the bar has one bond, to a place of the lattice that
   moves as the sites of the cell that holds it do (a triangle in the plane, a tetrahedron in
   space; weights are linear, so that a uniform strain moves the place as it moves the sites). No
   notch goes through the cell; a particle without such a cell, outside of the lattice or at a notch
   within about a spacing, is not joined.

   A law of bonds sees how the two slide past each other: in the reference state the place is shown
   to it by the bond's length further along the bar, and it turns with the bar's present tangent,

       bar   o------->  shown place           length + slip = present chord along the bar,
             x tangent                        gap = chord across it
   so that stretch times length is the slip, and the shear of a micropolar law goes with the gap.
   That length is the length of bar that the bond stands for (bar_line.h). What the bond exerts acts
   on the bar's particle and, shared out by the weights, on the sites. Its end moments are those of
   the chord that is only shown, and act on nothing. */
#ifndef PERILAT_RUNTIME_TIED_H
#define PERILAT_RUNTIME_TIED_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/filling/bar_line.h"
#include "runtime/lattice/near_particles.h"
#include "runtime/lattice/rows.h"

/* A body's particles as tied_cell asks for them; to be ended. */
near_particles tied_near(const rows *body);
/* The cell of a body's sites that holds a place: its particles and weights, the heaviest first.
   Notches of that lattice of the deck cut cells; without a deck none do. False without a cell. */
bool tied_cell(near_particles *near, const deck *k, const deck_lattice *around,
               const double place_of[3], rows_copy *out);

/* Of a link of the deck that joins places; of the bar and of the lattice around it. NULL after
   messages at the deck's line. */
rows *tied_build(const deck *k, const deck_link *link, const bar_line *line, const rows *bar,
                 const rows *body, diagnostics *d);

#endif
