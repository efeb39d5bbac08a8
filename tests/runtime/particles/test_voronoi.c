/* Voronoi cells against what is known of them: cells of lattices, sums over bodies of every shape,
   nearest points by all pairs, centroids, sets with gaps, and the same bits on any number of
   threads. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <omp.h>

#include "runtime/base/random_number.h"
#include "runtime/geometry/shape.h"
#include "runtime/particles/solid.h"
#include "runtime/particles/voronoi.h"

enum { MOST = 4000, MOST_SHAPES = 3 };

typedef struct bench {
  deck deck;
  deck_lattice lattice;
  deck_body bodies[MOST_SHAPES];
  deck_notch notches[MOST_SHAPES];
  solid solid;
  double x[3][MOST], volume[MOST], centroid[3][MOST];
  voronoi_points points;
  uint64_t state;
} bench;

static bench *begin(int dimensions, double spacing) {
  bench *b = calloc(1, sizeof *b);
  b->lattice = (deck_lattice){.name = "body",
                              .kind = "blue_noise",
                              .spacing = spacing,
                              .setting = dimensions == 3 ? "space" : "plane_stress"};
  b->deck =
      (deck){.lattices = &b->lattice, .lattice_count = 1, .bodys = b->bodies, .notchs = b->notches};
  b->points = (voronoi_points){
      dimensions, 0, {b->x[0], b->x[1], dimensions == 3 ? b->x[2] : NULL}, spacing, NULL};
  return b;
}

static void add_body(bench *b, deck_shape shape) {
  b->bodies[b->deck.body_count++] = (deck_body){.lattice = "body", .shape = shape};
}

static void add_notch(bench *b, deck_shape shape) {
  b->notches[b->deck.notch_count++] = (deck_notch){.lattice = "body", .shape = shape};
}

static void add_point(bench *b, double x, double y, double z) {
  assert_true(b->points.count < MOST);
  b->x[0][b->points.count] = x;
  b->x[1][b->points.count] = y;
  b->x[2][b->points.count++] = z;
}

static double uniform(bench *b, double low, double high) {
  return low + (high - low) * random_unit(random_mix(b->state++));
}

/* Points at random in the solid. */
static void scatter(bench *b, long count) {
  const double *low = b->solid.lower, *high = b->solid.upper;
  while (b->points.count < count) {
    double at[3] = {0, 0, 0};
    for (int c = 0; c < b->points.dimensions; c++)
      at[c] = uniform(b, low[c], high[c]);
    if (solid_holds(&b->solid, at)) add_point(b, at[0], at[1], at[2]);
  }
}

static double measure(bench *b, double tolerance) {
  double *const centroid[3] = {b->centroid[0], b->centroid[1], b->centroid[2]};
  voronoi_measure(&b->points, &b->solid, tolerance, b->volume, centroid);
  double sum = 0;
  for (long k = 0; k < b->points.count; k++)
    sum += b->volume[k];
  return sum;
}

static void end(bench *b) {
  solid_end(&b->solid);
  free(b);
}

/* --- cells of lattices ------------------------------------------------------------------------ */

static const deck_shape square = {.kind = SHAPE_RECTANGLE, .corner = {-5, -5}, .size = {10, 10}};
static const deck_shape cube = {.kind = SHAPE_BOX, .corner = {-4, -4, -4}, .size = {8, 8, 8}};

/* The cell in the middle has the lattice's volume and its point as the centroid. */
static void expect_middle(bench *b, double volume) {
  solid_begin(&b->solid, &b->deck, 0);
  measure(b, 1e-9);
  int found = 0;
  for (long k = 0; k < b->points.count; k++) {
    if (fmax(fmax(fabs(b->x[0][k]), fabs(b->x[1][k])), fabs(b->x[2][k])) > 1e-9) continue;
    found++;
    assert_true(fabs(b->volume[k] - volume) < 1e-13);
    for (int c = 0; c < b->points.dimensions; c++)
      assert_true(fabs(b->centroid[c][k]) < 1e-13);
  }
  assert_int_equal(found, 1);
  end(b);
}

