#include "generator/facts/law_facts_json.h"

#include <math.h>

#include "dsl/semantics/law_limits.h"
#include "generator/facts/point_facts.h"

static void put_pair(json *j, const char *name, const double pair[2]) {
  json_put_array(j, name);
  json_number(j, pair[0]);
  json_number(j, pair[1]);
  json_array_end(j);
}

static void open_symbol(json *j, const symbol *s) {
  char unit_text[64];
  dim_unit(s->dim, unit_text, sizeof unit_text);
  json_object(j);
  json_put_text(j, "name", s->name);
  json_put_text(j, "unit", unit_text);
  json_put_text(j, "description", s->doc);
}

/* SI; null for what is without end, or depends on a value that is not known. */
static void put_bounds(json *j, const law_facts *f, int p) {
  json_key(j, "bounds");
  if (!f->model.law->parameters.items[p]->declared->in.given) {
    json_null(j);
    return;
  }
  const law_limits limits = law_parameter_limits(f->model.law, p, f->values);
  json_object(j);
  json_put_number(j, "lower", limits.lower);
  json_put_bool(j, "lower_open", limits.lower_open);
  json_put_number(j, "upper", limits.upper);
  json_put_bool(j, "upper_open", limits.upper_open);
  json_object_end(j);
}

/* The formula that the default follows by; null where it is a number or there is none. */
static void put_default(json *j, const law *l, const symbol *s) {
  char text[400];
  const span w = s->follows ? s->declared->value->where : (span){0, 0, 0};
  snprintf(text, sizeof text, "%.*s", (int)(w.end - w.begin),
           s->follows ? l->sources->items[w.file].text + w.begin : "");
  json_put_text(j, "default", s->follows ? text : NULL);
}

static void put_parameters(json *j, const law_facts *f) {
  const symbol_list *list = &f->model.law->parameters;
  json_put_array(j, "parameters");
  for (int p = 0; p < list->count; p++) {
    open_symbol(j, list->items[p]);
    json_put_number(j, "value", f->given[p] ? f->values[p] : NAN);
    put_bounds(j, f, p);
    json_put_bool(j, "field", symbol_is_field(list->items[p]));
    put_default(j, f->model.law, list->items[p]);
    json_object_end(j);
  }
  json_array_end(j);
}

static void put_symbols(json *j, const char *name, const symbol_list *list) {
  json_put_array(j, name);
  for (int k = 0; k < list->count; k++) {
    open_symbol(j, list->items[k]);
    json_put_text(j, "on", placement_name(list->items[k]->place));
    json_object_end(j);
  }
  json_array_end(j);
}

static void put_options(json *j, const law *l) {
  json_put_array(j, "options");
  for (int k = 0; k < l->options.count; k++) {
    const stmt *declared = l->options.items[k]->declared;
    json_object(j);
    json_put_text(j, "name", declared->name);
    json_put_array(j, "choices");
    for (int w = 0; w < declared->word_count; w++)
      json_text(j, declared->words[w]);
    json_array_end(j);
    json_put_text(j, "chosen", l->chosen[k]);
    json_object_end(j);
  }
  json_array_end(j);
}

static void put_cost(json *j, const law_facts *f) {
  const kernel_plan *p = f->model.plan;
  json_put_object(j, "cost");
  json_put_number(j, "operations", p->flops_per_bond + p->divisions_per_bond);
  json_put_number(j, "divisions", p->divisions_per_bond);
  json_put_number(j, "bytes", (double)law_facts_bytes(p));
  json_put_number(j, "passes", law_facts_passes(p));
  json_put_number(j, "computed_once", p->uniform_count);
  json_object_end(j);
}

static void put_bonds(json *j, const implied *i) {
  put_pair(j, "peak_stress", i->strength);
  put_pair(j, "strain_at_peak", i->strain);
  json_put_number(j, "bond_peak_force", i->bond.peak_force);
  json_put_number(j, "bond_stretch_at_peak", i->bond.stretch_at_peak);
  json_put_bool(j, "separates", i->bond.separates);
  json_put_number(j, "bond_work_of_fracture", i->bond.energy);
  json_put_number(j, "work_of_fracture", i->bond.row_energy);
  put_pair(j, "crack_energy", i->crack);
}

