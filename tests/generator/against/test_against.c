/* A law beside a reference: laws whose difference is known in closed form, and the words for it. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdbool.h>

#include "generator/against/difference_words.h"
#include "generator/against/table_difference.h"
#include "tests/generator/command_tools.h"

/* --- laws ------------------------------------------------------------------------------------- */

/* A bond that softens, with the numbers and the branches that tests change. */
typedef struct variant {
  const char *stiffness, *end, *before, *closed, *opened, *after;
} variant;

static const variant right = {.stiffness = "sqrt(3)/2*E*s*t",
                              .end = "S_u",
                              .before = "  kappa = max(kappa, stretch)\n",
                              .closed = "EA*stretch",
                              .opened = "(1 - omega)*EA*stretch",
                              .after = ""};

static void write_law(workplace *w, const char *name, const variant *v) {
  char text[2000];
  snprintf(text, sizeof text,
           "model answer\n  law central bond\n"
           "  parameter E = 30 [GPa] in (0, inf)\n  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
           "  parameter S_t = 1e-4 in (0, inf)\n  parameter S_u = 2e-3 in (0, inf)\n"
           "  constant EA = %s\n  state kappa on bond = 0\n%s"
           "  damage omega on bond = | 0 when kappa <= S_t\n"
           "      | 1 - S_t/kappa*(%s - kappa)/(%s - S_t) when kappa <= %s\n"
           "      | 1 otherwise\n"
           "  force N = | %s when stretch > 0\n            | %s otherwise\n%send model\n",
           v->stiffness, v->before, v->end, v->end, v->end, v->opened, v->closed, v->after);
  write_text(w, name, text);
}

static const char cycle[] = "&path quantity = 'stretch' times = 0, '1 s', '2 s', '3 s', '4 s', "
                            "'5 s'  values = 0, 6e-4, 1e-4, 1e-3, -2e-4, 0 /\n";
static const char tear[] = "&path quantity = 'stretch' times = 0, '1 s'  values = 0, 3e-3 /\n";

/* The difference that the program tells, and its status. */
static void differs(workplace *w, const variant *v, const char *path, const char *wanted) {
  write_law(w, "right.plm", &right);
  write_law(w, "answer.plm", v);
  write_text(w, "path.nml", path);
  expect(w, "drive answer.plm path.nml --against right.plm", 2, wanted);
}

static void an_equal_law_is_equal(void **state) {
  workplace *w = *state;
  variant v = right;
  v.stiffness = "E*s*t*sin(60 [deg])"; /* the same but for rounding */
  v.closed = "EA*stretch + 0*EA";
  write_law(w, "right.plm", &right);
  write_law(w, "answer.plm", &v);
  write_text(w, "path.nml", cycle);
  expect(w, "drive answer.plm path.nml --against right.plm", 0,
         "against right.plm: equal within 1e-06 in 1001 rows");
}

static void one_factor_for_all_states(void **state) {
  variant v = right;
  v.stiffness = "sqrt(3)*E*s*t";
  differs(*state, &v, cycle, "the force N is twice that of the reference in all states");
  v.stiffness = "sqrt(3)/4*E*s*t";
  differs(*state, &v, cycle, "the force N is half that of the reference in all states");
  v.stiffness = "E*s*t";
  differs(*state, &v, cycle, "the force N is 2/sqrt(3) times that of the reference");
  v.stiffness = "0.7*sqrt(3)/2*E*s*t";
  differs(*state, &v, cycle, "the force N is 0.7 times that of the reference in all states");
  v.stiffness = "0*E*s*t";
  differs(*state, &v, cycle, "the force N is 0 in all states");
}

static void a_wrong_sign(void **state) {
  variant v = right;
  v.stiffness = "-sqrt(3)/2*E*s*t";
  differs(*state, &v, cycle, "the force N has the wrong sign in all states");
}

static void one_step_late(void **state) {
  variant v = right;
  v.before = "";
  v.after = "  kappa = max(kappa, stretch)\n";
  differs(*state, &v, cycle, "the force N is one step late");
}

