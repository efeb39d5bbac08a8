#include "dsl/semantics/formula.h"

#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/semantics/agreement.h"
#include "dsl/semantics/names.h"
#include "dsl/semantics/types.h"
#include "dsl/syntax/parse.h"

enum { MOST_STEPS = 500, LARGEST_EXPONENT = 16 };

/* X(code, value); a, b, c are values of earlier steps */
#define FORMULA_STEPS(X)                                                                           \
  X(NUMBER, s->number)                                                                             \
  X(VARIABLE, variables[s->a])                                                                     \
  X(ADD, a + b)                                                                                    \
  X(SUB, a - b)                                                                                    \
  X(MUL, a *b)                                                                                     \
  X(DIV, a / b)                                                                                    \
  X(POW, pl_pow(a, b))                                                                             \
  X(NEG, -a) X(ONE, s->of_one(a)) X(TWO, s->of_two(a, b)) X(LT, a < b) X(LE, a <= b) X(EQ, a == b) \
      X(AND, (a != 0) & (b != 0)) X(OR, (a != 0) | (b != 0)) X(NOT, a == 0)                        \
          X(SELECT, a != 0 ? b : c)

typedef enum step_code {
#define X(code, value) STEP_##code,
  FORMULA_STEPS(X)
#undef X
} step_code;

typedef struct step {
  step_code code;
  int a, b, c; /* steps; of a variable its position */
  double number;
  double (*of_one)(double);
  double (*of_two)(double, double);
} step;

struct formula {
  dimension dim;
  bool zero;
  unsigned reads; /* a bit for each variable */
  int result, count;
  step *steps;
};

static double value_of(const step *s, const double *variables, double a, double b, double c) {
  switch (s->code) {
#define X(code, value)                                                                             \
  case STEP_##code:                                                                                \
    return (double)(value);
    FORMULA_STEPS(X)
#undef X
  }
  return NAN;
}

double formula_value(const formula *f, const double *variables) {
  double values[MOST_STEPS];
  for (int k = 0; k < f->count; k++) {
    const step *s = &f->steps[k];
    const bool leaf = s->code <= STEP_VARIABLE;
    values[k] = leaf ? value_of(s, variables, 0, 0, 0)
                     : value_of(s, variables, values[s->a], values[s->b], values[s->c]);
  }
  return values[f->result];
}

dimension formula_dimension(const formula *f) {
  return f->dim;
}

bool formula_is_zero(const formula *f) {
  return f->zero;
}

bool formula_reads(const formula *f, int variable) {
  return f->reads >> variable & 1;
}

/* --- from the tree to steps ------------------------------------------------------------------- */

typedef struct flattening {
  formula *f;
  bool too_long;
} flattening;

static bool is_number(const flattening *t, int k) {
  return t->f->steps[k].code == STEP_NUMBER;
}

static int add_step(flattening *t, step s) {
  t->too_long |= t->f->count == MOST_STEPS;
  if (t->too_long) return 0;
  t->f->steps[t->f->count] = s;
  return t->f->count++;
}

static int number(flattening *t, double x) {
  return add_step(t, (step){.code = STEP_NUMBER, .number = x});
}

/* Of numbers alone it is a number. */
static int operation(flattening *t, step s) {
  if (t->too_long || !is_number(t, s.a) || !is_number(t, s.b) || !is_number(t, s.c))
    return add_step(t, s);
  const step *all = t->f->steps;
  return number(t, value_of(&s, NULL, all[s.a].number, all[s.b].number, all[s.c].number));
}

static int one(flattening *t, step_code code, int a) {
  return operation(t, (step){.code = code, .a = a, .b = a, .c = a});
}

static int two(flattening *t, step_code code, int a, int b) {
  return operation(t, (step){.code = code, .a = a, .b = b, .c = a});
}

static int choose(flattening *t, int guard, int yes, int no) {
  return operation(t, (step){.code = STEP_SELECT, .a = guard, .b = yes, .c = no});
}

static int call_one(flattening *t, double (*f)(double), int a) {
  return operation(t, (step){.code = STEP_ONE, .a = a, .b = a, .c = a, .of_one = f});
}

static int call_two(flattening *t, double (*f)(double, double), int a, int b) {
  return operation(t, (step){.code = STEP_TWO, .a = a, .b = b, .c = a, .of_two = f});
}

static int whole_power(flattening *t, int base, int n) {
  int result = -1;
  for (int square = base; n > 0; n >>= 1) {
    if (n & 1) result = result < 0 ? square : two(t, STEP_MUL, result, square);
    if (n > 1) square = two(t, STEP_MUL, square, square);
  }
  return result < 0 ? number(t, 1) : result;
}

