#include "dsl/semantics/law_limits.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/base/powers.h"

static double call_value(const expr *e, const double *values) {
  double x = e->argument_count > 0 ? law_constant_value(e->arguments[0].value, values) : NAN;
  switch (e->builtin) {
  case FUNCTION_ABS:
    return fabs(x);
  case FUNCTION_SQRT:
    return sqrt(x);
  case FUNCTION_CBRT:
    return pl_cbrt(x);
  case FUNCTION_EXP:
    return pl_exp(x);
  case FUNCTION_LOG:
    return pl_log(x);
  case FUNCTION_SIN:
    return pl_sin(x);
  case FUNCTION_COS:
    return pl_cos(x);
  case FUNCTION_TAN:
    return pl_tan(x);
  case FUNCTION_TANH:
    return pl_tanh(x);
  case FUNCTION_SIGN:
    return (x > 0) - (x < 0);
  case FUNCTION_MACAULAY:
    return pl_max(x, 0);
  case FUNCTION_SOFT_SIGN:
    return x / (1 + fabs(x));
  case FUNCTION_MIN:
  case FUNCTION_MAX:
    for (int i = 1; i < e->argument_count; i++) {
      double y = law_constant_value(e->arguments[i].value, values);
      x = e->builtin == FUNCTION_MIN ? pl_min(x, y) : pl_max(x, y);
    }
    return x;
  default:
    return NAN;
  }
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

double law_constant_value(const expr *e, const double *values) {
  switch (e->kind) {
  case EXPR_NUMBER:
    return number_value(e);
  case EXPR_NAME:
    if (!values || !e->symbol || e->symbol->kind != SYMBOL_PARAMETER) return NAN;
    return values[e->symbol->index];
  case EXPR_UNARY: {
    double a = law_constant_value(e->left, values);
    return e->unary == OP_NEG ? -a : a;
  }
  case EXPR_BINARY:
    return binary_value(e, values);
  case EXPR_CALL:
    return call_value(e, values);
  case EXPR_CASES:
    return NAN;
  }
  return NAN;
}

law_limits law_parameter_limits(const law *l, int p, const double *values) {
  const bounds *in = &l->parameters.items[p]->declared->in;
  return (law_limits){.lower = in->lower ? law_constant_value(in->lower, values) : -INFINITY,
                      .upper = in->upper ? law_constant_value(in->upper, values) : INFINITY,
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
