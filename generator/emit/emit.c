#include "generator/emit/emit.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/emit/emit_parts.h"
#include "generator/emit/prelude.h"
#include "generator/lower/law_inputs.h"

#define LONGEST_INLINE                                                                             \
  6 /* operations written into one expression before it is broken into lines                       \
     */

/* --- what a function is written from ---------------------------------------------------------- */

static bool in_loop(const emitter *e) {
  return e->scope >= IN_ROWS;
}

/* A value loaded from `uniforms`; in `prepare` the same node is computed. */
bool emit_is_uniform(const emitter *e, ir_node n) {
  return in_loop(e) && e->uniform_of[n] >= 0;
}

bool emit_is_input(const emitter *e, ir_node n) {
  return ir_operation(e->graph, n) == IR_INPUT && !emit_is_uniform(e, n);
}

static bool is_ends_input(const emitter *e, ir_node n, ends_input which) {
  return emit_is_input(e, n) && ir_input_source(e->graph, n) == IR_FROM_ENDS &&
         ir_input_index(e->graph, n) == (int)which;
}

static bool is_constant(const emitter *e, ir_node n) {
  return ir_operation(e->graph, n) == IR_CONSTANT;
}

/* --- names of inputs -------------------------------------------------------------------------- */

/* Values of a bond class, as C. */
static const char *const class_values[QUANTITY_COUNT] = {
#define X(code, value) [QUANTITY_##code] = #value,
    CLASS_QUANTITIES(X)
#undef X
};

/* --- a function's nodes ----------------------------------------------------------------------- */

static void use_node(emitter *e, ir_node n, ir_node user) {
  e->needed[n] = 1;
  e->uses[n]++;
  e->user[n] = user;
}

static int operand_count(const emitter *e, ir_node n) {
  return emit_is_uniform(e, n) ? 0 : ir_arity(ir_operation(e->graph, n));
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

/* May be part of a longer expression. A select goes into the last place of another one, as a chain
   of cases; not in strips, where gcc would ask more questions than there are. Values that a select chooses from are computed on lines of their own when they divide,
   so that no compiler thinks of branching. */
static bool is_inline(const emitter *e, ir_node n) {
  ir_op op = ir_operation(e->graph, n);
  if (op == IR_CONSTANT || (in_loop(e) && is_ends_input(e, n, ENDS_PROTECTED)) ||
      ir_is_expected(e->graph, n))
    return true;
  if (e->uses[n] > 1 || ir_name(e->graph, n) || e->size[n] > LONGEST_INLINE ||
      emit_is_uniform(e, n))
    return false;
  ir_node user = e->user[n];
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
    return user != IR_NONE && chosen && ir_operand(e->graph, user, 2) == n && e->scope != IN_ROWS &&
           !extreme_function(e, n);
  default:
    return ir_is_logical(e->graph, n) && is_inline_condition(e, n, user);
  }
}

static const char *wished_name(const emitter *e, ir_node n, char *space, size_t size) {
  const char *given = ir_name(e->graph, n);
  if (ir_operation(e->graph, n) == IR_INPUT && ir_input_source(e->graph, n) == IR_FROM_FIELD)
    snprintf(space, size, "old_%s", given ? given : "field");
  else if (given)
    return given;
  else
    snprintf(space, size, "v%d", (int)n);
  return space;
}

/* The model's names first, so that they stay as they are; then those of the nameless. */
static void choose_names(emitter *e) {
  char space[128];
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
        e->name[n] = c_names_make(&e->names, wished_name(e, n, space, sizeof space));
}

/* What loops of segments call the things of a root. */
static void reserve_numbered(c_names *names, int root) {
  static const char *const of_root[] = {"to", "value", "values", "far"};
  for (size_t k = 0; k < sizeof of_root / sizeof *of_root; k++) {
    char name[32];
    snprintf(name, sizeof name, "%s_%d", of_root[k], root);
    c_names_reserve(names, name);
  }
}

