#include "dsl/semantics/law_limits.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/base/powers.h"
#include "dsl/semantics/decided.h"

/* The function that a call has a value of numbers for, or NULL. */
static const builtin_function_info *plain_function(const expr *e) {
  const builtin_function_info *f = e->builtin < 0 ? NULL : &builtin_functions[e->builtin];
  return f && (f->of_one || f->of_many) ? f : NULL;
}

static double call_value(const expr *e, const double *values) {
  const builtin_function_info *f = plain_function(e);
  if (!f) return NAN;
  double x = law_constant_value(e->arguments[0].value, values);
  if (f->of_one) return f->of_one(x);
  for (int i = 1; i < e->argument_count; i++)
    x = f->of_many(x, law_constant_value(e->arguments[i].value, values));
  return x;
}

static double binary_value(const expr *e, const double *values) {
  double a = law_constant_value(e->left, values), b = law_constant_value(e->right, values);
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

static double name_value(const expr *e, const double *values) {
  const symbol *s = e->symbol;
  if (s && s->kind == SYMBOL_QUANTITY && s->index == QUANTITY_PI) return M_PI;
  return values && s && s->kind == SYMBOL_PARAMETER ? values[s->index] : NAN;
}

/* Of a parameter that is a vector. */
static double axis_value(const expr *e, const double *values) {
  const symbol *s = e->left->kind == EXPR_NAME ? e->left->symbol : NULL;
  if (!values || !s || s->kind != SYMBOL_PARAMETER) return NAN;
  return values[s->index + e->component];
}

double law_constant_value(const expr *e, const double *values) {
  switch (e->kind) {
  case EXPR_NUMBER:
    return number_value(e);
  case EXPR_NAME:
    return name_value(e, values);
  case EXPR_UNARY: {
    double a = law_constant_value(e->left, values);
    if (e->unary == OP_AXIS) return axis_value(e, values);
    return e->unary == OP_NEG ? -a : a;
  }
  case EXPR_BINARY:
    return binary_value(e, values);
  case EXPR_CALL:
    return call_value(e, values);
  case EXPR_CASES:
  case EXPR_HOLE:
    return NAN;
  }
  return NAN;
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
    if (!plain_function(e)) return false;
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
