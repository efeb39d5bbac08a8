/* How fast the compiled law is: the notched beam D6 at a spacing of 3.175 mm (Asadollahi 2014),
   free of loads, moved by a naive program, by a hand-written loop, by the generated kernel and by a
   whole run, in one process on one core.

   All but the whole run must reach the same motion from the same start before anything is timed.
   Each is then timed in turn, round after round, by the thread's processor time, so that neither a
   slow moment of the machine nor other programs favour one of them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/kernel/model.h"
#include "runtime/base/subnormals.h"
#include "runtime/deck/deck_read.h"
#include "runtime/interaction/interaction.h"
#include "runtime/simulation/simulation.h"
#include "tests/benchmark/handwritten.h"
#include "tests/benchmark/measure.h"
#include "tests/benchmark/naive.h"
#include "tests/benchmark/problem.h"

#define DECK  SOURCE_DIR "/examples/notched_beam/d6_s3.175.nml"
#define MODEL SOURCE_DIR "/models/mplm_bilinear.plm"

enum { ROUNDS = 11, SETTLING_STEPS = 50, MOST_CONTESTANTS = 8 };
#define ROUND_SECONDS   0.15
#define START_STRETCH   1e-4
#define AGREEMENT_STEPS 2000
#define AGREEMENT       1e-9 /* relative */
/* Turned by more than half a turn the particles stand 150 spacings away from their places: a
   rounding error of that in the start, which units other than metres make, is 3e-11 of a stretch of
   1e-3, and grows by the steps. */
#define FAR_TURN      3.5
#define FAR_STRETCH   1e-3
#define FAR_STEPS     200
#define FAR_AGREEMENT 1e-8
#define WANTED_ADVANTAGE                                                                           \
  15.0 /* of the hand-written loop over the naive program: else it is a poor yardstick */

/* --- what is measured ------------------------------------------------------------------------- */

typedef struct contestant {
  const char *name, *about;
  void *state;
  void (*set)(void *state, const motion *from);
  void (*get)(const void *state, motion *to);
  void (*advance)(void *state, long steps);
  bool same_motion; /* free of loads: must agree with the first */
  double difference, difference_far;
  long steps;             /* a round */
  double seconds[ROUNDS]; /* a step */
  double median, spread;  /* s; half the range of the middle half of the rounds over the median */
} contestant;

/* X(prefix, type): the functions of a contestant behind untyped pointers */
#define PROGRAMS(X) X(naive, naive) X(handwritten, handwritten) X(handwritten_fused, handwritten)
#define X(prefix, type)                                                                            \
  static void prefix##_set_any(void *state, const motion *from) {                                  \
    prefix##_set(state, from);                                                                     \
  }                                                                                                \
  static void prefix##_get_any(const void *state, motion *to) {                                    \
    prefix##_get(state, to);                                                                       \
  }                                                                                                \
  static void prefix##_advance_any(void *state, long steps) {                                      \
    prefix##_advance(state, steps);                                                                \
  }
PROGRAMS(X)
#undef X

static void sweep_set(void *state, const motion *from) {
  sweep *w = state;
  const size_t site = (size_t)w->body->lattice->size * sizeof(double);
  for (int d = 0; d < w->body->dof; d++) {
    memcpy(w->body->displacement[d], from->displacement[d], site);
    memcpy(w->body->velocity[d], from->velocity[d], site);
  }
  memcpy(w->field[0], from->damage, site * (size_t)w->body->lattice->directions);
}

static void sweep_get(const void *state, motion *to) {
  const sweep *w = state;
  const size_t site = (size_t)w->body->lattice->size * sizeof(double);
  for (int d = 0; d < w->body->dof; d++) {
    memcpy(to->displacement[d], w->body->displacement[d], site);
    memcpy(to->velocity[d], w->body->velocity[d], site);
  }
  memcpy(to->damage, w->field[0], site * (size_t)w->body->lattice->directions);
}

