/* Cells by the modes of their nodes: strains of a field that is bilinear, work of forces, cells
   beside the last, sums over rows. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/kernel.h"
#include "runtime/mesh/rectangle_cells.h"
#include "runtime/rectangle.h"

enum { CELLS = 2 * PL_LANES + 3, GROUPS = 3, STRIDE = 4 * PL_LANES, POINTS = 4 * PL_LANES };

static const double wide = 0.3, high = 0.2, root = 0.57735026918962576451;

static double xi_of(int k) {
  return k % 2 ? 1 : -1;
}
static double eta_of(int k) {
  return k / 2 ? 1 : -1;
}

/* Shape functions (1 + xi_n xi)(1 + eta_n eta)/4 (Hughes 1987, 3.2). */
static void slopes_at_points(double slope[4][4][2]) {
  for (int p = 0; p < 4; p++)
    for (int n = 0; n < 4; n++) {
      slope[p][n][0] = xi_of(n) * (1 + eta_of(n) * root * eta_of(p)) / (2 * wide);
      slope[p][n][1] = eta_of(n) * (1 + xi_of(n) * root * xi_of(p)) / (2 * high);
    }
}

static pl_rectangle slopes(void) {
  double slope[4][4][2];
  pl_rectangle r;
  slopes_at_points(slope);
  assert_true(rectangle_slopes_find(&r, (const double(*)[4][2])slope, 1e-12));
  return r;
}

/* u_x = x y, u_y = 2 x - 3 y + x y: eps_xx = y, eps_yy = x - 3, eps_xy = (x + 2 + y)/2. */
static void strains_are_those_of_the_field(void **state) {
  (void)state;
  const pl_rectangle r = slopes();
  double plane[2][2 * STRIDE], strain[3][POINTS];
  for (int j = 0; j < 2; j++)
    for (int i = 0; i < STRIDE; i++) {
      const double x = i * wide, y = j * high;
      plane[0][j * STRIDE + i] = x * y;
      plane[1][j * STRIDE + i] = 2 * x - 3 * y + x * y;
    }
  rectangle_cells_strain(&r, (const double *const[]){plane[0], plane[1]}, STRIDE,
                         (double *const[]){strain[0], strain[1], strain[2]});
  for (int p = 0; p < 4; p++)
    for (int lane = 0; lane < PL_LANES; lane++) {
      const double x = wide * (lane + 0.5 * (1 + root * xi_of(p))),
                   y = high * 0.5 * (1 + root * eta_of(p));
      const int at = p * PL_LANES + lane;
      assert_true(fabs(strain[0][at] - y) < 1e-13);
      assert_true(fabs(strain[1][at] - (x - 3)) < 1e-13);
      assert_true(fabs(strain[2][at] - 0.5 * (x + 2 + y)) < 1e-13);
    }
}

/* Each node has sum B^T stress volume over the cells that are there. */
static void forces_are_those_of_the_stress(void **state) {
  (void)state;
  const pl_rectangle r = slopes();
  const double volume = 0.7;
  double slope[4][4][2], stress[3][GROUPS * POINTS], force[2][2 * STRIDE], right[2][2 * STRIDE];
  slopes_at_points(slope);
  for (int c = 0; c < 3; c++)
    for (int k = 0; k < GROUPS * POINTS; k++)
      stress[c][k] = sin(1 + 0.7 * k + 2 * c);
  for (int k = 0; k < 2 * STRIDE; k++)
    force[0][k] = force[1][k] = right[0][k] = right[1][k] = 0.01 * k;
  for (int cell = 0; cell < CELLS; cell++)
    for (int p = 0; p < 4; p++)
      for (int n = 0; n < 4; n++) {
        const int k = cell / PL_LANES * POINTS + p * PL_LANES + cell % PL_LANES,
                  at = n / 2 * STRIDE + cell + n % 2;
        const double *s = slope[p][n];
        right[0][at] += volume * (s[0] * stress[0][k] + s[1] * stress[2][k]);
        right[1][at] += volume * (s[1] * stress[1][k] + s[0] * stress[2][k]);
      }
  const pl_rectangle by = rectangle_slopes_times(&r, volume);
  double plane[RECTANGLE_PUSHES][GROUPS * PL_LANES], *pushed[RECTANGLE_PUSHES];
  for (int k = 0; k < RECTANGLE_PUSHES; k++)
    pushed[k] = plane[k];
  rectangle_cells_push(&by, GROUPS, (const double *const[]){stress[0], stress[1], stress[2]},
                       pushed);
  rectangle_cells_gather(CELLS, pushed, (double *const[]){force[0], force[1]}, STRIDE);
  for (int d = 0; d < 2; d++)
    for (int k = 0; k < 2 * STRIDE; k++)
      assert_true(fabs(force[d][k] - right[d][k]) < 1e-12);
}

