#include "generator/report/report_laws.h"

#include <math.h>
#include <string.h>

#include "generator/report/print_quantity.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/uniform_strain.h"
#include "runtime/lattice/parameter_planes.h"

/* Irregular particles have no lattice that implies anything: they are asked. */
static void announce_uniform_strain(const run *r, int interaction) {
  const int lattice = r->deck->interactions[interaction].lattice;
  const rows *w = simulation_rows(r->simulation, lattice);
  const bool plane_strain = strcmp(r->deck->lattices[lattice].setting, "plane_strain") == 0;
  const simulation_law *l = &r->laws[interaction];
  const parameter_planes *f = simulation_planes(r->simulation, interaction);
  uniform_response u;
  if (!uniform_strain_response(l->law, l->parameters, f ? f->value : NULL, w, plane_strain, &u)) {
    printf(": no stiffness\n");
    return;
  }
  print_quantity(": held in a uniform strain E = ", u.E, "Pa");
  printf(
      ", nu = %.4f\n  residuals  force left on a particle %.2g %% of stress times its face "
      "(median), sum of forces %.1g of all; %ld particles whose bonds do not resolve all strains\n",
      u.nu, 100 * u.left_force, u.momentum, u.unresolved);
}

/* Young's modulus as the deck gives it, Pa; NAN where the law has none of that name. */
static double modulus_asked(const simulation_law *l) {
  for (int p = 0; p < l->law->parameter_count; p++) {
    const pl_parameter *q = &l->law->parameters[p];
    if (strcmp(q->name, "E") == 0 && strstr(q->unit, "Pa")) return l->parameters[p];
  }
  return NAN;
}

/* In plane strain a body is stiffer than its E. */
static void announce_modulus(const run *r, int interaction, double implied) {
  const int lattice = r->deck->interactions[interaction].lattice;
  const double difference = 0.02, asked = modulus_asked(&r->laws[interaction]);
  const rows *w = simulation_rows(r->simulation, lattice);
  const bool plane_strain = strcmp(r->deck->lattices[lattice].setting, "plane_strain") == 0;
  print_quantity(rows_are_chain(w) ? ": along this chain E = " : ": on this lattice E = ", implied,
                 "Pa");
  if (plane_strain || !(fabs(implied / asked - 1) > difference)) return;
  print_quantity(" (E = ", asked, "Pa was asked for)");
}

/* Of one of several laws. */
static void announce_part(long bonds, const char *name) {
  printf(" of %ld bond%s as `%s`", bonds, bonds == 1 ? "" : "s", name);
}

/* Also the force of a unit strain. */
static void announce_bar_modulus(const run *r, int interaction) {
  const rows *w = simulation_rows(r->simulation, r->deck->interactions[interaction].lattice);
  const simulation_law *l = &r->laws[interaction];
  const double E = uniform_strain_of_bar(l->law, l->parameters, w);
  print_quantity(": along this bar E = ", E, "Pa");
  print_quantity(", E A = ", E * w->area, "N");
  putchar('\n');
}

static void announce_law(const run *r, int interaction) {
  const deck_interaction *of = &r->deck->interactions[interaction];
  const rows *w = simulation_rows(r->simulation, of->lattice);
  const pl_law *kernel = r->laws[interaction].law;
  implied_elasticity e;
  printf("  law        %s", kernel->name);
  if (r->model_of[interaction] && r->model_of[interaction]->path) {
    const char *path = r->model_of[interaction]->path;
    printf(" (%s)", strncmp(path, "./", 2) == 0 ? path + 2 : path);
  }
  if (of->material->beside)
    announce_part(simulation_law_rows(r->simulation, interaction)->bond_count, of->name);
  if (deck_lattice_is_bar(&r->deck->lattices[of->lattice])) {
    announce_bar_modulus(r, interaction);
    return;
  }
  if (w->copies) {
    putchar('\n');
    return;
  }
  if (w->list) {
    announce_uniform_strain(r, interaction);
    return;
  }
  if (implied_elastic(kernel, r->laws[interaction].parameters, w, &e)) {
    announce_modulus(r, interaction, e.E[0]);
    if (!rows_are_chain(w)) printf(", nu = %.4f", e.nu[0]);
    double strength = implied_strength(kernel, r->laws[interaction].parameters, w, 0, NULL);
    if (isfinite(strength))
      print_quantity(", largest stress ", strength, "Pa under uniform strain along x, sides held");
  }
  putchar('\n');
}

