#include "dsl/syntax/tree_build.h"

#include <string.h>

static expr *node(parsing *p, expr_kind kind, span where) {
  expr *e = arena_alloc(p->memory, sizeof *e);
  e->kind = kind;
  e->where = where;
  e->depth = 1;
  e->builtin = -1;
  return e;
}

/* Makes `child` hang below `parent`. A child that is too deep is replaced by a number, so that no
   tree, not even one of a faulty text, exceeds the limit. */
static expr *below(parsing *p, expr *parent, expr *child) {
  if (child->depth >= TREE_DEEPEST) {
    if (first_complaint(p)) {
      diag_report(p->messages, DIAG_TOO_DEEP, child->where,
                  "this expression nests more than %d operations in one another", TREE_DEEPEST);
      diag_hint(p->messages, "give parts of it names of their own");
    }
    child = node(p, EXPR_NUMBER, child->where);
  }
  if (parent->depth <= child->depth) parent->depth = child->depth + 1;
  return child;
}

/* Index brackets hold `j`, always. Returns whether there are any. */
static bool index_given(parsing *p, word index) {
  if (index.text && strcmp(index.text, "j") != 0 && first_complaint(p)) {
    diag_report(p->messages, DIAG_SYNTAX, index.where, "the neighbour is called `j`, not `%s`",
                index.text);
    diag_hint(p->messages, "write [j]; a component of a vector is [x], [y] or [z]");
  }
  return index.text != NULL;
}

expr *build_number(parsing *p, double number, word written_unit, span where) {
  expr *e = node(p, EXPR_NUMBER, where);
  e->number = number;
  e->unit_text = written_unit.text;
  e->unit_where = written_unit.where;
  return e;
}

expr *build_hole(parsing *p, word written_unit, span where) {
  expr *e = node(p, EXPR_HOLE, where);
  e->unit_text = written_unit.text;
  e->unit_where = written_unit.where;
  return e;
}

expr *build_name(parsing *p, word name, bool primed, word index, span where) {
  expr *e = node(p, EXPR_NAME, where);
  e->name = name.text;
  e->name_where = name.where;
  e->primed = primed;
  e->indexed = index_given(p, index);
  return e;
}

static int find_axis(const char *text) {
  for (int k = 0; k < VECTOR_COMPONENT_COUNT; k++)
    if (text[0] == vector_axis(k) && !text[1]) return k;
  return -1;
}

expr *build_axis(parsing *p, expr *vector, word axis, span where) {
  expr *e = build_unary(p, OP_AXIS, vector, where);
  const int found = find_axis(axis.text);
  e->component = found < 0 ? 0 : found;
  if (found >= 0 || !first_complaint(p)) return e;
  diag_report(p->messages, DIAG_SYNTAX, axis.where, "a vector has no component `%s`", axis.text);
  diag_hint(p->messages, "components are named by the axes x, y and z, as in `%s[j][x]`",
            vector->name);
  return e;
}

expr *build_name_or_axis(parsing *p, word name, word index, span where) {
  if (!index.text || find_axis(index.text) < 0) return build_name(p, name, false, index, where);
  return build_axis(p, build_name(p, name, false, (word){.text = NULL}, name.where), index, where);
}

expr *build_vector(parsing *p, expr *x, expr *y, expr *z, span where) {
  expr *const parts[] = {x, y, z};
  expr *e = build_call(p, (word){.text = LAW_VECTOR, .where = where});
  for (int k = 0; k < VECTOR_COMPONENT_COUNT && parts[k]; k++)
    build_argument(p, e, (word){.text = NULL}, parts[k]);
  e->where = where;
  return e;
}

static int find_component(const char *first, const char *second) {
  for (int k = 0; k < GENERAL_COMPONENT_COUNT; k++)
    if (first[0] == tensor_axis(k, 0) && second[0] == tensor_axis(k, 1) && !first[1] && !second[1])
      return k;
  return -1;
}

expr *build_component(parsing *p, expr *tensor, word first, word second, span where) {
  expr *e = build_unary(p, OP_COMPONENT, tensor, where);
  const int found = find_component(first.text, second.text);
  e->component = found < 0 ? 0 : found;
  if (found >= 0 || !first_complaint(p)) return e;
  diag_report(p->messages, DIAG_SYNTAX, span_join(first.where, second.where),
              "a tensor has no component `%s,%s`", first.text, second.text);
  diag_hint(p->messages, "components are named by the axes x, y and z, as in `%s[x,y]`",
            tensor->name);
  return e;
}

