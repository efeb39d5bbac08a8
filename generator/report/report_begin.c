#include "generator/report/report_begin.h"

#include <math.h>
#include <stdio.h>
#include <strings.h>

#include "dsl/base/elementary.h"
#include "generator/report/print_quantity.h"
#include "generator/report/report_bodies.h"
#include "generator/report/report_laws.h"
#include "generator/report/report_mesh.h"
#include "runtime/base/quantity.h"
#include "runtime/parts/run_body.h"

static int lattice_of(const run *r, const char *region_name) {
  const int region = deck_find_region(r->deck, region_name);
  return deck_find_lattice(r->deck, r->deck->regions[region].lattice);
}

/* "mass       0.2 kg on 3 particles of `tip`" */
static void announce_point_mass(const run *r, int index) {
  const char *region = r->deck->point_masss[index].region;
  long particles;
  const double mass = simulation_point_mass(r->simulation, index, &particles);
  printf("  mass       %.6g kg on %ld %s%s of `%s`\n", mass, particles,
         deck_particle_word(&r->deck->lattices[lattice_of(r, region)]), particles == 1 ? "" : "s",
         region);
}

static bool is_written(const deck_item *item, const char *key) {
  for (int k = 0; k < item->key_count; k++)
    if (strcasecmp(item->keys[k].name, key) == 0) return true;
  return false;
}

