#include "runtime/simulation/time_loop.h"

#include <math.h>

#include "dsl/base/elementary.h"
#include "runtime/base/clock.h"
#include "runtime/base/subnormals.h"
#include "runtime/continuum/cells_engine.h"
#include "runtime/loads/load_steps.h"
#include "runtime/simulation/step_shrink.h"

/* --- samples ---------------------------------------------------------------------------------- */

/* Steps of samples follow from whole numbers, so that a resumed run samples where the unbroken one
 * does. */
static int64_t sample_step(const simulation *s, int64_t k) {
  return llround((double)k * s->plan.sample_interval / s->limit.step);
}

static bool sample_due(const simulation *s) {
  return s->clock.at.step >= sample_step(s, s->clock.at.next_sample) ||
         s->clock.at.step == s->clock.step_count;
}

static int64_t next_sample(const simulation *s) {
  int64_t k = s->clock.at.next_sample;
  while (sample_step(s, k) <= s->clock.at.step)
    k++;
  return k;
}

/* As what moves the bodies counts steps. */
static long parts_done(const simulation *s) {
  return (long)run_clock_parts(&s->clock);
}

static void end_badly(simulation *s, const char *what) {
  bad_search_energy(s->bad, what);
  s->clock.at.status = STEP_BAD;
}

static void add_up(const simulation *s) {
  double *sum = history_energies(&s->history);
  const int parts = s->body_count + s->contacts.count + s->stamps.count;
  if (parts == 1) return;
  for (int term = 0; term < LEDGER_COUNT; term++) {
    sum[term] = 0;
    for (int b = 0; b < parts; b++)
      sum[term] += history_energies_of(&s->history, b)[term];
  }
}

/* Energies that no stable step leads to. Where steps may shrink, a look tells. */
static void doubt(simulation *s) {
  if (s->deck->simulation.shrink_every > 0)
    s->clock.at.doubted = 1;
  else
    end_badly(s, BAD_ENERGY);
}

/* Of laws beside the first one of a body. */
static void sample_laws(simulation *s) {
  int number = 0;
  for (int b = 0; b < s->body_count; b++)
    for (int n = 1; n < s->bodies[b].law_count; n++) {
      double *terms = history_energies_of_law(&s->history, number++);
      terms[HISTORY_LAW_STORED] = ledger_stored_by(s->bodies[b].laws[n].state);
      terms[HISTORY_LAW_TAKES] = ledger_taken_by(s->bodies[b].laws[n].state);
    }
}

/* Energies of the state observed; they tell of a run that has gone wrong. */
static void sample_energies(simulation *s) {
  const bool last = run_clock_position(&s->clock) == run_clock_end(&s->clock);
  for (int k = 0; k < s->link_count; k++) {
    run_body *of = s->links[k].own;
    ledger_sample_link(&of->ledger, &of->energies, of->body, s->links[k].work,
                       history_energies_of(&s->history, (int)(of - s->bodies)));
  }
  for (int k = 0; k < s->contacts.count; k++) {
    run_contact *of = &s->contacts.items[k];
    ledger_sample_contact(&of->ledger, contact_stored(of->found), of->work,
                          history_energies_of(&s->history, s->body_count + k));
  }
  for (int k = 0; k < s->stamps.count; k++) {
    const stamp_energies e = run_stamp_energies(&s->stamps, k, parts_done(s));
    ledger_sample_stamp(&s->stamps.items[k].state.ledger, &e,
                        history_energies_of(&s->history, s->body_count + s->contacts.count + k));
  }
  for (int b = 0; b < s->body_count; b++) {
    run_body *of = &s->bodies[b];
    if (!run_body_is_link(of) &&
        !ledger_sample(&of->ledger, &of->energies, of->body, of->loads, &of->look,
                       run_body_highest_frequency(of), history_energies_of(&s->history, b)))
      doubt(s);
  }
  add_up(s);
  sample_laws(s);
  const double *terms = history_energies(&s->history);
  if (last && !isfinite(terms[LEDGER_KINETIC] + terms[LEDGER_STORED]))
    end_badly(s, "energies that are not finite");
}

/* Values of the state observed into the history. The end is sampled also when it lies between two
 * samples. */
