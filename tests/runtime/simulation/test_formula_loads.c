/* Loads by formulas of place and time: against closed forms, against the same loads given
   otherwise, and that what lets the formula read the place reads that of each particle. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/simulation/pair.h"
#include "tests/runtime/simulation/same_runs.h"

/* --- against closed forms --------------------------------------------------------------------- */

/* The right particle of a spring, forced with F sin(p t) from `start` on. */
static double shaken(double t, double start) {
  const double w = frequency(), p = 0.4 * w, s = t - start;
  return s < 0 ? 0 : 100 / mass() / (w * w - p * p) * (sin(p * s) - p / w * sin(w * s));
}

/* The left particle is driven with sin(p t): the right one follows. */
static double followed(double t, double start) {
  const double w = frequency(), p = 0.4 * w, s = t - start;
  return s < 0 ? 0 : 1e-6 * w * w / (w * w - p * p) * (sin(p * s) - p / w * sin(w * s));
}

/* The same with 1 - cos(p t), and the force on the drive's particle: of the spring and of its own
   mass. */
static double nodded(double t, double start) {
  const double w = frequency(), p = 0.4 * w, s = t - start;
  return s < 0 ? 0 : 1e-6 * (1 - cos(w * s) - w * w / (w * w - p * p) * (cos(p * s) - cos(w * s)));
}

static double nod_support(double t, double start) {
  const double p = 0.4 * frequency(), s = t - start;
  if (s < 0) return 0;
  return stiffness() * (1e-6 * (1 - cos(p * s)) - nodded(t, start)) +
         mass() * 1e-6 * p * p * cos(p * s);
}

static void motions_and_forces_follow_formulas(void **state) {
  (void)state;
  static const double starts[] = {0, 0.2, 40, 40 + 1 / 3.0, 40.8};
  const double p = 0.4 * frequency();
  char force[512], factor[512], moved[512], velocity[512], weight[512], nod[512], nod_velocity[512];
  snprintf(force, sizeof force,
           FIXED "&force region = 'right' component = 'x' formula = '100 [N]*sin(%.17g [1/s]*t)' "
                 "start = %%.17g /\n",
           p);
  snprintf(factor, sizeof factor,
           FIXED "&force region = 'right' component = 'x' total = '0.1 kN' history = 'formula' "
                 "formula = 'sin(%.17g [rad/s]*t)*x/10 [mm]' start = %%.17g /\n",
           p);
  snprintf(weight, sizeof weight,
           FIXED
           "&gravity acceleration = %.17g, 0 formula = 'sin(%.17g [1/s]*t)' start = %%.17g /\n",
           100 / mass(), p);
  snprintf(moved, sizeof moved,
           "&drive region = 'left' component = 'x' formula = '1 [um]*sin(%.17g [1/s]*t)' start = "
           "%%.17g /\n",
           p);
  snprintf(velocity, sizeof velocity,
           "&drive region = 'left' component = 'x' velocity = %.17g formula = 'cos(%.17g [1/s]*t)' "
           "start = %%.17g /\n",
           1e-6 * p, p);
  snprintf(nod, sizeof nod,
           "&drive region = 'left' component = 'x' displacement = '1 um' formula = '1 - cos(%.17g "
           "[1/s]*t)' start = %%.17g /\n",
           p);
  snprintf(nod_velocity, sizeof nod_velocity,
           "&drive region = 'left' component = 'x' formula = '%.17g [um/s]*sin(%.17g [1/s]*t)' "
           "start = %%.17g /\n",
           p, p);
  for (size_t k = 0; k < sizeof starts / sizeof *starts; k++) {
    const motion all[] = {
        {force, starts[k], "u", shaken, 100 / stiffness()},
        {factor, starts[k], "u", shaken, 100 / stiffness()},
        {weight, starts[k], "u", shaken, 100 / stiffness()},
        {moved, starts[k], "u", followed, 1e-6},
        {velocity, starts[k], "u", followed, 1e-6},
        {nod, starts[k], "u", nodded, 1e-6},
        {nod, starts[k], "r", nod_support, 1e-6 * stiffness()},
        {nod_velocity, starts[k], "r", nod_support, 1e-6 * stiffness()},
    };
    for (size_t n = 0; n < sizeof all / sizeof *all; n++)
      falls_with_the_square(&all[n]);
  }
}

