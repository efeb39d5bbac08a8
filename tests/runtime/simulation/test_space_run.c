/* Runs of bodies in space, with a law of springs by hand: drives, supports, forces, gravity and
   velocities along z, what monitors and frames say of them, and the same bits for any number of
   threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "tests/runtime/small_run.h"
#include "tests/runtime/spring_law.h"

#define HEAD(kind, more)                                                                           \
  "&simulation end_time = '2 ms' step = '5 us' " more " /\n"                                       \
  "&lattice name = 'block' kind = " kind " spacing = '10 mm' origin = '5 mm', '5 mm', '5 mm' /\n"  \
  "&material lattice = 'block' model = 'm' /\n"                                                    \
  "&region name = 'all' shape = 'sphere' centre = 0, 0, 0 radius = 1 /\n"                          \
  "&output frames = 2 fields = 'displacement', 'velocity', 'force' /\n"

static small_run run_of(const char *text) {
  small_run r;
  small_open(&r, &springs, text);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  return r;
}

/* Nothing but velocity and weight: every particle flies alike. */
static void a_free_body_flies(void **state) {
  (void)state;
  small_run r = run_of(
      HEAD("'fcc' shells = 2",
           "") "&body lattice = 'block' shape = 'box' corner = 0, 0, 0 "
               "size = '60 mm', '50 mm', '40 mm' /\n"
               "&gravity acceleration = '1 m/s^2', 0, '-9.81 m/s^2' /\n"
               "&initial_velocity region = 'all' component = 'z' value = '2 m/s' /\n"
               "&monitor name = 'w' kind = 'displacement' region = 'all' component = 'z' /\n"
               "&monitor name = 'u' kind = 'displacement' region = 'all' component = 'x' /\n"
               "&monitor name = 'fall' kind = 'velocity' region = 'all' component = 'z' /\n");
  const double t = 2e-3;
  assert_true(fabs(small_last(&r, "w") - (2 * t - 0.5 * 9.81 * t * t)) < 1e-12);
  assert_true(fabs(small_last(&r, "u") - 0.5 * t * t) < 1e-12);
  assert_true(fabs(small_last(&r, "fall") - (2 - 9.81 * t)) < 1e-12);
  const rows *w = simulation_rows(r.simulation, 0);
  assert_int_equal(2 * w->directions, 18);
  assert_true(fabs(w->depth - w->infinite.step[2] * round(w->depth / w->infinite.step[2])) < 1e-12);
  small_close(&r);
}

#define PULLED(kind, more)                                                                         \
  HEAD(kind, more)                                                                                 \
  "&body lattice = 'block' shape = 'box' corner = 0, 0, 0 size = '50 mm', '50 mm', '80 mm' /\n"    \
  "&notch lattice = 'block' shape = 'face' points = 0, -1, '41 mm', '21 mm', -1, '41 mm', "        \
  "'21 mm', 1, '41 mm', 0, 1, '41 mm' /\n"                                                         \
  "&region name = 'foot' shape = 'box' corner = -1, -1, -1 size = 2, 2, '1.006 m' /\n"             \
  "&region name = 'top' shape = 'box' corner = -1, -1, '73 mm' size = 2, 2, 1 /\n"                 \
  "&support region = 'foot' fix = 'xyz' /\n"                                                       \
  "&drive region = 'top' component = 'z' displacement = '0.1 mm' rise = '1.5 ms' /\n"              \
  "&damping rate = '3000 1/s' /\n"                                                                 \
  "&monitor name = 'below' kind = 'reaction' region = 'foot' component = 'z' /\n"                  \
  "&monitor name = 'above' kind = 'reaction' region = 'top' component = 'z' /\n"                   \
  "&monitor name = 'lift' kind = 'opening' between = 'foot', 'top' component = 'z' /\n"

static void a_block_is_pulled_along_z(void **state) {
  (void)state;
  static const char *const kinds[] = {"cubic", "fcc"};
  const char *texts[] = {PULLED("'cubic' horizon = 2", ""), PULLED("'fcc'", "")};
  for (int k = 0; k < 2; k++) {
    small_run r = run_of(texts[k]);
    const double up = small_last(&r, "above"), down = small_last(&r, "below");
    print_message("%s: pulled by %.3f N, held by %.3f N; %.4f J of work, %.2e J out of balance\n",
                  kinds[k], up, -down, small_last(&r, "energy/external"),
                  small_last(&r, "energy/imbalance"));
    assert_true(fabs(small_last(&r, "lift") - 1e-4) < 1e-9);
    assert_true(up > 10 && fabs(up + down) < 0.05 * up);
    assert_true(fabs(small_last(&r, "energy/imbalance")) <
                1e-3 * small_last(&r, "energy/external"));
    small_close(&r);
  }
}

