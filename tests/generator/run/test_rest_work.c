/* The work of rest states and fields that change, `energy/rest`. Theory: a body between fixed ends
   that is heated gets -F dr, which is what it stores and moves with; the balance closes by an error
   that falls with the square of the step, of points of linear laws to rounding; what states take is
   nothing where they only swell; a body that is free gets next to nothing, and one that is heated
   and cools down again has got what damping took, which falls as it goes slower. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

#define LAW_OF(name) SOURCE_DIR "/tests/generator/run/rests/" name ".plm"

#define HELD                                                                                       \
  "&region name = 'left' shape = 'rectangle' corner = '-1 mm', '-1 mm' size = '7 mm', '72 mm' /\n" \
  "&region name = 'right' shape = 'rectangle' corner = '194 mm', '-1 mm' size = '9 mm', "          \
  "'72 mm' /\n"                                                                                    \
  "&support region = 'left' fix = 'x' /\n&support region = 'right' fix = 'x' /\n"
#define WARMS "293 [K] + 100 [K]*(t/300 [us])**2*(1 + x/200 [mm])"

typedef struct body_case {
  const char *what, *law_path, *lattice; /* NULL: a mesh */
  const char *mesh, *temperature;
} body_case;

static const body_case by_fields[] = {
    {"bonds of the hexagon", "thermal_bond", "'hexagonal'", NULL, WARMS},
    {"bonds of two shells of squares", "thermal_bond", "'square' shells = 2", NULL, WARMS},
    {"families that soften", LAW_OF("heated_family"), "'hexagonal'", NULL, WARMS}};
static const body_case by_states[] = {
    {"bonds that swell", LAW_OF("slow_bond"), "'hexagonal'", NULL, NULL},
    {"bonds that swell late", LAW_OF("late_bond"), "'hexagonal'", NULL, NULL},
    {"families that swell", LAW_OF("slow_family"), "'hexagonal'", NULL, NULL}};
static const body_case of_points[] = {
    {"points", "thermal_elastic", NULL, "", WARMS},
    {"points in plane strain", "thermal_elastic", NULL, "setting = 'plane_strain'", WARMS},
    {"points that soften and yield", LAW_OF("heated_point"), NULL, "setting = 'plane_strain'",
     WARMS}};
#define COUNT(cases) ((int)(sizeof(cases) / sizeof *(cases)))

/* Part of a deck, to be used at once. */
static const char *body_text(const body_case *b) {
  static char text[2000];
  if (b->lattice)
    snprintf(text, sizeof text,
             "&lattice name = 'l' kind = %s spacing = '10 mm' thickness = '10 mm' /\n"
             "&material lattice = 'l' model = '%s' /\n"
             "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '201 mm', '60 mm' /\n",
             b->lattice, b->law_path);
  else
    snprintf(text, sizeof text,
             "&mesh name = 'l' corner = 0, 0 size = '200 mm', '60 mm' nodes = 21, 7 thickness = "
             "'10 mm' method = 'finite_elements' %s /\n"
             "&material mesh = 'l' model = '%s' /\n",
             b->mesh, b->law_path);
  return text;
}

static void run_case(deck_case *c, const body_case *b, const char *temperature, const char *more) {
  char text[4096], field[400] = "";
  if (temperature)
    snprintf(field, sizeof field, "&field %s = 'l' name = 'T' value = '%s' /\n",
             b->lattice ? "lattice" : "mesh", temperature);
  snprintf(text, sizeof text, "%s%s%s", body_text(b), field, more);
  deck_case_open(c, text);
  assert_int_equal(deck_case_go(c), STEP_END);
  const char *unchecked;
  simulation_imbalance(c->simulation, &unchecked);
  assert_null(unchecked);
}

#define MARCH                                                                                      \
  "&simulation end_time = '400 us' step_safety = %g /\n"                                           \
  "&output frames = 0 sample = '4 us' losses = .true. /\n" HELD

