/* Elements of 3, 4 and 6 nodes: their functions, the way back from a place, soundness, masses. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/base/random_number.h"
#include "runtime/geometry/element.h"

static const int kinds[] = {3, 4, 6};
static const double triangle[3][2] = {{0.2, 0.1}, {1.3, 0.3}, {0.6, 1.2}},
                    quadrilateral[4][2] = {{0, 0}, {1.2, 0.1}, {1.5, 1.1}, {-0.2, 0.9}},
                    curved[6][2] = {{0.2, 0.1},   {1.3, 0.3},  {0.6, 1.2},
                                    {0.75, 0.15}, {1.05, 0.8}, {0.35, 0.68}};

typedef const double (*corners_of)[2];

static corners_of places(int nodes) {
  return nodes == 3 ? triangle : nodes == 4 ? quadrilateral : curved;
}

static double draw(int k) {
  return random_unit(random_mix((uint64_t)k));
}

/* A place inside. */
static void inside(int nodes, int k, double u[2]) {
  u[0] = draw(2 * k);
  u[1] = draw(2 * k + 1);
  if (nodes == 4) {
    u[0] = 2 * u[0] - 1;
    u[1] = 2 * u[1] - 1;
  } else if (u[0] + u[1] > 1) {
    u[0] = 1 - u[0];
    u[1] = 1 - u[1];
  }
}

/* In x and y of elements with straight sides all polynomials that they are to have. */
static void functions_have_their_polynomials(void **state) {
  (void)state;
  static const double straight[6][2] = {{0.2, 0.1},  {1.3, 0.3},   {0.6, 1.2},
                                        {0.75, 0.2}, {0.95, 0.75}, {0.4, 0.65}};
  for (int kind = 0; kind < 3; kind++)
    for (int k = 0; k < 50; k++) {
      const int nodes = kinds[kind];
      corners_of at = nodes == 6 ? straight : places(nodes);
      double u[2], x[2], n[ELEMENT_MOST_NODES], g[ELEMENT_MOST_NODES][2], sum[5] = {0};
      inside(nodes, k, u);
      element_map(nodes, at, u, x, NULL);
      element_gradients(nodes, at, u, n, g);
      for (int q = 0; q < nodes; q++) {
        const double a = at[q][0], b = at[q][1];
        const double field = nodes == 6 ? 1 + a - 2 * b + a * a - a * b + 3 * b * b : 1 + a - 2 * b;
        sum[0] += n[q];
        sum[1] += g[q][0];
        sum[2] += n[q] * field;
        sum[3] += g[q][0] * field;
        sum[4] += g[q][1] * field;
      }
      const double more = nodes == 6;
      assert_true(fabs(sum[0] - 1) < 1e-14 && fabs(sum[1]) < 1e-13);
      assert_true(fabs(sum[2] - (1 + x[0] - 2 * x[1] +
                                 more * (x[0] * x[0] - x[0] * x[1] + 3 * x[1] * x[1]))) < 1e-13);
      assert_true(fabs(sum[3] - (1 + more * (2 * x[0] - x[1]))) < 1e-12);
      assert_true(fabs(sum[4] - (-2 + more * (6 * x[1] - x[0]))) < 1e-12);
    }
}

static void the_way_back_is_found(void **state) {
  (void)state;
  for (int kind = 0; kind < 3; kind++)
    for (int k = 0; k < 200; k++) {
      const int nodes = kinds[kind];
      double u[2], x[2], back[2];
      inside(nodes, k, u);
      element_map(nodes, places(nodes), u, x, NULL);
      assert_true(element_unmap(nodes, places(nodes), x, back));
      assert_true(fabs(back[0] - u[0]) < 1e-12 && fabs(back[1] - u[1]) < 1e-12);
      assert_true(element_outside(nodes, back) < 1e-12);
    }
  double u[2];
  assert_true(element_unmap(3, triangle, (const double[2]){-1, 0}, u));
  assert_true(element_outside(3, u) > 0.1);
}

