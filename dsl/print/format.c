/* The text is cut into tokens by the language's own lexer, and the tokens into lines where the
   writer broke them. Layout then means to give every token the column where it begins; it depends
   on the tokens and line breaks alone, never on the blanks there were. */
#include "dsl/print/format.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/syntax/lexer.h"

enum {
  INDENT = 2,
  WIDEST_ALIGNED = 100, /* what begins further right is not aligned */
  DEEPEST_HANGING = 60, /* nor is a continuation line indented further */
  NO_TOKEN = -1
};

int model_lex(MODEL_STYPE *value, span *where, parsing *p);

typedef struct token {
  int code;
  uint32_t begin, end;
  int spaces; /* before it, when it is not the first of its line */
  int column; /* it begins no further left than this */
  int line;
  int opened_by; /* innermost bracket around it, or NO_TOKEN */
  int bar;       /* `|`: the first one of its cases */
  int last_line; /* such a first one: line of the last */
  int hangs;     /* column where it began when lines were hung below it; 0: not yet */
  bool unary;    /* a sign, not a sum */
} token;

typedef enum line_kind { LINE_CODE, LINE_COMMENT, LINE_BLANK } line_kind;

typedef struct line {
  line_kind kind;
  int first, count; /* CODE: tokens */
  bool begins;      /* CODE: a statement */
  bool goes_on;     /* CODE: with `&` */
  bool inside;      /* COMMENT: of a statement */
  int indent;
  uint32_t comment, comment_end; /* empty without one */
  int comment_column;
} line;

typedef struct layout {
  const char *text;
  size_t length;
  token *tokens;
  int token_count, token_room;
  line *lines;
  int line_count, line_room;
  bool is_model; /* it has a model line; otherwise it is there to be included */
} layout;

/* --- reading ---------------------------------------------------------------------------------- */

static line *add_line(layout *f, line_kind kind) {
  if (f->line_count == f->line_room) {
    f->line_room = f->line_room ? 2 * f->line_room : 64;
    f->lines = must_realloc(f->lines, (size_t)f->line_room * sizeof *f->lines);
  }
  line *l = &f->lines[f->line_count++];
  *l = (line){.kind = kind};
  return l;
}

static void add_token(layout *f, int code, span where) {
  if (f->token_count == f->token_room) {
    f->token_room = f->token_room ? 2 * f->token_room : 256;
    f->tokens = must_realloc(f->tokens, (size_t)f->token_room * sizeof *f->tokens);
  }
  f->tokens[f->token_count++] = (token){
      .code = code, .begin = where.begin, .end = where.end, .spaces = 1, .opened_by = NO_TOKEN};
}

/* Where the reading stands: the line that takes the next token, if there is one. */
typedef struct reading {
  bool open;      /* a statement has begun */
  bool same_line; /* nothing broke the line since the last token */
  int line_ends;  /* in a row */
} reading;

static void add_comment(layout *f, reading *r, uint32_t begin, uint32_t end) {
  while (end > begin && isspace((unsigned char)f->text[end - 1]))
    end--;
  line *l;
  if (r->same_line && f->line_count > 0) {
    l = &f->lines[f->line_count - 1];
  } else {
    if (r->line_ends > 1 && f->line_count > 0) add_line(f, LINE_BLANK);
    l = add_line(f, LINE_COMMENT);
    l->inside = r->open;
  }
  l->comment = begin;
  l->comment_end = end;
  r->line_ends = 0;
}

/* Blanks, line ends, comments and `&` between two tokens. */
static void read_gap(layout *f, reading *r, uint32_t at, uint32_t end) {
  while (at < end) {
    if (f->text[at] == '!') {
      uint32_t begin = at;
      while (at < end && f->text[at] != '\n')
        at++;
      add_comment(f, r, begin, at);
      r->same_line = false; /* a comment takes the rest of its line */
    } else if (f->text[at++] == '\n') {
      r->same_line = false;
      r->line_ends++;
    }
  }
}

