#include "generator/lower.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "generator/kinematics.h"
#include "generator/law_inputs.h"
#include "generator/rewrite.h"

/* Expanding functions can grow a law without bound; these limits are far beyond any real one. */
#define MOST_NODES      50000
#define MOST_VISITS     2000000
#define MOST_CALLS_DEEP 64
#define CALL_BUCKETS    256

typedef struct binding {
  const symbol *symbol;
  ir_node node; /* IR_NONE while its rule is being lowered */
} binding;

/* A call that has been expanded: the same function of the same arguments is the same node. */
typedef struct known_call {
  const stmt *function;
  const ir_node *arguments;
  ir_node result;
  struct known_call *next;
} known_call;

typedef struct frame { /* of the function being expanded */
  const stmt *function;
  const ir_node *arguments;
  int depth;
} frame;

typedef struct lowering {
  const law *law;
  ir *graph;
  lower_mode mode;
  arena *memory;
  diagnostics *said;
  bool failed;
  long visits;
  const frame *frame;
  binding *bound;
  int bound_count, bound_capacity;
  known_call *calls[CALL_BUCKETS];
  ir_node *new_value; /* [fields] what names read below the rule: an opaque input until the end */
  ir_node *rule;      /* [fields] value of the rule, or IR_NONE before it */
  int *rule_order;    /* fields in the order of their rules */
  int rule_count;
  lowered_text text; /* LOWER_STEP; grown by malloc, copied to `memory` at the end */
  int group_count;
} lowering;

static ir_node lower_expr(lowering *c, const expr *e);

static ir_node fail(lowering *c, span where, const char *what) {
  if (!c->failed) diag_report(c->said, DIAG_NOT_SUPPORTED, where, "%s", what);
  c->failed = true;
  return ir_constant(c->graph, 0);
}

static ir_node unary(ir *g, ir_op op, ir_node a) {
  return ir_make(g, op, a, IR_NONE, IR_NONE);
}

static ir_node binary(ir *g, ir_op op, ir_node a, ir_node b) {
  return ir_make(g, op, a, b, IR_NONE);
}

/* --- what became of the text ------------------------------------------------------------------ */

/* Room for one more of `count` items. */
static void *one_more(void *items, int count, size_t size) {
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
  t->places = one_more(t->places, t->place_count, sizeof *t->places);
  t->places[t->place_count++] = (lowered_place){n, e->where};
}

static void note_line(lowering *c, const expr *cases, int line, ir_node guard) {
  if (c->mode != LOWER_STEP) return;
  lowered_text *t = &c->text;
  t->lines = one_more(t->lines, t->line_count, sizeof *t->lines);
  t->lines[t->line_count++] = (lowered_line){cases, line, c->group_count, guard};
}

/* --- inputs ----------------------------------------------------------------------------------- */

ir_node lower_quantity(ir *g, builtin_quantity q) {
  /* Of the number of bonds, too, a kernel knows the value of its bond class only (a full family).
   */
  placement on = law_motion_place(q) >= 0 ? ON_BOND : ON_BODY;
  return ir_input(g, IR_FROM_QUANTITY, (int)q, builtin_quantities[q].name, on);
}

ir_node lower_parameter(ir *g, const law *l, int k) {
  return ir_input(g, IR_FROM_PARAMETER, k, l->parameters.items[k]->name, ON_BODY);
}

ir_node lower_field(ir *g, const law *l, int k) {
  return ir_input(g, IR_FROM_FIELD, k, l->fields.items[k]->name, ON_BOND);
}

/* Stands for the new value of field k until all rules are known. */
static ir_node opaque_field(ir *g, const law *l, int k) {
  return ir_input(g, IR_FROM_FIELD, l->fields.count + k, l->fields.items[k]->name, ON_BOND);
}

static ir_node lower_quantity_name(lowering *c, const expr *e, builtin_quantity q) {
  if (q == QUANTITY_TWIST) return ir_constant(c->graph, 0); /* no bond twists in a plane */
  if (builtin_quantities[q].shape == SHAPE_VECTOR)
    return fail(c, e->where, "vectors cannot be compiled in laws of bonds yet");
  return lower_quantity(c->graph, q);
}

/* --- names ------------------------------------------------------------------------------------ */

static ir_node *binding_of(lowering *c, const symbol *s) {
  for (int k = c->bound_count - 1; k >= 0; k--)
    if (c->bound[k].symbol == s) return &c->bound[k].node;
  return NULL;
}