void emit_open_nodes(emitter *e, scope_kind scope, const ir_node *nodes, int count) {
  static const char *const own[] = {
      "law",        "uniforms",    "strip",         "count",  "q",       "flags",    "in",
      "out",        "bonds",       "present",       "lower",  "upper",   "low_open", "high_open",
      "parameters", "present_bit", "protected_bit", "family", "first",   "lanes",    "k",
      "to",         "half",        "back",          "last",   "kept",    "unusual",  "owned",
      "owner",      "sign",        "zeros",         "got",    "link_to", "changed",  "constant",
      "above",      "large",       "told",          "before", "group",   "lent",     "size_0",
      "size_1",     "largest_0",   "largest_1"};
  size_t n = (size_t)e->node_count + 1;
  e->scope = scope;
  e->roots = NULL;
  e->root_count = count;
  e->names = (c_names){0};
  for (size_t k = 0; k < sizeof own / sizeof *own; k++)
    c_names_reserve(&e->names, own[k]);
#define X(pass, member, task) c_names_reserve(&e->names, #member "_unusual");
  STRIP_PASSES(X)
#undef X
  for (int k = 0; k < count && scope >= IN_PARTICLES; k++)
    reserve_numbered(&e->names, k);
  e->needed = must_calloc(n, 1);
  e->uses = must_calloc(n, sizeof *e->uses);
  e->user = must_calloc(n, sizeof *e->user);
  e->size = must_calloc(n, sizeof *e->size);
  e->name = must_calloc(n, sizeof *e->name);
  find_needed(e, nodes, count);
  choose_names(e);
}

void emit_open_roots(emitter *e, scope_kind scope, const pass_root *roots, int root_count) {
  ir_node *nodes = must_alloc(((size_t)root_count + 1) * sizeof *nodes);
  for (int k = 0; k < root_count; k++)
    nodes[k] = roots[k].node;
  emit_open_nodes(e, scope, nodes, root_count);
  e->roots = roots;
  free(nodes);
}

void emit_close(emitter *e) {
  c_names_clear(&e->names);
  free(e->needed);
  free(e->uses);
  free(e->user);
  free(e->size);
  free(e->name);
}

/* --- expressions ------------------------------------------------------------------------------ */

/* How tightly an expression holds together; C's precedences, highest for names and calls. */
enum { LEVEL_CHOICE = 1, LEVEL_COMPARE = 5, LEVEL_SUM, LEVEL_PRODUCT, LEVEL_SIGN, LEVEL_ATOM };

static void write_expression(emitter *e, ir_node n);

static int level_of(ir_op op) {
  switch (op) {
  case IR_ADD:
  case IR_SUB:
    return LEVEL_SUM;
  case IR_MUL:
  case IR_DIV:
    return LEVEL_PRODUCT;
  case IR_NEG:
    return LEVEL_SIGN;
  case IR_LT:
  case IR_LE:
  case IR_EQ:
  case IR_AND:
  case IR_OR:
  case IR_NOT:
  case IR_SELECT:
    return LEVEL_CHOICE;
  default:
    return LEVEL_ATOM;
  }
}

/* Writes node n as an operand that must hold together at least as tightly as `level`. The
   parentheses are those that keep the order of evaluation of the graph. */
static void write_operand(emitter *e, ir_node n, int level) {
  if (is_constant(e, n))
    c_text_number(e->out, ir_value(e->graph, n));
  else if (e->name[n])
    c_text_add(e->out, "%s", e->name[n]);
  else if (level_of(ir_operation(e->graph, n)) >= level)
    write_expression(e, n);
  else {
    c_text_add(e->out, "(");
    write_expression(e, n);
    c_text_add(e->out, ")");
  }
}

void emit_value(emitter *e, ir_node n) {
  write_operand(e, n, LEVEL_SUM);
}

static void write_infix(emitter *e, ir_node n, const char *sign, int left, int right) {
  write_operand(e, ir_operand(e->graph, n, 0), left);
  c_text_add(e->out, "%s", sign);
  write_operand(e, ir_operand(e->graph, n, 1), right);
}

static void write_comparison(emitter *e, ir_node n) {
  ir_op op = ir_operation(e->graph, n);
  write_infix(e, n, op == IR_LT ? " < " : op == IR_LE ? " <= " : " == ", LEVEL_SUM, LEVEL_SUM);
}

