/* The same bits from the `perilat` command: for any number of threads, after a kill and a resume,
   after Ctrl-C and a resume, from the interpreter; and what it does with a step that is too large.
 */
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "runtime/result/hdf5_tools.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"

#define DECK SOURCE_DIR "/examples/notched_beam/d3_s6.35.nml"

enum { MOST_ARGUMENTS = 24, MOST_RUNS = 16 };

/* --- the command ------------------------------------------------------------------------------ */

typedef struct command {
  const char *words[MOST_ARGUMENTS];
  int count;
} command;

static char folder[] = "/tmp/perilat-reproducible-XXXXXX";
static char stored_paths[MOST_RUNS][128];
static int stored_count;

/* PATH of a file in the test's own folder. */
static const char *in_folder(const char *name) {
  assert_true(stored_count < MOST_RUNS);
  char *path = stored_paths[stored_count++];
  snprintf(path, sizeof stored_paths[0], "%s/%s", folder, name);
  return path;
}

static const char *beside(const char *target, const char *ending) {
  static char path[256];
  snprintf(path, sizeof path, "%s%s", target, ending);
  return path;
}

static bool exists(const char *path) {
  struct stat info;
  return stat(path, &info) == 0;
}

static command run_command(void) {
  return (command){{PERILAT_PROGRAM, "run", DECK}, 3};
}

static void add(command *c, const char *word) {
  assert_true(c->count < MOST_ARGUMENTS - 1);
  c->words[c->count++] = word;
}

static void set(command *c, const char *assignment) {
  add(c, "--set");
  add(c, assignment);
}

static void set_result(command *c, const char *target, char *text, size_t size) {
  snprintf(text, size, "output.result=%s", target);
  set(c, text);
}

/* Starts the command; what it says goes to LOG. */
static pid_t start(const command *c, const char *log) {
  const pid_t child = fork();
  assert_true(child >= 0);
  if (child) return child;
  const int out = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(out, STDOUT_FILENO);
  dup2(out, STDERR_FILENO);
  execv(c->words[0], (char *const *)c->words);
  _exit(127);
}

static void show(const char *log) {
  FILE *in = fopen(log, "r");
  char line[512];
  while (in && fgets(line, sizeof line, in))
    fputs(line, stderr);
  if (in) fclose(in);
}

