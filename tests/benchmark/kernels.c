/* How fast the compiled law is: the notched beam D6 at a spacing of 3.175 mm (Asadollahi 2014),
   free of loads, moved by a naive program, by a hand-written loop, by the generated kernel and by a
   whole run, in one process on one core.

   All but the whole run must reach the same motion from the same start before anything is timed.
   Each is then timed in turn, round after round, by the thread's processor time, so that neither a
   slow moment of the machine nor other programs favour one of them.

     benchmark_kernels [result.json] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "generator/model.h"
#include "runtime/simulation.h"
#include "tests/benchmark/handwritten.h"
#include "tests/benchmark/machine.h"
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

static void give_up(const char *why) {
  fprintf(stderr, "benchmark_kernels: %s\n", why);
  exit(EXIT_FAILURE);
}

static void sweep_set(void *state, const motion *from) {
  sweep *w = state;
  const size_t site = (size_t)w->lattice->size * sizeof(double);
  for (int d = 0; d < w->dof; d++) {
    memcpy(w->displacement[d], from->displacement[d], site);
    memcpy(w->velocity[d], from->velocity[d], site);
  }
  memcpy(w->field[0], from->damage, site * (size_t)w->lattice->directions);
}

static void sweep_get(const void *state, motion *to) {
  const sweep *w = state;
  const size_t site = (size_t)w->lattice->size * sizeof(double);
  for (int d = 0; d < w->dof; d++) {
    memcpy(to->displacement[d], w->displacement[d], site);
    memcpy(to->velocity[d], w->velocity[d], site);
  }
  memcpy(to->damage, w->field[0], site * (size_t)w->lattice->directions);
}

static void sweep_advance(void *state, long steps) {
  for (long step = 0; step < steps; step++)
    if (!sweep_step(state)) give_up("the generated kernel ran away");
}

static void run_set(void *state, const motion *from) {
  sweep_set(simulation_state(state), from);
}
static void run_get(const void *state, motion *to) {
  sweep_get(simulation_state((simulation *)state), to);
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
  deck *deck;
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
  b->deck = deck_read(b->memory, &b->sources, file, NULL, 0, &b->said);
  free(text);
  must_be_good(b, b->deck != NULL, "the deck cannot be read");
  b->deck->simulation.threads = 1;
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
  machine machine;
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

static double processor_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double time_steps(const contestant *c, const motion *start, long steps) {
  c->set(c->state, start);
  c->advance(c->state, SETTLING_STEPS);
  const double before = processor_seconds();
  c->advance(c->state, steps);
  return (processor_seconds() - before) / (double)steps;
}

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void summarise(contestant *c) {
  double sorted[ROUNDS];
  memcpy(sorted, c->seconds, sizeof sorted);
  qsort(sorted, ROUNDS, sizeof *sorted, by_value);
  c->median = sorted[ROUNDS / 2];
  c->spread = 0.5 * (sorted[ROUNDS - 1 - ROUNDS / 4] - sorted[ROUNDS / 4]) / c->median;
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

/* First line of /proc/cpuinfo that begins with `key`; "unknown" where there is none. */
static void processor_fact(const char *key, char *value, size_t size) {
  char line[4096];
  FILE *in = fopen("/proc/cpuinfo", "r");
  snprintf(value, size, "unknown");
  while (in && fgets(line, sizeof line, in)) {
    const char *colon = strchr(line, ':');
    if (strncmp(line, key, strlen(key)) != 0 || !colon) continue;
    snprintf(value, size, "%.*s", (int)strcspn(colon + 2, "\n\"\\"), colon + 2);
    break;
  }
  if (in) fclose(in);
}

static int vector_bits(void) {
#if defined(__AVX512F__)
  return 512;
#elif defined(__AVX__)
  return 256;
#else
  return 128;
#endif
}