static void take_sample(simulation *s) {
  run_progress *at = &s->clock.at;
  const double time = run_clock_time(&s->clock);
  monitors_sample(s->monitors, parts_done(s), time, s->history.sampled);
  at->stop = monitors_stop(s->monitors, time, s->history.sampled);
  if (at->stop >= 0) at->status = STEP_STOPPED;
  if (s->deck->output.energy) sample_energies(s);
  history_add(&s->history, at->samples++, time);
  at->next_sample = s->relaxation ? at->samples : next_sample(s);
  if (at->status == STEP_BAD ||
      frame_times_look(&s->frame_times, s->monitors, time, s->history.sampled, at) ||
      at->status != STEP_OK)
    s->go_on = false;
}

static void record_sample(simulation *s) {
  const double begun = s->profile ? monotonic_seconds() : 0;
  take_sample(s);
  if (s->profile) s->profile->sampled += monotonic_seconds() - begun;
}

/* --- time loop -------------------------------------------------------------------------------- */

static bool some_body_is_bad(const simulation *s) {
  for (int b = 0; b < s->body_count; b++)
    if (body_bad(s->bodies[b].body) >= 0) return true;
  return false;
}

/* The deck's time of the present places, for the laws, how far it has gone on from that of their
   states, and what they are given then. */
static void set_time(simulation *s) {
  for (int b = 0; b < s->body_count; b++) {
    body *of = s->bodies[b].body;
    of->time = load_clock_time(&s->bodies[b].loads->clock, of, parts_done(s));
    of->advance = of->time - of->reached;
    run_body_go_to(&s->bodies[b], of->time);
  }
}

static void find_contacts(simulation *s) {
  if (s->contacts.count > 0) run_contacts_find(&s->contacts, run_clock_parts(&s->clock));
  if (s->stamps.count > 0 && !run_stamps_find(&s->stamps, run_clock_parts(&s->clock)))
    end_badly(s, "a stamp that went too far");
}

/* --- ties ------------------------------------------------------------------------------------- */

/* Lattices tell what acts on their tied particles, then all loads of tied bodies act, and tied
   particles follow. */
static void tie_bodies(simulation *s) {
  const long step = parts_done(s);
  for (int n = 0; n < s->tie_count; n++)
    tie_steps_give(&s->ties[n]);
  for (int b = 0; b < s->body_count; b++) {
    const run_body *of = &s->bodies[b];
    if (!of->tied) continue;
    load_steps_take_ties(of->loads, of->body, step);
    for (int block = 0; block < of->body->block_count; block++)
      load_steps_apply(of->loads, of->body, block, step);
  }
  for (int n = 0; n < s->tie_count; n++)
    tie_steps_follow(&s->ties[n], true);
}

static void follow_ties(simulation *s) {
  for (int n = 0; n < s->tie_count; n++)
    tie_steps_follow(&s->ties[n], false);
}

static void see_ties(simulation *s) {
  for (int n = 0; n < s->tie_count; n++)
    tie_steps_see(&s->ties[n], parts_done(s));
}

static void look_at_ties(simulation *s) {
  int n = 0;
  for (int b = 0; b < s->body_count; b++)
    for (int k = 0; k < s->bodies[b].tie_count; k++)
      tie_steps_look(&s->ties[n++], &s->bodies[b].look, parts_done(s));
}

/* --- steps ------------------------------------------------------------------------------------ */

/* What one thread does after all have moved their rows and what is loaded in them. */
static void after_moving(simulation *s) {
  if (!some_body_is_bad(s)) tie_bodies(s);
  if (some_body_is_bad(s)) {
    bad_search_velocity(s->bad);
    s->clock.at.status = STEP_BAD;
    s->go_on = s->observe = false;
    return;
  }
  for (int b = 0; b < s->body_count; b++) {
    sweep_turn(s->bodies[b].state);
    s->bodies[b].body->reached = s->bodies[b].body->time;
    run_body_turn(&s->bodies[b]);
    load_steps_turn(s->bodies[b].loads, s->bodies[b].body, parts_done(s));
  }
  run_clock_go_on(&s->clock);
  set_time(s);
}

static bool goes_on(const simulation *s) {
  return s->clock.at.step < s->until && !step_shrink_due(s) && !(s->interrupted && *s->interrupted);
}

/* And when the forces of links are known, too. */
static void after_step(simulation *s) {
  const bool whole = s->clock.at.part == 0;
  find_contacts(s);
  s->go_on = s->clock.at.status == STEP_OK && (!whole || goes_on(s));
  s->observe = false;
  if (s->clock.at.status != STEP_OK) return;
  if (s->relaxation) {
    s->observe = relaxation_due(s->relaxation, s->clock.at.step);
    return;
  }
  if (!whole) {
    monitors_part(s->monitors, parts_done(s), s->clock.at.part == 1);
    return;
  }
  monitors_step(s->monitors, parts_done(s), 1L << s->clock.at.halvings);
  s->observe = sample_due(s) || monitors_due(s->monitors, (long)s->clock.at.step);
}