/* Per cent of the bonds of whole families that the body lacks. */
static double lost_bonds(const rows *w) {
  return 100 * (1 - (double)w->bond_count / ((double)w->particle_count * w->directions));
}

/* Where edges lack bonds, the body is softer than its lattice: said from 1 % on. With few bonds
   lost it cannot be. */
static void announce_edges(const run *r, int lattice, int interaction) {
  const double few = 0.3, many = 5e6, difference = 0.01; /* %, bonds, of the modulus */
  const rows *w = simulation_rows(r->simulation, lattice);
  const simulation_law *l = &r->laws[interaction];
  const parameter_planes *f = simulation_planes(r->simulation, interaction);
  implied_elasticity e;
  double E[3];
  if (w->list || lost_bonds(w) < few || !implied_elastic(l->law, l->parameters, w, &e)) return;
  if ((double)w->bond_count > many) {
    printf(
        "  body       lacks %.2g %% of the bonds of its lattice at edges; too large to be held in "
        "a uniform strain here\n",
        lost_bonds(w));
    return;
  }
  if (!uniform_strain_moduli(l->law, l->parameters, f ? f->value : NULL, w, E)) return;
  bool differs = false;
  for (int c = 0; c < 2; c++)
    differs = differs || fabs(E[c] / e.E[c] - 1) > difference;
  if (!differs) return;
  fputs("  body       held in a uniform strain", stdout);
  for (int c = 0; c < 2; c++) {
    if (isnan(E[c])) continue;
    print_quantity(c && !isnan(E[0]) ? ", E = " : " E = ", E[c], "Pa");
    printf(" along %c (%+.1f %%)", "xy"[c], 100 * (E[c] / e.E[c] - 1));
  }
  puts(f && f->count > (f->density ? 1 : 0)
           ? ": it is not uniform, and edges and notches lack bonds"
           : ": edges and notches lack bonds");
}

/* "S_t differs from bond to bond: 1.02e-4 to 1.33e-4, mean 1.18e-4": random fields, regions. */
static void announce_planes(const run *r, int interaction) {
  const parameter_planes *f = simulation_planes(r->simulation, interaction);
  const simulation_law *l = &r->laws[interaction];
  for (int k = 0; f && k < f->count; k++) {
    const bool particles =
        l->law->varying_place == PL_ON_PARTICLE || l->law->varying[k] == l->law->density;
    const pl_parameter *p = &l->law->parameters[l->law->varying[k]];
    const char *in = unit_is_pure(p->unit) ? "" : p->unit;
    const char *const places[] = {"region to region", "place to place", "place to place",
                                  particles ? "particle to particle" : "bond to bond"};
    static const char *const names[] = {"regions", "formula", "file", "field"};
    const plane_change change = parameter_planes_change(f, k);
    printf("  %-10s %s ", change == PLANE_STAYS ? names[f->source[k]] : "field", p->name);
    if (change != PLANE_CHANGES_ALIKE) printf("differs from %s", places[f->source[k]]);
    if (change != PLANE_STAYS)
      fputs(change == PLANE_CHANGES ? " and changes in time" : "changes in time", stdout);
    printf(": %.5g to %.5g%s%s", f->smallest[k], f->largest[k], *in ? " " : "", in);
    if (f->source[k] == PLANE_AT_RANDOM)
      printf(", mean of the distribution %.5g", l->parameters[l->law->varying[k]]);
    putchar('\n');
  }
}

/* Those at work on a lattice. Of several the body as a whole is not what one of them implies. */
void announce_laws(const run *r, int lattice) {
  const deck *k = r->deck;
  for (int n = 0; n < k->interaction_count; n++) {
    if (k->interactions[n].lattice != lattice) continue;
    announce_law(r, n);
    if (!k->interactions[n].material->beside) announce_edges(r, lattice, n);
    announce_planes(r, n);
  }
}
