/* Mixed mode on the micropolar lattice, at twice the spacing of examples/mixed_mode where that is
   enough: from which of two places the struck beam cracks, what a mirror and half a turn leave as
   it is, and the figures of the page. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"
#include "tests/verification/page.h"

#define FOLDER "examples/mixed_mode/"
static const char page[] = FOLDER "README.md";

/* The beam at 3.175 mm; softening ends at half the stretch, so that a crack costs the same. */
static const char *const coarse[] = {"lattice.spacing=3.175 mm", "material.alpha2=16.018",
                                     "material.alpha3=31.035",
                                     "region[striker].corner=-14.1 mm, 74 mm"};
enum { COARSE = 4, HALF_SPAN = 64 };

typedef struct struck {
  double peak, notch, midspan; /* N; m, heights of both cracks' tips at the end */
} struck;

static struck result_of(deck_case *c) {
  assert_int_equal(deck_case_go(c), STEP_STOPPED);
  const struck s = {deck_case_largest(c, "load"), deck_case_last(c, "notch_crack"),
                    deck_case_last(c, "midspan_crack")};
  print_message("  %.0f N; notch %.1f mm, midspan %.1f mm\n", s.peak, 1e3 * s.notch,
                1e3 * s.midspan);
  return s;
}

/* The beam with its notch in the column at n/64 of half the span, to the left or (-1) the right. */
static void open_beam(deck_case *c, int n, int side, bool is_coarse) {
  const double s = is_coarse ? 3.175 : 1.5875, x = -side * 101.6 * n / HALF_SPAN;
  char corner[64], size[64];
  const char *changes[COARSE + 3];
  snprintf(corner, sizeof corner, "notch.corner=%.4f mm, -1 mm", x - 0.2 * s);
  snprintf(size, sizeof size, "notch.size=%.4f mm, 20.05 mm", 0.4 * s);
  changes[0] = corner;
  changes[1] = size;
  changes[2] =
      side > 0 ? "region[beside].corner=-100 mm, -1 mm" : "region[beside].corner=35 mm, -1 mm";
  memcpy(changes + 3, coarse, sizeof coarse);
  assert_true(deck_case_run(c, FOLDER "offset_notch.nml", changes, is_coarse ? COARSE + 3 : 3));
}

static struck beam(int n, int side, bool is_coarse) {
  deck_case c;
  open_beam(&c, n, side, is_coarse);
  const struck s = result_of(&c);
  deck_case_close(&c);
  return s;
}

static void a_notch_near_midspan_cracks(void **unused) {
  (void)unused;
  const int places[] = {43, 47, 51};
  for (int k = 0; k < 3; k++) {
    const struck s = beam(places[k], 1, true);
    assert_true(s.notch > 0.070);
    assert_true(s.midspan == 0);
  }
}

static void else_the_beam_cracks_at_midspan(void **unused) {
  (void)unused;
  const int places[] = {53, 55};
  for (int k = 0; k < 2; k++) {
    const struck s = beam(places[k], 1, true);
    assert_true(s.midspan > 0.070);
    assert_true(s.notch == 0);
  }
}

/* A particle's damage at the place (x, y); -1 without a particle. */
static double damage_at(const rows *g, const double *damage, double x, double y) {
  for (long p = 0; p < g->particle_count; p++) {
    const long site = g->particle_site[p];
    if (fabs(g->x[site] - x) < 1e-6 && fabs(g->y[site] - y) < 1e-6) return damage[p];
  }
  return -1;
}

static double *damages(const deck_case *c, const rows *g) {
  const frame_field *fields;
  const int count = simulation_frame_fields(c->simulation, &fields);
  int at = 0;
  while (at < count && strcmp(fields[at].name, "damage") != 0)
    at++;
  assert_true(at < count);
  double *values = must_alloc((size_t)g->particle_count * sizeof *values);
  simulation_frame_values(c->simulation, at, values);
  return values;
}

