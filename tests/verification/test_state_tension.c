/* The state-based lattice in tension, up to just past the peak: the prism at three rotations of the
   lattice and the coarsest dog-bone (Nikravesh 2017, sections 5.2.2 and 5.4), beside the strength
   times the section and an independent computation of the same protocol. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/specimen.h"

typedef struct tension {
  const char *deck, *until;
  double reference, theory; /* N */
  double least, most;       /* of the peak over the theory */
  bool symmetric;
} tension;

/* 1 % of the reference: its settings (when the load is sampled, by what way the ends are held) move
   the peaks by 0.5 %. The band about the theory is the effect of the outline: particles there have
   fewer bonds. At 15 degrees the outline is ragged. 1e-8: roundings tell left from right, and
   softening amplifies them. */
static void check(const tension *t) {
  const outcome o = specimen_run(t->deck, t->until, NULL);
  print_message("%s: peak %.1f N at %.3f ms (reference %.0f: %+.2f %%; theory %.0f: %+.2f %%), "
                "ends differ by %.1e, "
                "asymmetry %.1e\n",
                t->deck, o.peak, 1e3 * o.time, t->reference, 100 * (o.peak / t->reference - 1),
                t->theory, 100 * (o.peak / t->theory - 1), o.ends, o.asymmetry);
  assert_true(fabs(o.peak / t->reference - 1) < 0.01);
  assert_true(o.peak > t->least * t->theory && o.peak < t->most * t->theory);
  assert_true(o.damage > 0.1);
  assert_true(o.ends < 0.02);
  if (t->symmetric) assert_true(o.asymmetry < 1e-8);
}

static void the_prism_at_0_degrees(void **state) {
  (void)state;
  check(&(tension){"examples/tension/rot0.nml", "7.4 ms", 57140, 58880, 0.94, 1.04, true});
}

static void the_prism_at_15_degrees(void **state) {
  (void)state;
  check(&(tension){"examples/tension/rot15.nml", "7.4 ms", 54810, 58880, 0.91, 1.04, false});
}

static void the_prism_at_30_degrees(void **state) {
  (void)state;
  check(&(tension){"examples/tension/rot30.nml", "7.4 ms", 57300, 58880, 0.94, 1.04, true});
}

/* The band of 5 % is for 4 mm; twice as coarse 8 %. */
static void the_coarse_dog_bone(void **state) {
  (void)state;
  check(&(tension){"examples/dog_bone/b_s8.nml", "3.2 ms", 13620, 14490, 0.92, 1.05, true});
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_prism_at_0_degrees),
      cmocka_unit_test(the_prism_at_15_degrees),
      cmocka_unit_test(the_prism_at_30_degrees),
      cmocka_unit_test(the_coarse_dog_bone),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
