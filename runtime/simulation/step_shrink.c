#include "runtime/simulation/step_shrink.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/continuum/cells_engine.h"
#include "runtime/continuum/tips.h"
#include "runtime/loads/load_steps.h"

bool step_shrink_due(const simulation *s) {
  const run_progress *at = &s->clock.at;
  if (s->relaxation) return at->status == STEP_OK && relaxation_stiffness_due(s->relaxation);
  const int every = s->deck->simulation.shrink_every;
  if (every == 0 || at->part > 0 || at->status != STEP_OK) return false;
  const bool due =
      at->step - at->step % every > at->looked || at->doubted || (s->contacts.near && !at->touched);
  return due &&
         !load_steps_jump(s->bodies[0].loads, s->bodies[0].body, (long)run_clock_parts(&s->clock));
}

/* --- what the bodies are like ----------------------------------------------------------------- */

static void observe(simulation *s) {
  const long parts = (long)run_clock_parts(&s->clock);
  for (int b = 0; b < s->body_count; b++)
    sweep_observe(s->bodies[b].state);
  for (int b = 0; b < s->body_count; b++)
    s->bodies[b].look = load_steps_observe(s->bodies[b].loads, s->bodies[b].body, parts);
}

static void watch_cells(const simulation *s) {
  for (int b = 0; b < s->body_count; b++) {
    const run_body *of = &s->bodies[b];
    if (of->cells)
      cells_watch_stiffness(of->cells, of->limit.step / of->limit.limit, run_clock_time(&s->clock));
  }
}

typedef struct ruling_body {
  double limit; /* s */
  int body;
  bool cracked;
} ruling_body;

/* Of all bodies the shortest limit now; *rest: at rest. */
static ruling_body shortest_limit(simulation *s, double *rest) {
  ruling_body found = {.limit = INFINITY};
  *rest = INFINITY;
  for (int b = 0; b < s->body_count; b++) {
    bool cracked;
    const double now = run_body_limit_here(&s->bodies[b], &cracked);
    *rest = pl_fmin(*rest, s->bodies[b].limit.limit);
    if (now < found.limit) found = (ruling_body){now, b, cracked};
  }
  return found;
}

/* --- another step ----------------------------------------------------------------------------- */

/* The step of all bodies is that of the clock. */
static void take_step(simulation *s) {
  for (int b = 0; b < s->body_count; b++) {
    run_body *of = &s->bodies[b];
    of->limit.step = run_clock_step(&s->clock);
    body_take_step(of->body, of->limit.step);
    if (of->cells && of->cells->tips)
      tips_shrink(of->cells->tips, INT64_C(1) << s->clock.at.halvings);
  }
}

void step_shrink_restored(simulation *s) {
  take_step(s);
}

typedef struct energies {
  double terms[LEDGER_COUNT];
} energies;

/* Of the state observed. False where they are none of a stable step. */
static bool find_energies(const simulation *s, energies *of) {
  bool sound = true;
  for (int b = 0; b < s->body_count; b++) {
    const run_body *at = &s->bodies[b];
    ledger copy = at->ledger;
    if (run_body_is_link(at))
      ledger_sample_link(&copy, &at->energies, at->body, 0, of[b].terms);
    else
      sound = ledger_sample(&copy, &at->energies, at->body, at->loads, &at->look,
                            run_body_highest_frequency(at), of[b].terms) &&
              sound;
  }
  return sound;
}

static void carry_energies(simulation *s, const energies *before, const energies *after) {
  for (int b = 0; b < s->body_count; b++)
    if (s->bodies[b].ledger.begun)
      ledger_carry(&s->bodies[b].ledger, before[b].terms, after[b].terms);
}

static void change_bodies(simulation *s, long parts, int64_t halvings) {
  s->clock.at.halvings = halvings;
  for (int b = 0; b < s->body_count; b++)
    if (!run_body_is_link(&s->bodies[b]))
      load_steps_change(s->bodies[b].loads, s->bodies[b].body, parts, run_clock_step(&s->clock),
                        (long)run_clock_parts(&s->clock));
  take_step(s);
  for (int b = 0; b < s->body_count; b++)
    if (s->bodies[b].cells && s->bodies[b].cells->tips)
      s->bodies[b].cells->tips->step = run_clock_parts(&s->clock);
  s->contacts.step = run_clock_parts(&s->clock);
}