/* Exit status, or -signal. */
static int wait_for(pid_t child) {
  int status;
  assert_int_equal(waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

static int finish(const command *c, const char *log) {
  return wait_for(start(c, log));
}

static void must_finish(const command *c) {
  const char *log = beside(folder, "/log");
  if (finish(c, log) == 0) return;
  show(log);
  fail_msg("the run did not succeed");
}

static bool log_has(const char *log, const char *text) {
  FILE *in = fopen(log, "r");
  char line[1024];
  bool found = false;
  while (in && fgets(line, sizeof line, in))
    found = found || strstr(line, text);
  if (in) fclose(in);
  return found;
}

static void nap(void) {
  nanosleep(&(struct timespec){0, 1000000}, NULL);
}

/* --- comparing results ------------------------------------------------------------------------ */

typedef struct comparison {
  hid_t other;
  long sets, numbers, different;
} comparison;

/* Values of a data set as doubles; NULL when it is none. */
static double *values_of(hid_t file, const char *path, hsize_t shape[4], int *rank) {
  const hid_t object = H5Oopen(file, path, H5P_DEFAULT);
  if (object < 0 || H5Iget_type(object) != H5I_DATASET) {
    if (object >= 0) H5Oclose(object);
    return NULL;
  }
  const hid_t space = H5Dget_space(object);
  *rank = H5Sget_simple_extent_ndims(space);
  memset(shape, 0, 4 * sizeof *shape);
  assert_true(*rank >= 1 && *rank <= 4);
  H5Sget_simple_extent_dims(space, shape, NULL);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  double *values = calloc((size_t)count + 1, sizeof *values);
  assert_true(H5Dread(object, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  H5Sclose(space);
  H5Oclose(object);
  return values;
}

static herr_t compare_set(hid_t file, const char *name, const H5L_info_t *info, void *context) {
  (void)info;
  comparison *c = context;
  hsize_t shape[4], others[4];
  int rank, other_rank;
  double *mine = values_of(file, name, shape, &rank);
  if (!mine) return 0; /* a group */
  double *theirs = values_of(c->other, name, others, &other_rank);
  if (!theirs || rank != other_rank || memcmp(shape, others, sizeof shape) != 0) {
    fprintf(stderr, "%s is missing or has another shape\n", name);
    c->different++;
  } else {
    size_t count = 1;
    for (int k = 0; k < rank; k++)
      count *= (size_t)shape[k];
    for (size_t k = 0; k < count; k++)
      c->different += memcmp(&mine[k], &theirs[k], sizeof(double)) != 0;
    c->numbers += (long)count;
  }
  c->sets++;
  free(mine);
  free(theirs);
  return 0;
}

/* Data sets of a group of A are in B with the same bits, and no others are there. */
static comparison compare(const char *a, const char *b, const char *group) {
  const hid_t fa = H5Fopen(a, H5F_ACC_RDONLY, H5P_DEFAULT),
              fb = H5Fopen(b, H5F_ACC_RDONLY, H5P_DEFAULT);
  assert_true(fa >= 0 && fb >= 0);
  const hid_t ga = H5Gopen2(fa, group, H5P_DEFAULT), gb = H5Gopen2(fb, group, H5P_DEFAULT);
  assert_true(ga >= 0 && gb >= 0);
  comparison c = {.other = gb}, back = {.other = ga};
  H5Lvisit(ga, H5_INDEX_NAME, H5_ITER_INC, compare_set, &c);
  H5Lvisit(gb, H5_INDEX_NAME, H5_ITER_INC, compare_set, &back);
  c.different += back.sets != c.sets;
  H5Gclose(ga);
  H5Gclose(gb);
  H5Fclose(fa);
  H5Fclose(fb);
  return c;
}

static void assert_same(const char *what, const char *a, const char *b) {
  const comparison history = compare(a, b, "/history"), frames = compare(a, b, "/frames");
  print_message("%s: %ld + %ld data sets, %ld numbers, %ld of them differ\n", what, history.sets,
                frames.sets, history.numbers + frames.numbers,
                history.different + frames.different);
  assert_true(history.sets >= 11 && frames.sets >= 4 && history.numbers > 100 &&
              frames.numbers > 1000);
  assert_int_equal(history.different + frames.different, 0);
}

static long samples_of(const char *path) {
  char error[512], unit_text[32];
  long count = 0;
  result_file *f = result_read(path, error, sizeof error);
  if (!f) fail_msg("%s", error);
  free(result_read_series(f, "time", &count, unit_text, sizeof unit_text, error, sizeof error));
  result_read_close(f);
  return count;
}

/* Largest value of a series. */
static double largest(const char *path, const char *name) {
  char error[512], unit_text[32];
  long count;
  double most = -INFINITY;
  result_file *f = result_read(path, error, sizeof error);
  if (!f) fail_msg("%s", error);
  double *v = result_read_series(f, name, &count, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(v);
  for (long k = 0; k < count; k++)
    most = fmax(most, v[k]);
  free(v);
  result_read_close(f);
  return most;
}

/* --- threads ---------------------------------------------------------------------------------- */

/* The whole run, with the crack through the beam. */
static void any_number_of_threads_gives_the_same_bits(void **state) {
  (void)state;
  static const char *const threads[] = {"1", "2", "3"};
  const char *results[3] = {in_folder("one.h5"), in_folder("two.h5"), in_folder("three.h5")};
  for (int k = 0; k < 3; k++) {
    command c = run_command();
    char text[256];
    set_result(&c, results[k], text, sizeof text);
    add(&c, "--threads");
    add(&c, threads[k]);
    must_finish(&c);
  }
  assert_true(largest(results[0], "separated") >= 3); /* the beam did break */
  assert_same("2 threads against 1", results[0], results[1]);
  assert_same("3 threads against 1", results[0], results[2]);
}

/* --- stopped and resumed ---------------------------------------------------------------------- */

/* The unbroken run for the two tests below. */
static const char *unbroken(void) {
  static const char *path;
  if (path) return path;
  path = in_folder("unbroken.h5");
  command c = run_command();
  char text[256];
  set_result(&c, path, text, sizeof text);
  must_finish(&c);
  return path;
}

/* Waits until `path` exists with at least `size` bytes while the child runs; false when it ended
 * before. */
static bool wait_for_file(pid_t child, const char *path, off_t size) {
  struct stat info;
  while (stat(path, &info) != 0 || info.st_size < size) {
    if (waitpid(child, NULL, WNOHANG) != 0) return false;
    nap();
  }
  return true;
}

static void a_killed_run_resumes_with_the_same_bits(void **state) {
  (void)state;
  const char *target = in_folder("killed.h5"), *log = in_folder("killed.log");
  command c = run_command();
  char text[256];
  set_result(&c, target, text, sizeof text);
  set(&c, "checkpoint.interval=0.02 s");
  const pid_t child = start(&c, log);
  char checkpoint[256];
  snprintf(checkpoint, sizeof checkpoint, "%s.checkpoint", target);
  if (!wait_for_file(child, checkpoint, 1)) {
    show(log);
    fail_msg("the run ended before its first checkpoint");
  }
  for (int k = 0; k < 50; k++) /* on into the run, so that there is work to be lost */
    nap();
  kill(child, SIGKILL);
  assert_int_equal(wait_for(child), -SIGKILL);
  assert_true(exists(checkpoint));
  assert_false(exists(target)); /* it appears whole or not at all */
  add(&c, "--resume");
  must_finish(&c);
  assert_true(log_has(beside(folder, "/log"), "resumed at t ="));
  assert_false(exists(checkpoint));
  assert_same("killed and resumed", unbroken(), target);
}

static void an_interrupted_run_leaves_a_result_and_resumes(void **state) {
  (void)state;
  const char *target = in_folder("stopped.h5"), *log = in_folder("stopped.log");
  command c = run_command();
  char text[256];
  set_result(&c, target, text, sizeof text);
  const pid_t child = start(&c, log);
  /* three frames of two displacements and the damage of 509 particles and 1417 bonds */
  if (!wait_for_file(child, beside(target, ".frames"), 3 * 8 * (3 * 509 + 1417))) {
    show(log);
    fail_msg("the run ended before its third frame");
  }
  kill(child, SIGINT);
  assert_int_equal(wait_for(child), 128 + SIGINT);
  const long samples = samples_of(target);
  assert_true(samples > 10 && samples < samples_of(unbroken()));
  assert_true(exists(beside(target, ".checkpoint")));
  add(&c, "--resume");
  must_finish(&c);
  assert_false(exists(beside(target, ".checkpoint")));
  print_message("Ctrl-C after %ld of %ld samples\n", samples, samples_of(unbroken()));
  assert_same("interrupted and resumed", unbroken(), target);
}

/* A full disk: the frame that did not fit is the first that the resumed run writes. */
static void a_run_without_room_resumes_with_the_same_bits(void **state) {
  (void)state;
  const char *target = in_folder("full.h5"), *log = in_folder("full.log");
  command c = {
      {"/bin/sh", "-c", "ulimit -f 400 && exec \"$@\"", "sh", PERILAT_PROGRAM, "run", DECK}, 7};
  char text[256];
  set_result(&c, target, text, sizeof text);
  assert_int_equal(finish(&c, log), 2);
  assert_true(log_has(log, "cannot write a frame") && log_has(log, "--resume"));
  assert_true(exists(beside(target, ".checkpoint")));
  c.words[2] = "exec \"$@\"";
  add(&c, "--resume");
  must_finish(&c);
  assert_same("without room and resumed", unbroken(), target);
}

/* --- steps and readers of the law ------------------------------------------------------------- */

static void an_unstable_step_is_refused_with_the_limit(void **state) {
  (void)state;
  const char *log = in_folder("unstable.log"), *target = in_folder("unstable.h5");
  command c = run_command();
  char text[256];
  set_result(&c, target, text, sizeof text);
  command fine = c;
  set(&c, "simulation.step=1.3 us");
  assert_int_equal(finish(&c, log), 1);
  FILE *in = fopen(log, "r");
  char line[1024];
  double limit = 0;
  while (in && fgets(line, sizeof line, in)) {
    const char *at = strstr(line, "the largest stable one is ");
    if (at) limit = strtod(at + strlen("the largest stable one is "), NULL);
  }
  if (in) fclose(in);
  /* at nu = 0.2 particles that turn in turn rule: omega = c/s sqrt(20 (1 - 3 nu)/(1 - nu^2)); the
     damper is of the friction kind and does not count; 1e-5: the printed digits */
  const double c_bar = sqrt(30e9 / 2323), theory = 2 / (sqrt(20 * 0.4 / 0.96) * c_bar / 6.35e-3);
  print_message("refused with the limit %.6g us; theory %.6g us\n", 1e6 * limit, 1e6 * theory);
  assert_true(fabs(limit / theory - 1) < 1e-5);
  assert_false(exists(target));
  set(&fine, "simulation.step=1.2 us"); /* just below: accepted */
  set(&fine, "simulation.end_time=0.1 ms");
  must_finish(&fine);
}

/* 200 steps with a drive that is hard enough to damage bonds in them. */
static void the_interpreter_gives_the_bits_of_the_kernel(void **state) {
  (void)state;
  const char *results[2] = {in_folder("compiled.h5"), in_folder("interpreted.h5")};
  for (int k = 0; k < 2; k++) {
    command c = run_command();
    char text[256];
    set_result(&c, results[k], text, sizeof text);
    set(&c, "simulation.step=0.3 us");
    set(&c, "simulation.end_time=60 us");
    set(&c, "drive.start=0");
    set(&c, "drive.rise=1 us");
    set(&c, "drive.velocity=-20 m/s");
    set(&c, "output.sample=0.3 us");
    if (k == 1) add(&c, "--interpret");
    must_finish(&c);
  }
  assert_true(largest(results[0], "energy/dissipated_damage") > 0);
  assert_int_equal(samples_of(results[0]), 201);
  assert_same("interpreter against kernel, 200 steps", results[0], results[1]);
}

static int open_folder(void **state) {
  (void)state;
  h5_quiet();
  return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state) {
  (void)state;
  command c = {{"/bin/rm", "-r", folder}, 3};
  return finish(&c, "/dev/null");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
      cmocka_unit_test(a_killed_run_resumes_with_the_same_bits),
      cmocka_unit_test(an_interrupted_run_leaves_a_result_and_resumes),
      cmocka_unit_test(a_run_without_room_resumes_with_the_same_bits),
      cmocka_unit_test(an_unstable_step_is_refused_with_the_limit),
      cmocka_unit_test(the_interpreter_gives_the_bits_of_the_kernel),
  };
  return cmocka_run_group_tests(tests, open_folder, remove_folder);
}