/* Triangle under the softening line: EA S_t S_u s/2. */
static void a_total_tells(void **state) {
  variant v = right;
  v.end = "(2*S_u)";
  char far[300];
  snprintf(far, sizeof far, "%s&simulation steps = 4000 /\n",
           "&path quantity = 'stretch' times = 0, '1 s'  values = 0, 5e-3 /\n");
  differs(*state, &v, far,
          "the largest force agrees, but the energy that it dissipates is twice that of the");
  v.end = "(S_u/2)";
  differs(*state, &v, tear, "the energy that it dissipates is half that of the reference");
}

static void one_side(void **state) {
  variant v = right;
  v.closed = "0*EA";
  differs(*state, &v, cycle, "wrong only where it is shortened: there it is 0");
  v.closed = "-EA*stretch";
  differs(*state, &v, cycle, "wrong only where it is shortened: there it has the wrong sign");
  v.closed = "2*EA*stretch";
  differs(*state, &v, cycle,
          "wrong only where it is shortened: there it is twice that of the reference");
  v.closed = "(1 - omega)*EA*stretch";
  differs(*state, &v,
          "&path quantity = 'stretch' times = 0, '1 s', '2 s', '4 s'  values = 0, -3e-4, 6e-4, "
          "-3e-4 /\n",
          "wrong only where it is shortened after it lost energy");
  v = right;
  v.opened = "(1 - omega)*EA*stretch*(1 + (kappa - stretch)/S_u)";
  differs(*state, &v, cycle, "wrong only below the largest that it has borne");
  v = right;
  v.end = "(1.3*S_u)";
  differs(*state, &v, cycle, "wrong only where it is stretched after it lost energy");
}

/* Two rows, of the first step of 3e-6. */
/* How far, and where it begins to break: at S_t, where EA S_t = 2598 N. */
static void how_far_and_from_where(void **state) {
  workplace *w = *state;
  variant v = right;
  v.end = "(1.3*S_u)";
  differs(w, &v, cycle, "after it lost energy: there it is too large by up to ");
  v.end = "(0.8*S_u)";
  differs(w, &v, cycle, "after it lost energy: there it is too small by up to ");
  v = right;
  v.opened = "(1 - 0*omega)*EA*stretch";
  differs(w, &v, cycle, "; it loses no energy, and should from N = 25");
  write_law(w, "answer.plm", &right);
  write_law(w, "right.plm", &v);
  expect(w, "drive answer.plm path.nml --against right.plm", 2, "; it loses energy from N = 25");
  v = right;
  v.before = "  kappa = max(kappa, 1.3*stretch)\n"; /* gives way too soon */
  differs(w, &v, "&path quantity = 'stretch' times = 0, '1 s', '2 s'  values = 0, 6e-4, 0 /\n",
          "; it begins to lose energy at N = 19");
}

static void the_first_state_that_differs(void **state) {
  variant v = right;
  v.opened = "(1 - omega)*EA*stretch*(1 + stretch/S_u)";
  v.closed = "EA*stretch*(1 + stretch/S_u)";
  differs(*state, &v, cycle,
          "the force N first differs at 0.005 s, stretch 3e-06: it is 78.0592, not 77.9423 N");
  differs(*state, &v, cycle, "\n  answer             0.005          3e-06");
  differs(*state, &v, cycle, "\n  reference          0.005          3e-06");
}

static void something_that_is_no_number(void **state) {
  variant v = right;
  v.opened = "(1 - omega)*EA*sqrt(S_u/2 - stretch)/sqrt(S_u/2 - stretch)*stretch";
  differs(*state, &v, tear, "is not a number at");
}

/* Where the force jumps, at a stretch that is a row of the path, the side of the jump is nothing
   to be told. */
static void a_row_at_a_jump_is_left_out(void **state) {
  workplace *w = *state;
  variant a = right, b = right;
  a.opened = "(1 - omega)*EA*stretch*(| 1 when stretch < 5e-4\n | 0.25 otherwise)";
  b.opened = "(1 - omega)*EA*stretch*(| 1 when stretch <= 5e-4\n | 0.25 otherwise)";
  write_law(w, "right.plm", &a);
  write_law(w, "answer.plm", &b);
  write_text(w, "path.nml",
             "&path quantity = 'stretch' times = 0, '1 s', '2 s' values = 0, 5e-4, 1e-3 /\n");
  expect(w, "drive answer.plm path.nml --against right.plm", 0, "equal within 1e-06 in 1000 rows");
  expect(w, "drive answer.plm path.nml --against right.plm", 0, "1 of 1001 rows are left out");
}