static void cells_of_lattices_are_known(void **state) {
  (void)state;
  bench *b = begin(2, 1);
  add_body(b, square);
  for (int row = -4; row <= 4; row++)
    for (int column = -4; column <= 4; column++)
      add_point(b, column + 0.5 * (row & 1), row * sqrt(0.75), 0);
  expect_middle(b, sqrt(0.75));

  b = begin(3, 1);
  add_body(b, cube);
  for (int n = 0; n < 7 * 7 * 7; n++)
    add_point(b, n % 7 - 3, n / 7 % 7 - 3, n / 49 - 3);
  expect_middle(b, 1);

  b = begin(3, 1); /* fcc: rhombic dodecahedra, whose corners belong to more than three faces */
  add_body(b, cube);
  for (int n = 0; n < 9 * 9 * 9; n++) {
    const int i = n % 9 - 4, j = n / 9 % 9 - 4, k = n / 81 - 4;
    if ((i + j + k) % 2 == 0) add_point(b, i * sqrt(0.5), j * sqrt(0.5), k * sqrt(0.5));
  }
  expect_middle(b, sqrt(0.5));

  b = begin(3, 1); /* bcc: truncated octahedra */
  add_body(b, cube);
  for (int n = 0; n < 7 * 7 * 7; n++) {
    add_point(b, n % 7 - 3, n / 7 % 7 - 3, n / 49 - 3);
    add_point(b, n % 7 - 2.5, n / 7 % 7 - 2.5, n / 49 - 2.5);
  }
  expect_middle(b, 0.5);
}

/* A polygon of as many sides as there are points around. */
static void a_cell_may_have_many_sides(void **state) {
  (void)state;
  enum { AROUND = 500 };
  bench *b = begin(2, 0.1);
  add_body(b, square);
  add_point(b, 0, 0, 0);
  for (int k = 0; k < AROUND; k++)
    add_point(b, 2 * cos(2 * acos(-1) * k / AROUND), 2 * sin(2 * acos(-1) * k / AROUND), 0);
  solid_begin(&b->solid, &b->deck, 0);
  measure(b, 1e-9);
  assert_true(fabs(b->volume[0] - AROUND * tan(acos(-1) / AROUND)) < 1e-11);
  end(b);
}

/* --- sums over bodies ------------------------------------------------------------------------- */

static const double angle_points[] = {0, 0, 1, 0, 1, 0.3, 0.4, 0.3, 0.4, 1, 0, 1};
static const double round_points[] = {0, 0, 1, 0, 1, 1, 0, 1};
static const double round_bulge[] = {0, 0.5, 0, -0.1};

typedef struct body_case {
  const char *what;
  int dimensions;
  deck_shape body, second, notch; /* points where there is none */
  double size, tolerance;
} body_case;

/* Segment of a circle of radius r under a rise h. */
static double segment(double r, double h) {
  return r * r * acos(1 - h / r) - (r - h) * sqrt(h * (2 * r - h));
}

static int body_cases(body_case *list) {
  const double pi = acos(-1), chord = 0.5, arc = (0.25 * 4 * chord * chord + 0.01) / 0.2;
  const body_case cases[] = {
      {"rectangle",
       2,
       {.kind = SHAPE_RECTANGLE, .size = {1, 0.5}},
       .size = 0.5,
       .tolerance = 1e-12},
      {"turned",
       2,
       {.kind = SHAPE_RECTANGLE, .size = {1, 0.5}, .rotation = 0.5},
       .size = 0.5,
       .tolerance = 1e-12},
      {"disc", 2, {.kind = SHAPE_DISC, .radius = 0.5}, .size = pi / 4, .tolerance = 1e-9},
      {"ring",
       2,
       {.kind = SHAPE_DISC, .radius = 0.5, .inner_radius = 0.3},
       .size = 0.16 * pi,
       .tolerance = 1e-9},
      {"angle",
       2,
       {.kind = SHAPE_POLYGON, .points = angle_points, .point_count = 6},
       .size = 0.58,
       .tolerance = 1e-12},
      {"arcs",
       2,
       {.kind = SHAPE_POLYGON,
        .points = round_points,
        .point_count = 4,
        .bulge = round_bulge,
        .bulge_count = 4},
       .size = 1 + pi / 8 - segment(arc, 0.1),
       .tolerance = 1e-9},
      {"dog-bone",
       2,
       {.kind = SHAPE_DOG_BONE, .width = 1, .height = 1.5, .neck = 0.6, .radius = 0.725},
       .size = 1.5 - 2 * segment(0.725, 0.2),
       .tolerance = 1e-9},
      {"notched",
       2,
       {.kind = SHAPE_RECTANGLE, .size = {1, 0.5}},
       .notch = {.kind = SHAPE_RECTANGLE, .corner = {0.497, -0.1}, .size = {0.006, 0.35}},
       .size = 0.5 - 0.006 * 0.25,
       .tolerance = 1e-12},
      {"overlap",
       2,
       {.kind = SHAPE_RECTANGLE, .size = {1, 0.5}},
       {.kind = SHAPE_RECTANGLE, .corner = {0.8, 0.2}, .size = {1, 1}},
       .size = 1.5 - 0.06,
       .tolerance = 1e-12},
      {"apart",
       2,
       {.kind = SHAPE_DISC, .radius = 0.5},
       {.kind = SHAPE_DISC, .centre = {3, 0}, .radius = 0.3},
       .size = pi * 0.34,
       .tolerance = 1e-9},
      {"box", 3, {.kind = SHAPE_BOX, .size = {1, 0.6, 0.4}}, .size = 0.24, .tolerance = 1e-12},
      {"sphere", 3, {.kind = SHAPE_SPHERE, .radius = 0.5}, .size = pi / 6, .tolerance = 1e-3},
      {"shell",
       3,
       {.kind = SHAPE_SPHERE, .radius = 0.5, .inner_radius = 0.3},
       .size = pi / 6 - 0.036 * pi,
       .tolerance = 1e-3},
      {"cylinder",
       3,
       {.kind = SHAPE_CYLINDER, .to = {0, 0, 1}, .radius = 0.4},
       .size = 0.16 * pi,
       .tolerance = 1e-3},
      {"tube",
       3,
       {.kind = SHAPE_CYLINDER, .to = {0.5, 0.3, 1}, .radius = 0.4, .inner_radius = 0.2},
       .size = 0.12 * pi * sqrt(1.34),
       .tolerance = 1e-3},
      {"bracket",
       3,
       {.kind = SHAPE_EXTRUSION, .points = angle_points, .point_count = 6, .z = {0, 0.5}},
       .size = 0.29,
       .tolerance = 1e-3},
      {"boxes",
       3,
       {.kind = SHAPE_BOX, .size = {1, 0.6, 0.4}},
       {.kind = SHAPE_BOX, .corner = {1, 0, 0}, .size = {0.5, 0.6, 0.8}},
       .size = 0.48,
       .tolerance = 1e-3},
  };
  memcpy(list, cases, sizeof cases);
  return (int)(sizeof cases / sizeof *cases);
}

