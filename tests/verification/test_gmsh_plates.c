/* Plates from Gmsh: a hole beside Kirsch's solution, and what the example's page says. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"
#include "tests/verification/page.h"

#define PLATE "examples/plate_gmsh/"

typedef struct answer {
  double top, side, pull, stretch, hole, energy;
} answer;

static double last(const deck_case *c, const char *series, bool there) {
  return there ? deck_case_last(c, series) : 0;
}

static answer solved(const char *file, const char *const *changes, int count, bool quarter) {
  deck_case c;
  assert_true(deck_case_run(&c, file, changes, count));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const answer a = {last(&c, "top", quarter),         last(&c, "side", quarter),
                    deck_case_last(&c, "pull"),       last(&c, "stretch", !quarter),
                    last(&c, "large_hole", !quarter), deck_case_last(&c, "energy/stored")};
  assert_true(fabs(deck_case_last(&c, "energy/external") - a.energy) < 1e-9 * a.energy);
  deck_case_close(&c);
  return a;
}

static void says(const char *row, const char *format, double value) {
  char figure[64];
  snprintf(figure, sizeof figure, format, value);
  page_line_says(PLATE "README.md", row, figure);
}

/* The force through the line above the hole: the integral of 1 + 1/(2 r^2) + 3/(2 r^4) from 1 to
   5. */
static void a_hole_is_as_kirsch_says(void **state) {
  (void)state;
  static const char *const file[] = {"mesh.file=hole_t3.msh"};
  const answer six = solved(PLATE "hole.nml", NULL, 0, true),
               three = solved(PLATE "hole.nml", file, 1, true);
  assert_true(fabs(six.top - 3) < 0.03 && fabs(six.side + 1) < 0.03);
  assert_true(fabs(three.top - 3) < 0.5);
  const double pull = 4 + 0.5 * (1 - 1.0 / 5) + 0.5 * (1 - 1.0 / 125);
  assert_true(fabs(six.pull - pull) < 1e-4 && fabs(three.pull - pull) < 1e-3);
  says("| 374 triangles of 6 nodes", "| %.3f |", six.top);
  says("| 374 triangles of 6 nodes", "| %.3f |", six.side);
  says("| 374 triangles of 3 nodes", "| %.3f |", three.top);
  says("| 374 triangles of 3 nodes", "| %.3f |", three.side);
}

/* Fewer freedoms are stiffer under a load: the energy of the coarser mesh is less. */
static void the_plate_with_holes(void **state) {
  (void)state;
  static const char *const file[] = {"mesh.file=plate_t3.msh"};
  const answer six = solved(PLATE "plate.nml", NULL, 0, false),
               three = solved(PLATE "plate.nml", file, 1, false);
  assert_true(fabs(six.pull - 120e3) < 1e-6 * 120e3 && fabs(three.pull - 120e3) < 1e-6 * 120e3);
  assert_true(three.energy < six.energy && three.energy > 0.97 * six.energy);
  /* the edge moves as one, nearly: the work is half of force times way */
  assert_true(fabs(six.energy - 0.5 * six.pull * six.stretch) < 0.01 * six.energy);
  says("| mean stretch", "| %.4f |", 1e3 * six.stretch);
  says("| mean stretch", "| %.4f |", 1e3 * three.stretch);
  says("| stress at the top of the large hole", "| %.1f |", 1e-6 * six.hole);
  says("| stress at the top of the large hole", "| %.1f |", 1e-6 * three.hole);
  says("| stored energy", "| %.3f |", six.energy);
  says("| stored energy", "| %.3f |", three.energy);
}

/* The sections through the large hole and through both small ones have 80 mm x 10 mm: they flow at
   250 MPa times that, and harden by a few per cent. */
static void the_plate_that_yields(void **state) {
  (void)state;
  deck_case c;
  assert_true(deck_case_run(&c, PLATE "plate_yield.nml", NULL, 0));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double load = deck_case_last(&c, "load"), limit = 250e6 * 80e-3 * 10e-3,
               external = deck_case_last(&c, "energy/external");
  assert_true(load > limit && load < 1.12 * limit);
  assert_true(deck_case_last(&c, "energy/dissipated_damage") > 0.5 * external);
  assert_true(fabs(deck_case_last(&c, "energy/imbalance")) < 1e-9 * external);
  says("| load, kN", "| %.1f |", 1e-3 * load);
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_hole_is_as_kirsch_says),
                                     cmocka_unit_test(the_plate_with_holes),
                                     cmocka_unit_test(the_plate_that_yields)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