/* Quasi-static runs observe to see whether the body has come to rest. */
static void end_increment(simulation *s) {
  if (!relaxation_look(s->relaxation, s->clock.at.step)) return;
  monitors_look(s->monitors, parts_done(s), (long)run_clock_position(&s->clock));
  record_sample(s);
  if (run_clock_position(&s->clock) == run_clock_end(&s->clock))
    s->clock.at.status = s->clock.at.status == STEP_OK ? STEP_END : s->clock.at.status;
  else
    relaxation_next(s->relaxation, s->clock.at.step);
  if (s->clock.at.status != STEP_OK || frame_times_due(&s->frame_times) || step_shrink_due(s))
    s->go_on = false;
}

static void look_at_loads(simulation *s) {
  see_ties(s);
  for (int b = 0; b < s->body_count; b++)
    s->bodies[b].look = load_steps_observe(s->bodies[b].loads, s->bodies[b].body, parts_done(s));
  look_at_ties(s);
}

static void look_at_cells(simulation *s) {
  for (int b = 0; b < s->body_count; b++) {
    const run_body *of = &s->bodies[b];
    if (of->cells)
      cells_watch_stiffness(of->cells, of->limit.step / of->limit.limit, run_clock_time(&s->clock));
  }
}

/* Kinds of monitors that read places, velocities, forces and damage of the state observed. */
static const uint64_t READ_FORCES =
    UINT64_C(1) << MONITOR_REACTION | UINT64_C(1) << MONITOR_REACTIONS |
    UINT64_C(1) << MONITOR_APPLIED | UINT64_C(1) << MONITOR_DISPLACEMENT |
    UINT64_C(1) << MONITOR_VELOCITY | UINT64_C(1) << MONITOR_ACCELERATION |
    UINT64_C(1) << MONITOR_OPENING | UINT64_C(1) << MONITOR_DAMAGED | UINT64_C(1) << MONITOR_BROKEN;

/* Nobody wants energies, or what the law says beside. A frame looks once more. */
static bool wants_forces_alone(const simulation *s) {
  bool alone = !s->deck->output.energy && !s->relaxation;
  for (int k = 0; k < s->deck->monitor_count; k++)
    alone = alone && (READ_FORCES >> s->deck->monitors[k].kind & 1) != 0;
  return alone;
}

static void look_for_forces_alone(simulation *s, bool alone) {
  for (int b = 0; b < s->body_count; b++)
    s->bodies[b].body->forces_alone = alone;
}

static void after_observing(simulation *s) {
  look_at_loads(s);
  look_at_cells(s);
  s->observe = false;
  s->observed_step = wants_forces_alone(s) ? -1 : s->clock.at.step;
  look_for_forces_alone(s, false);
  if (s->relaxation && s->clock.at.step > 0) {
    end_increment(s);
    return;
  }
  monitors_look(s->monitors, parts_done(s), (long)run_clock_position(&s->clock));
  if (sample_due(s)) record_sample(s);
}

/* Adds the time from `begun` to now, and returns now; nothing where nothing is measured. */
static double add_time(const simulation *s, double begun, double *sum) {
  if (!s->profile) return 0;
  const double now = monotonic_seconds();
  *sum += now - begun;
  return now;
}

/* Tasks of the team: the stages of a step, those of links, then those of observing. */
static int first_of_links(const simulation *s) {
  return s->step_stages;
}
static int first_of_observing(const simulation *s) {
  return s->step_stages + s->link_stages;
}

/* A block of a body in a stage; some bodies have fewer stages. */
static void do_block(simulation *s, run_body *of, int task, int block) {
  const sweep_engine *engine = &of->state->engine;
  body_block *b = &of->body->blocks[block];
  double now = s->profile ? monotonic_seconds() : 0;
  if (task >= first_of_observing(s)) {
    const int stage = task - first_of_observing(s);
    if (stage < engine->observe_stages) engine->observe(of->state, stage, block);
    add_time(s, now, &b->observing);
    return;
  }
  if (task >= first_of_links(s)) {
    if (task == first_of_observing(s) - 1) load_steps_take_links(of->loads, of->body, block);
    return;
  }
  if (task >= engine->step_stages || run_body_is_link(of)) return;
  engine->step(of->state, task, block);
  now = add_time(s, now, &b->stepping);
  if (task < engine->step_stages - 1 || of->tied) return;
  load_steps_apply(of->loads, of->body, block, parts_done(s));
  add_time(s, now, &b->loading);
}

