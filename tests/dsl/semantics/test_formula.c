/* Formulas: values, what they read, and what is said of those that are wrong, at the place where
   they stand in a longer text. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/formula.h"

static const formula_variable variables[] = {{"x", "m"}, {"y", "m"}, {"t", "s"}};
static const formula_scope scope = {variables, 3, "x, y (m), t (s)"};

typedef struct reading {
  arena *memory;
  source_set sources;
  diagnostics said;
  const formula *f;
} reading;

enum { BEFORE = 8 }; /* characters of the line before the formula */

static void read_formula(reading *r, const char *text, const char *of) {
  *r = (reading){.memory = arena_new()};
  diag_begin(&r->said, &r->sources);
  const char *line = arena_printf(r->memory, "value = %s /", text);
  const int file = source_add(&r->sources, "deck.nml", line, strlen(line));
  const span where = {BEFORE, BEFORE + (uint32_t)strlen(text), (uint16_t)file};
  r->f = formula_read(r->memory, &r->sources, where, &scope, of, "`value`", &r->said);
  if ((r->f != NULL) != (r->said.errors == 0)) fail_msg("%s: %d errors", text, r->said.errors);
}

static void forget(reading *r) {
  diag_clear(&r->said);
  source_clear(&r->sources);
  arena_free(r->memory);
}

static void values_are_in_si(void **state) {
  (void)state;
  static const struct {
    const char *text, *of;
    double value; /* at x = 0.2 m, y = -3 m, t = 0.5 s */
    unsigned reads;
  } cases[] = {
      {"3 [mm/s]", "m/s", 3e-3, 0},
      {"0", "Pa", 0, 0},
      {"x", "m", 0.2, 1},
      {"30 [GPa]*(1 + x/1 [m])", "Pa", 36e9, 1},
      {"-y*sin(2*3.141592653589793*t/2 [s])/1 [m]", "1", 3, 6},
      {"sin(pi/6) + acos(-1)/pi + log10(1000) - cosh(0)*asin(0)", "1", 4.5, 0},
      {"x**2/y - t*1 [m/s]", "m", -0.04 / 3 - 0.5, 7},
      {"| 1 [N] when x < 10 [cm] | 2 [N] when x < 30 [cm] and y < 0 | 3 [N] otherwise", "N", 2, 3},
      {"state + x", NULL, 0, 0}, /* a word that begins lines of laws is a name like others */
      {"max((| x when y > 0 | -y otherwise), 1 [m])", "m", 3, 3},
      {"x/t*1d2", "m/s", 40, 5},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    reading r;
    read_formula(&r, cases[k].text, cases[k].of);
    if (!cases[k].of) {
      assert_null(r.f);
      assert_string_equal(r.said.items[0].message, "there is no quantity `state`");
      forget(&r);
      continue;
    }
    if (!r.f) diag_print(&r.said, stderr);
    assert_non_null(r.f);
    const double got = formula_value(r.f, (double[]){0.2, -3, 0.5});
    if (!(fabs(got - cases[k].value) <= 1e-15 * fabs(cases[k].value)))
      fail_msg("%s: %.17g", cases[k].text, got);
    for (int v = 0; v < 3; v++)
      assert_int_equal(formula_reads(r.f, v), cases[k].reads >> v & 1);
    forget(&r);
  }
}

static void a_formula_of_any_unit_says_which(void **state) {
  (void)state;
  reading r;
  read_formula(&r, "x/t**2", NULL);
  assert_true(dim_equal(formula_dimension(r.f), dimension_of("m/s^2")));
  assert_false(formula_is_zero(r.f));
  forget(&r);
  read_formula(&r, "0", NULL);
  assert_true(formula_is_zero(r.f));
  forget(&r);
}

/* `^` marks where the message points. */
static void what_is_wrong_is_said_where_it_stands(void **state) {
  (void)state;
  static const struct {
    const char *text, *mark, *code, *message, *hint;
  } cases[] = {
      {"2*z", "  ^", "unknown-name", "there is no quantity `z`", "a formula knows x, y (m), t (s)"},
      {"x + t", "^^^^^", "units",
       "`x` is a length (m) but `t` is a time (s), so they cannot be added", NULL},
      {"x*y", "^^^", "units", "`value` must be a length (m), but this is an area (m^2)", NULL},
      {"3", "^", "units", "`value` must be a length (m), but this is a pure number",
       "give the number its unit: `3 [m]`"},
      {"x*(1 + x/200)", "  ^^^^^^^^^^^", "units",
       "`1` is a pure number but `x/200` is a length (m), so they cannot be added",
       "give `200` its unit, such as `200 [mm]`"},
      {"x*ph", "  ^^", "unknown-name", "there is no quantity `ph`",
       "a formula knows x, y (m), t (s)"},
      {"x*sum(y)", "  ^^^", "unknown-function", "`sum` is for laws, a formula does not have it",
       NULL},
      {"x[j]", "^^^^", "placement", "a formula has no neighbours to take `x` from", "write `x`"},
      {"min(x)", "^^^^^^", "arguments", "`min` needs two values or more", NULL},
      {"x*(1 + 2", "  ^", "unterminated", "this `(` is not closed", NULL},
      {"x*", " ^", "syntax", "the value after `*` is missing", NULL},
      {"3 mm", "  ^^", "syntax", "a unit stands in square brackets", "write 3 [mm]"},
      {"x = 3", "  ^", "syntax", "`=` gives a name its value; it does not compare",
       "equality is written `==`"},
      {"| x when y > 0 [m]", "^^^^^^^^^^^^^^^^^^", "cases",
       "these cases do not end with `otherwise`", "add a last line: `| value otherwise`"},
      {"x > y", "^^^^^", "shape", "`x > y` is true or false, not a number",
       "choose numbers with cases: | 1 when ... | 0 otherwise"},
      {"x, y", " ^", "syntax", "`,` cannot stand here; expected the end of the line", NULL},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    reading r;
    read_formula(&r, cases[k].text, "m");
    assert_null(r.f);
    const diagnostic *m = &r.said.items[0];
    const uint32_t begin = BEFORE + (uint32_t)strspn(cases[k].mark, " "),
                   end = BEFORE + (uint32_t)strlen(cases[k].mark);
    if (strcmp(m->message, cases[k].message) || strcmp(diag_name(m->code), cases[k].code) ||
        m->where.begin != begin || m->where.end != end || r.said.count != 1 ||
        strcmp(m->hint ? m->hint : "", cases[k].hint ? cases[k].hint : "")) {
      diag_print(&r.said, stderr);
      fail_msg("%s: other message", cases[k].text);
    }
    forget(&r);
  }
}

static void a_formula_has_its_limits(void **state) {
  (void)state;
  enum { TERMS = 2000 };
  char *text = calloc(TERMS, 4);
  for (int k = 0; k < 300; k++)
    strcat(text, k ? "+x" : "x");
  reading r;
  read_formula(&r, text, "m");
  assert_null(r.f);
  assert_non_null(strstr(r.said.items[0].message, "operations")
                      ? r.said.items[0].message
                      : strstr(r.said.items[0].message, "nest"));
  forget(&r);
  free(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(values_are_in_si),
                                     cmocka_unit_test(a_formula_of_any_unit_says_which),
                                     cmocka_unit_test(what_is_wrong_is_said_where_it_stands),
                                     cmocka_unit_test(a_formula_has_its_limits)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