expr *build_unary(parsing *p, unary_op op, expr *operand, span where) {
  expr *e = node(p, EXPR_UNARY, where);
  e->unary = op;
  e->left = below(p, e, operand);
  return e;
}

expr *build_binary(parsing *p, binary_op op, expr *left, expr *right, span where) {
  expr *e = node(p, EXPR_BINARY, where);
  e->binary = op;
  e->left = below(p, e, left);
  e->right = below(p, e, right);
  return e;
}

/* Room for one item more in an array that doubles at each power of two. */
static void *grown(arena *memory, void *items, int count, size_t size) {
  if (count & (count - 1)) return items;
  void *larger = arena_alloc(memory, size * (size_t)(count ? 2 * count : 1));
  if (count) memcpy(larger, items, size * (size_t)count);
  return larger;
}

expr *build_call(parsing *p, word name) {
  expr *e = node(p, EXPR_CALL, name.where);
  e->name = name.text;
  e->name_where = name.where;
  return e;
}

expr *build_argument(parsing *p, expr *call, word keyword, expr *value) {
  int n = call->argument_count++;
  call->arguments = grown(p->memory, call->arguments, n, sizeof *call->arguments);
  call->arguments[n] = (argument){keyword.text, keyword.where, below(p, call, value)};
  return call;
}

expr *build_cases(parsing *p, span where) {
  return node(p, EXPR_CASES, where);
}

expr *build_case(parsing *p, expr *cases, expr *value, expr *guard, bool jump, span where) {
  int n = cases->case_count++;
  cases->cases = grown(p->memory, cases->cases, n, sizeof *cases->cases);
  cases->cases[n] = (case_line){.value = below(p, cases, value),
                                .guard = guard ? below(p, cases, guard) : NULL,
                                .jump = jump,
                                .where = where};
  cases->where = span_join(cases->where, where);
  return cases;
}

expr *build_open_case(parsing *p, expr *cases, span where) {
  const word no_unit = {.text = NULL};
  build_case(p, cases, build_hole(p, no_unit, where), NULL, false, where);
  cases->cases[cases->case_count - 1].open = true;
  return cases;
}

words *build_words(parsing *p) {
  return arena_alloc(p->memory, sizeof(words));
}

words *build_word(parsing *p, words *list, word item) {
  int n = list->count++;
  list->items = grown(p->memory, list->items, n, sizeof *list->items);
  list->where = grown(p->memory, list->where, n, sizeof *list->where);
  list->items[n] = item.text;
  list->where[n] = item.where;
  return list;
}

static bool is_inf(const expr *e) {
  return e->kind == EXPR_NAME && !e->indexed && !e->primed && strcmp(e->name, "inf") == 0;
}

static bool is_minus_inf(const expr *e) {
  return e->kind == EXPR_UNARY && e->unary == OP_NEG && is_inf(e->left);
}

bounds build_bounds(parsing *p, bool lower_open, expr *lower, expr *upper, bool upper_open,
                    span where) {
  const expr *wrong = is_inf(lower) ? lower : is_minus_inf(upper) ? upper : NULL;
  if (wrong && first_complaint(p)) {
    diag_report(p->messages, DIAG_SYNTAX, wrong->where, "these bounds stand in the wrong order");
    diag_hint(p->messages, "the lower bound comes first: (-inf, inf)");
  }
  return (bounds){true,
                  lower_open,
                  upper_open,
                  is_minus_inf(lower) ? NULL : lower,
                  is_inf(upper) ? NULL : upper,
                  where};
}

stmt *build_stmt(parsing *p, stmt_kind kind, word name, word index, expr *value, span where) {
  stmt *s = arena_alloc(p->memory, sizeof *s);
  s->kind = kind;
  s->where = where;
  s->name = name.text;
  s->name_where = name.where;
  s->indexed = index_given(p, index);
  s->value = value;
  s->doc = p->lex.doc;
  return s;
}

stmt *build_tip_stmt(parsing *p, stmt_kind kind, span name_where, expr *value, span where) {
  const word name = {.text = stmt_kind_name(kind), .where = name_where}, none = {.text = NULL};
  return build_stmt(p, kind, name, none, value, where);
}

