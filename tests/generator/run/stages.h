/* Decks of two stages and of one run, and the states that they end in. Include after cmocka.h. */
#ifndef PERILAT_TESTS_STAGES_H
#define PERILAT_TESTS_STAGES_H

#include <math.h>

#include "runtime/result/result_state.h"
#include "runtime/result/state_write.h"
#include "tests/generator/command_tools.h"

#define BLOCK(lattice, model, body)                                                                \
  "&lattice   name = 'c'  " lattice "  thickness = '50 mm'  /\n"                                   \
  "&material  lattice = 'c'  " model "  /\n"                                                       \
  "&body      lattice = 'c'  shape = 'rectangle'  corner = 0, 0  " body "  /\n"                    \
  "&region    name = 'foot'  lattice = 'c'  shape = 'rectangle'  corner = '-1 mm', '-1 mm'  size " \
  "= '4 mm', "                                                                                     \
  "'40 mm'  /\n"                                                                                   \
  "&region    name = 'tip'  lattice = 'c'  shape = 'rectangle'  corner = '54 mm', '-1 mm'  size "  \
  "= '10 mm', '40 "                                                                                \
  "mm'  /\n"                                                                                       \
  "&support   region = 'foot'  fix = 'xy'  /\n"                                                    \
  "&monitor   name = 'u'  kind = 'displacement'  region = 'tip'  component = 'y'  /\n"

#define HEXAGON "kind = 'hexagonal'  spacing = '5 mm'"
#define BEAM    "size = '60 mm', '26 mm'"
#define STEADY                                                                                     \
  "&damping   rate = 300  /\n&gravity   acceleration = 5, -9.81  /\n"                              \
  "&force     region = 'tip'  component = 'y'  total = '-400 N'  history = 'constant'  /\n"

enum { DECK = 4000 };

static inline void write_stage(const workplace *w, const char *name, const char *block,
                               const char *end, const char *more) {
  char deck[DECK], file[100];
  const int n = snprintf(
      deck, sizeof deck,
      "&simulation  end_time = '%s'  step = '0.25 us'  /\n%s%s"
      "&output  result = '%s.h5'  frames = 1  state = .true.  fields = 'damage', 'velocity'  /\n",
      end, block, more, name);
  assert_true(n > 0 && n < DECK);
  snprintf(file, sizeof file, "%s.nml", name);
  write_text(w, file, deck);
}

static inline void run_stage_by(workplace *w, const char *name, int threads) {
  char arguments[200];
  snprintf(arguments, sizeof arguments, "run %s.nml --no-physics --threads %d", name, threads);
  expect(w, arguments, 0, "written");
}

static inline void run_stage(workplace *w, const char *name) {
  run_stage_by(w, name, 1);
}

static inline result_state *state_of(const workplace *w, const char *name) {
  char error[500] = "", file[100];
  bool missing;
  snprintf(file, sizeof file, "%s.h5", name);
  result_file *f = open_result_of(w, file);
  result_state *s = result_state_read(f, &missing, error, sizeof error);
  if (!s) print_message("%s %s\n", name, error);
  assert_non_null(s);
  result_read_close(f);
  return s;
}

static inline double largest(const double *values, long count) {
  double most = 0;
  for (long k = 0; k < count; k++)
    most = fmax(most, fabs(values[k]));
  return most;
}

/* Places, velocities, states and damage at the end of both, to the bit; returns the largest damage
   or state. */
static inline double same_ends(const workplace *w, const char *one, const char *two) {
  result_state *a = state_of(w, one), *b = state_of(w, two);
  double most = 0;
  assert_int_equal(a->body_count, b->body_count);
  for (int k = 0; k < a->body_count; k++) {
    const long count = a->bodies[k].count * a->bodies[k].dof;
    const size_t bytes = (size_t)count * sizeof(double);
    assert_int_equal(b->bodies[k].count, a->bodies[k].count);
    assert_true(largest(a->bodies[k].velocity, count) > 0);
    assert_memory_equal(a->bodies[k].displacement, b->bodies[k].displacement, bytes);
    assert_memory_equal(a->bodies[k].velocity, b->bodies[k].velocity, bytes);
  }
  assert_int_equal(a->law_count, b->law_count);
  for (int n = 0; n < a->law_count; n++)
    for (int f = 0; f < a->laws[n].field_count; f++) {
      const state_field *x = &a->laws[n].fields[f], *y = &b->laws[n].fields[f];
      const long count = x->count * x->columns;
      assert_true(x->count == y->count && x->columns == y->columns);
      assert_memory_equal(x->values, y->values, (size_t)count * sizeof(double));
      most = fmax(most, largest(x->values, count));
    }
  assert_int_equal(a->stamp_count, b->stamp_count);
  for (int n = 0; n < a->stamp_count; n++) {
    const state_stamp *x = &a->stamps[n], *y = &b->stamps[n];
    assert_memory_equal(x->place, y->place, sizeof x->place);
    assert_memory_equal(x->velocity, y->velocity, sizeof x->velocity);
    for (int f = 0; f < x->dragged_count; f++)
      assert_memory_equal(x->dragged[f].values, y->dragged[f].values,
                          (size_t)x->dragged[f].count * (size_t)x->dragged[f].columns *
                              sizeof(double));
  }
  result_state_free(a);
  result_state_free(b);
  return most;
}

/* By different numbers of threads; returns the largest damage. */
static inline double check_stages(workplace *w, const char *block, const char *more) {
  char second[2000];
  write_stage(w, "one", block, "0.6 ms", more);
  write_stage(w, "first", block, "0.25 ms", more);
  snprintf(second, sizeof second, "%s&start  result = 'first.h5'  /\n", more);
  write_stage(w, "second", block, "0.35 ms", second);
  run_stage_by(w, "one", 1);
  run_stage_by(w, "first", 2);
  run_stage_by(w, "second", 3);
  const double damage = same_ends(w, "one", "second");
  print_message("the same bits, with a damage or state of up to %.3g\n", damage);
  return damage;
}

/* Value of a history at its end, or at its first sample. */
static inline double last_of(const workplace *w, const char *name, const char *series, bool first) {
  char file[100], in[64], error[500] = "";
  long count;
  snprintf(file, sizeof file, "%s.h5", name);
  result_file *f = open_result_of(w, file);
  double *values = result_read_series(f, series, &count, in, sizeof in, error, sizeof error);
  if (!values) print_message("%s\n", error);
  assert_non_null(values);
  const double value = values[first ? 0 : count - 1];
  free(values);
  result_read_close(f);
  return value;
}

#endif