static void bind(lowering *c, const symbol *s, ir_node node) {
  if (c->bound_count == c->bound_capacity) {
    c->bound_capacity = c->bound_capacity ? 2 * c->bound_capacity : 64;
    c->bound = must_realloc(c->bound, (size_t)c->bound_capacity * sizeof *c->bound);
  }
  c->bound[c->bound_count++] = (binding){s, node};
}

/* Constants and inputs keep their own names. */
static void name_node(ir *g, ir_node n, const char *name, span where) {
  if (n != IR_NONE && ir_arity(ir_operation(g, n)) > 0) ir_set_name(g, n, name, where);
}

static ir_node lower_defined_name(lowering *c, const expr *e) {
  const symbol *s = e->symbol;
  ir_node *known = binding_of(c, s);
  if (known && *known != IR_NONE) return *known;
  if (known || !s->rule || !s->rule->value)
    return fail(c, e->where, "this name has no value that can be compiled");
  const frame *outer = c->frame;
  c->frame = NULL;
  bind(c, s, IR_NONE);
  ir_node n = lower_expr(c, s->rule->value);
  name_node(c->graph, n, s->name, s->rule->where);
  *binding_of(c, s) = n;
  c->frame = outer;
  return n;
}

static ir_node lower_field_name(lowering *c, const expr *e) {
  int k = e->symbol->index;
  if (e->reads_old || c->mode == LOWER_FROZEN) return lower_field(c->graph, c->law, k);
  return c->new_value[k];
}

static ir_node lower_choice_name(lowering *c, const expr *e) {
  if (e->symbol->option)
    return fail(c, e->where, "an option's choice stands in a comparison with its option only");
  /* Lattices in the plane are in plane stress for now. */
  return ir_constant(c->graph, strcmp(e->symbol->name, "plane_stress") == 0);
}

static ir_node lower_name(lowering *c, const expr *e) {
  if (c->frame)
    for (int k = 0; k < c->frame->function->word_count; k++)
      if (strcmp(c->frame->function->words[k], e->name) == 0) return c->frame->arguments[k];
  if (e->indexed || e->primed)
    return fail(c, e->where, "values of neighbours cannot be compiled yet");
  if (!e->symbol) return fail(c, e->where, "this name has no value that can be compiled");
  switch (e->symbol->kind) {
  case SYMBOL_QUANTITY:
    return lower_quantity_name(c, e, (builtin_quantity)e->symbol->index);
  case SYMBOL_PARAMETER:
    return lower_parameter(c->graph, c->law, e->symbol->index);
  case SYMBOL_STATE:
  case SYMBOL_DAMAGE:
    return lower_field_name(c, e);
  case SYMBOL_CHOICE:
    return lower_choice_name(c, e);
  default:
    return lower_defined_name(c, e);
  }
}

/* --- numbers and operators -------------------------------------------------------------------- */

static ir_node lower_number(lowering *c, const expr *e) {
  double value = e->number;
  if (e->unit_text) {
    unit u;
    const char *bad;
    size_t bad_length;
    if (!unit_parse(e->unit_text, strlen(e->unit_text), &u, &bad, &bad_length))
      return fail(c, e->unit_where, "this unit is not known");
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
    return fail(c, e->where, "an option is compared with one of its choices");
  bool same = strcmp(c->law->chosen[option->symbol->index], choice->name) == 0;
  return ir_constant(c->graph, same == (e->binary == OP_EQ));
}

static ir_node lower_binary(lowering *c, const expr *e) {
  if (is_option(e->left) || is_option(e->right)) return lower_option_test(c, e);
  ir *g = c->graph;
  ir_node a = lower_expr(c, e->left), b = lower_expr(c, e->right);
  switch (e->binary) {
  case OP_OR:
    return binary(g, IR_OR, a, b);
  case OP_AND:
    return binary(g, IR_AND, a, b);
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
  case OP_GE:
    return binary(g, IR_LE, b, a);
  case OP_ADD:
    return ir_add(g, a, b);
  case OP_SUB:
    return ir_sub(g, a, b);
  case OP_MUL:
    return ir_mul(g, a, b);
  case OP_CONTRACT: /* of bending quantities, which have one component in a plane */
    return e->left->shape == SHAPE_BENDING ? ir_mul(g, a, b)
                                           : fail(c, e->where, "tensors cannot be compiled yet");
  case OP_DIV:
    return ir_div(g, a, b);
  case OP_POW:
    return ir_power(g, a, b);
  default:
    return fail(c, e->where, "tensors cannot be compiled yet");
  }
}

static ir_node lower_unary(lowering *c, const expr *e) {
  ir_node a = lower_expr(c, e->left);
  switch (e->unary) {
  case OP_NEG:
    return ir_neg(c->graph, a);
  case OP_NOT:
    return unary(c->graph, IR_NOT, a);
  default:
    return a;
  }
}

/* From the last line up, so that the first true line wins. */
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
    if (rewrite_may_be_nan(g, x)) value = ir_select(g, binary(g, IR_EQ, x, x), value, x);
  }
  return value;
}

