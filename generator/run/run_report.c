#include "generator/run/run_report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/elementary.h"
#include "generator/drive/explain_bad.h"
#include "generator/drive/explain_point.h"
#include "generator/kernel/document.h"
#include "generator/run/bad_bond.h"
#include "generator/run/moment.h"
#include "generator/run/print_quantity.h"
#include "generator/run/report_mesh.h"
#include "generator/run/run_cracks.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/uniform_strain.h"
#include "runtime/continuum/mesh_ties.h"
#include "runtime/continuum/point_forces.h"
#include "runtime/continuum/tips.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/filling/bar_placing.h"
#include "runtime/geometry/polyline.h"
#include "runtime/lattice/notch_depth.h"
#include "runtime/lattice/parameter_planes.h"
#include "runtime/result/checkpoint.h"

/* --- before the run --------------------------------------------------------------------------- */

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
static void announce_body(const run *r, int lattice, int interaction) {
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

static void announce_notch(const notch_depth *n, int number, bool only) {
  char name[24] = "notch";
  if (!only) snprintf(name, sizeof name, "notch %d", number);
  printf("  %-10s ", name);
  if (n->kind == NOTCH_THROUGH)
    printf("%.4g mm deep: it cuts the body through\n", 1e3 * n->drawn);
  else if (n->kind == NOTCH_INSIDE)
    printf("%.4g mm long as drawn, %.4g mm from bond to bond; ligaments %.4g and %.4g mm\n",
           1e3 * n->drawn, 1e3 * n->cut, 1e3 * n->ligament[0], 1e3 * n->ligament[1]);
  else
    printf("%.4g mm deep as drawn, %.4g mm to the first bond left; ligament %.4g mm\n",
           1e3 * n->drawn, 1e3 * n->cut, 1e3 * n->ligament[0]);
}

static void announce_notches(const run *r, int lattice) {
  enum { MOST = 8 };
  const deck *k = r->deck;
  int said = 0, left = 0;
  for (int n = 0; n < k->notch_count; n++) {
    if (strcmp(k->notchs[n].lattice, k->lattices[lattice].name) != 0) continue;
    if (said == MOST) {
      left++;
      continue;
    }
    const notch_depth depth =
        notch_depth_of(simulation_rows(r->simulation, lattice), &k->notchs[n].shape);
    if (depth.kind == NOTCH_NONE) continue;
    announce_notch(&depth, n + 1, k->notch_count == 1);
    said++;
  }
  if (left > 0) printf("             and %d more\n", left);
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
    printf("  %-10s %s differs from %s: %.5g to %.5g%s%s", names[f->source[k]], p->name,
           places[f->source[k]], f->smallest[k], f->largest[k], *in ? " " : "", in);
    if (f->source[k] == PLANE_AT_RANDOM)
      printf(", mean of the distribution %.5g", l->parameters[l->law->varying[k]]);
    putchar('\n');
  }
}

static void announce_particles(const run *r, int lattice) {
  const rows *w = simulation_rows(r->simulation, lattice);
  const deck_lattice *k = &r->deck->lattices[lattice];
  char depth[32] = "";
  int fewest = ROWS_MAX_NEIGHBOURS, most = 0;
  if (w->dimensions == 3) snprintf(depth, sizeof depth, " x %.5g", 1e3 * w->depth);
  for (long p = 0; p < w->particle_count; p++) {
    const int degree = rows_degree(w, w->particle_site[p]);
    fewest = degree < fewest ? degree : fewest;
    most = degree > most ? degree : most;
  }
  printf("  particles  %s: %ld of %s, spacing %.6g mm, %.5g x %.5g%s mm between outermost ones\n"
         "  neighbours %d to %d, mean %.4g, %ld bonds\n",
         k->name, w->particle_count, k->file ? k->file : "blue noise", 1e3 * w->spacing,
         1e3 * w->width, 1e3 * w->height, depth, fewest, most,
         2 * (double)w->bond_count / (double)w->particle_count, w->bond_count);
}

static bool some_link_joins(const deck *k, int bar, int around) {
  for (int n = 0; n < k->lattice_count; n++) {
    const deck_link *link = &k->lattices[n];
    if (deck_lattice_is_link(link) && link->of_bar == bar && link->of_around == around) return true;
  }
  return false;
}

/* "placing    of 61 particles of bottom 59 lie in concrete, 0 to 5.8 mm from the nearest site, in
   the mean 2.7 mm; no link joins them" */
static void announce_placing(const run *r, int lattice) {
  const deck *k = r->deck;
  const rows *bar = simulation_rows(r->simulation, lattice);
  for (int n = 0; n < k->lattice_count; n++) {
    const rows *w = simulation_rows(r->simulation, n);
    if (deck_lattice_is_bar(&k->lattices[n]) || w->copies || w->dimensions != bar->dimensions)
      continue;
    const bar_placing p = bar_placing_in(bar, w);
    printf("  placing    of %ld particles of %s %ld lie in %s", bar->particle_count,
           k->lattices[lattice].name, p.inside, k->lattices[n].name);
    if (p.inside)
      printf(", %.3g to %.3g mm from the nearest %s, in the mean %.3g mm", 1e3 * p.least,
             1e3 * p.most, w->list ? "particle" : "site", 1e3 * p.mean);
    if (p.inside && !some_link_joins(k, lattice, n)) fputs("; no link joins them", stdout);
    putchar('\n');
  }
}

