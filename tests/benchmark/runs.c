/* What runs cost besides the bonds themselves: threads, memory traffic, size, compiling, starting,
   frames, monitors, the energy ledger, and what reproducible arithmetic costs against -ffast-math.
   Mostly on plates of the bilinear micropolar law. */
#include <fcntl.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "generator/kernel/toolchain.h"
#include "generator/kernel/toolchain_compiler.h"
#include "tests/benchmark/measure.h"
#include "tests/benchmark/trial.h"

extern char **environ;

enum { ROUNDS = 7, FEW_ROUNDS = 5, PLATE = 100000, MOST_TRIALS = 4, TEXT = 4096 };
#define ROUND_SECONDS 0.15
#define LAW           "mplm_bilinear"

static const char *const on_two = "end_time = 10 step = '0.4 us' threads = 2";
static const char *const steady = "end_time = 10 step = '0.4 us' threads = 1";

/* --- runs in turn ----------------------------------------------------------------------------- */

static void advance(trial *t, long steps) {
  for (long until = simulation_step_done(t->run) + steps; simulation_step_done(t->run) < until;) {
    if (simulation_advance(t->run, until - simulation_step_done(t->run), NULL) != STEP_OK)
      give_up("a run ended early");
    if (simulation_frame_due(t->run)) simulation_frame_taken(t->run);
  }
}

typedef double (*seconds_function)(void);

/* Seconds a step of each, medians of rounds in turn. */
static void take_turns(trial *const *trials, int count, seconds_function seconds, double *median) {
  long steps[MOST_TRIALS];
  double taken[MOST_TRIALS][ROUNDS];
  for (int k = 0; k < count; k++) {
    advance(trials[k], 2);
    const double begun = seconds();
    advance(trials[k], 2);
    steps[k] = (long)(2 * ROUND_SECONDS / (seconds() - begun)) + 1;
  }
  for (int round = 0; round < ROUNDS; round++)
    for (int k = 0; k < count; k++) {
      const double begun = seconds();
      advance(trials[k], steps[k]);
      taken[k][round] = (seconds() - begun) / (double)steps[k];
    }
  for (int k = 0; k < count; k++)
    median[k] = median_of(taken[k], ROUNDS);
}

static trial *open_plate(double particles, const char *law_name, const char *keys,
                         const char *groups) {
  char text[TEXT];
  trial_plate_text(text, sizeof text, particles, law_name, keys, groups);
  return trial_open(text);
}

static void print_percent(const char *about, double part) {
  printf("  %-58s %8.1f %%\n", about, 100 * part);
}

/* --- threads ---------------------------------------------------------------------------------- */

static void measure_threads(figures *f) {
  double median[2];
  trial *t[2] = {open_plate(PLATE, LAW, steady, ""), open_plate(PLATE, LAW, on_two, "")};
  take_turns(t, 2, wall_seconds, median);
  printf("  %-58s %8.2f\n", "two threads against one, 100 000 particles, wall time",
         median[0] / median[1]);
  figures_add(f, median[0] / median[1], "threads_2_over_1");
  trial_close(t[0]);
  trial_close(t[1]);
}

/* Of small bodies; by the least of many short bursts in turn, since what others take from the
   machine counts for much there. */
static void measure_threads_of_few(figures *f, double particles, const char *name) {
  enum { BURSTS = 400 };
  static const double burst = 1e-3; /* s */
  double least[2] = {INFINITY, INFINITY};
  trial *t[2] = {open_plate(particles, LAW, steady, ""), open_plate(particles, LAW, on_two, "")};
  long steps = 20;
  for (int round = 0; round < BURSTS; round++)
    for (int k = 0; k < 2; k++) {
      const double begun = wall_seconds();
      advance(t[k], steps);
      least[k] = fmin(least[k], (wall_seconds() - begun) / (double)steps);
      if (round < 10 && k == 0) steps = (long)(burst / least[0]) + 1;
    }
  printf("  two threads against one, %-33s %8.2f\n", name, least[0] / least[1]);
  figures_add(f, least[0] / least[1], "threads_2_over_1_%.0f_particles", particles);
  trial_close(t[0]);
  trial_close(t[1]);
}

/* --- memory and arithmetic -------------------------------------------------------------------- */

/* What a step must move for a particle of a law of bonds while no damage grows: displacements,
   velocities and states of the bonds are read and written once, damage is read. Flags are shared by
   rows alike, and forces stay in buffers of a row. */
static double bytes_per_particle(const pl_law *kernel, int directions) {
  double bytes = 4.0 * kernel->dof * sizeof(double);
  for (int f = 0; f < kernel->field_count; f++)
    bytes += (kernel->fields[f].kind == PL_FIELD_DAMAGE ? 1.0 : 2.0) * directions * sizeof(double);
  return bytes;
}

