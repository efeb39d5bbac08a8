#include "dsl/semantics/increments.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/builtins.h"

/* dp = p - previous(p)
   yield f = q - 3*mu*dp - f_y
   flow p along 1 returned when f >= 0
   eps_p = eps_p + dp*n

   What stands above the rule of p reads its value of the last step, so that dp is 0. While f is
   brought back to 0, p moves in it and in all that it is made of. The last line has dp as it stands
   above: 0. It has to be written again, below. */

enum {
  MOST_LOOKS = 1000000, /* statements looked at, for all states of a law together */
  READS_LAST = 1,       /* x above its rule, where it is the value of the last step */
  READS_PREVIOUS = 2,
  READS_INCREMENT = READS_LAST | READS_PREVIOUS
};

typedef struct increments {
  checker *ck;
  const entry *of;      /* the state x */
  unsigned char *reads; /* [statements] what a definition reads of x, through other names as well */
  bool *moves;          /* [statements] x moves in it while its rule is solved for it */
  bool *told;           /* [statements] a use of the name was warned of */
  bool in_output, in_guard;
} increments;

/* --- expressions ------------------------------------------------------------------------------ */

static bool is_previous(const expr *e) {
  return e->kind == EXPR_CALL && !e->symbol && e->builtin == FUNCTION_PREVIOUS;
}

typedef void visitor(increments *w, int reader, const expr *e);

static void visit_parts(increments *w, int reader, const expr *e, visitor *visit) {
  if (e->left) visit(w, reader, e->left);
  if (e->right) visit(w, reader, e->right);
  for (int k = 0; k < e->argument_count; k++)
    visit(w, reader, e->arguments[k].value);
  for (int k = 0; k < e->case_count; k++)
    visit(w, reader, e->cases[k].value);
}

static void visit_guards(increments *w, int reader, const expr *e, visitor *visit) {
  for (int k = 0; k < e->case_count; k++)
    if (e->cases[k].guard) visit(w, reader, e->cases[k].guard);
}

/* Position of the definition that a name stands for, or -1. */
static int definition_of(const expr *e) {
  if (e->kind != EXPR_NAME || !e->symbol || e->symbol->kind != SYMBOL_DEFINED) return -1;
  return entry_of(e->symbol)->declared_at;
}

/* Whether the two are the same, a state and its previous value being the same, too. */
static bool are_alike(const expr *a, const expr *b) {
  if (is_previous(a)) a = a->arguments[0].value;
  if (is_previous(b)) b = b->arguments[0].value;
  if (a->kind != b->kind || a->argument_count != b->argument_count || a->case_count) return false;
  if (a->kind == EXPR_NUMBER)
    return !(a->number < b->number) && !(a->number > b->number) && !a->unit_text && !b->unit_text;
  if (a->kind == EXPR_NAME)
    return a->symbol == b->symbol && a->indexed == b->indexed && a->primed == b->primed;
  if (a->kind == EXPR_UNARY)
    return a->unary == b->unary && a->component == b->component && are_alike(a->left, b->left);
  if (a->kind == EXPR_BINARY)
    return a->binary == b->binary && are_alike(a->left, b->left) && are_alike(a->right, b->right);
  if (a->kind != EXPR_CALL || strcmp(a->name, b->name) != 0) return false;
  for (int k = 0; k < a->argument_count; k++)
    if (!are_alike(a->arguments[k].value, b->arguments[k].value)) return false;
  return true;
}

/* Whether the value of x at hand is read, and the previous one. An output has the state of the end
   of a step, which is both. */