static void sweep_advance(void *state, long steps) {
  for (long step = 0; step < steps; step++)
    if (!sweep_step(state)) give_up("the generated kernel ran away");
}

static void run_set(void *state, const motion *from) {
  sweep_set(simulation_state(state, 0), from);
}
static void run_get(const void *state, motion *to) {
  sweep_get(simulation_state((simulation *)state, 0), to);
}

static void run_advance(void *state, long steps) {
  for (long until = simulation_step_done(state) + steps; simulation_step_done(state) < until;) {
    if (simulation_advance(state, until - simulation_step_done(state), NULL) != STEP_OK)
      give_up("the run ended early");
    if (simulation_frame_due(state)) simulation_frame_taken(state);
  }
}

/* --- the beam --------------------------------------------------------------------------------- */

typedef struct beam {
  source_set sources;
  diagnostics said;
  arena *memory;
  const deck *deck;
  model model;
  simulation_law law;
  simulation *run;
  problem problem;
} beam;

static void must_be_good(const beam *b, bool good, const char *what) {
  if (good) return;
  diag_print(&b->said, stderr);
  diag_print(&b->model.said, stderr);
  give_up(what);
}

static void read_deck(beam *b) {
  char error[512];
  size_t length;
  char *text = read_text_file(DECK, 1 << 20, &length, error, sizeof error);
  if (!text) give_up(error);
  const int file = source_add(&b->sources, DECK, text, length);
  const deck_override alone = {.text = "simulation.threads=1"};
  b->deck = deck_read(b->memory, &b->sources, file, &alone, 1, &b->said);
  free(text);
  must_be_good(b, b->deck != NULL, "the deck cannot be read");
}

static void compile_law(beam *b) {
  char error[4096];
  const char *note;
  must_be_good(b, model_open(&b->model, MODEL, NULL, 0) && model_plan(&b->model),
               "the law is faulty");
  b->law.law = model_kernel(&b->model, false, &note, error, sizeof error);
  if (!b->law.law) give_up(error);
  if (note) give_up(note);
  b->law.parameters = must_calloc((size_t)b->law.law->parameter_count + 1, sizeof(double));
  must_be_good(b,
               material_parameters(&b->deck->materials[0], b->law.law, b->law.parameters, &b->said),
               "the parameters do not fit the law");
}

static double parameter(const beam *b, const char *name) {
  for (int k = 0; k < b->law.law->parameter_count; k++)
    if (strcmp(b->law.law->parameters[k].name, name) == 0) return b->law.parameters[k];
  give_up("the law lacks a parameter");
  return 0;
}

static void beam_open(beam *b) {
  memset(b, 0, sizeof *b);
  b->memory = arena_new();
  diag_begin(&b->said, &b->sources);
  read_deck(b);
  compile_law(b);
  b->run = simulation_new(b->deck, &b->law, &b->said);
  must_be_good(b, b->run != NULL, "the deck does not fit");
  b->problem.lattice = simulation_rows(b->run, 0);
  b->problem.time_step = simulation_step_limit(b->run)->step;
#define X(name) b->problem.law.name = parameter(b, #name);
  X(E) X(nu) X(S_t) X(alpha1) X(alpha2) X(alpha3) X(beta) X(zeta) X(rate_0)
#undef X
}

static void beam_close(beam *b) {
  simulation_free(b->run);
  free(b->law.parameters);
  model_close(&b->model);
  diag_clear(&b->said);
  source_clear(&b->sources);
  arena_free(b->memory);
}

/* --- agreement -------------------------------------------------------------------------------- */

typedef struct field {
  beam *beam;
  contestant items[MOST_CONTESTANTS];
  int count;
  double damaged, softened; /* shares of bonds */
} field;