static void print_table(const field *f) {
  const rows *g = f->beam->problem.lattice;
  char name[256], clock[64];
  processor_fact("model name", name, sizeof name);
  processor_fact("cpu MHz", clock, sizeof clock);
  printf("Notched beam D6, spacing %.4g mm: %ld particles, %ld bonds, %d rows\n", 1e3 * g->spacing,
         g->particle_count, g->bond_count, g->row_count);
  printf("%s, %s MHz as told, vectors of %d bits; %s; one core, medians of %d rounds\n", name,
         clock, vector_bits(), __VERSION__, ROUNDS);
  printf(
      "%d cores; one of them: triad %.1f GB/s (in cache %.0f), fused multiply-adds %.1f Gflop/s\n",
      f->machine.cores, 1e-9 * f->machine.triad, 1e-9 * f->machine.cached_triad,
      1e-9 * f->machine.fma);
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

static void write_json(const field *f, const char *path) {
  const rows *g = f->beam->problem.lattice;
  char name[256];
  FILE *out = fopen(path, "w");
  if (!out) {
    perror(path);
    exit(EXIT_FAILURE);
  }
  processor_fact("model name", name, sizeof name);
  fprintf(out, "{\n  \"processor\": \"%s\",\n  \"compiler\": \"%s\",\n  \"vector_bits\": %d,\n",
          name, __VERSION__, vector_bits());
  fprintf(out,
          "  \"cores\": %d,\n  \"triad_bytes_per_second\": %.4g,\n"
          "  \"cached_triad_bytes_per_second\": %.4g,\n  \"fma_flops_per_second\": %.4g,\n",
          f->machine.cores, f->machine.triad, f->machine.cached_triad, f->machine.fma);
  fprintf(out, "  \"particles\": %ld,\n  \"bonds\": %ld,\n  \"rounds\": %d", g->particle_count,
          g->bond_count, ROUNDS);
  for (int k = 0; k < f->count; k++) {
    const contestant *c = &f->items[k];
    fprintf(out, ",\n  \"%s_mbonds_per_second\": %.2f", c->name, 1e-6 * updates_per_second(f, c));
    fprintf(out, ",\n  \"%s_spread_percent\": %.2f", c->name, 100 * c->spread);
    fprintf(out, ",\n  \"%s_times_naive\": %.2f", c->name, f->items[0].median / c->median);
    if (k > 0 && c->same_motion)
      fprintf(out, ",\n  \"%s_difference\": %.3e,\n  \"%s_difference_turned\": %.3e", c->name,
              c->difference, c->name, c->difference_far);
  }
  fprintf(out, "\n}\n");
  if (fclose(out) != 0) give_up("the result cannot be written");
}

/* A comparison of programs that compute different things says nothing. */
static bool is_fair(const field *f) {
  bool fair = true;
  for (int k = 1; k < f->count; k++) {
    const contestant *c = &f->items[k];
    if (!c->same_motion || (c->difference <= AGREEMENT && c->difference_far <= FAR_AGREEMENT))
      continue;
    fprintf(stderr, "benchmark_kernels: %s moves otherwise than %s\n", c->name, f->items[0].name);
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

int main(int argc, char **argv) {
  beam b;
  beam_open(&b);
  const problem *p = &b.problem;
  const pl_law *kernel = b.law.law;
  naive *plain = naive_new(p);
  handwritten *best = handwritten_new(p), *fused = handwritten_fused_new(p);
  sweep *lean = sweep_new(p->lattice, kernel, b.law.parameters, p->time_step, 1, false, false);
  sweep *ledger = sweep_new(p->lattice, kernel, b.law.parameters, p->time_step, 1, true, false);
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
  f.machine = machine_measure();
  const unsigned environment = sweep_enter();
  compare(&f);
  if (handwritten_rare(best) == 0)
    give_up("the turned start does not reach the path of large rotations");
  measure(&f);
  sweep_leave(environment);
  print_table(&f);
  judge_yardstick(&f);
  if (argc > 1) write_json(&f, argv[1]);
  const bool fair = is_fair(&f);
  naive_free(plain);
  handwritten_free(best);
  handwritten_fused_free(fused);
  sweep_free(lean);
  sweep_free(ledger);
  beam_close(&b);
  return fair ? EXIT_SUCCESS : EXIT_FAILURE;
}