static const char protected_text[] = "(flags[q] & protected_bit) != 0";

bool emit_asks_whether_protected(const emitter *e, ir_node n) {
  return ir_operation(e->graph, n) == IR_LT && is_constant(e, ir_operand(e->graph, n, 0)) &&
         ir_value(e->graph, ir_operand(e->graph, n, 0)) == 0 &&
         is_ends_input(e, ir_operand(e->graph, n, 1), ENDS_PROTECTED);
}

/* Logical nodes are doubles, 0 or 1, made by choices: gcc turns integers made of several
   comparisons into branches, and then the loop does not vectorise. This writes node n as C's
   condition. */
void emit_condition(emitter *e, ir_node n) {
  ir_op op = ir_operation(e->graph, n);
  if (!e->name[n] && emit_asks_whether_protected(e, n)) {
    c_text_add(e->out, "%s", protected_text);
  } else if (!e->name[n] && (op == IR_LT || op == IR_LE || op == IR_EQ)) {
    write_comparison(e, n);
  } else if (!e->name[n] && op == IR_NOT) {
    c_text_add(e->out, "!(");
    emit_condition(e, ir_operand(e->graph, n, 0));
    c_text_add(e->out, ")");
  } else {
    write_operand(e, n, LEVEL_SUM);
    c_text_add(e->out, " != 0.0");
  }
}

static void write_logical(emitter *e, ir_node n) {
  switch (ir_operation(e->graph, n)) {
  case IR_AND:
    emit_condition(e, ir_operand(e->graph, n, 0));
    c_text_add(e->out, " ? ");
    write_operand(e, ir_operand(e->graph, n, 1), LEVEL_SUM);
    c_text_add(e->out, " : 0.0");
    break;
  case IR_OR:
    emit_condition(e, ir_operand(e->graph, n, 0));
    c_text_add(e->out, " ? 1.0 : ");
    write_operand(e, ir_operand(e->graph, n, 1), LEVEL_SUM);
    break;
  case IR_NOT:
    emit_condition(e, ir_operand(e->graph, n, 0));
    c_text_add(e->out, " ? 0.0 : 1.0");
    break;
  default:
    write_comparison(e, n);
    c_text_add(e->out, " ? 1.0 : 0.0");
  }
}

/* gcc takes a chain of cases apart into more questions than there are; of this it makes one operation. */
static void write_extreme(emitter *e, ir_node n) {
  c_text_add(e->out, "pl_%s(", extreme_function(e, n));
  write_operand(e, ir_operand(e->graph, n, 1), LEVEL_CHOICE);
  c_text_add(e->out, ", ");
  write_operand(e, ir_operand(e->graph, n, 2), LEVEL_CHOICE);
  c_text_add(e->out, ")");
}

static void write_select(emitter *e, ir_node n) {
  if (extreme_function(e, n)) {
    write_extreme(e, n);
    return;
  }
  if ((e->relies & SURE_OF_EXPECTED) && ir_is_expected(e->graph, ir_operand(e->graph, n, 0))) {
    write_operand(e, ir_operand(e->graph, n, 1), LEVEL_CHOICE);
    return;
  }
  if ((e->relies & SURE_OF_UNHELD) && e->name[n] &&
      emit_asks_whether_protected(e, ir_operand(e->graph, n, 0))) {
    write_operand(e, ir_operand(e->graph, n, 2), LEVEL_CHOICE);
    return;
  }
  emit_condition(e, ir_operand(e->graph, n, 0));
  c_text_add(e->out, " ? ");
  write_operand(e, ir_operand(e->graph, n, 1), LEVEL_SUM);
  ir_node otherwise = ir_operand(e->graph, n, 2);
  bool chain = !e->name[otherwise] && ir_operation(e->graph, otherwise) == IR_SELECT;
  c_text_add(e->out, chain ? "\n        : " : " : ");
  write_operand(e, otherwise, LEVEL_CHOICE);
}

