/* Laws whose return or whose strain along z is not found: the run stops and names the point, its
   states and the line of the law, and writes a path that shows it; `check` and `drive` say so,
   too. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"

/* Newton's method goes off where an angle is more than 1.39 times its width beyond the limit. */
static const char angle_law[] =
    "model angle\n"
    "  law continuum\n"
    "  for plane_strain, plane_stress\n"
    "  parameter E = 200 [GPa]  in (0, inf)\n"
    "  parameter nu = 0.3  in [0, 0.5)\n"
    "  parameter f_y = 250 [MPa]  in (0, inf)\n"
    "  parameter w = 0.1 [MPa]  in (0, inf)\n"
    "  parameter rho = 7850 [kg/m^3]  in (0, inf)\n"
    "  state eps_bar on point = 0\n"
    "  state eps_p on point = tensor 0\n"
    "  constant mu = E/(2*(1 + nu))\n"
    "  trial = 2*mu*dev(strain - eps_p)\n"
    "  q = von_mises(trial)\n"
    "  yield f = atan2(q - f_y - 3*mu*(eps_bar - previous(eps_bar)), w)\n"
    "  flow eps_bar along 1 returned when f >= 0\n"
    "  eps_p = eps_p + 3/2*(eps_bar - previous(eps_bar))*trial/max(q, 1 [Pa])\n"
    "  stress sigma = hooke(strain - eps_p, E, nu)\n"
    "end model\n";

/* The stress along z is never 0: beside Hooke's there is one that grows with the pull along x and
   does not know z, and Hooke's has an end. */
static const char pinched_law[] =
    "model pinched\n"
    "  law continuum\n"
    "  for plane_stress, anisotropic\n"
    "  parameter E = 1 [GPa]  in (0, inf)\n"
    "  parameter c = 100 [MPa]  in (0, inf)\n"
    "  parameter rho = 1000 [kg/m^3]  in (0, inf)\n"
    "  pull = E*strain[x,x]\n"
    "  across = c*tanh(E*strain[z,z]/c)\n"
    "  stress sigma = tensor(pull, E*strain[y,y], across + pull, E*strain[x,y])\n"
    "  nonconservative \"a test\"\n"
    "end model\n";

static void write_bar(const workplace *w, const char *law, const char *text, const char *setting,
                      const char *velocity) {
  char file[64], deck[2000];
  snprintf(file, sizeof file, "%s.plm", law);
  write_text(w, file, text);
  snprintf(deck, sizeof deck,
           "&simulation  end_time = '0.1 ms'  /\n"
           "&mesh      name = 'bar'  size = '200 mm', '20 mm'  nodes = 41, 5  thickness = '10 mm'\n"
           "           method = 'finite_elements'  setting = '%s' /\n"
           "&material  mesh = 'bar'  model = './%s.plm' /\n"
           "&region    name = 'left'  shape = 'segment'  from = 0, 0  to = 0, '20 mm' /\n"
           "&drive     region = 'left'  component = 'x'  velocity = '%s'  rise = '10 us' /\n"
           "&output    result = 'bar.h5'  frames = 0  sample = '5 us' /\n",
           setting, law, velocity);
  write_text(w, "bar.nml", deck);
}

static void a_lost_return_stops_the_run(void **state) {
  static const char *const settings[] = {"plane_strain", "plane_stress"};
  workplace *w = *state;
  for (int k = 0; k < 2; k++) {
    write_bar(w, "angle", angle_law, settings[k], "-20 m/s");
    expect(w, "run bar.nml", 2,
           "angle.plm:15: the law's `eps_bar` does not come back to its limit");
    expect(w, "run bar.nml", 2, "of cell (");
    expect(w, "run bar.nml", 2, ", eps_bar 0, eps_p_xx 0");
    expect(w, "run bar.nml", 2, "this point alone: perilat drive bar_bad_point.nml");
    expect(w, "drive bar_bad_point.nml", 2, "`stress_xx` is not a number");
    expect(w, "drive bar_bad_point.nml", 2,
           "angle.plm:15: the law's `eps_bar` does not come back to its limit");
  }
}