/* Forces do the work of the stress: sum f u = sum s : strain. */
static void forces_and_strains_are_conjugate(void **state) {
  (void)state;
  const pl_rectangle r = slopes();
  double u[2][4], stress[3][4], strain[3][4], force[2][4], outer = 0, inner = 0;
  for (int k = 0; k < 4; k++) {
    for (int d = 0; d < 2; d++)
      u[d][k] = sin(1 + 3 * k + 5 * d);
    for (int c = 0; c < 3; c++)
      stress[c][k] = cos(2 + 3 * k + 7 * c);
  }
  pl_rectangle_strain(&r, u[0], u[1], strain);
  pl_rectangle_push(&r, stress[0], stress[2], force[0]);
  pl_rectangle_push(&r, stress[2], stress[1], force[1]);
  for (int k = 0; k < 4; k++) {
    outer += force[0][k] * u[0][k] + force[1][k] * u[1][k];
    inner +=
        stress[0][k] * strain[0][k] + stress[1][k] * strain[1][k] + 2 * stress[2][k] * strain[2][k];
  }
  assert_true(fabs(inner) > 1 && fabs(outer - inner) < 1e-12 * fabs(inner));
}

static void other_slopes_are_no_rectangle(void **state) {
  (void)state;
  for (int at = 0; at < 32; at++) {
    double slope[4][4][2];
    pl_rectangle r;
    slopes_at_points(slope);
    slope[at / 8][at / 2 % 4][at % 2] += 1e-6;
    assert_false(rectangle_slopes_find(&r, (const double(*)[4][2])slope, 1e-9));
  }
}

/* --- rows of cells ---------------------------------------------------------------------------- */

enum { ROWS = 5, NODES = CELLS + 1, AXES = 2 };

/* What cells of all rows do to their nodes. */
typedef struct pushed_rows {
  double plane[ROWS][RECTANGLE_PUSHES][CELLS], *at[RECTANGLE_PUSHES];
} pushed_rows;

static double *const *pushed_from(pushed_rows *p, int row, int first) {
  for (int k = 0; k < RECTANGLE_PUSHES; k++)
    p->at[k] = p->plane[row][k] + first;
  return p->at;
}

/* What a row does to its lower and upper nodes, by itself. */
static void row_alone(pushed_rows *p, int row, double force[AXES][2][NODES]) {
  memset(force, 0, sizeof(double[AXES][2][NODES]));
  rectangle_cells_gather(CELLS, pushed_from(p, row, 0), (double *const[]){force[0][0], force[1][0]},
                         NODES);
}

static void same_bits(const double *a, const double *b) {
  for (int n = 0; n < NODES; n++)
    assert_memory_equal(&a[n], &b[n], sizeof *a);
}

/* As kernels do it: what lanes beyond the last cell push is nothing that counts. */
static void add_strip(rectangle_rows *sums, int first, int end, double *const *pushed,
                      double force[AXES][NODES]) {
  for (int d = 0; d < AXES; d++) {
    pl_rectangle_ends ends;
    pl_rectangle_begin(&ends, sums->right[d]);
    for (int c = first; c < end; c += PL_LANES) {
      for (int lane = 0; lane < PL_LANES; lane++) {
        double at[4] = {NAN, NAN, NAN, NAN};
        for (int k = 0; k < 4 && c + lane < end; k++)
          at[k] = pushed[4 * d + k][c - first + lane];
        pl_rectangle_keep(&ends, lane, at);
      }
      pl_rectangle_sum(&ends, end - c, force[d] + c, sums->above[d] + c);
    }
    pl_rectangle_end(&ends, sums->right[d]);
  }
}

/* Sums from row to row are those of rows by themselves, to the bit: strip by strip, and where sums
   begin anew and what the row below does is added later. */
static void sums_of_rows_are_those_of_cells(void **state) {
  (void)state;
  static const int strips[] = {0, PL_LANES, 2 * PL_LANES, CELLS};
  static pushed_rows p;
  static double alone[ROWS][AXES][2][NODES], force[AXES][NODES], above[AXES][NODES];
  for (int row = 0; row < ROWS; row++) {
    for (int k = 0; k < RECTANGLE_PUSHES; k++)
      for (int c = 0; c < CELLS; c++)
        p.plane[row][k][c] = sin(1 + 0.37 * c + 1.9 * k + 5.3 * row) / 3;
    row_alone(&p, row, alone[row]);
  }
  for (int begins = 0; begins < ROWS; begins++) { /* in this row, too */
    rectangle_rows sums = {.above = {above[0], above[1]}};
    for (int row = 0; row < ROWS; row++) {
      if (row == 0 || row == begins) rectangle_rows_begin(&sums, 0, NODES);
      for (int s = 0; s < 3; s++)
        add_strip(&sums, strips[s], strips[s + 1], pushed_from(&p, row, strips[s]), force);
      rectangle_rows_end(&sums, CELLS, (double *const[]){force[0] + CELLS, force[1] + CELLS});
      for (int d = 0; d < AXES; d++) {
        double right[NODES];
        for (int n = 0; n < NODES; n++)
          right[n] =
              alone[row][d][0][n] + (row == 0 || row == begins ? 0 : alone[row - 1][d][1][n]);
        same_bits(force[d], right);
        same_bits(above[d], alone[row][d][1]);
      }
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(strains_are_those_of_the_field),
                                     cmocka_unit_test(forces_are_those_of_the_stress),
                                     cmocka_unit_test(forces_and_strains_are_conjugate),
                                     cmocka_unit_test(other_slopes_are_no_rectangle),
                                     cmocka_unit_test(sums_of_rows_are_those_of_cells)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