static void write_call(emitter *e, ir_node n) {
  ir_op op = ir_operation(e->graph, n);
  c_text_add(e->out, "pl_%s(", ir_op_name(op));
  for (int k = 0; k < ir_arity(op); k++) {
    c_text_add(e->out, k ? ", " : "");
    write_operand(e, ir_operand(e->graph, n, k), LEVEL_CHOICE);
  }
  c_text_add(e->out, ")");
}

static void write_expression(emitter *e, ir_node n) {
  switch (ir_operation(e->graph, n)) {
  case IR_ADD:
    write_infix(e, n, " + ", LEVEL_SUM, LEVEL_PRODUCT);
    break;
  case IR_SUB:
    write_infix(e, n, " - ", LEVEL_SUM, LEVEL_PRODUCT);
    break;
  case IR_MUL:
    write_infix(e, n, "*", LEVEL_PRODUCT, LEVEL_ATOM);
    break;
  case IR_DIV:
    write_infix(e, n, "/", LEVEL_PRODUCT, LEVEL_ATOM);
    break;
  case IR_NEG:
    c_text_add(e->out, "-");
    write_operand(e, ir_operand(e->graph, n, 0), LEVEL_ATOM);
    break;
  case IR_LT:
  case IR_LE:
  case IR_EQ:
  case IR_AND:
  case IR_OR:
  case IR_NOT:
    write_logical(e, n);
    break;
  case IR_SELECT:
    write_select(e, n);
    break;
  case IR_INPUT:
    c_text_add(e->out, "(%s ? 1.0 : 0.0)", protected_text); /* no other is written in place */
    break;
  default:
    write_call(e, n);
  }
}

/* "line 12" of the model file; nothing for lines of included files, whose numbers would mislead. */
void emit_line_end(emitter *e, ir_node n) {
  span where = ir_where(e->graph, n);
  const law *l = e->plan->law;
  if (where.end && where.file == l->tree->name_where.file)
    c_text_add(e->out, "; /* line %d */\n",
               source_line_number(l->sources, where.file, where.begin));
  else
    c_text_add(e->out, ";\n");
}

/* --- inputs ----------------------------------------------------------------------------------- */

/* What differs from bond to bond and is no class's is of its motion. */
static int motion_plane(int quantity) {
  const int plane = law_motion_place((builtin_quantity)quantity);
  assert(plane >= 0);
  return plane;
}

static const ends_origin *origin_of(const emitter *e, ir_node n) {
  return &ends_origins[ir_input_index(e->graph, n)];
}

/* `const double *restrict at_u_ix = strip->displacement_i[0];` */
static void write_array(emitter *e, ir_node n) {
  static const char *const arrays[] = {
      [FROM_DISPLACEMENT] = "displacement", [FROM_VELOCITY] = "velocity", [FROM_CHORD] = "chord"};
  static const char *const ends[] = {[OF_I] = "_i", [OF_J] = "_j", [OF_BOND] = ""};
  const int index = ir_input_index(e->graph, n);
  const ir_source from = ir_input_source(e->graph, n);
  c_text_add(e->out, "  const double *restrict at_%s = ", e->name[n]);
  if (from == IR_FROM_ENDS) {
    const ends_origin *o = origin_of(e, n);
    c_text_add(e->out, "strip->%s%s[%d];\n", arrays[o->array], ends[o->owner], o->component);
  } else if (from == IR_FROM_BOND_PARAMETER)
    c_text_add(e->out, "strip->parameter[%d];\n", index);
  else
    c_text_add(e->out, "in[%d];\n",
               from == IR_FROM_FIELD ? PL_STATE_INPUTS + index : motion_plane(index));
}

/* What stands before the loop: values that are the same for all bonds, and the arrays of the
 * others. */
void emit_inputs_before_loop(emitter *e) {
  for (ir_node n = 0; n < e->node_count; n++) {
    if (!e->needed[n] || is_constant(e, n)) continue;
    if (emit_is_uniform(e, n)) {
      c_text_add(e->out, "  const double %s = uniforms[%d]", e->name[n], e->uniform_of[n]);
      emit_line_end(e, n);
    } else if (is_ends_input(e, n, ENDS_TIME_STEP)) {
      c_text_add(e->out, "  const double %s = strip->time_step;\n", e->name[n]);
    } else if (emit_is_input(e, n) && !is_ends_input(e, n, ENDS_PROTECTED)) {
      bool of_strip = e->scope != IN_STATES && ir_input_source(e->graph, n) == IR_FROM_FIELD;
      if (!of_strip) /* a strip's fields are also written: write_field_arrays */
        write_array(e, n);
    }
  }
}

