/* Whether the cells of a mesh are of sizes that a law holds for: bounds, open and closed; whose
   cells count; elements and element-free cells; cells whose sides differ. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "hooke_law.h"
#include "list_cases.h"
#include "runtime/continuum/cell_sizes.h"

typedef struct range { /* m */
  double low, high;
  unsigned char low_open, high_open;
} range;

static range wanted;

static void bounds(const pl_law *law, const double *parameters, double *low, double *high,
                   unsigned char *low_open, unsigned char *high_open) {
  (void)law;
  (void)parameters;
  *low = wanted.low;
  *high = wanted.high;
  *low_open = wanted.low_open;
  *high_open = wanted.high_open;
}

static double high = 1; /* m: of the mesh */

/* 2 x 2 cells of 0.5 m x 0.5 m; the left ones of finite elements. */
static mesh four_cells(void) {
  mesh m;
  mesh_open(&m, (int[2]){3, 3}, (double[2]){0, 0}, (double[2]){1, high}, 1, 2.1);
  for (int j = 0; j < 3; j++)
    m.element_free[mesh_node(&m, 0, j)] = m.element_free[mesh_node(&m, 1, j)] = 0;
  mesh_settle(&m);
  return m;
}

/* What is said of a law that reads sizes within a range, a warning too; "" where all is good. */
static const char *said(const unsigned char *own, bool reads, const range *in) {
  static char text[500];
  pl_law law = hooke_law;
  source_set sources = {.count = 0};
  diagnostics d;
  mesh m = four_cells();
  law.reads_size = reads;
  law.size_bounds = in ? bounds : NULL;
  law.size_reason = "a reason";
  if (in) wanted = *in;
  diag_begin(&d, &sources);
  const bool fit = cell_sizes_fit(&m, own, &law, NULL, (span){0}, &d);
  assert_int_equal(d.errors, fit ? 0 : 1);
  snprintf(text, sizeof text, "%s", d.count ? d.items[0].message : "");
  diag_clear(&d);
  mesh_close(&m);
  return text;
}

static const unsigned char left[4] = {1, 0, 1, 0};

static void sizes_lie_within_bounds(void **state) {
  (void)state;
  assert_string_equal(said(left, false, &(range){0.1, 0.6, 1, 1}), "");
  assert_string_equal(said(left, false, &(range){0.1, 0.5, 1, 0}), "");
  assert_string_equal(said(left, false, &(range){0.5, 0.6, 0, 1}), "");
  assert_non_null(strstr(said(left, false, &(range){0.1, 0.5, 1, 1}), "500 mm across"));
  assert_non_null(
      strstr(said(left, false, &(range){0.1, 0.4, 1, 1}), "less than 400 mm: a reason"));
  assert_non_null(
      strstr(said(left, false, &(range){0.5, 0.9, 1, 1}), "more than 500 mm: a reason"));
  assert_non_null(strstr(said(left, false, &(range){0.7, 0.9, 1, 1}), "more than 700 mm"));
}

/* The right cells are element-free: a law that reads h must not have them. */
static void element_free_cells_have_no_size(void **state) {
  (void)state;
  assert_string_equal(said(NULL, false, NULL), "");
  assert_string_equal(said(left, true, NULL), "");
  assert_non_null(strstr(said(NULL, true, NULL), "is element-free and has none"));
}

/* Cells of 0.5 m x 0.125 m: h = 0.25 m is twice or half the width of a band. */
static void slender_cells_are_told(void **state) {
  (void)state;
  high = 0.25;
  assert_non_null(strstr(said(left, true, NULL), "takes up to 2 times more or less work"));
  assert_string_equal(said(left, false, NULL), "");
  high = 0.7;
  assert_string_equal(said(left, true, NULL), "");
  high = 1.6;
  assert_non_null(strstr(said(left, true, NULL), "is 1.6 times longer than wide"));
  high = 1;
}

/* A square cut in two triangles of 3 nodes: a row of squares is as wide before as after. */
static void triangles_are_as_wide_as_the_square_they_halve(void **state) {
  (void)state;
  static const struct {
    int kind;
    double h;
  } cases[] = {{3, 0.25}, {4, 0.25}, {6, 0.25 / sqrt(2)}};
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
    list_mesh l;
    list_open(&l, 4, cases[n].kind, 0, 1);
    for (int c = 0; c < mesh_cell_count(&l.m); c++) {
      assert_true(fabs(mesh_cell_size(&l.m, c) - cases[n].h) < 1e-13);
      assert_true(fabs(mesh_cell_slender(&l.m, c) - 1) < 1e-13);
    }
    list_close(&l);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sizes_lie_within_bounds), cmocka_unit_test(element_free_cells_have_no_size),
      cmocka_unit_test(slender_cells_are_told),
      cmocka_unit_test(triangles_are_as_wide_as_the_square_they_halve)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
