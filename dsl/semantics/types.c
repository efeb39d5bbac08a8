#include "dsl/semantics/types.h"

#include <math.h>

#include "dsl/semantics/calls.h"
#include "dsl/semantics/literals.h"
#include "dsl/semantics/names.h"
#include "dsl/semantics/order.h"

static const value UNKNOWN = {.unknown = true};

/* --- kinds of expression ---------------------------------------------------------------------- */

static value check_number_literal(checker *ck, expr *e) {
  value v = scalar_of(DIMENSIONLESS, ON_NOTHING);
  v.zero = e->number == 0 && !e->unit_text;
  if (!e->unit_text) return v;
  unit u;
  if (!read_unit(ck, e->unit_text, e->unit_where, &u)) return BROKEN;
  v.dim = u.dim;
  return v;
}

static value refuse(checker *ck, const expr *e, const char *message, const char *hint) {
  complain(ck, DIAG_PLACEMENT, e->where, message, e->name);
  if (hint) diag_hint(ck->d, hint, e->name);
  return BROKEN;
}

static bool is_displacement(const symbol *s) {
  return s->kind == SYMBOL_QUANTITY && s->index == QUANTITY_U;
}

/* x, x[j], x' and x'[j] of a state law: what lives where decides which of them there are. What is
   fixed on a bond, such as s, may stand without [j]: it is that of the bond at hand. */
static value check_family_name(checker *ck, expr *e, value v) {
  if (v.unknown && ck->function) return v;
  if (v.unknown) { /* a hole may live anywhere */
    v.whole = !e->indexed && v.place == ON_NEIGHBOUR;
    if (e->indexed || e->primed) v.place = ON_NEIGHBOUR;
    return v;
  }
  switch (v.place) {
  case ON_NOTHING:
  case ON_BODY:
  case ON_POINT:
  case ON_TIP:
    if (e->indexed) return refuse(ck, e, "`%s` is the same for every neighbour", "write `%s`");
    break;
  case ON_PARTICLE:
    if (e->primed)
      return refuse(ck, e, "`%s` belongs to a particle and has no two sides", "write `%s[j]`");
    if (e->indexed) v.place = ON_NEIGHBOUR;
    break;
  case ON_BOND:
    if (e->primed) return refuse(ck, e, "`%s` is the same seen from both ends", "write `%s[j]`");
    v.whole = !e->indexed && !is_fixed(e->symbol);
    break;
  case ON_NEIGHBOUR:
    if (e->primed && !e->indexed)
      return refuse(ck, e, "`%s'` needs its neighbour", "write `%s'[j]`");
    v.whole = !e->indexed;
    break;
  }
  if (e->primed && v.place < ON_PARTICLE)
    return refuse(ck, e, "`%s` is the same for every neighbour", "write `%s`");
  if (is_displacement(e->symbol)) v.place = ON_NEIGHBOUR; /* loops over bonds know it */
  return v;
}

/* The quantity of a name; NULL after a message. */
static entry *quantity_of(checker *ck, expr *e) {
  entry *found = names_resolve(ck, e);
  if (!found || !names_is_below(ck, found)) return found;
  report_undefined(ck, e, found);
  return NULL;
}

static value check_name(checker *ck, expr *e) {
  entry *found = quantity_of(ck, e);
  if (!found) return BROKEN;
  e->symbol = &found->symbol;
  if (found->symbol.kind == SYMBOL_OPTION) {
    const stmt *s = found->symbol.declared;
    complain(ck, DIAG_OPTION, e->where, "`%s` is an option and has no value of its own", e->name);
    if (s->word_count) diag_hint(ck->d, "compare it: `%s == %s`", e->name, s->words[0]);
    return BROKEN;
  }
  if ((e->indexed || e->primed) && is_single(ck)) {
    complain(ck, DIAG_PLACEMENT, e->where, "a %s law has no neighbours to take `%s` from",
             law_word(ck), e->name);
    diag_hint(ck->d, "write `%s`; only a state law has a family", e->name);
    return BROKEN;
  }
  if ((e->indexed || e->primed) && found->symbol.kind == SYMBOL_ARGUMENT) {
    complain(ck, DIAG_PLACEMENT, e->where,
             "a function takes one value as its argument, not a family");
    diag_hint(ck->d, "write `%s` here and `x[j]` in the call", e->name);
    return BROKEN;
  }
  if (!found->known) return UNKNOWN;
  value v = found->type;
  if (is_single(ck) || v.broken || found->symbol.kind == SYMBOL_ARGUMENT) return v;
  return check_family_name(ck, e, v);
}