static void do_links(simulation *s, int stage, int block) {
  for (int k = 0; k < s->link_count && stage >= 0 && stage < s->link_stages; k++)
    run_link_step(&s->links[k], stage, block, s->blocks);
}

/* The blocks of one body after the other are dealt out to those of the team. */
static void do_stage(void *of, int task, int block) {
  simulation *s = of;
  do_links(s, task - first_of_links(s), block);
  for (int b = 0; b < s->body_count; b++) {
    run_body *at = &s->bodies[b];
    const int own = (block - at->first_block + s->blocks) % s->blocks;
    if (own < at->body->block_count) do_block(s, at, task, own);
  }
}

/* Blocks keep the times of what they do in steps only. */
static int next_task(simulation *s) {
  set_time(s);
  for (int b = 0; b < s->body_count; b++)
    s->bodies[b].body->timed = s->profile && !s->observe;
  if (s->observe) look_for_forces_alone(s, wants_forces_alone(s));
  return s->observe ? first_of_observing(s) : s->go_on ? 0 : TEAM_END;
}

/* What one thread does between stages; sampling counts its time for itself (record_sample). */
static void look_after(simulation *s, bool moved, bool stepped) {
  if (!moved && !stepped) after_observing(s);
  if (moved) after_moving(s);
  if (stepped && s->clock.at.status == STEP_OK) after_step(s);
}

static int after_stage(void *of, int task) {
  simulation *s = of;
  profile *p = s->profile;
  const bool moved = task == first_of_links(s) - 1, stepped = task == first_of_observing(s) - 1,
             observed = task == first_of_observing(s) + s->observe_stages - 1;
  if (!moved && !stepped && !observed) return task + 1;
  const double begun = p ? monotonic_seconds() : 0, sampled = p ? p->sampled : 0;
  if (p && stepped && !moved) p->loaded += begun - s->links_begun;
  look_after(s, moved, stepped);
  s->links_begun = add_time(s, begun + (p ? p->sampled - sampled : 0), p ? &p->loaded : NULL);
  return moved && !stepped && s->clock.at.status == STEP_OK ? task + 1 : next_task(s);
}

/* First frame after the present step bounds an advance; one that is due but not taken does not. */
static int64_t next_stop(const simulation *s, long steps) {
  const int64_t step = s->clock.at.step, end = s->clock.step_count;
  const int64_t until = steps < end - step ? step + steps : end;
  if (s->relaxation) return until;
  const int64_t frame = frame_times_next(&s->frame_times);
  return frame < until ? frame : until;
}

static void observe_all(simulation *s) {
  set_time(s);
  for (int b = 0; b < s->body_count; b++)
    sweep_observe(s->bodies[b].state);
}

/* What laws were given a step ago is that of their states. */
static void go_back(simulation *s) {
  for (int b = 0; b < s->body_count; b++) {
    run_body_go_to(&s->bodies[b], s->bodies[b].body->reached);
    run_body_turn(&s->bodies[b]);
  }
}

static void begin(simulation *s) {
  if (s->clock.at.begun) go_back(s);
  set_time(s);
  follow_ties(s);
  for (int k = 0; k < s->link_count; k++)
    run_link_begin(&s->links[k]);
  find_contacts(s);
  if (s->clock.at.begun) return;
  s->clock.at.begun = 1;
  if (s->relaxation) relaxation_begin(s->relaxation);
  for (int b = 0; b < s->body_count; b++)
    load_steps_begin(s->bodies[b].loads, s->bodies[b].body);
  if (s->relaxation) return;
  observe_all(s);
  see_ties(s);
  for (int b = 0; b < s->body_count; b++)
    load_steps_set_back(s->bodies[b].loads, s->bodies[b].body);
  run_stamps_set_back(&s->stamps);
  follow_ties(s);
  monitors_step(s->monitors, 0, 1);
}

void time_loop_observe(simulation *s) {
  begin(s);
  if (s->observed_step == s->clock.at.step) return;
  observe_all(s);
  look_at_loads(s);
  s->observed_step = s->clock.at.step;
}

