/* Units of numbers, defaults and bounds of parameters. */
#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/base/powers.h"
#include "dsl/base/unit_hint.h"
#include "dsl/semantics/check.h"

/* --- units ------------------------------------------------------------------------------------ */

static bool is_whole_unit(const char *text, size_t length) {
  unit u;
  const char *bad;
  size_t bad_length;
  return length > 0 && unit_parse(text, length, &u, &bad, &bad_length);
}

bool read_unit(checker *ck, const char *text, span where, unit *result) {
  const char *bad;
  size_t length, whole = strlen(text);
  if (unit_parse(text, whole, result, &bad, &length)) return true;
  span part = where;
  if (where.end - where.begin == whole && length > 0) {
    part.begin = where.begin + (uint32_t)(bad - text);
    part.end = part.begin + (uint32_t)length;
  }
  if (length == 0) {
    complain(ck, DIAG_UNKNOWN_UNIT, where, "a unit is missing in `[%s]`", text);
    diag_hint(ck->d, "write a unit such as `[N/m]`, or no brackets for a pure number");
  } else if (is_whole_unit(bad, length) && bad > text && memchr(text, '/', (size_t)(bad - text))) {
    complain(ck, DIAG_UNKNOWN_UNIT, part, "does `%.*s` stand above or below the line?", (int)length,
             bad);
    diag_hint(ck->d, "write `*`, or put the divisor in parentheses: `J/(kg*K)`");
  } else {
    complain(ck, DIAG_UNKNOWN_UNIT, part, "there is no unit `%.*s`", (int)length, bad);
    unit_hint(ck->d, bad, length);
  }
  return false;
}

/* --- values ----------------------------------------------------------------------------------- */

static double call_value(const expr *e, const double *parameters) {
  double x = e->argument_count > 0 ? law_constant_value(e->arguments[0].value, parameters) : NAN;
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
      double y = law_constant_value(e->arguments[i].value, parameters);
      x = e->builtin == FUNCTION_MIN ? pl_min(x, y) : pl_max(x, y);
    }
    return x;
  default:
    return NAN;
  }
}

