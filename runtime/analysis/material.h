/* Parameter values of a &material against the table of its law. */
#ifndef PERILAT_RUNTIME_MATERIAL_H
#define PERILAT_RUNTIME_MATERIAL_H

#include "dsl/base/c_linkage.h"
#include "runtime/deck/deck.h"
#include "runtime/kernel.h"

C_LINKAGE_BEGIN

/* Parameter values of a &material: checks names (with suggestions), units and bounds against the
   law's table and reports at the deck's line. False on errors. values has law->parameter_count
   entries. */
bool material_parameters(const deck_material *m, const pl_law *law, double *values, diagnostics *d);

/* The law declares the parameter as a field, which may change in time. */
bool material_is_given(const pl_law *law, int parameter);

/* The mass density (kg/m^3) that a law with these parameter values gives its particles, or 0. */
double material_density(const pl_law *law, const double *values);

C_LINKAGE_END

#endif
