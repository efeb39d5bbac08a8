#include "generator/facts/law_facts_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/semantics/law_limits.h"
#include "generator/facts/point_facts.h"

/* The formula as it is written. */
static void print_default(const law *l, const symbol *s) {
  const span w = s->declared->value->where;
  printf("%sby default %.*s", s->doc ? "; " : "", (int)(w.end - w.begin),
         l->sources->items[w.file].text + w.begin);
}

static void print_parameter(const law_facts *f, int p) {
  const law *l = f->model.law;
  const symbol *s = l->parameters.items[p];
  char unit_text[64], interval[128] = "", value[32] = "(required)";
  dim_unit(s->dim, unit_text, sizeof unit_text);
  if (s->declared->in.given) law_parameter_bounds(l, p, f->values, interval, sizeof interval);
  if (f->given[p]) snprintf(value, sizeof value, "%.6g", f->values[p]);
  printf("  %-12s %-12s %-10s %-18s %s", s->name, value, unit_text, interval, s->doc ? s->doc : "");
  if (s->follows) print_default(l, s);
  printf("\n");
}

/* Parameters, or the fields that a deck gives in place and time. */
static void print_parameters(const law_facts *f, const char *title, bool fields) {
  const symbol_list *list = &f->model.law->parameters;
  bool begun = false;
  for (int p = 0; p < list->count; p++) {
    if (symbol_is_field(list->items[p]) != fields) continue;
    if (!begun)
      printf("%s:\n  %-12s %-12s %-10s %-18s %s\n", title, "name", "value", "unit", "bounds",
             "meaning");
    begun = true;
    print_parameter(f, p);
  }
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

/* "plane stress" of plane_stress. */
static void print_setting(const char *name) {
  for (; *name; name++)
    putchar(*name == '_' ? ' ' : *name);
}

static void print_cost(const law_facts *f) {
  const kernel_plan *p = f->model.plan;
  const int passes = law_facts_passes(p);
  const bool points = p->form == FORM_POINTS, tips = p->form == FORM_TIPS;
  const char *whose = points                   ? "point and step"
                      : tips                   ? "look at a tip"
                      : p->form == FORM_STRIPS ? "bond and step"
                                               : "bond of either side and step";
  printf("Cost per %s: %.0f operations, %.0f of them divisions or roots; %ld bytes; ", whose,
         p->flops_per_bond + p->divisions_per_bond, p->divisions_per_bond, law_facts_bytes(p));
  if (!points && !tips) printf("%d pass%s; ", passes, passes == 1 ? "" : "es");
  printf("%d value%s computed once per %s\n", p->uniform_count, p->uniform_count == 1 ? "" : "s",
         points ? "mesh"
         : tips ? "crack"
                : "lattice");
}

static void print_point(const point_facts *f) {
  fputs("At rest, in ", stdout);
  print_setting(law_setting_name(f->setting));
  if (!f->isotropic) {
    printf(": depends on the axes; %slinear\n", f->linear ? "" : "not ");
    return;
  }
  printf(": E = %.6g GPa, nu = %.6g; ", 1e-9 * f->E, f->nu);
  if (f->has_mass)
    printf("waves: dilatational %.6g m/s, shear %.6g m/s, Rayleigh %.6g m/s; ", f->c_d, f->c_s,
           f->c_R);
  printf("%slinear\n", f->linear ? "" : "not ");
}

static void print_points(const law_facts *f) {
  point_facts found[POINT_SETTINGS];
  const int count = point_facts_of(f->model.law, f->values, found);
  for (int k = 0; k < count; k++)
    print_point(&found[k]);
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
  printf("                        costs %.6g J: %.6g N/m of a crack across it that cuts no other "
         "bonds, one in sqrt(3)/2*s*t\n",
         b->energy, b->row_energy);
  printf("  work of fracture      %.6g N/m of a straight crack across the rows (opens along x), "
         "%.6g N/m along "
         "them (along y),\n                        by all bonds that it cuts: two in "
         "sqrt(3)/2*s*t across the rows, two in s*t along them\n",
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
  if (isfinite(i->waves.transverse)) printf(", transverse %.6g m/s", i->waves.transverse);
  if (rotations) printf("; rotation waves above %.6g rad/s", i->waves.rotation_cutoff);
  putchar('\n');
}

static void print_dynamics(const implied *i, bool rotations) {
  if (!i->has_mass) {
    printf("  waves, stable step    unknown: the law has no `rho`\n");
    return;
  }
  print_waves(i, rotations);
  if (!stability_at_rest(&i->step)) {
    printf("  stable step           none: the virgin body is unstable at rest\n");
    return;
  }
  printf("  stable step           %.6g us (%s mode%s rules, %.6g rad/s", 1e6 * i->step.limit,
         i->step.mode, i->step.at_surface ? " at the surface of a small block" : "",
         i->step.omega_max);
  if (i->step.damping_ratio > 0) printf(", damping ratio %.3g", i->step.damping_ratio);
  printf(")\n");
}

static void print_lattice(const law_facts *f) {
  const deck_lattice *d = &f->lattice;
  printf("On a%s %s%s", strcmp(d->kind, "fcc") == 0 ? "n" : "", d->kind,
         deck_lattice_is_chain(d) ? "" : " lattice");
  if (!bravais_is_hexagon(d)) printf(" of %d neighbours", f->implied.neighbours);
  printf(", s = %.6g mm, ", 1e3 * d->spacing);
  if (deck_lattice_is_chain(d)) {
    printf("A = %.6g mm^2:\n", 1e6 * d->area);
    return;
  }
  if (d->thickness > 0) printf("t = %.6g mm, ", 1e3 * d->thickness);
  print_setting(d->setting);
  puts(":");
}

static void print_elastic(const law_facts *f) {
  const implied_elasticity *e = &f->implied.elastic;
  fputs("  elastic constants     ", stdout);
  if (!f->implied.stiff)
    puts("none: the virgin lattice has no stiffness");
  else if (deck_lattice_is_chain(&f->lattice))
    printf("E = %.6g GPa along it, EA = %.6g MN\n", 1e-9 * e->E[0],
           1e-6 * e->E[0] * f->lattice.area);
  else
    printf("E = %.6g GPa along x, %.6g GPa along y; nu = %.6g, %.6g; G = %.6g GPa\n",
           1e-9 * e->E[0], 1e-9 * e->E[1], e->nu[0], e->nu[1], 1e-9 * e->G);
}

static void print_implied(const law_facts *f) {
  const implied *i = &f->implied;
  print_lattice(f);
  print_elastic(f);
  if (!law_facts_of_families(f)) {
    print_strength(i);
    print_bond(i);
  }
  print_dynamics(i, f->law->dof > f->law->dimensions);
}

void law_facts_print(const law_facts *f) {
  const law *l = f->model.law;
  printf("%s (law %s)\n", l->tree->name, law_kind_text(l));
  if (l->tree->doc) printf("%s\n", l->tree->doc);
  print_parameters(f, "Parameters", false);
  print_parameters(f, "Fields in place and time, and what they are without a deck", true);
  print_options(l);
  print_symbols("State and damage", &l->fields);
  print_symbols("Outputs", &l->outputs);
  print_cost(f);
  const char *check, *why;
  for (int k = 0; law_says(l, k, &check, &why); k++)
    printf("Accepted, %s: %s\n", check, why);
  if (f->missing)
    printf("What it implies depends on `%s`, which has no default: give --set %s=...\n", f->missing,
           f->missing);
  else if (law_facts_has_implied(f))
    print_implied(f);
  else if (l->tree->law == LAW_CONTINUUM)
    print_points(f);
}