static void place_token(layout *f, reading *r, int code, span where) {
  if (!r->same_line || !r->open) {
    if (r->line_ends > 1 && f->line_count > 0) add_line(f, LINE_BLANK);
    for (int k = f->line_count - 1; r->open && code != '|' && k >= 0; k--)
      if (f->lines[k].kind == LINE_CODE) {
        f->lines[k].goes_on = true;
        break;
      }
    line *l = add_line(f, LINE_CODE);
    l->first = f->token_count;
    l->begins = !r->open;
  }
  add_token(f, code, where);
  f->tokens[f->token_count - 1].line = f->line_count - 1;
  f->lines[f->line_count - 1].count++;
  *r = (reading){.open = true, .same_line = true};
}

/* Fills in tokens and lines; the text has been parsed without error. */
static void read_layout(layout *f, arena *memory, source_set *sources, int file) {
  diagnostics unsaid;
  diag_begin(&unsaid, sources);
  parsing *p = must_calloc(1, sizeof *p);
  *p = (parsing){.memory = memory, .sources = sources, .file = (uint16_t)file, .messages = &unsaid};
  lexer_open(p, f->text, 0, f->length);
  reading r = {0};
  for (uint32_t at = p->lex.offset;;) {
    MODEL_STYPE value;
    span where;
    int code = model_lex(&value, &where, p);
    read_gap(f, &r, at, where.begin);
    if (code == T_YYEOF) break;
    at = where.end;
    if (code == T_NEWLINE)
      r = (reading){.line_ends = 1};
    else
      place_token(f, &r, code, where);
  }
  lexer_close(p);
  free(p);
  diag_clear(&unsaid);
}

/* --- blanks ----------------------------------------------------------------------------------- */

static bool ends_operand(int code) {
  switch (code) {
  case T_NAME:
  case T_PRIMED:
  case T_NUMBER:
  case T_UNIT:
  case T_HOLE:
  case ')':
  case ']':
    return true;
  default:
    return false;
  }
}

static bool binds_tightly(int code) {
  return code == '*' || code == '/' || code == ':' || code == T_POW;
}

static int spaces_between(const token *before, const token *t) {
  if (t->code == ',' || t->code == ')' || t->code == ']') return 0;
  if (before->code == '(' || before->code == '[') return 0;
  if (t->code == '(' && before->code == T_NAME) return 0; /* a call */
  if (t->code == '[' && before->code != T_IN) return 0;   /* an index */
  if (before->unary || binds_tightly(t->code) || binds_tightly(before->code)) return 0;
  if (t->code == T_STRING)
    return before->code == T_INCLUDE || before->code == T_NONCONSERVATIVE ? 1 : 2;
  return t->code == T_IN ? 2 : 1;
}

/* The first bar inside each bracket is kept with the bracket; outside of brackets in *outermost. */
static void note_bar(layout *f, int k, int *outermost) {
  token *t = &f->tokens[k];
  int *noted = t->opened_by == NO_TOKEN ? outermost : &f->tokens[t->opened_by].bar;
  if (*noted == NO_TOKEN) *noted = k;
  t->bar = *noted;
  f->tokens[t->bar].last_line = t->line;
}

static void describe_tokens(layout *f, int first, int end) {
  int innermost = NO_TOKEN, outermost_bar = NO_TOKEN;
  for (int k = first; k < end; k++) {
    token *t = &f->tokens[k];
    const token *before = k > first ? t - 1 : NULL;
    t->unary = (t->code == '-' || t->code == '+') && (!before || !ends_operand(before->code));
    t->spaces = before ? spaces_between(before, t) : 0;
    if ((t->code == ')' || t->code == ']') && innermost != NO_TOKEN)
      innermost = f->tokens[innermost].opened_by;
    t->opened_by = innermost;
    t->bar = NO_TOKEN;
    if (t->code == '|') note_bar(f, k, &outermost_bar);
    if (t->code == '(' || t->code == '[') innermost = k;
  }
}