static double disagreement(const problem *p, const contestant *first, const contestant *other,
                           const motion *start, long steps) {
  motion a = motion_new(p->lattice), b = motion_new(p->lattice);
  first->set(first->state, start);
  first->advance(first->state, steps);
  first->get(first->state, &a);
  other->set(other->state, start);
  other->advance(other->state, steps);
  other->get(other->state, &b);
  const double difference = motion_difference(&a, &b, p->lattice);
  motion_free(&a);
  motion_free(&b);
  return difference;
}

/* From a shaken start, and for the paths of large rotations from one that is turned, too. */
static void compare(field *f) {
  const problem *p = &f->beam->problem;
  motion start = motion_new(p->lattice), turned = motion_new(p->lattice);
  motion_start(&start, p, START_STRETCH, 0);
  motion_start(&turned, p, FAR_STRETCH, FAR_TURN);
  for (int k = 1; k < f->count; k++) {
    contestant *c = &f->items[k];
    if (!c->same_motion) continue;
    c->difference = disagreement(p, &f->items[0], c, &start, AGREEMENT_STEPS);
    c->difference_far = disagreement(p, &f->items[0], c, &turned, FAR_STEPS);
  }
  f->items[0].set(f->items[0].state, &start);
  f->items[0].advance(f->items[0].state, AGREEMENT_STEPS);
  f->items[0].get(f->items[0].state, &turned);
  f->damaged = motion_damaged(&turned, p->lattice, 1e-12);
  f->softened = motion_damaged(&turned, p->lattice, 0.5);
  motion_free(&start);
  motion_free(&turned);
}

/* --- timing ----------------------------------------------------------------------------------- */

static double time_steps(const contestant *c, const motion *start, long steps) {
  c->set(c->state, start);
  c->advance(c->state, SETTLING_STEPS);
  const double before = processor_seconds();
  c->advance(c->state, steps);
  return (processor_seconds() - before) / (double)steps;
}

static void summarise(contestant *c) {
  c->median = median_of(c->seconds, ROUNDS);
  c->spread = spread_of(c->seconds, ROUNDS);
}

static void measure(field *f) {
  const problem *p = &f->beam->problem;
  motion start = motion_new(p->lattice);
  motion_start(&start, p, START_STRETCH, 0);
  for (int k = 0; k < f->count; k++) {
    contestant *c = &f->items[k];
    const double step = time_steps(c, &start, SETTLING_STEPS);
    c->steps = (long)(ROUND_SECONDS / step) + 1;
  }
  for (int round = 0; round < ROUNDS; round++)
    for (int k = 0; k < f->count; k++)
      f->items[k].seconds[round] = time_steps(&f->items[k], &start, f->items[k].steps);
  for (int k = 0; k < f->count; k++)
    summarise(&f->items[k]);
  motion_free(&start);
}

/* --- report ----------------------------------------------------------------------------------- */

static double updates_per_second(const field *f, const contestant *c) {
  return (double)f->beam->problem.lattice->bond_count / c->median;
}

static void print_table(const field *f) {
  const rows *g = f->beam->problem.lattice;
  printf("\nNotched beam D6, spacing %.4g mm: %ld particles, %ld bonds, %d rows\n",
         1e3 * g->spacing, g->particle_count, g->bond_count, g->row_count);
  printf("One core, medians of %d rounds. ", ROUNDS);
  printf("Shaken start: %.1f %% of the bonds damaged, %.1f %% above a half, after %d steps\n\n",
         100 * f->damaged, 100 * f->softened, AGREEMENT_STEPS);
  printf("%-22s %14s %9s %8s %9s %9s %11s %11s\n", "", "1e6 bonds/s", "ns/bond", "spread",
         "x naive", "of best", "difference", "turned");
  for (int k = 0; k < f->count; k++) {
    const contestant *c = &f->items[k];
    const double rate = updates_per_second(f, c);
    printf("%-22s %14.1f %9.2f %7.1f%% %9.1f %8.0f%%", c->about, 1e-6 * rate, 1e9 / rate,
           100 * c->spread, f->items[0].median / c->median, 100 * f->items[1].median / c->median);
    if (k > 0 && c->same_motion) printf(" %11.1e %11.1e", c->difference, c->difference_far);
    putchar('\n');
  }
}