/* As laws are compiled (generator/ir): small whole and half exponents by products and a root. */
static int power(flattening *t, int base, int exponent) {
  if (t->too_long || !is_number(t, exponent)) return two(t, STEP_POW, base, exponent);
  const double n = t->f->steps[exponent].number, size = fabs(n);
  const bool half = size == floor(size) + 0.5;
  int result;
  if (size == 1.0 / 3.0)
    result = call_one(t, pl_cbrt, base);
  else if (size <= LARGEST_EXPONENT && (size == floor(size) || half))
    result = whole_power(t, base, (int)size);
  else
    return two(t, STEP_POW, base, exponent);
  if (half) result = two(t, STEP_MUL, result, call_one(t, pl_sqrt, base));
  return n < 0 ? two(t, STEP_DIV, number(t, 1), result) : result;
}

static int flatten(flattening *t, const expr *e);

static int flatten_binary(flattening *t, const expr *e) {
  static const struct {
    step_code by;
    operator_reading reading;
  } computed[] = {
#define X(code, text, operation, reading) [OP_##code] = {STEP_##operation, reading},
      TREE_BINARY_OPERATORS(X)
#undef X
  };
  const step_code by = computed[e->binary].by;
  const operator_reading reading = computed[e->binary].reading;
  const int a = flatten(t, e->left), b = flatten(t, e->right);
  if (by == STEP_POW) return power(t, a, b);
  const int result = reading == READ_EXCHANGED ? two(t, by, b, a) : two(t, by, a, b);
  return reading == READ_NEGATED ? one(t, STEP_NOT, result) : result;
}

static int flatten_number(flattening *t, const expr *e) {
  unit u = {DIMENSIONLESS, 1};
  const char *bad;
  size_t length;
  if (e->unit_text) (void)unit_parse(e->unit_text, strlen(e->unit_text), &u, &bad, &length);
  return number(t, e->number * u.factor);
}

static int flatten_name(flattening *t, const expr *e) {
  if (e->symbol->kind == SYMBOL_QUANTITY) return number(t, M_PI);
  t->f->reads |= 1u << e->symbol->index;
  return add_step(t, (step){.code = STEP_VARIABLE, .a = e->symbol->index});
}

static int flatten_call(flattening *t, const expr *e) {
  const builtin_function_info *f = &builtin_functions[e->builtin];
  int a = flatten(t, e->arguments[0].value);
  if (f->of_one) return call_one(t, f->of_one, a);
  for (int k = 1; k < e->argument_count; k++)
    a = call_two(t, f->of_many ? f->of_many : pl_atan2, a, flatten(t, e->arguments[k].value));
  return a;
}

/* A comparison with NaN is false: where an operand of a guard is NaN, so is the value. */
static int keep_nan(flattening *t, const expr *guard, int of) {
  if (guard->kind == EXPR_UNARY) return keep_nan(t, guard->left, of);
  if (guard->kind != EXPR_BINARY) return of;
  const expr *sides[] = {guard->left, guard->right};
  for (int k = 0; k < 2; k++) {
    if (sides[k]->shape == SHAPE_LOGICAL) {
      of = keep_nan(t, sides[k], of);
    } else if (sides[k]->kind != EXPR_NUMBER && sides[k]->kind != EXPR_NAME) {
      const int x = flatten(t, sides[k]);
      of = choose(t, two(t, STEP_EQ, x, x), of, x);
    }
  }
  return of;
}

/* From the last line up, so that the first true line wins. */
static int flatten_cases(flattening *t, const expr *e) {
  int chosen = flatten(t, e->cases[e->case_count - 1].value);
  for (int k = e->case_count - 2; k >= 0; k--)
    chosen = choose(t, flatten(t, e->cases[k].guard), flatten(t, e->cases[k].value), chosen);
  for (int k = 0; k < e->case_count - 1; k++)
    chosen = keep_nan(t, e->cases[k].guard, chosen);
  return chosen;
}

static int flatten_unary(flattening *t, const expr *e) {
  const int a = flatten(t, e->left);
  return e->unary == OP_PLUS ? a : one(t, e->unary == OP_NEG ? STEP_NEG : STEP_NOT, a);
}

static int flatten(flattening *t, const expr *e) {
  if (t->too_long) return 0;
  switch (e->kind) {
  case EXPR_NUMBER:
    return flatten_number(t, e);
  case EXPR_NAME:
    return flatten_name(t, e);
  case EXPR_UNARY:
    return flatten_unary(t, e);
  case EXPR_BINARY:
    return flatten_binary(t, e);
  case EXPR_CALL:
    return flatten_call(t, e);
  case EXPR_CASES:
    return flatten_cases(t, e);
  case EXPR_HOLE: /* refused before */
    return 0;
  }
  return 0;
}

