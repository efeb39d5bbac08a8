#include "generator/report/report_trust.h"

#include <math.h>
#include <stdio.h>

#include "generator/plan/plan.h"
#include "generator/report/moment.h"
#include "generator/report/run_cracks.h"
#include "generator/report/run_series.h"

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
    else if (r->deck->simulation.shrink_every > 0)
      fprintf(
          stderr,
          "perilat: warning: from %s on steps were longer than is safe, until the next look: a "
          "point of `%s` had\n  become stiffer. Look more often, with a smaller `shrink_every`, "
          "or begin with a smaller `step_safety`\n",
          when, name);
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
  const double step = simulation_step_now(r->simulation);
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

/* Where the balance is not kept, the work of rest states that change stands among what states have
   taken. */
static bool rest_works(const run *r) {
  const char *unchecked;
  bool some = false;
  simulation_imbalance(r->simulation, &unchecked);
  for (int k = 0; k < r->deck->interaction_count && unchecked; k++)
    some = some || (r->model_of[k] && r->model_of[k]->plan->variation.before_count > 0) ||
           (r->model_of[k] && r->model_of[k]->plan->law->rest);
  return some;
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
    if (!(lost < -1e-3 * scale) || (k == 0 && (cracks_have_grown(r) || rest_works(r)))) continue;
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
  const char *unchecked;
  simulation_imbalance(r->simulation, &unchecked);
  const double left =
      fabs(last_value(r, "energy/imbalance")) / simulation_largest_energy(r->simulation);
  if (unchecked || !isfinite(left) || left <= MUCH_IMBALANCE || !keeps_energy(r)) return;
  fprintf(stderr,
          "perilat: warning: " IMBALANCE_WARNED ": in the end %.2g %% of the largest energy "
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

/* The part of the work that may be damped without a warning. Limit loads of laws that yield are far
   too low long before it is a tenth: under a punch on a block of `von_mises` in plane strain
   without hardening by 59 % with a part of 0.1 (6 increments), by 7 % with 0.02 (40), by 1 % with
   0.004. */
static double part_damped(const run *r) {
  for (int n = 0; n < r->deck->interaction_count; n++)
    if (yields(r->laws[n].law)) return 0.01;
  return 0.1;
}

/* What the relaxation took from a body whose law remembers: its states on the way are those of a
   body that moves. */
static void warn_of_damping(const run *r) {
  const double work = fabs(last_value(r, "energy/external")),
               largest = simulation_largest_energy(r->simulation);
  const bool by_itself = unless_nothing(work, largest) == 0; /* nothing loads it: it grows */
  const double part = part_damped(r), whole = by_itself ? largest : work,
               damping = last_value(r, "energy/dissipated_damping"),
               damage = unless_nothing(last_value(r, "energy/dissipated_damage"), whole);
  if (r->deck->relaxation.increments == 0 || !(damping > part * whole) || damage == 0) return;
  fprintf(
      stderr,
      "perilat: warning: the relaxation damped %.3g J, %.2g %% of %s: the body moved\n"
      "  within increments, and what broke or yielded then may depend on how many there are, the "
      "load that it bears, too;\n"
      "  take more increments: run it again with `relaxation.increments=%d` and compare. What "
      "stays the same was set free by the body "
      "itself, as it broke\n",
      damping, 100 * damping / whole,
      by_itself ? "the largest energy" : "the work of loads and drives",
      2 * r->deck->relaxation.increments);
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

/* Within an increment steps stay as they are. */
static void tell_stiffening(const run *r) {
  long unbalanced;
  const double stiffer = simulation_stiffened(r->simulation);
  const step_limit *limit = simulation_step_limit(r->simulation);
  const double part = limit->step / limit->limit;
  if (r->deck->relaxation.increments == 0 || r->deck->relaxation.solved) return;
  const long done = simulation_increments(r->simulation, &unbalanced);
  if (stiffer > 1.01)
    fprintf(stderr, "  after increment %ld the body was %.3g times as stiff as at rest;", done,
            stiffer);
  else if (done == 0)
    fputs("  the law may have stiffened in the first increment, by its age or by strain;", stderr);
  else
    return;
  fprintf(stderr,
          " within one increment steps of %.3g of the\n  longest stable one bear %.3g times the "
          "stiffness: take more `increments`, or a smaller `step_safety`\n",
          part, 1 / (part * part));
}

void tell_of_steps(const run *r, bool failed) {
  if (failed) tell_stiffening(r);
  tell_stiffness(r, failed);
  tell_growth(r, failed);
}

void warn_of_doubts(const run *r) {
  warn_of_gain(r);
  warn_of_imbalance(r);
  warn_of_damping(r);
  warn_of_overlap(r);
  warn_of_damaged_ties(r);
  if (!simulation_bad(r->simulation).what[0]) tell_of_steps(r, false);
}