/* A row of squares of a file, which numbers them from 100 on. */
static void a_cell_of_a_file_has_its_number(void **state) {
  workplace *w = *state;
  write_bar(w, "angle", angle_law, "plane_strain", "-20 m/s");
  assert_int_equal(
      shell(w, "awk 'BEGIN { n = 20; print \"$MeshFormat\\n4.1 0 8\\n$EndMeshFormat\\n$Nodes\"; "
               "print 1, 2*n + 2, 1, 2*n + 2; print 2, 1, 0, 2*n + 2; "
               "for (k = 1; k <= 2*n + 2; k++) print k; "
               "for (k = 0; k <= 2*n + 1; k++) print 10*int(k/2), 10*(k%%2), 0; "
               "print \"$EndNodes\\n$Elements\"; print 1, n, 100, 99 + n; print 2, 1, 3, n; "
               "for (k = 0; k < n; k++) print 100 + k, 2*k + 1, 2*k + 3, 2*k + 4, 2*k + 2; "
               "print \"$EndElements\" }' > bar.msh && "
               "sed -i \"s/size = .* nodes = 41, 5/file = 'bar.msh'  unit = 'mm'/; "
               "s/method = 'finite_elements'//; s/'20 mm' \\//'10 mm' \\//\" bar.nml"),
      0);
  expect(w, "run bar.nml", 2, " mm of cell 100: strain xx");
  assert_int_equal(shell(w, "grep -q ' m of cell 100 where a run stopped' bar_bad_point.nml"), 0);
}

/* Small steps never go far beyond the limit. */
static void the_same_law_goes_in_small_steps(void **state) {
  workplace *w = *state;
  write_text(w, "angle.plm", angle_law);
  write_text(w, "path.nml",
             "&simulation steps = 20000 /\n&point setting = 'plane_strain' /\n"
             "&material model = 'angle.plm' /\n"
             "&path quantity = 'strain_xy' value = 5e-3 rise = '1 s' /\n"
             "&output rows = 5 /\n"
             "&expect quantity = 'stress_xy' formula = 'f_y/sqrt(3)' tolerance = 1e-12 /\n");
  expect(w, "drive path.nml", 0, "1 of 1");
  expect(w, "drive path.nml --set simulation.steps=10", 2, "does not come back to its limit");
}

/* Pulled along x by more than 0.1 the bar has no strain along z without stress. The least one is
   told also where strains end beyond which there is no stress. */
static void a_lost_thickness_stops_the_run(void **state) {
  workplace *w = *state;
  write_bar(w, "pinched", pinched_law, "plane_stress", "-300 m/s");
  expect(w, "run bar.nml", 2, "no strain along z is found that leaves no stress there");
  expect(w, "run bar.nml", 2, " MPa in size at least, at -");
  expect(w, "run bar.nml", 2, "; no smaller step finds one: a law whose stress along z rises");
  expect(w, "drive bar_bad_point.nml", 2, "no strain along z is found that leaves no stress there");
  assert_int_equal(shell(w, "sed -i 's/  across = .*/& - 1 [Pa]*tanh(sqrt(1 - "
                            "5*strain[z,z]))/' pinched.plm"),
                   0);
  expect(w, "run bar.nml", 2, " MPa in size at least, at -");
}

/* As the volume shrinks the stress along z stops rising, before there is no energy any more. What
   only has cases jumps as other laws do. */
static void check_tells_folds_from_jumps(void **state) {
  workplace *w = *state;
  expect(w, "check '" SOURCE_DIR "/tests/generator/check/physics/continuity_point_fold.plm'", 0,
         "the strain along z that leaves no stress there ends here");
  assert_int_equal(shell(w, "sed 's/for plane_stress.*/for plane_stress/' '" SOURCE_DIR
                            "/tests/generator/check/physics/continuity_point.plm' > halves.plm"),
                   0);
  expect(w, "check halves.plm", 0, "let the values of the cases meet where one ends");
}

static void check_says_so(void **state) {
  workplace *w = *state;
  write_text(w, "angle.plm", angle_law);
  expect(w, "check angle.plm", 0, "a flow that does not come back to its limit");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_lost_return_stops_the_run),
      cmocka_unit_test(a_cell_of_a_file_has_its_number),
      cmocka_unit_test(the_same_law_goes_in_small_steps),
      cmocka_unit_test(a_lost_thickness_stops_the_run),
      cmocka_unit_test(check_says_so),
      cmocka_unit_test(check_tells_folds_from_jumps),
  };
  return cmocka_run_group_tests(tests, set_up_workplace, tear_down_workplace);
}