static void write_loop_input(emitter *e, ir_node n) {
  if (e->scope != IN_STATES && ir_input_source(e->graph, n) == IR_FROM_FIELD)
    c_text_add(e->out, "at_field_%d[q]", ir_input_index(e->graph, n));
  else
    c_text_add(e->out, "at_%s[q]", e->name[n]);
}

static void write_body_input(emitter *e, ir_node n) {
  int index = ir_input_index(e->graph, n);
  if (ir_input_source(e->graph, n) == IR_FROM_PARAMETER)
    c_text_add(e->out, "parameters[%d]", index);
  else if (ir_input_source(e->graph, n) == IR_FROM_ENDS)
    c_text_add(e->out, "bonds->chord[%d]", origin_of(e, n)->component);
  else
    c_text_add(e->out, "%s", class_values[index]);
}

/* --- lines ------------------------------------------------------------------------------------ */

static void write_dropped(emitter *e, ir_node n) {
  const bool loose = level_of(ir_operation(e->graph, n)) < LEVEL_SUM;
  c_text_add(e->out, loose ? "present != 0 ? (" : "present != 0 ? ");
  write_expression(e, n);
  c_text_add(e->out, loose ? ") : 0.0" : " : 0.0");
}

void emit_line(emitter *e, ir_node n) {
  const char *indent = e->scope == IN_NEIGHBOURS  ? "        "
                       : e->scope == IN_PARTICLES ? "      "
                       : in_loop(e)               ? "    "
                                                  : "  ";
  if (!e->needed[n] || !e->name[n] || emit_is_uniform(e, n) || is_ends_input(e, n, ENDS_TIME_STEP))
    return;
  c_text_add(e->out, "%sconst double %s = ", indent, e->name[n]);
  if (e->dropped && e->dropped[n])
    write_dropped(e, n);
  else if (!emit_is_input(e, n))
    write_expression(e, n);
  else if (e->scope >= IN_PARTICLES)
    emit_segment_input(e, n);
  else if (in_loop(e))
    write_loop_input(e, n);
  else
    write_body_input(e, n);
  emit_line_end(e, n);
}

void emit_lines(emitter *e) {
  for (ir_node n = 0; n < e->node_count; n++)
    emit_line(e, n);
}

/* --- roots and loops --------------------------------------------------------------------------- */

const pass_root *emit_find_root(const emitter *e, pass_target target, int index) {
  for (int k = 0; k < e->root_count; k++)
    if (e->roots[k].target == target && e->roots[k].index == index) return &e->roots[k];
  return NULL;
}

void emit_function_begin(emitter *e, const char *kind, const char *name, const char *over) {
  e->part = 0;
  for (int k = 1; k < KERNEL_PARTS; k++)
    if (e->part_length[k] < e->part_length[e->part]) e->part = k;
  e->part_start = e->out->length;
  c_text_add(e->out, "%s void %s(const pl_law *, const double *, %s);\n#if PL_IN_PART(%d)\n", kind,
             name, over, e->part);
  c_text_add(e->out, "%s void %s(const pl_law *law, const double *uniforms, %s) {\n", kind, name,
             over);
}

void emit_function_end(emitter *e) {
  c_text_add(e->out, "}\n#endif\n\n");
  e->part_length[e->part] += e->out->length - e->part_start;
}

void emit_loop_begin(emitter *e) {
  c_text_add(e->out, "  PL_INDEPENDENT\n  for (long q = 0; q < count; q++) {\n");
}

/* --- the law alone ---------------------------------------------------------------------------- */

