/* Names of the tree's parts, and its two printed forms. */
#include "dsl/syntax/tree.h"

#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/digits.h"

const char *stmt_kind_name(stmt_kind kind) {
#define X(code, text) text,
  static const char *const names[STMT_COUNT] = {TREE_STATEMENTS(X)};
#undef X
  return names[kind];
}

static const char *binary_op_text(binary_op op) {
#define X(code, text, operation, reading) text,
  static const char *const texts[OP_BINARY_COUNT] = {TREE_BINARY_OPERATORS(X)};
#undef X
  return texts[op];
}

const char *placement_name(placement p) {
  static const char *const names[] = {"nothing",  "body", "point",    "tip",
                                      "particle", "bond", "neighbour"};
  return names[p];
}

/* --- expressions as source text ------------------------------------------------------------------
   The levels of the grammar, loosest first. An expression whose own level is looser than the place
   where it stands needs parentheses there. */
typedef enum level {
  LEVEL_OR,
  LEVEL_AND,
  LEVEL_NOT,
  LEVEL_COMPARISON,
  LEVEL_SUM,
  LEVEL_ADDEND, /* -a*b is -(a*b) */
  LEVEL_TERM,
  LEVEL_FACTOR, /* after an operator: a*-b*c is (a*(-b))*c */
  LEVEL_POWER,
  LEVEL_PRIMARY
} level;

typedef struct operator_levels {
  level own, left, right;
} operator_levels;

static operator_levels levels_of(binary_op op) {
  switch (op) {
  case OP_OR:
    return (operator_levels){LEVEL_OR, LEVEL_OR, LEVEL_AND};
  case OP_AND:
    return (operator_levels){LEVEL_AND, LEVEL_AND, LEVEL_NOT};
  case OP_ADD:
  case OP_SUB:
    return (operator_levels){LEVEL_SUM, LEVEL_SUM, LEVEL_ADDEND};
  case OP_MUL:
  case OP_DIV:
  case OP_CONTRACT:
    return (operator_levels){LEVEL_TERM, LEVEL_TERM, LEVEL_FACTOR};
  case OP_POW:
    return (operator_levels){LEVEL_POWER, LEVEL_PRIMARY, LEVEL_FACTOR};
  default:
    return (operator_levels){LEVEL_COMPARISON, LEVEL_SUM, LEVEL_SUM};
  }
}

static void print_number(double number, FILE *out) {
  char text[DIGITS_TEXT];
  fputs(fewest_digits(number, text), out);
}

static void print_at(const expr *e, level context, FILE *out);

static void print_cases(const expr *e, FILE *out) {
  for (int i = 0; i < e->case_count; i++) {
    const case_line *c = &e->cases[i];
    fputs(i ? " | " : "| ", out);
    print_at(c->value, LEVEL_OR, out);
    if (c->open) continue;
    fputs(c->guard ? " when " : " otherwise", out);
    if (c->guard) print_at(c->guard, LEVEL_OR, out);
    if (c->jump) fputs(" jump", out);
  }
}

static void print_call(const expr *e, FILE *out) {
  fprintf(out, "%s(", expr_is_vector(e) ? "" : e->name);
  for (int i = 0; i < e->argument_count; i++) {
    const argument *a = &e->arguments[i];
    if (i) fputs(", ", out);
    if (a->keyword) fprintf(out, "%s = ", a->keyword);
    print_at(a->value, LEVEL_OR, out);
  }
  fputc(')', out);
}

static void print_binary(const expr *e, FILE *out) {
  operator_levels l = levels_of(e->binary);
  bool spaced = l.own < LEVEL_TERM;
  print_at(e->left, l.left, out);
  fprintf(out, spaced ? " %s " : "%s", binary_op_text(e->binary));
  print_at(e->right, l.right, out);
}

/* A sign is loose at the beginning of a sum's part and tight after an operator. */
static level level_of(const expr *e, level context) {
  switch (e->kind) {
  case EXPR_BINARY:
    return levels_of(e->binary).own;
  case EXPR_UNARY:
    if (e->unary >= OP_COMPONENT) return LEVEL_PRIMARY;
    if (e->unary == OP_NOT) return LEVEL_NOT;
    return context == LEVEL_FACTOR ? LEVEL_FACTOR : LEVEL_ADDEND;
  case EXPR_CASES:
    return LEVEL_OR; /* always in parentheses, see print_at */
  default:
    return LEVEL_PRIMARY;
  }
}

