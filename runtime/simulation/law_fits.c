#include "runtime/simulation/law_fits.h"

#include <string.h>
#include <strings.h>

span law_fits_where(const deck *k) {
  const deck_lattice *lattice = &k->lattices[0];
  const int m = deck_find_material(k, lattice->name);
  return m < 0 ? lattice->item.where : deck_where(&k->materials[m].item, "model");
}

bool law_fits_motion(const pl_law *law, const deck *k, diagnostics *d) {
  if (law->density >= 0) return true;
  diag_report(d, DIAG_MISSING_KEY, law_fits_where(k),
              "the law `%s` has no parameter `rho`, so its particles have no mass", law->name);
  for (int p = 0; p < law->parameter_count; p++)
    if (strcasecmp(law->parameters[p].name, "rho") == 0) {
      diag_hint(d, "in a law upper and lower case differ: write `rho` for `%s`",
                law->parameters[p].name);
      return false;
    }
  diag_hint(d, "add a mass density to the law, e.g. parameter rho = 2300 [kg/m^3] in (0, inf)");
  return false;
}

/* Protection keeps damage as it is: a law that softens through a plain state is not held back by
   it. */
void law_fits_protection(const pl_law *law, const deck *k, diagnostics *d) {
  for (int f = 0; f < law->field_count; f++)
    if (law->fields[f].kind == PL_FIELD_DAMAGE) return;
  if (k->protect_count > 0 && law->field_count > 0)
    diag_report(
        d, DIAG_DECK_WARNING, k->protects[0].item.where,
        "the law `%s` has no damage that could be held back; its states go on as they do elsewhere",
        law->name);
}

/* --- the lattice ------------------------------------------------------------------------------ */

/* The kernel of a law of families is made for lattices or for lists. A solver has one, and its deck
   may change. */
static bool topology_serves(const pl_law *law, const deck *k, const rows *lattice, diagnostics *d) {
  const deck_lattice *l = &k->lattices[0];
  const bool list = lattice->list != NULL;
  const int neighbours = 2 * lattice->directions;
  const bool same = (law->topology == PL_LIST) == list;
  if (law->kind == PL_STATE && same && law->neighbours && law->neighbours != neighbours) {
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, l->horizon > 0 ? "horizon" : "shells"),
                "this solver was built for %d neighbours, not %d", law->neighbours, neighbours);
    diag_hint(d, "build another one with `perilat build`, or use `perilat run`");
    return false;
  }
  if (law->kind == PL_STATE && same) return true;
  if (law->kind == PL_STATE) {
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "kind"),
                "this solver was built for particles that stand on %s",
                list ? "a lattice" : "no lattice");
    diag_hint(d, "build another one with `perilat build`, or use `perilat run`");
    return false;
  }
  diag_report(
      d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "kind"),
      "as a law of bonds `%s` runs on a hexagonal lattice, not on particles that stand on none",
      law->name);
  diag_hint(d, "compiled for these it does: use `perilat run`, or build a solver for them");
  return false;
}

bool law_fits_lattice(const pl_law *law, const deck *k, const rows *lattice, diagnostics *d) {
  const deck_lattice *l = &k->lattices[0];
  const bool same = law->dimensions == lattice->dimensions;
  if (same && (law->kind == PL_STATE || lattice->list)) return topology_serves(law, k, lattice, d);
  if (same && bravais_is_hexagon(l)) return true;
  if (law->dimensions != lattice->dimensions) {
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "kind"),
                "the law `%s` is of %s, the lattice is in %s", law->name,
                law->dimensions == 2 ? "the plane" : "space",
                law->dimensions == 2 ? "space" : "the plane");
    return false;
  }
  const bool hexagonal = strcmp(l->kind, "hexagonal") == 0;
  const char *key = !hexagonal ? "kind" : l->horizon > 0 ? "horizon" : "shells";
  diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, key),
              "`%s` is a law of bonds: it runs on a hexagonal lattice of nearest neighbours",
              law->name);
  diag_hint(d, "compiled for this one it runs, too: use `perilat run`, or build a solver for it");
  return false;
}

/* --- the result ------------------------------------------------------------------------------- */

/* In a result stand side by side: the times, fields of particles, a folder for those of bonds. */
static bool is_named_once(const deck *k, const frame_field *f, int count, int field) {
  const char *name = f[field].name;
  bool once = strcmp(name, "time") != 0;
  for (int n = 0; n < count; n++)
    if (n != field && strcmp(f[n].on_bonds ? k->lattices[0].name : f[n].name, name) == 0)
      once = false;
  return once || f[field].on_bonds;
}

bool law_fits_result(const pl_law *law, const deck *k, const frame_field *fields, int count,
                     diagnostics *d) {
  const int errors = d->errors;
  for (int n = 0; n < count; n++) {
    const char *name = fields[n].name;
    if (strcmp(fields[n].kind, "other") == 0 || is_named_once(k, fields, count, n)) continue;
    diag_report(d, DIAG_RESERVED_NAME, law_fits_where(k),
                "`%s` of the law `%s` cannot be stored: a result has another `%s` there", name,
                law->name, name);
    diag_hint(d, "give it another name in the law, or leave it out of `fields` in &output");
  }
  return d->errors == errors;
}