/* `states` and `tangent`. Planes without a root (moments of a central law) are zero. */
static void write_states_pass(emitter *e, const pass *p, const char *name, int planes) {
  emit_open_roots(e, IN_STATES, p->roots, p->root_count);
  emit_function_begin(e, "PL_RARE PL_PASS", name,
                      "long count,\n    const double *const *in, double *const *out");
  c_text_add(e->out, "  (void)law, (void)uniforms, (void)in;\n");
  emit_inputs_before_loop(e);
  for (int k = 0; k < planes; k++)
    c_text_add(e->out, "  double *restrict at_out_%d = out[%d];\n", k, k);
  emit_loop_begin(e);
  emit_lines(e);
  for (int k = 0; k < planes; k++) {
    const pass_root *r = emit_find_root(e, TO_OUT, k);
    c_text_add(e->out, "    at_out_%d[q] = ", k);
    if (r)
      write_operand(e, r->node, LEVEL_CHOICE);
    else
      c_text_add(e->out, "0.0");
    c_text_add(e->out, ";\n");
  }
  c_text_add(e->out, "  }\n");
  emit_function_end(e);
  emit_close(e);
}

/* --- parameters ------------------------------------------------------------------------------- */

static void write_prepare(emitter *e) {
  int count = e->plan->uniform_count;
  pass_root *roots = must_calloc((size_t)count + 1, sizeof *roots);
  for (int k = 0; k < count; k++)
    roots[k] = (pass_root){e->plan->uniforms[k], TO_OUT, k};
  emit_open_roots(e, IN_PREPARE, roots, count);
  c_text_add(e->out, "PL_RARE static void prepare(const pl_law *law, const double *parameters,\n"
                     "    const pl_bond_class *bonds, double *uniforms) {\n"
                     "  (void)law, (void)parameters, (void)bonds, (void)uniforms;\n");
  emit_lines(e);
  for (int k = 0; k < count; k++) {
    c_text_add(e->out, "  uniforms[%d] = ", k);
    write_operand(e, roots[k].node, LEVEL_CHOICE);
    c_text_add(e->out, ";\n");
  }
  c_text_add(e->out, "}\n\n");
  emit_close(e);
  free(roots);
}

/* `lower[3] = 0.0; low_open[3] = 1;` */
static void write_bound(emitter *e, int parameter, pass_target target, const char *value,
                        const char *open, bool is_open, const char *sign) {
  const pass_root *r = emit_find_root(e, target, parameter);
  c_text_add(e->out, "  %s[%d] = ", value, parameter);
  if (r)
    write_operand(e, r->node, LEVEL_CHOICE);
  else
    c_text_add(e->out, "%s__builtin_inf()", sign);
  c_text_add(e->out, ", %s[%d] = %d;\n", open, parameter, !r || is_open);
}

static void write_bounds(emitter *e) {
  const pass *p = &e->plan->passes[PASS_BOUNDS];
  const symbol_list *parameters = &e->plan->law->parameters;
  emit_open_roots(e, IN_BOUNDS, p->roots, p->root_count);
  c_text_add(
      e->out,
      "PL_RARE static void bounds(const pl_law *law, const double *parameters, double *lower,\n"
      "    double *upper, unsigned char *low_open, unsigned char *high_open) {\n"
      "  (void)law, (void)parameters, (void)lower, (void)upper, (void)low_open, "
      "(void)high_open;\n");
  emit_lines(e);
  for (int k = 0; k < parameters->count; k++) {
    const bounds *in = &parameters->items[k]->declared->in;
    write_bound(e, k, TO_LOWER, "lower", "low_open", in->lower_open, "-");
    write_bound(e, k, TO_UPPER, "upper", "high_open", in->upper_open, "");
  }
  c_text_add(e->out, "}\n\n");
  emit_close(e);
}

/* --- the table of facts ----------------------------------------------------------------------- */

static void write_symbol(emitter *e, const symbol *s) {
  char si[64];
  dim_unit(s->dim, si, sizeof si);
  c_text_add(e->out, "    {");
  c_text_string(e->out, s->name);
  c_text_add(e->out, ", ");
  c_text_string(e->out, si);
  c_text_add(e->out, ", ");
  c_text_string(e->out, s->doc);
  c_text_add(e->out, ", ");
  c_text_number(e->out, s->initial);
}