static void others_read_it(void **state) {
  workplace *w = *state;
  variant v = right;
  v.stiffness = "sqrt(3)*E*s*t";
  differs(w, &v, cycle, "twice");
  assert_int_equal(shell(w, "$P drive answer.plm path.nml --against right.plm --json --picture "
                            "both.svg 2>/dev/null"),
                   2);
  assert_non_null(strstr(w->said, "\"equal\": false,"));
  assert_non_null(strstr(w->said, "\"difference\": \"ratio\",\n    \"of\": \"N\",\n"));
  assert_true(exists(w, "both.svg"));
  expect(w, "drive answer.plm path.nml --against missing.plm", 1, "missing.plm");
  expect(w, "drive answer.plm path.nml --against path.nml", 1, "--against");
  expect(w, "drive answer.plm path.nml --against right.plm --tolerance x", 1, "--tolerance takes");
  expect(w, "drive answer.plm path.nml --against right.plm --tolerance 2", 0, "equal within 2");
  expect(w, "drive answer.plm path.nml --against right.plm --picture right.plm", 1,
         "would overwrite");
}

/* --- other laws ------------------------------------------------------------------------------- */

static void moments_points_and_families(void **state) {
  workplace *w = *state;
  write_text(w, "bend.nml",
             "&path quantity = 'theta_i' value = 1e-4 rise = '1 s' /\n"
             "&path quantity = 'stretch' value = 1e-5 rise = '1 s' /\n");
  assert_int_equal(shell(w, "sed 's/nu *= *0[.0-9]*/nu = 0.1/' " SOURCE_DIR
                            "/models/elastic_micropolar.plm > other.plm"),
                   0);
  expect(w, "drive other.plm bend.nml --against elastic_micropolar.plm", 2, "against ");
  write_text(w, "point.nml",
             "&path quantity = 'strain_xx' value = 1e-4 rise = '1 s' /\n"
             "&point test = 'uniaxial stress' /\n");
  assert_int_equal(shell(w, "sed 's/31.37/7/' " SOURCE_DIR "/models/elastic.plm > "
                            "soft.plm; $P drive soft.plm point.nml --against elastic.plm"),
                   2);
  assert_non_null(strstr(w->said, "stress_xx is "));
  assert_non_null(strstr(w->said, "in all states"));
  write_text(w, "family.nml", "&path quantity = 'strain_xx' value = 1e-5 rise = '1 s' /\n");
  expect(w, "drive splm_elastic.plm family.nml --against splm_elastic.plm", 0, "equal");
  expect(w, "drive elastic.plm family.nml --against splm_elastic.plm", 1,
         "laws of different things");
}

/* --- words of numbers ------------------------------------------------------------------------- */

static void ratios_have_names(void **state) {
  (void)state;
  assert_string_equal(ratio_words(2), "twice");
  assert_string_equal(ratio_words(0.5), "half");
  assert_string_equal(ratio_words(sqrt(3) / 2), "sqrt(3)/2 times");
  assert_string_equal(ratio_words(log(10)), "ln(10) times");
  assert_string_equal(ratio_words(0), "0 instead of");
  assert_null(ratio_words(1));
  assert_null(ratio_words(2.01));
  assert_string_equal(column_words("N"), "the force N");
  assert_string_equal(column_words("mine"), "mine");
}

