/* How fast laws of families are: the state-based lattice for concrete on the hexagon, the elastic lattice on the
   face-centred cubic lattice with 18 neighbours, the linear peridynamic solid with 122, each on about 100 000 particles,
   one core, in processor time. The laws take turns, round after round.

     benchmark_families [result.json] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "generator/model.h"
#include "runtime/simulation.h"
#include "runtime/sweep.h"

enum { ROUNDS = 7, CONTESTANTS = 4 };
#define ROUND_SECONDS 0.3

typedef struct contestant {
  const char *key, *name, *model, *lattice, *body;
  law_setting setting;
  arena *memory;
  source_set sources;
  diagnostics said;
  deck *deck;
  model opened;
  double *parameters;
  rows *rows;
  sweep *state;
  long steps;
  double seconds[ROUNDS]; /* a step */
} contestant;

#define BOX(size)                                                                                  \
  "shape = 'box' corner = 0, 0, 0 size = '" size " mm', '" size " mm', '" size " mm'"
#define PLATE "shape = 'rectangle' corner = 0, 0 size = '3160 mm', '2740 mm'"

static contestant all[CONTESTANTS] = {
    {.key = "splm_concrete",
     .name = "splm_concrete, hexagon, 6 neighbours",
     .model = "splm_concrete",
     .lattice = "kind = 'hexagonal' thickness = '150 mm'",
     .body = PLATE},
    {.key = "splm_elastic_hexagon",
     .name = "splm_elastic, hexagon, 6 neighbours",
     .model = "splm_elastic",
     .lattice = "kind = 'hexagonal' thickness = '150 mm'",
     .body = PLATE},
    {.key = "splm_elastic_fcc",
     .name = "splm_elastic, face-centred cubic, 18 neighbours",
     .model = "splm_elastic",
     .lattice = "kind = 'fcc' shells = 2",
     .body = BOX("410"),
     .setting = SETTING_SPACE},
    {.key = "lps_cubic",
     .name = "lps, cubic, 122 neighbours",
     .model = "lps",
     .lattice = "kind = 'cubic' horizon = 3.015",
     .body = BOX("460"),
     .setting = SETTING_SPACE},
};

static void give_up(const char *why) {
  fprintf(stderr, "benchmark: %s\n", why);
  exit(1);
}

static void build_lattice(contestant *c) {
  char text[512];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n&lattice name = 'l' spacing = '10 mm' %s /\n"
           "&body lattice = 'l' %s /\n&material lattice = 'l' model = '%s' /\n",
           c->lattice, c->body, c->model);
  c->memory = arena_new();
  diag_begin(&c->said, &c->sources);
  int file = source_add(&c->sources, "deck", text, strlen(text));
  c->deck = deck_read(c->memory, &c->sources, file, NULL, 0, &c->said);
  c->rows = c->deck ? rows_build(c->deck, 0, &c->said) : NULL;
  diag_print(&c->said, stderr);
  if (!c->rows) give_up("the lattice cannot be built");
}

static const pl_law *compile(contestant *c) {
  char path[4096], error[4096];
  const char *note;
  snprintf(path, sizeof path, "%s/models/%s.plm", SOURCE_DIR, c->model);
  bool good = model_open(&c->opened, path, NULL, 0);
  if (good) c->opened.law->setting = c->setting;
  good = good && model_plan(&c->opened);
  diag_print(&c->opened.said, stderr);
  const pl_law *kernel = good ? model_kernel(&c->opened, false, &note, error, sizeof error) : NULL;
  if (!kernel) give_up(good ? error : "a law cannot be compiled");
  return kernel;
}

static double parameter(const contestant *c, const pl_law *kernel, const char *name) {
  for (int p = 0; p < kernel->parameter_count; p++)
    if (strcmp(kernel->parameters[p].name, name) == 0) return c->parameters[p];
  return 0;
}

/* Particles moved at random by 1e-6 spacings: elastic. */
static void move_particles(contestant *c) {
  uint64_t seed = 1;
  for (int d = 0; d < c->state->dof; d++)
    for (long p = 0; p < c->rows->particle_count; p++) {
      seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
      c->state->displacement[d][c->rows->particle_site[p]] =
          1e-6 * c->rows->spacing * ((double)(seed >> 11) * 0x1p-53 - 0.5);
    }
}

static void open_contestant(contestant *c) {
  build_lattice(c);
  const pl_law *kernel = compile(c);
  c->parameters = calloc((size_t)kernel->parameter_count + 1, sizeof *c->parameters);
  for (int p = 0; p < kernel->parameter_count; p++)
    c->parameters[p] = kernel->parameters[p].initial;
  c->rows->mass = parameter(c, kernel, "rho") * c->rows->volume;
  const double speed = sqrt(parameter(c, kernel, "E") / parameter(c, kernel, "rho"));
  c->state =
      sweep_new(c->rows, kernel, c->parameters, 0.1 * c->rows->spacing / speed, 1, false, false);
  move_particles(c);
}

static double processor_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double time_steps(contestant *c, long steps) {
  const double begun = processor_seconds();
  for (long k = 0; k < steps; k++)
    if (!sweep_step(c->state)) give_up("the motion went bad");
  return (processor_seconds() - begun) / (double)steps;
}

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

/* Million particle-steps a second: the median of the rounds. */
static double rate(contestant *c) {
  qsort(c->seconds, ROUNDS, sizeof *c->seconds, by_value);
  return 1e-6 * (double)c->rows->particle_count / c->seconds[ROUNDS / 2];
}

int main(int argc, char **argv) {
  for (int k = 0; k < CONTESTANTS; k++)
    open_contestant(&all[k]);
  const unsigned environment = sweep_enter();
  for (int k = 0; k < CONTESTANTS; k++) {
    const double once = time_steps(&all[k], 2);
    all[k].steps = once < ROUND_SECONDS ? (long)(ROUND_SECONDS / once) + 1 : 1;
  }
  for (int round = 0; round < ROUNDS; round++)
    for (int k = 0; k < CONTESTANTS; k++)
      all[k].seconds[round] = time_steps(&all[k], all[k].steps);
  sweep_leave(environment);
  FILE *json = argc > 1 ? fopen(argv[1], "w") : NULL;
  if (argc > 1 && !json) give_up("the result cannot be written");
  printf("million particle-steps a second, one core, processor time, medians of %d rounds\n",
         ROUNDS);
  for (int k = 0; k < CONTESTANTS; k++) {
    contestant *c = &all[k];
    const double million = rate(c);
    printf("  %-48s %8.2f   (%ld particles, %.3g ns a bond side)\n", c->name, million,
           c->rows->particle_count, 1e3 / million / (2 * c->rows->directions));
    if (json)
      fprintf(json, "%s\"%s_million_particle_steps_per_second\": %.6g", k ? ",\n  " : "{\n  ",
              c->key, million);
  }
  if (json) {
    fputs("\n}\n", json);
    fclose(json);
  }
  return 0;
}
