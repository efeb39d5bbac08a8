/* Formulas as MathML: what browsers are given for what laws are explained in. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/print/mathml.h"
#include "dsl/semantics/builtins.h"

/* Without the frame; malloc'ed. */
static char *mathml_of(const char *latex) {
  static const char open[] = "<math><mrow>", close[] = "</mrow></math>";
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  mathml_put(latex, strlen(latex), false, out);
  fclose(out);
  assert_memory_equal(text, open, strlen(open));
  assert_string_equal(text + length - strlen(close), close);
  text[length - strlen(close)] = 0;
  memmove(text, text + strlen(open), strlen(text + strlen(open)) + 1);
  return text;
}

static void pieces_are_as_mathml_has_them(void **state) {
  (void)state;
  static const char *const rows[][2] = {
      {"x", "<mi>x</mi>"},
      {"12.5", "<mn>12.5</mn>"},
      {"a + b", "<mi>a</mi><mo>+</mo><mi>b</mi>"},
      {"-\\omega", "<mo>−</mo><mi>ω</mi>"},
      {"a < b", "<mi>a</mi><mo>&lt;</mo><mi>b</mi>"},
      {"S_{t}", "<msub><mi>S</mi><mrow><mi>t</mi></mrow></msub>"},
      {"x^2", "<msup><mi>x</mi><mn>2</mn></msup>"},
      {"\\omega^{(n-1)}", "<msup><mi>ω</mi><mrow><mo>(</mo><mi>n</mi><mo>−</mo><mn>1</mn><mo>)</mo>"
                          "</mrow></msup>"},
      {"x_{i}^{2}", "<msubsup><mi>x</mi><mrow><mi>i</mi></mrow><mrow><mn>2</mn></mrow></msubsup>"},
      {"\\frac{a}{b}", "<mfrac><mrow><mi>a</mi></mrow><mrow><mi>b</mi></mrow></mfrac>"},
      {"\\log_{10} a", "<msub><mi>log</mi><mrow><mn>10</mn></mrow></msub><mi>a</mi>"},
      {"\\arccos x", "<mi>arccos</mi><mi>x</mi>"},
      {"a \\cdot {e}_{x}",
       "<mi>a</mi><mo>·</mo><msub><mrow><mi>e</mi></mrow><mrow><mi>x</mi></mrow>"
       "</msub>"},
      {"\\sqrt{a}", "<msqrt><mrow><mi>a</mi></mrow></msqrt>"},
      {"\\sqrt[3]{a}", "<mroot><mrow><mi>a</mi></mrow><mn>3</mn></mroot>"},
      {"\\left|x\\right|", "<mrow><mo fence=\"true\" stretchy=\"true\">|</mo><mi>x</mi><mo "
                           "fence=\"true\" stretchy=\"true\">|</mo></mrow>"},
      {"\\mathrm{soft\\_sign}", "<mi mathvariant=\"normal\">soft_sign</mi>"},
      {"\\text{when }a", "<mtext>when\xC2\xA0</mtext><mi>a</mi>"},
      {"\\begin{cases} a & \\text{when } b \\\\ c & \\text{otherwise} \\end{cases}",
       "<mtable class=\"cases\" displaystyle=\"true\"><mtr><mtd><mi>a</mi></mtd><mtd><mtext>when"
       "\xC2\xA0</mtext><mi>b</mi></mtd></mtr><mtr><mtd><mi>c</mi></mtd><mtd><mtext>otherwise</"
       "mtext>"
       "</mtd></mtr></mtable>"},
  };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    char *text = mathml_of(rows[k][0]);
    assert_string_equal(text, rows[k][1]);
    free(text);
  }
}

/* Every tag that opens closes, in order; nothing of LaTeX is left over. */
static void is_whole(const char *latex) {
  enum { DEEPEST = 100 };
  char *text = mathml_of(latex), stack[DEEPEST][20];
  int depth = 0;
  for (char *at = strchr(text, '<'); at; at = strchr(at, '<')) {
    const bool closes = at[1] == '/';
    const size_t length = strcspn(at + 1 + closes, " >");
    char *name = strndup(at + 1 + closes, length);
    if (closes) {
      assert_true(depth > 0);
      assert_string_equal(stack[--depth], name);
    } else {
      assert_true(depth < DEEPEST);
      snprintf(stack[depth++], sizeof *stack, "%s", name);
    }
    free(name);
    at++;
  }
  assert_int_equal(depth, 0);
  assert_null(strchr(text, '\\'));
  free(text);
}

static void functions_are_whole(void **state) {
  (void)state;
  for (int f = 0; f < FUNCTION_COUNT; f++) {
    char latex[200];
    const char *formula = builtin_functions[f].formula;
    const size_t before = strcspn(formula, "#");
    snprintf(latex, sizeof latex, "%.*s%s%s", (int)before, formula, formula[before] ? "x" : "",
             formula[before] ? formula + before + 1 : "\\left(x\\right)");
    is_whole(latex);
  }
}

/* What is no formula still ends. */
static void ends_on_anything(void **state) {
  (void)state;
  static const char *const rows[] = {"",
                                     "{",
                                     "}",
                                     "\\",
                                     "x^",
                                     "\\frac{a",
                                     "\\left",
                                     "\\sqrt",
                                     "a_{b^{",
                                     "\\text{a",
                                     "&&&",
                                     "\\nothing{<b>}",
                                     "\\begin{cases} a & b \\\\"};
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    char *text = mathml_of(rows[k]);
    assert_null(strstr(text, "<b>"));
    free(text);
  }
  enum { LONG = 100000 };
  char *deep = malloc(LONG + 1);
  memset(deep, '{', LONG);
  deep[LONG] = 0;
  free(mathml_of(deep));
  free(deep);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pieces_are_as_mathml_has_them),
      cmocka_unit_test(functions_are_whole),
      cmocka_unit_test(ends_on_anything),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
