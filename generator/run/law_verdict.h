/* The verdict of mechanics on a law with the values of a deck, on its lattice. */
#ifndef PERILAT_GENERATOR_LAW_VERDICT_H
#define PERILAT_GENERATOR_LAW_VERDICT_H

#include "generator/kernel/model.h"
#include "runtime/deck/deck.h"

/* Does the law obey mechanics with these parameters on this lattice, a perfect one? What is
   wrong goes to `of_law`. That it does not with all that its bounds allow is a warning at
   `where` of `of_values`. */
bool run_law_obeys(model *opened, const deck_lattice *lattice, const double *parameters, span where,
                   diagnostics *of_law, diagnostics *of_values);

#endif