static void print_component(const expr *e, FILE *out) {
  print_at(e->left, LEVEL_PRIMARY, out);
  if (e->unary == OP_AXIS)
    fprintf(out, "[%c]", vector_axis(e->component));
  else
    fprintf(out, "[%c,%c]", tensor_axis(e->component, 0), tensor_axis(e->component, 1));
}

static void print_bare(const expr *e, level own, FILE *out) {
  switch (e->kind) {
  case EXPR_NUMBER:
    print_number(e->number, out);
    if (e->unit_text) fprintf(out, " [%s]", e->unit_text);
    break;
  case EXPR_NAME:
    fprintf(out, "%s%s%s", e->name, e->primed ? "'" : "", e->indexed ? "[j]" : "");
    break;
  case EXPR_UNARY:
    if (e->unary >= OP_COMPONENT) {
      print_component(e, out);
      break;
    }
    fputs(e->unary == OP_NOT ? "not " : e->unary == OP_NEG ? "-" : "+", out);
    print_at(e->left, own, out);
    break;
  case EXPR_BINARY:
    print_binary(e, out);
    break;
  case EXPR_CALL:
    print_call(e, out);
    break;
  case EXPR_CASES:
    print_cases(e, out);
    break;
  case EXPR_HOLE:
    fputc('?', out);
    if (e->unit_text) fprintf(out, " [%s]", e->unit_text);
    break;
  }
}

static void print_at(const expr *e, level context, FILE *out) {
  level own = level_of(e, context);
  bool enclosed = own < context || e->kind == EXPR_CASES;
  if (enclosed) fputc('(', out);
  print_bare(e, own, out);
  if (enclosed) fputc(')', out);
}

void expr_print(const expr *e, FILE *out) {
  print_at(e, LEVEL_OR, out);
}

char *expr_text(const expr *e) {
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  expr_print(e, out);
  must_close_text(out);
  return text;
}

/* --- the tree as indented text ---------------------------------------------------------------- */

static void indent(int depth, FILE *out) {
  fprintf(out, "%*s", 2 * depth, "");
}

static void dump_expr(const expr *e, int depth, FILE *out);

static void dump_cases(const expr *e, int depth, FILE *out) {
  for (int i = 0; i < e->case_count; i++) {
    const case_line *c = &e->cases[i];
    indent(depth, out);
    fprintf(out, "case%s\n", c->jump ? " jump" : "");
    dump_expr(c->value, depth + 1, out);
    if (c->open) continue;
    indent(depth, out);
    fputs(c->guard ? "when\n" : "otherwise\n", out);
    if (c->guard) dump_expr(c->guard, depth + 1, out);
  }
}

static void dump_arguments(const expr *e, int depth, FILE *out) {
  for (int i = 0; i < e->argument_count; i++) {
    const argument *a = &e->arguments[i];
    if (a->keyword) {
      indent(depth, out);
      fprintf(out, "argument %s\n", a->keyword);
    }
    dump_expr(a->value, depth + (a->keyword != NULL), out);
  }
}

static void dump_expr(const expr *e, int depth, FILE *out) {
  static const char *const unary[] = {"negative", "positive", "not", "component", "axis"};
  indent(depth, out);
  switch (e->kind) {
  case EXPR_NUMBER:
    fputs("number ", out);
    print_bare(e, LEVEL_PRIMARY, out);
    fputc('\n', out);
    break;
  case EXPR_NAME:
    fputs("name ", out);
    print_bare(e, LEVEL_PRIMARY, out);
    fputc('\n', out);
    break;
  case EXPR_UNARY:
    fputs(unary[e->unary], out);
    if (e->unary == OP_COMPONENT)
      fprintf(out, " %c,%c", tensor_axis(e->component, 0), tensor_axis(e->component, 1));
    if (e->unary == OP_AXIS) fprintf(out, " %c", vector_axis(e->component));
    fputc('\n', out);
    dump_expr(e->left, depth + 1, out);
    break;
  case EXPR_BINARY:
    fprintf(out, "operator %s\n", binary_op_text(e->binary));
    dump_expr(e->left, depth + 1, out);
    dump_expr(e->right, depth + 1, out);
    break;
  case EXPR_CALL:
    fprintf(out, "call %s\n", e->name);
    dump_arguments(e, depth + 1, out);
    break;
  case EXPR_CASES:
    fputs("cases\n", out);
    dump_cases(e, depth + 1, out);
    break;
  case EXPR_HOLE:
    fputs("hole ", out);
    print_bare(e, LEVEL_PRIMARY, out);
    fputc('\n', out);
    break;
  }
}