static void run_team(simulation *s) {
  const team_work work = {.of = s, .block = do_stage, .next = after_stage};
  team_begin(s->team, next_task(s));
#pragma omp parallel num_threads(s->blocks)
  {
    const unsigned environment = subnormals_off();
    team_join(s->team, &work);
    subnormals_restore(environment);
  }
}

/* --- static runs ------------------------------------------------------------------------------ */

static bool is_pushed(const simulation *s) {
  bool some = false;
  for (int b = 0; b < s->body_count; b++)
    some = some || mesh_rest_is_pushed(s->bodies[b].rest);
  return some;
}

/* Points push where they have a stress without strain: as they were, and as they are given to be at
   the end of the increment. */
static void begin_increment(simulation *s, bool pushed) {
  const load_clock clock = relaxation_clock(s->relaxation, s->clock.at.step);
  if (pushed && s->observed_step != s->clock.at.step) observe_all(s);
  for (int b = 0; b < s->body_count; b++) {
    mesh_rest_begin(s->bodies[b].rest, clock);
    s->bodies[b].body->reached = s->bodies[b].body->time;
    run_body_turn(&s->bodies[b]);
  }
  s->clock.at.step++;
  if (pushed) observe_all(s);
  for (int b = 0; b < s->body_count; b++)
    mesh_rest_see_given(s->bodies[b].rest, false);
}

/* An increment: places, what is seen there, a sample. */
static void stand(simulation *s) {
  double unbalance = 0;
  begin_increment(s, is_pushed(s));
  for (int b = 0; b < s->body_count; b++)
    unbalance = pl_fmax(unbalance, mesh_rest_solve(s->bodies[b].rest));
  relaxation_solved(s->relaxation, unbalance);
  observe_all(s);
  look_at_loads(s);
  s->observed_step = s->clock.at.step;
  for (int b = 0; b < s->body_count; b++) {
    mesh_rest_work(s->bodies[b].rest);
    mesh_rest_see_given(s->bodies[b].rest, true);
    cells_look_at_tips(s->bodies[b].state);
  }
  monitors_look(s->monitors, parts_done(s), (long)run_clock_position(&s->clock));
  record_sample(s);
  if (run_clock_position(&s->clock) == run_clock_end(&s->clock) && s->clock.at.status == STEP_OK)
    s->clock.at.status = STEP_END;
}

/* Up to the next frame; one that is due but not taken holds nothing up. */
static void stand_on(simulation *s) {
  bool more = s->clock.at.status == STEP_OK && !(s->interrupted && *s->interrupted);
  while (more) {
    stand(s);
    more = s->clock.at.status == STEP_OK && !frame_times_due(&s->frame_times) &&
           !(s->interrupted && *s->interrupted);
  }
}

/* The team has stopped for a look at the step, and not for a frame that has come: since `event`, or
   in a quasi-static run since the beginning, when none was due. */
static bool is_held_up(const simulation *s, int64_t event, bool due) {
  const bool frame = s->relaxation && !due && frame_times_due(&s->frame_times);
  return step_shrink_due(s) && !frame && s->clock.at.step < s->until &&
         s->clock.at.event == event && !(s->interrupted && *s->interrupted);
}

static bool has_ended(const simulation *s) {
  return s->clock.at.step == s->clock.step_count || s->clock.at.status == STEP_STOPPED;
}

step_status time_loop_run(simulation *s, long steps, const volatile sig_atomic_t *interrupted) {
  if (s->clock.at.status != STEP_OK) return (step_status)s->clock.at.status;
  s->until = next_stop(s, steps);
  s->interrupted = interrupted;
  const double begun = s->profile ? monotonic_seconds() : 0;
  begin(s);
  s->go_on = goes_on(s);
  s->observe = s->clock.at.samples == 0;
  const bool solved = s->relaxation && s->relaxation->deck->solved;
  const int64_t event = s->clock.at.event;
  const bool due = frame_times_due(&s->frame_times);
  if (solved) s->go_on = false;
  run_team(s);
  while (is_held_up(s, event, due)) {
    step_shrink_look(s);
    s->go_on = s->clock.at.status == STEP_OK; /* a look is followed by a step */
    run_team(s);
  }
  if (solved && s->clock.at.event == event) stand_on(s);
  if (has_ended(s)) step_shrink_settle(s);
  if (s->profile) {
    s->profile->elapsed += monotonic_seconds() - begun;
    profile_sum(s->profile, s->bodies, s->body_count, s->blocks);
  }
  if (s->clock.at.status == STEP_OK && has_ended(s)) s->clock.at.status = STEP_END;
  return (step_status)s->clock.at.status;
}