/* v[x] */
static value check_axis(checker *ck, expr *e) {
  const value v = check_value(ck, e->left);
  if (v.broken || v.unknown) return v;
  if (v.shape == SHAPE_VECTOR) return scalar_of(v.dim, v.place);
  const char axis = vector_axis(e->component);
  complain(ck, DIAG_SHAPE, e->where, "`%s` is %s and has no component `%c`", e->left->name,
           shape_words(v.shape), axis);
  if (shape_is_tensor(v.shape))
    diag_hint(ck->d, "a tensor's component has two axes: `%s[%c,%c]`", e->left->name, axis, axis);
  else
    diag_hint(ck->d, "components are those of vectors, such as `direction[x]`");
  return BROKEN;
}

static value check_component(checker *ck, expr *e) {
  value v = check_value(ck, e->left);
  if (v.broken || v.unknown) return v;
  if (shape_is_tensor(v.shape)) {
    v.shape = SHAPE_SCALAR;
    v.deviator = false;
    return v;
  }
  complain(ck, DIAG_SHAPE, e->where, "`%s` is %s and has no component `%c,%c`", e->left->name,
           shape_words(v.shape), tensor_axis(e->component, 0), tensor_axis(e->component, 1));
  if (v.shape == SHAPE_VECTOR)
    diag_hint(ck->d, "a vector's component has one axis: `%s[%c]`", e->left->name,
              tensor_axis(e->component, 0));
  else
    diag_hint(ck->d, "components are those of stresses, strains and other tensors");
  return BROKEN;
}

static value check_unary(checker *ck, expr *e) {
  if (e->unary == OP_COMPONENT) return check_component(ck, e);
  if (e->unary == OP_AXIS) return check_axis(ck, e);
  if (e->unary != OP_NOT) return check_number(ck, e->left);
  value v = check_guard(ck, e->left);
  return v;
}

/* Exponents of quantities with a unit: numbers only, so that the unit is known. */
static bool number_of(const expr *e, double *number) {
  double a, b;
  switch (e->kind) {
  case EXPR_NUMBER:
    *number = e->number;
    return !e->unit_text;
  case EXPR_UNARY:
    if (e->unary == OP_NOT || !number_of(e->left, &a)) return false;
    *number = e->unary == OP_NEG ? -a : a;
    return true;
  case EXPR_BINARY:
    if (!number_of(e->left, &a) || !number_of(e->right, &b)) return false;
    switch (e->binary) {
    case OP_ADD:
      *number = a + b;
      return true;
    case OP_SUB:
      *number = a - b;
      return true;
    case OP_MUL:
      *number = a * b;
      return true;
    case OP_DIV:
      *number = a / b;
      return true;
    default:
      return false;
    }
  default:
    return false;
  }
}

static value check_power(checker *ck, expr *e, value base, value exponent) {
  if (base.broken || exponent.broken) return BROKEN;
  if (!base.unknown && base.shape != SHAPE_SCALAR) {
    complain(ck, DIAG_SHAPE, e->where, "%s has no powers", shape_words(base.shape));
    if (base.shape == SHAPE_BENDING || base.shape == SHAPE_VECTOR)
      diag_hint(ck->d, "take its magnitude first: `norm(%s)`", written(ck, e->left, "..."));
    return BROKEN;
  }
  if (!expect(ck, e->right, exponent, DIMENSIONLESS, SHAPE_SCALAR, "an exponent")) return BROKEN;
  value v = joined(ck, base, exponent);
  v.zero = false;
  if (base.unknown || dim_is_none(base.dim)) return v;
  if (exponent.unknown && ck->holes) {
    v.unknown = true;
    return v;
  }
  double number, twelfths;
  if (!number_of(e->right, &number)) {
    complain(ck, DIAG_UNITS, e->right->where,
             "%s is %s, so its exponent must be written as a number",
             quoted(ck, e->left, "the base"), describe(ck, base.dim));
    diag_hint(ck->d, "divide by a reference value first: `(x/x_0)**p`");
    return BROKEN;
  }
  twelfths = 12 * number;
  bool exact = fabs(twelfths) < 1e6 && fabs(twelfths - nearbyint(twelfths)) < 1e-9;
  if (exact && dim_pow(base.dim, (int)nearbyint(twelfths), 12, &v.dim)) return v;
  complain(ck, DIAG_UNITS, e->where, "%s to the power of %g has no exact unit",
           describe(ck, base.dim), number);
  return BROKEN;
}