/* The largest difference between the damage of a particle of `a` and that of its image in `b`. */
static double image_gap(const deck_case *a, const deck_case *b, double sign_y) {
  const rows *g = simulation_rows(a->simulation, 0), *h = simulation_rows(b->simulation, 0);
  double *first = damages(a, g), *second = damages(b, h), gap = 0;
  assert_int_equal(g->particle_count, h->particle_count);
  for (long p = 0; p < g->particle_count; p++) {
    const long site = g->particle_site[p];
    const double image = damage_at(h, second, -g->x[site], sign_y * g->y[site]);
    assert_true(image >= 0);
    gap = fmax(gap, fabs(first[p] - image));
  }
  free(first);
  free(second);
  return gap;
}

/* The mirrored beam sums its forces in another order, so that rounding differs, and grows where the
   crack's tip has a choice. 1e-6 leaves room for that; another bond broken would be 1/6. */
static void the_mirrored_beam_has_the_mirrored_crack(void **unused) {
  (void)unused;
  deck_case left, right;
  open_beam(&left, 43, 1, true);
  open_beam(&right, 43, -1, true);
  const struck a = result_of(&left), b = result_of(&right);
  const double gap = image_gap(&left, &right, 1);
  print_message("  peaks apart by %.1e, damage by %.1e\n", a.peak / b.peak - 1, gap);
  assert_true(fabs(a.peak / b.peak - 1) < 1e-9);
  assert_true(gap < 1e-6);
  deck_case_close(&left);
  deck_case_close(&right);
}

static void says(const char *row, const char *form, double value) {
  char figure[64];
  snprintf(figure, sizeof figure, form, value);
  page_line_says(page, row, figure);
}

/* The page's own spacing, on either side of the transition. */
static void the_page_has_the_beams_figures(void **unused) {
  (void)unused;
  const struck nearest = beam(43, 1, false), near = beam(51, 1, false), far = beam(52, 1, false);
  assert_true(nearest.notch > 0.070 && nearest.midspan == 0);
  says("| 43/64", "%.2f kN", 1e-3 * nearest.peak);
  assert_true(near.notch > 0.070 && near.midspan == 0);
  assert_true(far.midspan > 0.070 && far.notch < 0.070);
  says("| 51/64", "%.2f kN", 1e-3 * near.peak);
  says("| 52/64", "%.2f kN", 1e-3 * far.peak);
  says("| 52/64", "%.1f mm", 1e3 * far.notch);
}

static void open_plate(deck_case *c, const char *rotation) {
  assert_true(deck_case_run(c, FOLDER "double_edge_notched.nml", &rotation, 1));
  assert_int_equal(deck_case_go(c), STEP_END);
}

/* Half a turn leaves the plate and its loads as they are, and so the two cracks, to rounding and
   what the relaxation leaves unbalanced; another bond broken would be 1/6. */
static void half_a_turn_changes_nothing(void **unused) {
  (void)unused;
  deck_case c;
  open_plate(&c, "lattice.rotation=30");
  const double gap = image_gap(&c, &c, -1);
  print_message("  damage apart by %.1e\n", gap);
  assert_true(gap < 0.05);
  says("| pulled and sheared, 30", "%.2f kN", 1e-3 * deck_case_largest(&c, "tension"));
  deck_case_close(&c);
}

static void the_page_has_the_plates_figures(void **unused) {
  (void)unused;
  deck_case c;
  open_plate(&c, "lattice.rotation=0");
  says("| pulled and sheared, 0", "%.2f kN", 1e-3 * deck_case_largest(&c, "tension"));
  says("| pulled and sheared, 0", "%.2f kN", 1e-3 * deck_case_largest(&c, "shear"));
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_notch_near_midspan_cracks),
      cmocka_unit_test(else_the_beam_cracks_at_midspan),
      cmocka_unit_test(the_mirrored_beam_has_the_mirrored_crack),
      cmocka_unit_test(the_page_has_the_beams_figures),
      cmocka_unit_test(half_a_turn_changes_nothing),
      cmocka_unit_test(the_page_has_the_plates_figures),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