static void add_figures(figures *to, const field *f) {
  for (int k = 0; k < f->count; k++) {
    const contestant *c = &f->items[k];
    figures_add(to, 1e-6 * updates_per_second(f, c), "mplm_bilinear_%s_million_bonds_per_second",
                c->name);
    figures_add(to, 100 * c->spread, "mplm_bilinear_%s_spread_percent", c->name);
    if (k > 0)
      figures_add(to, f->items[0].median / c->median, "mplm_bilinear_%s_times_naive", c->name);
    if (k > 0 && c->same_motion)
      figures_add(to, c->difference, "mplm_bilinear_%s_difference", c->name);
  }
  figures_add(to, f->items[1].median / f->items[3].median,
              "mplm_bilinear_generated_of_handwritten");
}

/* A comparison of programs that compute different things says nothing. */
static bool is_fair(const field *f) {
  bool fair = true;
  for (int k = 1; k < f->count; k++) {
    const contestant *c = &f->items[k];
    if (!c->same_motion || (c->difference <= AGREEMENT && c->difference_far <= FAR_AGREEMENT))
      continue;
    fprintf(stderr, "benchmark: %s moves otherwise than %s\n", c->name, f->items[0].name);
    fair = false;
  }
  return fair;
}

static void judge_yardstick(const field *f) {
  const double advantage = f->items[0].median / fmin(f->items[1].median, f->items[2].median);
  printf("\nThe better hand-written loop is %.1f times as fast as the naive program%s\n", advantage,
         advantage < WANTED_ADVANTAGE
             ? ", too little for a yardstick: a busy machine, or one with short vectors?"
             : ".");
}

bool benchmark_bonds(figures *to) {
  beam b;
  beam_open(&b);
  const problem *p = &b.problem;
  const pl_law *kernel = b.law.law;
  naive *plain = naive_new(p);
  handwritten *best = handwritten_new(p), *fused = handwritten_fused_new(p);
  sweep *lean =
      interaction_new(p->lattice, kernel, b.law.parameters, p->time_step, 1, false, false);
  sweep *ledger =
      interaction_new(p->lattice, kernel, b.law.parameters, p->time_step, 1, true, false);
#define CONTESTANT(prefix, about, state, same)                                                     \
  {#prefix, about, state, prefix##_set_any, prefix##_get_any, prefix##_advance_any, same, 0, 0, 0, \
   {0},     0,     0}
  field f = {.beam = &b,
             .count = 6,
             .items = {CONTESTANT(naive, "naive", plain, true),
                       CONTESTANT(handwritten, "hand-written", best, true),
                       CONTESTANT(handwritten_fused, "hand-written, fused", fused, true),
                       {.name = "generated",
                        .about = "generated",
                        .state = lean,
                        .set = sweep_set,
                        .get = sweep_get,
                        .advance = sweep_advance,
                        .same_motion = true},
                       {.name = "generated_ledger",
                        .about = "generated, ledger",
                        .state = ledger,
                        .set = sweep_set,
                        .get = sweep_get,
                        .advance = sweep_advance,
                        .same_motion = true},
                       {.name = "run",
                        .about = "whole run",
                        .state = b.run,
                        .set = run_set,
                        .get = run_get,
                        .advance = run_advance,
                        .same_motion = false}}};
  const unsigned environment = subnormals_off();
  compare(&f);
  if (handwritten_rare(best) == 0)
    give_up("the turned start does not reach the path of large rotations");
  measure(&f);
  subnormals_restore(environment);
  print_table(&f);
  judge_yardstick(&f);
  add_figures(to, &f);
  const bool fair = is_fair(&f);
  naive_free(plain);
  handwritten_free(best);
  handwritten_fused_free(fused);
  sweep_free(lean);
  sweep_free(ledger);
  beam_close(&b);
  return fair;
}
