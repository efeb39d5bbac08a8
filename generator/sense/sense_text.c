#include "generator/sense/sense_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/sense/sense_memory.h"

/* --- numbers of the text ---------------------------------------------------------------------- */

static double value_in(const sense_bench *b, const expr *e, int *left);

static double value_of_number(const expr *e) {
  unit in;
  const char *bad;
  size_t length;
  if (!e->unit_text) return e->number;
  return unit_parse(e->unit_text, strlen(e->unit_text), &in, &bad, &length) ? e->number * in.factor
                                                                            : NAN;
}

static double value_of_name(const sense_bench *b, const expr *e, int *left) {
  const symbol *s = e->symbol;
  if (s && s->kind == SYMBOL_PARAMETER) return sense_value(b, s);
  if (s && s->kind == SYMBOL_QUANTITY && s->index == QUANTITY_PI) return M_PI;
  if (s && s->kind == SYMBOL_CONSTANT && s->rule) return value_in(b, s->rule->value, left);
  return NAN;
}

static double value_of_binary(double x, binary_op op, double y) {
  switch (op) {
  case OP_ADD:
    return x + y;
  case OP_SUB:
    return x - y;
  case OP_MUL:
    return x * y;
  case OP_DIV:
    return x / y;
  case OP_POW:
    return pl_pow(x, y);
  default:
    return NAN;
  }
}

/* With so many looks left: names in names unfold to any size. */
static double value_in(const sense_bench *b, const expr *e, int *left) {
  if (!e || --*left < 0) return NAN;
  switch (e->kind) {
  case EXPR_NUMBER:
    return value_of_number(e);
  case EXPR_NAME:
    return value_of_name(b, e, left);
  case EXPR_UNARY: {
    const double x = value_in(b, e->left, left);
    return e->unary == OP_NEG ? -x : e->unary == OP_PLUS ? x : NAN;
  }
  case EXPR_BINARY: {
    const double x = value_in(b, e->left, left), y = value_in(b, e->right, left);
    return value_of_binary(x, e->binary, y);
  }
  default:
    return NAN;
  }
}

/* Of an expression of numbers, parameters and constants; else NaN. */
static double value_of(const sense_bench *b, const expr *e) {
  int left = 2000;
  return value_in(b, e, &left);
}

/* --- degrees ---------------------------------------------------------------------------------- */

static const double FULL_TURN = 2 * M_PI, DEGREE = M_PI / 180;

static bool has_unit(const expr *e) {
  return e && (e->unit_text || has_unit(e->left) || has_unit(e->right));
}

static const symbol *parameter_of(const expr *e) {
  return e->kind == EXPR_NAME && e->symbol && e->symbol->kind == SYMBOL_PARAMETER ? e->symbol
                                                                                  : NULL;
}

/* The parameter that is the argument of a sine, where its bounds end beyond a full turn. */
static bool is_bounded_in_degrees(const sense_bench *b, const symbol *angle) {
  if (!angle || !angle->declared->in.given || has_unit(angle->declared->in.upper)) return false;
  const double most = value_of(b, angle->declared->in.upper);
  return most > FULL_TURN && most <= 400;
}

/* 30, 22.5: angles in degrees are such numbers, if 3.14 did not turn them. */
static bool is_round(double angle) {
  const double within = 1e-3 * fabs(angle);
  const double whole = fabs(angle - nearbyint(angle)),
               parts = fabs(angle / 7.5 - nearbyint(angle / 7.5));
  return whole <= within || 7.5 * parts <= within;
}

/* The parameter of an angle, declared with its unit, that is turned into radians once more. */
static const symbol *turned_again(const sense_bench *b, const expr *e, double angle) {
  const double within = 1e-3; /* 3.14/180, too */
  const symbol *s = NULL;
  for (; e->kind == EXPR_BINARY && (e->binary == OP_MUL || e->binary == OP_DIV) && !s; e = e->left)
    s = parameter_of(e->left) ? parameter_of(e->left) : parameter_of(e->right);
  if (!s || !has_unit(s->declared->value) || !dim_is_none(s->dim)) return NULL;
  return fabs(angle / (sense_value(b, s) * DEGREE) - 1) <= within ? s : NULL;
}

static void say_degrees(sense_bench *b, const expr *call, double value) {
  const expr *angle = call->arguments[0].value;
  char *text = expr_text(angle);
  sense_say(b, DIAG_DEGREES, angle->where,
            "angles are in radians: write the unit, `30 [deg]`, in the parameter and in its "
            "bounds, and no factor such as 180/pi",
            "`%s` takes `%s` = %.6g as radians, but this looks like degrees", call->name, text,
            value);
  free(text);
}