static unsigned char reads_of_x(const increments *w, const expr *e) {
  const expr *of = is_previous(e) ? e->arguments[0].value : e;
  if (of->kind == EXPR_NAME && of->symbol == &w->of->symbol)
    return of != e ? READS_PREVIOUS : of->reads_old || w->in_output ? READS_LAST : 0;
  if (of != e) return 0;
  unsigned char reads = 0;
  if (e->left) reads |= reads_of_x(w, e->left);
  if (e->right) reads |= reads_of_x(w, e->right);
  for (int k = 0; k < e->argument_count; k++)
    reads |= reads_of_x(w, e->arguments[k].value);
  for (int k = 0; k < e->case_count; k++) {
    reads |= reads_of_x(w, e->cases[k].value);
    if (e->cases[k].guard) reads |= reads_of_x(w, e->cases[k].guard);
  }
  const int definition = definition_of(e);
  return definition >= 0 ? w->reads[definition] : reads;
}

/* x - previous(x), or of something that is made of both alike. */
static bool is_increment(const increments *w, const expr *e) {
  if (e->kind != EXPR_BINARY || e->binary != OP_SUB || !are_alike(e->left, e->right)) return false;
  return (reads_of_x(w, e->left) | reads_of_x(w, e->right)) == READS_INCREMENT &&
         reads_of_x(w, e->left) != READS_INCREMENT && reads_of_x(w, e->right) != READS_INCREMENT;
}

/* --- what moves with x in a yield function or a rate ------------------------------------------ */

static void mark_moving(increments *w, int reader, const expr *e) {
  const symbol *s = e->kind == EXPR_NAME ? e->symbol : NULL;
  if (s && s->declared && s->kind != SYMBOL_PARAMETER && s->kind != SYMBOL_ARGUMENT) {
    const bool field = s->kind == SYMBOL_STATE || s->kind == SYMBOL_DAMAGE;
    const int at = field ? entry_of(s)->rule_at : entry_of(s)->declared_at;
    if (at >= 0 && at < reader) w->moves[at] = true;
  }
  visit_parts(w, reader, e, mark_moving);
  visit_guards(w, reader, e, mark_moving);
}

static bool is_rate(const increments *w) {
  return w->of->symbol.rule->kind == STMT_RATE;
}

static void find_moving(increments *w) {
  const stmt *rule = w->of->symbol.rule;
  const expr *solved = is_rate(w) ? rule->value : rule->returned ? rule->when : NULL;
  if (!solved) return;
  mark_moving(w, w->of->rule_at, solved);
  for (int i = w->of->rule_at - 1; i >= 0; i--)
    if (w->moves[i] && w->ck->statements[i]->value) mark_moving(w, i, w->ck->statements[i]->value);
}

/* --- what is 0 -------------------------------------------------------------------------------- */

static const char *name_of_x(const increments *w) {
  return w->of->symbol.name;
}

/* A difference as it is written, without what stands around it. */
static const char *text_of(const increments *w, const expr *e) {
  const char *x = name_of_x(w);
  expr bare = *e;
  bare.where.begin = e->left->where.begin;
  bare.where.end = e->right->where.end;
  return written(w->ck, &bare, arena_printf(w->ck->memory, "%s - previous(%s)", x, x));
}

static void warn_of_output(increments *w, span where, const char *text) {
  complain(w->ck, DIAG_LAST_STEP, where,
           "`%s` is 0 in an output, which reads the states of the end of the step", text);
  diag_hint(w->ck->d, "keep the increment in a state of its own, and show that");
}

static void warn_of_increment(increments *w, int reader, const expr *e) {
  checker *ck = w->ck;
  const char *x = name_of_x(w), *text = text_of(w, e);
  if (w->in_output) {
    warn_of_output(w, e->where, text);
    return;
  }
  complain(ck, DIAG_LAST_STEP, e->where, "`%s` is 0 above the rule of `%s`", text, x);
  diag_note(ck->d, w->of->symbol.rule->name_where, "`%s` has its new value below this line", x);
  if (reader == w->of->rule_at)
    diag_hint(ck->d,
              "the increment is not there before its rule is done: write the rule without it");
  else
    diag_hint(ck->d, "move this rule below the rule of `%s`", x);
}