/* Index of the line after the statement that begins at line k (comments inside belong to it). */
static int statement_end(const layout *f, int k) {
  int end = k + 1;
  for (int i = k + 1; i < f->line_count; i++) {
    if (f->lines[i].kind == LINE_CODE && f->lines[i].begins) break;
    if (f->lines[i].kind == LINE_CODE) end = i + 1;
  }
  return end;
}

static int tokens_end(const layout *f, int k, int end) {
  for (int i = end - 1; i >= k; i--)
    if (f->lines[i].kind == LINE_CODE) return f->lines[i].first + f->lines[i].count;
  return 0;
}

/* --- columns ---------------------------------------------------------------------------------- */

/* Characters, not bytes. */
static int width_of(const char *text, uint32_t begin, uint32_t end) {
  int width = 0;
  for (uint32_t i = begin; i < end; i++)
    width += ((unsigned char)text[i] & 0xC0) != 0x80;
  return width;
}

/* Column where token `wanted` of a line begins, or, for one past its last, where the line ends. */
static int column_of(const layout *f, const line *l, int wanted) {
  int column = l->indent;
  for (int k = l->first; k < l->first + l->count; k++) {
    const token *t = &f->tokens[k];
    if (k > l->first) {
      column += t->spaces;
      if (column < t->column) column = t->column;
    }
    if (k == wanted) return column;
    column += width_of(f->text, t->begin, t->end);
  }
  return column;
}

/* A token that is to begin in one column with others. */
typedef struct mark {
  const line *line;
  int token;
  int column; /* where it would begin */
} mark;

static void align_marks(layout *f, mark *marks, int count) {
  int widest = 0;
  for (int i = 0; i < count; i++) {
    marks[i].column = column_of(f, marks[i].line, marks[i].token);
    if (marks[i].column > widest && marks[i].column <= WIDEST_ALIGNED) widest = marks[i].column;
  }
  for (int i = 0; i < count; i++)
    if (marks[i].column <= widest) f->tokens[marks[i].token].column = widest;
}

/* --- declarations ----------------------------------------------------------------------------- */

/* Declarations of one kind that follow one another form a table. */
typedef enum table_kind {
  NO_TABLE,
  PARAMETERS,
  GIVEN_FIELDS,
  CONSTANTS,
  OPTIONS,
  FIELDS,
  FUNCTIONS,
  RESULTS,
  OUTPUTS,
  DEFINITIONS
} table_kind;

static table_kind table_of(int code) {
  switch (code) {
  case T_PARAMETER:
    return PARAMETERS;
  case T_FIELD:
    return GIVEN_FIELDS;
  case T_CONSTANT:
    return CONSTANTS;
  case T_OPTION:
    return OPTIONS;
  case T_STATE:
  case T_DAMAGE:
    return FIELDS;
  case T_FUNCTION:
    return FUNCTIONS;
  case T_FORCE:
  case T_MOMENT:
  case T_ENERGY:
  case T_STRESS:
  case T_STRAIN:
  case T_YIELD:
    return RESULTS;
  case T_OUTPUT:
    return OUTPUTS;
  case T_NAME:
    return DEFINITIONS;
  default:
    return NO_TABLE;
  }
}

/* First token of that code outside of brackets on a line, or NO_TOKEN. */
static int find_token(const layout *f, const line *l, int code) {
  for (int k = l->first; k < l->first + l->count; k++)
    if (f->tokens[k].code == code && f->tokens[k].opened_by == NO_TOKEN) return k;
  return NO_TOKEN;
}

static void align_table(layout *f, const int *rows, int count) {
  static const int columns[] = {T_NAME, T_ON, '=', T_IN, T_STRING};
  mark *marks = must_calloc((size_t)count, sizeof *marks);
  for (size_t c = 0; c < sizeof columns / sizeof columns[0]; c++) {
    int marked = 0;
    for (int i = 0; i < count; i++) {
      const line *l = &f->lines[rows[i]];
      int t = find_token(f, l, columns[c]);
      if (t != NO_TOKEN) marks[marked++] = (mark){l, t, 0};
    }
    align_marks(f, marks, marked);
  }
  free(marks);
}