/* Of two tensors, one of which need not be symmetric, or of a tensor and a vector behind it;
   SHAPE_SCALAR: there is none. That of two symmetric tensors is hardly ever meant: `product`. */
static shape matrix_product(shape a, shape b) {
  if (shape_is_tensor(a) && b == SHAPE_VECTOR) return SHAPE_VECTOR;
  const bool general = a == SHAPE_GENERAL || b == SHAPE_GENERAL;
  return general && shape_is_tensor(a) && shape_is_tensor(b) ? SHAPE_GENERAL : SHAPE_SCALAR;
}

static value check_product(checker *ck, expr *e, value a, value b) {
  if (a.broken || b.broken) return BROKEN;
  bool divide = e->binary == OP_DIV;
  value v = {.dim = divide ? dim_div(a.dim, b.dim) : dim_mul(a.dim, b.dim),
             .place = place_join(ck, a.place, b.place)};
  if (a.unknown || b.unknown) {
    v.unknown = true;
    return v;
  }
  if (ck->holes && shape_is_tensor(a.shape) && shape_is_tensor(b.shape) && !divide) {
    v.unknown = true; /* what a hole is part of may be symmetric or not */
    return v;
  }
  const shape of_two = divide ? SHAPE_SCALAR : matrix_product(a.shape, b.shape);
  if (of_two != SHAPE_SCALAR) {
    v.shape = of_two;
    return v;
  }
  v.shape = a.shape != SHAPE_SCALAR ? a.shape : b.shape;
  v.deviator = a.deviator || b.deviator;
  if (divide && b.shape != SHAPE_SCALAR) {
    complain(ck, DIAG_SHAPE, e->right->where, "%s cannot be divided by", shape_words(b.shape));
    diag_hint(ck->d, "divide by its magnitude: `norm(%s)`", written(ck, e->right, "..."));
    return BROKEN;
  }
  if (a.shape != SHAPE_SCALAR && b.shape != SHAPE_SCALAR) {
    const char *left = written(ck, e->left, "a"), *right = written(ck, e->right, "b");
    complain(ck, DIAG_SHAPE, e->where, "the product of %s and %s is not defined",
             shape_words(a.shape), shape_words(b.shape));
    if (a.shape == SHAPE_VECTOR && b.shape == SHAPE_VECTOR)
      diag_hint(ck->d, "write `dot(%s, %s)` or `cross(%s, %s)`", left, right, left, right);
    else if (a.shape == SHAPE_VECTOR && shape_is_tensor(b.shape))
      diag_hint(ck->d, "the tensor stands first: `%s*%s`",
                b.shape == SHAPE_GENERAL ? arena_printf(ck->memory, "transpose(%s)", right) : right,
                left);
    else if (a.shape == SHAPE_TENSOR && b.shape == SHAPE_TENSOR)
      diag_hint(ck->d,
                "for the scalar product write `%s : %s`, for the symmetric one "
                "`product(%s, %s)`",
                left, right, left, right);
    else if (a.shape == b.shape)
      diag_hint(ck->d, "for the scalar product write `%s : %s`", left, right);
    return BROKEN;
  }
  return v;
}

static value check_contraction(checker *ck, expr *e, value a, value b) {
  if (a.broken || b.broken) return BROKEN;
  bool unknown = a.unknown || b.unknown;
  const bool tensors = shape_is_tensor(a.shape) && shape_is_tensor(b.shape);
  if (!unknown && !tensors && (a.shape != b.shape || a.shape == SHAPE_SCALAR)) {
    complain(ck, DIAG_SHAPE, e->where,
             "`:` needs two tensors, vectors or bending quantities, not %s and %s",
             shape_words(a.shape), shape_words(b.shape));
    if (a.shape == SHAPE_SCALAR || b.shape == SHAPE_SCALAR) diag_hint(ck->d, "write `*`");
    return BROKEN;
  }
  value v = scalar_of(dim_mul(a.dim, b.dim), place_join(ck, a.place, b.place));
  v.unknown = unknown;
  return v;
}

/* --- logic ------------------------------------------------------------------------------------ */

static value logical(placement where) {
  return (value){.shape = SHAPE_LOGICAL, .place = where};
}

