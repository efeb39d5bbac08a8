/* Along bars: neighbours in a copy, what a link chooses, and the length of bar that each chosen
   particle stands for: in all that of the bar, whatever its legs, its particles and the choice. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/filling/bar_line.h"
#include "tests/runtime/built_rows.h"

typedef struct built_line {
  built_rows b;
  bar_line line;
} built_line;

static void build_line(built_line *l, const char *bar, int first, int every) {
  char text[1000];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n&bar name = 'b' area = 1e-4 %s /\n"
           "&material bar = 'b' model = 'beam' /\n",
           bar);
  build_rows(&l->b, text);
  const deck_link link = {.first = first, .every = every};
  l->line = bar_line_of(&l->b.deck->lattices[0], &link, l->b.rows);
}

static void end_line(built_line *l) {
  bar_line_end(&l->line);
  built_end(&l->b);
}

/* Legs in parts of 10.4, 10 and 14 mm, and of 10 and 8.75 mm. */
#define BENT  "points = 0, 0, 0, 0.104, 0.02, 0.104, 0.02, 0.09 spacing = 0.01"
#define RING  "points = 0, 0, 0.05, 0, 0.05, 0.035, 0, 0.035 closed = T spacing = 0.01"
#define THREE " copies = 3 shift = 0.03, 0.04"

static void shares_add_up_to_the_bar(void **state) {
  (void)state;
  static const struct {
    const char *bar;
    int copies;
    double length;
  } bars[] = {{BENT, 1, 0.138}, {BENT THREE, 3, 0.138}, {RING, 1, 0.17}, {RING THREE, 3, 0.17}};
  for (int n = 0; n < 4; n++)
    for (int every = 1; every < 20; every++)
      for (int first = 0; first < every && first < 10; first++) {
        built_line l;
        double sum = 0;
        build_line(&l, bars[n].bar, first, every);
        assert_true(fabs(l.line.length / bars[n].length - 1) < 1e-14);
        for (int32_t p = 0; p < l.b.rows->particle_count; p++)
          if (bar_line_chooses(&l.line, p)) sum += bar_line_share(&l.line, p);
        assert_true(fabs(sum / (bars[n].copies * bars[n].length) - 1) < 1e-13);
        end_line(&l);
      }
}

static void has_share(const built_line *l, int32_t particle, double share) {
  assert_true(bar_line_chooses(&l->line, particle));
  assert_true(fabs(bar_line_share(&l->line, particle) / share - 1) < 1e-13);
}

/* 10.4 mm up to particle 10, then 10 mm to 12, then 14 mm to 13. */
static void half_of_the_way_is_along_the_bar(void **state) {
  (void)state;
  built_line l;
  build_line(&l, BENT THREE, 1, 3); /* 1, 4, 7, 10, 13 */
  assert_int_equal(l.line.each, 14);
  for (int copy = 0; copy < 3; copy++) {
    has_share(&l, 14 * copy + 1, 0.0104 + 0.0156);
    has_share(&l, 14 * copy + 7, 0.0312);
    has_share(&l, 14 * copy + 10, 0.0156 + 0.017);
    has_share(&l, 14 * copy + 13, 0.017);
    assert_false(bar_line_chooses(&l.line, 14 * copy));
  }
  end_line(&l);
}

/* 17 particles: between number 16 and number 0 there is one part alone, of 8.75 mm. */
static void rings_have_no_ends(void **state) {
  (void)state;
  built_line l;
  build_line(&l, RING, 0, 2);
  assert_int_equal(l.line.each, 18);
  end_line(&l);
  build_line(&l, "points = 0, 0, 0.05, 0, 0.05, 0.03, 0, 0.035 closed = T spacing = 0.01", 0, 2);
  const double slant = hypot(0.05, 0.005) / 5, rise = 0.035 / 4;
  assert_int_equal(l.line.each, 5 + 3 + 5 + 4);
  has_share(&l, 0, 0.01 + rise / 2);
  has_share(&l, 16, rise + rise / 2);
  has_share(&l, 8, 0.01 + slant);
  end_line(&l);
}

/* What is left out at the beginning, bare of bond, is nobody's. */
static void a_late_first_one_takes_no_more_than_others(void **state) {
  (void)state;
  built_line l;
  build_line(&l, "points = 0, 0, 0.3, 0 spacing = 0.01", 20, 2);
  has_share(&l, 20, 0.02);
  has_share(&l, 30, 0.01);
  end_line(&l);
  build_line(&l, "points = 0, 0, 0.05, 0, 0.05, 0.03, 0, 0.03 closed = T spacing = 0.01", 9, 3);
  has_share(&l, 9, 0.03);
  has_share(&l, 15, 0.03);
  end_line(&l);
}

static void copies_know_their_own_neighbours(void **state) {
  (void)state;
  built_line l;
  build_line(&l, BENT THREE, 0, 1);
  assert_int_equal(bar_line_beside(&l.line, 14, -1), 14);
  assert_int_equal(bar_line_beside(&l.line, 14, 1), 15);
  assert_int_equal(bar_line_beside(&l.line, 13, 1), 13);
  end_line(&l);
  build_line(&l, RING THREE, 0, 1);
  assert_int_equal(bar_line_beside(&l.line, 18, -1), 35);
  assert_int_equal(bar_line_beside(&l.line, 35, 1), 18);
  assert_int_equal(bar_line_beside(&l.line, 20, 1), 21);
  end_line(&l);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shares_add_up_to_the_bar),
      cmocka_unit_test(half_of_the_way_is_along_the_bar),
      cmocka_unit_test(rings_have_no_ends),
      cmocka_unit_test(a_late_first_one_takes_no_more_than_others),
      cmocka_unit_test(copies_know_their_own_neighbours),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
