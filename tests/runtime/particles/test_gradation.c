/* Spacings by a formula of the place: how many particles that is, of which size, the same whatever
   the threads; and what cannot be. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <omp.h>

#include "runtime/particles/blue_noise.h"
#include "runtime/particles/gradation.h"
#include "runtime/particles/particle_set.h"
#include "tests/runtime/built_rows.h"

#define DECK(keys, shape)                                                                          \
  "&simulation end_time = 1 /\n&lattice name = 'heap' kind = 'blue_noise' " keys                   \
  " /\n&material lattice = 'heap' model = 'm' /\n&body lattice = 'heap' shape = " shape " /\n"
#define PLATE "'rectangle' corner = -0.1, -0.1 size = 0.2, 0.2"

/* Of a cone that is cut off, in closed form: 2 pi r dr over (r0 + g r)^2. */
static void particles_are_counted(void **state) {
  (void)state;
  static const char text[] = DECK("spacing = '2 [mm] + 0.05*sqrt(x**2 + y**2)' thickness = 1",
                                  "'disc' centre = 0, 0 radius = 0.1");
  const double pi = acos(-1), a = 2e-3, b = a + 0.05 * 0.1;
  const double share = (log(b / a) + a / b - 1) / (0.05 * 0.05);
  built_rows d;
  gradation g;
  solid s;
  read_deck(&d, text);
  assert_non_null(d.deck);
  solid_begin(&s, d.deck, 0);
  assert_true(gradation_begin(&g, &d.deck->lattices[0], &s, pi * 0.01, &d.said));
  assert_true(fabs(g.count / (2 * pi * share / sqrt(0.75)) - 1) < 2e-3);
  assert_true(fabs(g.least / a - 1) < 0.05 && fabs(g.most / b - 1) < 0.05);
  solid_end(&s);
  built_end(&d);
}

static void one_spacing_is_that_of_all(void **state) {
  (void)state;
  built_rows d[2];
  particle_set *set[2];
  read_deck(&d[0], DECK("spacing = '8 mm' thickness = 1", PLATE));
  read_deck(&d[1], DECK("spacing = '2*4 [mm]' thickness = 1", PLATE));
  for (int k = 0; k < 2; k++)
    set[k] = particle_set_make(d[k].deck, 0, &d[k].said);
  assert_null(set[1]->own);
  assert_int_equal(set[0]->count, set[1]->count);
  assert_memory_equal(set[0]->at[0], set[1]->at[0], (size_t)set[0]->count * sizeof(double));
  for (int k = 0; k < 2; k++) {
    particle_set_free(set[k]);
    built_end(&d[k]);
  }
}

static void threads_do_not_matter(void **state) {
  (void)state;
  static const char *const text[] = {
      DECK("spacing = '4 [mm] + 0.05*abs(x + y)' thickness = 1", PLATE),
      DECK("spacing = '8 [mm] + 0.1*abs(x + y)' setting = 'space'",
           "'sphere' centre = 0, 0, 0 radius = 0.05")};
  const int threads = omp_get_max_threads();
  for (int n = 0; n < 2; n++) {
    built_rows d[2];
    particle_set *set[2];
    for (int k = 0; k < 2; k++) {
      read_deck(&d[k], text[n]);
      omp_set_num_threads(k ? 4 : 1);
      set[k] = particle_set_make(d[k].deck, 0, &d[k].said);
      assert_non_null(set[k]);
    }
    const size_t bytes = (size_t)set[0]->count * sizeof(double);
    assert_int_equal(set[0]->count, set[1]->count);
    for (int c = 0; c < set[0]->dimensions; c++)
      assert_memory_equal(set[0]->at[c], set[1]->at[c], bytes);
    assert_memory_equal(set[0]->volume, set[1]->volume, bytes);
    assert_memory_equal(set[0]->own, set[1]->own, bytes);
    for (int k = 0; k < 2; k++) {
      particle_set_free(set[k]);
      built_end(&d[k]);
    }
  }
  omp_set_num_threads(threads);
}

/* What is said, and how it is mended. */
static void check_refused(const char *text, const char *message, const char *hint) {
  built_rows d;
  read_deck(&d, text);
  assert_non_null(d.deck);
  assert_null(particle_set_make(d.deck, 0, &d.said));
  assert_int_equal(d.said.errors, 1);
  const diagnostic *last = &d.said.items[d.said.count - 1];
  if (!strstr(last->message, message) || !last->hint || !strstr(last->hint, hint))
    fail_msg("%s\n%s", last->message, last->hint ? last->hint : "");
  built_end(&d);
}

static void what_cannot_be_is_said(void **state) {
  (void)state;
  check_refused(DECK("spacing = '2 [mm] + 0.1*abs(x)' thickness = 1", PLATE),
                "gradation beyond its ratio: the spacing goes from 2 to 12 mm, and the largest may "
                "be 4 times the smallest",
                "min(..., 8 [mm])");
  check_refused(DECK("spacing = '2 [mm] + 0.1*abs(x)' setting = 'space'",
                     "'box' corner = -0.1, 0, 0 size = 0.2, 0.02, 0.02"),
                "gradation beyond its ratio", "min(..., 8 [mm])");
  check_refused(DECK("spacing = 'min(5 [mm] + 0.5*abs(x), 15 [mm])' thickness = 1", PLATE),
                "too steep a gradation: at (", "spread it over a longer way");
  check_refused(DECK("spacing = '5 [mm] - 0.1*x' thickness = 1", PLATE),
                "it must be greater than 0", "max(2 [mm], ...)");
  check_refused(DECK("spacing = 'sqrt(x*1 [mm])' thickness = 1", PLATE),
                "`spacing` has no finite value at (-100, -100) mm", "max(2 [mm], ...)");
  check_refused(DECK("spacing = '1e-6 [mm]*(2 + x/1 [m])' thickness = 1", PLATE),
                "the most that can be stored", "times as large would do");
}

/* A spike between the places that were looked at: no particle is larger than four of the smallest.
   */
static void sizes_are_bounded(void **state) {
  (void)state;
  enum { COUNT = 200 };
  built_rows d;
  solid s;
  double at[2][COUNT], own[COUNT];
  read_deck(&d, DECK("spacing = '4 [mm] + 1e3*abs(x)' thickness = 1", PLATE));
  assert_non_null(d.deck);
  solid_begin(&s, d.deck, 0);
  voronoi_points p = {
      .dimensions = 2, .count = COUNT, .at = {at[0], at[1]}, .spacing = 4e-3, .own = own};
  const gradation g = {.dimensions = 2, .graded = d.deck->lattices[0].graded, .least = 4e-3};
  blue_noise_fill(&p, &s, &g, 1);
  for (long k = 0; k < COUNT; k++)
    assert_true(own[k] >= 4e-3 && own[k] <= GRADATION_MOST_RATIO * 4e-3);
  solid_end(&s);
  built_end(&d);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(particles_are_counted), cmocka_unit_test(one_spacing_is_that_of_all),
      cmocka_unit_test(threads_do_not_matter), cmocka_unit_test(what_cannot_be_is_said),
      cmocka_unit_test(sizes_are_bounded),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
