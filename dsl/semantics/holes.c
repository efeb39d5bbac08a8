#include "dsl/semantics/holes.h"

#include <math.h>

#include "dsl/semantics/agreement.h"

/* --- what a hole must be -------------------------------------------------------------------------
   The check leaves `open` what it cannot know because of a hole. Here units go the other way, from
   where a value is used to the hole: of `force N = EA*stretch` the product is a force and `stretch`
   a number, so `EA` is a force; and with `constant EA = ?*s` above, the hole is a force over a
   length. Statements are looked at from the last to the first, since a name stands above its use;
   states are read above their rules, too, so there are some rounds. */

enum { MOST_ROUNDS = 4 };

typedef struct settling {
  checker *ck;
  bool changed;
  int depth, expansions;
} settling;

static void spread(settling *t, expr *e);

/* The literal 0 agrees with any unit, so it tells none. */
static bool tells_unit(const expr *e) {
  return !e->open && !(e->kind == EXPR_NUMBER && e->number == 0 && !e->unit_text);
}

static void want_of_name(const expr *e) {
  if (!e->symbol || e->symbol->kind == SYMBOL_ARGUMENT || e->symbol->kind == SYMBOL_OPTION) return;
  value *v = &entry_of(e->symbol)->type;
  if (!v->unknown || v->broken) return;
  v->dim = e->dim;
  v->shape = e->shape;
  v->unknown = false;
}

static void want(settling *t, expr *e, dimension dim, shape s) {
  if (!e || !e->open || t->depth >= MOST_DEPTH) return;
  e->open = false;
  e->dim = dim;
  e->shape = s;
  t->changed = true;
  t->depth++;
  if (e->kind == EXPR_NAME) want_of_name(e);
  spread(t, e);
  t->depth--;
}

/* One is as the other. */
static void want_alike(settling *t, expr *a, expr *b) {
  if (tells_unit(a)) want(t, b, a->dim, a->shape);
  if (tells_unit(b)) want(t, a, b->dim, b->shape);
}

/* The shape of a factor that stands beside a known one; false where it may be several: before a
   vector a number or a tensor, beside a tensor that need not be symmetric anything. */
static bool shape_of_factor(shape product, shape known, bool left, shape *factor) {
  *factor = known == SHAPE_SCALAR ? product : SHAPE_SCALAR;
  if (known == SHAPE_VECTOR) return !left;
  if (shape_is_tensor(known) && product != known) *factor = product;
  return known != SHAPE_GENERAL || product == SHAPE_VECTOR;
}

static void want_factor(settling *t, const expr *product, const expr *known, expr *factor) {
  shape s;
  if (!tells_unit(known)) return;
  if (shape_of_factor(product->shape, known->shape, factor == product->left, &s))
    want(t, factor, dim_div(product->dim, known->dim), s);
}

/* Of a sum or of cases, as they are; of a tensor that need not be symmetric one part may be. */
static void want_part(settling *t, const expr *whole, expr *part, const expr *other) {
  const bool tells =
      whole->shape != SHAPE_GENERAL || (other && !other->open && other->shape == SHAPE_TENSOR);
  if (tells) want(t, part, whole->dim, whole->shape);
}

static void want_base(settling *t, const expr *power) {
  const double twelfths = power->right->kind == EXPR_NUMBER ? 12 * power->right->number : 0;
  dimension dim;
  want(t, power->right, DIMENSIONLESS, SHAPE_SCALAR);
  if (twelfths <= 0 || twelfths > 1e3 || twelfths != nearbyint(twelfths)) return;
  if (dim_pow(power->dim, 12, (int)twelfths, &dim)) want(t, power->left, dim, SHAPE_SCALAR);
}

/* Where a tensor is as good as one that need not be symmetric: those come from families. */
static bool may_be_general(const settling *t, shape s) {
  return shape_is_tensor(s) && t->ck->tree->law == LAW_STATE;
}

