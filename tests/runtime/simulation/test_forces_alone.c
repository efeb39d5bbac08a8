/* Samples that ask for forces alone do not ask the law for energies and outputs, and change
   nothing: not what monitors say, not the frames between. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/runtime/family_law.h"
#include "tests/runtime/small_run.h"

/* --- a law that counts how often it is observed ----------------------------------------------- */

static long looks;
static void counted(const pl_law *law, const double *uniforms, const pl_family *f) {
  looks++;
  family_observe_pass(law, uniforms, f);
}
static const pl_family_function counted_passes[] = {counted};

static pl_law counting_law(void) {
  pl_law law = family_hexagon;
  law.observe.pass = counted_passes;
  return law;
}

/* Three frames behind the first; a sample in each step; `output` are keys, `more` groups. */
static void open_run(small_run *r, const pl_law *law, const char *output, const char *more) {
  char text[4096];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 3e-5 step = 1e-6 threads = 1 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
      "&material lattice = 'c' model = 'm' S_t = 2e-4 tau = 1e-8 /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"
      "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = 0.015, 0.1 /\n"
      "&region name = 'right' shape = 'rectangle' corner = 0.085, 0 size = 0.015, 0.1 /\n"
      "&support region = 'left' fix = 'xy' /\n"
      "&drive region = 'right' component = 'x' velocity = 1 /\n"
      "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' /\n"
      "&monitor name = 'opening' kind = 'opening' between = 'left', 'right' component = 'x' /\n"
      "&monitor name = 'pull' kind = 'acceleration' region = 'right' component = 'y' /\n"
      "&monitor name = 'cracks' kind = 'damaged' /\n%s\n"
      "&output frames = 3 sample = 1e-6 fields = 'energy', 'xx', 'omega', 'velocity' %s /\n",
      more, output);
  small_open(r, law, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* To the next frame; looks on the way there. */
static long go_to_frame(small_run *r) {
  looks = 0;
  step_status status = STEP_OK;
  while (status == STEP_OK && !simulation_frame_due(r->simulation))
    status = simulation_advance(r->simulation, 1L << 40, NULL);
  const long on_the_way = looks;
  assert_true(simulation_frame_due(r->simulation));
  return on_the_way;
}

static void assert_same_frames(small_run *a, small_run *b) {
  const frame_field *of[2];
  const int count = simulation_frame_fields(a->simulation, &of[0]);
  assert_int_equal(simulation_frame_fields(b->simulation, &of[1]), count);
  for (int f = 0; f < count; f++) {
    const size_t size = (size_t)(of[0][f].count * of[0][f].components);
    double *values[2];
    for (int k = 0; k < 2; k++) {
      values[k] = must_calloc(size + 1, sizeof **values);
      simulation_frame_values((k ? b : a)->simulation, f, values[k]);
    }
    assert_memory_equal(values[0], values[1], size * sizeof **values);
    free(values[0]);
    free(values[1]);
  }
}

static void assert_same_series(const small_run *a, const small_run *b, const char *name) {
  const size_t samples = (size_t)simulation_history(a->simulation, NULL);
  assert_int_equal(simulation_history(b->simulation, NULL), samples);
  assert_memory_equal(small_values(a, name), small_values(b, name), samples * sizeof(double));
}

static void forces_alone_change_nothing(void **state) {
  (void)state;
  const pl_law law = counting_law();
  small_run whole, alone;
  open_run(&whole, &law, "", "");
  open_run(&alone, &law, "energy = .false.", "");
  for (int frame = 0; frame < 4; frame++) {
    const long with = go_to_frame(&whole), without = go_to_frame(&alone);
    assert_true(frame == 0 || with >= 10);
    assert_true(without <= (frame == 0)); /* the state at rest is looked at once */
    assert_same_frames(&whole, &alone);
    simulation_frame_taken(whole.simulation);
    simulation_frame_taken(alone.simulation);
  }
  static const char *const names[] = {"load", "opening", "pull", "cracks"};
  for (int k = 0; k < 4; k++)
    assert_same_series(&whole, &alone, names[k]);
  assert_true(small_last(&alone, "cracks") > 0);
  small_close(&whole);
  small_close(&alone);
}

/* A monitor of what the law says beside, or of what is stored. */
static void some_monitors_want_more(void **state) {
  (void)state;
  static const char *const monitors[] = {
      "&monitor name = 'more' kind = 'field' field = 'xx' region = 'right' /",
      "&monitor name = 'more' kind = 'energy' component = 'stored' region = 'right' /"};
  const pl_law law = counting_law();
  for (int k = 0; k < 2; k++) {
    small_run whole, alone;
    open_run(&whole, &law, "", monitors[k]);
    open_run(&alone, &law, "energy = .false.", monitors[k]);
    for (int frame = 0; frame < 4; frame++) {
      go_to_frame(&whole);
      assert_true(go_to_frame(&alone) >= 10 || frame == 0);
      assert_same_frames(&whole, &alone);
      simulation_frame_taken(whole.simulation);
      simulation_frame_taken(alone.simulation);
    }
    assert_same_series(&whole, &alone, "more");
    double most = 0;
    for (long n = 0; n < simulation_history(alone.simulation, NULL); n++)
      most = fmax(most, fabs(small_values(&alone, "more")[n]));
    assert_true(most > 0);
    small_close(&whole);
    small_close(&alone);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(forces_alone_change_nothing),
                                     cmocka_unit_test(some_monitors_want_more)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