/* Largest imbalance over the energy stored at last. */
static double gap_of(const body_case *b, double safety, double *left) {
  char more[2000];
  deck_case c;
  snprintf(more, sizeof more, MARCH, safety);
  run_case(&c, b, b->temperature, more);
  const double rest = deck_case_last(&c, "energy/rest"),
               stored = deck_case_last(&c, "energy/stored"),
               kept = stored + deck_case_last(&c, "energy/kinetic"),
               taken = deck_case_last(&c, "energy/dissipated_damage"),
               gap = deck_case_largest(&c, "energy/imbalance") / stored;
  assert_true(rest > 0 && deck_case_last(&c, "energy/external") == 0);
  *left = (rest - kept - taken) / stored;
  if (!strstr(b->what, "yield")) assert_true(fabs(taken) < 1e-12 * stored);
  deck_case_close(&c);
  return gap;
}

static void what_is_held_and_heated_balances(void **state) {
  (void)state;
  const body_case *const all[] = {by_fields, by_states};
  const int counts[] = {COUNT(by_fields), COUNT(by_states)};
  for (int kind = 0; kind < 2; kind++)
    for (int k = 0; k < counts[kind]; k++) {
      double left;
      const double coarse = gap_of(&all[kind][k], 0.8, &left),
                   fine = gap_of(&all[kind][k], 0.4, &left);
      print_message("%s: imbalance %.2e of what is stored, with half of the step %.2e\n",
                    all[kind][k].what, coarse, fine);
      assert_true(coarse < 2e-3 && (fine < 1e-11 || coarse / fine > 3.7));
      assert_true(fabs(left) < 2e-3);
    }
}

static void points_balance_to_rounding(void **state) {
  (void)state;
  for (int k = 0; k < COUNT(of_points); k++) {
    double left;
    const double gap = gap_of(&of_points[k], 0.8, &left);
    print_message("%s: imbalance %.2e of what is stored\n", of_points[k].what, gap);
    assert_true(gap < 1e-13);
  }
}

/* Heated evenly and slowly: what moves is the inertia of growth alone. */
static void a_free_body_gets_next_to_nothing(void **state) {
  (void)state;
  static const char free_text[] = "&simulation end_time = '4 ms' /\n"
                                  "&output frames = 0 losses = .true. /\n";
  char held[2000];
  snprintf(held, sizeof held, "%s" HELD, free_text);
  const body_case *const all[] = {&by_fields[0], &by_fields[2], &of_points[0]};
  for (int k = 0; k < 3; k++) {
    double given[2];
    for (int is_held = 0; is_held < 2; is_held++) {
      deck_case c;
      run_case(&c, all[k], "293 [K] + 100 [K]*(1 - cos(t*785.398 [1/s]))/2",
               is_held ? held : free_text);
      given[is_held] = deck_case_last(&c, "energy/rest");
      deck_case_close(&c);
    }
    print_message("%s: %.3g J free, %.3g J held\n", all[k]->what, given[0], given[1]);
    assert_true(fabs(given[0]) < 1e-3 * given[1] && given[1] > 1);
  }
}

/* Up and down in increments, at rest after each: what is given at last went into damping. */
static void a_closed_way_gives_nothing(void **state) {
  (void)state;
  const body_case *const all[] = {&by_fields[0], &of_points[0]};
  for (int k = 0; k < 2; k++) {
    double given[2], most = 0;
    for (int finer = 0; finer < 2; finer++) {
      char more[2000];
      deck_case c;
      snprintf(more, sizeof more,
               "&simulation end_time = 1 /\n&relaxation increments = %d tolerance = 1e-7 /\n"
               "&output frames = 0 /\n" HELD,
               finer ? 40 : 10);
      run_case(&c, all[k], "293 [K] + 100 [K]*sin(t*3.14159265358979 [1/s])", more);
      given[finer] = deck_case_last(&c, "energy/rest");
      most = deck_case_largest(&c, "energy/rest");
      assert_true(fabs(given[finer] - deck_case_last(&c, "energy/dissipated_damping")) <
                  1e-6 * most);
      assert_true(deck_case_largest(&c, "energy/imbalance") < 1e-6 * most);
      assert_true(fabs(deck_case_last(&c, "energy/stored")) < 1e-9 * most);
      deck_case_close(&c);
    }
    print_message("%s: %.2e of the most, in four times as many increments %.2e\n", all[k]->what,
                  given[0] / most, given[1] / most);
    assert_true(given[0] > 0 && given[0] < 0.1 * most && given[0] / given[1] > 3);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_held_and_heated_balances),
      cmocka_unit_test(points_balance_to_rounding),
      cmocka_unit_test(a_free_body_gets_next_to_nothing),
      cmocka_unit_test(a_closed_way_gives_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
