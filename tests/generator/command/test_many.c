/* Thousands of parameters, states, groups, monitors, histories: the time grows as their number.
   Processor time of four times as many is compared, so that what else the machine does matters
   little: 4 is linear, 16 quadratic. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <sys/resource.h>

#include "tests/generator/command_tools.h"
#include "tests/runtime/small_result.h"

enum { TIMES = 4, TRIES = 4 };
static const double most_growth = 7;

/* --- measuring -------------------------------------------------------------------------------- */

static double seconds_of_children(void) {
  struct rusage used;
  assert_int_equal(getrusage(RUSAGE_CHILDREN, &used), 0);
  return (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

typedef void (*writer)(workplace *w, const char *name, int count);

typedef struct growth {
  const char *of, *command; /* %s: the file's name, twice at most */
  writer write;
  int count, status;
} growth;

static double time_of(workplace *w, const growth *g, const char *file) {
  char line[400];
  snprintf(line, sizeof line, g->command, file, file);
  const double before = seconds_of_children();
  const int status = shell(w, "$P %s", line);
  if (status != g->status) show_failure(w, line, status, g->status, "");
  assert_int_equal(status, g->status);
  return seconds_of_children() - before;
}

/* The least of some tries each: a busy machine can only add. */
static void grows_with_the_number(workplace *w, const growth *g) {
  double few = INFINITY, many = INFINITY;
  g->write(w, "few", g->count);
  g->write(w, "many", TIMES * g->count);
  for (int k = 0; k < TRIES && (k == 0 || many > most_growth * few); k++) {
    few = fmin(few, time_of(w, g, "few"));
    many = fmin(many, time_of(w, g, "many"));
  }
  if (many > most_growth * few)
    fail_msg("%s: %d take %.3f s, %d take %.3f s: %.1f times", g->of, g->count, few,
             TIMES * g->count, many, many / few);
}

static void all_grow_so(workplace *w, const growth *cases, size_t count) {
  for (size_t k = 0; k < count; k++)
    grows_with_the_number(w, &cases[k]);
}

/* --- laws ------------------------------------------------------------------------------------- */

static FILE *open_in(workplace *w, const char *name) {
  FILE *out = fopen(in_workplace(w, name), "w");
  assert_non_null(out);
  return out;
}

static FILE *begin_law(workplace *w, const char *name) {
  FILE *out = open_in(w, name);
  fputs("model many\n  law central bond\n  parameter rho = 2323 [kg/m^3] in (0, inf)\n", out);
  return out;
}

static void end_law(FILE *out, const char *factor, ...) __attribute__((format(printf, 2, 3)));
static void end_law(FILE *out, const char *factor, ...) {
  va_list values;
  va_start(values, factor);
  fputs("  force N = 1 [N]*stretch*(1 + ", out);
  vfprintf(out, factor, values);
  fputs(")\nend model\n", out);
  va_end(values);
  fclose(out);
}

/* Each has bounds, and a value that depends on the one before. */
static void write_parameters(workplace *w, const char *name, int count) {
  FILE *out = begin_law(w, name);
  for (int k = 0; k < count; k++)
    fprintf(out, "  parameter p%d = 1e-3 in (0, 1) \"number %d\"\n", k, k);
  fputs("  v0 = p0\n", out);
  for (int k = 1; k < count; k++)
    fprintf(out, "  v%d = v%d + p%d\n", k, k - 1, k);
  end_law(out, "v%d", count - 1);
}

static void write_outputs(workplace *w, const char *name, int count) {
  FILE *out = begin_law(w, name);
  for (int k = 0; k < count; k++)
    fprintf(out, "  output x%d = stretch*%d\n", k, k + 1);
  end_law(out, "0");
}

static void write_functions(workplace *w, const char *name, int count) {
  FILE *out = begin_law(w, name);
  for (int k = 0; k < count; k++)
    fprintf(out, "  function f%d(x) = x*%d\n", k, k + 1);
  for (int k = 0; k < count; k++)
    fprintf(out, "  output x%d = f%d(stretch)\n", k, k);
  end_law(out, "0");
}

static void write_states(workplace *w, const char *name, int count) {
  FILE *out = begin_law(w, name);
  for (int k = 0; k < count; k++)
    fprintf(out, "  state q%d = 0\n  q%d = max(q%d, stretch)\n  output x%d = q%d\n", k, k, k, k, k);
  end_law(out, "0");
}

static void write_unknown_names(workplace *w, const char *name, int count) {
  FILE *out = begin_law(w, name);
  for (int k = 0; k < count; k++)
    fprintf(out, "  v%d = nothing%d*stretch\n", k, k);
  end_law(out, "v%d", count - 1);
}

static void laws(void **state) {
  static const growth cases[] = {
      {"parameters", "check %s", write_parameters, 1500, 0},
      {"parameters, written as C", "check --no-physics --dump=c %s", write_parameters, 1500, 0},
      {"outputs", "check %s", write_outputs, 1500, 0},
      {"functions", "check --no-physics %s", write_functions, 2000, 0},
      {"states", "check %s", write_states, 200, 0},
      {"faults", "check %s", write_unknown_names, 2000, 1},
  };
  all_grow_so(*state, cases, sizeof cases / sizeof *cases);
}

/* --- decks ------------------------------------------------------------------------------------ */

static FILE *begin_deck(workplace *w, const char *name) {
  FILE *out = open_in(w, name);
  fputs("&simulation end_time = '20 us' /\n"
        "&lattice name = 'c' kind = 'hexagonal' spacing = '6.35 mm' thickness = '152.4 mm' /\n"
        "&material lattice = 'c' model = 'splm_elastic' /\n"
        "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = '60 mm', '60 mm' /\n"
        "&region name = 'low' shape = 'rectangle' corner = 0, 0 size = '60 mm', '10 mm' /\n"
        "&support region = 'low' fix = 'xy' /\n",
        out);
  return out;
}

static void write_monitors(workplace *w, const char *name, int count) {
  FILE *out = begin_deck(w, name);
  for (int k = 0; k < count; k++)
    fprintf(out, "&monitor name = 'm%d' kind = 'reaction' region = 'low' component = 'x' /\n", k);
  fclose(out);
}

static void write_stops(workplace *w, const char *name, int count) {
  FILE *out = begin_deck(w, name);
  for (int k = 0; k < count; k++)
    fprintf(out, "&monitor name = 'm%d' kind = 'displacement' region = 'low' component = 'x' /\n",
            k);
  for (int k = 0; k < count; k++)
    fprintf(out, "&stop monitor = 'm%d' above = '1 m' /\n", k);
  fclose(out);
}

/* Names that only their last digits tell apart, and loads on each. */
static void write_loads(workplace *w, const char *name, int count) {
  FILE *out = begin_deck(w, name);
  for (int k = 0; k < count; k++)
    fprintf(out, "&region name = 'a_place_of_the_specimen_%d' shape = 'point' at = 0.03, 0.04 /\n",
            k);
  for (int k = 0; k < count; k++)
    fprintf(out, "&support region = 'a_place_of_the_specimen_%d' fix = 'x' /\n", k);
  for (int k = 0; k < count; k++)
    fprintf(out,
            "&monitor name = 'm%d' kind = 'reaction' region = 'a_place_of_the_specimen_%d' "
            "component = 'x' /\n",
            k, k);
  fclose(out);
}

static void write_drives(workplace *w, const char *name, int count) {
  FILE *out = begin_deck(w, name);
  for (int k = 0; k < count; k++)
    fprintf(out, "&region name = 'a_place_of_the_specimen_%d' shape = 'point' at = 0.03, 0.04 /\n",
            k);
  for (int k = 0; k < count; k++)
    fprintf(out, "&drive region = 'a_place_of_the_specimen_%d' component = 'y' velocity = 0 /\n",
            k);
  fclose(out);
}

static void write_lattices(workplace *w, const char *name, int count) {
  FILE *out = open_in(w, name);
  fputs("&simulation end_time = '20 us' /\n", out);
  for (int k = 0; k < count; k++)
    fprintf(out,
            "&lattice name = 'l%d' kind = 'hexagonal' spacing = 1 thickness = 1 /\n"
            "&material lattice = 'l%d' model = 'splm_elastic' /\n"
            "&body lattice = 'l%d' shape = 'rectangle' corner = 0, 0 size = 1, 1 /\n",
            k, k, k);
  fclose(out);
}

static void write_unknown_groups(workplace *w, const char *name, int count) {
  FILE *out = begin_deck(w, name);
  for (int k = 0; k < count; k++)
    fputs("&suport region = 'low' fix = 'x' /\n", out);
  fclose(out);
}

static void decks(void **state) {
  static const growth cases[] = {
      {"monitors", "run --set output.result=%s.h5 %s", write_monitors, 2400, 0},
      {"stops", "run --set output.result=%s.h5 %s", write_stops, 1200, 0},
      {"loads", "check %s", write_loads, 800, 0},
      {"drives", "check %s", write_drives, 1200, 1}, /* of one particle: most are refused */
      {"lattices", "check %s", write_lattices, 200, 1},
      {"unknown groups", "check %s", write_unknown_groups, 2400, 1},
  };
  all_grow_so(*state, cases, sizeof cases / sizeof *cases);
}

/* --- results ---------------------------------------------------------------------------------- */

/* Also writes the list of all names, for a shell. */
static void write_histories(workplace *w, const char *name, int count) {
  char file[40], list[40], error[1024];
  snprintf(file, sizeof file, "%s.h5", name);
  snprintf(list, sizeof list, "%s.list", name);
  char *path = strdup(in_workplace(w, file));
  const result_header h = small_header(path);
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  static const double values[] = {0, 1, 2};
  double u[2 * PARTICLES], omega[BONDS];
  small_frame(0, u, omega);
  assert_true(result_frame(r, 0, (const double *const[]){u, omega}, error, sizeof error));
  result_series *series = calloc((size_t)count, sizeof *series);
  char(*names)[40] = calloc((size_t)count, sizeof *names);
  FILE *asked = open_in(w, list);
  for (int k = 0; k < count; k++) {
    snprintf(names[k], sizeof names[k], "history_%d", k);
    series[k] = (result_series){.name = names[k], .unit = "N", .values = values};
    fprintf(asked, "--history history_%d\n", k);
  }
  fclose(asked);
  const result_ending e = {.ended = "at the end",
                           .dt = 0.1,
                           .steps = 3,
                           .time = values,
                           .history_count = 3,
                           .series = series,
                           .series_count = count};
  assert_true(result_finish(r, &e, error, sizeof error));
  result_close(r);
  free(path);
  free(names);
  free(series);
}

static void results(void **state) {
  static const growth cases[] = {
      {"histories, exported by name", "export %s.h5 $(cat %s.list)", write_histories, 5000, 0},
      {"histories, compared", "compare %s.h5 %s.h5", write_histories, 2000, 0},
  };
  all_grow_so(*state, cases, sizeof cases / sizeof *cases);
}

#define T(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)

int main(void) {
  const struct CMUnitTest tests[] = {T(laws), T(decks), T(results)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