static ir_node lower_cases(lowering *c, const expr *e) {
  ir_node value = IR_NONE;
  for (int k = e->case_count - 1; k >= 0; k--) {
    const case_line *line = &e->cases[k];
    ir_node here = lower_expr(c, line->value);
    if (!line->guard)
      value = here;
    else if (value == IR_NONE)
      return fail(c, line->where, "the last line of cases must be `otherwise`");
    else
      value = ir_select(c->graph, lower_expr(c, line->guard), here, value);
  }
  for (int k = 0; k < e->case_count && value != IR_NONE; k++) {
    if (!e->cases[k].guard) continue;
    ir_node guard = lower_expr(c, e->cases[k].guard);
    value = keep_nan(c, guard, value);
    note_line(c, e, k, guard);
  }
  c->group_count++;
  return value;
}

/* --- calls ------------------------------------------------------------------------------------ */

static unsigned call_bucket(const stmt *function, const ir_node *arguments) {
  uintptr_t hash = (uintptr_t)function >> 4;
  for (int k = 0; k < function->word_count; k++)
    hash = hash * 31 + (uintptr_t)arguments[k];
  return (unsigned)(hash % CALL_BUCKETS);
}

static known_call *find_call(const lowering *c, const stmt *function, const ir_node *arguments) {
  size_t size = (size_t)function->word_count * sizeof *arguments;
  for (known_call *k = c->calls[call_bucket(function, arguments)]; k; k = k->next)
    if (k->function == function && memcmp(k->arguments, arguments, size) == 0) return k;
  return NULL;
}

static ir_node lower_user_call(lowering *c, const expr *e) {
  const stmt *function = e->symbol->declared;
  int depth = c->frame ? c->frame->depth + 1 : 1;
  if (e->argument_count != function->word_count)
    return fail(c, e->where, "this call has the wrong number of arguments");
  if (depth > MOST_CALLS_DEEP)
    return fail(c, e->where, "functions call each other more than 64 deep");
  ir_node *arguments = arena_alloc(c->memory, (size_t)(e->argument_count + 1) * sizeof *arguments);
  for (int k = 0; k < e->argument_count; k++)
    arguments[k] = lower_expr(c, e->arguments[k].value);
  known_call *known = find_call(c, function, arguments);
  if (known) return known->result;
  frame inner = {function, arguments, depth};
  const frame *outer = c->frame;
  c->frame = &inner;
  ir_node result = lower_expr(c, function->value);
  c->frame = outer;
  known = arena_alloc(c->memory, sizeof *known);
  unsigned bucket = call_bucket(function, arguments);
  *known = (known_call){function, arguments, result, c->calls[bucket]};
  c->calls[bucket] = known;
  return result;
}

/* previous(x): the value at the end of the last step. */
static ir_node lower_previous(lowering *c, const expr *e) {
  const symbol *s = e->arguments[0].value->symbol;
  if (!s || (s->kind != SYMBOL_STATE && s->kind != SYMBOL_DAMAGE))
    return fail(c, e->where, "`previous` asks for a state or a damage");
  return lower_field(c->graph, c->law, s->index);
}

