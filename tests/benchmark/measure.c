#include "tests/benchmark/measure.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "tests/benchmark/lanes.h"

void give_up(const char *format, ...) {
  va_list more;
  va_start(more, format);
  fputs("benchmark: ", stderr);
  vfprintf(stderr, format, more);
  fputc('\n', stderr);
  va_end(more);
  exit(EXIT_FAILURE);
}

/* --- clocks and medians ----------------------------------------------------------------------- */

static double seconds_by(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double processor_seconds(void) {
  return seconds_by(CLOCK_THREAD_CPUTIME_ID);
}
double wall_seconds(void) {
  return seconds_by(CLOCK_MONOTONIC);
}

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

enum { MOST_VALUES = 64 };

static void sort_into(double sorted[MOST_VALUES], const double *values, int count) {
  if (count < 1 || count > MOST_VALUES) give_up("a median of %d values", count);
  memcpy(sorted, values, (size_t)count * sizeof *values);
  qsort(sorted, (size_t)count, sizeof *sorted, by_value);
}

double median_of(const double *values, int count) {
  double sorted[MOST_VALUES];
  sort_into(sorted, values, count);
  return count % 2 ? sorted[count / 2] : 0.5 * (sorted[count / 2 - 1] + sorted[count / 2]);
}

double spread_of(const double *values, int count) {
  double sorted[MOST_VALUES];
  sort_into(sorted, values, count);
  return 0.5 * (sorted[count - 1 - count / 4] - sorted[count / 4]) / median_of(values, count);
}

/* --- the machine ------------------------------------------------------------------------------ */

void processor_fact(const char *key, char *value, size_t size) {
  char line[4096];
  FILE *in = fopen("/proc/cpuinfo", "r");
  snprintf(value, size, "unknown");
  while (in && fgets(line, sizeof line, in)) {
    const char *colon = strchr(line, ':');
    if (strncmp(line, key, strlen(key)) != 0 || !colon || colon[1] == '\n') continue;
    snprintf(value, size, "%.*s", (int)strcspn(colon + 2, "\n\"\\"), colon + 2);
    break;
  }
  if (in) fclose(in);
}

int vector_bits(void) {
  return (int)(8 * sizeof(lanes));
}

int processor_count(void) {
  return (int)sysconf(_SC_NPROCESSORS_ONLN);
}

enum { PEAK_ROUNDS = 7 };

double triad_bandwidth(size_t bytes, int threads) {
  const long count = (long)(bytes / (3 * sizeof(double)));
  double *a = must_alloc((size_t)count * sizeof *a), *b = must_alloc((size_t)count * sizeof *b),
         *c = must_alloc((size_t)count * sizeof *c), seconds[PEAK_ROUNDS];
  double factor = 3;
  for (int round = -1; round < PEAK_ROUNDS; round++) { /* the first touches the memory */
    const double begun = wall_seconds();
#pragma omp parallel for num_threads(threads) schedule(static)
    for (long k = 0; k < count; k++) {
      if (round < 0)
        a[k] = b[k] = c[k] = (double)k;
      else
        a[k] = b[k] + factor * c[k];
    }
    if (round >= 0) seconds[round] = wall_seconds() - begun;
  }
  free(a);
  free(b);
  free(c);
  return 3 * sizeof(double) * (double)count / median_of(seconds, PEAK_ROUNDS);
}

/* Enough chains to fill two units whose results take four or five cycles. This file is compiled
   with contraction. */
enum { CHAINS = 12, LINKS = 1 << 20 };

static __attribute__((noinline)) lanes run_chains(lanes factor, lanes term) {
  lanes x[CHAINS];
  for (int c = 0; c < CHAINS; c++)
    x[c] = lanes_all(c);
  for (long k = 0; k < LINKS; k++)
    for (int c = 0; c < CHAINS; c++)
      x[c] = x[c] * factor + term;
  for (int c = 1; c < CHAINS; c++)
    x[0] += x[c];
  return x[0];
}

double fused_peak(void) {
  double seconds[PEAK_ROUNDS];
  volatile double factor = 0.5, term = 0.25, kept;
  for (int round = 0; round < PEAK_ROUNDS; round++) {
    const double begun = processor_seconds();
    kept = run_chains(lanes_all(factor), lanes_all(term))[0];
    seconds[round] = processor_seconds() - begun;
  }
  (void)kept;
  return 2.0 * LANES * CHAINS * LINKS / median_of(seconds, PEAK_ROUNDS);
}

/* --- figures ---------------------------------------------------------------------------------- */

enum { MOST_FIGURES = 256, KEY = 80 };

typedef struct figure {
  char key[KEY];
  double value;
} figure;

struct figures {
  FILE *out;
  bool any;
  int count;
  figure items[MOST_FIGURES];
};

figures *figures_open(const char *path) {
  figures *f = must_calloc(1, sizeof *f);
  f->out = path ? fopen(path, "w") : NULL;
  if (path && !f->out) give_up("%s cannot be written", path);
  return f;
}

static void begin_figure(figures *f, const char *key) {
  fprintf(f->out, "%s\"%s\": ", f->any ? ",\n  " : "{\n  ", key);
  f->any = true;
}

void figures_text(figures *f, const char *key, const char *text) {
  if (!f->out) return;
  begin_figure(f, key);
  fprintf(f->out, "\"%s\"", text);
}

void figures_add(figures *f, double value, const char *format, ...) {
  va_list more;
  if (!isfinite(value)) return;
  if (f->count == MOST_FIGURES) give_up("more than %d figures", MOST_FIGURES);
  figure *item = &f->items[f->count++];
  item->value = value;
  va_start(more, format);
  vsnprintf(item->key, sizeof item->key, format, more);
  va_end(more);
  if (!f->out) return;
  begin_figure(f, item->key);
  fprintf(f->out, "%.6g", value);
}

double figures_value(const figures *f, const char *key) {
  for (int k = 0; k < f->count; k++)
    if (strcmp(f->items[k].key, key) == 0) return f->items[k].value;
  return NAN;
}

void figures_close(figures *f) {
  if (f->out) {
    fputs(f->any ? "\n}\n" : "{}\n", f->out);
    if (fclose(f->out) != 0) give_up("the figures cannot be written");
  }
  free(f);
}