/* --- what a formula cannot have --------------------------------------------------------------- */

static bool is_of_numbers(checker *ck, const expr *e) {
  const int k = builtin_function_find(e->name);
  if (k < 0) return true; /* the check tells */
  const builtin_function_info *f = &builtin_functions[k];
  if (!f->of_one && !f->of_many && k != FUNCTION_ATAN2) {
    complain(ck, DIAG_UNKNOWN_FUNCTION, e->name_where,
             "`%s` is for laws, a formula does not have it", e->name);
    return false;
  }
  if (!f->of_many || e->argument_count > 1) return true;
  complain(ck, DIAG_ARGUMENTS, e->where, "`%s` needs two values or more", e->name);
  return false;
}

static bool is_own_name(checker *ck, const expr *e) {
  if (!e->indexed && !e->primed) return true;
  complain(ck, DIAG_PLACEMENT, e->where, "a formula has no neighbours to take `%s` from", e->name);
  diag_hint(ck->d, "write `%s`", e->name);
  return false;
}

static bool is_written(checker *ck, const expr *e) {
  complain(ck, DIAG_HOLE, e->where, "a part of this formula is still to be written");
  return false;
}

/* Nothing that needs a law; false after messages. */
static bool stands_alone(checker *ck, const expr *e) {
  bool good = true;
  if (!e) return true;
  if (e->kind == EXPR_NAME) good = is_own_name(ck, e);
  if (e->kind == EXPR_CALL) good = is_of_numbers(ck, e);
  if (e->kind == EXPR_HOLE) good = is_written(ck, e);
  good = stands_alone(ck, e->left) && good;
  good = stands_alone(ck, e->right) && good;
  for (int k = 0; k < e->argument_count; k++)
    good = stands_alone(ck, e->arguments[k].value) && good;
  for (int k = 0; k < e->case_count; k++)
    good = stands_alone(ck, e->cases[k].value) && stands_alone(ck, e->cases[k].guard) && good;
  return good;
}

/* --- reading ---------------------------------------------------------------------------------- */

static void enter_variables(checker *ck, const formula_scope *scope) {
  ck->now = -1; /* above the formula */
  names_add_quantity(ck, QUANTITY_PI);
  ck->now = 0;
  for (int k = 0; k < scope->count; k++) {
    const formula_variable *v = &scope->variables[k];
    if (!*v->name) continue;
    entry *e = names_add(ck, SPACE_QUANTITIES, v->name,
                         (symbol){.kind = SYMBOL_ARGUMENT, .name = v->name, .index = k});
    e->type = scalar_of(dimension_of(v->unit), ON_BODY);
    e->known = true;
  }
}

static bool check(checker *ck, const formula_scope *scope, expr *e, const char *unit_text,
                  const char *what, value *v) {
  names_open(ck);
  enter_variables(ck, scope);
  const int errors = ck->d->errors;
  if (stands_alone(ck, e)) *v = check_number(ck, e);
  if (!v->broken && unit_text) expect(ck, e, *v, dimension_of(unit_text), SHAPE_SCALAR, what);
  names_end(ck);
  return ck->d->errors == errors;
}

static const formula *flat(checker *ck, const expr *e, value v) {
  step room[MOST_STEPS];
  formula *f = arena_alloc(ck->memory, sizeof *f);
  *f = (formula){.dim = v.dim, .zero = v.zero, .steps = room};
  flattening t = {.f = f};
  f->result = flatten(&t, e);
  if (t.too_long) {
    complain(ck, DIAG_TOO_LONG, e->where, "this formula has more than %d operations", MOST_STEPS);
    return NULL;
  }
  f->steps = arena_alloc(ck->memory, (size_t)f->count * sizeof *f->steps);
  memcpy(f->steps, room, (size_t)f->count * sizeof *f->steps);
  return f;
}

const formula *formula_read(arena *memory, source_set *sources, span where,
                            const formula_scope *scope, const char *unit_text, const char *what,
                            diagnostics *d) {
  tree stub = {.law = LAW_CENTRAL_BOND};
  law of_none = {.tree = &stub};
  checker ck = {.memory = memory,
                .tree = &stub,
                .sources = sources,
                .d = d,
                .law = &of_none,
                .alone = scope->words};
  value v = BROKEN;
  expr *e = parse_expression(memory, sources, where, d);
  return e && check(&ck, scope, e, unit_text, what, &v) ? flat(&ck, e, v) : NULL;
}
