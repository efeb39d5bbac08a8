#include "generator/target/expression.h"

#include <stdlib.h>
#include <string.h>

#include "generator/plan/plan_roots.h"

/* Operations written into one expression before it is broken into lines. */
enum { LONGEST_INLINE = 6 };

const char *numeral(const emitter *e, int number) {
  return arena_printf(e->memory, "%d", number);
}

/* --- what a function is written from ---------------------------------------------------------- */

bool expression_is_ends_input(const emitter *e, ir_node n, ends_input which) {
  return expression_is_input(e, n) && ir_input_source(e->graph, n) == IR_FROM_ENDS &&
         ir_input_index(e->graph, n) == (int)which;
}

const char *expression_time(emitter *e, ir_node n, word time_step, word advance) {
  return spell(e, expression_is_ends_input(e, n, ENDS_ADVANCE) ? advance : time_step);
}

bool expression_reads(const emitter *e, ir_source from) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (e->needed[n] && ir_operation(e->graph, n) == IR_INPUT &&
        ir_input_source(e->graph, n) == from)
      return true;
  return false;
}

static bool is_constant(const emitter *e, ir_node n) {
  return ir_operation(e->graph, n) == IR_CONSTANT;
}

const segment_root *expression_find_root(const emitter *e, segment_target target, int index) {
  for (int k = 0; k < e->root_count; k++)
    if (e->roots[k].target == target && e->roots[k].index == index) return &e->roots[k];
  return NULL;
}

/* --- which nodes get a line ------------------------------------------------------------------- */

static void use_node(emitter *e, ir_node n, ir_node user) {
  e->needed[n] = 1;
  e->uses[n]++;
  e->user[n] = user;
}

static int operand_count(const emitter *e, ir_node n) {
  return expression_is_uniform(e, n) ? 0 : ir_arity(ir_operation(e->graph, n));
}

/* Marks what the roots need; nodes only refer to earlier ones, so one walk down is enough. */
static void find_needed(emitter *e, const ir_node *nodes, int count) {
  for (int k = 0; k < count; k++)
    use_node(e, nodes[k], IR_NONE);
  for (ir_node n = e->node_count - 1; n >= 0; n--)
    for (int k = 0; e->needed[n] && k < operand_count(e, n); k++)
      use_node(e, ir_operand(e->graph, n, k), n);
}

/* A condition asked directly by a select or inside another condition; `a and (b or c)` nests to the
 * right only. */
static bool is_inline_condition(const emitter *e, ir_node n, ir_node user) {
  ir_op op = ir_operation(e->graph, n),
        asking = user == IR_NONE ? IR_ADD : ir_operation(e->graph, user);
  bool asked = ir_operand(e->graph, user == IR_NONE ? n : user, 0) == n;
  if (op == IR_AND || op == IR_OR) return (asking == IR_AND || asking == IR_OR) && !asked;
  return asking == IR_AND || asking == IR_OR || asking == IR_NOT || (asking == IR_SELECT && asked);
}

/* x < y ? x : y, or the larger: the function that this is; NULL for other nodes. */
static const char *extreme_function(const emitter *e, ir_node n) {
  if (ir_operation(e->graph, n) != IR_SELECT) return NULL;
  const ir_node asked = ir_operand(e->graph, n, 0), yes = ir_operand(e->graph, n, 1),
                no = ir_operand(e->graph, n, 2);
  if (ir_operation(e->graph, asked) != IR_LT) return NULL;
  const ir_node x = ir_operand(e->graph, asked, 0), y = ir_operand(e->graph, asked, 1);
  return yes == x && no == y ? "smaller" : yes == y && no == x ? "larger" : NULL;
}

bool expression_is_extreme(const emitter *e, ir_node n) {
  return extreme_function(e, n) != NULL;
}

/* May be part of a longer expression. A select goes into the last place of another one, as a chain
   of cases; not in strips, where gcc would ask more questions than there are. Values that a select
   chooses from are computed on lines of their own when they divide, so that no compiler thinks of
   branching. */