static void measure_memory(figures *f) {
  const double particles = 4e6;
  double median, rate;
  trial *t = open_plate(particles, LAW, on_two, "&output energy = .false. /");
  const double bytes = bytes_per_particle(t->law.law, simulation_rows(t->run, 0)->directions),
               memory = simulation_memory(t->run);
  rate = (double)simulation_rows(t->run, 0)->particle_count;
  take_turns(&t, 1, wall_seconds, &median);
  rate *= bytes / median;
  trial_close(t);
  const double triad = triad_bandwidth((size_t)memory, 2);
  printf("  %-58s %8.0f\n", "bytes a particle that a step streams, no damage growing", bytes);
  printf("  %-58s %8.1f GB/s\n", "triad of two threads on as much memory (24 bytes a place)",
         1e-9 * triad);
  print_percent("share of it, 4 million particles, two threads", rate / triad);
  figures_add(f, bytes, "mplm_bilinear_bytes_per_particle");
  figures_add(f, 1e-9 * triad, "triad_gigabytes_per_second");
  figures_add(f, rate / triad, "mplm_bilinear_share_of_triad");
}

static void measure_arithmetic(figures *f) {
  double median;
  trial *t = open_plate(PLATE, LAW, steady, "&output energy = .false. /");
  const pl_law *kernel = t->law.law;
  take_turns(&t, 1, processor_seconds, &median);
  const double flops = (kernel->flops_per_bond + kernel->divisions_per_bond) *
                       (double)simulation_rows(t->run, 0)->bond_count / median;
  const double peak = fused_peak();
  trial_close(t);
  printf("  %-58s %8.1f GFLOP/s\n", "peak of fused multiply-adds, one core", 1e-9 * peak);
  print_percent("share of it, 100 000 particles, a division as one", flops / peak);
  figures_add(f, 1e-9 * peak, "fma_peak_gigaflops");
  figures_add(f, flops / peak, "mplm_bilinear_share_of_fma_peak");
}

static void measure_sizes(figures *f) {
  printf("  ns a particle-step, one core, by size of the body:\n   ");
  for (int power = 4; power <= 7; power++) {
    double median;
    trial *t = open_plate(pow(10, power), LAW, steady, "&output energy = .false. /");
    take_turns(&t, 1, processor_seconds, &median);
    const double each = 1e9 * median / (double)simulation_rows(t->run, 0)->particle_count;
    printf("  10^%d %.2f", power, each);
    figures_add(f, each, "mplm_bilinear_1e%d_nanoseconds_per_particle_step", power);
    trial_close(t);
  }
  putchar('\n');
}

/* --- compiling and starting ------------------------------------------------------------------- */

static double seconds_to_kernel(const char *name, int neighbours) {
  char error[4096];
  const char *note = NULL;
  model m;
  const double begun = wall_seconds();
  trial_open_model(&m, name, neighbours);
  if (!model_kernel(&m, false, &note, error, sizeof error)) give_up("%s", error);
  const double taken = wall_seconds() - begun;
  model_close(&m);
  return taken;
}

/* In an empty cache first, then from it; the caller's cache is put back. */
static void measure_compiling(figures *f, const char *name, int neighbours) {
  double cold[FEW_ROUNDS], warm[FEW_ROUNDS];
  const char *set = getenv("PERILAT_CACHE");
  char *before = set ? strdup(set) : NULL;
  for (int round = 0; round < FEW_ROUNDS; round++) {
    char folder[] = "/tmp/perilat-benchmark-XXXXXX", command[100];
    if (!mkdtemp(folder)) give_up("no folder for an empty cache");
    setenv("PERILAT_CACHE", folder, 1);
    cold[round] = seconds_to_kernel(name, neighbours);
    warm[round] = seconds_to_kernel(name, neighbours);
    snprintf(command, sizeof command, "rm -r %s", folder);
    if (system(command) != 0) give_up("%s stays behind", folder);
  }
  if (before)
    setenv("PERILAT_CACHE", before, 1);
  else
    unsetenv("PERILAT_CACHE");
  free(before);
  printf("  law to loaded kernel, %-36s %8.2f s, from the cache %.3f s\n", name,
         median_of(cold, FEW_ROUNDS), median_of(warm, FEW_ROUNDS));
  figures_add(f, median_of(cold, FEW_ROUNDS), "%s_law_to_kernel_seconds", name);
  figures_add(f, median_of(warm, FEW_ROUNDS), "%s_law_to_cached_kernel_seconds", name);
}

static double children_seconds(void) {
  struct rusage r;
  getrusage(RUSAGE_CHILDREN, &r);
  return (double)(r.ru_utime.tv_sec + r.ru_stime.tv_sec) +
         1e-6 * (double)(r.ru_utime.tv_usec + r.ru_stime.tv_usec);
}

