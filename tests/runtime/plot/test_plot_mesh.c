/* Parts of cells as pictures draw them: together they are the mesh, linear fields are exact, sides
   of a crack keep apart; lines of equal value at round values; pixels between corners. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/plot/colour_scale.h"
#include "runtime/plot/plot_cells.h"
#include "runtime/plot/plot_mesh.h"
#include "runtime/plot/plot_paths.h"
#include "runtime/plot/shading.h"

enum { ALONG = 5, UP = 4, NODES = ALONG * UP, CELLS = (ALONG - 1) * (UP - 1) };

typedef struct small_plot {
  plot_mesh mesh;
  int32_t cells[4 * CELLS];
  double reference[2 * NODES], moved[2 * NODES], values[NODES];
  mesh_view view;
} small_plot;

static void begin(small_plot *s) {
  memset(s, 0, sizeof *s);
  for (int n = 0; n < NODES; n++) {
    s->reference[2 * n] = 0.5 * (n % ALONG);
    s->reference[2 * n + 1] = 0.25 * (n / ALONG);
  }
  memcpy(s->moved, s->reference, sizeof s->moved);
  for (int c = 0; c < CELLS; c++) {
    const int32_t low = c / (ALONG - 1) * ALONG + c % (ALONG - 1);
    const int32_t around[4] = {low, low + 1, low + 1 + ALONG, low + ALONG};
    memcpy(s->cells + 4 * c, around, sizeof around);
  }
  s->mesh = (plot_mesh){.cell_count = CELLS, .cells = s->cells, .size = sqrt(0.125)};
  s->view = (mesh_view){s->reference, s->moved, s->values, NULL};
}

typedef struct seen {
  double area, worst, least, most;
  long parts, between; /* with other values than 0 and 1 */
} seen;

static double area_of(const double at[4][2]) {
  double sum = 0;
  for (int k = 0; k < 4; k++)
    sum += at[k][0] * at[(k + 1) % 4][1] - at[(k + 1) % 4][0] * at[k][1];
  return 0.5 * sum;
}

/* Each part has the one value of its cell, whatever its nodes have. */
static void look_at_cells(void *context, const double at[4][2], const double value[4]) {
  seen *s = context;
  const int i = (int)(at[0][0] / 0.5 + 1e-6), j = (int)(at[0][1] / 0.25 + 1e-6);
  s->parts++;
  for (int k = 0; k < 4; k++)
    s->worst = fmax(s->worst, fabs(value[k] - (100 - (j * (ALONG - 1) + i))));
}

static void values_of_cells_do_not_mix(void **state) {
  (void)state;
  int32_t number[CELLS];
  double of_cells[CELLS];
  small_plot p;
  seen s = {.area = 0};
  begin(&p);
  for (int c = 0; c < CELLS; c++) {
    number[c] = CELLS - 1 - c; /* the table has them the other way round */
    of_cells[number[c]] = 100 - c;
  }
  p.mesh.number = number;
  p.view.of_cells = of_cells;
  plot_mesh_parts(&p.mesh, &p.view, 3, 7, look_at_cells, &s);
  assert_int_equal(s.parts, 9 * CELLS);
  assert_true(s.worst == 0);
}

/* Moved by (0.1 y, 0), with the value 3 x - y of where it was. */
static void look(void *context, const double at[4][2], const double value[4]) {
  seen *s = context;
  s->area += area_of(at);
  s->parts++;
  for (int k = 0; k < 4; k++) {
    const double y = at[k][1], x = at[k][0] - 0.1 * y;
    s->worst = fmax(s->worst, fabs(value[k] - (3 * x - y)));
  }
}

/* Of rectangles, and of cells that lean. */
static void parts_are_the_mesh_and_linear_fields_exact(void **state) {
  (void)state;
  for (int leans = 0; leans < 2; leans++) {
    small_plot p;
    begin(&p);
    for (int n = 0; n < NODES; n++) {
      p.reference[2 * n] += 0.4 * leans * p.reference[2 * n + 1];
      p.moved[2 * n] = p.reference[2 * n] + 0.1 * p.reference[2 * n + 1];
      p.values[n] = 3 * p.reference[2 * n] - p.reference[2 * n + 1];
    }
    for (int whole = 1; whole <= 3; whole += 2) {
      seen s = {.area = 0};
      plot_mesh_parts(&p.mesh, &p.view, whole, 7, look, &s);
      assert_int_equal(s.parts, CELLS * whole * whole);
      assert_true(fabs(s.area - 2 * 0.75) < 1e-14 && s.worst < 1e-14);
    }
  }
}

static void look_at_sides(void *context, const double at[4][2], const double value[4]) {
  seen *s = context;
  s->area += area_of(at);
  s->parts++;
  for (int k = 0; k < 4; k++)
    s->between += fabs(value[k]) > 1e-12 && fabs(value[k] - 1) > 1e-12;
}

