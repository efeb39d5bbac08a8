/* Runs of decks of examples/ by the program itself, and their histories. */
#ifndef PERILAT_TESTS_DECK_RUN_H
#define PERILAT_TESTS_DECK_RUN_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SAMPLES = 4096 };

typedef struct table { /* of a history */
  double time[MOST_SAMPLES], value[MOST_SAMPLES];
  int count;
} table;

typedef struct deck_run {
  char folder[64];
} deck_run;

static inline void shell(const char *command) {
  const int status = system(command);
  if (status) print_message("%s\n", command);
  assert_int_equal(status, 0);
}

/* Of a deck with a change, such as "--set tips.points=4"; to be ended. */
static inline deck_run run_begin(const char *deck, const char *change) {
  char command[2048];
  deck_run r = {"/tmp/perilat_cracks_XXXXXX"};
  assert_non_null(mkdtemp(r.folder));
  snprintf(command, sizeof command,
           "'%s' run '%s/examples/%s' %s --set output.result=%s/r.h5 >%s/said 2>&1",
           PERILAT_PROGRAM, SOURCE_DIR, deck, change, r.folder, r.folder);
  shell(command);
  return r;
}

static inline void run_end(const deck_run *r) {
  char command[256];
  snprintf(command, sizeof command, "rm -r %s", r->folder);
  shell(command);
}

/* In one of two places, which take turns. */
static inline const table *run_history(const deck_run *r, const char *name) {
  char command[1024], line[512];
  static table both[2];
  static int last;
  table *t = &both[last = !last];
  t->count = 0;
  snprintf(command, sizeof command, "'%s' export --history '%s' %s/r.h5", PERILAT_PROGRAM, name,
           r->folder);
  FILE *in = popen(command, "r");
  assert_non_null(in);
  while (fgets(line, sizeof line, in))
    if (t->count < MOST_SAMPLES &&
        sscanf(line, "%lf,%lf", &t->time[t->count], &t->value[t->count]) == 2)
      t->count++;
  assert_int_equal(pclose(in), 0);
  assert_true(t->count > 2);
  return t;
}

static inline double history_at(const table *t, double time) {
  int k = 0;
  while (k + 1 < t->count && fabs(t->time[k + 1] - time) < fabs(t->time[k] - time))
    k++;
  return t->value[k];
}

static inline double history_first_above(const table *t, double level) {
  for (int k = 0; k < t->count; k++)
    if (t->value[k] >= level) return t->time[k];
  return INFINITY;
}

static inline double history_largest(const table *t) {
  double most = 0;
  for (int k = 0; k < t->count; k++)
    most = t->value[k] > most ? t->value[k] : most;
  return most;
}

static inline double run_last(const deck_run *r, const char *name) {
  const table *t = run_history(r, name);
  return t->value[t->count - 1];
}

/* A number that follows a text in what the run said. */
static inline double run_said(const deck_run *r, const char *text) {
  char path[128], line[1024];
  double value = NAN;
  snprintf(path, sizeof path, "%s/said", r->folder);
  FILE *in = fopen(path, "r");
  assert_non_null(in);
  while (fgets(line, sizeof line, in)) {
    const char *at = strstr(line, text);
    if (at) sscanf(at + strlen(text), "%lf", &value);
  }
  fclose(in);
  return value;
}

#endif
