/* The specimens of examples/ for the state-based lattice beside an independent computation of the
   same protocols and the theory (Nikravesh 2017, chapter 5): peaks, and in tension the work of
   fracture. Prints the table of the pages of the examples. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/specimen.h"

typedef struct specimen {
  const char *deck, *until, *more;
  double reference;           /* N */
  double theory, least, most; /* N; parts of it: what the peak must lie between */
  bool symmetric;
} specimen;

static const double compression = 620.55e3, brazilian = 193.0e3, cylinder = 236.0e3,
                    bone_b = 14.49e3, bone_d = 57.96e3;

/* 1 % of the reference, whose peaks are those of every step, not of samples. 1e-8: roundings tell
   left from right. */
static void compare(const specimen *s) {
  const outcome o = specimen_run(s->deck, s->until, s->more);
  print_message("%-42s %-20s %8.2f kN, reference %7.2f (%+.2f %%), theory %7.2f (%+.1f %%), ends "
                "%.0e, asymmetry "
                "%.0e\n",
                s->deck, s->more ? s->more : "", 1e-3 * o.peak, 1e-3 * s->reference,
                100 * (o.peak / s->reference - 1), 1e-3 * s->theory, 100 * (o.peak / s->theory - 1),
                o.ends, o.asymmetry);
  assert_true(fabs(o.peak / s->reference - 1) < 0.01);
  assert_true(o.peak > s->least * s->theory && o.peak < s->most * s->theory);
  if (s->symmetric) assert_true(o.asymmetry < 1e-8);
}

static void compare_all(const specimen *s, int count) {
  for (int k = 0; k < count; k++)
    compare(&s[k]);
}

static void prisms_in_compression(void **state) {
  (void)state;
  static const specimen list[] = {
      {"examples/compression/rot30.nml", "8.8 ms", NULL, 588700, compression, 0.90, 1.02, true},
      {"examples/compression/rot0_objective.nml", "8.4 ms", NULL, 581500, compression, 0.86, 1.02,
       true},
      {"examples/compression/rot30_objective.nml", "8.8 ms", NULL, 588700, compression, 0.86, 1.02,
       true},
  };
  compare_all(list, 3);
}

/* The published profile fails early in a lattice turned by 15 degrees. At the first damage, at 355
   to 360 kN, the load falls for good or recovers once more: differences of a thousandth in the
   angle or the speed decide which, and peaks from 347 to 433 kN have been computed. */
static void the_published_profile_depends_on_the_rotation(void **state) {
  (void)state;
  const outcome o = specimen_run("examples/compression/rot15.nml", "6.5 ms", NULL);
  print_message("examples/compression/rot15.nml: %.1f kN (%+.1f %% of the theory)\n", 1e-3 * o.peak,
                100 * (o.peak / compression - 1));
  assert_true(o.peak > 340e3 && o.peak < 435e3);
}

static void split_cylinders(void **state) {
  (void)state;
  static const specimen list[] = {
      {"examples/brazilian/rot0.nml", "5.6 ms", NULL, 197500, brazilian, 0.92, 1.07, true},
      {"examples/brazilian/rot15.nml", "5.6 ms", NULL, 191100, brazilian, 0.92, 1.07, false},
      {"examples/brazilian/rot30.nml", "5.7 ms", NULL, 184900, brazilian, 0.92, 1.07, true},
      {"examples/brazilian/rot0_objective.nml", "5.8 ms", NULL, 203800, brazilian, 0.92, 1.07,
       true},
      {"examples/brazilian/rot15_objective.nml", "5.8 ms", NULL, 193800, brazilian, 0.92, 1.07,
       false},
      {"examples/brazilian/rot30_objective.nml", "5.8 ms", NULL, 187300, brazilian, 0.92, 1.07,
       true},
      {"examples/cylinder/rot0.nml", "5.6 ms", NULL, 241300, cylinder, 0.92, 1.07, true},
      {"examples/cylinder/rot15.nml", "5.6 ms", NULL, 233400, cylinder, 0.92, 1.07, false},
      {"examples/cylinder/rot30.nml", "5.7 ms", NULL, 225900, cylinder, 0.92, 1.07, true},
  };
  compare_all(list, 9);
}

static void dog_bones(void **state) {
  (void)state;
  static const specimen list[] = {
      {"examples/dog_bone/b_s4.nml", "3.4 ms", NULL, 14600, bone_b, 0.95, 1.05, true},
      {"examples/dog_bone/b_s4.nml", "3.4 ms", "lattice.rotation=15", 14340, bone_b, 0.95, 1.05,
       false},
      {"examples/dog_bone/b_s4.nml", "3.4 ms", "lattice.rotation=30", 14370, bone_b, 0.95, 1.05,
       true},
      {"examples/dog_bone/b_s2.nml", "3.4 ms", NULL, 14850, bone_b, 0.95, 1.05, true},
      {"examples/dog_bone/d_s8.nml", "10.6 ms", NULL, 57390, bone_d, 0.95, 1.05, true},
  };
  compare_all(list, 5);
}

/* Energy that damage and the dampers in the bonds took, over G_f times the section. It is no
   constant of the law: one crack is several rows wide, and rows beside it are damaged. 3 %: the
   speed of the test and the last bonds' dampers. */
static void the_work_of_fracture_is_more_than_the_fracture_energy(void **state) {
  (void)state;
  static const struct {
    const char *deck;
    double expected;
  } list[] = {{"examples/tension/rot0.nml", 1.37},
              {"examples/tension/rot15.nml", 1.43},
              {"examples/tension/rot30.nml", 1.58}};
  const double G_f = 81.43, section = 0.15 * 0.15; /* N/m, m^2 */
  for (int k = 0; k < 3; k++) {
    const outcome o = specimen_run(list[k].deck, NULL, NULL);
    print_message("%s: work of fracture %.3f G_f (expected %.2f), with mass damping %.3f\n",
                  list[k].deck, o.lost / (G_f * section), list[k].expected,
                  o.external / (G_f * section));
    assert_true(fabs(o.lost / (G_f * section) / list[k].expected - 1) < 0.03);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(prisms_in_compression),
      cmocka_unit_test(the_published_profile_depends_on_the_rotation),
      cmocka_unit_test(split_cylinders),
      cmocka_unit_test(dog_bones),
      cmocka_unit_test(the_work_of_fracture_is_more_than_the_fracture_energy),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