/* diff(f, x): x is a parameter, a quantity, a state or a damage, all of them inputs here. */
static ir_node lower_diff(lowering *c, const expr *e) {
  ir_node f = lower_expr(c, e->arguments[0].value), x = lower_expr(c, e->arguments[1].value);
  if (ir_operation(c->graph, x) != IR_INPUT)
    return fail(c, e->arguments[1].value->where,
                "nothing can be differentiated by this in a plane");
  if (ir_count(c->graph) > MOST_NODES) /* derivatives of derivatives grow without another visit */
    return fail(c, e->where, "with its derivatives written out the law is too large to compile");
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

/* Functions of one argument that are one operation. A bending quantity has one component in a
   plane: its norm is the absolute value. */
static ir_op simple_operation(builtin_function f) {
  switch (f) {
  case FUNCTION_ABS:
  case FUNCTION_NORM:
    return IR_ABS;
  case FUNCTION_SQRT:
    return IR_SQRT;
  case FUNCTION_CBRT:
    return IR_CBRT;
  case FUNCTION_EXP:
    return IR_EXP;
  case FUNCTION_LOG:
    return IR_LOG;
  case FUNCTION_SIN:
    return IR_SIN;
  case FUNCTION_COS:
    return IR_COS;
  case FUNCTION_TAN:
    return IR_TAN;
  case FUNCTION_TANH:
    return IR_TANH;
  case FUNCTION_SIGN:
    return IR_SIGN;
  default:
    return IR_OP_COUNT;
  }
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
    return fail(c, e->where,
                "this function belongs to laws of families, which cannot be compiled yet");
  ir_node a = lower_expr(c, e->arguments[0].value);
  if (f == FUNCTION_SOFT_SIGN) return soft_sign(g, a);
  if (f == FUNCTION_MACAULAY) return binary(g, IR_MAX, a, ir_constant(g, 0));
  if (f == FUNCTION_ATAN2) return binary(g, IR_ATAN2, a, lower_expr(c, e->arguments[1].value));
  return unary(g, op, a);
}

static ir_node lower_kind(lowering *c, const expr *e) {
  switch (e->kind) {
  case EXPR_NUMBER:
    return lower_number(c, e);
  case EXPR_NAME:
    return lower_name(c, e);
  case EXPR_UNARY:
    return lower_unary(c, e);
  case EXPR_BINARY:
    return lower_binary(c, e);
  case EXPR_CASES:
    return lower_cases(c, e);
  default:
    return e->builtin >= 0 ? lower_builtin_call(c, e) : lower_user_call(c, e);
  }
}

static ir_node lower_expr(lowering *c, const expr *e) {
  if (c->failed) return ir_constant(c->graph, 0);
  if (++c->visits > MOST_VISITS || ir_count(c->graph) > MOST_NODES)
    return fail(c, e->where, "with its functions expanded the law is too large to compile");
  ir_node n = lower_kind(c, e);
  if (e->kind == EXPR_BINARY || (e->kind == EXPR_CALL && e->builtin >= 0)) note_place(c, n, e);
  return n;
}

/* --- rules ------------------------------------------------------------------------------------ */

/* min(max(old, rule), 1) in a form in which a rule that is not a number stays so, and is found. */
static ir_node clamp_damage(lowering *c, ir_node old, ir_node rule) {
  ir *g = c->graph;
  ir_node one = ir_constant(g, 1);
  ir_node grown = ir_select(g, binary(g, IR_LT, rule, old), old, rule);
  ir_node clamped = ir_select(g, binary(g, IR_LT, one, grown), one, grown);
  if (c->mode != LOWER_PROTECTABLE) return clamped;
  ir_node is_protected = binary(g, IR_LT, ir_constant(g, 0), kinematics_input(g, ENDS_PROTECTED));
  return ir_select(g, is_protected, old, clamped);
}

/* a - b of a guard a >= b or a > b. */
static ir_node overstress_of(lowering *c, const expr *when) {
  if (!when || when->kind != EXPR_BINARY) return IR_NONE;
  binary_op op = when->binary;
  if (op != OP_GE && op != OP_GT && op != OP_LE && op != OP_LT) return IR_NONE;
  ir_node a = lower_expr(c, when->left), b = lower_expr(c, when->right);
  return op == OP_GE || op == OP_GT ? ir_sub(c->graph, a, b) : ir_sub(c->graph, b, a);
}

static void note_flow(lowering *c, const stmt *rule, ir_node when) {
  if (c->mode != LOWER_STEP) return;
  lowered_text *t = &c->text;
  t->flows = one_more(t->flows, t->flow_count, sizeof *t->flows);
  t->flows[t->flow_count++] =
      (lowered_flow){rule, rule->symbol->index, when, overstress_of(c, rule->when)};
}

/* `flow x by expr when guard`: one increment a step. */
static ir_node flow_once(lowering *c, const stmt *rule, ir_node old, ir_node increment) {
  if (rule->returned)
    return fail(c, rule->where, "`flow ... along ... returned` cannot be compiled yet");
  ir_node flown = ir_add(c->graph, old, increment);
  ir_node when = rule->when ? lower_expr(c, rule->when) : IR_NONE;
  note_flow(c, rule, when);
  return rule->when ? ir_select(c->graph, when, flown, old) : flown;
}

static void lower_field_rule(lowering *c, const stmt *rule) {
  const symbol *s = rule->symbol;
  if (c->mode == LOWER_FROZEN) return;
  if (s->place != ON_BOND) {
    fail(c, rule->where, "states that do not live on the bond cannot be compiled yet");
    return;
  }
  ir_node old = lower_field(c->graph, c->law, s->index);
  ir_node value = lower_expr(c, rule->value);
  if (rule->kind == STMT_FLOW) value = flow_once(c, rule, old, value);
  if (c->mode == LOWER_STEP) c->text.rules[s->index] = value;
  if (s->kind == SYMBOL_DAMAGE) value = clamp_damage(c, old, value);
  name_node(c->graph, value, s->name, rule->where);
  c->rule[s->index] = value;
  c->rule_order[c->rule_count++] = s->index;
}

static void lower_rule(lowering *c, const stmt *rule) {
  const symbol *s = rule->symbol;
  bool field = s && (s->kind == SYMBOL_STATE || s->kind == SYMBOL_DAMAGE);
  if (field && rule == s->rule)
    lower_field_rule(c, rule);
  else if (!field && s && rule->value && rule->kind != STMT_PARAMETER &&
           rule->kind != STMT_FUNCTION && rule->kind != STMT_OPTION && !binding_of(c, s)) {
    ir_node n = lower_expr(c, rule->value);
    name_node(c->graph, n, s->name, rule->where);
    bind(c, s, n);
  }
}

/* --- results ---------------------------------------------------------------------------------- */

static ir_node result_node(lowering *c, law_result which) {
  const symbol *s = c->law->results[which];
  ir_node *known = s ? binding_of(c, s) : NULL;
  return known ? *known : IR_NONE;
}

/* At fixed fields the energy's derivative: N = dW/dL, where the stretch is (L - s)/s. */
static ir_node force_of_energy(lowering *c, ir_node W) {
  ir *g = c->graph;
  ir_node by_stretch = ir_derivative(g, W, lower_quantity(g, QUANTITY_STRETCH));
  ir_node by_length = ir_derivative(g, W, lower_quantity(g, QUANTITY_LENGTH));
  return ir_add(g, ir_div(g, by_stretch, lower_quantity(g, QUANTITY_S)), by_length);
}

static ir_node end_moment(lowering *c, law_result which, ir_node W, builtin_quantity theta) {
  ir *g = c->graph;
  ir_node moment = result_node(c, which), shear = result_node(c, RESULT_V);
  if (moment != IR_NONE) return moment;
  if (shear != IR_NONE)
    return ir_div(g, ir_mul(g, shear, lower_quantity(g, QUANTITY_LENGTH)), ir_constant(g, 2));
  if (W != IR_NONE) return ir_derivative(g, W, lower_quantity(g, theta));
  return fail(c, c->law->tree->name_where, "the law gives no end moments");
}

static void lower_results(lowering *c, lowered_law *out) {
  const symbol_list *outputs = &c->law->outputs;
  out->W = result_node(c, RESULT_W);
  out->N = result_node(c, RESULT_N);
  if (out->N == IR_NONE && out->W == IR_NONE)
    out->N = fail(c, c->law->tree->name_where, "the law gives no force");
  else if (out->N == IR_NONE)
    out->N = force_of_energy(c, out->W);
  out->M_i = out->M_j = IR_NONE;
  if (c->law->tree->law == LAW_MICROPOLAR_BOND) {
    out->M_i = end_moment(c, RESULT_M_I, out->W, QUANTITY_THETA_I);
    out->M_j = end_moment(c, RESULT_M_J, out->W, QUANTITY_THETA_J);
  }
  span nowhere = {0, 0, 0};
  name_node(c->graph, out->N, "N", nowhere);
  name_node(c->graph, out->M_i, "M_i", nowhere);
  name_node(c->graph, out->M_j, "M_j", nowhere);
  for (int k = 0; k < outputs->count; k++) {
    ir_node *known = binding_of(c, outputs->items[k]);
    out->outputs[k] =
        known ? *known : fail(c, outputs->items[k]->where, "this output has no value");
  }
}

static void resolve_text(lowering *c, const ir_node *from, const ir_node *to) {
  ir *g = c->graph;
  lowered_text *t = &c->text;
  if (c->mode != LOWER_STEP) return;
  int fields = c->law->fields.count,
      count = fields + t->line_count + t->place_count + 2 * t->flow_count;
  ir_node *all = must_alloc(((size_t)count + 1) * sizeof *all), *at = all;
  for (int k = 0; k < fields; k++)
    *at++ = t->rules[k];
  for (int k = 0; k < t->line_count; k++)
    *at++ = t->lines[k].guard;
  for (int k = 0; k < t->place_count; k++)
    *at++ = t->places[k].node;
  for (int k = 0; k < t->flow_count; k++) {
    *at++ = t->flows[k].when;
    *at++ = t->flows[k].overstress;
  }
  ir_substitute(g, all, count, from, to, c->rule_count, all);
  at = all;
  for (int k = 0; k < fields; k++)
    t->rules[k] = *at++;
  for (int k = 0; k < t->line_count; k++)
    t->lines[k].guard = *at++;
  for (int k = 0; k < t->place_count; k++)
    t->places[k].node = *at++;
  for (int k = 0; k < t->flow_count; k++) {
    t->flows[k].when = *at++;
    t->flows[k].overstress = *at++;
  }
  free(all);
}

static void *keep(arena *memory, void *items, int count, size_t size) {
  void *kept = arena_alloc(memory, ((size_t)count + 1) * size);
  if (count) memcpy(kept, items, (size_t)count * size);
  free(items);
  return kept;
}

/* Puts the rules in place of the opaque new values. A rule reads new values of rules above it. */
static void resolve_fields(lowering *c, lowered_law *out) {
  ir *g = c->graph;
  int fields = c->law->fields.count;
  ir_node *from = must_alloc(((size_t)fields + 1) * sizeof *from);
  ir_node *to = must_alloc(((size_t)fields + 1) * sizeof *to);
  for (int k = 0; k < c->rule_count; k++) { /* every field has a rule: the checker sees to that */
    int f = c->rule_order[k];
    ir_substitute(g, &c->rule[f], 1, from, to, k, &out->fields[f]);
    name_node(g, out->fields[f], c->law->fields.items[f]->name,
              c->law->fields.items[f]->rule->where);
    from[k] = c->new_value[f];
    to[k] = out->fields[f];
  }
  ir_node *results[] = {&out->N, &out->M_i, &out->M_j, &out->W};
  for (size_t k = 0; k < sizeof results / sizeof *results; k++)
    if (*results[k] != IR_NONE)
      ir_substitute(g, results[k], 1, from, to, c->rule_count, results[k]);
  ir_substitute(g, out->outputs, c->law->outputs.count, from, to, c->rule_count, out->outputs);
  resolve_text(c, from, to);
  free(from);
  free(to);
}

static bool is_pairwise(const law *l, diagnostics *d) {
  if (l->tree->law != LAW_STATE) return true;
  diag_report(d, DIAG_NOT_SUPPORTED, l->tree->law_where,
              "laws of a particle's whole family can be checked but not compiled yet");
  diag_hint(d, "write it as a `law central bond` or a `law micropolar bond`");
  return false;
}

bool lower_law(const law *l, ir *g, lower_mode mode, arena *memory, lowered_law *out,
               diagnostics *d) {
  if (!is_pairwise(l, d)) return false;
  int fields = l->fields.count;
  size_t field_bytes = ((size_t)fields + 1) * sizeof(ir_node);
  lowering c = {.law = l, .graph = g, .mode = mode, .memory = memory, .said = d};
  *out = (lowered_law){IR_NONE, IR_NONE, IR_NONE, IR_NONE, NULL, NULL, {0}};
  c.text.rules = arena_alloc(memory, field_bytes);
  c.new_value = must_alloc(field_bytes);
  c.rule = must_alloc(field_bytes);
  c.rule_order = must_alloc(((size_t)fields + 1) * sizeof *c.rule_order);
  out->fields = arena_alloc(memory, field_bytes);
  out->outputs = arena_alloc(memory, ((size_t)l->outputs.count + 1) * sizeof(ir_node));
  for (int k = 0; k < fields; k++) {
    c.new_value[k] = mode == LOWER_FROZEN ? lower_field(g, l, k) : opaque_field(g, l, k);
    c.text.rules[k] = out->fields[k] = lower_field(g, l, k);
  }
  for (int k = 0; k < l->rule_count && !c.failed; k++)
    lower_rule(&c, l->rules[k]);
  if (!c.failed) lower_results(&c, out);
  if (!c.failed && mode != LOWER_FROZEN) resolve_fields(&c, out);
  lowered_text *t = &c.text;
  t->lines = keep(memory, t->lines, t->line_count, sizeof *t->lines);
  t->places = keep(memory, t->places, t->place_count, sizeof *t->places);
  t->flows = keep(memory, t->flows, t->flow_count, sizeof *t->flows);
  out->text = c.text;
  free(c.bound);
  free(c.new_value);
  free(c.rule);
  free(c.rule_order);
  return !c.failed;
}

ir_node lower_bound(ir *g, const law *l, const expr *bound, double infinite, diagnostics *d) {
  if (!bound) return ir_constant(g, infinite);
  arena *memory = arena_new();
  lowering c = {.law = l, .graph = g, .mode = LOWER_STEP, .memory = memory, .said = d};
  ir_node n = lower_expr(&c, bound);
  free(c.bound);
  arena_free(memory);
  return c.failed ? IR_NONE : n;
}

/* --- energy ----------------------------------------------------------------------------------- */

enum { ENERGY_PAIRS = 3 }; /* N with the stretch, M_i with theta_i, M_j with theta_j */

typedef struct energy_parts {
  ir_node force[ENERGY_PAIRS];  /* N, M_i, M_j at zero rate; IR_NONE where there is none */
  ir_node motion[ENERGY_PAIRS]; /* stretch, theta_i, theta_j */
  ir_node s, length;
} energy_parts;

static energy_parts parts_at_zero_rate(ir *g, const lowered_law *frozen) {
  energy_parts p = {{frozen->N, frozen->M_i, frozen->M_j},
                    {lower_quantity(g, QUANTITY_STRETCH), IR_NONE, IR_NONE},
                    lower_quantity(g, QUANTITY_S),
                    lower_quantity(g, QUANTITY_LENGTH)};
  ir_node rate = lower_quantity(g, QUANTITY_STRETCH_RATE);
  for (int k = 0; k < ENERGY_PAIRS; k++)
    if (p.force[k] != IR_NONE) rewrite_zero(g, &p.force[k], 1, &rate, 1, &p.force[k]);
  if (frozen->M_i != IR_NONE) {
    p.motion[1] = lower_quantity(g, QUANTITY_THETA_I);
    p.motion[2] = lower_quantity(g, QUANTITY_THETA_J);
  }
  return p;
}

static bool is_homogeneous(const ir *g, ir_node f, const energy_parts *p) {
  if (rewrite_depends(g, &f, 1, &p->length, 1)) /* s (1 + stretch) is not */
    return false;
  double degree = rewrite_degree(g, f, p->motion, ENERGY_PAIRS);
  return degree == 1 || degree == REWRITE_ZERO;
}

/* Work of force k over its motion; that of N is N s d(stretch). */
static ir_node work(ir *g, const energy_parts *p, int k, ir_node force) {
  ir_node w = ir_mul(g, force, p->motion[k]);
  return k == 0 ? ir_mul(g, w, p->s) : w;
}

static ir_node half(ir *g, ir_node n) {
  return ir_mul(g, ir_constant(g, 0.5), n);
}

static ir_node add_some(ir *g, ir_node a, ir_node b) {
  return a == IR_NONE ? b : ir_add(g, a, b);
}

static ir_node half_work(ir *g, const energy_parts *p, int first) {
  ir_node sum = IR_NONE;
  for (int k = first; k < ENERGY_PAIRS; k++)
    if (p->force[k] != IR_NONE) sum = add_some(g, sum, half(g, work(g, p, k, p->force[k])));
  return sum;
}

/* N = k (stretch - stretch_0): s N^2/(2k), zero where it is stress-free. With k = 0 the bond
   carries nothing. IR_NONE when N is not of this form. */
static ir_node affine_energy(ir *g, const energy_parts *p) {
  ir_node N = p->force[0];
  ir_node moving[] = {p->motion[0], p->motion[1], p->motion[2], p->length};
  ir_node k = ir_derivative(g, N, p->motion[0]);
  if (rewrite_depends(g, &N, 1, moving + 1, 3) || rewrite_depends(g, &k, 1, moving, 4) ||
      ir_operation(g, k) == IR_CONSTANT)
    return IR_NONE;
  ir_node one = ir_constant(g, 1);
  ir_node none = binary(g, IR_EQ, k, ir_constant(g, 0));
  ir_node divisor = ir_select(g, none, one, k);
  return half(g, ir_div(g, ir_mul(g, ir_mul(g, N, N), p->s), divisor));
}

/* Integral over the straight path from rest: Gauss-Legendre on [0, 1]. */
static ir_node path_energy(ir *g, const energy_parts *p) {
  static const double at[2] = {0.86113631159405257522, 0.33998104358485626480};
  static const double weight[2] = {0.34785484513745385737, 0.65214515486254614263};
  ir_node sum = IR_NONE;
  for (int point = 0; point < 4; point++) {
    double sign = point < 2 ? -1 : 1;
    ir_node fraction = ir_constant(g, 0.5 * (1 + sign * at[point % 2]));
    ir_node from[ENERGY_PAIRS + 1], to[ENERGY_PAIRS + 1];
    int count = 0;
    for (int k = 0; k < ENERGY_PAIRS; k++) {
      if (p->motion[k] == IR_NONE) continue;
      from[count] = p->motion[k];
      to[count++] = ir_mul(g, fraction, p->motion[k]);
    }
    from[count] = p->length;
    to[count++] = ir_add(g, p->s, ir_mul(g, fraction, ir_sub(g, p->length, p->s)));
    for (int k = 0; k < ENERGY_PAIRS; k++) {
      if (p->force[k] == IR_NONE) continue;
      ir_node here;
      ir_substitute(g, &p->force[k], 1, from, to, count, &here);
      sum =
          add_some(g, sum, ir_mul(g, ir_constant(g, 0.5 * weight[point % 2]), work(g, p, k, here)));
    }
  }
  return sum;
}

ir_node lower_stored_energy(const law *l, ir *g, const lowered_law *frozen) {
  (void)l;
  if (frozen->W != IR_NONE) {
    ir_node rate = lower_quantity(g, QUANTITY_STRETCH_RATE), W;
    rewrite_zero(g, &frozen->W, 1, &rate, 1, &W);
    return W;
  }
  energy_parts p = parts_at_zero_rate(g, frozen);
  bool homogeneous[ENERGY_PAIRS];
  for (int k = 0; k < ENERGY_PAIRS; k++)
    homogeneous[k] = p.force[k] == IR_NONE || is_homogeneous(g, p.force[k], &p);
  if (homogeneous[0] && homogeneous[1] && homogeneous[2]) return half_work(g, &p, 0);
  ir_node moments[] = {p.force[1], p.force[2]};
  bool central = p.force[1] == IR_NONE;
  bool apart = central || !rewrite_depends(g, moments, 2, p.motion, 1);
  ir_node axial = apart && homogeneous[1] && homogeneous[2] ? affine_energy(g, &p) : IR_NONE;
  if (axial == IR_NONE) return path_energy(g, &p);
  return central ? axial : ir_add(g, axial, half_work(g, &p, 1));
}

ir_node lower_rate_power(const law *l, ir *g, const lowered_law *frozen, ir_node theta_rate_i,
                         ir_node theta_rate_j) {
  (void)l;
  energy_parts p = parts_at_zero_rate(g, frozen);
  ir_node whole[ENERGY_PAIRS] = {frozen->N, frozen->M_i, frozen->M_j};
  ir_node length_rate = ir_mul(g, lower_quantity(g, QUANTITY_STRETCH_RATE), p.s);
  ir_node rate[ENERGY_PAIRS] = {length_rate, theta_rate_i, theta_rate_j};
  ir_node power = IR_NONE, stretch_rate = lower_quantity(g, QUANTITY_STRETCH_RATE);
  for (int k = 0; k < ENERGY_PAIRS; k++) {
    if (whole[k] == IR_NONE || !rewrite_depends(g, &whole[k], 1, &stretch_rate, 1)) continue;
    ir_node part = ir_sub(g, whole[k], p.force[k]);
    power = add_some(g, power, ir_mul(g, part, rate[k]));
  }
  return power;
}
