/* Cells that lie over each other, and nodes that hang: none in a graded grid of quadrilaterals, in
   curved triangles and at a slit; each place where one node is put into another cell is found. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/geometry/cell_overlap.h"

enum { ALONG = 12, NODES = (ALONG + 1) * (ALONG + 1), CELLS = ALONG * ALONG };

typedef struct grid {
  double at[NODES + 3][2];
  unsigned char nodes[CELLS + 1];
  int32_t cell[CELLS + 1][ELEMENT_MOST_NODES];
} grid;

/* Sides grow by powers, so that cells are of all sizes; the map bends them. */
static void make_grid(grid *g) {
  memset(g, 0, sizeof *g);
  for (int j = 0; j <= ALONG; j++)
    for (int i = 0; i <= ALONG; i++) {
      double *at = g->at[j * (ALONG + 1) + i];
      at[0] = pow((double)i / ALONG, 3);
      at[1] = pow((double)j / ALONG, 2) + 0.3 * at[0];
    }
  for (int c = 0; c < CELLS; c++) {
    const int32_t a = c / ALONG * (ALONG + 1) + c % ALONG;
    const int32_t corner[] = {a, a + 1, a + ALONG + 2, a + ALONG + 1};
    g->nodes[c] = 4;
    memcpy(g->cell[c], corner, sizeof corner);
  }
}

static bool find(const grid *g, int nodes, int cells, cell_overlap *found) {
  const overlap_cells of = {.node_count = nodes,
                            .count = cells,
                            .at = g->at,
                            .nodes = g->nodes,
                            .cell = g->cell,
                            .same = 1e-9};
  return cell_overlap_find(&of, found);
}

/* A triangle of three more nodes around `middle`. */
static void add_triangle(grid *g, const double middle[2], double size) {
  static const double way[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  for (int q = 0; q < 3; q++) {
    for (int k = 0; k < 2; k++)
      g->at[NODES + q][k] = middle[k] + size * way[q][k];
    g->cell[CELLS][q] = NODES + q;
  }
  g->nodes[CELLS] = 3;
}

static void grids_are_sound_until_a_triangle_lies_on_them(void **state) {
  (void)state;
  grid g;
  cell_overlap found;
  make_grid(&g);
  assert_false(find(&g, NODES, CELLS, &found));
  for (int c = 0; c < CELLS; c++) {
    double middle[2] = {0, 0};
    for (int q = 0; q < 4; q++)
      for (int k = 0; k < 2; k++)
        middle[k] += g.at[g.cell[c][q]][k] / 4;
    add_triangle(&g, middle, 1e-5);
    assert_true(find(&g, NODES + 3, CELLS + 1, &found));
    assert_true(found.cell == c && found.side == -1);
  }
}

static void hanging_nodes_have_a_side(void **state) {
  (void)state;
  grid g;
  cell_overlap found;
  make_grid(&g); /* the triangle's first node lies on the right edge, the others beyond it */
  const double *low = g.at[5 * (ALONG + 1) + ALONG], *high = g.at[6 * (ALONG + 1) + ALONG],
               on[2] = {1, 0.4 * low[1] + 0.6 * high[1]};
  add_triangle(&g, on, 0.1);
  g.at[NODES + 2][0] += 0.05;
  assert_true(find(&g, NODES + 3, CELLS + 1, &found));
  assert_int_equal(found.cell, 5 * ALONG + ALONG - 1);
  assert_int_equal(found.side, 1);
  assert_int_equal(found.node, NODES);
  add_triangle(&g, high, 0.1); /* at a node it is a twin */
  g.at[NODES + 2][0] += 0.05;
  assert_false(find(&g, NODES + 3, CELLS + 1, &found));
}

/* Two triangles of 6 nodes with an arc between: the arc's middle is beyond the chord. */
static void arcs_are_sides(void **state) {
  (void)state;
  static const double at[10][2] = {{0, 0},   {1, 0}, {0, 1},   {0.5, 0}, {0.6, 0.6},
                                   {0, 0.5}, {1, 1}, {1, 0.5}, {0.5, 1}, {0.55, 0.55}};
  static const int32_t cell[2][ELEMENT_MOST_NODES] = {{0, 1, 2, 3, 4, 5}, {1, 6, 2, 7, 8, 4}};
  static const unsigned char nodes[2] = {6, 6};
  overlap_cells of = {9, 2, at, nodes, cell, 1e-9};
  cell_overlap found;
  assert_false(cell_overlap_find(&of, &found));
  of.node_count = 10; /* between chord and arc: in the first */
  assert_true(cell_overlap_find(&of, &found));
  assert_true(found.cell == 0 && found.node == 9 && found.side == -1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(grids_are_sound_until_a_triangle_lies_on_them),
      cmocka_unit_test(hanging_nodes_have_a_side), cmocka_unit_test(arcs_are_sides)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
