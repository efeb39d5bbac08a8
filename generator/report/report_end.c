#include "generator/report/report_end.h"

#include <math.h>
#include <stdio.h>

#include "dsl/base/elementary.h"
#include "generator/report/moment.h"
#include "generator/report/print_quantity.h"
#include "generator/report/report_mesh.h"
#include "generator/report/report_trust.h"
#include "generator/report/run_cracks.h"
#include "generator/report/run_series.h"

/* Work of contacts, stamps and links on bodies goes out in sum, but for rounding. */
static void conclude_energy(const run *r) {
  const double external = unless_nothing(last_value(r, "energy/external"),
                                         sample_of(r, "energy/kinetic", false)),
               imbalance = last_value(r, "energy/imbalance");
  const double rest = last_value(r, "energy/rest");
  if (!isfinite(external)) return;
  printf("  energy     external work %.5g J", external);
  if (fabs(rest) > 0) printf(", of rest states and fields %.5g J", rest);
  printf(": kinetic %.3g, stored %.3g, dissipated by %s %.5g, by damping %.3g; ",
         last_value(r, "energy/kinetic"), last_value(r, "energy/stored"), lost_to(r),
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
  const long within = simulation_increments_within(r->simulation);
  if (within > 0)
    printf("             in %ld of them hardly anything acted on the body: compared with 1e-5 of "
           "the forces between its particles\n",
           within);
  const double step = simulation_step_now(r->simulation),
               planned = simulation_step_limit(r->simulation)->step;
  if (step < planned)
    printf("  shrinks    to %.4g us: the body became %.3g times as stiff as at rest\n", 1e6 * step,
           simulation_stiffened(r->simulation));
  if (unbalanced > 0)
    printf("             %ld of them without balance after %ld steps\n", unbalanced,
           (long)r->deck->relaxation.most_steps);
}

static const char *const causes[] = {[STEP_STIFFER] = "had become stiffer",
                                     [STEP_CRACKED] = "was cut by cracks",
                                     [STEP_TOUCHED] = "particles came near to touch"};

/* "shrinks    to 0.02417 us, 1/2 of the first, at t = 0.0001 ms: particles came near to touch" */
static void conclude_changes(const run *r) {
  int count;
  const step_change *all = simulation_step_changes(r->simulation, &count);
  const double planned = simulation_step_limit(r->simulation)->step;
  if (r->deck->simulation.shrink_every > 0 && count == 0) puts("  shrinks    it did not have to");
  for (int k = 0; k < count; k++) {
    char text[MOMENT_TEXT];
    printf("  shrinks    to %.4g us, 1/%d of the first, at %s: ",
           1e6 * planned / (double)(INT64_C(1) << all[k].halvings), 1 << all[k].halvings,
           moment(r, planned * (double)all[k].step, text));
    if (all[k].cause != STEP_TOUCHED) printf("%s ", r->deck->lattices[all[k].body].name);
    puts(causes[all[k].cause]);
  }
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

/* "stamp      ball: at most 12 particles in touch at a time, 2.3 kN on it, 3.1 mm from where it was
   drawn". */
static void conclude_stamp(const run *r, int number) {
  const stamp_said s = simulation_stamp(r->simulation, number);
  printf("  stamp      %s: ", r->deck->stamps[number].name);
  if (s.touching == 0)
    fputs("nothing touched it", stdout);
  else
    printf("at most %ld particle%s in touch at a time", s.touching, s.touching == 1 ? "" : "s");
  if (s.touching > 0) print_quantity(", ", s.force, "N on it");
  const double way = pl_hypot(pl_hypot(s.place[0], s.place[1]), s.place[2]);
  if (way > 0)
    print_quantity(", ", way, "m from where it was drawn\n");
  else
    puts(", where it was drawn");
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
  conclude_changes(r);
  for (int k = 0; k < r->deck->monitor_count; k++)
    conclude_monitor(r, k);
  for (int k = 0; k < r->deck->contact_count; k++)
    conclude_contact(r, k);
  for (int k = 0; k < r->deck->stamp_count; k++)
    conclude_stamp(r, k);
  conclude_energy(r);
  conclude_cracks(r);
  conclude_deaths(r);
  fflush(stdout);
  warn_of_doubts(r);
}

void tell_result(const run *r) {
  long frames = (long)result_mark(r->result).count;
  printf("  written    %s (%ld frame%s) and its .xdmf for ParaView\n", r->result_path, frames,
         frames == 1 ? "" : "s");
}

/* "load was below 5 % of its peak", with `link` = " was "; "load above 5000 N", with " ". */
static void describe_event(const run *r, const deck_stop *s, const char *link, char *text,
                           size_t size) {
  const char *side = s->below ? "below" : "above", *unit_name;
  if (s->of_peak) {
    snprintf(text, size, "%s%s%s %.4g %% of its peak", s->monitor, link, side, 100 * s->level);
    return;
  }
  simulation_series(r->simulation, deck_find_monitor(r->deck, s->monitor), &unit_name, NULL);
  const bool pure = unit_is_pure(unit_name);
  snprintf(text, size, "%s%s%s %.6g%s%s", s->monitor, link, side, s->level, pure ? "" : " ",
           pure ? "" : unit_name);
}

/* "ended early at t = 25.9 ms: load was below 5 % of its peak". */
void print_stop(const run *r) {
  const deck_stop *s = simulation_stopped_by(r->simulation);
  if (!s) return;
  char text[MOMENT_TEXT], why[256];
  describe_event(r, s, " was ", why, sizeof why);
  printf("  ended early at %s: %s\n", moment(r, simulation_time(r->simulation), text), why);
}

void print_frames(const run *r) {
  for (int k = 0; k < r->deck->frame_count; k++) {
    const deck_frame *f = &r->deck->frames[k];
    const double came = simulation_frame_came(r->simulation, k);
    char text[MOMENT_TEXT], why[256];
    if (f->at_count > 0) continue;
    describe_event(r, &f->event, came < 0 ? " " : " was ", why, sizeof why);
    if (came < 0)
      printf("  no frame for %s: it never was\n", why);
    else
      printf("  frame at %s: %s\n", moment(r, came, text), why);
  }
}

void describe_end(const run *r, const run_end *end, char *text, size_t size) {
  const deck_stop *s = simulation_stopped_by(r->simulation);
  char now[MOMENT_TEXT], why[256] = "";
  moment(r, simulation_time(r->simulation), now);
  if (end->status == STEP_BAD) {
    const bad_state b = simulation_bad(r->simulation);
    snprintf(text, size, "failed at %s: %s in step %ld", now, b.what, b.step);
  } else if (end->status == STEP_STOPPED && s) {
    describe_event(r, s, " was ", why, sizeof why);
    snprintf(text, size, "stopped by &stop at %s: %s", now, why);
  } else if (end->status == STEP_OK)
    snprintf(text, size, "interrupted at %s%s", now, r->is_kept ? ": the run can be resumed" : "");
  else
    snprintf(text, size, "end of the run");
}