static double binary_value(const expr *e, const double *parameters) {
  double a = law_constant_value(e->left, parameters), b = law_constant_value(e->right, parameters);
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

double law_constant_value(const expr *e, const double *parameters) {
  switch (e->kind) {
  case EXPR_NUMBER:
    return number_value(e);
  case EXPR_NAME:
    if (!parameters || !e->symbol || e->symbol->kind != SYMBOL_PARAMETER) return NAN;
    return parameters[e->symbol->index];
  case EXPR_UNARY: {
    double a = law_constant_value(e->left, parameters);
    return e->unary == OP_NEG ? -a : a;
  }
  case EXPR_BINARY:
    return binary_value(e, parameters);
  case EXPR_CALL:
    return call_value(e, parameters);
  case EXPR_CASES:
    return NAN;
  }
  return NAN;
}

/* Calls and cases that law_constant_value does not know are refused where a plain value is asked
 * for. */
static bool is_plain(const expr *e) {
  switch (e->kind) {
  case EXPR_NUMBER:
  case EXPR_NAME:
    return true;
  case EXPR_UNARY:
    return e->unary != OP_NOT && is_plain(e->left);
  case EXPR_BINARY:
    return e->binary > OP_GE && e->binary != OP_CONTRACT && is_plain(e->left) && is_plain(e->right);
  case EXPR_CALL:
    if (e->builtin < 0 || e->builtin == FUNCTION_ATAN2 ||
        (e->builtin > FUNCTION_MAX && e->builtin < FUNCTION_COUNT))
      return false;
    for (int i = 0; i < e->argument_count; i++)
      if (!is_plain(e->arguments[i].value)) return false;
    return true;
  case EXPR_CASES:
    return false;
  }
  return false;
}

static value check_plain(checker *ck, expr *e, context where) {
  context before = ck->context;
  ck->context = where;
  value v = check_number(ck, e);
  ck->context = before;
  if (!v.broken && !is_plain(e)) {
    complain(ck, DIAG_BAD_NUMBER, e->where,
             "a value given here is made of numbers, + - * / ** and plain functions");
    return BROKEN;
  }
  return v;
}

static bool read_finite(checker *ck, const expr *e, double *number) {
  *number = law_constant_value(e, NULL);
  if (isfinite(*number)) return true;
  complain(ck, DIAG_BAD_NUMBER, e->where, "this is not a finite number");
  return false;
}

/* --- parameters and states -------------------------------------------------------------------- */

static void check_density(checker *ck, const stmt *s, dimension dim) {
  dimension density = dimension_of("kg/m^3");
  if (strcmp(s->name, "rho") != 0 || dim_equal(dim, density)) return;
  complain(ck, DIAG_UNITS, s->value ? s->value->where : s->name_where,
           "`rho` is the mass density the lattice reads, but this is %s", describe(ck, dim));
  diag_hint(ck->d, "give it a unit such as `2323 [kg/m^3]`, or choose another name");
}

void check_parameter(checker *ck, stmt *s) {
  if (!s->symbol) return;
  entry *e = entry_of(s->symbol);
  value v = scalar_of(DIMENSIONLESS, ON_BODY);
  unit u;
  if (s->value) {
    v = check_plain(ck, s->value, IN_DEFAULT);
    if (!v.broken && v.shape != SHAPE_SCALAR) v = BROKEN;
    if (!v.broken && !read_finite(ck, s->value, &e->symbol.initial)) v = BROKEN;
    e->symbol.has_default = !v.broken;
  } else if (s->unit_text) {
    if (read_unit(ck, s->unit_text, s->unit_where, &u))
      v.dim = u.dim;
    else
      v = BROKEN;
  }
  v.zero = v.unknown = false;
  v.place = ON_BODY;
  e->type = v;
  e->known = true;
  if (!v.broken) check_density(ck, s, v.dim);
}

/* A bare 0 leaves unit and shape to the rule. */
void check_initial_value(checker *ck, stmt *s) {
  if (!s->symbol) return;
  entry *e = entry_of(s->symbol);
  value v = {.zero = true};
  if (s->value) v = check_plain(ck, s->value, IN_DEFAULT);
  if (!v.broken && s->value && !read_finite(ck, s->value, &e->symbol.initial)) v = BROKEN;
  if (v.zero) {
    e->infer = !e->known;
    return;
  }
  v.place = e->symbol.place;
  e->type = v;
  e->known = true;
}

/* --- bounds ----------------------------------------------------------------------------------- */

/* The unit the default is written in; the SI unit where it is not a single number. */
static double own_unit(const symbol *p, char *text, size_t size) {
  const expr *e = p->declared->value;
  const char *own = e && e->kind == EXPR_NUMBER ? e->unit_text : p->declared->unit_text;
  unit u;
  const char *bad;
  size_t length;
  if (own && unit_parse(own, strlen(own), &u, &bad, &length)) {
    snprintf(text, size, "%s", own);
    return u.factor;
  }
  dim_unit(entry_of(p)->type.dim, text, size);
  return 1;
}

static bool check_limit(checker *ck, expr *limit, const symbol *parameter) {
  if (!limit) return true;
  value v = check_plain(ck, limit, IN_BOUNDS);
  if (v.broken) return false;
  const char *what = arena_printf(ck->memory, "a bound of `%s`", parameter->name);
  if (expect(ck, limit, v, entry_of(parameter)->type.dim, SHAPE_SCALAR, what)) return true;
  char text[64];
  own_unit(parameter, text, sizeof(text));
  if (limit->kind == EXPR_NUMBER && !limit->unit_text)
    diag_hint(ck->d, "give the number its unit: `%g [%s]`", limit->number, text);
  return false;
}

static bool limits_of(const bounds *in, const double *values, double *lower, double *upper) {
  *lower = in->lower ? law_constant_value(in->lower, values) : -INFINITY;
  *upper = in->upper ? law_constant_value(in->upper, values) : INFINITY;
  return !isnan(*lower) && !isnan(*upper);
}

static bool is_within(const bounds *in, double lower, double upper, double x) {
  bool above = in->lower_open || !in->lower ? x > lower : x >= lower;
  bool below = in->upper_open || !in->upper ? x < upper : x <= upper;
  return above && below;
}

static void limits_text(const bounds *in, double lower, double upper, char *text, size_t size) {
  char low[32] = "-inf", high[32] = "inf";
  if (in->lower) snprintf(low, sizeof(low), "%.6g", lower);
  if (in->upper) snprintf(high, sizeof(high), "%.6g", upper);
  snprintf(text, size, "%c%s, %s%c", in->lower_open || !in->lower ? '(' : '[', low, high,
           in->upper_open || !in->upper ? ')' : ']');
}

static void check_default_in_bounds(checker *ck, const symbol *p, const double *defaults) {
  const stmt *s = p->declared;
  double lower, upper;
  if (!limits_of(&s->in, defaults, &lower, &upper)) return; /* of a parameter without a default */
  char text[80], unit_name[64];
  double factor = own_unit(p, unit_name, sizeof(unit_name));
  limits_text(&s->in, lower / factor, upper / factor, text, sizeof(text));
  if (lower > upper || (lower == upper && (s->in.lower_open || s->in.upper_open))) {
    complain(ck, DIAG_BOUNDS, s->in.where, "no value lies in %s", text);
    if (lower > upper) diag_hint(ck->d, "the lower bound comes first");
  } else if (p->has_default && !is_within(&s->in, lower, upper, p->initial)) {
    bool plain = strcmp(unit_name, "1") == 0;
    complain(ck, DIAG_BOUNDS, s->value->where, "the default of `%s` is not in %s%s%s", p->name,
             text, plain ? "" : " ", plain ? "" : unit_name);
    diag_note(ck->d, s->in.where, "its bounds are given here");
  }
}

void check_bounds(checker *ck) {
  const symbol_list *parameters = &ck->law->parameters;
  double *defaults = arena_alloc(ck->memory, (size_t)parameters->count * sizeof(double));
  for (int i = 0; i < parameters->count; i++)
    defaults[i] = parameters->items[i]->has_default ? parameters->items[i]->initial : NAN;
  for (int i = 0; i < parameters->count; i++) {
    const symbol *p = parameters->items[i];
    const bounds *in = &p->declared->in;
    if (!in->given || entry_of(p)->type.broken) continue;
    bool lower = check_limit(ck, in->lower, p), upper = check_limit(ck, in->upper, p);
    if (lower && upper) check_default_in_bounds(ck, p, defaults);
  }
}

law_limits law_parameter_limits(const law *l, int p, const double *values) {
  const bounds *in = &l->parameters.items[p]->declared->in;
  law_limits limits = {.lower_open = in->lower_open || !in->lower,
                       .upper_open = in->upper_open || !in->upper};
  limits_of(in, values, &limits.lower, &limits.upper);
  return limits;
}

void law_parameter_bounds(const law *l, int p, const double *values, char *text, size_t size) {
  const bounds *in = &l->parameters.items[p]->declared->in;
  double lower, upper;
  limits_of(in, values, &lower, &upper);
  limits_text(in, lower, upper, text, size);
}

bool law_parameter_within(const law *l, int p, const double *values, char *text, size_t size) {
  const bounds *in = &l->parameters.items[p]->declared->in;
  if (!in->given) {
    if (isfinite(values[p])) return true;
    snprintf(text, size, "(-inf, inf)");
    return false;
  }
  double lower, upper;
  bool known = limits_of(in, values, &lower, &upper);
  if (known && is_within(in, lower, upper, values[p])) return true;
  limits_text(in, lower, upper, text, size);
  return false;
}