static void write_parameters(emitter *e) {
  const symbol_list *list = &e->plan->law->parameters;
  if (!list->count) return;
  c_text_add(e->out, "static const pl_parameter law_parameters[] = {\n");
  for (int k = 0; k < list->count; k++) {
    write_symbol(e, list->items[k]);
    c_text_add(e->out, ", %d},\n", list->items[k]->has_default);
  }
  c_text_add(e->out, "};\n\n");
}

static void write_varying(emitter *e) {
  if (!e->plan->varying_count) return;
  c_text_add(e->out, "static const int law_varying[] = {");
  for (int k = 0; k < e->plan->varying_count; k++)
    c_text_add(e->out, "%s%d", k ? ", " : "", e->plan->varying[k]);
  c_text_add(e->out, "};\n\n");
}

static const char *place_of_field(const symbol *s) {
  return s->place <= ON_PARTICLE ? "PL_ON_PARTICLE"
         : s->place == ON_BOND   ? "PL_ON_BOND"
                                 : "PL_ON_NEIGHBOUR";
}

static void write_fields(emitter *e, const symbol_list *list, const char *name) {
  if (!list->count) return;
  c_text_add(e->out, "static const pl_field %s[] = {\n", name);
  for (int k = 0; k < list->count; k++) {
    const symbol *s = list->items[k];
    write_symbol(e, s);
    c_text_add(e->out, ", %s, %s},\n",
               s->kind == SYMBOL_DAMAGE  ? "PL_FIELD_DAMAGE"
               : s->kind == SYMBOL_STATE ? "PL_FIELD_STATE"
                                         : "PL_FIELD_OUTPUT",
               place_of_field(s));
  }
  c_text_add(e->out, "};\n\n");
}

static void write_table(emitter *e, const char *member, const char *array, int count) {
  c_text_add(e->out, "    .%s_count = %d,\n    .%ss = %s,\n", member, count, member,
             count ? array : "0");
}

static void write_descriptor(emitter *e, const char *key) {
  const kernel_plan *p = e->plan;
  c_text_add(e->out,
             "static const pl_law the_law = {\n    .abi = PL_KERNEL_ABI,\n    .kind = %d,\n"
             "    .dimensions = %d,\n    .dof = %d,\n    .force_planes = %d,\n    .name = ",
             p->kind, p->dimensions, p->dof, p->force_planes);
  c_text_string(e->out, p->law->tree->name);
  c_text_add(e->out, ",\n    .key = ");
  c_text_string(e->out, key);
  c_text_add(e->out, ",\n");
  write_table(e, "parameter", "law_parameters", p->law->parameters.count);
  c_text_add(e->out, "    .density = %d,\n", p->law->rho ? p->law->rho->index : -1);
  if (p->varying_count)
    c_text_add(e->out, "    .varying_count = %d,\n    .varying = law_varying,\n", p->varying_count);
  write_table(e, "field", "law_fields", p->law->fields.count);
  write_table(e, "output", "law_outputs", p->law->outputs.count);
  c_text_add(e->out,
             "    .stores = %d,\n    .reads_rates = %d,\n    .uniform_count = %d,\n"
             "    .flops_per_bond = ",
             p->stores, p->reads_rates, p->uniform_count);
  c_text_number(e->out, p->flops_per_bond);
  c_text_add(e->out, ",\n    .divisions_per_bond = ");
  c_text_number(e->out, p->divisions_per_bond);
  c_text_add(e->out, ",\n    .prepare = prepare,\n    .bounds = bounds,\n");
}

static void write_entry(emitter *e, const char *key) {
  c_text_add(e->out, "#if PL_IN_PART(0)\n");
  write_descriptor(e, key);
  if (e->plan->kind == PL_STATE) {
    emit_program_members(e);
  } else {
#define X(pass, member, task) c_text_add(e->out, "    .%s = %s,\n", #member, #member);
    STRIP_PASSES(X)
#undef X
    c_text_add(e->out, "    .states = states,\n    .tangent = tangent,\n");
  }
  c_text_add(e->out, "};\n\nconst pl_law *perilat_kernel(void);\n"
                     "const pl_law *perilat_kernel(void) { return &the_law; }\n#endif\n");
}

