/* Gauges on meshes: linear fields at any place, free fall, an accelerated edge, places that are
   none. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/loads/mesh_gauge.h"
#include "tests/runtime/continuum/hooke_law.h"
#include "tests/runtime/small_run.h"

static void run(small_run *r, const char *text) {
  small_open(r, &hooke_law, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
  assert_int_equal(small_go(r), STEP_END);
}

#define GAUGE(name, kind, component, at)                                                           \
  "&monitor name = '" name "' kind = '" kind "' component = '" component "' at = " at " /\n"

/* A mesh all of whose nodes begin with u = (1e-4 + 2e-3 x - 4e-3 y, -3e-3 x + 1e-3 y): before any
   step gauges show that field, of elements, element-free nodes, and between them. */
#define LINEAR(mesh)                                                                               \
  "&simulation end_time = '20 us' step_safety = 0.5 /\n" mesh                                      \
  "&material mesh = 'plate' model = 'hooke' /\n"                                                   \
  "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"                       \
  "&initial_displacement region = 'all' component = 'x' "                                          \
  "value = '1e-4 [m] + 2e-3*x - 4e-3*y' /\n"                                                       \
  "&initial_displacement region = 'all' component = 'y' value = '1e-3*y - 3e-3*x' /\n" GAUGE(      \
      "xx1", "strain", "xx", "0.05, 0.11") GAUGE("xx2", "strain", "xx", "0.23, 0.31")              \
      GAUGE("xx3", "strain", "xx", "0.77, 0.219") GAUGE("yy", "strain", "yy", "0.77, 0.219")       \
          GAUGE("xy", "strain", "xy", "0.61, 0.4") GAUGE("sxx", "stress", "xx", "0.61, 0.4")       \
              GAUGE("sxy", "stress", "xy", "0.23, 0.31")                                           \
                  GAUGE("u1", "displacement", "x", "0.05, 0.11")                                   \
                      GAUGE("u2", "displacement", "y",                                             \
                            "0.77, 0.219") "&monitor name = 'mean' kind = 'displacement' "         \
                                           "component = 'x' region = 'some' /\n"                   \
                                           "&region name = 'some' shape = 'rectangle' corner = "   \
                                           "0.3, 0.15 size = 0.4, 0.2 /\n"

static void is_linear(const char *text) {
  small_run r;
  run(&r, text);
  const double E = 30e9, nu = 0.2;
  const struct {
    const char *name;
    double value;
  } known[] = {{"xx1", 2e-3},
               {"xx2", 2e-3},
               {"xx3", 2e-3},
               {"yy", 1e-3},
               {"xy", -3.5e-3},
               {"sxx", E / (1 - nu * nu) * (2e-3 + nu * 1e-3)},
               {"sxy", E / (1 + nu) * -3.5e-3},
               {"u1", 1e-4 + 2e-3 * 0.05 - 4e-3 * 0.11},
               {"u2", -3e-3 * 0.77 + 1e-3 * 0.219},
               {"mean", 1e-4 + 2e-3 * 0.5 - 4e-3 * 0.25}};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
    const double first = small_values(&r, known[k].name)[0];
    if (fabs(first - known[k].value) > 1e-10 * fabs(known[k].value))
      fail_msg("%s: %.15g is not %.15g", known[k].name, first, known[k].value);
  }
  small_close(&r);
}

static void linear_fields_are_shown_anywhere(void **state) {
  (void)state;
  is_linear(LINEAR("&mesh name = 'plate' size = 1, 0.5 nodes = 21, 11 thickness = 0.1 "
                   "method = 'finite_elements' /\n"));
  is_linear(LINEAR("&mesh name = 'plate' size = 1, 0.5 nodes = 21, 11 thickness = 0.1 "
                   "method = 'element_free' support = 2.6 /\n"
                   "&zone mesh = 'plate' method = 'finite_elements' shape = 'rectangle' "
                   "corner = 0, 0 size = 0.21, 0.5 /\n"));
  is_linear(LINEAR("&mesh name = 'plate' corners = 0, 0, 1, 0, 1, 0.5, 0, 0.5 nodes = 21, 11 "
                   "thickness = 0.1 method = 'finite_elements' /\n"));
}

/* u = 1e-3 (1 + x + 2 y + 4 x y) of one element with one point: what it knows is the strain in the
   middle, wherever the gauge is. */
static void one_point_speaks_for_its_element(const char *group) {
  static const char rest[] =
      "&simulation end_time = '1 ms' step_safety = 0.5 /\n"
      "&material mesh = 'plate' model = 'hooke' /\n"
      "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"
      "&initial_displacement region = 'all' component = 'x' "
      "value = '1e-3 [m] + 1e-3*x + 2e-3*y + 4e-3 [1/m]*x*y' /\n" GAUGE(
          "low", "strain", "xx", "0.1, 0.1") GAUGE("high", "strain", "xx", "0.9, 0.9")
          GAUGE("xy", "strain", "xy", "0.9, 0.1") GAUGE("stress", "stress", "xx", "0.1, 0.9");
  char text[2000];
  small_run r;
  snprintf(text, sizeof text, "%s%s", group, rest);
  run(&r, text);
  assert_true(fabs(small_values(&r, "low")[0] - 3e-3) < 1e-15);
  assert_true(fabs(small_values(&r, "high")[0] - 3e-3) < 1e-15);
  assert_true(fabs(small_values(&r, "xy")[0] - 2e-3) < 1e-15);
  assert_true(fabs(small_values(&r, "stress")[0] - 3e-3 * 30e9 / (1 - 0.04)) < 1e-3);
  small_close(&r);
}