/* A column that is all rounding beside another one of its kind tells nothing. */
static void rounding_is_no_difference(void **state) {
  (void)state;
  double time[3] = {0, 1, 2}, x[3] = {0, 1, 2}, a[3] = {0, 5, 9}, noise[3] = {0, 1e-15, 0},
         none[3] = {0, 0, 0};
  drive_column answer[] = {{"time", "s", time},
                           {"strain_xx", "1", x},
                           {"stress_xx", "Pa", a},
                           {"stress_xy", "Pa", noise}};
  drive_column reference[] = {{"time", "s", time},
                              {"strain_xx", "1", x},
                              {"stress_xx", "Pa", a},
                              {"stress_xy", "Pa", none}};
  drive_table t = {.of = DRIVE_OF_POINTS,
                   .way = 1,
                   .force = 2,
                   .law_column = 4,
                   .columns = answer,
                   .column_count = 4,
                   .rows = 3,
                   .bad_row = -1},
              r = t;
  r.columns = reference;
  table_difference d;
  table_difference_find(&d, &t, &r, 1e-6, NULL, true);
  assert_int_equal(d.kind, DIFFERENCE_NONE);
  table_difference_free(&d);
  noise[1] = 1e-2;
  table_difference_find(&d, &t, &r, 1e-6, NULL, true);
  assert_int_not_equal(d.kind, DIFFERENCE_NONE);
  assert_string_equal(d.columns[d.of].name, "stress_xy");
  assert_int_equal(d.row, 1);
  table_difference_free(&d);
}

/* Words of two tables of a particle that is sheared to and fro: strain_xy, stress_xx of the second
   order, stress_xy. */
typedef struct sheared {
  double time[9], none[9], shear[9], small[9], large[9];
} sheared;

enum { SHEARED_ROWS = 9 };

static void shear(sheared *s, double small, double large, int late) {
  for (int k = 0; k < SHEARED_ROWS; k++) {
    const double at = 1e-3 * sin(0.7 * k), before = 1e-3 * sin(0.7 * (k - late));
    s->time[k] = k;
    s->none[k] = 0;
    s->shear[k] = at;
    s->small[k] = small * at * at;
    s->large[k] = large * before;
  }
}

static drive_table table_of(sheared *s, drive_column columns[5]) {
  const drive_column all[] = {{"time", "s", s->time},
                              {"strain_xx", "1", s->none},
                              {"strain_xy", "1", s->shear},
                              {"stress_xx", "Pa", s->small},
                              {"stress_xy", "Pa", s->large}};
  memcpy(columns, all, sizeof all);
  return (drive_table){.of = DRIVE_OF_FAMILIES,
                       .way = 1,
                       .force = 3,
                       .law_column = 5,
                       .columns = columns,
                       .column_count = 5,
                       .rows = SHEARED_ROWS,
                       .bad_row = -1};
}

static void said_of(sheared *answer, sheared *first, const char *wanted) {
  drive_column columns[2][5];
  const drive_table a = table_of(answer, columns[0]), r = table_of(first, columns[1]);
  table_difference d;
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  table_difference_find(&d, &a, &r, 1e-6, NULL, true);
  difference_say(&d, &a, "right", out);
  must_close_text(out);
  if (!strstr(text, wanted)) fail_msg("there is no `%s` in `%s`", wanted, text);
  table_difference_free(&d);
  free(text);
}

/* Stresses have one scale, and words are of what is large; a strain that is at rest is not what is
   driven. */
static void what_is_small_of_its_kind_says_little(void **state) {
  (void)state;
  sheared first, answer;
  shear(&first, 3e9, 1e10, 0);
  shear(&answer, 2e9, 2e10, 0);
  said_of(&answer, &first, "stress_xy is twice right in all states");
  shear(&answer, 2e9, 1.01e10, 0);
  said_of(&answer, &first, "stress_xy is 1.01 times right in all states");
  shear(&answer, 2e9, 1e10, 0);
  said_of(&answer, &first,
          "stress_xx, which is small beside the largest of its kind, first differs at 1 s, "
          "strain_xy 0.000644218");
  shear(&answer, 3e9 + 1, 1e10, 0); /* 1e-6 Pa beside 1e7 Pa */
  said_of(&answer, &first, "equal within");
  shear(&answer, 3e9, 1e10, 1);
  said_of(&answer, &first, "stress_xy is one step late");
}

