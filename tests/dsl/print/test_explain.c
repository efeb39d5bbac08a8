/* Laws read back as equations: letters, step indices and fractions against formulas written by
   hand, whole documents against golden files, and, where there is pdflatex, by it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/print/explain.h"
#include "dsl/print/explain_math.h"
#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"
#include "tests/dsl/text_files.h"

typedef struct reading {
  source_set sources;
  diagnostics d;
  arena *memory;
  law *law;
} reading;

static void read_law(reading *r, const char *text) {
  *r = (reading){.memory = arena_new()};
  diag_begin(&r->d, &r->sources);
  int file = source_add(&r->sources, "law.plm", text, strlen(text));
  const parse_options options = {NULL, NULL};
  tree *t = parse_model(r->memory, &r->sources, file, &options, &r->d);
  if (t && r->d.errors == 0) r->law = law_check(r->memory, t, &r->sources, NULL, 0, &r->d);
  if (!r->law) diag_print(&r->d, stderr);
  assert_non_null(r->law);
}

static void end(reading *r) {
  diag_clear(&r->d);
  source_clear(&r->sources);
  arena_free(r->memory);
}

static char *explained(const law *l, explain_form form) {
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  explain_law(l, form, NULL, 0, out);
  fclose(out);
  return text;
}

/* The law's lines, between a head that declares what they use and a force; every part must be found
   in what is made of them. */
static void assert_reads(const char *lines, const char *part) {
  char text[4096];
  snprintf(text, sizeof text,
           "model m\n  law micropolar bond\n  parameter a = 2\n  parameter b_t = 3\n  parameter "
           "alpha1 = 1\n"
           "  parameter EA = 2 [MN]\n  parameter x_ = 1\n  parameter beta_1 = 1\n  parameter beta1 "
           "= 1\n%s\n"
           "  force N = EA*stretch\n  force V = EA*theta_i\nend model\n",
           lines);
  reading r;
  read_law(&r, text);
  char *found = explained(r.law, EXPLAIN_MARKDOWN);
  if (!strstr(found, part)) fail_msg("%s\nis not read as\n%s\nbut\n%s", lines, part, found);
  free(found);
  end(&r);
}

