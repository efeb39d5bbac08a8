/* Expressions to IR (see lower_parts.h). */
#include "generator/lower/lower_parts.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/hash.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/kinematics.h"
#include "generator/lower/law_inputs.h"

ir_node lower_fail(lowering *c, span where, const char *what) {
  if (!c->failed) diag_report(c->said, DIAG_NOT_SUPPORTED, where, "%s", what);
  c->failed = true;
  return ir_constant(c->graph, 0);
}

components lower_failed_value(lowering *c, span where, const char *what) {
  return scalar(lower_fail(c, where, what));
}

bool lower_is_state_law(const lowering *c) {
  return c->law->tree->law == LAW_STATE;
}

/* --- what became of the text ------------------------------------------------------------------ */

/* Room for one more of `count` items. */
void *lower_one_more(void *items, int count, size_t size) {
  bool full = count == 0 || (count >= 16 && (count & (count - 1)) == 0);
  return full ? must_realloc(items, (size_t)(count ? 2 * count : 16) * size) : items;
}

static void note_place(lowering *c, ir_node n, const expr *e) {
  if (c->mode != LOWER_STEP || c->failed || n == IR_NONE) return;
  ir_op op = ir_operation(c->graph, n);
  if (op != IR_DIV && op != IR_SQRT && op != IR_LOG && op != IR_POW) return;
  lowered_text *t = &c->text;
  for (int k = 0; k < t->place_count; k++)
    if (t->places[k].node == n) return;
  t->places = lower_one_more(t->places, t->place_count, sizeof *t->places);
  t->places[t->place_count++] = (lowered_place){n, e->where};
}

static void note_line(lowering *c, const expr *cases, int line, ir_node guard) {
  if (c->mode != LOWER_STEP) return;
  lowered_text *t = &c->text;
  t->lines = lower_one_more(t->lines, t->line_count, sizeof *t->lines);
  t->lines[t->line_count++] = (lowered_line){cases, line, c->group_count, guard};
}

/* --- inputs ----------------------------------------------------------------------------------- */

ir_node lower_quantity(ir *g, builtin_quantity q) {
  /* Of the number of bonds, too, a kernel knows the value of its bond class only (a full family).
   */
  placement on = law_motion_place(q) >= 0 ? ON_BOND : ON_BODY;
  ir_node n = ir_input(g, IR_FROM_QUANTITY, (int)q, builtin_quantities[q].name, on);
  return builtin_quantities[q].place == ON_BOND ? ir_mark_class(g, n) : n;
}

ir_node lower_parameter(ir *g, const law *l, int k) {
  return ir_input(g, IR_FROM_PARAMETER, k, l->parameters.items[k]->name, ON_BODY);
}

ir_node lower_field(ir *g, const law *l, int k) {
  return ir_input(g, IR_FROM_FIELD, k, l->fields.items[k]->name, l->fields.items[k]->place);
}

ir_node lower_volume(lowering *c) {
  return c->law->irregular ? kinematics_input(c->graph, ENDS_VOLUME_I)
                           : lower_quantity(c->graph, QUANTITY_V);
}

static components lower_quantity_name(lowering *c, const expr *e, builtin_quantity q) {
  if (q == QUANTITY_V) return scalar(lower_volume(c));
  if (q == QUANTITY_RESOLVED) return scalar(lower_resolved(c));
  if (q == QUANTITY_TWIST) return scalar(ir_constant(c->graph, 0)); /* no bond twists in a plane */
  if (q == QUANTITY_N_FAMILY && lower_is_state_law(c)) return scalar(lower_family_size(c->graph));
  if (q == QUANTITY_DIRECTION && lower_is_state_law(c)) return lower_direction(c);
  if (builtin_quantities[q].shape == SHAPE_VECTOR)
    return lower_failed_value(c, e->where, "vectors cannot be compiled in laws of bonds yet");
  return scalar(lower_quantity(c->graph, q));
}

/* --- names ------------------------------------------------------------------------------------ */

/* Where the symbol is bound, or would be. */
static binding *place_of(const lowering *c, const symbol *s) {
  size_t k = (size_t)hash_more(HASH_START, &s, sizeof s) & (c->bound_room - 1);
  while (c->bound[k].symbol && c->bound[k].symbol != s)
    k = (k + 1) & (c->bound_room - 1);
  return &c->bound[k];
}

components *lower_binding_of(lowering *c, const symbol *s) {
  binding *found = c->bound_room ? place_of(c, s) : NULL;
  return found && found->symbol ? &found->value : NULL;
}

static void grow_bindings(lowering *c) {
  binding *before = c->bound;
  const size_t room = c->bound_room;
  c->bound_room = room ? 2 * room : 64;
  c->bound = must_calloc(c->bound_room, sizeof *c->bound);
  for (size_t k = 0; k < room; k++)
    if (before[k].symbol) *place_of(c, before[k].symbol) = before[k];
  free(before);
}

