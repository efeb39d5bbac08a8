/* The law of a material: opened once, with the options that the material sets, for the lattice
   that it fills. Messages about the law itself stay in out->said for the caller to print, those
   about the deck's lines go to `said`; the model must be closed when out->memory is set. */
#ifndef PERILAT_GENERATOR_MATERIAL_LAW_H
#define PERILAT_GENERATOR_MATERIAL_LAW_H

#include "dsl/base/c_linkage.h"
#include "generator/kernel/model.h"
#include "runtime/deck/deck.h"

C_LINKAGE_BEGIN

/* Finds (beside the deck, model_find), reads and plans it. Without a lattice a bond is of one in
   plane stress, and families are of the setting that the law names first. */
bool material_law_open(const deck_material *m, const deck_lattice *l, const char *deck_path,
                       model *out, diagnostics *said);

/* The setting of a lattice or mesh: its key `setting`. */
law_setting material_setting(const deck_lattice *l);
/* The steps of that. Opens the file `path`, which is refused, unseen, when it holds no law, and
   takes the options. */
bool material_law_read(const deck_material *m, const char *path, model *out, diagnostics *said);
/* The options of an opened law that the material sets; out->values has what it sets beside them,
   the values for material_parameters. */
bool material_law_take_options(const deck_material *m, model *out, diagnostics *said);
/* The same of a material of a region, which has the options of its lattice's: `values` is it
   without them. */
bool material_law_regional(const deck_material *m, const model *of, arena *memory,
                           deck_material *values, diagnostics *said);
/* Plans the kernel that this lattice needs, and what differs in space: the material's random
   fields, the values of its regions. */
bool material_law_plan(const deck_material *m, const deck_lattice *l, model *out,
                       diagnostics *said);

C_LINKAGE_END

#endif
