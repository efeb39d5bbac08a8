/* Whether the cells of a mesh are of sizes that a law holds for: bounds, open and closed; whose cells
   count; elements and element-free cells. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "hooke_law.h"
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

/* 2 x 2 cells of 0.5 m x 0.5 m; the left ones of finite elements. */
static mesh four_cells(void) {
  mesh m;
  mesh_open(&m, (int[2]){3, 3}, (double[2]){0, 0}, (double[2]){1, 1}, 1, 2.1);
  for (int j = 0; j < 3; j++)
    m.element_free[mesh_node(&m, 0, j)] = m.element_free[mesh_node(&m, 1, j)] = 0;
  mesh_settle(&m);
  return m;
}

/* What is said of a law that reads sizes within a range; "" where all is good. */
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
  snprintf(text, sizeof text, "%s", fit ? "" : d.items[0].message);
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

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(sizes_lie_within_bounds),
                                     cmocka_unit_test(element_free_cells_have_no_size)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
