/* What the checker accepts is homogeneous in its units: thousands of random expressions are
   computed in SI and in a system whose metre, kilogram and second are 1/4096 of ours. Values in
   m^a kg^b s^c must differ by 4096^(a + b + c): a power of 2, also of roots, so that this is nearly
   exact. Example: s + 2 [m] is accepted, as 0.9 + 2 = 2.9 and 3686.4 + 8192 = 4096*2.9. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"

#define BASE                                                                                       \
  "model m\nlaw micropolar bond\nparameter EA = 2.5 [kN]\nfunction f(p, q) = p*q + 2*q*p\n"        \
  "function g(p) = | 0 when p < 0 | p otherwise\nforce N = EA*stretch\n"                           \
  "force V = EA*(theta_i + theta_j)\n"

/* --- random expressions ----------------------------------------------------------------------- */

static uint32_t draw(uint32_t *state, uint32_t below) {
  *state = *state * 1664525u + 1013904223u;
  return (*state >> 10) % below;
}

/* `#` stands for an expression, `?` for a condition. */
static const char *const forms[] = {
    "(#+#)",     "(#-#)",        "#*#",      "#/#",
    "(-#)",      "#**2",         "#**(1/2)", "(#)**(-1)",
    "abs(#)",    "sqrt(#)",      "cbrt(#)",  "exp(#)",
    "sin(#)",    "tanh(#)",      "sign(#)",  "f(#, #)",
    "min(#, #)", "max(#, #, #)", "g(#)",     "atan2(#, #)",
    "norm(#)",   "(#:#)",        "log(#)",   "positive_part(#)",
    "log10(#)",  "asin(#)",      "acos(#)",  "sinh(#)",
    "cosh(#)",   "pi*#",         "(#+#)",    "(| # when ? | # otherwise)"};
static const char *const conditions[] = {"# < #", "# >= #", "(? and ?)", "not ?"};
static const char *const leaves[] = {
    "stretch", "stretch_rate", "s",       "t",          "length",  "spacing",
    "area",    "EA",           "theta_i", "theta_j",    "0",       "1",
    "0.5",     "2 [m]",        "3 [kN]",  "V",          "4 [1/s]", "m",
    "s",       "stretch",      "s/t",     "EA*stretch", "m_i",     "area/t",
    "EA/(s*t)"};
#define PICK(list, state) (list)[draw(state, sizeof(list) / sizeof *(list))]

static void write_form(FILE *out, uint32_t *state, const char *form, int depth) {
  for (; *form; form++) {
    if (*form == '#')
      write_form(out, state, depth > 0 && draw(state, 3) ? PICK(forms, state) : PICK(leaves, state),
                 depth - 1);
    else if (*form == '?')
      write_form(out, state, depth > 0 ? PICK(conditions, state) : "# < #", depth - 1);
    else
      fputc(*form, out);
  }
}

/* --- their values ----------------------------------------------------------------------------- */

typedef struct units {
  double finer; /* how many of these metres, kilograms, seconds make one of ours */
  const double *arguments;
  const stmt *function; /* that the arguments belong to */
} units;

static double number_in(const units *u, double si, dimension dim) {
  for (int k = 0; k < 4; k++)
    si *= pow(u->finer, dim.twelfths[k] / 12.0);
  return si;
}

static double value_of(const units *u, const expr *e);

static double name_value(const units *u, const expr *e) {
  for (int i = 0; u->function && i < u->function->word_count; i++)
    if (strcmp(u->function->words[i], e->name) == 0) return u->arguments[i];
  const int q = builtin_quantity_find(e->name);
  if (q < 0) return number_in(u, 2500, dimension_of("N"));
  return number_in(u, 0.3 + 0.1 * q, dimension_of(builtin_quantities[q].unit));
}

static double call_value(const units *u, const expr *e) {
  double values[16];
  for (int i = 0; i < e->argument_count; i++)
    values[i] = value_of(u, e->arguments[i].value);
  if (e->builtin < 0) {
    const stmt *s = e->symbol->declared;
    return value_of(&(units){u->finer, values, s}, s->value);
  }
  if (e->builtin == FUNCTION_NORM) return fabs(values[0]);
  if (e->builtin == FUNCTION_ATAN2) return atan2(values[0], values[1]);
  const builtin_function_info *f = &builtin_functions[e->builtin];
  if (f->of_one) return f->of_one(values[0]);
  assert_non_null(f->of_many);
  for (int i = 1; i < e->argument_count; i++)
    values[0] = f->of_many(values[0], values[i]);
  return values[0];
}