/* `perilat run` of the deck in a folder of its own; quiet unless it fails. */
static void run_program(const char *folder, const char *deck_text) {
  char path[200], result[200], log[200];
  snprintf(path, sizeof path, "%s/deck.nml", folder);
  snprintf(result, sizeof result, "output.result=%s/out.h5", folder);
  snprintf(log, sizeof log, "%s/log", folder);
  FILE *out = fopen(path, "w");
  if (!out || fputs(deck_text, out) < 0 || fclose(out) != 0) give_up("%s cannot be written", path);
  char *const arguments[] = {PERILAT_PROGRAM, "run", path, "--set", result, NULL};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t child;
  int status = -1;
  const bool spawned = posix_spawn(&child, arguments[0], &actions, NULL, arguments, environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  if (!spawned || waitpid(child, &status, 0) != child || status != 0)
    give_up("perilat run failed: see %s", log);
}

static void remove_folder(const char *folder) {
  char command[200];
  snprintf(command, sizeof command, "rm -r %s", folder);
  if (system(command) != 0) give_up("%s stays behind", folder);
}

static void measure_start(figures *f, const char *folder) {
  double seconds[ROUNDS];
  char text[TEXT];
  trial_plate_text(text, sizeof text, 100, LAW, "step = '0.4 us' end_time = '0.4 us' threads = 1",
                   "");
  run_program(folder, text); /* fills the cache */
  for (int round = 0; round < ROUNDS; round++) {
    const double begun = wall_seconds();
    run_program(folder, text);
    seconds[round] = wall_seconds() - begun;
  }
  printf("  %-58s %8.3f s\n", "perilat run of a small deck, one step", median_of(seconds, ROUNDS));
  figures_add(f, median_of(seconds, ROUNDS), "start_up_seconds");
}

/* --- frames, monitors, ledger ----------------------------------------------------------------- */

enum { FRAME_STEPS = 1000, FRAMES = 20, FRAME_PLATE = 20000 };

/* Processor seconds of one `perilat run`, by frames; what starting and stopping costs is in both
   and falls out. */
static double run_seconds(const char *folder, int frames, long steps) {
  char text[TEXT], keys[100], groups[100];
  snprintf(keys, sizeof keys, "step = '0.4 us' end_time = '%.1f us' threads = 1",
           0.4 * (double)steps);
  snprintf(groups, sizeof groups, "&output frames = %d /", frames);
  trial_plate_text(text, sizeof text, FRAME_PLATE, LAW, keys, groups);
  const double before = children_seconds();
  run_program(folder, text);
  return children_seconds() - before;
}

static void measure_frames(figures *f, const char *folder) {
  double bare[FEW_ROUNDS], framed[FEW_ROUNDS], longer[FEW_ROUNDS];
  for (int round = 0; round < FEW_ROUNDS; round++) {
    bare[round] = run_seconds(folder, 0, FRAME_STEPS / 5);
    framed[round] = run_seconds(folder, FRAMES, FRAME_STEPS / 5);
    longer[round] = run_seconds(folder, 0, FRAME_STEPS + FRAME_STEPS / 5);
  }
  const double none = median_of(bare, FEW_ROUNDS);
  const double frame = (median_of(framed, FEW_ROUNDS) - none) / FRAMES;
  const double steps = median_of(longer, FEW_ROUNDS) - none;
  print_percent("a frame every 1000 steps, of 20 000 particles", frame / steps);
  figures_add(f, frame / steps, "frame_every_1000_steps");
}

/* A sample every 80 steps: a run of 160 000 steps has 2000. */
static void measure_sampling(figures *f) {
  static const char *const groups[] = {
      "&output energy = .false. /",
      "&support region = 'left' fix = 'x' /\n"
      "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' /\n"
      "&monitor name = 'opening' kind = 'opening' between = 'left', 'right' component = 'x' /\n"
      "&monitor name = 'cracks' kind = 'damaged' /\n"
      "&output energy = .false. sample = '32 us' /",
      "&output energy = .true. /", "&output energy = .true. sample = '32 us' /"};
  trial *t[4];
  double median[4];
  for (int k = 0; k < 4; k++)
    t[k] = open_plate(PLATE, LAW, steady, groups[k]);
  take_turns(t, 4, processor_seconds, median);
  print_percent("three monitors, a sample every 80 steps", median[1] / median[0] - 1);
  print_percent("energy ledger, no samples", median[2] / median[0] - 1);
  print_percent("energy ledger, a sample every 80 steps", median[3] / median[0] - 1);
  figures_add(f, median[1] / median[0] - 1, "monitors_overhead");
  figures_add(f, median[2] / median[0] - 1, "ledger_overhead");
  figures_add(f, median[3] / median[0] - 1, "ledger_and_samples_overhead");
  for (int k = 0; k < 4; k++)
    trial_close(t[k]);
}

/* What a sample costs, in steps without one: runs that sample in each step beside runs that do not;
   of monitors alone, and of these and the energies. */
static void measure_sample(figures *f, const char *name) {
  static const char *const some = "end_time = 0.2 step = '0.4 us' threads = 1";
  static const char *const monitors =
      "&support region = 'left' fix = 'x' /\n"
      "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' /\n"
      "&monitor name = 'opening' kind = 'opening' between = 'left', 'right' component = 'x' /\n";
  static const struct {
    const char *key, *keys;
  } kinds[] = {{"monitors", "energy = .false."}, {"energies", "energy = .true."}};
  for (int k = 0; k < 2; k++) {
    char groups[2][TEXT];
    double median[2];
    snprintf(groups[0], TEXT, "%s&output %s sample = '1 ms' /", monitors, kinds[k].keys);
    snprintf(groups[1], TEXT, "%s&output %s sample = '0.4 us' /", monitors, kinds[k].keys);
    trial *t[2] = {open_plate(FRAME_PLATE, name, some, groups[0]),
                   open_plate(FRAME_PLATE, name, some, groups[1])};
    take_turns(t, 2, processor_seconds, median);
    printf("  a sample of %s, in steps, %-30s %8.2f\n", kinds[k].key, name,
           median[1] / median[0] - 1);
    figures_add(f, median[1] / median[0] - 1, "%s_sample_of_%s_in_steps", name, kinds[k].key);
    trial_close(t[0]);
    trial_close(t[1]);
  }
}

/* --- reproducible arithmetic ------------------------------------------------------------------ */

/* The same C, allowed to reorder and to fuse. */
static const pl_law *compile_fast(model *m, const char *name, const char *folder,
                                  loaded_kernel *out) {
  char c_path[200], path[200], command[2000], error[2000];
  snprintf(c_path, sizeof c_path, "%s/%s.c", folder, name);
  snprintf(path, sizeof path, "%s/%s.so", folder, name);
  snprintf(command, sizeof command, "%s %s -ffast-math -ffp-contract=fast -o %s %s",
           toolchain_compiler(), toolchain_flags(), path, c_path);
  FILE *c = fopen(c_path, "w");
  if (!c || fputs(model_c_text(m), c) < 0 || fclose(c) != 0)
    give_up("%s cannot be written", c_path);
  if (system(command) != 0) give_up("failed: %s", command);
  if (!toolchain_open(path, NULL, out, error, sizeof error)) give_up("%s", error);
  return out->law;
}

static void measure_fast_math(figures *f, const char *name, const char *folder) {
  double median[2];
  loaded_kernel fast;
  trial *t[2] = {open_plate(PLATE, name, steady, "&output energy = .false. /"),
                 open_plate(PLATE, name, steady, "&output energy = .false. /")};
  simulation_free(t[1]->run);
  t[1]->law.law = compile_fast(&t[1]->model, name, folder, &fast);
  t[1]->run = simulation_new(t[1]->deck, &t[1]->law, &t[1]->said);
  if (!t[1]->run) give_up("a kernel compiled with -ffast-math does not run");
  trial_shake(simulation_state(t[1]->run, 0));
  take_turns(t, 2, processor_seconds, median);
  printf("  as fast as with -ffast-math, %-29s %8.2f\n", name, median[1] / median[0]);
  figures_add(f, median[1] / median[0], "%s_of_fast_math", name);
  trial_close(t[0]);
  trial_close(t[1]);
  toolchain_unload(&fast);
}

bool benchmark_runs(figures *f) {
  char folder[] = "/tmp/perilat-benchmark-XXXXXX";
  if (!mkdtemp(folder)) give_up("no folder for runs");
  printf("\nRuns (%s where nothing else is said)\n", LAW);
  measure_threads(f);
  measure_threads_of_few(f, 8000, "8000 particles, least times");
  measure_threads_of_few(f, 1000, "1000 particles, least times");
  measure_memory(f);
  measure_arithmetic(f);
  measure_sizes(f);
  measure_compiling(f, LAW, 0);
  measure_compiling(f, "splm_concrete", 6);
  measure_start(f, folder);
  measure_frames(f, folder);
  measure_sampling(f);
  measure_sample(f, LAW);
  measure_sample(f, "splm_concrete");
  measure_sample(f, "splm_elastic");
  measure_fast_math(f, LAW, folder);
  measure_fast_math(f, "splm_elastic", folder);
  remove_folder(folder);
  return true;
}
