#include "generator/command/info_law.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "dsl/semantics/law_reads.h"
#include "generator/facts/law_facts.h"
#include "generator/facts/law_facts_json.h"
#include "generator/facts/law_facts_text.h"
#include "generator/facts/law_judged.h"
#include "generator/interpreter/interpreted.h"
#include "generator/kernel/document.h"
#include "generator/kernel/material_law.h"
#include "generator/kernel/settings.h"
#include "generator/plan/plan.h"
#include "generator/run/law_verdict.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/stability.h"
#include "runtime/deck/deck_value.h"
#include "runtime/simulation/simulation.h"

static void tell(const law_facts *f, const diagnostics *d) {
  if (f->report) diag_json_add(f->report, d);
  diag_print(d, stderr);
}

static bool read_size(law_facts *f, const char *option, const char *text, const char *in,
                      double *value) {
  double number;
  int file = source_add(&f->sources, option, text, strlen(text));
  const span where = {0, (uint32_t)strlen(text), (uint16_t)file};
  namelist_value v = {.kind = NAMELIST_TEXT, .text = text, .where = where, .text_where = where};
  if (*text && namelist_number(text, strlen(text), &number) == strlen(text) && isfinite(number)) {
    v.kind = NAMELIST_NUMBER;
    v.number = number;
  }
  return deck_real_read(&v, option + 2, in, BOUND_POSITIVE, value, &f->said);
}

/* --- the lattice ------------------------------------------------------------------------------ */

static bool read_number(const char *option, const char *text, double least, double most,
                        double *value) {
  double number;
  if (namelist_number(text, strlen(text), &number) == strlen(text) && number >= least &&
      number <= most) {
    *value = number;
    return true;
  }
  say_error("%s needs a number from %g to %g, not `%s`", option, least, most, text);
  return false;
}

static bool read_family(deck_lattice *l, const info_law_options *o) {
  double shells = l->shells;
  if (o->horizon && o->shells) {
    say_error("--horizon and --shells exclude each other");
    return false;
  }
  if (o->horizon) l->shells = 0;
  if (o->horizon && !read_number("--horizon", o->horizon, 1, 8, &l->horizon)) return false;
  if (o->shells && !read_number("--shells", o->shells, 1, 64, &shells)) return false;
  if (shells != floor(shells)) {
    say_error("--shells needs a whole number, not `%s`", o->shells);
    return false;
  }
  if (o->shells) l->shells = (int)shells;
  return true;
}

static bool choose_lattice(law_facts *f, const info_law_options *o) {
  const model *m = &f->model;
  deck_lattice *d = &f->lattice;
  double thickness = 100e-3, area = 100e-6;
  *d = law_reads(m->law, QUANTITY_AREA)
           ? lattice_default_chain(10e-3, area)
           : lattice_default(law_setting_name(m->law->setting), 10e-3, thickness);
  if (o->lattice) {
    d->kind = o->lattice;
    d->shells = 0;
  }
  const int dimensions = bravais_dimensions(d->kind);
  const bool chain = deck_lattice_is_chain(d);
  if (!dimensions) {
    say_error("there is no lattice `%s`\n  --lattice takes %s", d->kind, LATTICE_KINDS_OF_SITES);
    return false;
  }
  if (!read_family(d, o) ||
      (o->spacing && !read_size(f, "--spacing", o->spacing, "m", &d->spacing)) ||
      (o->thickness && !read_size(f, "--thickness", o->thickness, "m", &thickness)) ||
      (o->area && !read_size(f, "--area", o->area, "m^2", &area)))
    return false;
  if (dimensions == 3 || chain) thickness = 0;
  d->thickness = d->stiffness_thickness = d->mass_thickness = thickness;
  d->area = chain ? area : 0;
  d->setting = law_setting_name(law_setting_in(m->law, dimensions));
  return true;
}

/* --- the law ---------------------------------------------------------------------------------- */

/* What is nowhere has the message of decks. */
static bool find_law(law_facts *f, const char *name, char **path) {
  *path = model_find(name, NULL);
  f->material.model = *path ? *path : name;
  f->material.item.where = (span){0, 0, UINT16_MAX};
  return *path || access(name, F_OK) == 0 ||
         material_law_open(&f->material, NULL, NULL, &f->model, &f->said);
}

