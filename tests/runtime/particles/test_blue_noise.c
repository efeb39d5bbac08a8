/* Blue noise by itself: all points in the body, none too near another, cells of equal size, and
   the same bits of one seed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/particles/blue_noise.h"
#include "tests/runtime/built_rows.h"

enum { COUNT = 600 };

#define DECK(keys, shape)                                                                          \
  "&simulation end_time = 1 /\n&lattice name = 'heap' kind = 'blue_noise' spacing = 0.01 " keys    \
  " /\n&material lattice = 'heap' model = 'm' /\n&body lattice = 'heap' shape = " shape " /\n"

typedef struct filled {
  built_rows deck;
  solid solid;
  voronoi_points points;
  double volume[COUNT];
} filled;

/* `spacing` that of the hexagonal (fcc) lattice with as many particles. */
static void fill(filled *f, const char *text, int dimensions, double size, uint64_t seed) {
  read_deck(&f->deck, text);
  assert_non_null(f->deck.deck);
  solid_begin(&f->solid, f->deck.deck, 0);
  const double each = size / COUNT;
  f->points =
      (voronoi_points){.dimensions = dimensions,
                       .count = COUNT,
                       .spacing = dimensions == 2 ? sqrt(each / sqrt(0.75)) : cbrt(each * sqrt(2))};
  for (int c = 0; c < dimensions; c++)
    f->points.at[c] = must_calloc(COUNT, sizeof(double));
  const gradation alike = {.dimensions = dimensions,
                           .spacing = f->points.spacing,
                           .least = f->points.spacing,
                           .most = f->points.spacing,
                           .count = COUNT};
  blue_noise_fill(&f->points, &f->solid, &alike, seed);
  voronoi_measure(&f->points, &f->solid, 1e-3, f->volume, NULL);
}

static void empty(filled *f) {
  for (int c = 0; c < 3; c++)
    free(f->points.at[c]);
  solid_end(&f->solid);
  built_end(&f->deck);
}

static void check_even(const filled *f, double size) {
  double sum = 0, square = 0;
  long pair[2];
  for (long k = 0; k < COUNT; k++) {
    const double at[3] = {f->points.at[0][k], f->points.at[1][k],
                          f->points.dimensions == 3 ? f->points.at[2][k] : 0};
    assert_true(solid_holds(&f->solid, at));
    sum += f->volume[k];
    square += pow(f->volume[k] * COUNT / size - 1, 2);
  }
  assert_true(fabs(sum / size - 1) < 2e-3);
  assert_true(sqrt(square / COUNT) < 0.15); /* 0.53 (space: 0.42) where points stand at random */
  assert_false(voronoi_too_near(&f->points, 0.55 * f->points.spacing, pair));
  assert_true(
      voronoi_too_near(&f->points, 1.1 * f->points.spacing, pair)); /* no lattice is wider */
}

static void points_are_even_in_the_plane_and_in_space(void **state) {
  (void)state;
  filled *f = must_calloc(1, sizeof *f);
  fill(f, DECK("thickness = 1", "'rectangle' corner = 0, 0 size = 0.3, 0.2"), 2, 0.06, 1);
  check_even(f, 0.06);
  empty(f);
  fill(f, DECK("setting = 'space'", "'box' corner = 0, 0, 0 size = 0.1, 0.1, 0.08"), 3, 8e-4, 1);
  check_even(f, 8e-4);
  empty(f);
  free(f);
}

/* Of a ring, from which much of its box is missing. */
static void points_stay_out_of_holes(void **state) {
  (void)state;
  const double size = acos(-1) * (0.04 - 0.01);
  filled *f = must_calloc(1, sizeof *f);
  fill(f, DECK("thickness = 1", "'disc' centre = 0, 0 radius = 0.2 inner_radius = 0.1"), 2, size,
       5);
  check_even(f, size);
  empty(f);
  free(f);
}

static void the_seed_decides_and_threads_do_not(void **state) {
  (void)state;
  static const char text[] = DECK("thickness = 1", "'rectangle' corner = 0, 0 size = 0.3, 0.2");
  filled *f = must_calloc(3, sizeof *f);
  const int threads = omp_get_max_threads();
  for (int k = 0; k < 3; k++) {
    omp_set_num_threads(k == 1 ? 3 : 1);
    fill(&f[k], text, 2, 0.06, k == 2 ? 8 : 7);
  }
  omp_set_num_threads(threads);
  for (int c = 0; c < 2; c++) {
    assert_memory_equal(f[0].points.at[c], f[1].points.at[c], COUNT * sizeof(double));
    assert_memory_not_equal(f[0].points.at[c], f[2].points.at[c], COUNT * sizeof(double));
  }
  for (int k = 0; k < 3; k++)
    empty(&f[k]);
  free(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(points_are_even_in_the_plane_and_in_space),
      cmocka_unit_test(points_stay_out_of_holes),
      cmocka_unit_test(the_seed_decides_and_threads_do_not),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