static bench *fill(const body_case *c) {
  bench *b = begin(c->dimensions, c->dimensions == 2 ? sqrt(c->size / 400) : cbrt(c->size / 600));
  add_body(b, c->body);
  if (c->second.kind != SHAPE_POINT) add_body(b, c->second);
  if (c->notch.kind != SHAPE_POINT) add_notch(b, c->notch);
  solid_begin(&b->solid, &b->deck, 0);
  scatter(b, c->dimensions == 2 ? 400 : 600);
  return b;
}

/* Points at random, some very near to each other: a harder case than even ones. */
static void volumes_add_up_to_the_body(void **state) {
  (void)state;
  body_case cases[32];
  const int count = body_cases(cases);
  for (int n = 0; n < count; n++) {
    const body_case *c = &cases[n];
    bench *b = fill(c);
    const double sum = measure(b, c->dimensions == 2 ? 1e-10 : 1e-4);
    if (fabs(sum / c->size - 1) > c->tolerance)
      fail_msg("%s: sum %.12g of %.12g, off by %.3g", c->what, sum, c->size, sum / c->size - 1);
    const double off = solid_size(&b->solid, c->dimensions == 2 ? 1e-10 : 1e-5) / c->size - 1;
    if (fabs(off) > c->tolerance) fail_msg("%s: the whole is off by %.3g", c->what, off);
    end(b);
  }
}

enum { FEW_POINTS = 25, PLANE_STEPS = 600, SPACE_STEPS = 90 };

static int nearest_of(const bench *b, const double at[3]) {
  double least = INFINITY;
  int nearest = 0;
  for (int m = 0; m < FEW_POINTS; m++) {
    double square_of = 0;
    for (int d = 0; d < b->points.dimensions; d++)
      square_of += (b->x[d][m] - at[d]) * (b->x[d][m] - at[d]);
    if (square_of >= least) continue;
    least = square_of;
    nearest = m;
  }
  return nearest;
}

/* Of places on a grid, each counts for its nearest point; by all pairs. */
static void count_places(const bench *b, double found[FEW_POINTS]) {
  const int dimensions = b->points.dimensions;
  const long steps = dimensions == 2 ? PLANE_STEPS : SPACE_STEPS;
  double each = 1, step[3] = {0, 0, 0}, at[3] = {0, 0, 0};
  for (int d = 0; d < dimensions; d++) {
    step[d] = (b->solid.upper[d] - b->solid.lower[d]) / (double)steps;
    each *= step[d];
  }
  for (long k = 0; k < (dimensions == 2 ? steps * steps : steps * steps * steps); k++) {
    const long i[3] = {k % steps, k / steps % steps, k / (steps * steps)};
    for (int d = 0; d < dimensions; d++)
      at[d] = b->solid.lower[d] + ((double)i[d] + 0.5) * step[d];
    if (solid_holds(&b->solid, at)) found[nearest_of(b, at)] += each;
  }
}