/* Documentation may have several lines; each gets its own. */
static void dump_doc(const char *doc, int depth, FILE *out) {
  while (doc) {
    size_t length = strcspn(doc, "\n");
    indent(depth, out);
    fprintf(out, "doc %.*s\n", (int)length, doc);
    doc = doc[length] ? doc + length + 1 : NULL;
  }
}

static void dump_bounds(const bounds *b, int depth, FILE *out) {
  if (!b->given) return;
  indent(depth, out);
  fprintf(out, "in %c", b->lower_open ? '(' : '[');
  if (b->lower)
    expr_print(b->lower, out);
  else
    fputs("-inf", out);
  fputs(", ", out);
  if (b->upper)
    expr_print(b->upper, out);
  else
    fputs("inf", out);
  fprintf(out, "%c\n", b->upper_open ? ')' : ']');
}

static void dump_labelled(const char *label, const expr *e, int depth, FILE *out) {
  if (!e) return;
  indent(depth, out);
  fprintf(out, "%s\n", label);
  dump_expr(e, depth + 1, out);
}

static void dump_head(const stmt *s, FILE *out) {
  indent(1, out);
  fputs(stmt_kind_name(s->kind), out);
  if (s->name) fprintf(out, " %s%s", s->name, s->indexed ? "[j]" : "");
  for (int i = 0; i < s->word_count; i++)
    fprintf(out, "%s%s", i ? (s->kind == STMT_OPTION ? " | " : ", ") : ": ", s->words[i]);
  if (s->place != ON_NOTHING) fprintf(out, " on %s", placement_name(s->place));
  if (s->unit_text) fprintf(out, " [%s]", s->unit_text);
  if (s->kind == STMT_FLOW) fputs(s->returned ? " along, returned" : " by", out);
  if (s->along_reference) fputs(" along reference", out);
  fputc('\n', out);
}

static void dump_stmt(const stmt *s, FILE *out) {
  dump_head(s, out);
  dump_doc(s->doc, 2, out);
  if (s->text) {
    indent(2, out);
    fprintf(out, "text \"%s\"\n", s->text);
  }
  dump_bounds(&s->in, 2, out);
  dump_labelled(s->deviator ? "deviator"
                : s->vector ? LAW_VECTOR
                : s->tensor ? "tensor"
                            : "value",
                s->value, 2, out);
  dump_labelled("when", s->when, 2, out);
}

const char *stmt_words(arena *memory, const stmt *s) {
  const char *kind = stmt_kind_name(s->kind);
  return strcmp(kind, s->name) == 0 ? kind : arena_printf(memory, "%s %s", kind, s->name);
}

char tensor_axis(int component, int which) {
#define X(code, first, second) {first, second},
  static const char axes[GENERAL_COMPONENT_COUNT][2] = {TENSOR_COMPONENTS(X) TURNED_COMPONENTS(X)};
#undef X
  return axes[component][which];
}

char vector_axis(int component) {
  return "xyz"[component];
}

bool expr_is_vector(const expr *e) {
  return e && e->kind == EXPR_CALL && strcmp(e->name, LAW_VECTOR) == 0;
}

const char *law_kind_name(law_kind kind) {
#define X(code, words) [code] = words,
  static const char *const names[] = {LAW_KINDS(X)};
#undef X
  return names[kind];
}

const char *law_resting(law_kind kind) {
  if (kind == LAW_CONTINUUM) return "strain";
  return kind == LAW_SLIP_BOND || kind == LAW_CRACK ? NULL : "stretch";
}

void tree_dump(const tree *t, FILE *out) {
  fprintf(out, "model %s\n", t->name);
  dump_doc(t->doc, 1, out);
  indent(1, out);
  fprintf(out, "law %s\n", law_kind_name(t->law));
  for (int i = 0; i < t->setting_count; i++)
    fprintf(out, "%s%s%s", i ? ", " : "  for ", t->settings[i],
            i + 1 == t->setting_count ? "\n" : "");
  if (t->anisotropic) fputs("  anisotropic\n", out);
  for (const stmt *s = t->first; s; s = s->next)
    dump_stmt(s, out);
}
