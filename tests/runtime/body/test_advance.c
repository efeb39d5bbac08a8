/* A row of particles under known forces: v = F t/m, places follow, work is counted, and what leaves
   the limits stays. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/body/advance.h"
#include "tests/runtime/built_rows.h"

static const char line[] =
    "&simulation end_time = 1 /\n"
    "&lattice name = 'l' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
    "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = 0.07, 0.001 /\n"
    "&material lattice = 'l' model = 'm' /\n";

static void free_particles_gain_speed(void **state) {
  (void)state;
  enum { STEPS = 10 };
  const double step = 1e-4, force = 3;
  built_rows r;
  build_rows(&r, line);
  rows_set_density(r.rows, 2000);
  body *b = body_new(r.rows, 2, step, 1, BODY_SHARE_ROWS);
  const long site = r.rows->particle_site[3], start = body_start(b, 0);
  const double *forces[PL_MAX_DOF] = {b->force[0] + start, b->force[1] + start};
  b->works = true;
  b->force[0][site] = force;
  for (int n = 1; n <= STEPS; n++) {
    advance_row(b, b->blocks, 0, forces);
    const double v = force * n * step / b->mass[0];
    assert_true(fabs(b->velocity[0][site] / v - 1) < 1e-14);
    assert_true(b->velocity[0][site - 1] == 0 && b->velocity[1][site] == 0);
  }
  const double way = force / b->mass[0] * step * step * STEPS * (STEPS + 1) / 2;
  assert_true(fabs(b->displacement[0][site] / way - 1) < 1e-14);
  /* against the bonds: half of each step's force with the velocity before and after */
  const double last = b->velocity[0][site];
  assert_true(fabs(-b->row_internal[0] / (0.5 * b->mass[0] * last * last) - 1) < 1e-13);
  body_free(b);
  built_end(&r);
}

static void a_row_that_is_too_fast_stays(void **state) {
  (void)state;
  built_rows r;
  build_rows(&r, line);
  rows_set_density(r.rows, 2000);
  body *b = body_new(r.rows, 2, 1e-4, 1, BODY_SHARE_ROWS);
  const long site = r.rows->particle_site[5], start = body_start(b, 0);
  const double *forces[PL_MAX_DOF] = {b->force[0] + start, b->force[1] + start};
  b->blocks[0].bad_site = -1;
  b->force[1][site] = 1e9;
  advance_row(b, b->blocks, 0, forces);
  assert_int_equal(b->blocks[0].bad_site, site);
  assert_true(b->velocity[1][site] == 0 && b->displacement[1][site] == 0);
  body_free(b);
  built_end(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(free_particles_gain_speed),
                                     cmocka_unit_test(a_row_that_is_too_fast_stays)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