static bool names_option(const checker *ck, const expr *e) {
  if (e->kind != EXPR_NAME) return false;
  const entry *found = names_find(ck, SPACE_QUANTITIES, e->name);
  return found && found->symbol.kind == SYMBOL_OPTION;
}

/* onset == rankine: decided when the law is compiled. */
static value check_choice(checker *ck, expr *e) {
  expr *left = names_option(ck, e->left) ? e->left : e->right;
  expr *right = left == e->left ? e->right : e->left;
  entry *option = quantity_of(ck, left);
  if (!option) return BROKEN;
  const stmt *s = option->symbol.declared;
  left->symbol = &option->symbol;
  left->shape = right->shape = SHAPE_LOGICAL;
  if (right->kind == EXPR_HOLE) {
    ck->holes = right->open = true;
    return logical(ON_NOTHING);
  }
  if ((e->binary != OP_EQ && e->binary != OP_NE) || right->kind != EXPR_NAME || right->indexed) {
    complain(ck, DIAG_OPTION, e->where, "option `%s` can only be compared with one of its choices",
             s->name);
    if (s->word_count) diag_hint(ck->d, "write `%s == %s`", s->name, s->words[0]);
    return BROKEN;
  }
  entry *choice = names_find_choice(ck, &option->symbol, right->name);
  if (choice) {
    right->symbol = &choice->symbol;
    return logical(ON_NOTHING);
  }
  complain(ck, DIAG_OPTION, right->where, "option `%s` has no choice `%s`", s->name, right->name);
  diag_note(ck->d, s->name_where, "its choices are given here");
  diag_suggest(ck->d, right->name, s->words, s->word_count);
  return BROKEN;
}

static value check_comparison(checker *ck, expr *e) {
  if (names_option(ck, e->left) || names_option(ck, e->right)) return check_choice(ck, e);
  value a = check_value(ck, e->left);
  value b = check_value(ck, e->right);
  if (a.broken || b.broken) return BROKEN;
  bool chained =
      e->left->kind == EXPR_BINARY && e->left->binary >= OP_EQ && e->left->binary <= OP_GE;
  if (chained && a.shape == SHAPE_LOGICAL) {
    complain(ck, DIAG_SHAPE, e->where, "comparisons cannot be chained");
    diag_hint(ck->d, "write `a < b and b < c`");
    return BROKEN;
  }
  value common = agree(ck, e->where, e->left, a, e->right, b, "compared");
  if (common.broken) return BROKEN;
  if (!common.unknown && common.shape != SHAPE_SCALAR) {
    complain(ck, DIAG_SHAPE, e->where, "%s cannot be compared",
             common.shape == SHAPE_LOGICAL ? "what is true or false" : shape_words(common.shape));
    if (common.shape == SHAPE_BENDING || common.shape == SHAPE_VECTOR)
      diag_hint(ck->d, "compare magnitudes: `norm(...)`");
    return BROKEN;
  }
  return logical(common.place);
}

static value check_binary(checker *ck, expr *e) {
  if (e->binary >= OP_EQ && e->binary <= OP_GE) return check_comparison(ck, e);
  if (e->binary == OP_AND || e->binary == OP_OR) {
    value a = check_guard(ck, e->left), b = check_guard(ck, e->right);
    return a.broken || b.broken ? BROKEN : logical(place_join(ck, a.place, b.place));
  }
  value a = check_number(ck, e->left);
  value b = check_number(ck, e->right);
  switch (e->binary) {
  case OP_ADD:
    return agree(ck, e->where, e->left, a, e->right, b, "added");
  case OP_SUB:
    return agree(ck, e->where, e->left, a, e->right, b, "subtracted");
  case OP_POW:
    return check_power(ck, e, a, b);
  case OP_CONTRACT:
    return check_contraction(ck, e, a, b);
  default:
    return check_product(ck, e, a, b);
  }
}

/* --- cases ------------------------------------------------------------------------------------ */

static void check_otherwise(checker *ck, const expr *e) {
  for (int i = 0; i < e->case_count; i++) {
    if (e->cases[i].guard || e->cases[i].open) continue;
    if (i + 1 == e->case_count) return;
    complain(ck, DIAG_CASES, e->cases[i + 1].where, "this line can never be chosen");
    diag_note(ck->d, e->cases[i].where, "`otherwise` takes all that is left");
    diag_hint(ck->d, "`otherwise` stands on the last line");
    return;
  }
  if (e->case_count && e->cases[e->case_count - 1].open) return;
  span last = e->case_count ? e->cases[e->case_count - 1].where : e->where;
  complain(ck, DIAG_CASES, last, "these cases do not end with `otherwise`");
  diag_hint(ck->d, "add a last line: `| value otherwise`");
}

