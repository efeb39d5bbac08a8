#include "generator/facts/law_judged.h"

#include "dsl/semantics/law_variant.h"
#include "generator/intervals/interval_check.h"
#include "generator/sense/sense.h"

bool law_obeys(const law *l, const double *parameters, diagnostics *d, physics_report *report) {
  const bool good = law_is_sound(l, &(physics_options){.parameters = parameters}, d, report);
  interval_check(l, d);
  return good;
}

bool law_obeys_alone(const law *l, diagnostics *d) {
  return law_obeys(law_on_lattice(l, law_first_setting(l), false, 0), NULL, d, NULL);
}