static void warn_of_name(increments *w, const expr *e) {
  checker *ck = w->ck;
  const char *x = name_of_x(w);
  const stmt *definition = ck->statements[definition_of(e)];
  complain(ck, DIAG_LAST_STEP, e->name_where,
           "`%s` reads `%s`: written above the rule of `%s`, it has `%s` of the last step here",
           e->name, x, x, x);
  diag_note(ck->d, definition->name_where,
            "it is defined here, where `%s - previous(%s)` is 0; only in the %s does it move with "
            "`%s`",
            x, x, is_rate(w) ? "rate" : "yield function", x);
  diag_hint(ck->d, "write `%s_new = ...` below the rule of `%s`, from the new `%s`, and use that",
            e->name, x, x);
}

/* Whether a name has an increment of 0 where it is read now, unlike in the yield function or the
   rate. A yield function itself may be asked for as it was before the flow, and so may a guard ask;
   an output asks for it after. */
static bool is_stale(const increments *w, int definition) {
  return w->reads[definition] == READS_INCREMENT && w->moves[definition] && !w->in_guard &&
         !w->in_output && w->ck->statements[definition]->kind != STMT_YIELD;
}

/* Whether an output reads an increment by this name, which was not warned of where it stands. */
static bool is_shown_increment(const increments *w, const expr *e) {
  int at = -1;
  for (int next = definition_of(e); next >= 0; next = definition_of(e)) {
    at = next;
    e = w->ck->statements[at]->value;
  }
  return w->in_output && at >= 0 && (w->moves[at] || at > w->of->rule_at) && is_increment(w, e);
}

static void find_zeros(increments *w, int reader, const expr *e) {
  const int definition = definition_of(e);
  if (is_increment(w, e)) {
    warn_of_increment(w, reader, e);
    return;
  }
  if (is_shown_increment(w, e)) warn_of_output(w, e->name_where, e->name);
  if (definition >= 0 && is_stale(w, definition) && !w->told[definition]) {
    w->told[definition] = true;
    warn_of_name(w, e);
  }
  visit_parts(w, reader, e, find_zeros);
  const bool in_guard = w->in_guard;
  w->in_guard = true;
  visit_guards(w, reader, e, find_zeros);
  w->in_guard = in_guard;
}

/* A rate, and a definition that only it or the yield function sees, move with x; what is kept or
   given does not. */
static bool moves_with_x(const increments *w, int i) {
  const stmt *s = w->ck->statements[i];
  if (i == w->of->rule_at && is_rate(w)) return true;
  return w->moves[i] && s->symbol && s->symbol->kind == SYMBOL_DEFINED;
}

static void check_rules(increments *w) {
  for (int i = 0; i < w->ck->statement_count; i++) {
    const stmt *s = w->ck->statements[i];
    if (!s->value || s->kind == STMT_FUNCTION) continue;
    w->in_output = s->kind == STMT_OUTPUT;
    w->reads[i] = reads_of_x(w, s->value);
    if (moves_with_x(w, i)) continue;
    find_zeros(w, i, s->value);
    w->in_guard = true;
    if (s->when && !s->returned) find_zeros(w, i, s->when);
    w->in_guard = false;
  }
}

static void check_state(checker *ck, const entry *of) {
  const size_t count = (size_t)ck->statement_count + 1;
  unsigned char *reads = must_calloc(count, 1);
  bool *marks = must_calloc(2 * count, sizeof *marks);
  increments w = {.ck = ck, .of = of, .reads = reads, .moves = marks, .told = marks + count};
  find_moving(&w);
  check_rules(&w);
  free(reads);
  free(marks);
}

void report_increments(checker *ck) {
  int looks = 0;
  for (int k = 0; k < ck->law->fields.count && looks <= MOST_LOOKS; k++) {
    const symbol *s = ck->law->fields.items[k];
    if (!s->old_is_read || !s->rule) continue;
    check_state(ck, entry_of(s));
    looks += ck->statement_count;
  }
}