/* "15 copies, each (80, 0) mm from the one before, " */
static void announce_copies(const deck_bar *k, int dimensions) {
  char text[ROWS_PLACE_TEXT];
  if (k->copies > 1)
    printf("%d copies, each %s from the one before, ", k->copies,
           rows_place_text(dimensions, k->shift, text));
}

/* "bar        bottom: 58 particles, 57 bonds, 1.14 m long, spacing 20 mm, area 126.68 mm^2" */
static void announce_bar(const run *r, int lattice) {
  const rows *w = simulation_rows(r->simulation, lattice);
  const deck_bar *k = &r->deck->lattices[lattice];
  const polyline p = {w->dimensions, k->value_count / w->dimensions, k->points, k->closed};
  double shortest = INFINITY, longest = 0;
  for (int leg = 0; leg < polyline_legs(&p); leg++) {
    const double *from, *to;
    const double part =
        polyline_leg(&p, leg, &from, &to) / (double)polyline_parts(&p, leg, k->spacing);
    shortest = pl_fmin(shortest, part);
    longest = pl_fmax(longest, part);
  }
  printf("  bar        %s: ", k->name);
  announce_copies(k, w->dimensions);
  printf("%s%ld particles, %ld bonds, %s%.6g mm long, area %.6g mm^2, spacing %.6g",
         k->closed ? "closed, " : "", w->particle_count, w->bond_count,
         k->copies > 1 ? "each " : "", 1e3 * polyline_length(&p), 1e6 * k->area, 1e3 * shortest);
  if (longest > shortest * (1 + POLYLINE_ROUNDING)) printf(" to %.6g", 1e3 * longest);
  fputs(" mm", stdout);
  if (pl_fmax(longest - k->spacing, k->spacing - shortest) > POLYLINE_ROUNDING * k->spacing)
    printf(": legs are no multiples of %.6g mm", 1e3 * k->spacing);
  putchar('\n');
  announce_placing(r, lattice);
}

/* "link       bond: 116 bonds of 2.5 to 20 mm join 29 particles of bottom to 60 of concrete" */
static void announce_link(const run *r, int lattice) {
  const rows *w = simulation_rows(r->simulation, lattice);
  const deck_link *k = &r->deck->lattices[lattice];
  double shortest = INFINITY, longest = 0, chord[3];
  long of_bar = 0;
  for (long p = 0; p < w->particle_count; p++) {
    of_bar += w->copies[p].lattice == k->of_bar;
    for (int n = 0; n < 2 * w->directions; n++) {
      if (!rows_has_neighbour(w, w->particle_site[p], n)) continue;
      const double length = rows_chord(w, w->particle_site[p], n, chord);
      shortest = pl_fmin(shortest, length);
      longest = pl_fmax(longest, length);
    }
  }
  if (k->to == LINK_TO_PLACE) {
    printf("  link       %s: %ld particles of %s tied to places in %s, every %.6g mm\n", k->name,
           w->bond_count, k->bar, k->around, 1e3 * k->spacing);
    return;
  }
  printf("  link       %s: %ld bonds of %.4g to %.4g mm join %ld particles of %s to %ld of %s\n",
         k->name, w->bond_count, 1e3 * shortest, 1e3 * longest, of_bar, k->bar,
         w->particle_count - of_bar, k->around);
}

static void announce_lattice(const run *r, int lattice) {
  const rows *w = simulation_rows(r->simulation, lattice);
  const deck_lattice *k = &r->deck->lattices[lattice];
  char depth[32] = "", family[64] = "";
  if (w->dimensions == 3) snprintf(depth, sizeof depth, " x %.5g", 1e3 * w->depth);
  if (w->shell[w->directions - 1] > 1)
    snprintf(family, sizeof family, ", %d neighbours", 2 * w->directions);
  printf(
      "  lattice    %s: %s, spacing %.6g mm%s, %ld particles, %ld bonds, %.5g x %.5g%s mm between "
      "outermost sites\n",
      k->name, k->kind, 1e3 * w->spacing, family, w->particle_count, w->bond_count, 1e3 * w->width,
      1e3 * w->height, depth);
}

/* "tie        core to left: 17 particles, 0.31 kg of which goes to 18 nodes; 16 bonds count by halves" */
static void announce_ties(const run *r, int lattice) {
  int count;
  const mesh_tie *ties = simulation_ties(r->simulation, lattice, &count);
  for (int n = 0; n < count; n++) {
    const mesh_tie *t = &ties[n];
    printf("  tie        %s to %s: %ld particles, %.4g kg of them goes to its nodes",
           t->from->lattice, t->from->mesh, t->count,
           mesh_tie_mass(t, simulation_rows(r->simulation, lattice)));
    if (t->half_count > 0) printf("; %ld bonds along its edge count by halves", t->half_count);
    if (t->left_out > 0) printf("; %ld bonds inside it are left out", t->left_out);
    putchar('\n');
  }
}

