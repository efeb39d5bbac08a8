#include "generator/lower/lower_value.h"

#include <string.h>

#include "dsl/semantics/decided.h"
#include "generator/ir/derive.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/lower_family.h"
#include "generator/lower/lower_general.h"
#include "generator/lower/lower_gradient.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/lower_slip.h"
#include "generator/lower/lower_tensor.h"
#include "generator/lower/point_inputs.h"

/* --- names ------------------------------------------------------------------------------------ */

static components lower_bending_quantity(const lowering *c, builtin_quantity q) {
  components v = {.count = lower_bending_axes(c->law)};
  for (int k = 0; k < v.count; k++)
    v.of[k] = lower_bending(c->graph, c->law, q, k);
  return v;
}

static components lower_tensor_of_point(const lowering *c, bool rate) {
  components v = {.count = TENSOR_COUNT};
  for (int k = 0; k < TENSOR_COUNT; k++)
    v.of[k] = lower_point_strain(c->graph, c->law, k, rate);
  return v;
}

static components lower_quantity_name(lowering *c, builtin_quantity q) {
  if (q == QUANTITY_PI) return scalar(ir_constant(c->graph, HALF_TURN));
  if (q == QUANTITY_STRAIN || q == QUANTITY_STRAIN_RATE)
    return lower_tensor_of_point(c, q == QUANTITY_STRAIN_RATE);
  if (c->law->tree->law == LAW_CRACK) return scalar(lower_tip_quantity(c->graph, q));
  if (q == QUANTITY_CELL_SIZE) return scalar(point_input_node(c->graph, POINT_CELL_SIZE));
  if (q == QUANTITY_V) return scalar(lower_volume(c->graph, c->law));
  if (q == QUANTITY_RESOLVED) return scalar(lower_resolved(c->graph, c->law));
  if (q == QUANTITY_DT) return scalar(lower_advance(c->graph, c->law));
  if (builtin_quantities[q].kinds == IN_SLIP) return lower_slip_quantity(c, q);
  if (builtin_quantities[q].shape == SHAPE_BENDING) return lower_bending_quantity(c, q);
  if (q == QUANTITY_TWIST && !c->law->twists) return scalar(ir_constant(c->graph, 0));
  if (q == QUANTITY_N_FAMILY && lower_is_state_law(c)) return scalar(lower_family_size(c->graph));
  if (c->variation->sizes && (q == QUANTITY_SPACING || q == QUANTITY_HORIZON))
    return scalar(lower_own_size(c->graph, c->law, q));
  if (q == QUANTITY_DIRECTION) return lower_direction(c->graph, c->law);
  if (q == QUANTITY_U) return lower_displacement(c->graph, c->law);
  return scalar(lower_quantity(c->graph, q));
}

static components lower_defined_name(lowering *c, const expr *e) {
  const symbol *s = e->symbol;
  components *known = lower_binding_of(c, s);
  if (known && known->count) return *known;
  if (known || !s->rule || !s->rule->value)
    return lower_failed_value(c, e->where, "this name has no value that can be compiled");
  const frame *outer = c->frame;
  c->frame = NULL;
  lower_bind(c, s, (components){0});
  components v = lower_value(c, s->rule->value);
  lower_name_value(c, v, s->name, s->rule->where);
  *lower_binding_of(c, s) = v;
  c->frame = outer;
  return v;
}

static ir_node lower_one_field(const lowering *c, int k, bool old) {
  return old || c->mode == LOWER_FROZEN ? lower_field(c->graph, c->law, k) : c->new_value[k];
}

/* Of a tensor in the plane what leaves it is 0. */
static components lower_field_value(const lowering *c, const symbol *s, bool old) {
  if (s->shape == SHAPE_VECTOR) {
    components v = {.count = VECTOR_COMPONENT_COUNT};
    for (int k = 0; k < v.count; k++)
      v.of[k] = lower_one_field(c, law_field_of(s, k), old);
    return v;
  }
  if (s->shape != SHAPE_TENSOR) return scalar(lower_one_field(c, s->index, old));
  components v = {.count = TENSOR_COUNT};
  for (int k = 0; k < TENSOR_COUNT; k++) {
    const int field = law_field_of(s, k);
    v.of[k] = field < 0 || lower_is_none(c->law, k) ? ir_constant(c->graph, 0)
                                                    : lower_one_field(c, field, old);
  }
  return s->deviator ? tensor_as_deviator(c->graph, v) : v;
}