/* Parameters are one table whatever stands between; others end at blank lines and comments. */
static int next_row(const layout *f, int after, table_kind kind) {
  for (int k = after; k < f->line_count; k++) {
    const line *l = &f->lines[k];
    if (l->kind == LINE_CODE)
      return l->begins && table_of(f->tokens[l->first].code) == kind ? k : -1;
    if (kind != PARAMETERS) return -1;
  }
  return -1;
}

/* Statements of several lines end a table. */
static void align_tables(layout *f) {
  int *rows = must_calloc((size_t)f->line_count + 1, sizeof *rows);
  for (int k = 0; k < f->line_count;) {
    const line *l = &f->lines[k];
    table_kind kind =
        l->kind == LINE_CODE && l->begins ? table_of(f->tokens[l->first].code) : NO_TABLE;
    if (kind == NO_TABLE) {
      k++;
      continue;
    }
    int count = 0, last = k;
    for (int row = k; row >= 0;) {
      last = row;
      rows[count++] = row;
      row = statement_end(f, row) > row + 1 ? -1 : next_row(f, row + 1, kind);
    }
    align_table(f, rows, count);
    k = last + 1;
  }
  free(rows);
}

/* --- continuation lines and cases ------------------------------------------------------------- */

/* Many lines may hang below one token: its column is worked out once. */
static int hanging_column(layout *f, int t) {
  token *above = &f->tokens[t];
  if (!above->hangs) above->hangs = column_of(f, &f->lines[above->line], t);
  return above->hangs;
}

/* Under the first bar; otherwise behind the innermost bracket, or else under `body`, the first
   token behind the `=` (NO_TOKEN when that ends its line). */
static int hanging_indent(layout *f, int base, int body, int first) {
  const token *t = &f->tokens[first];
  int column = base + INDENT;
  if (t->code == '|' && t->bar < first)
    column = hanging_column(f, t->bar);
  else if (t->opened_by != NO_TOKEN)
    column = hanging_column(f, t->opened_by) + 1;
  else if (t->code != '|' && body != NO_TOKEN)
    column = hanging_column(f, body);
  return column <= DEEPEST_HANGING ? column : base + INDENT;
}

/* The `when` or `otherwise` of the case that begins at a bar, if it stands on the same line. */
static int case_word(const layout *f, const line *l, int bar) {
  for (int k = bar + 1; k < l->first + l->count; k++) {
    const token *t = &f->tokens[k];
    if (t->opened_by != f->tokens[bar].opened_by) continue;
    if (t->code == '|') return NO_TOKEN;
    if (t->code == T_WHEN || t->code == T_OTHERWISE) return k;
  }
  return NO_TOKEN;
}

/* Aligns the guards of cases that stand one a line; `bar` is the first. */
static void align_cases(layout *f, int bar, mark *marks) {
  int count = 0;
  for (int k = f->tokens[bar].line; k <= f->tokens[bar].last_line; k++) {
    const line *l = &f->lines[k];
    int on_line = 0;
    for (int t = l->first; l->kind == LINE_CODE && t < l->first + l->count; t++) {
      if (f->tokens[t].code != '|' || f->tokens[t].bar != bar) continue;
      if (++on_line > 1) return;
      int guard = case_word(f, l, t);
      if (guard != NO_TOKEN) marks[count++] = (mark){l, guard, 0};
    }
  }
  if (count < 2) return;
  for (int i = 0; i < count; i++)
    f->tokens[marks[i].token].spaces = 2;
  align_marks(f, marks, count);
}