/* "mass       0.2 kg on 3 particles of `tip`" */
static void announce_point_mass(const run *r, int index) {
  long particles;
  const double mass = simulation_point_mass(r->simulation, index, &particles);
  printf("  mass       %.6g kg on %ld particle%s of `%s`\n", mass, particles,
         particles == 1 ? "" : "s", r->deck->point_masss[index].region);
}

static bool is_written(const deck_item *item, const char *key) {
  for (int k = 0; k < item->key_count; k++)
    if (strcasecmp(item->keys[k].name, key) == 0) return true;
  return false;
}

/* "load       -42 kN/m on 1.2 m of `top`, 60 particles: -50.4 kN along y" */
static void announce_line_load(const run *r, int force) {
  const deck_force *f = &r->deck->forces[force];
  const int region = deck_find_region(r->deck, f->region);
  const int lattice = deck_find_lattice(r->deck, r->deck->regions[region].lattice);
  const int dimensions = simulation_rows(r->simulation, lattice)->dimensions;
  long particles;
  const double length = simulation_loaded_length(r->simulation, force, &particles);
  const bool known = is_written(&f->item, "per_length");
  fputs("  load      ", stdout);
  if (known) print_quantity(" ", f->force.value, "N/m");
  printf("%s %.6g m of `%s`, %ld particles", known ? " on" : " by length on", length, f->region,
         particles);
  if (known) print_quantity(": ", f->force.value * length, "N");
  printf(" along %s\n", deck_component_name(dimensions, f->component));
}

/* Loads come in the deck's time, which has nothing to do with that of the steps. */
static void announce_increments(const run *r) {
  const deck_relaxation *k = &r->deck->relaxation;
  if (k->solved) {
    printf("  static     %d increment%s, each the solution of K u = F\n", k->increments,
           k->increments == 1 ? "" : "s");
    return;
  }
  printf(
      "  increments %d, quasi-static, each until the unbalanced force is %.4g of the reactions or "
      "loads, or for %ld steps\n",
      k->increments, k->tolerance, (long)k->most_steps);
  fputs("  steps      of ", stdout);
}

/* Those at work on a lattice. Of several the body as a whole is not what one of them implies. */
static void announce_laws(const run *r, int lattice) {
  const deck *k = r->deck;
  for (int n = 0; n < k->interaction_count; n++) {
    if (k->interactions[n].lattice != lattice) continue;
    announce_law(r, n);
    if (!k->interactions[n].material->beside) announce_body(r, lattice, n);
    announce_planes(r, n);
  }
}

static double hertz(double omega) {
  return omega / (2 * M_PI);
}

/* What the deck gives by frequencies. */
static void announce_frequencies(const run *r) {
  const deck *k = simulation_deck(r->simulation);
  if (k->simulation.periods > 0) {
    const double frequency = hertz(simulation_omega(r->simulation, 1));
    printf("  periods    %.6g of %.6g ms, mode 1 at %.6g Hz\n", k->simulation.periods,
           1e3 / frequency, frequency);
  }
  for (int n = 0; n < k->damping_count; n++) {
    const deck_damping *b = &k->dampings[n];
    if (b->ratio > 0)
      printf("  damping    %.4g of the critical one of mode %d at %.6g Hz: rate %.6g 1/s\n",
             b->ratio, b->mode, hertz(simulation_omega(r->simulation, b->mode)), b->rate);
  }
}

/* "0.3061 us: 0.25 of the stable step 1.224 us (rotation mode rules)" */
static void announce_step(const run *r) {
  const step_limit *limit = simulation_step_limit(r->simulation);
  printf("%.4g us: %.3g of the stable step %.4g us (%s mode%s", 1e6 * limit->step,
         limit->step / limit->limit, 1e6 * limit->limit, limit->mode,
         limit->at_surface ? " at a surface" : "");
  if (r->deck->lattice_count > 1)
    printf(" of %s", r->deck->lattices[simulation_ruling_body(r->simulation)].name);
  puts(" rules)");
}

void announce(const run *r) {
  const deck_simulation *s = &simulation_deck(r->simulation)->simulation;
  printf("%s\n", s->title ? s->title : r->options->deck_path);
  for (int k = 0; k < r->deck->lattice_count; k++) {
    if (deck_lattice_is_mesh(&r->deck->lattices[k])) {
      announce_mesh(r, k);
      continue;
    }
    if (deck_lattice_is_bar(&r->deck->lattices[k]))
      announce_bar(r, k);
    else if (deck_lattice_is_link(&r->deck->lattices[k]))
      announce_link(r, k);
    else if (simulation_rows(r->simulation, k)->list)
      announce_particles(r, k);
    else
      announce_lattice(r, k);
    announce_ties(r, k);
    announce_notches(r, k);
    announce_laws(r, k);
  }
  for (int p = 0; p < r->deck->point_mass_count; p++)
    announce_point_mass(r, p);
  for (int f = 0; f < r->deck->force_count; f++)
    if (r->deck->forces[f].per_length) announce_line_load(r, f);
  if (r->deck->relaxation.increments > 0)
    announce_increments(r);
  else
    printf("  time       %.6g ms in %ld steps of ", 1e3 * s->end_time,
           simulation_step_count(r->simulation));
  if (!r->deck->relaxation.solved) announce_step(r);
  announce_frequencies(r);
  printf("  machine    %d thread%s, %.1f MiB\n", simulation_threads(r->simulation),
         simulation_threads(r->simulation) == 1 ? "" : "s",
         simulation_memory(r->simulation) / 1048576.0);
  printf("  result     %s\n", r->result_path);
  fflush(stdout);
}