static bool is_inline(const emitter *e, ir_node n) {
  ir_op op = ir_operation(e->graph, n);
  if (op == IR_CONSTANT || expression_is_ends_input(e, n, ENDS_PROTECTED) ||
      ir_is_expected(e->graph, n))
    return true;
  if (e->uses[n] > 1 || ir_name(e->graph, n) || e->size[n] > LONGEST_INLINE ||
      expression_is_uniform(e, n))
    return false;
  ir_node user = e->user[n];
  if (expression_is_of_time(e, n) && (user == IR_NONE || !expression_is_of_time(e, user)))
    return false;
  bool chosen = user == IR_NONE || ir_operation(e->graph, user) == IR_SELECT;
  switch (op) {
  case IR_ADD:
  case IR_SUB:
  case IR_MUL:
  case IR_FMA:
  case IR_NEG:
  case IR_ABS:
    return true;
  case IR_DIV:
    return !chosen;
  case IR_SELECT:
    return user != IR_NONE && chosen && ir_operand(e->graph, user, 2) == n && !e->scope->strip &&
           !extreme_function(e, n);
  default:
    return ir_is_logical(e->graph, n) && is_inline_condition(e, n, user);
  }
}

static const char *wished_name(const emitter *e, ir_node n) {
  const char *given = ir_name(e->graph, n);
  if (ir_operation(e->graph, n) == IR_INPUT && ir_input_source(e->graph, n) == IR_FROM_FIELD)
    return arena_printf(e->memory, "old_%s", given ? given : "field");
  return given ? given : arena_printf(e->memory, "v%d", (int)n);
}

/* An input that is called like the array it is from: slot_0, plane_0. */
static bool is_pass_own(const emitter *e, ir_node n) {
  if (ir_operation(e->graph, n) != IR_INPUT || !ir_name(e->graph, n)) return false;
  const ir_source from = ir_input_source(e->graph, n);
  return from == IR_FROM_SLOT || from == IR_FROM_PLANE;
}

/* A uniform of a large loop has no name: there are more of them than registers. */
static bool reads_in_place(const emitter *e, ir_node n) {
  return e->plan->large && expression_is_uniform(e, n);
}

/* The model's names first, so that they stay as they are; then those of the nameless. */
static void choose_names(emitter *e) {
  for (ir_node n = 0; n < e->node_count; n++) {
    if (!e->needed[n]) continue;
    e->size[n] = 1;
    for (int k = 0; k < operand_count(e, n); k++) {
      ir_node operand = ir_operand(e->graph, n, k);
      e->size[n] += is_inline(e, operand) ? e->size[operand] : 0;
    }
  }
  for (int named = 1; named >= 0; named--)
    for (ir_node n = 0; n < e->node_count; n++)
      if (e->needed[n] && (ir_name(e->graph, n) != NULL) == named && !is_inline(e, n))
        e->name[n] = reads_in_place(e, n)
                         ? spell(e, e->scope->uniform, numeral(e, e->uniform_of[n]))
                     : is_pass_own(e, n) && c_names_reserve(&e->names, ir_name(e->graph, n))
                         ? ir_name(e->graph, n)
                         : c_names_make(&e->names, wished_name(e, n));
}

/* --- the order of lines ----------------------------------------------------------------------- */

/* Values that wait at most while node n is computed, its operands in the order that needs the
   fewest (Sethi and Ullman 1970, of trees; nodes with more users are counted for each). Sorts the
   operands; of equals the last, behind which a chain of cases goes on, comes first. */
static int waiting_values(const emitter *e, const int *waiting, ir_node n, ir_node operand[3]) {
  const int count = operand_count(e, n);
  int most = is_constant(e, n) ? 0 : 1;
  for (int k = 0; k < count; k++) {
    const ir_node o = ir_operand(e->graph, n, count - 1 - k);
    int at = k;
    for (; at > 0 && waiting[operand[at - 1]] < waiting[o]; at--)
      operand[at] = operand[at - 1];
    operand[at] = o;
  }
  for (int k = 0; k < count; k++)
    if (waiting[operand[k]] + k > most) most = waiting[operand[k]] + k;
  return most;
}

typedef struct ordering {
  const emitter *e;
  int *waiting;   /* [node_count] */
  ir_node *open;  /* [node_count] nodes whose operands are placed, each below the next */
  int *placed;    /* [node_count] operands that have been, and one more once the node is */
  ir_node *order; /* [count] */
  int count;
} ordering;

/* Node n behind all that it needs. */
static void put_behind_operands(ordering *o, ir_node n) {
  int depth = 0;
  if (o->placed[n] == 0) o->open[depth++] = n;
  while (depth > 0) {
    const ir_node top = o->open[depth - 1];
    const int count = operand_count(o->e, top);
    ir_node operand[3];
    waiting_values(o->e, o->waiting, top, operand);
    const int next = o->placed[top]++;
    if (next < count) {
      if (o->placed[operand[next]] == 0) o->open[depth++] = operand[next];
      continue;
    }
    o->order[o->count++] = top;
    depth--;
  }
}