static void a_crack_keeps_its_sides_apart(void **state) {
  (void)state;
  small_plot p;
  begin(&p);
  const double low[2] = {0.81, -1}, high[2] = {0.72, 2}; /* between the second and third column */
  crack_lines_add(&p.mesh.lines, low, high);
  for (int n = 0; n < NODES; n++)
    if (n % ALONG > 1) {
      p.values[n] = 1;
      p.moved[2 * n] += 1;
    }
  seen s = {.area = 0};
  plot_mesh_parts(&p.mesh, &p.view, 1, 4, look_at_sides, &s);
  assert_int_equal(s.between, 0);
  assert_int_equal(s.parts, CELLS - 3 + 3 * 16);
  assert_true(fabs(s.area - 2 * 0.75) < 1e-14); /* nothing is drawn in the gap */
  const double on[2] = {0.81 - 0.09 / 3 * 1.3, 0.3}, left[2] = {-1e-4, 0}, right[2] = {1e-4, 0};
  double face[2][2];
  plot_mesh_face(&p.mesh, &p.view, on, left, face[0]);
  plot_mesh_face(&p.mesh, &p.view, on, right, face[1]);
  assert_true(fabs(face[0][0] - on[0]) < 1e-14 && fabs(face[1][0] - on[0] - 1) < 1e-14);
  crack_lines_close(&p.mesh.lines);
}

static void the_outline_is_what_one_cell_has_alone(void **state) {
  (void)state;
  small_plot p;
  long count;
  begin(&p);
  int32_t *sides = plot_mesh_outline(&p.mesh, &count);
  assert_int_equal(count, 2 * (ALONG - 1 + UP - 1));
  free(sides);
  memmove(p.cells + 4 * 5, p.cells + 4 * 6, 4 * (CELLS - 6) * sizeof *p.cells);
  p.mesh.cell_count--; /* without a cell inside */
  sides = plot_mesh_outline(&p.mesh, &count);
  assert_int_equal(count, 2 * (ALONG - 1 + UP - 1) + 4);
  free(sides);
}

/* Triangles have their last corner twice. */
static void triangles_are_filled_and_outlined(void **state) {
  (void)state;
  small_plot p;
  long count;
  begin(&p);
  const int32_t two[] = {0, 1, ALONG + 1, ALONG + 1, 0, ALONG + 1, ALONG, ALONG};
  memcpy(p.cells, two, sizeof two);
  p.mesh.cell_count = 2;
  for (int n = 0; n < NODES; n++) {
    p.moved[2 * n] += 0.1 * p.reference[2 * n + 1];
    p.values[n] = 3 * p.reference[2 * n] - p.reference[2 * n + 1];
  }
  for (int whole = 1; whole <= 4; whole++) {
    seen s = {.area = 0};
    plot_mesh_parts(&p.mesh, &p.view, whole, 7, look, &s);
    assert_true(fabs(s.area - 0.125) < 1e-15 && s.worst < 1e-14);
  }
  free(plot_mesh_outline(&p.mesh, &count));
  assert_int_equal(count, 4);
}

static void levels_are_round(void **state) {
  (void)state;
  double levels[CONTOURS_MOST];
  assert_int_equal(contour_levels(-0.5e6, 10.7e6, 10, levels), 11);
  for (int k = 0; k < 11; k++)
    assert_true(fabs(levels[k] - 1e6 * k) < 1e-3);
  assert_int_equal(contour_levels(0, 1, 4, levels), 4); /* 0.2 to 0.8 */
  assert_true(fabs(levels[0] - 0.2) < 1e-15 && fabs(levels[3] - 0.8) < 1e-15);
  assert_int_equal(contour_levels(3, 3, 4, levels), 0);
}

static void pixels_have_the_values_between(void **state) {
  (void)state;
  const canvas c = {.is_png = true};
  shading s = shading_new(&c, 10, 20, 8, 6);
  const double at[4][2] = {{11, 21}, {17, 21}, {17, 25}, {11, 25}}, value[4] = {0, 6, 10, 4};
  int inside = 0;
  shading_fill(&s, at, value);
  for (int y = 0; y < s.height; y++)
    for (int x = 0; x < s.width; x++) {
      const float v = s.values[y * s.width + x];
      const bool there = x >= 1 && x < 7 && y >= 1 && y < 5;
      assert_int_equal(!isnan(v), there);
      inside += there;
      if (there) assert_true(fabs(v - (x + 0.5 - 1 + y + 0.5 - 1)) < 1e-5); /* linear */
    }
  assert_int_equal(inside, 24);
  const double wild[4][2] = {{NAN, 0}, {1e300, 5}, {15, 1e9}, {-1e9, 3}};
  shading_fill(&s, wild, value); /* no crash */
  shading_free(&s);
  assert_int_equal(scale_step(NAN, 0, 1, CELL_STEPS), -1);
  assert_int_equal(scale_step(2, 0, 1, CELL_STEPS), CELL_STEPS - 1);
  assert_int_equal(scale_step(0.5, 0, 1, 2), 1);
}

static void paths_need_a_result(void **state) {
  (void)state;
  char error[512] = "";
  const char *const none[] = {"/nowhere/at/all.h5"};
  assert_false(plot_paths(none, 1, &(plot_paths_options){.output = "a.png"}, error, sizeof error));
  assert_non_null(strstr(error, "cannot read the result"));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(parts_are_the_mesh_and_linear_fields_exact),
                                     cmocka_unit_test(values_of_cells_do_not_mix),
                                     cmocka_unit_test(a_crack_keeps_its_sides_apart),
                                     cmocka_unit_test(the_outline_is_what_one_cell_has_alone),
                                     cmocka_unit_test(triangles_are_filled_and_outlined),
                                     cmocka_unit_test(levels_are_round),
                                     cmocka_unit_test(pixels_have_the_values_between),
                                     cmocka_unit_test(paths_need_a_result)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