static double binary_value(const units *u, const expr *e) {
  const double a = value_of(u, e->left), b = value_of(u, e->right);
  switch (e->binary) {
  case OP_ADD:
    return a + b;
  case OP_SUB:
    return a - b;
  case OP_MUL:
  case OP_CONTRACT: /* in the plane a bending quantity is one number */
    return a * b;
  case OP_DIV:
    return a / b;
  case OP_POW:
    return pow(a, b);
  case OP_LT:
    return a < b;
  case OP_GE:
    return a >= b;
  case OP_AND:
    return a != 0 && b != 0;
  default:
    fail_msg("an operator that no form has");
    return NAN;
  }
}

static double value_of(const units *u, const expr *e) {
  switch (e->kind) {
  case EXPR_NUMBER: {
    unit written = {DIMENSIONLESS, 1};
    const char *bad;
    size_t length;
    if (e->unit_text)
      assert_true(unit_parse(e->unit_text, strlen(e->unit_text), &written, &bad, &length));
    return number_in(u, e->number * written.factor, written.dim);
  }
  case EXPR_NAME:
    return name_value(u, e);
  case EXPR_UNARY: {
    const double a = value_of(u, e->left);
    return e->unary == OP_NOT ? a == 0 : e->unary == OP_NEG ? -a : a;
  }
  case EXPR_BINARY:
    return binary_value(u, e);
  case EXPR_CALL:
    return call_value(u, e);
  case EXPR_CASES:
    for (int i = 0; i < e->case_count; i++)
      if (!e->cases[i].guard || value_of(u, e->cases[i].guard) != 0)
        return value_of(u, e->cases[i].value);
    break;
  case EXPR_HOLE:
    break;
  }
  fail_msg("cases without otherwise were accepted");
  return NAN;
}

/* --- the test --------------------------------------------------------------------------------- */

/* Returns whether there was a value to compare, in a unit. */
static bool assert_homogeneous(const char *text, const symbol *output) {
  const units si = {.finer = 1}, fine = {.finer = 4096};
  const double a = value_of(&si, output->rule->value), b = value_of(&fine, output->rule->value);
  const double expected = number_in(&fine, a, output->dim);
  if (!isfinite(expected) || !isfinite(b)) return false; /* the root of a negative number, say */
  if (fabs(b - expected) > 1e-9 * fabs(expected))
    fail_msg("`%s` is accepted: %.17g, in the finer units %.17g instead of %.17g", text, a, b,
             expected);
  return a != 0 && !dim_is_none(output->dim);
}

static void what_is_accepted_is_homogeneous(void **state) {
  (void)state;
  uint32_t random = 2014;
  int accepted = 0, refused = 0, compared = 0;
  for (int n = 0; n < 20000; n++) {
    char *text, *whole;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    write_form(out, &random, PICK(forms, &random), 1 + n % 3);
    fclose(out);
    out = open_memstream(&whole, &length);
    fprintf(out, BASE "output o = %s\nend model\n", text);
    fclose(out);
    arena *memory = arena_new();
    source_set sources = {0};
    diagnostics d;
    const int file = source_add(&sources, "law.plm", whole, length);
    diag_begin(&d, &sources);
    tree *t = parse_model(memory, &sources, file, &(parse_options){0}, &d);
    law *l = t && d.errors == 0 ? law_check(memory, t, &sources, NULL, 0, &d) : NULL;
    compared += l && assert_homogeneous(text, l->outputs.items[0]);
    accepted += l != NULL;
    refused += l == NULL && d.errors > 0;
    diag_clear(&d);
    source_clear(&sources);
    arena_free(memory);
    free(whole);
    free(text);
  }
  assert_int_equal(accepted + refused, 20000);
  assert_true(accepted > 5000 && compared > 2000);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_accepted_is_homogeneous)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
