#include "generator/command/info_law.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "dsl/semantics/law_limits.h"
#include "generator/check/physics.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/kernel/settings.h"
#include "generator/plan/passes.h"
#include "generator/run/run.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/stability.h"
#include "runtime/deck/deck_value.h"
#include "runtime/simulation/simulation.h"

static const char *const law_kinds[] = {"central bond", "micropolar bond", "state"};

/* --- what is known of the law ----------------------------------------------------------------- */

typedef struct implied {
  implied_elasticity elastic;
  bool stiff;
  double strength[2], strain[2]; /* under uniform uniaxial strain along x, y */
  implied_bond bond;
  double crack[2]; /* N/m; opening along x, y */
  implied_waves waves;
  step_limit step;
  bool has_mass;
  int neighbours;
} implied;

typedef struct facts {
  arena *memory;
  source_set sources;
  diagnostics said;
  diag_json *report; /* or NULL */
  model model;
  deck_material material;
  pl_law *law;         /* interpreted */
  double *values;      /* [parameters] */
  bool *given;         /* a default or a setting */
  const char *missing; /* a parameter without a value, or NULL */
  deck_lattice lattice;
  implied implied;
} facts;

static void tell(const facts *f, const diagnostics *d) {
  if (f->report) diag_json_add(f->report, d);
  diag_print(d, stderr);
}