static void say_turned_again(sense_bench *b, const expr *call, const symbol *s) {
  char mend[256];
  snprintf(mend, sizeof mend, "leave the factor out: `%s(%.60s)`", call->name, s->name);
  sense_say(b, DIAG_DEGREES, call->arguments[0].value->where, mend,
            "`%s` is in radians already, whatever unit it is written in: the factor turns it into "
            "radians a second time",
            s->name);
}

static void check_angle(sense_bench *b, const expr *call) {
  const expr *angle = call->arguments[0].value;
  const symbol *alone = parameter_of(angle);
  const double value = value_of(b, angle);
  const symbol *again = turned_again(b, angle, value);
  if (again)
    say_turned_again(b, call, again);
  else if (is_bounded_in_degrees(b, alone) || (fabs(value) > FULL_TURN && is_round(value) &&
                                               !(alone && has_unit(alone->declared->value))))
    say_degrees(b, call, value);
}

/* --- powers ----------------------------------------------------------------------------------- */

static bool is_plain(const expr *e, double *value) {
  *value = e && e->kind == EXPR_NUMBER && !e->unit_text ? e->number : NAN;
  return !isnan(*value);
}

static void check_power(sense_bench *b, const expr *e) {
  double power, divisor;
  if (e->binary != OP_DIV || e->left->kind != EXPR_BINARY || e->left->binary != OP_POW) return;
  if (!is_plain(e->left->right, &power) || power != 1 || !is_plain(e->right, &divisor)) return;
  char *base = expr_text(e->left->left), mend[256];
  snprintf(mend, sizeof mend, "write `%.60s**(1/%g)`%s", base, divisor,
           divisor == 2 ? ", or `sqrt(...)`" : "");
  sense_say(b, DIAG_PRECEDENCE, e->where, mend,
            "`**1/%g` is `(...**1)/%g`: this divides by %g and takes no root", divisor, divisor,
            divisor);
  free(base);
}

/* --- sums over the family --------------------------------------------------------------------- */

typedef struct seen_names {
  const expr *own; /* the first value of the particle itself that moves */
  bool differs;    /* something that moves is read of the neighbour or of the bond */
} seen_names;

static bool moves(const symbol *s) {
  if (s->kind == SYMBOL_QUANTITY) return !builtin_quantities[s->index].fixed;
  return s->kind == SYMBOL_DEFINED || s->kind == SYMBOL_STATE || s->kind == SYMBOL_DAMAGE ||
         s->kind == SYMBOL_RESULT;
}

static void look_for_names(const expr *e, seen_names *seen) {
  if (!e) return;
  if (e->kind == EXPR_NAME && e->symbol && moves(e->symbol)) {
    seen->differs = seen->differs || e->indexed || e->primed || e->place > ON_PARTICLE;
    if (!e->indexed && e->place == ON_PARTICLE && !seen->own) seen->own = e;
  }
  if (e->kind == EXPR_CALL && e->symbol)
    seen->differs = true; /* of what is inside nothing is known */
  look_for_names(e->left, seen);
  look_for_names(e->right, seen);
  for (int k = 0; k < e->argument_count; k++)
    look_for_names(e->arguments[k].value, seen);
  for (int k = 0; k < e->case_count; k++) {
    look_for_names(e->cases[k].guard, seen);
    look_for_names(e->cases[k].value, seen);
  }
}

static void check_sum(sense_bench *b, const expr *call) {
  seen_names seen = {NULL, false};
  if (b->law->tree->law != LAW_STATE) return;
  look_for_names(call->arguments[0].value, &seen);
  if (!seen.own || seen.differs) return;
  char mend[256];
  snprintf(mend, sizeof mend, "write `%.60s[j]` for the neighbour's, or take it out of the `%s`",
           seen.own->name, call->name);
  sense_say(b, DIAG_OWN_VALUE, seen.own->where, mend,
            "`%s` is the particle's own value, the same for each neighbour of this `%s`",
            seen.own->name, call->name);
}

/* --- flows and rates whose new value the force does not know ---------------------------------- */

typedef struct reading {
  bool old, new, dt;
  int looks; /* names in names unfold to any size */
} reading;

/* `previous(x)` alone is an old value that is meant; a name above its rule may be. Of any state
   where that is NULL. */
static void find_readings(const expr *e, const symbol *state, reading *found, int depth) {
  enum { DEEPEST = 64, MOST_LOOKS = 100000 };
  if (!e || depth > DEEPEST || ++found->looks > MOST_LOOKS) return;
  if (e->kind == EXPR_CALL && !e->symbol && e->builtin == FUNCTION_PREVIOUS) {
    found->old = found->old || !state || e->arguments[0].value->symbol == state;
    return;
  }
  if (e->kind == EXPR_NAME && e->symbol == state) found->new = true;
  if (e->kind == EXPR_NAME && e->symbol && e->symbol->kind == SYMBOL_QUANTITY &&
      e->symbol->index == QUANTITY_DT)
    found->dt = true;
  if (e->kind == EXPR_NAME && e->symbol && e->symbol->kind == SYMBOL_DEFINED && e->symbol->rule)
    find_readings(e->symbol->rule->value, state, found, depth + 1);
  find_readings(e->left, state, found, depth + 1);
  find_readings(e->right, state, found, depth + 1);
  for (int k = 0; k < e->argument_count; k++)
    find_readings(e->arguments[k].value, state, found, depth + 1);
  for (int k = 0; k < e->case_count; k++) {
    find_readings(e->cases[k].guard, state, found, depth + 1);
    find_readings(e->cases[k].value, state, found, depth + 1);
  }
}