/* A formula that ends: the particle flies on as at the end of sin(p t). */
static double swung(double t, double end) {
  const double w = frequency(), p = 0.4 * w, s = t - end;
  if (t < end) return 1e-6 * sin(p * t);
  return 1e-6 * (sin(p * end) * cos(w * s) + p / w * cos(p * end) * sin(w * s));
}

static void a_formula_may_end(void **state) {
  (void)state;
  static const double ends[] = {40, 40.2, 40 + 1 / 3.0, 40 + 2 / 3.0, 40.8};
  const double p = 0.4 * frequency();
  char moved[512], velocity[512];
  snprintf(moved, sizeof moved,
           FIXED "&drive region = 'right' component = 'x' formula = '1 [um]*sin(%.17g [1/s]*t)' "
                 "end = %%.17g /\n",
           p);
  snprintf(velocity, sizeof velocity,
           FIXED "&drive region = 'right' component = 'x' formula = '%.17g [m/s]*cos(%.17g "
                 "[1/s]*t)' end = %%.17g /\n",
           1e-6 * p, p);
  for (size_t k = 0; k < sizeof ends / sizeof *ends; k++) {
    falls_with_the_square(&(motion){moved, ends[k], "u", swung, 1e-6});
    falls_with_the_square(&(motion){velocity, ends[k], "u", swung, 1e-6});
  }
}

/* --- against the same loads otherwise --------------------------------------------------------- */

/* A block whose sides are driven and pushed, with groups that the two ways differ in. */
#define BLOCK(groups)                                                                              \
  "&simulation end_time = 2e-5 step_safety = 0.5 threads = %d /\n"                                 \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"                     \
  "&region name = 'left' shape = 'rectangle' corner = -1, -1 size = 1.006, 2 /\n"                  \
  "&region name = 'right' shape = 'rectangle' corner = 0.094, -1 size = 1, 2 /\n"                  \
  "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n" groups                \
  "&monitor name = 'r' kind = 'reaction' region = 'left' component = 'x' /\n"                      \
  "&monitor name = 'u' kind = 'displacement' region = 'right' component = 'x' /\n"                 \
  "&output frames = 0 sample = 1e-7 /\n"