void step_shrink_to(simulation *s, int64_t halvings, step_cause cause, int number) {
  run_progress *at = &s->clock.at;
  const size_t count = (size_t)s->body_count;
  energies *before = must_calloc(2 * count + 1, sizeof *before), *after = before + count;
  observe(s);
  find_energies(s, before);
  change_bodies(s, (long)run_clock_parts(&s->clock), halvings);
  observe(s);
  find_energies(s, after);
  carry_energies(s, before, after);
  free(before);
  s->observed_step = -1;
  at->changes[at->change_count++] =
      (step_change){.step = at->step, .halvings = halvings, .cause = cause, .body = number};
}

/* --- a look ----------------------------------------------------------------------------------- */

/* The part of the longest stable step that the present one may be: of steps that are halved the
   nearest to what is asked for, with half of what is left to the stable one in hand. */
static double part_allowed(const simulation *s) {
  const double part = pl_fmax(s->deck->simulation.step_safety, s->limit.step / s->limit.limit);
  return pl_fmin(M_SQRT2 * part, 0.5 * (1 + part));
}

static int64_t halvings_for(const simulation *s, double limit) {
  int64_t n = s->clock.at.halvings;
  while (n <= RUN_MOST_HALVINGS &&
         s->limit.step / (double)(INT64_C(1) << n) > part_allowed(s) * limit)
    n++;
  return n;
}

/* The energies of a sample were taken for those of steps that are too long; were they? */
static void settle_doubt(simulation *s, bool too_long) {
  energies *now = must_calloc((size_t)s->body_count + 1, sizeof *now);
  observe(s);
  if (!find_energies(s, now) || too_long) {
    bad_search_energy(s->bad, BAD_ENERGY);
    s->clock.at.status = STEP_BAD;
  }
  s->clock.at.doubted = 0;
  free(now);
}

/* *stiffer: the part of the longest stable step at rest that is left of it. */
static ruling_body look_at_bodies(simulation *s, double *stiffer) {
  double rest;
  observe(s);
  watch_cells(s);
  const ruling_body now = shortest_limit(s, &rest);
  s->observed_step = -1;
  *stiffer = now.limit < rest ? now.limit / rest : 1;
  return now;
}

static void fit_step(simulation *s) {
  run_progress *at = &s->clock.at;
  double stiffer;
  const ruling_body now = look_at_bodies(s, &stiffer);
  const bool meet = s->contacts.near && !at->touched;
  if (meet) at->touched = 1;
  const int64_t alone = halvings_for(s, stiffer * s->limit.limit),
                all = at->touched ? halvings_for(s, stiffer * s->touching) : alone;
  if (all > RUN_MOST_HALVINGS) {
    bad_search_step(s->bad, now.body);
    at->status = STEP_BAD;
  } else if (all > at->halvings) {
    const step_cause cause = meet && alone < all ? STEP_TOUCHED
                             : now.cracked       ? STEP_CRACKED
                                                 : STEP_STIFFER;
    step_shrink_to(s, all, cause, now.body);
  }
}

/* The body is at rest, and its next increment has not begun. The step may be half way from the part
   of the stable one that the run began with to the stable one. */
static void fit_increment(simulation *s) {
  const double part = s->limit.step / s->limit.limit;
  double stiffer;
  look_at_bodies(s, &stiffer);
  relaxation_state *state = &s->relaxation->state;
  const double limit = relaxation_stiffness(s->relaxation, stiffer) * s->limit.limit;
  if (!(limit > 0) || run_clock_step(&s->clock) <= 0.5 * (1 + part) * limit) return;
  state->step = part * limit;
  take_step(s);
  relaxation_next(s->relaxation, s->clock.at.step);
}

void step_shrink_look(simulation *s) {
  if (s->relaxation) {
    fit_increment(s);
    return;
  }
  fit_step(s);
  s->clock.at.looked = s->clock.at.step;
  if (s->clock.at.doubted && s->clock.at.status == STEP_OK) settle_doubt(s, false);
}

void step_shrink_settle(simulation *s) {
  double stiffer;
  if (!s->clock.at.doubted || s->clock.at.status == STEP_BAD) return;
  look_at_bodies(s, &stiffer);
  settle_doubt(s, run_clock_step(&s->clock) >
                      stiffer * (s->clock.at.touched ? s->touching : s->limit.limit));
}