/* Of a large loop: each value shortly before it is used. As the graph stands all lines of a chain
   of cases would wait, more than there are registers, for the first to be chosen from. */
static void choose_order(emitter *e) {
  const size_t size = (size_t)e->node_count + 1;
  ordering o = {.e = e,
                .waiting = must_calloc(size, sizeof(int)),
                .open = must_alloc(size * sizeof(ir_node)),
                .placed = must_calloc(size, sizeof(int)),
                .order = must_alloc(size * sizeof(ir_node))};
  for (ir_node n = 0; n < e->node_count; n++) {
    ir_node operand[3];
    o.waiting[n] = waiting_values(e, o.waiting, n, operand);
  }
  for (ir_node n = e->node_count - 1; n >= 0; n--)
    if (e->needed[n]) put_behind_operands(&o, n);
  for (ir_node n = 0; n < e->node_count; n++)
    put_behind_operands(&o, n);
  free(o.waiting);
  free(o.open);
  free(o.placed);
  e->order = o.order;
}

/* --- a function's nodes ----------------------------------------------------------------------- */

void emitter_begin(emitter *e, const kernel_plan *plan, c_text *out) {
  *e = (emitter){.plan = plan, .graph = plan->graph, .out = out, .memory = arena_new()};
  e->node_count = ir_count(plan->graph);
  e->uniform_of = must_calloc((size_t)e->node_count + 1, sizeof *e->uniform_of);
  for (int n = 0; n < e->node_count; n++)
    e->uniform_of[n] = -1;
  for (int k = 0; k < plan->uniform_count; k++)
    e->uniform_of[plan->uniforms[k]] = k;
  e->of_time = must_calloc((size_t)e->node_count + 1, 1);
  plan_mark_of_time(plan, e->of_time);
}

void emitter_end(emitter *e) {
  free(e->uniform_of);
  free(e->of_time);
  arena_free(e->memory);
}

static void open_nodes(emitter *e, const scope *in, const ir_node *nodes, int count) {
  size_t n = (size_t)e->node_count + 1;
  e->scope = in;
  e->names = (c_names){0};
  words_reserve(&e->names);
  e->needed = must_calloc(n, 1);
  e->uses = must_calloc(n, sizeof *e->uses);
  e->user = must_calloc(n, sizeof *e->user);
  e->size = must_calloc(n, sizeof *e->size);
  e->name = must_calloc(n, sizeof *e->name);
  find_needed(e, nodes, count);
  choose_names(e);
  e->order = NULL;
  if (e->plan->large) choose_order(e);
}

void expression_open(emitter *e, const scope *in, const ir_node *nodes, int count) {
  e->roots = NULL;
  e->root_count = 0;
  open_nodes(e, in, nodes, count);
}

void expression_open_segment(emitter *e, const scope *in, const segment *a) {
  ir_node *nodes = must_alloc((2 * (size_t)a->root_count + 1) * sizeof *nodes);
  e->roots = a->roots;
  e->root_count = a->root_count;
  open_nodes(e, in, nodes, segment_nodes(e->graph, a, nodes));
  free(nodes);
}

void expression_close(emitter *e) {
  c_names_clear(&e->names);
  free(e->needed);
  free(e->uses);
  free(e->user);
  free(e->size);
  free(e->name);
  free(e->order);
}

/* --- expressions ------------------------------------------------------------------------------ */

/* How tightly an expression holds together; C's precedences, highest for names and calls. */
enum { LEVEL_CHOICE = 1, LEVEL_SUM, LEVEL_PRODUCT, LEVEL_SIGN, LEVEL_ATOM };

/* Operations that are no call: how tightly they hold together, and how tightly the operands must.
   */
typedef struct operator_text {
  int level;
  const char *sign; /* between two operands */
  int left, right;
} operator_text;

static const operator_text operators[IR_OP_COUNT] = {
    [IR_ADD] = {LEVEL_SUM, " + ", LEVEL_SUM, LEVEL_PRODUCT},
    [IR_SUB] = {LEVEL_SUM, " - ", LEVEL_SUM, LEVEL_PRODUCT},
    [IR_MUL] = {LEVEL_PRODUCT, "*", LEVEL_PRODUCT, LEVEL_ATOM},
    [IR_DIV] = {LEVEL_PRODUCT, "/", LEVEL_PRODUCT, LEVEL_ATOM},
    [IR_NEG] = {LEVEL_SIGN, NULL, 0, 0},
    [IR_LT] = {LEVEL_CHOICE, " < ", LEVEL_SUM, LEVEL_SUM},
    [IR_LE] = {LEVEL_CHOICE, " <= ", LEVEL_SUM, LEVEL_SUM},
    [IR_EQ] = {LEVEL_CHOICE, " == ", LEVEL_SUM, LEVEL_SUM},
    [IR_AND] = {LEVEL_CHOICE, NULL, 0, 0},
    [IR_OR] = {LEVEL_CHOICE, NULL, 0, 0},
    [IR_NOT] = {LEVEL_CHOICE, NULL, 0, 0},
    [IR_SELECT] = {LEVEL_CHOICE, NULL, 0, 0},
};

