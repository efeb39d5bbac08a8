#include "generator/run/law_verdict.h"

#include "dsl/semantics/law_variant.h"
#include "generator/sense/sense.h"

/* What `perilat check law.plm` judges is more than a deck needs. */
static void warn_of_other_values(model *opened, const law *l, span where, diagnostics *d) {
  const law *alone = law_on_lattice(l, law_first_setting(l), l->irregular, l->neighbours);
  diagnostics found;
  diag_begin(&found, &opened->sources);
  if (!law_is_sound(alone, NULL, &found, NULL)) {
    diag_report(d, DIAG_DECK_WARNING, where,
                "the law `%s` obeys mechanics with these values on this lattice, but not with all "
                "that its bounds allow",
                l->tree->name);
    diag_hint(d, "`perilat check %s`, with the options chosen here, shows where", opened->path);
  }
  diag_clear(&found);
}

bool run_law_obeys(model *opened, const deck_lattice *lattice, const double *parameters, span where,
                   diagnostics *of_law, diagnostics *of_values) {
  const physics_options options = {.parameters = parameters, .lattice = lattice, .effort = 0.5};
  const law *l = opened->law, *regular = law_on_lattice(l, l->setting, false, l->neighbours);
  const bool good = law_is_sound(regular, &options, of_law, NULL);
  if (good) warn_of_other_values(opened, regular, where, of_values);
  return good;
}