static void spread_binary(settling *t, expr *e) {
  switch (e->binary) {
  case OP_OR:
  case OP_AND:
    want(t, e->left, DIMENSIONLESS, SHAPE_LOGICAL);
    want(t, e->right, DIMENSIONLESS, SHAPE_LOGICAL);
    return;
  case OP_ADD:
  case OP_SUB:
    want_part(t, e, e->left, e->right);
    want_part(t, e, e->right, e->left);
    return;
  case OP_MUL:
    want_factor(t, e, e->left, e->right);
    want_factor(t, e, e->right, e->left);
    return;
  case OP_DIV:
    if (tells_unit(e->right)) want(t, e->left, dim_mul(e->dim, e->right->dim), e->shape);
    if (tells_unit(e->left)) want(t, e->right, dim_div(e->left->dim, e->dim), SHAPE_SCALAR);
    return;
  case OP_CONTRACT:
    if (tells_unit(e->left) && !may_be_general(t, e->left->shape))
      want(t, e->right, dim_div(e->dim, e->left->dim), e->left->shape);
    if (tells_unit(e->right) && !may_be_general(t, e->right->shape))
      want(t, e->left, dim_div(e->dim, e->right->dim), e->right->shape);
    return;
  case OP_POW:
    want_base(t, e);
    return;
  default: /* a comparison */
    want_alike(t, e->left, e->right);
  }
}

static void want_all(settling *t, const expr *call, dimension dim, shape s) {
  for (int k = 0; k < call->argument_count; k++)
    want(t, call->arguments[k].value, dim, s);
}

static void spread_own_function(settling *t, const expr *e) {
  const stmt *s = e->symbol ? e->symbol->declared : NULL;
  if (s && s->value && t->expansions++ < MOST_EXPANSIONS) want(t, s->value, e->dim, e->shape);
}

static void spread_call(settling *t, const expr *e) {
  if (e->builtin < 0) {
    spread_own_function(t, e);
    return;
  }
  expr *first = e->arguments[0].value;
  dimension dim;
  switch (e->builtin) {
  case FUNCTION_SQRT:
    if (dim_pow(e->dim, 2, 1, &dim)) want(t, first, dim, SHAPE_SCALAR);
    return;
  case FUNCTION_CBRT:
    if (dim_pow(e->dim, 3, 1, &dim)) want(t, first, dim, SHAPE_SCALAR);
    return;
  case FUNCTION_ABS:
  case FUNCTION_MACAULAY:
  case FUNCTION_MIN:
  case FUNCTION_MAX:
    want_all(t, e, e->dim, SHAPE_SCALAR);
    return;
  case FUNCTION_SUM:
  case FUNCTION_MEAN:
  case FUNCTION_PREVIOUS:
  case FUNCTION_DEVIATOR:
    want(t, first, e->dim, e->shape);
    return;
  case FUNCTION_TENSOR:
  case FUNCTION_VECTOR:
    want_all(t, e, e->dim, SHAPE_SCALAR);
    return;
  case FUNCTION_TRACE:
    if (!may_be_general(t, SHAPE_TENSOR)) want(t, first, e->dim, SHAPE_TENSOR);
    return;
  case FUNCTION_PRINCIPAL:
  case FUNCTION_DEV:
  case FUNCTION_VON_MISES:
    want(t, first, e->dim, SHAPE_TENSOR);
    return;
  case FUNCTION_EXP:
  case FUNCTION_LOG:
  case FUNCTION_LOG10:
  case FUNCTION_SIN:
  case FUNCTION_COS:
  case FUNCTION_TAN:
  case FUNCTION_ASIN:
  case FUNCTION_ACOS:
  case FUNCTION_SINH:
  case FUNCTION_COSH:
  case FUNCTION_TANH:
    want_all(t, e, DIMENSIONLESS, SHAPE_SCALAR);
    return;
  default:
    return;
  }
}