stmt *build_rest(parsing *p, word of, word index, expr *value, span where) {
  const word name = {.text = arena_printf(p->memory, "rest_%s", of.text), .where = of.where};
  stmt *s = build_stmt(p, STMT_DEFINITION, name, index, value, where);
  s->rest_of = of.text;
  return s;
}

stmt *build_total(parsing *p, const stmt *rest) {
  const span at = rest->name_where;
  const word index = {.text = rest->indexed ? "j" : NULL, .where = at},
             of = {.text = rest->rest_of, .where = at}, by = {.text = rest->name, .where = at},
             name = {.text = arena_printf(p->memory, "total_%s", rest->rest_of), .where = at};
  expr *measured = build_name(p, of, false, index, at),
       *rest_part = build_name(p, by, false, index, at);
  expr *sum = build_binary(p, OP_ADD, measured, rest_part, at);
  stmt *s = build_stmt(p, STMT_DEFINITION, name, index, sum, rest->where);
  s->total = true;
  return s;
}

stmt *build_failure(parsing *p, span name_where, expr *guard, span where) {
  const word name = {.text = LAW_FAILED, .where = name_where}, none = {.text = NULL};
  expr *whole = build_number(p, 1, none, name_where),
       *intact = build_number(p, 0, none, name_where);
  expr *rule = build_case(p, build_cases(p, where), whole, guard, true, guard->where);
  rule = build_case(p, rule, intact, NULL, false, guard->where);
  stmt *s = build_stmt(p, STMT_DAMAGE, name, none, rule, where);
  s->failure = true;
  s->place = ON_POINT;
  s->place_where = name_where;
  return s;
}

void build_words_of(stmt *s, const words *list) {
  s->words = list->items;
  s->word_where = list->where;
  s->word_count = list->count;
}

void build_placement(parsing *p, stmt *s, word on) {
  static const struct {
    const char *name;
    placement place;
  } places[] = {{"bond", ON_BOND},
                {"particle", ON_PARTICLE},
                {"neighbour", ON_NEIGHBOUR},
                {"point", ON_POINT},
                {"tip", ON_TIP}};
  if (!on.text) return;
  s->place_where = on.where;
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++)
    if (strcmp(on.text, places[i].name) == 0) s->place = places[i].place;
  if (s->place != ON_NOTHING || !first_complaint(p)) return;
  diag_report(p->messages, DIAG_SYNTAX, on.where, "a %s cannot live on `%s`",
              stmt_kind_name(s->kind), on.text);
  diag_hint(p->messages, HINT_PLACES);
}

void build_tensor_state(parsing *p, stmt *s, word tensor) {
  s->vector = strcmp(tensor.text, LAW_VECTOR) == 0;
  s->tensor = !s->vector;
  s->deviator = strcmp(tensor.text, "deviator") == 0;
  if (!s->vector && !s->deviator && strcmp(tensor.text, "tensor") != 0) {
    if (!first_complaint(p)) return;
    diag_report(p->messages, DIAG_SYNTAX, tensor.where, "`%s` is not understood here", tensor.text);
    diag_hint(p->messages, "a state that is a tensor begins with `= tensor 0`, one of trace 0 with "
                           "`= deviator 0`, one that is a vector with `= vector 0`");
  } else if (s->value->number != 0 && first_complaint(p)) {
    diag_report(p->messages, DIAG_SYNTAX, s->value->where, "a %s begins at 0", tensor.text);
    diag_hint(p->messages, "write `%s 0`", tensor.text);
  }
}

void build_force_state(parsing *p, word state, stmt *s, word direction) {
  s->along_reference = direction.text != NULL;
  if (strcmp(state.text, "state") != 0) {
    if (!first_complaint(p)) return;
    diag_report(p->messages, DIAG_SYNTAX, state.where, "`force %s %s` is not understood",
                state.text, s->name);
    diag_hint(p->messages,
              "write `force N =` or `force V =`, or, in a state law, `force state F[j] =`");
  } else if (direction.text && strcmp(direction.text, "reference") != 0 && first_complaint(p)) {
    diag_report(p->messages, DIAG_SYNTAX, direction.where,
                "a force state acts along the current bond or `along reference`");
  }
}