static ir_node lower_choice_name(lowering *c, const expr *e) {
  if (e->symbol->option)
    return lower_fail(c, e->where,
                      "an option's choice stands in a comparison with its option only");
  return ir_constant(c->graph, decided_to_hold(c->law, e));
}

static components lower_own_vector(const lowering *c, int first) {
  components v = {.count = VECTOR_COMPONENT_COUNT};
  for (int k = 0; k < v.count; k++)
    v.of[k] = lower_own_parameter(c, first + k);
  return v;
}

/* Of the particle, or of the bond seen from it. */
static components lower_own_name(lowering *c, const expr *e) {
  switch (e->symbol->kind) {
  case SYMBOL_QUANTITY:
    return lower_quantity_name(c, (builtin_quantity)e->symbol->index);
  case SYMBOL_PARAMETER:
    if (e->symbol->shape == SHAPE_VECTOR) return lower_own_vector(c, e->symbol->index);
    return scalar(lower_own_parameter(c, e->symbol->index));
  case SYMBOL_STATE:
  case SYMBOL_DAMAGE:
    return lower_field_value(c, e->symbol, e->reads_old);
  case SYMBOL_CHOICE:
    return scalar(lower_choice_name(c, e));
  default:
    return lower_defined_name(c, e);
  }
}

/* x[j] of a particle's x and x'[j] are the neighbour's. */
static components of_whom(lowering *c, const expr *name, components mine) {
  const bool of_neighbour = name->primed || (name->indexed && name->symbol->place == ON_PARTICLE);
  return of_neighbour ? lower_neighbour(c->graph, mine) : mine;
}

static components lower_name(lowering *c, const expr *e) {
  if (c->frame)
    for (int k = 0; k < c->frame->function->word_count; k++)
      if (strcmp(c->frame->function->words[k], e->name) == 0) return c->frame->arguments[k];
  if (!e->symbol)
    return lower_failed_value(c, e->where, "this name has no value that can be compiled");
  return of_whom(c, e, lower_own_name(c, e));
}

/* --- numbers and operators -------------------------------------------------------------------- */

static ir_node lower_number(lowering *c, const expr *e) {
  double value = e->number;
  if (e->unit_text) {
    unit u;
    const char *bad;
    size_t bad_length;
    if (!unit_parse(e->unit_text, strlen(e->unit_text), &u, &bad, &bad_length))
      return lower_fail(c, e->unit_where, "this unit is not known");
    value *= u.factor;
  }
  return ir_constant(c->graph, value);
}

static bool is_option(const expr *e) {
  return e->kind == EXPR_NAME && e->symbol && e->symbol->kind == SYMBOL_OPTION;
}

/* onset == rankine, decided by the choice in force. */
static ir_node lower_option_test(lowering *c, const expr *e) {
  const expr *option = is_option(e->left) ? e->left : e->right;
  const expr *choice = option == e->left ? e->right : e->left;
  if (choice->kind != EXPR_NAME)
    return lower_fail(c, e->where, "an option is compared with one of its choices");
  return ir_constant(c->graph, decided_to_hold(c->law, e));
}

static ir_node lower_scalar_binary(ir *g, binary_op op, ir_node a, ir_node b) {
  static const struct {
    ir_op by;
    operator_reading reading;
  } computed[] = {
#define X(code, text, operation, reading) [OP_##code] = {IR_##operation, reading},
      TREE_BINARY_OPERATORS(X)
#undef X
  };
  const ir_op by = computed[op].by;
  const operator_reading reading = computed[op].reading;
  if (by == IR_POW) return ir_power(g, a, b);
  const ir_node result =
      reading == READ_EXCHANGED ? ir_binary(g, by, b, a) : ir_binary(g, by, a, b);
  return reading == READ_NEGATED ? ir_unary(g, IR_NOT, result) : result;
}

static components lower_binary(lowering *c, const expr *e) {
  if (is_option(e->left) || is_option(e->right)) return scalar(lower_option_test(c, e));
  components a = lower_value(c, e->left), b = lower_value(c, e->right);
  if (a.count > 1 || b.count > 1) return tensor_binary(c, e, a, b);
  return scalar(lower_scalar_binary(c->graph, e->binary, a.of[0], b.of[0]));
}