/* --- during the run, and when it goes wrong --------------------------------------------------- */

/* "load 3100 N (peak 11020 N), cmod 1.2e-5 m": monitors at the last sample. */
void describe_monitors(const run *r, char *text, size_t size) {
  const double *time;
  long samples = simulation_history(r->simulation, &time);
  char now[MOMENT_TEXT];
  int n = snprintf(text, size, "%s", moment(r, simulation_time(r->simulation), now));
  for (int k = 0; samples > 0 && k < r->deck->monitor_count && k < 2 && n > 0 && (size_t)n < size;
       k++) {
    const char *unit_name;
    const double *values;
    const char *name = simulation_series(r->simulation, k, &unit_name, &values);
    const double last = values[samples - 1] + 0.0; /* no minus before zeros */
    const bool pure = unit_is_pure(unit_name);
    n += snprintf(text + n, size - (size_t)n, ", %s %.4g%s%s", name, last, pure ? "" : " ",
                  pure ? "" : unit_name);
    if (k == 0 && (size_t)n < size)
      n += snprintf(text + n, size - (size_t)n, " (peak %.4g)",
                    simulation_monitor_peak(r->simulation, k, NULL) + 0.0);
  }
}

/* The bond at fault, for `perilat drive`. */
static void write_bad_bond(const run *r, const bad_state *b) {
  char path[4200], error[ERROR_LENGTH + 4200];
  bad_bond_path(r->result_path, b, path, sizeof path);
  if (bad_bond_write(path, r->options->deck_path, r->model_of[b->interaction],
                     &r->laws[b->interaction], simulation_rows(r->simulation, b->body), b, error,
                     sizeof error))
    fprintf(stderr, "  this bond alone: perilat drive %s\n", path);
  else
    fprintf(stderr, "  %s\n", error);
}

static void write_bad_point(const run *r, const bad_state *b) {
  char path[4200], error[ERROR_LENGTH + 4200];
  bad_bond_path(r->result_path, b, path, sizeof path);
  if (bad_point_write(path, r->options->deck_path, r->model_of[b->interaction],
                      &r->laws[b->interaction], &r->deck->lattices[b->body], b, error,
                      sizeof error))
    fprintf(stderr, "  this point alone: perilat drive %s\n", path);
  else
    fprintf(stderr, "  %s\n", error);
}

/* What its law says there, line by line. */
static bool explain_bad_point(const run *r, const bad_state *b) {
  const simulation_law *l = &r->laws[b->interaction];
  const point_state *p = b->point;
  const asked_point at = {p->strain, p->field, p->size, simulation_step_limit(r->simulation)->step};
  return r->model_of[b->interaction] &&
         explain_point(r->model_of[b->interaction]->plan, l->parameters, &at, stderr);
}

static void print_fields(const pl_law *kernel, const double *values, bool on_particles) {
  for (int f = 0; f < kernel->field_count; f++)
    if ((kernel->fields[f].place == PL_ON_PARTICLE) == on_particles)
      fprintf(stderr, ", %s %.6g", kernel->fields[f].name, values[f]);
}

/* What the particle's law read: its family. */
static void print_family(const run *r, const bad_state *b) {
  const pl_law *kernel = r->laws[b->interaction].law;
  fprintf(stderr, "  the particle has %d bonds", b->family_count);
  print_fields(kernel, b->own_fields, true);
  fputc('\n', stderr);
  for (int k = 0; k < b->family_count; k++) {
    const bad_neighbour *n = &b->family[k];
    fprintf(stderr, "  bond to particle %ld: stretch %.6g, stretch rate %.6g 1/s", n->particle,
            n->stretch, n->stretch_rate);
    print_fields(kernel, n->fields, false);
    print_fields(kernel, n->fields, true);
    fputc('\n', stderr);
  }
}

/* What a point of a mesh was like before the step. */
static void print_point(const run *r, const bad_state *b) {
  const pl_law *kernel = r->laws[b->interaction].law;
  const point_state *p = b->point;
  char cell[BAD_CELL_TEXT];
  fprintf(stderr, "  point (%.6g, %.6g) mm of cell %s", 1e3 * p->at[0], 1e3 * p->at[1],
          bad_cell_text(&r->deck->lattices[b->body], p->cell, cell));
  fprintf(stderr, ": strain xx %.6g, yy %.6g, xy %.6g; stress xx %.6g, yy %.6g, xy %.6g MPa",
          p->strain[0], p->strain[1], p->strain[2], 1e-6 * p->stress[0], 1e-6 * p->stress[1],
          1e-6 * p->stress[2]);
  for (int f = 0; f < kernel->field_count; f++)
    fprintf(stderr, ", %s %.6g", kernel->fields[f].name, p->field[f]);
  fputc('\n', stderr);
}