/* "load       -42 kN/m on 1.2 m of `top`, 60 particles: -50.4 kN along y" */
static void announce_line_load(const run *r, int force) {
  const deck_force *f = &r->deck->forces[force];
  const int lattice = lattice_of(r, f->region);
  const int dimensions = simulation_rows(r->simulation, lattice)->dimensions;
  long particles;
  const double length = simulation_loaded_length(r->simulation, force, &particles);
  const bool known = is_written(&f->item, "per_length");
  fputs("  load      ", stdout);
  if (known) print_quantity(" ", f->force.value, "N/m");
  printf("%s %.6g m of `%s`, %ld %ss", known ? " on" : " by length on", length, f->region,
         particles, deck_particle_word(&r->deck->lattices[lattice]));
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

/* "12 particles and 40 bonds", "1 bond" */
static void print_counts(long particles, long bonds) {
  if (particles > 0) printf("%ld particle%s", particles, particles == 1 ? "" : "s");
  if (particles > 0 && bonds > 0) fputs(" and ", stdout);
  if (bonds > 0 || particles == 0) printf("%ld bond%s", bonds, bonds == 1 ? "" : "s");
}

static void print_going(const run_going *g) {
  if (g->particles + g->bonds > 0) {
    print_counts(g->particles, g->bonds);
    fputs(" go on", stdout);
  }
  if (g->new_particles + g->new_bonds > 0) {
    if (g->particles + g->bonds > 0) fputs("; ", stdout);
    print_counts(g->new_particles, g->new_bonds);
    fputs(" are new", stdout);
  }
  if (g->gone_particles + g->gone_bonds > 0) {
    fputs("; ", stdout);
    print_counts(g->gone_particles, g->gone_bonds);
    fputs(" are gone", stdout);
  }
}

/* "start      first.h5, `plate`: 120 particles and 330 bonds go on; 20 bonds are gone" */
static void announce_start(const run *r) {
  if (!r->deck->start.result) return;
  for (int k = 0; k < r->deck->lattice_count; k++) {
    const run_going g = simulation_going(r->simulation, k);
    printf("  start      %s, `%s`: ", r->deck->start.result, r->deck->lattices[k].name);
    print_going(&g);
    puts("");
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

/* "0.3061 us: 0.25 of the stable step 1.224 us (rotation mode rules)", or "(contact rules)" */
static void announce_step(const run *r) {
  const step_limit *limit = simulation_step_limit(r->simulation);
  printf("%.4g us: %.3g of the stable step %.4g us (%s", 1e6 * limit->step,
         limit->step / limit->limit, 1e6 * limit->limit, limit->mode);
  if (!limit->between) {
    printf(" mode%s", limit->at_surface ? " at a surface" : "");
    if (r->deck->lattice_count > 1)
      printf(" of %s", r->deck->lattices[simulation_ruling_body(r->simulation)].name);
  }
  puts(" rules)");
}

/* "looked at every 100 steps, halved where bodies stiffen; once they touch the stable step is 0.12
   us" */
static void announce_shrinking(const run *r) {
  const int every = r->deck->simulation.shrink_every;
  if (every == 0) return;
  printf("  shrinks    looked at every %d step%s, halved where bodies stiffen", every,
         every == 1 ? "" : "s");
  if (r->deck->contact_count > 0)
    printf("; near to touching the stable step is %.4g us",
           1e6 * simulation_touching_limit(r->simulation));
  putchar('\n');
}

/* "stamp      ball: 0.5 kg at 3 m/s along (0, -1), 1.5 mm from `plate`" */
static void announce_stamp(const run *r, int number) {
  const deck_stamp *stamp = &r->deck->stamps[number];
  const stamp_said said = simulation_stamp(r->simulation, number);
  const double *v = said.velocity;
  const double speed = pl_hypot(pl_hypot(v[0], v[1]), v[2]);
  int lattice;
  const double gap = simulation_stamp_gap(r->simulation, number, &lattice);
  printf("  stamp      %s: ", stamp->name);
  if (stamp->mass > 0)
    printf("%.4g kg", stamp->mass);
  else
    fputs("its motion is prescribed", stdout);
  if (stamp->mass > 0 && speed > 0) {
    print_quantity(" at ", speed, "m/s");
    printf(" along (%.3g, %.3g", v[0] / speed + 0.0, v[1] / speed + 0.0);
    if (v[2] != 0) printf(", %.3g", v[2] / speed);
    putchar(')');
  }
  if (isfinite(gap)) {
    print_quantity(", ", pl_fmax(gap, 0), "m from");
    printf(" `%s`", r->deck->lattices[lattice].name);
  }
  putchar('\n');
}

/* "accepted   patch of `beams`: as published" */
static void announce_accepted(const run *r) {
  const char *check, *why;
  for (int n = 0; n < r->open_models; n++) {
    const law *l = r->models[n].law;
    for (int k = 0; l && law_says(l, k, &check, &why); k++)
      printf("  accepted   %s of `%s`: %s\n", check, l->tree->name, why);
  }
}

void announce(const run *r) {
  const deck_simulation *s = &simulation_deck(r->simulation)->simulation;
  char when[TIME_TEXT];
  printf("%s\n", s->title ? s->title : r->options->deck_path);
  for (int k = 0; k < r->deck->lattice_count; k++) {
    if (deck_lattice_is_mesh(&r->deck->lattices[k])) {
      announce_mesh(r, k);
      continue;
    }
    announce_body(r, k);
    announce_ties(r, k);
    announce_notches(r, k);
    announce_laws(r, k);
  }
  announce_accepted(r);
  announce_start(r);
  for (int p = 0; p < r->deck->point_mass_count; p++)
    announce_point_mass(r, p);
  for (int k = 0; k < r->deck->stamp_count; k++)
    announce_stamp(r, k);
  for (int f = 0; f < r->deck->force_count; f++)
    if (r->deck->forces[f].per_length) announce_line_load(r, f);
  if (r->deck->relaxation.increments > 0)
    announce_increments(r);
  else
    printf("  time       %s in %ld steps of ", time_text(s->end_time, 6, when),
           simulation_step_count(r->simulation));
  if (!r->deck->relaxation.solved) announce_step(r);
  announce_shrinking(r);
  announce_frequencies(r);
  printf("  machine    %d thread%s, %.1f MiB\n", simulation_threads(r->simulation),
         simulation_threads(r->simulation) == 1 ? "" : "s",
         simulation_memory(r->simulation) / 1048576.0);
  printf("  result     %s\n", r->result_path);
  fflush(stdout);
}