static void cells_hold_what_is_nearest(void **state) {
  (void)state;
  body_case cases[32];
  const int count = body_cases(cases);
  for (int n = 0; n < count; n++) {
    const body_case *c = &cases[n];
    double found[FEW_POINTS] = {0};
    bench *b = fill(c);
    b->points.count = FEW_POINTS;
    measure(b, 1e-4);
    count_places(b, found);
    for (int m = 0; m < FEW_POINTS;
         m++) /* the surface of a cell, a grid step thick, at random signs */
      if (fabs(found[m] - b->volume[m]) > 0.004 * c->size)
        fail_msg("%s: cell %d has %.6g, by counting %.6g", c->what, m, b->volume[m], found[m]);
    end(b);
  }
}

/* Weighted by volume, the centroids' mean is the body's centroid: here by symmetry 0. */
static void centroids_balance(void **state) {
  (void)state;
  const deck_shape bodies[] = {{.kind = SHAPE_DISC, .radius = 0.5, .inner_radius = 0.2},
                               {.kind = SHAPE_SPHERE, .radius = 0.5}};
  for (int n = 0; n < 2; n++) {
    bench *b = begin(2 + n, 0.05);
    add_body(b, bodies[n]);
    solid_begin(&b->solid, &b->deck, 0);
    scatter(b, 500);
    const double sum = measure(b, 1e-6);
    for (int c = 0; c < 2 + n; c++) {
      double first = 0;
      for (long k = 0; k < 500; k++)
        first += b->volume[k] * b->centroid[c][k];
      assert_true(fabs(first / sum) < 0.5 * (n == 0 ? 1e-8 : 1e-4));
    }
    end(b);
  }
}

/* --- gaps, neighbours, threads ---------------------------------------------------------------- */

/* All points at one end of a long bar: the last cells are the rest of it. */
static void cells_reach_across_gaps(void **state) {
  (void)state;
  bench *b = begin(2, 0.01);
  add_body(b, (deck_shape){.kind = SHAPE_RECTANGLE, .size = {10, 0.1}});
  solid_begin(&b->solid, &b->deck, 0);
  for (int k = 0; k < 50; k++)
    add_point(b, uniform(b, 0, 0.1), uniform(b, 0, 0.1), 0);
  assert_true(fabs(measure(b, 1e-10) - 1) < 1e-12);
  end(b);
}

/* Thousands at one end of the bar, and two far from them. */
static void cells_of_stragglers_are_whole(void **state) {
  (void)state;
  bench *b = begin(2, 0.002);
  add_body(b, (deck_shape){.kind = SHAPE_RECTANGLE, .size = {10, 0.1}});
  solid_begin(&b->solid, &b->deck, 0);
  for (int k = 0; k < 3000; k++)
    add_point(b, uniform(b, 0, 0.1), uniform(b, 0, 0.1), 0);
  add_point(b, 6, 0.05, 0);
  add_point(b, 9, 0.05, 0);
  assert_true(fabs(measure(b, 1e-10) - 1) < 1e-12);
  assert_true(fabs(b->volume[3001] - 0.1 * 2.5) < 1e-12);
  end(b);
}

static void the_nearest_pair_is_found(void **state) {
  (void)state;
  bench *b = begin(3, 0.1);
  add_body(b, cube);
  solid_begin(&b->solid, &b->deck, 0);
  for (int n = 0; n < 1000; n++)
    add_point(b, n % 10, n / 10 % 10, n / 100);
  long pair[2];
  assert_false(voronoi_too_near(&b->points, 0.5, pair));
  assert_true(voronoi_too_near(&b->points, 1.01, pair));
  assert_true(pair[0] == 0 && pair[1] == 1);
  b->x[0][700] = b->x[0][123] + 1e-9;
  b->x[1][700] = b->x[1][123];
  b->x[2][700] = b->x[2][123];
  assert_true(voronoi_too_near(&b->points, 1e-6, pair));
  assert_true(pair[0] == 123 && pair[1] == 700);
  end(b);
}

static void threads_do_not_matter(void **state) {
  (void)state;
  static double volume[MOST];
  bench *b = begin(3, 0.1);
  add_body(b, (deck_shape){.kind = SHAPE_SPHERE, .radius = 0.5});
  solid_begin(&b->solid, &b->deck, 0);
  scatter(b, 700);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  measure(b, 1e-3);
  memcpy(volume, b->volume, sizeof volume);
  omp_set_num_threads(5);
  measure(b, 1e-3);
  omp_set_num_threads(threads);
  assert_memory_equal(volume, b->volume, sizeof volume);
  end(b);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cells_of_lattices_are_known),
                                     cmocka_unit_test(a_cell_may_have_many_sides),
                                     cmocka_unit_test(volumes_add_up_to_the_body),
                                     cmocka_unit_test(cells_hold_what_is_nearest),
                                     cmocka_unit_test(centroids_balance),
                                     cmocka_unit_test(cells_reach_across_gaps),
                                     cmocka_unit_test(cells_of_stragglers_are_whole),
                                     cmocka_unit_test(the_nearest_pair_is_found),
                                     cmocka_unit_test(threads_do_not_matter)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