void lower_bind(lowering *c, const symbol *s, components value) {
  if (2 * (c->bound_count + 1) > c->bound_room) grow_bindings(c);
  binding *bound = place_of(c, s);
  c->bound_count += bound->symbol == NULL;
  *bound = (binding){s, value};
}

void lower_name_node(ir *g, ir_node n, const char *name, span where) {
  if (n != IR_NONE && ir_arity(ir_operation(g, n)) > 0) ir_set_name(g, n, name, where);
}

void lower_name_value(lowering *c, components value, const char *name, span where) {
  static const char *const parts[] = {"xx", "yy", "zz", "xy", "yz", "xz"};
  static const char *const axes[] = {"x", "y", "z"};
  for (int k = 0; k < value.count; k++) {
    const char *part = value.count == 3 ? axes[k] : parts[k];
    const char *full = value.count == 1 ? name : arena_printf(c->memory, "%s_%s", name, part);
    lower_name_node(c->graph, value.of[k], full, where);
  }
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

static ir_node lower_field_name(lowering *c, const expr *e) {
  int k = e->symbol->index;
  if (e->reads_old || c->mode == LOWER_FROZEN) return lower_field(c->graph, c->law, k);
  return c->new_value[k];
}

static ir_node lower_choice_name(lowering *c, const expr *e) {
  if (e->symbol->option)
    return lower_fail(c, e->where,
                      "an option's choice stands in a comparison with its option only");
  const bool holds = strcmp(e->symbol->name, LAW_IRREGULAR) == 0
                         ? c->law->irregular
                         : strcmp(e->symbol->name, law_setting_name(c->law->setting)) == 0;
  return ir_constant(c->graph, holds);
}

/* Of the particle, or of the bond seen from it. */
static components lower_own_name(lowering *c, const expr *e) {
  switch (e->symbol->kind) {
  case SYMBOL_QUANTITY:
    return lower_quantity_name(c, e, (builtin_quantity)e->symbol->index);
  case SYMBOL_PARAMETER:
    return scalar(lower_parameter(c->graph, c->law, e->symbol->index));
  case SYMBOL_STATE:
  case SYMBOL_DAMAGE:
    return scalar(lower_field_name(c, e));
  case SYMBOL_CHOICE:
    return scalar(lower_choice_name(c, e));
  default:
    return lower_defined_name(c, e);
  }
}

/* x[j] of a particle's x and x'[j] are the neighbour's. */
static components of_whom(lowering *c, const expr *name, components mine) {
  const bool of_neighbour = name->primed || (name->indexed && name->symbol->place == ON_PARTICLE);
  return of_neighbour ? lower_neighbour(c, mine) : mine;
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
  bool same = strcmp(c->law->chosen[option->symbol->index], choice->name) == 0;
  return ir_constant(c->graph, same == (e->binary == OP_EQ));
}

static ir_node lower_comparison(ir *g, binary_op op, ir_node a, ir_node b) {
  switch (op) {
  case OP_EQ:
    return binary(g, IR_EQ, a, b);
  case OP_NE:
    return unary(g, IR_NOT, binary(g, IR_EQ, a, b));
  case OP_LT:
    return binary(g, IR_LT, a, b);
  case OP_LE:
    return binary(g, IR_LE, a, b);
  case OP_GT:
    return binary(g, IR_LT, b, a);
  default:
    return binary(g, IR_LE, b, a);
  }
}

static ir_node lower_scalar_binary(ir *g, binary_op op, ir_node a, ir_node b) {
  switch (op) {
  case OP_OR:
    return binary(g, IR_OR, a, b);
  case OP_AND:
    return binary(g, IR_AND, a, b);
  case OP_ADD:
    return ir_add(g, a, b);
  case OP_SUB:
    return ir_sub(g, a, b);
  case OP_MUL:
  case OP_CONTRACT: /* of bending quantities, which have one component in a plane */
    return ir_mul(g, a, b);
  case OP_DIV:
    return ir_div(g, a, b);
  case OP_POW:
    return ir_power(g, a, b);
  default:
    return lower_comparison(g, op, a, b);
  }
}

static components lower_binary(lowering *c, const expr *e) {
  if (is_option(e->left) || is_option(e->right)) return scalar(lower_option_test(c, e));
  components a = lower_value(c, e->left), b = lower_value(c, e->right);
  if (a.count > 1 || b.count > 1) return lower_tensor_binary(c, e, a, b);
  return scalar(lower_scalar_binary(c->graph, e->binary, a.of[0], b.of[0]));
}

static components lower_unary(lowering *c, const expr *e) {
  components a = lower_value(c, e->left);
  if (e->unary == OP_NOT) return scalar(unary(c->graph, IR_NOT, a.of[0]));
  for (int k = 0; k < a.count && e->unary == OP_NEG; k++)
    a.of[k] = ir_neg(c->graph, a.of[k]);
  return a;
}

/* A comparison with NaN is false, so that a NaN would fall through to `otherwise` unseen: where an operand of a guard could
   be NaN, the cases give that NaN instead. */
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
    if (ir_may_be_nan(g, x)) value = ir_select(g, binary(g, IR_EQ, x, x), value, x);
  }
  return value;
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
    for (int q = 0; q < value.count && q < here.count; q++)
      value.of[q] = ir_select(c->graph, guard, here.of[q], value.of[q]);
  }
  for (int k = 0; k < e->case_count && value.count; k++) {
    if (!e->cases[k].guard) continue;
    ir_node guard = lower_expr(c, e->cases[k].guard);
    for (int q = 0; q < value.count; q++)
      value.of[q] = keep_nan(c, guard, value.of[q]);
    note_line(c, e, k, guard);
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

/* previous(x): the value at the end of the last step, of x[j] and x'[j] the neighbour's. */
static ir_node lower_previous(lowering *c, const expr *e) {
  const expr *name = e->arguments[0].value;
  const symbol *s = name->symbol;
  if (!s || (s->kind != SYMBOL_STATE && s->kind != SYMBOL_DAMAGE))
    return lower_fail(c, e->where, "`previous` asks for a state or a damage");
  return of_whom(c, name, scalar(lower_field(c->graph, c->law, s->index))).of[0];
}

/* diff(f, x): x is a parameter, a quantity, a state or a damage, all of them inputs here. */
static ir_node lower_diff(lowering *c, const expr *e) {
  ir_node f = lower_expr(c, e->arguments[0].value), x = lower_expr(c, e->arguments[1].value);
  if (ir_operation(c->graph, x) != IR_INPUT)
    return lower_fail(c, e->arguments[1].value->where,
                      "nothing can be differentiated by this in a plane");
  if (lower_is_state_law(c) && ir_place(c->graph, f) > ON_BODY && ir_place(c->graph, x) > ON_BODY)
    return lower_fail(c, e->where,
                      "in a law of families only a parameter can be differentiated by yet");
  if (ir_count(c->graph) > MOST_NODES) /* derivatives of derivatives grow without another visit */
    return lower_fail(c, e->where,
                      "with its derivatives written out the law is too large to compile");
  return ir_derivative(c->graph, f, x);
}

static ir_node lower_extreme(lowering *c, const expr *e, ir_op op) {
  ir_node n = lower_expr(c, e->arguments[0].value);
  for (int k = 1; k < e->argument_count; k++)
    n = binary(c->graph, op, n, lower_expr(c, e->arguments[k].value));
  return n;
}

static ir_node soft_sign(ir *g, ir_node x) {
  return ir_div(g, x, ir_add(g, ir_constant(g, 1), unary(g, IR_ABS, x)));
}

/* A function of one argument that is one operation bears its name. A bending quantity has one component
   in a plane: its norm is the absolute value. */
static ir_op simple_operation(builtin_function f) {
  if (f == FUNCTION_NORM) return IR_ABS;
  ir_op op = 0;
  while (op < IR_OP_COUNT &&
         (ir_arity(op) != 1 || strcmp(ir_op_name(op), builtin_functions[f].name) != 0))
    op++;
  return op;
}

static ir_node lower_builtin_call(lowering *c, const expr *e) {
  ir *g = c->graph;
  builtin_function f = (builtin_function)e->builtin;
  if (f == FUNCTION_PREVIOUS) return lower_previous(c, e);
  if (f == FUNCTION_DIFF) return lower_diff(c, e);
  if (f == FUNCTION_MIN || f == FUNCTION_MAX)
    return lower_extreme(c, e, f == FUNCTION_MIN ? IR_MIN : IR_MAX);
  ir_op op = simple_operation(f);
  if (op == IR_OP_COUNT && f != FUNCTION_SOFT_SIGN && f != FUNCTION_MACAULAY && f != FUNCTION_ATAN2)
    return lower_fail(c, e->where, "this function cannot be compiled here");
  ir_node a = lower_expr(c, e->arguments[0].value);
  if (f == FUNCTION_SOFT_SIGN) return soft_sign(g, a);
  if (f == FUNCTION_MACAULAY) return binary(g, IR_MAX, a, ir_constant(g, 0));
  if (f == FUNCTION_ATAN2) return binary(g, IR_ATAN2, a, lower_expr(c, e->arguments[1].value));
  return unary(g, op, a);
}

static components lower_call(lowering *c, const expr *e) {
  components v;
  if (e->builtin < 0) return lower_user_call(c, e);
  return lower_family_call(c, e, &v) ? v : scalar(lower_builtin_call(c, e));
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
    note_place(c, v.of[0], e);
  return v;
}

ir_node lower_expr(lowering *c, const expr *e) {
  components v = lower_value(c, e);
  return v.count == 1 ? v.of[0] : lower_fail(c, e->where, "a single number is needed here");
}