/* A mesh whose points have become so stiff that the step may be beyond the limit. Where it was, how
   stiff they are in the end tells nothing. */
static void tell_stiffness(const run *r, bool failed) {
  for (int b = 0; b < simulation_bodies(r->simulation); b++) {
    const cells *c = simulation_cells(r->simulation, b);
    const step_limit *limit = simulation_step_limit(r->simulation);
    const double part = limit->step / limit->limit;
    const char *name = r->deck->lattices[b].name;
    char when[MOMENT_TEXT];
    if (!c || c->stiffened.since < 0) continue;
    moment(r, c->stiffened.since, when);
    if (failed)
      fprintf(
          stderr,
          "  from %s on a point of `%s` was more than %.3g times as stiff as at rest, and steps "
          "of %.3g of the\n  limit at rest too long for it: take a smaller `step_safety`\n",
          when, name, 1 / (part * part), part);
    else
      fprintf(
          stderr,
          "perilat: warning: from %s on steps of %.3g of the limit at rest were longer than is "
          "safe: a point of `%s`\n  became %.3g times as stiff as at rest, and steps up to %.3g of "
          "that limit are safe. Run it with\n  `step_safety = %.2g` and compare\n",
          when, part, name, c->stiffened.most, 1 / sqrt(c->stiffened.most),
          0.9 / sqrt(c->stiffened.most));
  }
}

/* As a crack cuts nodes off, the rest of the body can become stiffer for its mass. */
static void tell_growth(const run *r, bool failed) {
  const double step = simulation_step_limit(r->simulation)->step;
  for (int b = 0; b < simulation_bodies(r->simulation) && cracks_have_grown(r); b++) {
    const double now = simulation_limit_now(r->simulation, b);
    if (step <= now) continue;
    if (failed)
      fprintf(stderr,
              "  since the cracks of `%s` have grown its longest stable step is %.4g us, and these "
              "were %.4g us: take a\n  smaller `step_safety`\n",
              r->deck->lattices[b].name, 1e6 * now, 1e6 * step);
    else
      fprintf(stderr,
              "perilat: warning: since the cracks of `%s` have grown its longest stable step is "
              "%.4g us, and these were %.4g us.\n  Run it with a smaller `step_safety` and "
              "compare\n",
              r->deck->lattices[b].name, 1e6 * now, 1e6 * step);
  }
}

/* Samples of a series; NULL where there is none of that name. */
static const double *series_of(const run *r, const char *name) {
  for (int k = 0; k < simulation_series_count(r->simulation); k++) {
    const double *values;
    if (strcmp(simulation_series(r->simulation, k, NULL, &values), name) == 0) return values;
  }
  return NULL;
}

/* The first or the last sample; NaN where there is none. */
static double sample_of(const run *r, const char *name, bool last) {
  const double *time, *values = series_of(r, name);
  const long samples = simulation_history(r->simulation, &time);
  return values && samples > 0 ? values[last ? samples - 1 : 0] : NAN;
}

static double last_value(const run *r, const char *name) {
  return sample_of(r, name, true);
}

/* Where no particle is at fault. */
static void report_bad_energy(const run *r, const bad_state *b) {
  char when[MOMENT_TEXT];
  say_error("%s after %ld steps (%s): kinetic %.3g J, stored %.3g J\n"
            "  no stable step does that: the step is too long for this body, or the law's stored "
            "energy is "
            "not that of its forces\n"
            "  what was computed until then is in the result; a smaller `step_safety` tells which",
            b->what, b->step, moment(r, b->time, when), last_value(r, "energy/kinetic"),
            last_value(r, "energy/stored"));
  tell_stiffness(r, true);
  tell_growth(r, true);
}

void report_bad(const run *r) {
  bad_state b = simulation_bad(r->simulation);
  char place_text[ROWS_PLACE_TEXT], when[MOMENT_TEXT];
  bool no_return = false;
  if (b.particle < 0) {
    report_bad_energy(r, &b);
    return;
  }
  say_error(
      "%s in step %ld (%s%s) at particle %ld, %s", b.what, b.step,
      r->deck->relaxation.increments > 0 ? "after " : "", moment(r, b.time, when), b.particle,
      rows_place_text(simulation_rows(r->simulation, b.body)->dimensions, b.place, place_text));
  if (b.family) print_family(r, &b);
  if (b.point) {
    print_point(r, &b);
    no_return = explain_bad_point(r, &b);
    write_bad_point(r, &b);
  }
  if (b.bond_particle >= 0) {
    fprintf(stderr,
            "  bond to particle %ld: stretch %.6g, stretch rate %.6g 1/s, end rotations %.6g and "
            "%.6g\n",
            b.bond_particle, b.stretch, b.stretch_rate, b.theta_i, b.theta_j);
    const pl_bond_class bonds = rows_bond_class(simulation_rows(r->simulation, b.body), 0);
    if (r->model_of[b.interaction])
      explain_bad(r->model_of[b.interaction]->plan, b.parameters, &bonds, &b, stderr);
    write_bad_bond(r, &b);
  }
  tell_stiffness(r, true);
  tell_growth(r, true);
  fputs(no_return
            ? "  what was computed until then is in the result; no smaller step mends it, but a "
              "law whose flow comes back\n"
            : "  what was computed until then is in the result; a smaller `step_safety` or a "
              "law that stays finite there mends it\n",
        stderr);
}