static components lower_unary(lowering *c, const expr *e) {
  components a = lower_value(c, e->left);
  if (e->unary == OP_COMPONENT && a.count == TENSOR_COUNT)
    return scalar(a.of[symmetric_component(e->component)]);
  if (e->unary >= OP_COMPONENT) return scalar(a.of[a.count == 1 ? 0 : e->component]);
  if (e->unary == OP_NOT) return scalar(ir_unary(c->graph, IR_NOT, a.of[0]));
  for (int k = 0; k < a.count && e->unary == OP_NEG; k++)
    a.of[k] = ir_neg(c->graph, a.of[k]);
  return e->unary == OP_NEG ? tensor_settled(c->graph, a) : a;
}

/* A comparison with NaN is false, so that a NaN would fall through to `otherwise` unseen: where an
   operand of a guard could be NaN, the cases give that NaN instead. */
static ir_node keep_nan(lowering *c, ir_node guard, ir_node value) {
  ir *g = c->graph;
  if (ir_is_logical(g, guard) && ir_operation(g, guard) != IR_LT &&
      ir_operation(g, guard) != IR_LE && ir_operation(g, guard) != IR_EQ) {
    for (int k = 0; k < ir_arity(ir_operation(g, guard)); k++)
      if (ir_is_logical(g, ir_operand(g, guard, k)))
        value = keep_nan(c, ir_operand(g, guard, k), value);
    return value;
  }
  for (int k = 0; k < ir_arity(ir_operation(g, guard)) && ir_is_logical(g, guard); k++) {
    ir_node x = ir_operand(g, guard, k);
    if (ir_may_be_nan(g, x)) value = ir_select(g, ir_binary(g, IR_EQ, x, x), value, x);
  }
  return value;
}

/* A value of cases is a deviator where each line is; 0 stands for a vector or a tensor of zeros. */
static bool all_deviators(const ir *g, const components *a, const components *b) {
  const components *both[] = {a, b};
  for (int k = 0; k < 2; k++)
    if (!tensor_is_deviator(g, both[k]) &&
        (both[k]->count != 1 || !ir_is_number(g, both[k]->of[0], 0)))
      return false;
  return a->count > 1 || b->count > 1;
}

static components widened(ir *g, components v, int count) {
  if (v.count == TENSOR_COUNT && count == GENERAL_COUNT) return general_of(g, v);
  for (; v.count < count; v.count++)
    v.of[v.count] = v.of[0];
  return v;
}

/* From the last line up, so that the first true line wins. */
static components lower_cases(lowering *c, const expr *e) {
  components value = {0};
  for (int k = e->case_count - 1; k >= 0; k--) {
    const case_line *line = &e->cases[k];
    components here = lower_value(c, line->value);
    if (!line->guard) {
      value = here;
      continue;
    }
    if (value.count == 0)
      return lower_failed_value(c, line->where, "the last line of cases must be `otherwise`");
    ir_node guard = lower_expr(c, line->guard);
    const bool deviators = all_deviators(c->graph, &here, &value);
    value = widened(c->graph, value, here.count);
    here = widened(c->graph, here, value.count);
    for (int q = 0; q < value.count; q++)
      value.of[q] = ir_select(c->graph, guard, here.of[q], value.of[q]);
    value.traced = false;
    if (deviators) value = tensor_as_deviator(c->graph, value);
  }
  for (int k = 0; k < e->case_count && value.count; k++) {
    if (!e->cases[k].guard) continue;
    ir_node guard = lower_expr(c, e->cases[k].guard);
    for (int q = 0; q < value.count; q++)
      value.of[q] = keep_nan(c, guard, value.of[q]);
    value = tensor_settled(c->graph, value);
    lower_note_line(c, e, k, guard);
  }
  c->group_count++;
  return value;
}

/* --- calls ------------------------------------------------------------------------------------ */

static unsigned call_bucket(const stmt *function, const components *arguments) {
  uintptr_t hash = (uintptr_t)function >> 4;
  for (int k = 0; k < function->word_count; k++)
    hash = hash * 31 + (uintptr_t)arguments[k].of[0];
  return (unsigned)(hash % CALL_BUCKETS);
}

static bool are_same(const components *a, const components *b, int count) {
  for (int k = 0; k < count; k++) {
    if (a[k].count != b[k].count) return false;
    for (int q = 0; q < a[k].count; q++)
      if (a[k].of[q] != b[k].of[q]) return false;
  }
  return true;
}

static known_call *find_call(const lowering *c, const stmt *function, const components *arguments) {
  for (known_call *k = c->calls[call_bucket(function, arguments)]; k; k = k->next)
    if (k->function == function && are_same(k->arguments, arguments, function->word_count))
      return k;
  return NULL;
}

