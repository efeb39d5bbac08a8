/* A sparse matrix from products with it, and its lowest eigenvalues, against closed forms and all
   eigenvalues of the dense matrix: simple ones, multiple ones, zeros, and matrices that have no
   modes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/analysis/lowest_modes.h"
#include "runtime/analysis/sparse_probe.h"

/* LAPACK: eigenvalues of a symmetric matrix, ascending. */
void dsyev_(const char *job, const char *part, const int *n, double *a, const int *leading,
            double *values, double *work, const int *room, int *info, size_t job_length,
            size_t part_length);

enum { MOST = 400 };
typedef struct dense {
  int order, products;
  double a[MOST][MOST];
} dense;

static void multiply(void *of, const double *x, double *product) {
  dense *m = of;
  m->products++;
  for (int r = 0; r < m->order; r++) {
    product[r] = 0;
    for (int c = 0; c < m->order; c++)
      product[r] += m->a[r][c] * x[c];
  }
}

static double random_of(uint64_t *bits) {
  *bits = *bits * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(*bits >> 11) * 0x1p-53;
}

/* Springs between rows p and q of a matrix, and to the ground. */
static void add_spring(dense *m, int p, int q, double k) {
  m->a[p][p] += k;
  if (q < 0) return;
  m->a[q][q] += k;
  m->a[p][q] -= k;
  m->a[q][p] -= k;
}

/* Nodes of one to three rows in a grid, as wide as nodes are; springs between all rows of
   neighbours. */
typedef struct grid {
  dense m;
  int32_t pairs[4 * MOST][2];
  long pair_count, first[MOST + 1];
  int wide, high;
} grid;

static void add_pair(grid *g, int a, int b, uint64_t *bits) {
  g->pairs[g->pair_count][0] = b;
  g->pairs[g->pair_count++][1] = a;
  for (long p = g->first[a]; p < g->first[a + 1]; p++)
    for (long q = g->first[b]; q < g->first[b + 1]; q++)
      add_spring(&g->m, (int)p, (int)q, 1 + random_of(bits));
}

static grid *grid_new(int wide, int high) {
  grid *g = must_calloc(1, sizeof *g);
  uint64_t bits = 4711;
  g->wide = wide;
  g->high = high;
  for (int n = 0; n < wide * high; n++)
    g->first[n + 1] = g->first[n] + 1 + n % 3;
  g->m.order = (int)g->first[wide * high];
  assert_true(g->m.order <= MOST);
  for (int y = 0; y < high; y++)
    for (int x = 0; x < wide; x++) {
      const int n = y * wide + x;
      if (x > 0) add_pair(g, n, n - 1, &bits);
      if (y > 0) add_pair(g, n, n - wide, &bits);
      if (x > 0 && y > 0) add_pair(g, n, n - wide - 1, &bits);
    }
  return g;
}

static sparse_matrix probed(grid *g) {
  sparse_graph graph =
      sparse_graph_new(g->wide * g->high, (const int32_t(*)[2])g->pairs, g->pair_count);
  const sparse_matrix m = sparse_probe(&graph, g->first, multiply, &g->m);
  sparse_graph_free(&graph);
  return m;
}

static void a_probed_matrix_is_the_matrix(void **state) {
  (void)state;
  grid *g = grid_new(12, 10);
  sparse_matrix s = probed(g);
  double sum = 0, difference = 0, largest = 0;
  for (long c = 0; c < s.order; c++)
    for (int64_t k = s.begin[c]; k < s.begin[c + 1]; k++) {
      difference = fmax(difference, fabs(s.value[k] - g->m.a[s.row[k]][c]));
      sum += fabs(s.value[k]) * (s.row[k] == c ? 1 : 2);
    }
  for (int r = 0; r < g->m.order; r++) {
    double row = 0;
    for (int c = 0; c < g->m.order; c++) {
      row += fabs(g->m.a[r][c]);
      sum -= fabs(g->m.a[r][c]);
    }
    largest = fmax(largest, row);
  }
  assert_true(difference == 0); /* products with units */
  assert_true(fabs(sum) < 1e-9);
  assert_true(fabs(s.size / largest - 1) < 1e-14);
  assert_true(s.asymmetry == 0);
  assert_true(g->m.products < 60); /* of 239 columns */
  g->m.a[3][4] += 1e-3;            /* and what is not symmetric is told, and halved */
  sparse_matrix_free(&s);
  s = probed(g);
  assert_true(fabs(s.asymmetry - 1e-3) < 1e-15);
  sparse_matrix_free(&s);
  free(g);
}

static void reach_counts_steps(void **state) {
  (void)state;
  const int32_t pairs[][2] = {{0, 1}, {2, 1}, {2, 3}, {3, 4}, {4, 3}};
  sparse_graph one = sparse_graph_new(6, pairs, 5), two = sparse_graph_reach(&one, 2);
  static const int32_t near[] = {0, 1, 2, 0, 1, 2, 3, 0, 1, 2, 3, 4, 1, 2, 3, 4, 2, 3, 4, 5};
  static const long begin[] = {0, 3, 7, 12, 16, 19, 20};
  assert_memory_equal(two.begin, begin, sizeof begin);
  assert_memory_equal(two.near, near, sizeof near);
  sparse_graph_free(&one);
  sparse_graph_free(&two);
}