/* From an expression that is known to its parts. */
static void spread(settling *t, expr *e) {
  switch (e->kind) {
  case EXPR_NUMBER:
  case EXPR_NAME:
  case EXPR_HOLE:
    return;
  case EXPR_UNARY:
    if (e->unary == OP_COMPONENT && may_be_general(t, SHAPE_TENSOR)) return;
    want(t, e->left, e->dim,
         e->unary == OP_COMPONENT ? SHAPE_TENSOR
         : e->unary == OP_AXIS    ? SHAPE_VECTOR
                                  : e->shape);
    return;
  case EXPR_BINARY:
    spread_binary(t, e);
    return;
  case EXPR_CALL:
    spread_call(t, e);
    return;
  case EXPR_CASES:
    for (int k = 0; k < e->case_count; k++)
      want_part(t, e, e->cases[k].value, NULL);
  }
}

static void settle(settling *t, expr *e) {
  if (!e) return;
  if (!e->open) spread(t, e);
  settle(t, e->left);
  settle(t, e->right);
  for (int k = 0; k < e->argument_count; k++)
    settle(t, e->arguments[k].value);
  for (int k = 0; k < e->case_count; k++) {
    if (e->cases[k].guard) want(t, e->cases[k].guard, DIMENSIONLESS, SHAPE_LOGICAL);
    settle(t, e->cases[k].value);
    settle(t, e->cases[k].guard);
  }
}

static void settle_statement(settling *t, stmt *s) {
  const value *v = s->symbol ? &entry_of(s->symbol)->type : NULL;
  const bool direction = s->kind == STMT_FLOW && s->returned;
  if (v && !v->unknown && !v->broken && s->kind != STMT_FUNCTION && !direction) {
    const bool rate = s->kind == STMT_RATE;
    want(t, s->value, rate ? dim_div(v->dim, dimension_of("s")) : v->dim, v->shape);
    want(t, s->in.lower, v->dim, v->shape);
    want(t, s->in.upper, v->dim, v->shape);
  }
  want(t, s->when, DIMENSIONLESS, SHAPE_LOGICAL);
  settle(t, s->value);
  settle(t, s->when);
}

static void settle_all(checker *ck) {
  settling t = {.ck = ck, .changed = true};
  for (int round = 0; round < MOST_ROUNDS && t.changed; round++) {
    t.changed = false;
    for (int k = ck->statement_count - 1; k >= 0; k--)
      settle_statement(&t, ck->statements[k]);
  }
}

/* --- in words --------------------------------------------------------------------------------- */

/* Where in its statement a hole stands. */
typedef enum role { ROLE_WHOLE, ROLE_VALUE, ROLE_LINE, ROLE_GUARD, ROLE_PART } role;

static const char *rule_words(checker *ck, const stmt *s) {
  const symbol_kind kind = s->symbol ? s->symbol->kind : SYMBOL_DEFINED;
  const char *of = kind == SYMBOL_STATE    ? "the rule of the state "
                   : kind == SYMBOL_DAMAGE ? "the rule of the damage "
                                           : "";
  return arena_printf(ck->memory, "%s`%s%s`", of, s->name, s->indexed ? "[j]" : "");
}

/* "the constant `EA`", "`force N`": what the statement says. */
static const char *statement_words(checker *ck, const stmt *s) {
  const char *name = s->name ? s->name : "";
  switch (s->kind) {
  case STMT_FIELD:
    return arena_printf(ck->memory, "the default of the field `%s`", name);
  case STMT_PARAMETER:
    return arena_printf(ck->memory, "the default of the parameter `%s`", name);
  case STMT_STATE:
    return arena_printf(ck->memory, "the initial value of the state `%s`", name);
  case STMT_CONSTANT:
  case STMT_FUNCTION:
  case STMT_OUTPUT:
    return arena_printf(ck->memory, "the %s `%s`", stmt_kind_name(s->kind), name);
  case STMT_YIELD:
    return arena_printf(ck->memory, "the yield function `%s`", name);
  case STMT_FLOW:
    return arena_printf(ck->memory, "the flow of `%s`", name);
  case STMT_RATE:
    return arena_printf(ck->memory, "the rate of the state `%s`", name);
  case STMT_DAMAGE:
  case STMT_DEFINITION:
    return rule_words(ck, s);
  default:
    return arena_printf(ck->memory, "`%s%s`", stmt_words(ck->memory, s), s->indexed ? "[j]" : "");
  }
}