static void lay_out_statement(layout *f, int from, int end) {
  const line *head = &f->lines[from];
  int base = head->indent, after_head = head->first + head->count;
  int body = find_token(f, head, '=') + 1;
  if (body == NO_TOKEN + 1 || body == after_head) body = NO_TOKEN;
  for (int k = from + 1; k < end; k++) {
    line *l = &f->lines[k];
    if (l->kind == LINE_CODE) l->indent = hanging_indent(f, base, body, l->first);
  }
  if (end == from + 1) return;
  mark *marks = must_calloc((size_t)(end - from), sizeof *marks);
  for (int t = tokens_end(f, from, end) - 1; t >= head->first; t--) { /* inner cases first */
    const token *bar = &f->tokens[t];
    if (bar->code == '|' && bar->bar == t && bar->last_line > bar->line) align_cases(f, t, marks);
  }
  free(marks);
  int indent = base + INDENT;
  for (int k = end - 1; k > from; k--) { /* a comment stands as the line below it */
    if (f->lines[k].kind == LINE_CODE)
      indent = f->lines[k].indent;
    else
      f->lines[k].indent = indent;
  }
}

/* `crack` alone begins what a tip does, `end crack` ends it. */
static bool ends_crack(const layout *f, const line *l) {
  static const char crack[] = "crack";
  if (l->kind != LINE_CODE || l->count < 2 || f->tokens[l->first].code != T_END) return false;
  const token *t = &f->tokens[l->first + 1];
  return t->end - t->begin == sizeof crack - 1 &&
         memcmp(f->text + t->begin, crack, sizeof crack - 1) == 0;
}

static int indent_of(const layout *f, const line *l, bool in_model, bool in_crack) {
  int code = l->kind == LINE_CODE ? f->tokens[l->first].code : T_NAME;
  if (in_crack) return ends_crack(f, l) ? INDENT : 2 * INDENT;
  return !in_model || code == T_MODEL || code == T_END ? 0 : INDENT;
}

static void lay_out(layout *f) {
  bool in_model = false, in_crack = false;
  for (int k = 0; k < f->line_count; k++) {
    line *l = &f->lines[k];
    l->indent = indent_of(f, l, in_model, in_crack);
    if (l->kind != LINE_CODE || !l->begins) continue;
    int code = f->tokens[l->first].code;
    const bool crack_ends = in_crack && ends_crack(f, l);
    in_crack = f->is_model && !crack_ends && (in_crack || code == T_CRACK);
    in_model = f->is_model && (code != T_END || crack_ends) && (in_model || code == T_MODEL);
    describe_tokens(f, l->first, tokens_end(f, k, statement_end(f, k)));
  }
  align_tables(f);
  for (int k = 0; k < f->line_count; k++)
    if (f->lines[k].kind == LINE_CODE && f->lines[k].begins)
      lay_out_statement(f, k, statement_end(f, k));
}

/* --- writing ---------------------------------------------------------------------------------- */

static bool has_trailing_comment(const line *l) {
  return l->kind == LINE_CODE && l->comment < l->comment_end;
}

static int code_width(const layout *f, const line *l) {
  return column_of(f, l, l->first + l->count) + (l->goes_on ? 2 : 0);
}

/* Comments at the ends of lines that follow one another begin in one column. */
static void align_comments(layout *f) {
  for (int k = 0; k < f->line_count;) {
    int end = k, widest = 0;
    for (; end < f->line_count && has_trailing_comment(&f->lines[end]); end++) {
      int column = code_width(f, &f->lines[end]) + 2;
      if (column > widest && column <= WIDEST_ALIGNED) widest = column;
    }
    for (; k < end; k++)
      f->lines[k].comment_column = widest;
    k++;
  }
}

static void write_blanks(FILE *out, int count) {
  fprintf(out, "%*s", count > 0 ? count : 0, "");
}

static void write_code(const layout *f, const line *l, FILE *out) {
  int column = l->indent;
  write_blanks(out, column);
  for (int k = l->first; k < l->first + l->count; k++) {
    const token *t = &f->tokens[k];
    int begins = k > l->first ? column + t->spaces : column;
    if (k > l->first && begins < t->column) begins = t->column;
    write_blanks(out, begins - column);
    fwrite(f->text + t->begin, 1, t->end - t->begin, out);
    column = begins + width_of(f->text, t->begin, t->end);
  }
  if (l->goes_on) fputs(" &", out);
  if (!has_trailing_comment(l)) return;
  column += l->goes_on ? 2 : 0;
  write_blanks(out, l->comment_column > column + 2 ? l->comment_column - column : 2);
}