static void expressions_read_as_formulas(void **state) {
  (void)state;
  static const struct {
    const char *line, *formula;
  } pairs[] = {
      {"y = a*b_t/alpha1", "$$y = \\frac{a\\,b_{t}}{\\alpha_{1}}$$"},
      {"y = a/b_t*stretch/s", "$$y = \\frac{a}{b_{t}}\\,\\frac{\\mathit{stretch}}{s}$$"},
      {"y = a/b_t/stretch", "$$y = \\frac{a}{b_{t}\\,\\mathit{stretch}}$$"},
      {"y = a/(b_t/stretch)", "$$y = \\frac{a}{\\frac{b_{t}}{\\mathit{stretch}}}$$"},
      {"y = a*(b_t*stretch)", "$$y = a\\,\\left(b_{t}\\,\\mathit{stretch}\\right)$$"},
      {"y = a/b_t*(a + 1)", "$$y = \\frac{a}{b_{t}}\\,\\left(a + 1\\right)$$"},
      {"y = (a + 1)*(a - 1)", "$$y = \\left(a + 1\\right)\\,\\left(a - 1\\right)$$"},
      {"y = (a + 1)/(a - 1)", "$$y = \\frac{a + 1}{a - 1}$$"},
      {"y = a - (b_t - 1)", "$$y = a - \\left(b_{t} - 1\\right)$$"},
      {"y = a - b_t - 1", "$$y = a - b_{t} - 1$$"},
      {"y = a - (-b_t)", "$$y = a - \\left(-b_{t}\\right)$$"},
      {"y = -a*b_t", "$$y = -a\\,b_{t}$$"},
      {"y = -(a + b_t)", "$$y = -\\left(a + b_{t}\\right)$$"},
      {"y = 2*3*a", "$$y = 2\\cdot 3\\,a$$"},
      {"y = a**2*(a + 1)**(1/2)", "$$y = {a}^{2}\\,{\\left(a + 1\\right)}^{\\frac{1}{2}}$$"},
      {"y = (a**2)**3", "$$y = {\\left({a}^{2}\\right)}^{3}$$"},
      {"y = 1.18e-4*a + 2e7", "$$y = 1.18\\cdot 10^{-4}\\,a + 2\\cdot 10^{7}$$"},
      {"y = 30 [GPa]*a", "$$y = 30\\,\\mathrm{GPa}\\,a$$"},
      {"y = stretch_rate/10 [1/s]",
       "$$y = \\frac{\\mathit{stretch}_{\\mathrm{rate}}}{10/\\mathrm{s}}$$"},
      {"y = sqrt(abs(a)) + cbrt(a)", "$$y = \\sqrt{\\left|a\\right|} + \\sqrt[3]{a}$$"},
      {"y = positive_part(a)**2", "$$y = {\\left\\langle a\\right\\rangle}^{2}$$"},
      {"y = max(a, log(b_t))", "$$y = \\max\\left(a,\\, \\ln\\left(b_{t}\\right)\\right)$$"},
      {"y = diff(stretch**2, stretch)",
       "$$y = \\frac{\\partial}{\\partial "
       "\\mathit{stretch}}\\left({\\mathit{stretch}}^{2}\\right)$$"},
      {"y = theta_i : theta_j", "$$y = \\theta_{i} : \\theta_{j}$$"},
      {"y = | a when a /= b_t and not a >= 1 | 0 otherwise",
       "$$y = \\begin{cases} a & \\text{when } a \\ne b_{t} \\;\\text{and}\\; \\text{not }\\left(a "
       "\\ge 1\\right) \\\\ "
       "0 & \\text{otherwise} \\end{cases}$$"},
      {"eps_mp = x_ + beta1 + beta_1",
       "$$\\varepsilon_{\\mathrm{mp}} = \\mathrm{x\\_} + \\mathrm{beta1} + \\mathrm{beta\\_1}$$"},
      {"y = dot(direction, (1, 2*a))**2",
       "$$y = {\\left(\\mathit{direction} \\cdot \\left(1,\\, 2\\,a\\right)\\right)}^{2}$$"},
      {"y = norm(cross(direction, (0, 0, 1))) + direction[y]",
       "$$y = \\left\\lVert \\mathit{direction} \\times \\left(0,\\, 0,\\, "
       "1\\right)\\right\\rVert + {\\mathit{direction}}_{y}$$"},
      {"y = acos(sin(pi*a)) + log10(cosh(a))",
       "$$y = \\arccos\\left(\\sin\\left(\\pi\\,a\\right)\\right) + "
       "\\log_{10}\\left(\\cosh\\left(a\\right)\\right)$$"},
      {"function f(p, q_el) = p**q_el",
       "$$f\\left(p,\\, q_{\\mathrm{el}}\\right) = {p}^{q_{\\mathrm{el}}}$$"},
  };
  for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
    assert_reads(pairs[i].line, pairs[i].formula);
}

static void steps_are_marked(void **state) {
  (void)state;
  assert_reads("state q = 0\ny = q + 1\nq = max(q, stretch)*y\nz = q**2 - previous(q)",
               "$$y = q^{(n-1)} + 1$$");
  assert_reads("state q = 0\ny = q + 1\nq = max(q, stretch)*y\nz = q**2 - previous(q)",
               "$$q^{(n)} = \\max\\left(q^{(n-1)},\\, \\mathit{stretch}\\right)\\,y$$");
  assert_reads("state q = 0\ny = q + 1\nq = max(q, stretch)*y\nz = q**2 - previous(q)",
               "$$z = {\\left(q^{(n)}\\right)}^{2} - q^{(n-1)}$$");
  assert_reads("state q = 0\nflow q by stretch when stretch > q",
               "$$q^{(n)} = q^{(n-1)} + \\begin{cases} \\mathit{stretch} & \\text{when } "
               "\\mathit{stretch} > q^{(n-1)} "
               "\\\\ 0 & \\text{otherwise} \\end{cases}$$");
  assert_reads("damage w = stretch\noutput y = w",
               "$$w^{(n)} = \\max\\left(w^{(n-1)},\\, \\min\\left(1,\\, \\hat{d}\\right)\\right), "
               "\\qquad \\hat{d} = "
               "\\mathit{stretch}$$\n");
}

/* The state of a rate goes on, in names above, too; another one is old above its rule. */
static void rates_are_equations_in_time(void **state) {
  (void)state;
#define CHAIN                                                                                      \
  "state v = 0\nstate w = 0\nz = stretch - v\nrate v = (z - w)/2 [s]\nrate w = (v - w)/2 [s]\n"    \
  "y = v + w"
  assert_reads(CHAIN, "$$z = \\mathit{stretch} - v$$");
  assert_reads(CHAIN, "\\mathrm{d}t}\\,v = \\frac{z - w^{(n-1)}}{2\\,\\mathrm{s}}$$");
  assert_reads(CHAIN, "\\mathrm{d}t}\\,w = \\frac{v^{(n)} - w}{2\\,\\mathrm{s}}$$");
  assert_reads(CHAIN, "$$y = v^{(n)} + w^{(n)}$$");
  assert_reads(CHAIN, "a state without an index as it goes on within the step.");
  assert_reads("state v = 0\ny = 2*v\nrate v = stretch/2 [s]", "$$y = 2\\,v^{(n-1)}$$");
#undef CHAIN
}