static const char *expression(const emitter *e, ir_node n);

static const char *number(const emitter *e, double value) {
  c_text digits = {0};
  c_text_number(&digits, value);
  const char *text = arena_text(e->memory, digits.text, digits.length);
  free(digits.text);
  return text;
}

/* Node n itself as an operand that must hold together at least as tightly as `level`. The
   parentheses are those that keep the order of evaluation of the graph. */
static const char *grouped(const emitter *e, ir_node n, int level) {
  const int own = operators[ir_operation(e->graph, n)].level;
  const char *text = expression(e, n);
  return own == 0 || own >= level ? text : arena_printf(e->memory, "(%s)", text);
}

static const char *operand(const emitter *e, ir_node n, int level) {
  if (is_constant(e, n)) return number(e, ir_value(e->graph, n));
  return e->name[n] ? e->name[n] : grouped(e, n, level);
}

const char *expression_value(const emitter *e, ir_node n) {
  return operand(e, n, LEVEL_SUM);
}

const char *expression_whole(const emitter *e, ir_node n) {
  return operand(e, n, LEVEL_CHOICE);
}

static const char *infix(const emitter *e, ir_node n) {
  const operator_text *o = &operators[ir_operation(e->graph, n)];
  const char *left = operand(e, ir_operand(e->graph, n, 0), o->left);
  return arena_printf(e->memory, "%s%s%s", left, o->sign,
                      operand(e, ir_operand(e->graph, n, 1), o->right));
}

bool expression_asks_protected(const emitter *e, ir_node n) {
  return ir_operation(e->graph, n) == IR_LT && is_constant(e, ir_operand(e->graph, n, 0)) &&
         ir_value(e->graph, ir_operand(e->graph, n, 0)) == 0 &&
         expression_is_ends_input(e, ir_operand(e->graph, n, 1), ENDS_PROTECTED);
}

/* Logical nodes are doubles, 0 or 1, made by choices: gcc turns integers made of several
   comparisons into branches, and then the loop does not vectorise. */
const char *expression_condition(const emitter *e, ir_node n) {
  ir_op op = ir_operation(e->graph, n);
  if (e->name[n]) return spell(e, SAY_NOT_ZERO, e->name[n]);
  if (expression_asks_protected(e, n)) return spell(e, SAY_IS_PROTECTED);
  if (op == IR_LT || op == IR_LE || op == IR_EQ) return infix(e, n);
  if (op == IR_NOT) return spell(e, SAY_NOT, expression_condition(e, ir_operand(e->graph, n, 0)));
  return spell(e, SAY_NOT_ZERO, expression_value(e, n));
}

static const char *logical(const emitter *e, ir_node n) {
  const ir_node first = ir_operand(e->graph, n, 0);
  switch (ir_operation(e->graph, n)) {
  case IR_AND:
    return spell(e, SAY_CHOICE, expression_condition(e, first),
                 expression_value(e, ir_operand(e->graph, n, 1)), "0.0");
  case IR_OR:
    return spell(e, SAY_CHOICE, expression_condition(e, first), "1.0",
                 expression_value(e, ir_operand(e->graph, n, 1)));
  case IR_NOT:
    return spell(e, SAY_CHOICE, expression_condition(e, first), "0.0", "1.0");
  default:
    return spell(e, SAY_CHOICE, infix(e, n), "1.0", "0.0");
  }
}

static const char *call(const emitter *e, const char *function, ir_node n, int first) {
  const int end = ir_arity(ir_operation(e->graph, n));
  const char *arguments = expression_whole(e, ir_operand(e->graph, n, first));
  for (int k = first + 1; k < end; k++)
    arguments = arena_printf(e->memory, "%s, %s", arguments,
                             expression_whole(e, ir_operand(e->graph, n, k)));
  return spell(e, SAY_CALL, function, arguments);
}

