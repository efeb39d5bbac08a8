#include "dsl/semantics/law_limits.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/base/powers.h"
#include "dsl/semantics/decided.h"

enum { MOST_OWN_ARGUMENTS = 16 };

/* The function that a call has a value of numbers for, or NULL. */
static const builtin_function_info *plain_function(const expr *e) {
  const builtin_function_info *f = e->builtin < 0 ? NULL : &builtin_functions[e->builtin];
  return f && (f->of_one || f->of_many) ? f : NULL;
}

/* What names stand for: values of parameters, or NULL; of a function's arguments, or NULL. */
typedef struct known_values {
  const double *parameters, *arguments;
} known_values;

static double value_of(const expr *e, known_values v);

/* The body of the law's own function with its arguments. */
static double own_value(const expr *e, known_values v) {
  double arguments[MOST_OWN_ARGUMENTS];
  if (!e->symbol || e->argument_count > MOST_OWN_ARGUMENTS) return NAN;
  for (int i = 0; i < e->argument_count; i++)
    arguments[i] = value_of(e->arguments[i].value, v);
  return value_of(e->symbol->declared->value, (known_values){v.parameters, arguments});
}

static double call_value(const expr *e, known_values v) {
  const builtin_function_info *f = plain_function(e);
  if (e->builtin < 0) return own_value(e, v);
  if (!f) return NAN;
  double x = value_of(e->arguments[0].value, v);
  if (f->of_one) return f->of_one(x);
  for (int i = 1; i < e->argument_count; i++)
    x = f->of_many(x, value_of(e->arguments[i].value, v));
  return x;
}

static double binary_value(const expr *e, known_values v) {
  double a = value_of(e->left, v), b = value_of(e->right, v);
  switch (e->binary) {
  case OP_ADD:
    return a + b;
  case OP_SUB:
    return a - b;
  case OP_MUL:
    return a * b;
  case OP_DIV:
    return a / b;
  case OP_POW:
    return power_of(a, b);
  default:
    return NAN;
  }
}

static double number_value(const expr *e) {
  unit u = {DIMENSIONLESS, 1};
  const char *bad;
  size_t length;
  if (e->unit_text && !unit_parse(e->unit_text, strlen(e->unit_text), &u, &bad, &length))
    return NAN;
  return e->number * u.factor;
}

static double name_value(const expr *e, known_values v) {
  const symbol *s = e->symbol;
  if (s && s->kind == SYMBOL_QUANTITY && s->index == QUANTITY_PI) return M_PI;
  if (s && s->kind == SYMBOL_ARGUMENT) return v.arguments ? v.arguments[s->index] : NAN;
  return v.parameters && s && s->kind == SYMBOL_PARAMETER ? v.parameters[s->index] : NAN;
}

/* Of a parameter that is a vector. */
static double axis_value(const expr *e, known_values v) {
  const symbol *s = e->left->kind == EXPR_NAME ? e->left->symbol : NULL;
  if (!v.parameters || !s || s->kind != SYMBOL_PARAMETER) return NAN;
  return v.parameters[s->index + e->component];
}

static double value_of(const expr *e, known_values v) {
  switch (e->kind) {
  case EXPR_NUMBER:
    return number_value(e);
  case EXPR_NAME:
    return name_value(e, v);
  case EXPR_UNARY: {
    double a = value_of(e->left, v);
    if (e->unary == OP_AXIS) return axis_value(e, v);
    return e->unary == OP_NEG ? -a : a;
  }
  case EXPR_BINARY:
    return binary_value(e, v);
  case EXPR_CALL:
    return call_value(e, v);
  case EXPR_CASES:
  case EXPR_HOLE:
    return NAN;
  }
  return NAN;
}

double law_constant_value(const expr *e, const double *values) {
  return value_of(e, (known_values){values, NULL});
}

bool law_reads_parameter(const expr *e, const symbol *parameter) {
  if (!e) return false;
  if (e->kind == EXPR_NAME)
    return e->symbol && e->symbol->kind == SYMBOL_PARAMETER &&
           (!parameter || e->symbol == parameter);
  bool reads = law_reads_parameter(e->left, parameter) || law_reads_parameter(e->right, parameter);
  if (e->kind == EXPR_CALL && e->builtin < 0 && e->symbol)
    reads = reads || law_reads_parameter(e->symbol->declared->value, parameter);
  for (int i = 0; i < e->argument_count && !reads; i++)
    reads = law_reads_parameter(e->arguments[i].value, parameter);
  return reads;
}

bool law_is_plain(const expr *e) {
  switch (e->kind) {
  case EXPR_NUMBER:
  case EXPR_NAME:
    return true;
  case EXPR_UNARY:
    return e->unary != OP_NOT && law_is_plain(e->left);
  case EXPR_BINARY:
    return e->binary > OP_GE && e->binary != OP_CONTRACT && law_is_plain(e->left) &&
           law_is_plain(e->right);
  case EXPR_CALL:
    if (e->builtin < 0 ? !e->symbol || !law_is_plain(e->symbol->declared->value)
                       : !plain_function(e))
      return false;
    for (int i = 0; i < e->argument_count; i++)
      if (!law_is_plain(e->arguments[i].value)) return false;
    return true;
  case EXPR_CASES:
  case EXPR_HOLE:
    return false;
  }
  return false;
}

bool law_is_bound(const expr *e) {
  if (e->kind != EXPR_CASES) return law_is_plain(e);
  for (int k = 0; k < e->case_count; k++)
    if (!law_is_plain(e->cases[k].value) ||
        (e->cases[k].guard && !decided_early(e->cases[k].guard)))
      return false;
  return true;
}

static double bound_value(const law *l, const expr *e, const double *values) {
  for (int k = 0; e->kind == EXPR_CASES && k < e->case_count; k++)
    if (!e->cases[k].guard || decided_to_hold(l, e->cases[k].guard))
      return law_constant_value(e->cases[k].value, values);
  return law_constant_value(e, values);
}

law_limits law_parameter_limits(const law *l, int p, const double *values) {
  const bounds *in = &l->parameters.items[p]->declared->in;
  return (law_limits){.lower = in->lower ? bound_value(l, in->lower, values) : -INFINITY,
                      .upper = in->upper ? bound_value(l, in->upper, values) : INFINITY,
                      .lower_open = in->lower_open || !in->lower,
                      .upper_open = in->upper_open || !in->upper};
}

bool limits_hold(law_limits limits, double x) {
  bool above = limits.lower_open ? x > limits.lower : x >= limits.lower;
  bool below = limits.upper_open ? x < limits.upper : x <= limits.upper;
  return above && below;
}

law_limits limits_in(law_limits limits, double factor) {
  limits.lower /= factor;
  limits.upper /= factor;
  return limits;
}

void limits_text(law_limits limits, char *text, size_t size) {
  snprintf(text, size, "%c%.6g, %.6g%c", limits.lower_open ? '(' : '[', limits.lower, limits.upper,
           limits.upper_open ? ')' : ']');
}

bool law_parameter_within(const law *l, int p, const double *values, char *text, size_t size) {
  const law_limits limits = law_parameter_limits(l, p, values);
  if (limits_hold(limits, values[p])) return true;
  limits_text(limits, text, size);
  return false;
}

void law_parameter_bounds(const law *l, int p, const double *values, char *text, size_t size) {
  limits_text(law_parameter_limits(l, p, values), text, size);
}