/* SI units throughout; null for what is infinite, unknown or does not exist. */
static void put_implied(json *j, const law_facts *f) {
  const implied *i = &f->implied;
  json_put_object(j, "implied");
  json_put_text(j, "lattice", f->lattice.kind);
  json_put_number(j, "neighbours", i->neighbours);
  json_put_text(j, "setting", f->lattice.setting);
  json_put_number(j, "spacing", f->lattice.spacing);
  json_put_number(j, "thickness", f->lattice.thickness > 0 ? f->lattice.thickness : NAN);
  json_put_number(j, "area", f->lattice.area > 0 ? f->lattice.area : NAN);
  if (i->stiff) {
    put_pair(j, "E", i->elastic.E);
    put_pair(j, "nu", i->elastic.nu);
    json_put_number(j, "G", i->elastic.G);
  }
  if (!law_facts_of_families(f)) put_bonds(j, i);
  if (i->has_mass) {
    put_pair(j, "longitudinal_speed", i->waves.longitudinal);
    json_put_number(j, "transverse_speed", i->waves.transverse);
    json_put_number(j, "rotation_cutoff",
                    f->law->dof > f->law->dimensions ? i->waves.rotation_cutoff : NAN);
    json_put_number(j, "stable_step", stability_at_rest(&i->step) ? i->step.limit : NAN);
    json_put_bool(j, "at_surface", i->step.at_surface);
    json_put_text(j, "ruling_mode", i->step.mode);
    json_put_number(j, "omega_max", i->step.omega_max);
    json_put_number(j, "damping_ratio", i->step.damping_ratio);
  }
  json_object_end(j);
}

/* null for what is not isotropic, or has no mass */
static void put_points(json *j, const law_facts *f) {
  point_facts found[POINT_SETTINGS];
  const int count = point_facts_of(f->model.law, f->values, found);
  json_put_array(j, "points");
  for (int k = 0; k < count; k++) {
    const point_facts *p = &found[k];
    const bool waves = p->isotropic && p->has_mass;
    json_object(j);
    json_put_text(j, "setting", law_setting_name(p->setting));
    json_put_bool(j, "linear", p->linear);
    json_put_bool(j, "isotropic", p->isotropic);
    json_put_number(j, "E", p->isotropic ? p->E : NAN);
    json_put_number(j, "nu", p->isotropic ? p->nu : NAN);
    json_put_number(j, "dilatational_speed", waves ? p->c_d : NAN);
    json_put_number(j, "shear_speed", waves ? p->c_s : NAN);
    json_put_number(j, "rayleigh_speed", waves ? p->c_R : NAN);
    json_object_end(j);
  }
  json_array_end(j);
}

static void put_accepted(json *j, const law *l) {
  json_put_array(j, "accepted");
  const char *check, *why;
  for (int k = 0; law_says(l, k, &check, &why); k++) {
    json_object(j);
    json_put_text(j, "check", check);
    json_put_text(j, "why", why);
    json_object_end(j);
  }
  json_array_end(j);
}

void law_facts_put(json *j, const law_facts *f) {
  const law *l = f->model.law;
  json_put_text(j, "model", l->tree->name);
  json_put_text(j, "law", law_kind_text(l));
  json_put_text(j, "description", l->tree->doc);
  put_parameters(j, f);
  put_options(j, l);
  put_symbols(j, "fields", &l->fields);
  put_symbols(j, "outputs", &l->outputs);
  json_put_text(j, "nonconservative", l->nonconservative);
  put_accepted(j, l);
  put_cost(j, f);
  if (law_facts_has_implied(f)) put_implied(j, f);
  if (l->tree->law == LAW_CONTINUUM && !f->missing) put_points(j, f);
}
