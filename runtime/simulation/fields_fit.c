#include "runtime/simulation/fields_fit.h"

#include <string.h>

#include "runtime/deck/deck_value.h"

/* In a result stand side by side: the times, fields of particles, a folder for the bonds of each
   lattice; in such a folder the fields of its bonds. Those of cells have a folder of their own. */
static bool is_named_once(const deck *k, const frame_field *f, int count, int field) {
  const char *name = f[field].name;
  if (f[field].on_bonds || f[field].on_cells) return true;
  bool once = strcmp(name, "time") != 0;
  for (int n = 0; n < count; n++)
    if (n != field && !f[n].of_cracks && !f[n].of_stamp && !f[n].on_cells)
      once = once &&
             strcmp(f[n].on_bonds ? k->interactions[f[n].interaction].name : f[n].name, name) != 0;
  return once;
}

/* What any law has is not what a law is told to name otherwise. */
static bool is_own_field(const frame_field *f) {
  return f->of_cracks || f->of_stamp || (strcmp(f->kind, "other") == 0 && !f->of_law);
}

bool fields_fit_result(const deck *k, const run_body *bodies, const frame_field *fields, int count,
                       diagnostics *d) {
  const int errors = d->errors;
  for (int n = 0; n < count; n++) {
    const char *name = fields[n].name;
    if (is_own_field(&fields[n]) || is_named_once(k, fields, count, n)) continue;
    const run_law *of = &bodies[0].laws[fields[n].interaction];
    diag_report(d, DIAG_RESERVED_NAME, deck_where(&of->from->material->item, "model"),
                "`%s` of the law `%s` cannot be stored: a result has another `%s` there", name,
                of->law->name, name);
    diag_hint(d, "give it another name in the law, or leave it out of `fields` in &output");
  }
  return d->errors == errors;
}
