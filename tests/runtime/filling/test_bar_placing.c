/* Where bars lie among the particles of a body, against a look at each of them; bars that cross
   notches. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "runtime/filling/bar_placing.h"
#include "tests/runtime/built_rows.h"

#define BEGIN "&simulation end_time = 1 /\n"
#define PLATE                                                                                      \
  "&lattice name = 'l' kind = 'hexagonal' spacing = 0.02 thickness = 1 origin = -0.6, 0 /\n"       \
  "&material lattice = 'l' model = 'm' /\n"                                                        \
  "&body lattice = 'l' shape = 'rectangle' corner = -0.6, 0 size = 1.2, 0.26 /\n"
#define BLOCK                                                                                      \
  "&lattice name = 'l' kind = 'fcc' spacing = 0.02 /\n&material lattice = 'l' model = 'm' /\n"     \
  "&body lattice = 'l' shape = 'sphere' centre = 0, 0, 0 radius = 0.1 /\n"
#define NOISE                                                                                      \
  "&lattice name = 'l' kind = 'blue_noise' spacing = 0.02 thickness = 1 /\n"                       \
  "&material lattice = 'l' model = 'm' /\n"                                                        \
  "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = 0.2 /\n"
#define BAR(keys)                                                                                  \
  "&bar name = 'b' area = 1e-4 spacing = 0.02 points = " keys " /\n&material bar = 'b' model = 'm' "  \
  "/\n"

static bar_placing by_looking(const rows *bar, const rows *of) {
  bar_placing found = {.least = INFINITY};
  for (long n = 0; n < bar->particle_count; n++) {
    double here[3], nearest = INFINITY;
    rows_place(bar, bar->particle_site[n], here);
    for (long m = 0; m < of->particle_count; m++) {
      double there[3];
      rows_place(of, of->particle_site[m], there);
      nearest =
          fmin(nearest, hypot(hypot(there[0] - here[0], there[1] - here[1]), there[2] - here[2]));
    }
    if (nearest > of->spacing * (1 + 1e-6)) continue;
    found.inside++;
    found.least = fmin(found.least, nearest);
    found.most = fmax(found.most, nearest);
    found.mean += nearest;
  }
  if (found.inside) found.mean /= (double)found.inside;
  return found;
}

static void is_placed(const char *text, long inside, double least, double most) {
  built_rows b;
  build_rows(&b, text);
  rows *bar = lattice_build(b.deck, 1, &b.said);
  const bar_placing p = bar_placing_in(bar, b.rows), q = by_looking(bar, b.rows);
  assert_int_equal(p.inside, q.inside);
  assert_true(!p.inside || (fabs(p.least - q.least) < 1e-15 && fabs(p.most - q.most) < 1e-15 &&
                            fabs(p.mean - q.mean) < 1e-15));
  assert_int_equal(p.inside, inside);
  if (!isnan(least)) assert_true(fabs(p.least - least) < 1e-12 && fabs(p.most - most) < 1e-12);
  rows_free(bar);
  built_end(&b);
}

/* On the second row of sites, 17.32 mm up, and 2.68 mm above it; a leg that comes in from outside.
   */
static void bars_lie_on_sites_or_off(void **state) {
  (void)state;
  const double row = sqrt(3) / 100, above = 0.02 - row;
  is_placed(BEGIN PLATE BAR("-0.59, 0.01732050807568877, 0.59, 0.01732050807568877"), 60, 0, 0);
  is_placed(BEGIN PLATE BAR("-0.59, 0.02, 0.59, 0.02"), 60, above, above);
  is_placed(BEGIN PLATE BAR("-1, 0.1, 0.1, 0.1, 0.1, 2"), 44, NAN, NAN);
  is_placed(BEGIN PLATE BAR("-1, 1, 1, 1"), 0, NAN, NAN);
  is_placed(BEGIN BLOCK BAR("-0.2, 0, 0, 0.2, 0.003, 0.001"), 11, NAN, NAN);
  is_placed(BEGIN NOISE BAR("-0.3, 0.01, 0.3, 0.01"), 21, NAN, NAN);
}

static void a_notch_does_not_cut_it(void **state) {
  (void)state;
#define NOTCH "&notch lattice = 'l' shape = 'segment' from = 0, 0 to = 0, 0.1 /\n"
  static const struct {
    const char *text;
    int warnings;
  } decks[] = {{BEGIN PLATE NOTCH BAR("-0.5, 0.05, 0.51, 0.05"), 1},
               {BEGIN PLATE NOTCH BAR("-0.5, 0.15, 0.51, 0.15"), 0},
               {BEGIN PLATE "&notch lattice = 'l' shape = 'rectangle' cut_bonds = F corner = 0, 0 "
                            "size = 0.1, 0.1 /\n" BAR("-0.5, 0.05, 0.51, 0.05"),
                0}};
  for (size_t k = 0; k < sizeof decks / sizeof *decks; k++) {
    built_rows b;
    build_rows(&b, decks[k].text);
    const int before = b.said.count;
    rows *bar = lattice_build(b.deck, 1, &b.said);
    assert_int_equal(b.said.count - before, decks[k].warnings);
    if (decks[k].warnings) assert_non_null(strstr(b.said.items[before].message, "crosses a notch"));
    assert_int_equal(bar->bond_count, bar->particle_count - 1);
    rows_free(bar);
    built_end(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bars_lie_on_sites_or_off),
      cmocka_unit_test(a_notch_does_not_cut_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