static components lower_user_call(lowering *c, const expr *e) {
  const stmt *function = e->symbol->declared;
  int depth = c->frame ? c->frame->depth + 1 : 1;
  if (e->argument_count != function->word_count)
    return lower_failed_value(c, e->where, "this call has the wrong number of arguments");
  if (depth > MOST_CALLS_DEEP)
    return lower_failed_value(c, e->where, "functions call each other more than 64 deep");
  components *arguments =
      arena_alloc(c->memory, (size_t)(e->argument_count + 1) * sizeof *arguments);
  for (int k = 0; k < e->argument_count; k++)
    arguments[k] = lower_value(c, e->arguments[k].value);
  known_call *known = find_call(c, function, arguments);
  if (known) return known->result;
  frame inner = {function, arguments, depth};
  const frame *outer = c->frame;
  c->frame = &inner;
  components result = lower_value(c, function->value);
  c->frame = outer;
  known = arena_alloc(c->memory, sizeof *known);
  unsigned bucket = call_bucket(function, arguments);
  *known = (known_call){function, arguments, result, c->calls[bucket]};
  c->calls[bucket] = known;
  return result;
}

/* previous(x): the value at the end of the last step, of x[j] and x'[j] the neighbour's. Of a flow
   that is solved for, x itself moves in its guard and previous(x) does not. */
static components lower_previous(lowering *c, const expr *e) {
  const expr *name = e->arguments[0].value;
  const symbol *s = name->symbol;
  if (!s || (s->kind != SYMBOL_STATE && s->kind != SYMBOL_DAMAGE))
    return lower_failed_value(c, e->where, "`previous` asks for a state or a damage");
  components old = lower_field_value(c, s, true);
  for (int k = 0; k < old.count && c->mode != LOWER_FROZEN && lower_is_solved(s); k++)
    if (ir_operation(c->graph, old.of[k]) == IR_INPUT)
      old.of[k] = lower_kept_field(c->graph, c->law, law_field_of(s, k));
  return of_whom(c, name, tensor_settled(c->graph, old));
}

/* diff(f, x): x is a parameter, a quantity, a state or a damage, all of them inputs here. */
static ir_node lower_slope(lowering *c, const expr *e, ir_node f, ir_node x) {
  if (ir_operation(c->graph, x) != IR_INPUT)
    return lower_fail(c, e->arguments[1].value->where,
                      "nothing can be differentiated by this in a plane");
  if (lower_is_state_law(c) && !ir_is_uniform(c->graph, f) && !ir_is_uniform(c->graph, x))
    return lower_fail(c, e->where,
                      "in a law of families only a parameter that is the same everywhere can be "
                      "differentiated by yet");
  if (ir_count(c->graph) > MOST_NODES) /* derivatives of derivatives grow without another visit */
    return lower_fail(c, e->where,
                      "with its derivatives written out the law is too large to compile");
  return ir_derivative(c->graph, f, x);
}

/* The deviator whose product with any change of a deviator x is the change of f, out of the
   derivatives by xx and yy, with which zz = -(xx + yy) moves. */
static components by_deviator(ir *g, components v) {
  const ir_node both = ir_add(g, v.of[TENSOR_XX], v.of[TENSOR_YY]),
                third = ir_div(g, both, ir_constant(g, 3));
  for (int k = 0; k < TENSOR_ZZ; k++)
    v.of[k] = ir_sub(g, v.of[k], third);
  return tensor_as_deviator(g, v);
}

/* By or of a vector component by component. A shear stands twice in a tensor. */
static components lower_diff(lowering *c, const expr *e) {
  components f = lower_value(c, e->arguments[0].value), x = lower_value(c, e->arguments[1].value);
  if (f.count > 1 && x.count > 1)
    return lower_failed_value(c, e->where,
                              x.count == TENSOR_COUNT
                                  ? "a tensor has no derivative by a tensor here: take that of a "
                                    "component, such as `sigma[x,y]`"
                                  : "in space a bending quantity has no one derivative by another");
  components v = {.count = f.count > x.count ? f.count : x.count};
  const bool deviator = tensor_is_deviator(c->graph, &x);
  for (int k = 0; k < v.count; k++) {
    const bool none =
        x.count == TENSOR_COUNT && (lower_is_none(c->law, k) || (deviator && k == TENSOR_ZZ));
    v.of[k] = none ? ir_constant(c->graph, 0)
                   : lower_slope(c, e, f.of[f.count > 1 ? k : 0], x.of[x.count > 1 ? k : 0]);
    if (x.count == TENSOR_COUNT && k >= TENSOR_XY) v.of[k] = half(c->graph, v.of[k]);
  }
  if (deviator) return by_deviator(c->graph, v);
  return tensor_is_deviator(c->graph, &f) ? tensor_as_deviator(c->graph, v) : v;
}