/* The face opens: only bonds that do not cross it carry. */
static void a_face_parts_the_bonds(void **state) {
  (void)state;
  small_run r = run_of(PULLED("'cubic'", ""));
  const rows *w = simulation_rows(r.simulation, 0);
  const sweep *s = simulation_state(r.simulation, 0);
  long cut = 0;
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p], up = rows_partner(w, site, 2);
    if (!w->present[up] || rows_has_bond(w, site, 2)) continue;
    cut++;
    assert_true(w->x[site] < 0.021 && fabs(w->z[site] - 0.035) < 1e-9);
    assert_true(s->body->displacement[2][up] - s->body->displacement[2][site] > 5e-6);
  }
  assert_int_equal(cut, 2 * 5);
  small_close(&r);
}

static void frames_have_three_components(void **state) {
  (void)state;
  small_run r = run_of(PULLED("'fcc'", ""));
  const frame_field *fields;
  const long count = simulation_rows(r.simulation, 0)->particle_count;
  assert_int_equal(simulation_frame_fields(r.simulation, &fields), 3);
  double *values = malloc(3 * (size_t)count * sizeof *values);
  double sum = 0, largest = 0;
  for (int f = 0; f < 3; f++)
    assert_int_equal(fields[f].components, 3);
  assert_string_equal(fields[2].name, "force");
  simulation_frame_values(r.simulation, 2, values);
  for (long p = 0; p < count; p++) {
    sum += values[3 * p + 2];
    largest = fmax(largest, fabs(values[3 * p + 2]));
  }
  assert_true(largest > 1 && fabs(sum) < 1e-9 * largest);
  simulation_frame_values(r.simulation, 0, values);
  assert_true(fabs(values[3 * (count - 1) + 2] - 1e-4) < 1e-12);
  free(values);
  small_close(&r);
}

static void threads_do_not_change_bits(void **state) {
  (void)state;
  small_run one = run_of(PULLED("'fcc'", "threads = 1")),
            three = run_of(PULLED("'fcc'", "threads = 3"));
  const sweep *a = simulation_state(one.simulation, 0), *b = simulation_state(three.simulation, 0);
  const size_t bytes = (size_t)simulation_rows(one.simulation, 0)->size * sizeof(double);
  for (int c = 0; c < 3; c++)
    assert_memory_equal(a->body->displacement[c], b->body->displacement[c], bytes);
  assert_true(small_last(&one, "above") == small_last(&three, "above"));
  small_close(&one);
  small_close(&three);
}

static void expect(const char *text, const pl_law *law, const char *part) {
  small_run r;
  small_open(&r, law, text);
  assert_null(r.simulation);
  assert_true(r.said.errors > 0);
  assert_non_null(strstr(r.said.items[0].message, part));
  small_close(&r);
}

static void laws_keep_to_their_lattices(void **state) {
  (void)state;
  static const char block[] =
      HEAD("'cubic'",
           "") "&body lattice = 'block' shape = 'sphere' centre = 0, 0, 0 radius = '30 mm' /\n";
  static const char plate[] =
      "&simulation end_time = 1 /\n"
      "&lattice name = 'plate' kind = 'hexagonal' spacing = 1 thickness = 1 %s /\n"
      "&material lattice = 'plate' model = 'm' /\n"
      "&body lattice = 'plate' shape = 'disc' centre = 0, 0 radius = 5 /\n";
  char text[1024];
  snprintf(text, sizeof text, plate, "shells = 2");
  expect(text, &elastic_beam, "hexagonal lattice of nearest neighbours");
  expect(block, &elastic_beam, "is of the plane, the lattice is in space");
  snprintf(text, sizeof text, plate, "");
  expect(text, &springs, "is of space, the lattice is in the plane");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_free_body_flies),          cmocka_unit_test(a_block_is_pulled_along_z),
      cmocka_unit_test(a_face_parts_the_bonds),     cmocka_unit_test(frames_have_three_components),
      cmocka_unit_test(threads_do_not_change_bits), cmocka_unit_test(laws_keep_to_their_lattices),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