/* The law, for the lattice that it is meant for or that is asked for. */
static bool open_law(law_facts *f, const info_law_options *o) {
  char *path;
  const bool opened =
      find_law(f, o->law, &path) && model_open(&f->model, f->material.model, NULL, 0);
  const bool asked =
      opened && choose_lattice(f, o) &&
      settings_read(f->memory, &f->sources, o->settings, o->setting_count, &f->material, &f->said);
  const bool good = asked && material_law_take_options(&f->material, &f->model, &f->said) &&
                    material_law_plan(&f->material, &f->lattice, &f->model, &f->said);
  if (f->model.memory && (asked || !opened)) tell(f, &f->model.said);
  free(path);
  return good;
}

static const deck_assignment *setting_of(const law_facts *f, const char *name) {
  for (int k = 0; k < f->material.assignment_count; k++)
    if (strcasecmp(f->material.assignments[k].name, name) == 0) return &f->material.assignments[k];
  return NULL;
}

/* Values, and which of them are known. False on a setting that the law refuses. */
static bool take_values(law_facts *f) {
  const symbol_list *p = &f->model.law->parameters;
  f->values = arena_alloc(f->memory, ((size_t)p->count + 1) * sizeof *f->values);
  f->given = arena_alloc(f->memory, (size_t)p->count + 1);
  for (int k = 0; k < p->count; k++) {
    const deck_assignment *a = setting_of(f, p->items[k]->name);
    f->given[k] = a || p->items[k]->has_default;
    f->values[k] = a ? a->value : f->given[k] ? p->items[k]->initial : NAN;
    if (!f->given[k] && !f->missing) f->missing = p->items[k]->name;
  }
  if (f->missing) return true;
  return material_parameters(&f->model.values, f->law, f->values, &f->said);
}

/* What single bonds tell; laws of families have none. */
static void imply_bonds(law_facts *f, const rows *w) {
  implied *i = &f->implied;
  for (int c = 0; c < 2; c++) {
    i->strength[c] = implied_strength(f->law, f->values, w, c, &i->strain[c]);
    i->crack[c] = implied_crack_energy(f->law, f->values, w, c);
  }
  implied_bond_curve(f->law, f->values, w, 0, &i->bond);
}

static bool imply(law_facts *f) {
  implied *i = &f->implied;
  rows *w = implied_lattice_like(&f->lattice, material_density(f->law, f->values));
  if (!w) {
    say_error("a particle of this lattice has no neighbours, or more than %d", ROWS_MAX_NEIGHBOURS);
    return false;
  }
  i->neighbours = 2 * w->directions;
  i->has_mass = w->mass > 0;
  i->stiff = implied_elastic(f->law, f->values, w, &i->elastic);
  if (!law_facts_of_families(f)) imply_bonds(f, w);
  i->waves = (implied_waves){{NAN, NAN}, NAN, NAN};
  if (i->has_mass && i->stiff) implied_wave_speeds(f->law, f->values, w, &i->elastic, &i->waves);
  if (i->has_mass) stability_limit(f->law, f->values, NULL, w, &i->step);
  rows_free(w);
  return true;
}

/* --- all of it -------------------------------------------------------------------------------- */

static bool asks_for_lattice(const info_law_options *o) {
  return o->lattice || o->horizon || o->shells || o->spacing || o->thickness || o->area;
}

/* What `perilat check` says; where values or a lattice are asked for, and no value is missing, the
   verdict of a deck with these. */
static bool obeys(law_facts *f, const info_law_options *o) {
  diagnostics found;
  diag_begin(&found, &f->model.sources);
  const bool of_deck = !f->missing && (f->model.values.assignment_count > 0 || asks_for_lattice(o));
  const bool good = of_deck ? run_law_obeys(&f->model, &f->lattice, f->values,
                                            f->material.item.where, &found, &f->said)
                            : law_obeys(f->model.law, NULL, &found, NULL);
  tell(f, &found);
  diag_clear(&found);
  return good;
}

static bool learn(law_facts *f, const info_law_options *o) {
  if (!open_law(f, o)) return false;
  f->law = plan_interpreted(f->model.plan);
  return take_values(f) && (!law_facts_has_implied(f) || imply(f));
}

int info_law(const info_law_options *o) {
  law_facts f = {.memory = arena_new(), .report = o->report};
  diag_begin(&f.said, &f.sources);
  const bool known = learn(&f, o), good = known && obeys(&f, o);
  tell(&f, &f.said);
  if (o->report) diag_json_end(o->report, good);
  if (known && o->report)
    law_facts_put(o->report->document, &f);
  else if (known)
    law_facts_print(&f);
  if (f.law) plan_interpreted_free(f.law);
  if (f.model.memory) model_close(&f.model);
  diag_clear(&f.said);
  source_clear(&f.sources);
  arena_free(f.memory);
  return good ? 0 : 1;
}