/* sqrt(3)/2 = 0.866025. */
static void rounded_constants_are_told(void **state) {
  variant v = right;
  v.stiffness = "0.866*E*s*t";
  differs(*state, &v, cycle,
          "the force N is off by 0.0029 % in all states: is a constant rounded? write sqrt(2)/3");
  v.stiffness = "0.87*E*s*t";
  differs(*state, &v, cycle, "the force N is off by 0.46 % in all states: is a constant");
  v.stiffness = "sqrt(3)/2*E*s*t*8/9";
  differs(*state, &v, cycle, "the force N is 8/9 times that of the reference in all states");
  v.stiffness = "0.88*E*s*t";
  differs(*state, &v, cycle, "the force N is 1.016 times that of the reference in all states");
}

typedef void ratio_teller(double ratio, const char *should, FILE *out);

static void said_by(ratio_teller *tell, double ratio, const char *wanted) {
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  tell(ratio, "right", out);
  must_close_text(out);
  assert_string_equal(text, wanted);
  free(text);
}

static void said_ratio(double ratio, const char *wanted) {
  said_by(ratio_say, ratio, wanted);
}

static void said_plainly(double ratio, const char *wanted) {
  said_by(plain_ratio_say, ratio, wanted);
}

/* A root would be the formula that is asked for. */
static void students_read_no_roots(void **state) {
  (void)state;
  said_plainly(2, "twice right");
  said_plainly(-3. / 4, "minus 3/4 times right");
  said_plainly(2 / sqrt(3), "1.155 times right");
  said_plainly(-sqrt(3) / 2, "minus 0.866 times right");
  said_plainly(2 / (3 * sqrt(3)), "0.3849 times right");
  said_plainly(log(10), "2.303 times right");
  said_plainly(3.14159265358979323846 / 4, "0.7854 times right");
  said_plainly(0, "0");
}

static void is_formula(double ratio, const char *wanted) {
  char text[64] = "none";
  assert_int_equal(ratio_formula(ratio, text, sizeof text), strcmp(wanted, "none") != 0);
  assert_string_equal(text, wanted);
}

static void ratios_are_told_as_fractions(void **state) {
  (void)state;
  is_formula(3. / 4, "3/4");
  is_formula(8. / 15, "8/15");
  is_formula(2 / (3 * sqrt(3)), "2/(3 sqrt(3))");
  is_formula(sqrt(3) / 4, "sqrt(3)/4");
  is_formula(5 * sqrt(2) / 3, "5 sqrt(2)/3");
  is_formula(1 / (2 * sqrt(2)), "1/(2 sqrt(2))");
  is_formula(3.14159265358979323846 / 4, "pi/4");
  is_formula(2 / 3.14159265358979323846, "2/pi");
  is_formula(3.14159265358979323846 * sqrt(3) / 6, "pi sqrt(3)/6");
  is_formula(1 / sqrt(3.14159265358979323846), "1/sqrt(pi)");
  is_formula(0.7, "none");
  is_formula(3. / 4 * (1 + 2e-5), "none");
  is_formula(0.123456, "none");
  is_formula(0, "none");
  is_formula(INFINITY, "none");
}

static void ratios_have_their_sign(void **state) {
  (void)state;
  said_ratio(2, "twice right");
  said_ratio(-2, "minus twice right");
  said_ratio(-0.0, "0");
  said_ratio(-1e-12, "0");
  said_ratio(0.7, "0.7 times right");
  said_ratio(1 - 3e-5, "off by 0.003 %");
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {TEST(an_equal_law_is_equal),
                                     TEST(one_factor_for_all_states),
                                     TEST(a_wrong_sign),
                                     TEST(one_step_late),
                                     TEST(a_total_tells),
                                     TEST(one_side),
                                     TEST(how_far_and_from_where),
                                     TEST(the_first_state_that_differs),
                                     TEST(something_that_is_no_number),
                                     TEST(a_row_at_a_jump_is_left_out),
                                     TEST(others_read_it),
                                     TEST(moments_points_and_families),
                                     cmocka_unit_test(ratios_have_names),
                                     cmocka_unit_test(rounding_is_no_difference),
                                     TEST(rounded_constants_are_told),
                                     cmocka_unit_test(what_is_small_of_its_kind_says_little),
                                     cmocka_unit_test(ratios_are_told_as_fractions),
                                     cmocka_unit_test(students_read_no_roots),
                                     cmocka_unit_test(ratios_have_their_sign)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