static void stretch_is_measured_from_the_rest(void **state) {
  (void)state;
  assert_reads("state v = 0\nrest stretch = v\nrate v = stretch/2 [s]",
               "change of bond length over reference length; less `rest_stretch` |");
  assert_reads("state v = 0\nrest stretch = v\nrate v = stretch/2 [s]",
               "\\mathit{rest}_{\\mathrm{stretch}} = v^{(n-1)}$$\n\n$$\\frac{");
  assert_reads("output y = stretch", "change of bond length over reference length |");
}

static void units_read_as_formulas(void **state) {
  (void)state;
  static const struct {
    const char *unit, *formula;
  } pairs[] = {{"kg/m^3", "\\mathrm{kg}/\\mathrm{m}^{3}"},
               {"MPa*m^0.5", "\\mathrm{MPa}\\,\\mathrm{m}^{0.5}"},
               {"MPa*sqrt(m)", "\\mathrm{MPa}\\,\\sqrt{\\mathrm{m}}"},
               {"1/sqrt(s*(m))/K", "1/\\sqrt{\\mathrm{s}\\,(\\mathrm{m})}/\\mathrm{K}"},
               {"m**(1/2)", "\\mathrm{m}^{1/2}"},
               {"s^-1", "\\mathrm{s}^{-1}"},
               {"\xC2\xB5m", "\\mu\\mathrm{m}"},
               {"%", "\\%"}};
  for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    math_unit(pairs[i].unit, out);
    fclose(out);
    assert_string_equal(text, pairs[i].formula);
    free(text);
  }
}

static void descriptions_are_escaped(void **state) {
  (void)state;
  reading r;
  read_law(
      &r, "!> 50% of $x_1$ & {more} \\ ~ ^ #1, \xCE\xB8 \xE2\x9C\x93 \xC3\xA9 \xFF\nmodel m\n  law "
          "central bond\n"
          "  parameter EA = 2 [MN] \"a|b * _c_ `d` <e> $f$\"\n  force N = EA*stretch\nend model\n");
  char *latex = explained(r.law, EXPLAIN_LATEX), *markdown = explained(r.law, EXPLAIN_MARKDOWN);
  assert_non_null(strstr(latex,
                         "50\\% of \\$x\\_1\\$ \\& \\{more\\} \\textbackslash{} \\textasciitilde{} "
                         "\\textasciicircum{} \\#1, \\ensuremath{\\theta} ? \xC3\xA9 ?\n"));
  assert_non_null(strstr(markdown, "| a\\|b \\* \\_c\\_ \\`d\\` \\<e> \\$f\\$ |"));
  free(latex);
  free(markdown);
  end(&r);
}

/* --- whole documents -------------------------------------------------------------------------- */

static void run_pdflatex(const char *latex) {
  int status;
  free(run_command("command -v pdflatex >/dev/null", &status));
  if (status != 0) return;
  char folder[] = "explain_XXXXXX", path[64], command[512];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/law.tex", folder);
  write_file(path, latex);
  snprintf(command, sizeof command,
           "cd %s && pdflatex -halt-on-error -interaction=nonstopmode law.tex", folder);
  char *said = run_command(command, &status);
  if (status != 0) fail_msg("%s", said);
  free(said);
  snprintf(command, sizeof command, "rm -r %s", folder);
  free(run_command(command, &status));
}

static void documents_are_as_expected(void **state) {
  (void)state;
  static const char *const names[] = {"mplm_bilinear", "splm_concrete", "hardening_point", "lefm"};
  for (int i = 0; i < 4; i++) {
    char path[4096];
    snprintf(path, sizeof path, "%s/tests/dsl/golden/%s.plm", SOURCE_DIR, names[i]);
    size_t length;
    char *text = read_file(path, &length);
    assert_non_null(text);
    reading r;
    read_law(&r, text);
    char *markdown = explained(r.law, EXPLAIN_MARKDOWN), *latex = explained(r.law, EXPLAIN_LATEX);
    snprintf(path, sizeof path, "%s/tests/dsl/golden/%s.md", SOURCE_DIR, names[i]);
    assert_golden(path, markdown);
    snprintf(path, sizeof path, "%s/tests/dsl/golden/%s.tex", SOURCE_DIR, names[i]);
    assert_golden(path, latex);
    run_pdflatex(latex);
    free(markdown);
    free(latex);
    end(&r);
    free(text);
  }
}