/* "a force (N)"; NULL where nothing tells. */
static const char *type_words(checker *ck, const stmt *s, const expr *hole, role in) {
  if (in == ROLE_GUARD) return "true or false";
  const bool damage = s->symbol && s->symbol->kind == SYMBOL_DAMAGE;
  if (damage && in != ROLE_PART) return "a pure number from 0 to 1";
  if (s->kind == STMT_YIELD && in != ROLE_PART) return "a number, below 0 where nothing flows";
  if (s->kind == STMT_FORCE_STATE && in != ROLE_PART) return "a force (N), or N/m^6";
  if (hole->open) return NULL;
  if (in != ROLE_PART && s->kind == STMT_MOMENT) return "a moment (N*m)";
  if (in != ROLE_PART && s->kind == STMT_ENERGY && dim_equal(hole->dim, dimension_of("J")))
    return "an energy (J)";
  if (hole->shape == SHAPE_LOGICAL) return shape_words(hole->shape);
  const char *unit_words = describe(ck, hole->dim);
  if (hole->shape == SHAPE_SCALAR) return unit_words;
  return arena_printf(ck->memory, "%s, %s", shape_words(hole->shape), unit_words);
}

static void report_hole(checker *ck, const stmt *s, const expr *hole, role in) {
  static const char *const parts[] = {[ROLE_WHOLE] = "",
                                      [ROLE_VALUE] = "a case of ",
                                      [ROLE_LINE] = "a case of ",
                                      [ROLE_GUARD] = "a condition of ",
                                      [ROLE_PART] = "a part of "};
  const char *what = statement_words(ck, s), *type = type_words(ck, s, hole, in);
  diag_report(ck->d, DIAG_HOLE, hole->where, "%s%s is still to be written%s%s%s", parts[in], what,
              type ? ": " : "", type ? type : "", in == ROLE_LINE ? ", and when it applies" : "");
  if (!type) diag_hint(ck->d, "nothing that is written yet tells its unit");
}

static void report_in(checker *ck, const stmt *s, const expr *e, role in) {
  if (!e) return;
  const bool is_choice = e->kind == EXPR_BINARY && e->left->symbol &&
                         e->left->symbol->kind == SYMBOL_OPTION && e->right->kind == EXPR_HOLE;
  if (e->kind == EXPR_HOLE) report_hole(ck, s, e, in);
  if (is_choice)
    diag_report(ck->d, DIAG_HOLE, e->right->where,
                "a choice of the option `%s` is still to be written", e->left->name);
  const role below =
      in == ROLE_GUARD && (e->binary == OP_AND || e->binary == OP_OR) ? in : ROLE_PART;
  report_in(ck, s, e->left, below);
  if (!is_choice) report_in(ck, s, e->right, below);
  for (int k = 0; k < e->argument_count; k++)
    report_in(ck, s, e->arguments[k].value, ROLE_PART);
  for (int k = 0; k < e->case_count; k++) {
    const case_line *line = &e->cases[k];
    report_in(ck, s, line->value, in == ROLE_PART ? in : line->open ? ROLE_LINE : ROLE_VALUE);
    report_in(ck, s, line->guard, ROLE_GUARD);
  }
}

void report_holes(checker *ck) {
  if (!ck->holes) return;
  settle_all(ck);
  for (int k = 0; k < ck->statement_count; k++) {
    const stmt *s = ck->statements[k];
    report_in(ck, s, s->value, ROLE_WHOLE);
    report_in(ck, s, s->in.lower, ROLE_PART);
    report_in(ck, s, s->in.upper, ROLE_PART);
    report_in(ck, s, s->when, ROLE_GUARD);
  }
}