static void elements_with_one_point_have_one_strain(void **state) {
  (void)state;
  one_point_speaks_for_its_element("&mesh name = 'plate' size = 1, 1 nodes = 2, 2 thickness = 0.1 "
                                   "method = 'finite_elements' gauss = 1 /\n");
  one_point_speaks_for_its_element("&mesh name = 'plate' corners = 0, 0, 1, 0, 1, 1, 0, 1 "
                                   "nodes = 2, 2 thickness = 0.1 method = 'finite_elements' "
                                   "gauss = 1 /\n");
}

#define ZONED                                                                                      \
  "&simulation end_time = '2 ms' step_safety = 0.6 /\n&output sample = '50 us' /\n"                \
  "&mesh name = 'plate' size = 1, 0.5 nodes = 21, 11 thickness = 0.1 method = 'element_free' /\n"  \
  "&zone mesh = 'plate' method = 'finite_elements' shape = 'rectangle' corner = 0, 0 "             \
  "size = 0.21, 0.5 /\n"                                                                           \
  "&material mesh = 'plate' model = 'hooke' /\n"                                                   \
  "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"                       \
  "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, 0.5 /\n"

/* y = v t - g t^2/2 at every sample, without strain. */
static void a_mesh_falls_freely(void **state) {
  (void)state;
  small_run r;
  run(&r,
      ZONED "&gravity acceleration = 0, -9.81 /\n"
            "&initial_velocity region = 'all' component = 'y' value = 2 /\n"
            "&monitor name = 'u' kind = 'displacement' component = 'y' region = 'all' /\n"
            "&monitor name = 'v' kind = 'velocity' component = 'y' region = 'all' /\n"
            "&monitor name = 'a' kind = 'acceleration' component = 'y' region = 'all' /\n" GAUGE(
                "at", "acceleration", "y", "0.7, 0.3") GAUGE("vat", "velocity", "y", "0.7, 0.3")
                GAUGE("xx", "strain", "xx", "0.7, 0.3"));
  const double *time, *u = small_values(&r, "u"), *v = small_values(&r, "v"),
                      *a = small_values(&r, "a"), *at = small_values(&r, "at"),
                      *vat = small_values(&r, "vat"), *xx = small_values(&r, "xx");
  const long count = simulation_history(r.simulation, &time);
  assert_true(count > 3);
  for (long k = 0; k < count; k++) {
    const double t = time[k];
    assert_true(fabs(u[k] - (2 * t - 0.5 * 9.81 * t * t)) < 1e-12);
    assert_true(fabs(v[k] - (2 - 9.81 * t)) < 1e-9 && fabs(vat[k] - (2 - 9.81 * t)) < 1e-9);
    assert_true(fabs(a[k] + 9.81) < 1e-6 && fabs(at[k] + 9.81) < 1e-6);
    assert_true(fabs(xx[k]) < 1e-12);
  }
  assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-9 * small_last(&r, "energy/kinetic"));
  small_close(&r);
}

/* x = a t^2/2 of an edge that is driven; the whole follows. */
static void an_edge_may_be_accelerated(void **state) {
  (void)state;
  small_run r;
  run(&r, ZONED "&drive region = 'left' component = 'x' acceleration = '1000 m/s^2' /\n"
                "&monitor name = 'u' kind = 'displacement' component = 'x' region = 'left' /\n"
                "&monitor name = 'v' kind = 'velocity' component = 'x' region = 'left' /\n"
                "&monitor name = 'a' kind = 'acceleration' component = 'x' region = 'left' /\n");
  const double *time, *u = small_values(&r, "u"), *v = small_values(&r, "v"),
                      *a = small_values(&r, "a");
  const long count = simulation_history(r.simulation, &time);
  assert_true(count > 3);
  for (long k = 1; k < count; k++) { /* at 0 the acceleration jumps */
    assert_true(fabs(u[k] - 500 * time[k] * time[k]) < 1e-12);
    assert_true(fabs(v[k] - 1000 * time[k]) < 1e-9);
    assert_true(fabs(a[k] - 1000) < 1e-5);
  }
  assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-9 * small_last(&r, "energy/external"));
  small_close(&r);
}

static void wrong(const char *text, const char *message) {
  small_run r;
  bool found = false;
  small_open(&r, &hooke_law, text);
  assert_null(r.simulation);
  for (int k = 0; k < r.said.count; k++)
    found = found || strstr(r.said.items[k].message, message);
  if (!found) small_print(&r);
  assert_true(found);
  small_close(&r);
}

static void what_is_not_shown_is_told(void **state) {
  (void)state;
  wrong(ZONED GAUGE("xx", "strain", "xx", "0.7, 3"), "is not in the mesh");
  wrong(ZONED "&monitor name = 'u' kind = 'displacement' component = 'x' /\n",
        "needs `region` or `at`");
  wrong(ZONED "&drive region = 'left' component = 'x' acceleration = 3 rise = '1 ms' /\n",
        "an acceleration is constant");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(linear_fields_are_shown_anywhere),
                                     cmocka_unit_test(a_mesh_falls_freely),
                                     cmocka_unit_test(an_edge_may_be_accelerated),
                                     cmocka_unit_test(elements_with_one_point_have_one_strain),
                                     cmocka_unit_test(what_is_not_shown_is_told)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