static void deviators_are_told_from_tensors(void **state) {
  (void)state;
  reading r;
  read_law(&r, "model m\n  law continuum\n  parameter E = 2 [GPa]\n"
               "  state e on point = deviator 0  \"shape\"\n  state d on point = tensor 0\n"
               "  e = dev(strain)\n  d = strain\n  stress sigma = E*(e + d)\nend model\n");
  char *found = explained(r.law, EXPLAIN_MARKDOWN);
  assert_non_null(strstr(found, "| `e` | 1 | point | deviator 0 | shape |"));
  assert_non_null(strstr(found, "| `d` | 1 | point | tensor 0 |"));
  free(found);
  end(&r);
}

/* y, with `mode` and not `size` decided. */
static void chosen_branches_stand_alone(void **state) {
  (void)state;
  static const struct {
    const char *rule, *formula;
  } pairs[] = {
      {"y = | a when mode == one | 2*a otherwise", "$$y = 2\\,a$$"},
      {"y = | a when mode == two | 2*a otherwise", "$$y = a$$"},
      {"y = | a when mode /= one and stretch > 0 | 2*a otherwise",
       "$$y = \\begin{cases} a & \\text{when } \\mathit{stretch} > 0 \\\\ 2\\,a & "
       "\\text{otherwise} \\end{cases}$$"},
      {"y = | 0*a when stretch < 0 | a when mode == two or stretch > 1 | 2*a otherwise",
       "$$y = \\begin{cases} 0\\,a & \\text{when } \\mathit{stretch} < 0 \\\\ a & "
       "\\text{otherwise} \\end{cases}$$"},
      {"y = 3*(| a when not mode == two | a + 2*a otherwise)",
       "$$y = 3\\,\\left(a + 2\\,a\\right)$$"},
      {"y = | a when size == big | 2*a otherwise",
       "$$y = \\begin{cases} a & \\text{when } \\mathrm{size} = \\mathrm{big} \\\\ 2\\,a & "
       "\\text{otherwise} \\end{cases}$$"},
  };
  static const law_choice choices[] = {{"mode", "two"}};
  for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
    char text[2048];
    snprintf(text, sizeof text,
             "model m\n  law central bond\n  option mode = one | two\n  option size = big | small\n"
             "  parameter a = 2 [N]\n  %s\n  force N = y*stretch\nend model\n",
             pairs[k].rule);
    reading r;
    read_law(&r, text);
    char *found = NULL;
    size_t length;
    FILE *out = open_memstream(&found, &length);
    explain_law(r.law, EXPLAIN_MARKDOWN, choices, 1, out);
    fclose(out);
    if (!strstr(found, pairs[k].formula))
      fail_msg("%s\nis not read as\n%s\nbut\n%s", pairs[k].rule, pairs[k].formula, found);
    free(found);
    end(&r);
  }
}

static void the_command_explains_with_options(void **state) {
  (void)state;
  char command[4096];
  int status;
  snprintf(command, sizeof command,
           "%s explain --set onset=mohr_coulomb %s/tests/dsl/golden/splm_concrete.plm 2>/dev/null",
           PERILAT_PROGRAM, SOURCE_DIR);
  char *text = run_command(command, &status);
  assert_int_equal(status, 0);
  assert_non_null(strstr(
      text,
      "| `onset` | `rankine`, `mohr_coulomb` | `mohr_coulomb` | what begins tensile damage |"));
  assert_null(strstr(text, "\\mathrm{rankine}"));
  free(text);
  snprintf(command, sizeof command,
           "%s explain --set onset=none %s/tests/dsl/golden/splm_concrete.plm 2>/dev/null",
           PERILAT_PROGRAM, SOURCE_DIR);
  free(run_command(command, &status));
  assert_int_equal(status, 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(expressions_read_as_formulas),
      cmocka_unit_test(steps_are_marked),
      cmocka_unit_test(rates_are_equations_in_time),
      cmocka_unit_test(stretch_is_measured_from_the_rest),
      cmocka_unit_test(units_read_as_formulas),
      cmocka_unit_test(descriptions_are_escaped),
      cmocka_unit_test(documents_are_as_expected),
      cmocka_unit_test(deviators_are_told_from_tensors),
      cmocka_unit_test(chosen_branches_stand_alone),
      cmocka_unit_test(the_command_explains_with_options),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