static const char *choice(const emitter *e, ir_node n) {
  const ir_node asked = ir_operand(e->graph, n, 0), yes = ir_operand(e->graph, n, 1),
                no = ir_operand(e->graph, n, 2);
  /* gcc takes a chain of cases apart into more questions than there are; of this it makes one
     operation. */
  if (extreme_function(e, n)) return call(e, extreme_function(e, n), n, 1);
  if ((e->relies & RELIES_ON_EXPECTED) && ir_is_expected(e->graph, asked))
    return expression_whole(e, yes);
  if ((e->relies & RELIES_ON_UNPROTECTED) && e->name[n] && expression_asks_protected(e, asked))
    return expression_whole(e, no);
  const bool chain = !e->name[no] && ir_operation(e->graph, no) == IR_SELECT;
  return spell(e, chain ? SAY_CASE : SAY_CHOICE, expression_condition(e, asked),
               expression_value(e, yes), expression_whole(e, no));
}

static const char *expression(const emitter *e, ir_node n) {
  const ir_op op = ir_operation(e->graph, n);
  switch (op) {
  case IR_ADD:
  case IR_SUB:
  case IR_MUL:
  case IR_DIV:
    return infix(e, n);
  case IR_NEG:
    return arena_printf(e->memory, "-%s", operand(e, ir_operand(e->graph, n, 0), LEVEL_ATOM));
  case IR_LT:
  case IR_LE:
  case IR_EQ:
  case IR_AND:
  case IR_OR:
  case IR_NOT:
    return logical(e, n);
  case IR_SELECT:
    return choice(e, n);
  case IR_INPUT: /* no other is written in place */
    return arena_printf(e->memory, "(%s)",
                        spell(e, SAY_CHOICE, spell(e, SAY_IS_PROTECTED), "1.0", "0.0"));
  default:
    return call(e, ir_op_name(op), n, 0);
  }
}

/* --- lines ------------------------------------------------------------------------------------ */

/* The line of the model file; nothing for lines of included files, whose numbers would mislead. */
const char *expression_line_end(const emitter *e, ir_node n) {
  span where = ir_where(e->graph, n);
  const law *l = e->plan->law;
  if (!where.end || where.file != l->tree->name_where.file) return spell(e, SAY_LINE_END);
  const int line = source_line_number(l->sources, where.file, where.begin);
  return spell(e, SAY_LINE_END_OF, numeral(e, line));
}

void expression_line_of_time(emitter *e, ir_node n, const char *indent) {
  if (e->name[n])
    say(e, SAY_LINE, indent, e->name[n], expression(e, n), expression_line_end(e, n));
}

/* What the loop needs, and what its values of time are computed from. */
static unsigned char *needed_before_loop(const emitter *e) {
  unsigned char *mask = must_alloc((size_t)e->node_count + 1);
  memcpy(mask, e->needed, (size_t)e->node_count);
  for (ir_node n = e->node_count - 1; n >= 0; n--)
    for (int k = 0; mask[n] && expression_is_of_time(e, n) && k < operand_count(e, n); k++)
      mask[ir_operand(e->graph, n, k)] = 1;
  return mask;
}

void expression_declare(emitter *e) {
  unsigned char *mask = needed_before_loop(e);
  for (ir_node n = 0; n < e->node_count; n++) {
    if (!mask[n] || is_constant(e, n)) continue;
    if (expression_is_uniform(e, n)) {
      if (e->name[n] &&
          !e->plan->large) /* the condition of the larger of two has none: nothing reads it */
        say(e, SAY_LINE, e->scope->before, e->name[n],
            spell(e, e->scope->uniform, numeral(e, e->uniform_of[n])), expression_line_end(e, n));
    } else if (expression_is_input(e, n))
      e->scope->declare(e, n);
    else if (expression_is_of_time(e, n))
      expression_line_of_time(e, n, e->scope->before);
  }
  free(mask);
}

static const char *dropped(const emitter *e, ir_node n) {
  return spell(e, SAY_CHOICE, spell(e, SAY_NOT_ABSENT), grouped(e, n, LEVEL_SUM), "0.0");
}

void expression_line(emitter *e, ir_node n) {
  if (!e->needed[n] || !e->name[n] || expression_is_uniform(e, n) || expression_is_of_time(e, n))
    return;
  const char *value = e->dropped && e->dropped[n] ? dropped(e, n)
                      : expression_is_input(e, n) || ir_operation(e->graph, n) == IR_SEARCH
                          ? e->scope->input(e, n)
                          : expression(e, n);
  say(e, SAY_LINE, e->scope->indent, e->name[n], value, expression_line_end(e, n));
}

void expression_lines(emitter *e) {
  for (int k = 0; k < e->node_count; k++)
    expression_line(e, expression_in_order(e, k));
}