/* All eigenvalues of a held grid, to 1e-8, and in vectors at right angles. */
static void all_eigenvalues_are_found(void **state) {
  (void)state;
  enum { ALL = 60 };
  grid *g = grid_new(6, 5);
  add_spring(&g->m, 0, -1, 5);
  assert_int_equal(g->m.order, ALL);
  sparse_matrix s = probed(g);
  lowest_mode modes[ALL];
  int count, zeros, info, n = ALL, room = 64 * ALL;
  assert_null(lowest_modes_find(&s, 1e-12, ALL, modes, &count, &zeros));
  assert_int_equal(count, ALL);
  assert_int_equal(zeros, 0);
  double a[ALL * ALL], values[ALL], work[64 * ALL];
  for (int k = 0; k < ALL * ALL; k++)
    a[k] = g->m.a[k / ALL][k % ALL];
  dsyev_("N", "U", &n, a, &n, values, work, &room, &info, 1, 1);
  for (int k = 0; k < ALL; k++) {
    assert_true(fabs(modes[k].value / values[k] - 1) < 1e-8);
    assert_true(modes[k].residual < 1e-8 * values[k] + 1e-12);
    for (int m = 0; m <= k; m++) {
      double product = 0;
      for (int r = 0; r < ALL; r++)
        product += modes[k].vector[r] * modes[m].vector[r];
      assert_true(fabs(product - (m == k)) < 1e-8);
    }
  }
  lowest_modes_free(modes, count);
  sparse_matrix_free(&s);
  free(g);
}

/* Copies of one chain of `each` springs and masses, held at one end or free: 4 sin^2 of
   (k - 1/2) pi/(2 n + 1), or of k pi/(2 n). */
static sparse_matrix copies_of_chain(grid *g, int copies, int each, bool held) {
  g->wide = copies * each;
  g->high = 1;
  g->m.order = copies * each;
  for (int n = 0; n < copies * each; n++) {
    g->first[n + 1] = n + 1;
    if (n % each == 0 && held) add_spring(&g->m, n, -1, 1);
    if (n % each == 0) continue;
    g->pairs[g->pair_count][0] = n;
    g->pairs[g->pair_count++][1] = n - 1;
    add_spring(&g->m, n, n - 1, 1);
  }
  return probed(g);
}

static void multiple_eigenvalues_are_found_as_often_as_they_are(void **state) {
  (void)state;
  enum { COPIES = 5, EACH = 20, MANY = 12 };
  for (int held = 0; held < 2; held++) {
    grid *g = must_calloc(1, sizeof *g);
    sparse_matrix s = copies_of_chain(g, COPIES, EACH, held);
    lowest_mode modes[MANY];
    int count, zeros;
    assert_null(lowest_modes_find(&s, 1e-12, MANY, modes, &count, &zeros));
    assert_int_equal(count, MANY);
    assert_int_equal(zeros, held ? 0 : COPIES);
    for (int k = 0; k < MANY; k++) {
      const double number = k / COPIES + 1, angle = held ? (number - 0.5) * M_PI / (2 * EACH + 1)
                                                         : number * M_PI / (2 * EACH);
      if (!(fabs(modes[k].value / (4 * sin(angle) * sin(angle)) - 1) < 1e-10))
        fail_msg("mode %d: %.15g", k, modes[k].value);
    }
    lowest_modes_free(modes, count);
    sparse_matrix_free(&s);
    free(g);
  }
}

/* Fewer than are asked for; a matrix that pushes on, and one with more zeros than are counted. */
static void odd_matrices(void **state) {
  (void)state;
  lowest_mode modes[30];
  int count, zeros;
  grid *g = must_calloc(1, sizeof *g);
  sparse_matrix s = copies_of_chain(g, 1, 20, false);
  assert_null(lowest_modes_find(&s, 1e-12, 30, modes, &count, &zeros));
  assert_int_equal(count, 19);
  assert_int_equal(zeros, 1);
  lowest_modes_free(modes, count);
  g->m.a[3][3] -= 1;
  sparse_matrix_free(&s);
  s = probed(g);
  assert_string_equal(lowest_modes_find(&s, 1e-12, 3, modes, &count, &zeros),
                      "the bodies are unstable at rest");
  assert_int_equal(count, 0);
  sparse_matrix_free(&s);
  memset(g, 0, sizeof *g);
  s = copies_of_chain(g, 40, 2, false);
  assert_null(lowest_modes_find(&s, 1e-12, 30, modes, &count, &zeros));
  assert_int_equal(count, 30);
  assert_int_equal(zeros, LOWEST_MOST_ZEROS);
  for (int k = 0; k < count; k++)
    assert_true(fabs(modes[k].value / 2 - 1) < 1e-10);
  lowest_modes_free(modes, count);
  sparse_matrix_free(&s);
  free(g);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_probed_matrix_is_the_matrix), cmocka_unit_test(reach_counts_steps),
      cmocka_unit_test(all_eigenvalues_are_found),
      cmocka_unit_test(multiple_eigenvalues_are_found_as_often_as_they_are),
      cmocka_unit_test(odd_matrices)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
