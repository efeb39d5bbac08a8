/* What tests of the command need: a folder of its own with a small deck, the program run in it by a
   shell, and its result compared with another's to the last bit. */
#ifndef PERILAT_TESTS_COMMAND_TOOLS_H
#define PERILAT_TESTS_COMMAND_TOOLS_H

#include <ftw.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "runtime/result/result_fields.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"

#define SAID_SIZE 20000

typedef struct workplace {
  char folder[200];
  char said[SAID_SIZE]; /* both outputs of the last command */
} workplace;

/* The body of small decks: a short beam on two points. */
#define SMALL_BEAM                                                                                 \
  "&lattice     name = 'concrete'  kind = 'hexagonal'  spacing = '6.35 mm'  thickness = '152.4 "   \
  "mm'  /\n"                                                                                       \
  "&material    lattice = 'concrete'  model = 'mplm_bilinear'  /\n"                                \
  "&body        lattice = 'concrete'  shape = 'rectangle'  corner = 0, 0  size = '38.1 mm', '12 "  \
  "mm'  /\n"                                                                                       \
  "&region      name = 'left'  shape = 'point'  at = 0, 0  /\n"                                    \
  "&region      name = 'right'  shape = 'point'  at = '38.1 mm', 0  /\n"                           \
  "&region      name = 'loader'  shape = 'point'  at = '19.05 mm', '11 mm'  /\n"                   \
  "&support     region = 'left'  fix = 'xy'  /\n"                                                  \
  "&support     region = 'right'  fix = 'y'  /\n"

static const char small_deck[] =
    "! A small beam, pushed down in the middle\n"
    "&simulation  title = 'small beam'  end_time = '1 ms'  /\n" SMALL_BEAM
    "&drive       region = 'loader'  component = 'y'  velocity = '-20 mm/s'  rise = '0.2 ms'  /\n"
    "&monitor     name = 'load'  kind = 'reaction'  region = 'loader'  component = 'y'  scale = -1 "
    " /\n"
    "&output      result = 'beam.h5'  frames = 4  /\n";

static inline const char *in_workplace(const workplace *w, const char *name) {
  static _Thread_local char path[400];
  snprintf(path, sizeof path, "%s/%s", w->folder, name);
  return path;
}

static inline void write_bytes(const workplace *w, const char *name, const void *data,
                               size_t size) {
  FILE *out = fopen(in_workplace(w, name), "wb");
  assert_non_null(out);
  assert_int_equal(fwrite(data, 1, size, out), size);
  assert_int_equal(fclose(out), 0);
}

static inline void write_text(const workplace *w, const char *name, const char *text) {
  write_bytes(w, name, text, strlen(text));
}

/* Whole file (malloc'ed). */
static inline char *read_bytes(const workplace *w, const char *name, size_t *size) {
  FILE *in = fopen(in_workplace(w, name), "rb");
  assert_non_null(in);
  struct stat about;
  assert_int_equal(fstat(fileno(in), &about), 0);
  char *data = calloc((size_t)about.st_size + 1, 1);
  assert_non_null(data);
  *size = fread(data, 1, (size_t)about.st_size, in);
  fclose(in);
  return data;
}

static inline bool exists(const workplace *w, const char *name) {
  return access(in_workplace(w, name), F_OK) == 0;
}

static inline int set_up_workplace(void **state) {
  workplace *w = calloc(1, sizeof *w);
  assert_non_null(w);
  snprintf(w->folder, sizeof w->folder, "/tmp/perilat_command_XXXXXX");
  assert_non_null(mkdtemp(w->folder));
  write_text(w, "beam.nml", small_deck);
  *state = w;
  return 0;
}

static inline int remove_entry(const char *path, const struct stat *about, int kind,
                               struct FTW *at) {
  (void)about, (void)kind, (void)at;
  return remove(path);
}