static void open_block(small_run *r, const char *format, int threads) {
  char text[4096];
  snprintf(text, sizeof text, format, threads);
  small_open(r, &elastic_beam, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* A number as a formula gives the same bits: the same instants, the same sums. */
static void a_constant_formula_is_a_constant(void **state) {
  (void)state;
  small_run plain, by_formula;
  open_block(&plain,
             BLOCK("&drive region = 'left' component = 'x' displacement = '1 um' history = "
                   "'ramp' rise = 1 start = '1 us' /\n"
                   "&force region = 'right' component = 'y' total = '2 kN' start = '3.3 us' end = "
                   "'9.1 us' /\n"
                   "&force region = 'right' component = 'rotation' moment = 3 /\n"
                   "&gravity acceleration = 0, -100 start = '2.2 us' /\n"),
             1);
  open_block(&by_formula,
             BLOCK("&drive region = 'left' component = 'x' formula = '1e-6 [m]*(t/1 [s])' start = "
                   "'1 us' /\n"
                   "&force region = 'right' component = 'y' formula = '2 [kN]' start = '3.3 us' "
                   "end = '9.1 us' /\n"
                   "&force region = 'right' component = 'rotation' formula = '3 [N*m]' /\n"
                   "&gravity acceleration = 0, -100 formula = '1' start = '2.2 us' /\n"),
             1);
  assert_int_equal(small_go(&plain), STEP_END);
  assert_int_equal(small_go(&by_formula), STEP_END);
  const double *a, *b;
  const long samples = simulation_history(plain.simulation, NULL);
  simulation_series(plain.simulation, small_series(&plain, "u"), NULL, &a);
  simulation_series(by_formula.simulation, small_series(&by_formula, "u"), NULL, &b);
  const double size = small_largest(&plain, "u");
  assert_true(size > 1e-12);
  for (long k = 0; k < samples; k++) /* but for the slope when the drive begins */
    assert_true(fabs(a[k] - b[k]) <= 1e-9 * size);
  small_close(&plain);
  small_close(&by_formula);
}

#define VARIED                                                                                     \
  "&drive region = 'left' component = 'x' formula = '5 [mm/s]*(1 + y/60 [mm])*cos(t/3 [us])' /\n"  \
  "&drive region = 'left' component = 'y' formula = '10 [nm]*(y/60 [mm])**2*sin(t/3 [us])' end = " \
  "'7.7 us' /\n"                                                                                   \
  "&force region = 'all' component = 'y' total = '2 kN' formula = 'exp(-((x - 10 [km/s]*t)/20 "    \
  "[mm])**2)' /\n"                                                                                 \
  "&force region = 'right' component = 'rotation' formula = '3 [N*m]*y/10 [mm]' start = '1 us' "   \
  "/\n&damping rate = 1000 /\n"

static void each_particle_has_its_own_value(void **state) {
  (void)state;
  small_run r;
  open_block(&r, BLOCK(VARIED), 1);
  const sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  for (int k = 0; k < 12; k++) {
    simulation_advance(r.simulation, 7, NULL);
    const double t = simulation_time(r.simulation);
    for (long p = 0; p < g->particle_count; p++) {
      const int64_t q = g->particle_site[p];
      if (g->x[q] > 0.006) continue;
      const double u = 5e-3 * (1 + g->y[q] / 0.06) * 3e-6 * sin(t / 3e-6),
                   v = 1e-8 * g->y[q] * g->y[q] / 0.0036 * sin(t / 3e-6);
      assert_true(fabs(w->body->displacement[0][q] - u) < 1e-5 * 3e-8);
      if (t < 7.6e-6) assert_true(fabs(w->body->displacement[1][q] - v) < 1e-12 * 1e-8);
    }
  }
  assert_true(small_go(&r) == STEP_END);
  /* bonds that turn are no linear springs */
  assert_true(small_largest(&r, "energy/imbalance") < 1e-7 * small_largest(&r, "energy/external"));
  small_close(&r);
}

static void threads_and_interruptions_keep_the_bits(void **state) {
  (void)state;
  small_run straight;
  open_block(&straight, BLOCK(VARIED), 1);
  assert_int_equal(small_go(&straight), STEP_END);
  const long total = simulation_step_count(straight.simulation);
  for (int k = 1; k < 4; k++) {
    small_run first, second;
    open_block(&first, BLOCK(VARIED), k + 1);
    open_block(&second, BLOCK(VARIED), 4 - k);
    hand_over(first.simulation, k * total / 4, second.simulation);
    assert_int_equal(small_go(&second), STEP_END);
    same_runs(&straight, &second);
    small_close(&first);
    small_close(&second);
  }
  small_close(&straight);
}

/* --- quasi-static runs ------------------------------------------------------------------------ */

static void increments_follow_formulas(void **state) {
  (void)state;
  static const char *const loads[] = {
      "&force region = 'right' component = 'x' formula = '100 [N]*(t/1 [s])**2' /\n",
      "&drive region = 'right' component = 'x' formula = '%.17g [m]*(t/1 [s])**2' /\n",
      "&drive region = 'right' component = 'x' formula = '2*%.17g [m/s]*(t/1 [s])' /\n"};
  for (size_t n = 0; n < sizeof loads / sizeof *loads; n++) {
    char load[512];
    snprintf(load, sizeof load, loads[n], 100 / stiffness());
    expect_quarters(load, (double[]){0, 1 / 16.0, 4 / 16.0, 9 / 16.0, 1});
  }
}

/* --- what is refused -------------------------------------------------------------------------- */

/* No number at the place of a particle: told before the run begins. */
static void a_formula_without_a_number_is_told(void **state) {
  (void)state;
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = %.17g /\n" PAIR
           "&force region = 'right' component = 'x' formula = '1 [N]/(x/10 [mm] - 1)' /\n",
           step_of(10));
  small_run r;
  small_open(&r, &elastic_bar, text);
  assert_null(r.simulation);
  assert_string_equal(r.said.items[r.said.count - 1].message,
                      "this formula has no finite value at (10, 0) mm, t = 0 s");
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(motions_and_forces_follow_formulas),
      cmocka_unit_test(a_formula_may_end),
      cmocka_unit_test(a_constant_formula_is_a_constant),
      cmocka_unit_test(each_particle_has_its_own_value),
      cmocka_unit_test(threads_and_interruptions_keep_the_bits),
      cmocka_unit_test(increments_follow_formulas),
      cmocka_unit_test(a_formula_without_a_number_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