/* Of laws of families, whose forces may read damages of the last step, but not what a flow or a
   rate has just changed. */
static void check_force_state(sense_bench *b) {
  const stmt *force = law_force_state(b->law);
  if (!force || b->law->options.count > 0) return; /* which may choose just that */
  reading any = {.old = false};
  find_readings(force->value, NULL, &any, 0);
  if (any.dt && !any.old) sense_say_reads_dt(b);
  for (int k = 0; k < b->law->fields.count; k++) {
    const symbol *s = b->law->fields.items[k];
    reading found = {.old = false};
    if (!s->rule || (s->rule->kind != STMT_FLOW && s->rule->kind != STMT_RATE)) continue;
    find_readings(force->value, s, &found, 0);
    if (found.old && !found.new)
      sense_say(b, DIAG_ONE_STEP_LATE, force->where,
                "write it below the rule of the state, without `previous`",
                "the force state is made of `%s` as it was before its %s: it is a step late",
                s->name, s->rule->kind == STMT_RATE ? "rate" : "flow");
  }
}

/* A state of the last step that an expression reads because its rule stands below; not
   `previous(x)`, which is meant. */
static const symbol *state_below(const expr *e, int depth) {
  enum { DEEPEST = 64 };
  const symbol *found = NULL;
  if (!e || depth > DEEPEST) return NULL;
  if (e->kind == EXPR_CALL && !e->symbol && e->builtin == FUNCTION_PREVIOUS) return NULL;
  if (e->kind == EXPR_NAME && e->symbol && e->reads_old) return e->symbol;
  if (e->kind == EXPR_NAME && e->symbol && e->symbol->kind == SYMBOL_DEFINED && e->symbol->rule)
    found = state_below(e->symbol->rule->value, depth + 1);
  if (!found) found = state_below(e->left, depth + 1);
  if (!found) found = state_below(e->right, depth + 1);
  for (int k = 0; k < e->argument_count && !found; k++)
    found = state_below(e->arguments[k].value, depth + 1);
  for (int k = 0; k < e->case_count && !found; k++) {
    found = state_below(e->cases[k].guard, depth + 1);
    if (!found) found = state_below(e->cases[k].value, depth + 1);
  }
  return found;
}

static void check_rest(sense_bench *b) {
  const symbol *late = b->law->rest ? state_below(b->law->rest->rule->value, 0) : NULL;
  char mend[400];
  if (!late) return;
  snprintf(mend, sizeof mend,
           "write the rule of `%.60s` above this line; where it reads `stretch`, leave `rest "
           "stretch` out and write `stretch - %.60s` in the force, below the rule",
           late->name, late->name);
  sense_say(b, DIAG_ONE_STEP_LATE, b->law->rest->rule->where, mend,
            "the rest stretch is made of `%s` as it was before its rule: the force is a step late, "
            "off by as much as `%s` changes in a step",
            late->name, late->name);
}

/* --- the walk --------------------------------------------------------------------------------- */

static void look_at_call(sense_bench *b, const expr *e) {
  if (e->symbol || e->argument_count == 0) return;
  switch (e->builtin) {
  case FUNCTION_SIN:
  case FUNCTION_COS:
  case FUNCTION_TAN:
    check_angle(b, e);
    break;
  case FUNCTION_SUM:
  case FUNCTION_MEAN:
    check_sum(b, e);
    break;
  default:
    break;
  }
}

static void look_at(sense_bench *b, const expr *e) {
  if (!e) return;
  if (e->kind == EXPR_CALL) look_at_call(b, e);
  if (e->kind == EXPR_BINARY) check_power(b, e);
  look_at(b, e->left);
  look_at(b, e->right);
  for (int k = 0; k < e->argument_count; k++)
    look_at(b, e->arguments[k].value);
  for (int k = 0; k < e->case_count; k++) {
    look_at(b, e->cases[k].guard);
    look_at(b, e->cases[k].value);
  }
}

void sense_check_text(sense_bench *b) {
  for (const stmt *s = b->law->tree->first; s; s = s->next) {
    look_at(b, s->value);
    look_at(b, s->when);
  }
  check_force_state(b);
  check_rest(b);
}