/* The sum of weights is the area by the outline (Green), of arcs of parabolas by Simpson's rule. */
static double area_by_outline(int nodes, corners_of at) {
  const int corners = element_corners(nodes);
  double sum = 0;
  for (int k = 0; k < corners; k++) {
    const double *a = at[k], *b = at[(k + 1) % corners];
    sum += 0.5 * (a[0] * b[1] - b[0] * a[1]);
    if (nodes < 6) continue;
    const double *m = at[3 + k]; /* 2/3 of the triangle that its middle makes */
    sum += 2.0 / 3 * ((m[0] - a[0]) * (b[1] - a[1]) - (b[0] - a[0]) * (m[1] - a[1]));
  }
  return sum;
}

static void areas_are_those_of_outlines(void **state) {
  (void)state;
  for (int kind = 0; kind < 3; kind++) {
    const int nodes = kinds[kind];
    const double whole = area_by_outline(nodes, places(nodes));
    double u[ELEMENT_MOST_POINTS][2], weight[ELEMENT_MOST_POINTS], sum = 0,
                                                                   share[ELEMENT_MOST_NODES];
    const int count = element_rule(nodes, 2, u, weight);
    for (int k = 0; k < count; k++)
      sum += weight[k] * element_map(nodes, places(nodes), u[k], NULL, NULL);
    assert_true(fabs(sum / whole - 1) < 1e-14);
    assert_true(fabs(element_area(nodes, places(nodes)) / whole - 1) < 1e-14);
    element_mass(nodes, places(nodes), share);
    for (int q = 0; q < nodes; q++) {
      assert_true(share[q] > 0);
      sum -= share[q];
    }
    assert_true(fabs(sum) < 1e-14 * whole);
  }
}

/* Hinton, Rock and Zienkiewicz 1976: 1/19 of the mass at corners, 16/57 at sides. */
static void the_scaled_diagonal_is_that_of_the_paper(void **state) {
  (void)state;
  static const double unit[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
  double share[ELEMENT_MOST_NODES];
  element_mass(6, unit, share);
  for (int q = 0; q < 3; q++) {
    assert_true(fabs(share[q] - 0.5 / 19) < 1e-14);
    assert_true(fabs(share[3 + q] - 0.5 * 16 / 57) < 1e-14);
  }
}

/* A side's node moved along its side: the Jacobian is 0 at the corner when it stands a quarter of
   the side from there, and negative beyond. */
static void unsound_elements_are_known(void **state) {
  (void)state;
  double u[2], moved[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.26, 0}, {0.5, 0.5}, {0, 0.5}};
  assert_true(element_is_sound(6, (corners_of)moved, u));
  moved[3][0] = 0.24;
  assert_false(element_is_sound(6, (corners_of)moved, u));
  assert_true(element_map(6, (corners_of)moved, u, NULL, NULL) <= 0);
  moved[3][0] = 0.5;
  moved[3][1] = 0.45; /* bent inward: |J| = 0 is reached between the corners first */
  assert_false(element_is_sound(6, (corners_of)moved, u));
  const double arrow[4][2] = {{0, 0}, {1, 0}, {0.4, 0.4}, {0, 1}};
  const double dart[4][2] = {{0, 0}, {1, 0}, {0.6, 0.6}, {0, 1}};
  assert_false(element_is_sound(4, arrow, u));
  assert_true(element_is_sound(4, dart, u));
  const double flat[3][2] = {{0, 0}, {1, 1}, {2, 2}}, clockwise[3][2] = {{0, 0}, {0, 1}, {1, 0}};
  assert_false(element_is_sound(3, flat, u));
  assert_false(element_is_sound(3, clockwise, u));
  for (int kind = 0; kind < 3; kind++)
    assert_true(element_is_sound(kinds[kind], places(kinds[kind]), u));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(functions_have_their_polynomials),
      cmocka_unit_test(the_way_back_is_found),
      cmocka_unit_test(areas_are_those_of_outlines),
      cmocka_unit_test(the_scaled_diagonal_is_that_of_the_paper),
      cmocka_unit_test(unsound_elements_are_known),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