static char *write_layout(const layout *f) {
  char *text = NULL;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  for (int k = 0; k < f->line_count; k++) {
    const line *l = &f->lines[k];
    if (l->kind == LINE_CODE) write_code(f, l, out);
    if (l->kind == LINE_COMMENT) write_blanks(out, l->indent);
    fwrite(f->text + l->comment, 1, l->comment_end - l->comment, out);
    fputc('\n', out);
  }
  must_close_text(out);
  return text;
}

/* --- parsing before and after ----------------------------------------------------------------- */

/* What a text includes does not matter here. */
static char *read_nothing(void *context, const char *name, const char *from, char **found) {
  (void)context;
  (void)from;
  *found = must_copy(name);
  return must_copy("");
}

/* A text to be included, read as the only one that a bare model includes. */
static char *read_that(void *context, const char *name, const char *from, char **found) {
  const source *that = context;
  if (strcmp(name, "\x01") != 0) return read_nothing(NULL, name, from, found);
  *found = must_copy(that->name);
  return must_copy(that->text);
}

static tree *parse_text(arena *memory, source_set *sources, int file, bool is_model,
                        diagnostics *d) {
  if (is_model) {
    const parse_options options = {read_nothing, NULL};
    return parse_model(memory, sources, file, &options, d);
  }
  static const char around[] = "model m\nlaw state\ninclude \"\x01\"\nend model\n";
  source that = sources->items[file]; /* the set may move when sources are added */
  const parse_options options = {read_that, &that};
  int outer = source_add(sources, "(a model that includes it)", around, sizeof around - 1);
  return parse_model(memory, sources, outer, &options, d);
}

/* Does the text hold a model line, as far as can be seen without reading it? */
static bool holds_model_line(const source *s) {
  for (const char *at = s->text; at; at = strchr(at, '\n')) {
    at += strspn(at, " \t\r\n");
    if (strncmp(at, "model", 5) == 0 && isspace((unsigned char)at[5])) return true;
    if (strncmp(at, "law", 3) == 0 && isspace((unsigned char)at[3])) return true;
  }
  return false;
}

static char *dumped(const tree *t) {
  char *text = NULL;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  tree_dump(t, out);
  must_close_text(out);
  return text;
}

/* True when the new text says what the old one says. A difference would be a fault of this program.
 */
static bool same_tree(const tree *before, const char *after, bool is_model) {
  arena *memory = arena_new();
  source_set sources = {0};
  diagnostics d;
  diag_begin(&d, &sources);
  int file = source_add(&sources, "formatted", after, strlen(after));
  const tree *t = parse_text(memory, &sources, file, is_model, &d);
  bool same = t && d.errors == 0;
  if (same) {
    char *old_form = dumped(before), *new_form = dumped(t);
    same = strcmp(old_form, new_form) == 0;
    free(old_form);
    free(new_form);
  }
  diag_clear(&d);
  source_clear(&sources);
  arena_free(memory);
  return same;
}

static char *format_parsed(arena *memory, source_set *sources, int file, bool is_model) {
  const source *s = &sources->items[file];
  layout f = {.text = s->text, .length = s->length, .is_model = is_model};
  read_layout(&f, memory, sources, file);
  lay_out(&f);
  align_comments(&f);
  char *text = write_layout(&f);
  free(f.tokens);
  free(f.lines);
  return text;
}

char *format_model(source_set *sources, int file, diagnostics *d) {
  arena *memory = arena_new();
  bool is_model = holds_model_line(&sources->items[file]);
  int errors = d->errors;
  const tree *t = parse_text(memory, sources, file, is_model, d);
  char *text = t && d->errors == errors ? format_parsed(memory, sources, file, is_model) : NULL;
  if (text && !same_tree(t, text, is_model)) {
    free(text);
    text = NULL;
    diag_report(d, DIAG_NOT_SUPPORTED, (span){0, 0, (uint16_t)file},
                "formatting would change the meaning of this text, which is a fault of perilat");
  }
  arena_free(memory);
  return text;
}