/* --- stopped and resumed ---------------------------------------------------------------------- */

/* As a word of a shell. */
static void print_word(const char *word, FILE *out) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                              "_./:=,+-";
  if (*word && strspn(word, plain) == strlen(word)) {
    fputs(word, out);
    return;
  }
  fputc('\'', out);
  for (; *word; word++)
    fputs(*word == '\'' ? "'\\''" : (char[]){*word, 0}, out);
  fputc('\'', out);
}

void print_resume(const run *r, FILE *out) {
  const run_options *o = r->options;
  if (o->deck_text)
    fputs("  ", out);
  else
    fprintf(out, "  %s ", o->program);
  print_word(o->deck_text ? o->program : o->deck_path, out);
  for (int k = 0; k < o->override_count; k++) {
    fputs(" --set ", out);
    print_word(o->overrides[k].text, out);
  }
  fputs(o->interpret ? " --interpret --resume\n" : " --resume\n", out);
}

/* One line, cut to what is near the byte at which two lines begin to differ. */
static void print_near(const char *title, const char *line, size_t differs) {
  enum { BEFORE = 50, WIDTH = 120 };
  size_t length = strcspn(line, "\n"), from = differs > BEFORE ? differs - BEFORE : 0;
  size_t shown = length - from < WIDTH ? length - from : WIDTH;
  fprintf(stderr, "    %s %s%.*s%s\n", title, from ? "..." : "", (int)shown, line + from,
          from + shown < length ? "..."
          : length              ? ""
                                : "nothing more");
}

void print_misfit(const run *r) {
  char *stopped = checkpoint_fingerprint(r->checkpoint_path);
  if (!stopped || strcmp(stopped, r->fingerprint) == 0) {
    free(stopped);
    return;
  }
  size_t line = 0, at = 0;
  for (; stopped[at] == r->fingerprint[at]; at++)
    if (stopped[at] == '\n') line = at + 1;
  fputs("  they differ first here:\n", stderr);
  print_near("stopped run:", stopped + line, at - line);
  print_near("this run:   ", r->fingerprint + line, at - line);
  fputs("  a run goes on with the deck and the --set options that it began with\n", stderr);
  free(stopped);
}

/* --- after the run ---------------------------------------------------------------------------- */

/* What is lost in rounding and in the integration's own wave is nothing. */
static double unless_nothing(double energy, double external) {
  return fabs(energy) < 1e-7 * fabs(external) ? 0 : energy;
}

/* Work of contacts and links on bodies goes out in sum, but for rounding. */
static void conclude_energy(const run *r) {
  const double external = unless_nothing(last_value(r, "energy/external"),
                                         sample_of(r, "energy/kinetic", false)),
               imbalance = last_value(r, "energy/imbalance");
  if (!isfinite(external)) return;
  printf("  energy     external work %.5g J: kinetic %.3g, stored %.3g, dissipated by damage %.5g, "
         "by damping %.3g; ",
         external, last_value(r, "energy/kinetic"), last_value(r, "energy/stored"),
         unless_nothing(last_value(r, "energy/dissipated_damage"), external),
         last_value(r, "energy/dissipated_damping"));
  const char *unchecked;
  simulation_imbalance(r->simulation, &unchecked);
  if (unchecked)
    printf("imbalance not checked: %s", unchecked);
  else
    printf("imbalance %.2g J", imbalance);
  const double largest = simulation_largest_energy(r->simulation);
  if (!unchecked && largest > 0)
    printf(" (%.2g %% of the largest energy)", 100 * fabs(imbalance) / largest);
  putchar('\n');
}

/* What states, damage and rate terms cannot do: give more than they have taken. */
static void warn_of_gain(const run *r) {
  static const struct {
    const char *series, *words;
  } parts[] = {{"energy/dissipated_damage", "its damage and states have"},
               {"energy/dissipated_damping", "its rate terms and the deck's damping have"}};
  const double scale = simulation_largest_energy(r->simulation);
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
    const double lost = last_value(r, parts[k].series);
    if (!(lost < -1e-3 * scale) || (k == 0 && cracks_have_grown(r))) continue;
    fprintf(stderr,
            "perilat: warning: the law gives energy: %s dissipated %.5g J, less than nothing\n"
            "  `perilat drive` along a closed path shows where (`perilat help dissipation`)%s\n",
            parts[k].words, lost,
            k ? ""
              : "; a law that locks energy in its states should give W (`perilat help energy`)");
  }
}

/* Where the law says that it has an energy and none of its parts may be given away. */
static bool keeps_energy(const run *r) {
  bool keeps = true;
  for (int k = 0; k < r->deck->interaction_count; k++)
    keeps = keeps && !(r->model_of[k] && r->model_of[k]->plan->law->nonconservative);
  return keeps;
}

