/* What stands beside curves: the range that it needs, and that it is drawn where it belongs, gaps left out. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "runtime/plot/plot_beside.h"

static const double x[] = {1, 2, NAN, 4, 5}, y[] = {10, -3, 99, 7, INFINITY};
static const double low[] = {0, 1, 2, NAN, 1}, high[] = {5, 8, 9, 6, 12};
static const plot_beside points = {.x = x, .y = y, .count = 5};
static const plot_beside band = {.x = x, .low = low, .high = high, .count = 5};

static void ranges_are_widened_by_finite_values(void **state) {
  (void)state;
  double from = 3, to = 3;
  beside_range(&points, true, &from, &to);
  assert_true(from == 1 && to == 5);
  from = INFINITY, to = -INFINITY;
  beside_range(&points, false, &from, &to);
  assert_true(from == -3 && to == 99);
  from = 1, to = 2;
  beside_range(&band, false, &from, &to);
  assert_true(from == 0 && to == 12);
  from = -50, to = 50; /* never narrower */
  beside_range(&band, true, &from, &to);
  assert_true(from == -50 && to == 50);
}

/* --- pictures --------------------------------------------------------------------------------- */

typedef struct picture {
  canvas canvas;
  axis x, y;
  char path[32];
} picture;

static void begin(picture *p) {
  char error[200];
  strcpy(p->path, "/tmp/perilat_XXXXXX.png");
  close(mkstemps(p->path, 4));
  assert_true(canvas_open(&p->canvas, p->path, DIAGRAM_WIDTH, DIAGRAM_HEIGHT, error, sizeof error));
  assert_true(axis_set(&p->x, "x", "1", NULL, 0, 6, error, sizeof error));
  assert_true(axis_set(&p->y, "y", "1", NULL, 0, 12, error, sizeof error));
}

static void end(picture *p) {
  char error[200];
  assert_true(canvas_close(&p->canvas, error, sizeof error));
  unlink(p->path);
}

/* Anything but white within a few pixels of the place. */
static bool drawn_near(const picture *p, double at_x, double at_y, int pixels) {
  cairo_surface_t *s = p->canvas.surface;
  cairo_surface_flush(s);
  const unsigned char *data = cairo_image_surface_get_data(s);
  const int stride = cairo_image_surface_get_stride(s);
  const int column = (int)axis_along_x(&p->x, at_x), row = (int)axis_along_y(&p->y, at_y);
  for (int r = row - pixels; r <= row + pixels; r++)
    for (int c = column - pixels; c <= column + pixels; c++)
      for (int k = 0; k < 3; k++)
        if (data[r * stride + 4 * c + k] != 255) return true;
  return false;
}

/* A band from 2 to 3 along a ramp, with a gap in the middle. */
static void bands_are_shaded_between_their_values(void **state) {
  (void)state;
  enum { N = 7 };
  const double at[N] = {0, 1, 2, 3, 4, 5, 6};
  const double under[N] = {2, 3, 4, NAN, 6, 7, 8}, over[N] = {4, 5, 6, 7, 8, 9, 10};
  const plot_beside ramp = {.x = at, .low = under, .high = over, .count = N};
  picture p;
  begin(&p);
  beside_draw_band(&p.canvas, &ramp, 0, &p.x, &p.y);
  assert_true(drawn_near(&p, 1.5, 4.5, 2) && drawn_near(&p, 5, 8, 2));
  assert_false(drawn_near(&p, 3, 6, 2)); /* the gap */
  assert_false(drawn_near(&p, 1.5, 6.5, 2) || drawn_near(&p, 1.5, 2.5, 2));
  beside_draw_points(&p.canvas, &ramp, 0, &p.x, &p.y); /* a band has none */
  assert_false(drawn_near(&p, 3, 6, 2));
  end(&p);
}

/* Marks stand on the points, a line joins them but not across a gap; a single value is a dashed line. */
static void points_are_marked_and_joined(void **state) {
  (void)state;
  const double at[] = {1, 2, 3, 5}, height[] = {2, 2, NAN, 8};
  const plot_beside table = {.x = at, .y = height, .count = 4};
  picture p;
  begin(&p);
  beside_draw_points(&p.canvas, &table, 1, &p.x, &p.y);
  assert_true(drawn_near(&p, 1, 2, 6) && drawn_near(&p, 2, 2, 6) && drawn_near(&p, 5, 8, 6));
  assert_true(drawn_near(&p, 1.5, 2, 2));
  assert_false(drawn_near(&p, 3.5, 5, 6)); /* on the way from the second to the last */
  beside_draw_points(&p.canvas, &(plot_beside){.y = (double[]){11}, .count = 1}, 2, &p.x, &p.y);
  assert_true(drawn_near(&p, 0.5, 11, 8) && drawn_near(&p, 5.5, 11, 8));
  end(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ranges_are_widened_by_finite_values),
      cmocka_unit_test(bands_are_shaded_between_their_values),
      cmocka_unit_test(points_are_marked_and_joined),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