/* --- the whole text --------------------------------------------------------------------------- */

/* Bonds of a strip share no output, whatever the pointers look like. What an array of a family held is there already: gcc
   would load it again behind every store, and compute again what follows; clang, spared the load, would branch. */
static const char own_macros[] =
    "\n#if defined(__clang__)\n"
    "#define PL_INDEPENDENT _Pragma(\"clang loop vectorize(assume_safety)\")\n"
    "#define PL_AGAIN(value, array) ((void)(value), (array)[q])\n"
    "#else\n"
    "#define PL_INDEPENDENT _Pragma(\"GCC ivdep\")\n"
    "#define PL_AGAIN(value, array) (value)\n"
    "#endif\n"
    "#define PL_RARE __attribute__((cold)) /* not worth the compiler's time */\n"
    "#define PL_APART __attribute__((noinline)) /* leaves its caller the registers */\n"
    "#if defined(PL_PART) /* one of the parts that are compiled at the same time */\n"
    "#define PL_PASS __attribute__((visibility(\"hidden\")))\n"
    "#define PL_IN_PART(part) (PL_PART == (part))\n"
    "#else\n"
    "#define PL_PASS static\n"
    "#define PL_IN_PART(part) 1\n"
    "#endif\n\n";

/* gcc would ask one question of a case several times, and of strips keep what it had better load again (8 % of a step); of
   families it would move what is loaded for a choice into a branch. The others only take the compiler's time. */
static const char
    for_strips[] = "\"no-thread-jumps\", \"no-gcse\"",
    for_families[] =
        "\"no-thread-jumps\", \"no-tree-sink\", \"no-tree-pre\", \"no-tree-slp-vectorize\", "
        "\"no-predictive-commoning\", \"no-tree-loop-distribution\", \"no-split-loops\"";

static void write_prelude(emitter *e) {
  c_text_add(e->out,
             "/* Written by perilat. */\n"
             "#if !defined(__clang__)\n"
             "#pragma GCC optimize(%s)\n"
             "#endif\n",
             e->plan->kind == PL_STATE ? for_families : for_strips);
  c_text_add(e->out, "#pragma GCC diagnostic push\n"
                     "#pragma GCC diagnostic ignored \"-Wunused-function\"\n");
  c_text_add(e->out, "%s\n%s\n", prelude_kernel_h, prelude_elementary_h);
  c_text_add(e->out, "#pragma GCC diagnostic pop\n%s", own_macros);
}

void emit_find_uniforms(emitter *e) {
  e->uniform_of = must_calloc((size_t)e->node_count + 1, sizeof *e->uniform_of);
  for (int n = 0; n < e->node_count; n++)
    e->uniform_of[n] = -1;
  for (int k = 0; k < e->plan->uniform_count; k++)
    e->uniform_of[e->plan->uniforms[k]] = k;
}

char *emit_kernel(const kernel_plan *p, const char *key) {
  c_text out = {0};
  emitter e = {.plan = p, .graph = p->graph, .out = &out, .node_count = ir_count(p->graph)};
  emit_find_uniforms(&e);
  write_prelude(&e);
  write_parameters(&e);
  write_varying(&e);
  write_fields(&e, &p->law->fields, "law_fields");
  write_fields(&e, &p->law->outputs, "law_outputs");
  write_prepare(&e);
  write_bounds(&e);
  if (p->kind == PL_STATE) {
    emit_programs(&e);
    write_entry(&e, key);
    free(e.uniform_of);
    return out.text;
  }
#define X(pass, member, task) emit_strip_pass(&e, &p->passes[pass], #member);
  STRIP_PASSES(X)
#undef X
  write_states_pass(&e, &p->passes[PASS_STATES], "states", PL_STATE_RESULTS + p->law->fields.count);
  write_states_pass(&e, &p->passes[PASS_TANGENT], "tangent", PL_TANGENTS);
  write_entry(&e, key);
  free(e.uniform_of);
  return out.text;
}