static void warn_of_imbalance(const run *r) {
  static const double MUCH = 0.05; /* of the largest energy */
  const char *unchecked;
  simulation_imbalance(r->simulation, &unchecked);
  const double left =
      fabs(last_value(r, "energy/imbalance")) / simulation_largest_energy(r->simulation);
  if (unchecked || !isfinite(left) || left <= MUCH || !keeps_energy(r)) return;
  fprintf(stderr,
          "perilat: warning: the energies do not add up: in the end %.2g %% of the largest energy "
          "is missing or too much\n"
          "  either `energy W` is not that of the law's stress or forces (`perilat check` looks), "
          "or the step is too large:\n  run it with a smaller `step_safety`%s and compare\n",
          100 * left, r->deck->relaxation.increments > 0 ? " and more `increments`" : "");
}

/* States at points, and no damage that may set energy free all at once. */
static bool yields(const pl_law *kernel) {
  bool some = false;
  for (int k = 0; k < kernel->field_count; k++) {
    if (kernel->fields[k].place != PL_ON_POINT || kernel->fields[k].kind == PL_FIELD_DAMAGE)
      return false;
    some = true;
  }
  return some;
}

/* The part of the work that may be damped without a warning. Limit loads of laws that yield are far too
   low long before it is a tenth: under a punch on a block of `von_mises` in plane strain without
   hardening by 59 % with a part of 0.1 (6 increments), by 7 % with 0.02 (40), by 1 % with 0.004. */
static double part_damped(const run *r) {
  for (int n = 0; n < r->deck->interaction_count; n++)
    if (yields(r->laws[n].law)) return 0.01;
  return 0.1;
}

/* What the relaxation took from a body whose law remembers: its states on the way are those of a
   body that moves. */
static void warn_of_damping(const run *r) {
  const double part = part_damped(r), external = last_value(r, "energy/external"),
               damping = last_value(r, "energy/dissipated_damping"),
               damage = unless_nothing(last_value(r, "energy/dissipated_damage"), external);
  if (r->deck->relaxation.increments == 0 || !(damping > part * fabs(external)) || damage == 0)
    return;
  fprintf(
      stderr,
      "perilat: warning: the relaxation damped %.3g J, %.2g %% of the work of loads and drives: "
      "the body moved\n"
      "  within increments, and what broke or yielded then may depend on how many there are, the "
      "load that it bears, too;\n"
      "  take more increments: run it again with `relaxation.increments=%d` and compare. What "
      "stays the same was set free by the body "
      "itself, as it broke\n",
      damping, 100 * damping / fabs(external), 2 * r->deck->relaxation.increments);
}

/* "particle 12 of plate at (3, 4) mm" */
static void print_particle(const run *r, int lattice, long particle) {
  const rows *g = simulation_rows(r->simulation, lattice);
  double at[3];
  char text[ROWS_PLACE_TEXT];
  rows_place(g, g->particle_site[particle], at);
  fprintf(stderr, "particle %ld of %s, %s", particle, r->deck->lattices[lattice].name,
          rows_place_text(g->dimensions, at, text));
}

/* Faces that have gone through each other. */
static void warn_of_overlap(const run *r) {
  const overlap_found o = simulation_overlap(r->simulation);
  if (o.pairs == 0) return;
  fprintf(stderr,
          "perilat: warning: in the end %ld pair%s of particles that no bond joins lie%s over each "
          "other,\n  nearer than half a spacing; the nearest are ",
          o.pairs, o.pairs == 1 ? "" : "s", o.pairs == 1 ? "s" : "");
  print_particle(r, o.body[0], o.particle[0]);
  fputs(",\n  and ", stderr);
  print_particle(r, o.body[1], o.particle[1]);
  fputs(": a `&contact` keeps them apart\n", stderr);
}

/* The mesh has no damage: what has come to its edge can go no further. */
static void warn_of_damaged_ties(const run *r) {
  for (int n = 0; n < r->deck->lattice_count; n++) {
    const long bonds = simulation_damaged_ties(r->simulation, n);
    if (bonds == 0) continue;
    fprintf(stderr,
            "perilat: warning: damage has reached the edge of the mesh that `%s` is tied to: %ld "
            "bond%s there\n  %s damage of 0.5 or more; make the lattice larger\n",
            r->deck->lattices[n].name, bonds, bonds == 1 ? "" : "s", bonds == 1 ? "has" : "have");
  }
}

static double largest_of(const run *r, const char *name) {
  const double *time, *values = series_of(r, name);
  const long samples = simulation_history(r->simulation, &time);
  double largest = 0;
  for (long k = 0; values && k < samples; k++)
    largest = pl_fmax(largest, values[k]);
  return largest;
}