static inline int tear_down_workplace(void **state) {
  workplace *w = *state;
  nftw(w->folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
  free(w);
  return 0;
}

/* A line of shell in the workplace, where $P is the program. Its exit status, 128 + signal; its
   outputs go to w->said. */
static inline int shell(workplace *w, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static inline int shell(workplace *w, const char *format, ...) {
  char line[2000], whole[4000];
  va_list values;
  va_start(values, format);
  vsnprintf(line, sizeof line, format, values);
  va_end(values);
  snprintf(whole, sizeof whole,
           "cd '%s' && export PERILAT_MODELS='" SOURCE_DIR "/models' && P='" PERILAT_PROGRAM
           "' && (%s) > said 2>&1",
           w->folder, line);
  int status = system(whole);
  size_t size;
  char *said = read_bytes(w, "said", &size);
  snprintf(w->said, sizeof w->said, "%s", said);
  free(said);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static inline void show_failure(const workplace *w, const char *line, int status, int expected,
                                const char *wanted) {
  fprintf(stderr, "%s\n  gave status %d (expected %d); it said\n%s\n  expected: %s\n", line, status,
          expected, w->said, wanted);
}

/* `perilat <arguments>` must end with `status` and say `wanted`. */
static inline void expect(workplace *w, const char *arguments, int status, const char *wanted) {
  int found = shell(w, "$P %s", arguments);
  bool good = found == status && strstr(w->said, wanted) && !strstr(w->said, "runtime error");
  if (!good) show_failure(w, arguments, found, status, wanted);
  assert_true(good);
}

/* --- results ---------------------------------------------------------------------------------- */

static inline result_file *open_result_of(const workplace *w, const char *name) {
  char error[1000];
  result_file *f = result_read(in_workplace(w, name), error, sizeof error);
  if (!f) fprintf(stderr, "%s\n", error);
  assert_non_null(f);
  return f;
}

static inline void same_series(result_file *a, result_file *b, const char *name) {
  long count[2];
  char unit_text[64], error[1000];
  double *x =
      result_read_series(a, name, &count[0], unit_text, sizeof unit_text, error, sizeof error);
  double *y =
      result_read_series(b, name, &count[1], unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(x);
  assert_non_null(y);
  assert_int_equal(count[0], count[1]);
  assert_memory_equal(x, y, (size_t)count[0] * sizeof *x);
  free(x);
  free(y);
}

static inline void same_frames(result_file *a, result_file *b, const char *field) {
  long frames[2];
  free(result_read_frame_times(a, &frames[0]));
  free(result_read_frame_times(b, &frames[1]));
  assert_int_equal(frames[0], frames[1]);
  for (long k = 0; k < frames[0]; k++) {
    long count;
    int components;
    char unit_text[64], error[1000];
    double *x = result_read_frame(a, field, k, &count, &components, unit_text, sizeof unit_text,
                                  error, sizeof error);
    double *y = result_read_frame(b, field, k, &count, &components, unit_text, sizeof unit_text,
                                  error, sizeof error);
    assert_non_null(x);
    assert_non_null(y);
    assert_memory_equal(x, y, (size_t)(count * components) * sizeof *x);
    free(x);
    free(y);
  }
}

/* Histories and frames of both are the same to the last bit. */
static inline void expect_same_results(const workplace *w, const char *first, const char *second) {
  result_file *a = open_result_of(w, first), *b = open_result_of(w, second);
  static const char *const series[] = {"time", "load", "energy/external", "energy/imbalance"};
  for (size_t k = 0; k < sizeof series / sizeof *series; k++)
    same_series(a, b, series[k]);
  same_frames(a, b, "displacement");
  same_frames(a, b, "damage");
  result_read_close(a);
  result_read_close(b);
}

/* --- runs that are stopped -------------------------------------------------------------------- */

static inline void wait_a_little(void) {
  const struct timespec millisecond = {0, 1000000};
  nanosleep(&millisecond, NULL);
}

static inline off_t size_of(const workplace *w, const char *name) {
  struct stat about;
  return stat(in_workplace(w, name), &about) == 0 ? about.st_size : 0;
}

/* Starts a long run to the result `output` in the background, with one --set more or NULL; returns
   when a few frames are written. */
static inline pid_t start_long_run(const workplace *w, const char *output, const char *more) {
  enum { A_FEW = 8000 }; /* bytes; all hundred frames have 50000 */
  char frames[100], set[100];
  snprintf(frames, sizeof frames, "%s.frames", output);
  snprintf(set, sizeof set, "output.result=%s", output);
  bool begun = false;
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    if (chdir(w->folder) != 0 || !freopen("said_long", "w", stdout) ||
        dup2(fileno(stdout), fileno(stderr)) < 0)
      _exit(99);
    setenv("PERILAT_MODELS", SOURCE_DIR "/models", 1);
    execl(PERILAT_PROGRAM, "perilat", "run", "long.nml", "--set", set, "--set",
          "simulation.title=a long run", /* to be quoted for a shell */
          more ? "--set" : NULL, more, (char *)NULL);
    _exit(99);
  }
  for (int k = 0; k < 60000; k++) {
    begun = begun || size_of(w, frames) < A_FEW; /* those of an earlier run are gone */
    if (begun && size_of(w, frames) > A_FEW) return child;
    wait_a_little();
  }
  fail_msg("the run of %s did not write frames", output);
  return child;
}

static inline int end_of(pid_t child) {
  int status;
  assert_int_equal(waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static inline void write_long_deck(workplace *w) {
  assert_int_equal(
      shell(w, "sed -e 's/1 ms/40 ms/' -e 's/frames = 4/frames = 100/' beam.nml > long.nml; "
               "echo '&checkpoint interval = 0.02 /' >> long.nml"),
      0);
}

#endif