static bool read_length(facts *f, const char *option, const char *text, double *value) {
  double number;
  int file = source_add(&f->sources, option, text, strlen(text));
  const span where = {0, (uint32_t)strlen(text), (uint16_t)file};
  namelist_value v = {.kind = NAMELIST_TEXT, .text = text, .where = where, .text_where = where};
  if (*text && namelist_number(text, strlen(text), &number) == strlen(text) && isfinite(number)) {
    v.kind = NAMELIST_NUMBER;
    v.number = number;
  }
  return deck_real_read(&v, option + 2, "m", BOUND_POSITIVE, value, &f->said);
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

/* The setting of such a lattice that the law is meant for, plane stress before plane strain. */
static law_setting meant_setting(const model *m, int dimensions) {
  char meant[96];
  if (dimensions == 3) return SETTING_SPACE;
  for (int k = SETTING_PLANE_STRESS; k <= SETTING_PLANE_STRAIN; k++)
    if (model_suits(m, law_setting_name((law_setting)k), meant, sizeof meant))
      return (law_setting)k;
  return SETTING_PLANE_STRESS;
}

static bool choose_lattice(facts *f, const info_law_options *o, const model *m) {
  deck_lattice *d = &f->lattice;
  const bool space = m->law->setting == SETTING_SPACE;
  double spacing = 10e-3, thickness = 100e-3;
  *d = (deck_lattice){.name = "lattice",
                      .kind = o->lattice ? o->lattice
                              : space    ? "fcc"
                                         : "hexagonal"};
  if (!o->lattice && space) d->shells = 2;
  const int dimensions = bravais_dimensions(d->kind);
  if (!dimensions) {
    say_error("there is no lattice `%s`\n  --lattice takes hexagonal, square, cubic or "
              "fcc",
              d->kind);
    return false;
  }
  if (!read_family(d, o) || (o->spacing && !read_length(f, "--spacing", o->spacing, &spacing)) ||
      (o->thickness && !read_length(f, "--thickness", o->thickness, &thickness)))
    return false;
  d->spacing = spacing;
  d->thickness = d->stiffness_thickness = d->mass_thickness = dimensions == 2 ? thickness : 0;
  d->setting = law_setting_name(meant_setting(m, dimensions));
  return true;
}

/* --- the law ---------------------------------------------------------------------------------- */

/* Looks at the law for the lattice that it is meant for. */
static bool open_lattice(facts *f, const info_law_options *o, const char *path) {
  model m;
  const bool opened = model_open(&m, path, NULL, 0);
  if (!opened) tell(f, &m.said);
  const bool good = opened && choose_lattice(f, o, &m);
  model_close(&m);
  return good;
}

static bool open_law(facts *f, const info_law_options *o) {
  char *path = model_find(o->law, NULL);
  f->material.model = path ? path : o->law;
  f->material.item.where = (span){0, 0, UINT16_MAX};
  const bool there =
      path || access(o->law, F_OK) == 0; /* what is nowhere has a message of its own */
  bool good = (!there || open_lattice(f, o, f->material.model)) &&
              settings_read(f->memory, &f->sources, o->settings, o->setting_count, &f->material,
                            &f->said) &&
              run_open_material(&f->material, &f->lattice, NULL, &f->model, &f->said);
  if (f->model.memory) tell(f, &f->model.said);
  free(path);
  return good;
}

static const deck_assignment *setting_of(const facts *f, const char *name) {
  for (int k = 0; k < f->material.assignment_count; k++)
    if (strcasecmp(f->material.assignments[k].name, name) == 0) return &f->material.assignments[k];
  return NULL;
}

/* Values, and which of them are known. False on a setting that the law refuses. */
static bool take_values(facts *f) {
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
  return material_parameters(&f->material, f->law, f->values, &f->said);
}

/* What single bonds tell; laws of families have none. */
static void imply_bonds(facts *f, const rows *w) {
  implied *i = &f->implied;
  for (int c = 0; c < 2; c++) {
    i->strength[c] = implied_strength(f->law, f->values, w, c, &i->strain[c]);
    i->crack[c] = implied_crack_energy(f->law, f->values, w, c);
  }
  implied_bond_curve(f->law, f->values, w, 0, &i->bond);
}

static bool is_of_families(const facts *f) {
  return f->law->kind == PL_STATE;
}

static bool imply(facts *f) {
  implied *i = &f->implied;
  if (f->law->kind == PL_MICROPOLAR && !bravais_is_hexagon(&f->lattice)) {
    say_error("a micropolar law runs on the hexagonal lattice of nearest neighbours only");
    return false;
  }
  rows *w = implied_lattice_like(&f->lattice, material_density(f->law, f->values));
  if (!w) {
    say_error("a particle of this lattice has no neighbours, or more than %d", ROWS_MAX_NEIGHBOURS);
    return false;
  }
  i->neighbours = 2 * w->directions;
  i->has_mass = w->mass > 0;
  i->stiff = implied_elastic(f->law, f->values, w, &i->elastic);
  if (!is_of_families(f)) imply_bonds(f, w);
  i->waves = (implied_waves){{NAN, NAN}, NAN, NAN};
  if (i->has_mass && i->stiff) implied_wave_speeds(f->law, f->values, w, &i->elastic, &i->waves);
  if (i->has_mass) stability_limit(f->law, f->values, NULL, w, &i->step);
  rows_free(w);
  return true;
}

/* Arrays that a segment over neighbours or bonds reads and writes, without what a pass keeps for itself. */
static long arrays_of_segment(const ir *g, const segment *a) {
  unsigned char *needed = must_calloc((size_t)ir_count(g) + 1, 1);
  long count = 1; /* the bits of the bonds */
  for (int k = 0; k < a->root_count; k++) {
    ir_mark(g, &a->roots[k].node, 1, needed);
    count += a->roots[k].target == TO_NEIGHBOUR_FIELD || a->roots[k].target == TO_SHARED;
  }
  for (ir_node n = 0; n < ir_count(g); n++) {
    if (!needed[n] || ir_operation(g, n) != IR_INPUT || ir_place(g, n) <= ON_BODY) continue;
    const ir_source from = ir_input_source(g, n);
    count += from != IR_FROM_SLOT && from != IR_FROM_PLANE;
  }
  free(needed);
  return count;
}

static long bytes_of_families(const kernel_plan *p) {
  long count = 0;
  for (int k = 0; k < p->step.pass_count; k++)
    for (int s = 0; s < p->step.passes[k].segment_count; s++)
      if (p->step.passes[k].segments[s].kind != OVER_PARTICLES)
        count += arrays_of_segment(p->graph, &p->step.passes[k].segments[s]) *
                 (p->step.passes[k].segments[s].kind == OVER_BONDS ? 1 : 2);
  return 8 * count / 2; /* of the two ends of a bond, one */
}

/* Bytes that one bond reads and writes in a step, most of them from a cache: neighbouring bonds
 * share their ends. */
static long bytes_per_bond(const kernel_plan *p) {
  if (p->kind == PL_STATE) return bytes_of_families(p);
  const pass *a = &p->passes[PASS_ROWS];
  unsigned char *needed = must_calloc((size_t)ir_count(p->graph) + 1, 1);
  long count = a->root_count + 1; /* the flags */
  for (int k = 0; k < a->root_count; k++) {
    ir_mark(p->graph, &a->roots[k].node, 1, needed);
    count += a->roots[k].target == TO_FIELD; /* read, too, to keep it where a bond is absent */
  }
  for (ir_node n = 0; n < ir_count(p->graph); n++)
    count += needed[n] && ir_operation(p->graph, n) == IR_INPUT &&
             ir_place(p->graph, n) > ON_BODY && ir_input_source(p->graph, n) == IR_FROM_ENDS;
  free(needed);
  return 8 * count;
}

/* --- as text ---------------------------------------------------------------------------------- */

static void print_parameter(const facts *f, int p) {
  const law *l = f->model.law;
  const symbol *s = l->parameters.items[p];
  char unit_text[64], interval[128] = "", value[32] = "(required)";
  dim_unit(s->dim, unit_text, sizeof unit_text);
  if (s->declared->in.given) law_parameter_bounds(l, p, f->values, interval, sizeof interval);
  if (f->given[p]) snprintf(value, sizeof value, "%.6g", f->values[p]);
  printf("  %-12s %-12s %-10s %-18s %s\n", s->name, value, unit_text, interval,
         s->doc ? s->doc : "");
}

/* Further lines of a description stand below its first one. */
static void print_description(const char *text) {
  for (; *text; text++) {
    putchar(*text);
    if (*text == '\n') printf("%*s", 38, "");
  }
  putchar('\n');
}

static void print_symbols(const char *title, const symbol_list *list) {
  if (list->count)
    printf("%s:\n  %-12s %-10s %-12s %s\n", title, "name", "unit", "lives", "meaning");
  for (int k = 0; k < list->count; k++) {
    const symbol *s = list->items[k];
    char unit_text[64];
    dim_unit(s->dim, unit_text, sizeof unit_text);
    printf("  %-12s %-10s on %-9s ", s->name, unit_text, placement_name(s->place));
    print_description(s->doc ? s->doc : "");
  }
}

static void print_options(const law *l) {
  for (int k = 0; k < l->options.count; k++) {
    const stmt *declared = l->options.items[k]->declared;
    printf("option %s =", declared->name);
    for (int w = 0; w < declared->word_count; w++)
      printf("%s %s", w ? " |" : "", declared->words[w]);
    printf("   (now: %s)\n", l->chosen[k]);
  }
}

static int pass_count(const kernel_plan *p) {
  return p->kind == PL_STATE ? p->step.pass_count : 1;
}

static void print_cost(const facts *f) {
  const kernel_plan *p = f->model.plan;
  const int passes = pass_count(p);
  printf(
      "Cost per bond%s and step: %.0f operations, %.0f of them divisions or roots; %ld bytes; %d "
      "pass%s; %d value%s computed once "
      "per lattice\n",
      p->kind == PL_STATE ? " of either side" : "", p->flops_per_bond + p->divisions_per_bond,
      p->divisions_per_bond, bytes_per_bond(p), passes, passes == 1 ? "" : "es", p->uniform_count,
      p->uniform_count == 1 ? "" : "s");
}

static void print_strength(const implied *i) {
  for (int c = 0; c < 2; c++) {
    printf("  peak stress along %c   ", "xy"[c]);
    if (isfinite(i->strength[c]))
      printf("%.6g MPa at a uniform strain of %.6g, sides held\n", 1e-6 * i->strength[c],
             i->strain[c]);
    else
      printf("none: it only grows\n");
  }
}

static void print_bond(const implied *i) {
  const implied_bond *b = &i->bond;
  if (isfinite(b->peak_force))
    printf("  one bond, drawn out   largest force %.6g N at a stretch of %.6g\n", b->peak_force,
           b->stretch_at_peak);
  if (!b->separates) {
    printf("  work of fracture      none: a bond never separates\n");
    return;
  }
  printf("                        costs %.6g J: %.6g N/m on its share of a crack, sqrt(3)/2*s*t\n",
         b->energy, b->row_energy);
  printf("  work of fracture      %.6g N/m of a straight crack across the rows (opens along x), "
         "%.6g N/m along "
         "them (along y),\n                        by all bonds that it cuts\n",
         i->crack[0], i->crack[1]);
}

static void print_waves(const implied *i, bool rotations) {
  if (!i->stiff) {
    printf("  wave speeds           none: the virgin lattice has no stiffness\n");
    return;
  }
  printf("  wave speeds           longitudinal %.6g m/s", i->waves.longitudinal[0]);
  if (fabs(i->waves.longitudinal[1] - i->waves.longitudinal[0]) > 1e-6 * i->waves.longitudinal[0])
    printf(" along x, %.6g m/s along y", i->waves.longitudinal[1]);
  printf(", transverse %.6g m/s", i->waves.transverse);
  if (rotations) printf("; rotation waves above %.6g rad/s", i->waves.rotation_cutoff);
  putchar('\n');
}

static void print_dynamics(const implied *i, bool rotations) {
  if (!i->has_mass) {
    printf("  waves, stable step    unknown: the law has no `rho`\n");
    return;
  }
  print_waves(i, rotations);
  if (i->step.least < STABILITY_LEAST) {
    printf("  stable step           none: the virgin body is unstable at rest\n");
    return;
  }
  printf("  stable step           %.6g us (%s mode%s rules, %.6g rad/s", 1e6 * i->step.limit,
         i->step.mode, i->step.at_surface ? " at the surface of a small block" : "",
         i->step.omega_max);
  if (i->step.damping_ratio > 0) printf(", damping ratio %.3g", i->step.damping_ratio);
  printf(")\n");
}

/* "plane stress" of plane_stress. */
static void print_setting(const char *name) {
  for (; *name; name++)
    putchar(*name == '_' ? ' ' : *name);
}

static void print_lattice(const facts *f) {
  const deck_lattice *d = &f->lattice;
  printf("On a%s %s lattice", strcmp(d->kind, "fcc") == 0 ? "n" : "", d->kind);
  if (f->implied.neighbours != 6 || strcmp(d->kind, "hexagonal") != 0)
    printf(" of %d neighbours", f->implied.neighbours);
  printf(", s = %.6g mm, ", 1e3 * d->spacing);
  if (d->thickness > 0) printf("t = %.6g mm, ", 1e3 * d->thickness);
  print_setting(d->setting);
  puts(":");
}

static void print_implied(const facts *f) {
  const implied *i = &f->implied;
  print_lattice(f);
  if (i->stiff)
    printf("  elastic constants     E = %.6g GPa along x, %.6g GPa along y; nu = %.6g, %.6g; G = "
           "%.6g GPa\n",
           1e-9 * i->elastic.E[0], 1e-9 * i->elastic.E[1], i->elastic.nu[0], i->elastic.nu[1],
           1e-9 * i->elastic.G);
  else
    printf("  elastic constants     none: the virgin lattice has no stiffness\n");
  if (!is_of_families(f)) {
    print_strength(i);
    print_bond(i);
  }
  print_dynamics(i, f->law->kind == PL_MICROPOLAR);
}

static void print_text(const facts *f) {
  const law *l = f->model.law;
  printf("%s (law %s)\n", l->tree->name, law_kinds[l->tree->law]);
  if (l->tree->doc) printf("%s\n", l->tree->doc);
  if (l->parameters.count)
    printf("Parameters:\n  %-12s %-12s %-10s %-18s %s\n", "name", "value", "unit", "bounds",
           "meaning");
  for (int p = 0; p < l->parameters.count; p++)
    print_parameter(f, p);
  print_options(l);
  print_symbols("State and damage", &l->fields);
  print_symbols("Outputs", &l->outputs);
  print_cost(f);
  if (l->nonconservative) printf("Not conservative: %s\n", l->nonconservative);
  if (f->missing)
    printf("What it implies depends on `%s`, which has no default: give --set %s=...\n", f->missing,
           f->missing);
  else
    print_implied(f);
}

/* --- as JSON ---------------------------------------------------------------------------------- */

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
static void put_bounds(json *j, const facts *f, int p) {
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

static void put_parameters(json *j, const facts *f) {
  const symbol_list *list = &f->model.law->parameters;
  json_put_array(j, "parameters");
  for (int p = 0; p < list->count; p++) {
    open_symbol(j, list->items[p]);
    json_put_number(j, "value", f->given[p] ? f->values[p] : NAN);
    put_bounds(j, f, p);
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

static void put_cost(json *j, const facts *f) {
  const kernel_plan *p = f->model.plan;
  json_put_object(j, "cost");
  json_put_number(j, "operations", p->flops_per_bond + p->divisions_per_bond);
  json_put_number(j, "divisions", p->divisions_per_bond);
  json_put_number(j, "bytes", (double)bytes_per_bond(p));
  json_put_number(j, "passes", pass_count(p));
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
static void put_implied(json *j, const facts *f) {
  const implied *i = &f->implied;
  json_put_object(j, "implied");
  json_put_text(j, "lattice", f->lattice.kind);
  json_put_number(j, "neighbours", i->neighbours);
  json_put_text(j, "setting", f->lattice.setting);
  json_put_number(j, "spacing", f->lattice.spacing);
  json_put_number(j, "thickness", f->lattice.thickness > 0 ? f->lattice.thickness : NAN);
  if (i->stiff) {
    put_pair(j, "E", i->elastic.E);
    put_pair(j, "nu", i->elastic.nu);
    json_put_number(j, "G", i->elastic.G);
  }
  if (!is_of_families(f)) put_bonds(j, i);
  if (i->has_mass) {
    put_pair(j, "longitudinal_speed", i->waves.longitudinal);
    json_put_number(j, "transverse_speed", i->waves.transverse);
    json_put_number(j, "rotation_cutoff",
                    f->law->kind == PL_MICROPOLAR ? i->waves.rotation_cutoff : NAN);
    json_put_number(j, "stable_step", i->step.least < STABILITY_LEAST ? NAN : i->step.limit);
    json_put_bool(j, "at_surface", i->step.at_surface);
    json_put_text(j, "ruling_mode", i->step.mode);
    json_put_number(j, "omega_max", i->step.omega_max);
    json_put_number(j, "damping_ratio", i->step.damping_ratio);
  }
  json_object_end(j);
}

static void put_law(json *j, const facts *f) {
  const law *l = f->model.law;
  json_put_text(j, "model", l->tree->name);
  json_put_text(j, "law", law_kinds[l->tree->law]);
  json_put_text(j, "description", l->tree->doc);
  put_parameters(j, f);
  put_options(j, l);
  put_symbols(j, "fields", &l->fields);
  put_symbols(j, "outputs", &l->outputs);
  json_put_text(j, "nonconservative", l->nonconservative);
  put_cost(j, f);
  if (!f->missing) put_implied(j, f);
}

/* --- all of it -------------------------------------------------------------------------------- */

/* The verdict of a deck with these values on this lattice; where a value is missing, that of
   `perilat check`. */
static bool obeys(facts *f) {
  diagnostics found;
  diag_begin(&found, &f->model.sources);
  const bool good = f->missing ? physics_check(f->model.law, NULL, &found, NULL)
                               : run_law_obeys(&f->model, &f->lattice, f->values,
                                               f->material.item.where, &found, &f->said);
  tell(f, &found);
  diag_clear(&found);
  return good;
}

static bool learn(facts *f, const info_law_options *o) {
  if (!open_law(f, o)) return false;
  f->law = plan_interpreted(f->model.plan, "");
  return take_values(f) && (f->missing || imply(f));
}

int info_law(const info_law_options *o) {
  facts f = {.memory = arena_new(), .report = o->report};
  diag_begin(&f.said, &f.sources);
  const bool known = learn(&f, o), good = known && obeys(&f);
  tell(&f, &f.said);
  if (o->report) diag_json_end(o->report, good);
  if (known && o->report)
    put_law(o->report->document, &f);
  else if (known)
    print_text(&f);
  if (f.law) plan_interpreted_free(f.law);
  if (f.model.memory) model_close(&f.model);
  diag_clear(&f.said);
  source_clear(&f.sources);
  arena_free(f.memory);
  return good ? 0 : 1;
}