static value check_cases(checker *ck, expr *e) {
  value result = {.zero = true};
  placement guards = ON_NOTHING;
  bool broken = false;
  expr *sample = NULL; /* the first value whose unit is known */
  for (int i = 0; i < e->case_count; i++) {
    case_line *line = &e->cases[i];
    value v = check_value(ck, line->value);
    value guard = line->guard ? check_guard(ck, line->guard) : logical(ON_NOTHING);
    guards = place_join(ck, guards, guard.place);
    broken |= v.broken || guard.broken;
    if (broken) continue;
    result = agree(ck, line->value->where, sample ? sample : line->value, result, line->value, v,
                   "values of the same cases");
    broken |= result.broken;
    if (!sample && !v.zero && !v.unknown) sample = line->value;
  }
  check_otherwise(ck, e);
  if (broken) return BROKEN;
  for (int i = 0; i < e->case_count; i++) {
    e->cases[i].value->dim = result.dim;
    e->cases[i].value->shape = result.shape;
  }
  result.place = place_join(ck, result.place, guards);
  return result;
}

/* --- what is still to be written -------------------------------------------------------------- */

/* Agrees with everything; reported when all else is known (holes.h). */
static value check_hole(checker *ck, expr *e) {
  unit u;
  ck->holes = true;
  if (!e->unit_text)
    return (value){.unknown = true, .place = ck->in_reduction ? ON_NEIGHBOUR : ON_NOTHING};
  return read_unit(ck, e->unit_text, e->unit_where, &u) ? scalar_of(u.dim, ON_NOTHING) : BROKEN;
}

/* --- entry points ----------------------------------------------------------------------------- */

static value check_kind(checker *ck, expr *e) {
  switch (e->kind) {
  case EXPR_NUMBER:
    return check_number_literal(ck, e);
  case EXPR_NAME:
    return check_name(ck, e);
  case EXPR_UNARY:
    return check_unary(ck, e);
  case EXPR_BINARY:
    return check_binary(ck, e);
  case EXPR_CALL:
    return check_call(ck, e);
  case EXPR_CASES:
    return check_cases(ck, e);
  case EXPR_HOLE:
    return check_hole(ck, e);
  }
  return BROKEN;
}

value check_family(checker *ck, expr *e) {
  if (!e) return BROKEN;
  if (ck->depth >= MOST_DEPTH) {
    if (!ck->too_deep) complain(ck, DIAG_TOO_DEEP, e->where, "this expression is nested too deep");
    ck->too_deep = true;
    return BROKEN;
  }
  ck->depth++;
  value v = check_kind(ck, e);
  ck->depth--;
  e->dim = v.dim;
  e->shape = v.shape;
  e->place = v.place;
  e->deviator = v.deviator || v.zero;
  e->open = v.unknown || v.broken;
  return v;
}

value check_value(checker *ck, expr *e) {
  value v = check_family(ck, e);
  if (v.broken || !v.whole) return v;
  complain(ck, DIAG_PLACEMENT, e->where, "%s has one value for each neighbour",
           quoted(ck, e, "this"));
  if (ck->of_whole_family)
    diag_hint(ck->d, HINT_NAME_THE_FAMILY, ck->of_whole_family);
  else if (e->kind == EXPR_NAME)
    diag_hint(ck->d, "write `%s[j]`", e->name);
  return BROKEN;
}

value check_number(checker *ck, expr *e) {
  value v = check_value(ck, e);
  if (v.broken || v.unknown || v.shape != SHAPE_LOGICAL) return v;
  complain(ck, DIAG_SHAPE, e->where, "%s is true or false, not a number", quoted(ck, e, "this"));
  diag_hint(ck->d, "choose numbers with cases: | 1 when ... | 0 otherwise");
  return BROKEN;
}

value check_guard(checker *ck, expr *e) {
  value v = check_value(ck, e);
  if (v.broken || (v.unknown && e->kind != EXPR_NUMBER)) return v;
  if (v.shape == SHAPE_LOGICAL) return v;
  complain(ck, DIAG_SHAPE, e->where, "%s is a number where true or false is needed",
           quoted(ck, e, "this"));
  diag_hint(ck->d, "compare it: `%s > 0`", written(ck, e, "x"));
  return BROKEN;
}
