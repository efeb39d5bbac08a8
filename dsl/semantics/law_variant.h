/* A checked law with other options, or for another lattice: a copy that shares all else with it.
   Nothing is changed on the law itself, and nothing is checked again, since the check of a law
   holds for all its options and lattices. */
#ifndef PERILAT_DSL_LAW_VARIANT_H
#define PERILAT_DSL_LAW_VARIANT_H

#include "dsl/semantics/law.h"

C_LINKAGE_BEGIN

/* All live in l->memory. Choices that name no option of the law, or none of its words, say
   nothing. */
const law *law_with_options(const law *l, const law_choice *choices, int count);
/* `neighbours` of a full family, or 0 where they are not known. */
const law *law_on_lattice(const law *l, law_setting setting, bool irregular, int neighbours);
/* Of a micropolar law in space: for bonds that bend in a plane and twist. */
const law *law_twisting(const law *l);
/* The same for bonds that bend about all axes. */
const law *law_bending_in_space(const law *l);

C_LINKAGE_END

#endif