/* How well the increments of a quasi-static run ended. */
static void conclude_increments(const run *r) {
  long unbalanced;
  const long increments = simulation_increments(r->simulation, &unbalanced);
  if (increments == 0) return;
  if (r->deck->relaxation.solved) {
    printf("  static     unbalanced force left: at most %.2g of the reactions or loads\n",
           largest_of(r, "relaxation_unbalance"));
    return;
  }
  printf("  increments %ld, in the mean %ld steps each, at most %.0f; unbalanced force left: at "
         "most %.2g of the "
         "reactions or loads\n",
         increments, simulation_step_done(r->simulation) / increments,
         largest_of(r, "relaxation_steps"), largest_of(r, "relaxation_unbalance"));
  if (unbalanced > 0)
    printf("             %ld of them without balance after %ld steps\n", unbalanced,
           (long)r->deck->relaxation.most_steps);
}

/* "contact    blow: at most 34 pairs of particles in touch at a time, 1.2 kN between two, ..." */
static void conclude_contact(const run *r, int number) {
  const contact_said c = simulation_contact(r->simulation, number);
  printf("  contact    %s: ", r->deck->contacts[number].name);
  if (c.pairs == 0) {
    puts("nothing touched");
    return;
  }
  printf("at most %ld pair%s of particles in touch at a time", c.pairs, c.pairs == 1 ? "" : "s");
  print_quantity(", ", c.force, "N between two");
  print_quantity(", ", c.stored, "J stored\n");
}

/* The value that is largest in size, with its sign. */
static void conclude_monitor(const run *r, int k) {
  const char *unit_name;
  const char *name = simulation_series(r->simulation, k, &unit_name, NULL);
  double when = 0;
  const double peak = simulation_monitor_peak(r->simulation, k, &when) + 0.0;
  const bool pure = unit_is_pure(unit_name);
  char text[MOMENT_TEXT];
  printf("  %-10s largest %.6g%s%s at %s\n", name, peak, pure ? "" : " ", pure ? "" : unit_name,
         moment(r, when, text));
}

static void conclude_speed(const run *r, double seconds, long steps) {
  if (r->deck->relaxation.solved) {
    printf("%ld solution%s in %.2f s\n", steps, steps == 1 ? "" : "s", seconds);
    return;
  }
  const double rate = (double)steps / pl_fmax(seconds, 1e-9);
  double bonds = 0, nodes = 0;
  for (int b = 0; b < simulation_bodies(r->simulation); b++) {
    bonds += (double)simulation_rows(r->simulation, b)->bond_count;
    if (simulation_cells(r->simulation, b))
      nodes += (double)simulation_rows(r->simulation, b)->particle_count;
  }
  printf("%ld steps in %.2f s: %.0f steps/s", steps, seconds, rate);
  if (bonds > 0) printf(", %.1f million bond updates/s", 1e-6 * rate * bonds);
  if (nodes > 0) printf(", %.1f million node updates/s", 1e-6 * rate * nodes);
  putchar('\n');
}

void conclude(const run *r, double seconds, long steps) {
  conclude_speed(r, seconds, steps);
  conclude_increments(r);
  for (int k = 0; k < r->deck->monitor_count; k++)
    conclude_monitor(r, k);
  for (int k = 0; k < r->deck->contact_count; k++)
    conclude_contact(r, k);
  conclude_energy(r);
  conclude_cracks(r);
  conclude_deaths(r);
  fflush(stdout);
  warn_of_gain(r);
  warn_of_imbalance(r);
  warn_of_damping(r);
  warn_of_overlap(r);
  warn_of_damaged_ties(r);
  if (!simulation_bad(r->simulation).what[0]) {
    tell_stiffness(r, false);
    tell_growth(r, false);
  }
  long frames = (long)result_mark(r->result).count;
  printf("  written    %s (%ld frame%s) and its .xdmf for ParaView\n", r->result_path, frames,
         frames == 1 ? "" : "s");
}

/* "load was below 5 % of its peak" */
static void describe_stop(const deck_stop *s, char *text, size_t size) {
  const char *side = s->below ? "below" : "above";
  if (s->of_peak)
    snprintf(text, size, "%s was %s %.4g %% of its peak", s->monitor, side, 100 * s->level);
  else
    snprintf(text, size, "%s was %s %.6g", s->monitor, side, s->level);
}

/* "ended early at t = 25.9 ms: load was below 5 % of its peak". */
void print_stop(const run *r) {
  const deck_stop *s = simulation_stopped_by(r->simulation);
  if (!s) return;
  char text[MOMENT_TEXT], why[256];
  describe_stop(s, why, sizeof why);
  printf("  ended early at %s: %s\n", moment(r, simulation_time(r->simulation), text), why);
}

void describe_end(const run *r, const run_end *end, char *text, size_t size) {
  const deck_stop *s = simulation_stopped_by(r->simulation);
  char now[MOMENT_TEXT], why[256] = "";
  moment(r, simulation_time(r->simulation), now);
  if (end->status == STEP_BAD) {
    const bad_state b = simulation_bad(r->simulation);
    snprintf(text, size, "failed at %s: %s in step %ld", now, b.what, b.step);
  } else if (end->status == STEP_STOPPED && s) {
    describe_stop(s, why, sizeof why);
    snprintf(text, size, "stopped by &stop at %s: %s", now, why);
  } else if (end->status == STEP_OK)
    snprintf(text, size, "interrupted at %s%s", now, r->is_kept ? ": the run can be resumed" : "");
  else
    snprintf(text, size, "end of the run");
}