static ir_node soft_sign(ir *g, ir_node x) {
  const ir_node size = ir_unary(g, IR_ABS, x);
  return ir_div(g, x, ir_add(g, ir_constant(g, 1), size));
}

/* What has the name of an operation is that operation, of more than two arguments the first with
   each of the others. */
static ir_node lower_builtin_call(lowering *c, const expr *e) {
  ir *g = c->graph;
  builtin_function f = (builtin_function)e->builtin;
  ir_op op = operation_named(builtin_functions[f].name);
  if (op == IR_OP_COUNT && f != FUNCTION_SOFT_SIGN && f != FUNCTION_MACAULAY)
    return lower_fail(c, e->where, "this function cannot be compiled here");
  ir_node a = lower_expr(c, e->arguments[0].value);
  if (f == FUNCTION_SOFT_SIGN) return soft_sign(g, a);
  if (f == FUNCTION_MACAULAY) return ir_binary(g, IR_MAX, a, ir_constant(g, 0));
  if (e->argument_count == 1 && ir_arity(op) == 1) return ir_unary(g, op, a);
  for (int k = 1; k < e->argument_count; k++)
    a = ir_binary(g, op, a, lower_expr(c, e->arguments[k].value));
  return a;
}

/* Arguments come first: what goes over a family knows no text. Which principal value is asked for
   is no value. */
static components lower_of_family(lowering *c, const expr *e) {
  enum { MOST_ARGUMENTS = GENERAL_COUNT };
  components a[MOST_ARGUMENTS] = {lower_value(c, e->arguments[0].value)};
  const bool which = e->builtin == FUNCTION_PRINCIPAL || e->builtin == FUNCTION_PRINCIPAL_DIRECTION;
  const int count = which ? 1 : e->argument_count;
  const bool products = e->builtin == FUNCTION_PRODUCT || e->builtin == FUNCTION_DOT ||
                        e->builtin == FUNCTION_CROSS || e->builtin == FUNCTION_DYAD;
  for (int k = 1; k < count && !c->failed; k++)
    a[k] = products ? lower_value(c, e->arguments[k].value)
                    : scalar(lower_expr(c, e->arguments[k].value));
  if (c->failed) return a[0];
  const ir_node weight = e->argument_count > 1 ? a[1].of[0] : IR_NONE;
  if (e->builtin == FUNCTION_GRADIENT) return lower_gradient(c->graph, c->law, a[0], weight);
  if (e->builtin == FUNCTION_CORRESPONDENCE)
    return lower_correspondence(c->graph, c->law, a[0], weight);
  return lower_family_call(c, e, a);
}

static components lower_call(lowering *c, const expr *e) {
  if (e->builtin < 0) return lower_user_call(c, e);
  if (e->builtin == FUNCTION_DIFF) return lower_diff(c, e);
  if (e->builtin == FUNCTION_PREVIOUS) return lower_previous(c, e);
  return lower_is_family_call(e) ? lower_of_family(c, e) : scalar(lower_builtin_call(c, e));
}

static components lower_kind(lowering *c, const expr *e) {
  switch (e->kind) {
  case EXPR_NUMBER:
    return scalar(lower_number(c, e));
  case EXPR_NAME:
    return lower_name(c, e);
  case EXPR_UNARY:
    return lower_unary(c, e);
  case EXPR_BINARY:
    return lower_binary(c, e);
  case EXPR_CASES:
    return lower_cases(c, e);
  default:
    return lower_call(c, e);
  }
}

components lower_value(lowering *c, const expr *e) {
  if (c->failed) return scalar(ir_constant(c->graph, 0));
  if (++c->visits > MOST_VISITS || ir_count(c->graph) > MOST_NODES)
    return lower_failed_value(c, e->where,
                              "with its functions expanded the law is too large to compile");
  components v = lower_kind(c, e);
  if (e->kind == EXPR_BINARY || (e->kind == EXPR_CALL && e->builtin >= 0))
    for (int k = 0; k < v.count; k++)
      lower_note_place(c, v.of[k], e);
  return v;
}

ir_node lower_expr(lowering *c, const expr *e) {
  components v = lower_value(c, e);
  return v.count == 1 ? v.of[0] : lower_fail(c, e->where, "a single number is needed here");
}
