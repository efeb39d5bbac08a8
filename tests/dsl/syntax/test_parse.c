/* The parser against the language's rules: trees of whole laws, Fortran's precedence, printing that
   reads back, spans, includes, limits, and texts that nobody would write. */
#define _GNU_SOURCE /* asprintf */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "dsl/syntax/parse.h"

#define GOLDEN SOURCE_DIR "/tests/dsl/golden/"
#define HEAD   "model m\nlaw central bond\n"
#define TAIL   "end model\n"

/* --- one parse and all that belongs to it ----------------------------------------------------- */

typedef struct parsed {
  arena *memory;
  source_set sources;
  diagnostics messages;
  tree *model;
} parsed;

static parsed *parse_bytes(const char *text, size_t length, const parse_options *options) {
  parsed *p = must_calloc(1, sizeof *p);
  p->memory = arena_new();
  diag_begin(&p->messages, &p->sources);
  int file = source_add(&p->sources, "law.plm", text, length);
  p->model = parse_model(p->memory, &p->sources, file, options, &p->messages);
  return p;
}

static parsed *parse_text(const char *text) {
  return parse_bytes(text, strlen(text), NULL);
}

static void parsed_free(parsed *p) {
  diag_clear(&p->messages);
  source_clear(&p->sources);
  arena_free(p->memory);
  free(p);
}

static void expect_clean(const parsed *p) {
  if (p->messages.count) diag_print(&p->messages, stderr);
  assert_int_equal(p->messages.count, 0);
  assert_non_null(p->model);
}

/* The one error of a text has this code and stands at this line and column. */
static void expect_error(const parsed *p, diag_code code, int line, int column) {
  if (p->messages.count != 1) diag_print(&p->messages, stderr);
  assert_int_equal(p->messages.count, 1);
  const diagnostic *d = &p->messages.items[0];
  assert_string_equal(diag_name(d->code), diag_name(code));
  place at = source_place(&p->sources, d->where.file, d->where.begin);
  assert_int_equal(at.line, line);
  assert_int_equal(at.column, column);
}

static char *dump(const tree *t) {
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  tree_dump(t, out);
  fclose(out);
  return text;
}

static char *printed(const expr *e) {
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  expr_print(e, out);
  fclose(out);
  return text;
}

static char *read_file(const char *path) {
  FILE *f = fopen(path, "rb");
  if (!f) return NULL;
  fseek(f, 0, SEEK_END);
  size_t length = (size_t)ftell(f);
  rewind(f);
  char *text = must_calloc(length + 1, 1);
  assert_int_equal(fread(text, 1, length, f), length);
  fclose(f);
  return text;
}

/* Parses `x = <text>`; the expression, or NULL when it is refused. */
static expr *parse_expr(parsed **p, const char *text) {
  char *whole = must_alloc(strlen(text) + 64);
  sprintf(whole, HEAD "x = %s\n" TAIL, text);
  *p = parse_text(whole);
  free(whole);
  return (*p)->messages.count == 0 ? (*p)->model->first->value : NULL;
}

/* --- golden trees ----------------------------------------------------------------------------- */

static void golden(const char *name) {
  char path[1024];
  snprintf(path, sizeof path, GOLDEN "%s.plm", name);
  char *text = read_file(path);
  assert_non_null(text);
  parsed *p = parse_text(text);
  expect_clean(p);
  char *found = dump(p->model);
  snprintf(path, sizeof path, GOLDEN "%s.tree", name);
  if (getenv("PERILAT_BLESS")) {
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    fputs(found, f);
    fclose(f);
  }
  char *expected = read_file(path);
  assert_non_null(expected);
  assert_string_equal(found, expected);
  free(expected);
  free(found);
  parsed_free(p);
  free(text);
}

static void golden_pairwise_law(void **state) {
  (void)state;
  golden("mplm_bilinear");
}

static void golden_state_law(void **state) {
  (void)state;
  golden("splm_concrete");
}

static void shipped_law_parses(void **state) {
  (void)state;
  char *text = read_file(SOURCE_DIR "/models/mplm_bilinear.plm");
  assert_non_null(text);
  parsed *p = parse_text(text);
  expect_clean(p);
  assert_string_equal(p->model->name, "mplm_bilinear");
  parsed_free(p);
  free(text);
}

/* --- precedence: values by Fortran's rules, with a = 2, b = 3, c = 5 -------------------------- */

static double value_of(const expr *e) {
  if (e->kind == EXPR_NUMBER) return e->number;
  if (e->kind == EXPR_NAME) return e->name[0] == 'a' ? 2 : e->name[0] == 'b' ? 3 : 5;
  double l = value_of(e->left), r = e->right ? value_of(e->right) : 0;
  if (e->kind == EXPR_UNARY) return e->unary == OP_NEG ? -l : e->unary == OP_PLUS ? l : l == 0;
  switch (e->binary) {
  case OP_OR:
    return l != 0 || r != 0;
  case OP_AND:
    return l != 0 && r != 0;
  case OP_EQ:
    return l == r;
  case OP_NE:
    return l != r;
  case OP_LT:
    return l < r;
  case OP_LE:
    return l <= r;
  case OP_GT:
    return l > r;
  case OP_GE:
    return l >= r;
  case OP_ADD:
    return l + r;
  case OP_SUB:
    return l - r;
  case OP_MUL:
  case OP_CONTRACT:
    return l * r;
  case OP_DIV:
    return l / r;
  case OP_POW:
    return pow(l, r);
  default:
    return NAN;
  }
}

static void precedence_is_fortrans(void **state) {
  (void)state;
  static const struct {
    const char *text;
    double value;
  } cases[] = {
      {"-a**2", -4},
      {"(-a)**2", 4},
      {"a**b**2", 512},
      {"(a**b)**2", 64},
      {"-a + c", 3},
      {"-a*b + c", -1},
      {"c - b - a", 0},
      {"c - (b - a)", 4},
      {"60/b/c", 4},
      {"60/b*c", 100},
      {"60/-b*c", -100},
      {"60/-a**2*c", -75},
      {"a**-1*6", 3},
      {"a*-b + c", -1},
      {"a*b**2", 18},
      {"a - -b", 5},
      {"--a", 2},
      {"+a", 2},
      {"a + b*c", 17},
      {"a*b + c == 11", 1},
      {"not a == b and b == b", 1},
      {"not (a == b and b == b)", 1},
      {"not not a == 2", 1},
      {"a == b or b == b and a == c", 0},
      {"(a == a or b == b) and a == c", 0},
      {"a == a or b == b and a == c", 1},
      {"a /= b", 1},
      {"a < b and b <= 3 and c > b and c >= 5", 1},
      {"1.18d-4*1e4", 1.18},
      {"1D2 + .5 + 2.", 102.5},
      {"a:b + 1", 7},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    parsed *p;
    const expr *e = parse_expr(&p, cases[i].text);
    if (!e) print_error("refused: %s\n", cases[i].text);
    assert_non_null(e);
    double found = value_of(e);
    if (fabs(found - cases[i].value) > 1e-12) print_error("%s = %g\n", cases[i].text, found);
    assert_true(fabs(found - cases[i].value) <= 1e-12);
    parsed_free(p);
  }
}

/* --- printing reads back ---------------------------------------------------------------------- */

static uint64_t random_state;

static uint32_t random_below(uint32_t limit) { /* Marsaglia (2003), xorshift64 */
  random_state ^= random_state << 13;
  random_state ^= random_state >> 7;
  random_state ^= random_state << 17;
  return (uint32_t)((random_state >> 32) % limit);
}

static expr *fresh(arena *memory, expr_kind kind) {
  expr *e = arena_alloc(memory, sizeof *e);
  e->kind = kind;
  return e;
}

static expr *random_leaf(arena *memory) {
  static const char *const names[] = {"a", "bc", "S_p", "eps"};
  static const char *const units[] = {"GPa", "kg/m^3", "1/s"};
  expr *e = fresh(memory, random_below(9) == 0 ? EXPR_HOLE
                          : random_below(3)    ? EXPR_NAME
                                               : EXPR_NUMBER);
  if (e->kind == EXPR_HOLE) {
    if (random_below(4) == 0) e->unit_text = units[random_below(3)];
  } else if (e->kind == EXPR_NAME) {
    e->name = names[random_below(4)];
    e->indexed = random_below(4) == 0;
    e->primed = random_below(6) == 0;
  } else {
    e->number = random_below(2) ? random_below(100) : ldexp(random_below(1u << 30), -40) / 3;
    if (random_below(4) == 0) e->unit_text = units[random_below(3)];
  }
  return e;
}

static expr *random_expr(arena *memory, int depth);

static void random_cases(arena *memory, expr *e, int depth) {
  e->case_count = 1 + (int)random_below(3);
  e->cases = arena_alloc(memory, sizeof *e->cases * (size_t)e->case_count);
  for (int i = 0; i < e->case_count; i++) {
    e->cases[i].value = random_expr(memory, depth - 1);
    if (i + 1 < e->case_count) e->cases[i].guard = random_expr(memory, depth - 1);
    e->cases[i].jump = random_below(4) == 0;
  }
}

static void random_arguments(arena *memory, expr *e, int depth) {
  e->name = "f";
  e->argument_count = 1 + (int)random_below(3);
  e->arguments = arena_alloc(memory, sizeof *e->arguments * (size_t)e->argument_count);
  for (int i = 0; i < e->argument_count; i++) {
    e->arguments[i].value = random_expr(memory, depth - 1);
    if (random_below(5) == 0) e->arguments[i].keyword = "weight";
  }
}

static expr *random_expr(arena *memory, int depth) {
  uint32_t choice = random_below(12);
  if (depth == 0 || choice < 2) return random_leaf(memory);
  expr *e = fresh(memory, choice < 8    ? EXPR_BINARY
                          : choice < 10 ? EXPR_UNARY
                          : choice < 11 ? EXPR_CALL
                                        : EXPR_CASES);
  if (e->kind == EXPR_CASES) {
    random_cases(memory, e, depth);
  } else if (e->kind == EXPR_CALL) {
    random_arguments(memory, e, depth);
  } else {
    e->unary = (unary_op)random_below(3);
    e->binary = (binary_op)random_below(OP_BINARY_COUNT);
    e->left = random_expr(memory, depth - 1);
    if (e->kind == EXPR_BINARY) e->right = random_expr(memory, depth - 1);
  }
  return e;
}

static bool same_text(const char *a, const char *b) {
  return (!a && !b) || (a && b && strcmp(a, b) == 0);
}

static bool same(const expr *a, const expr *b) {
  if (!a || !b) return a == b;
  if (a->kind != b->kind) return false;
  switch (a->kind) {
  case EXPR_NUMBER:
    return a->number == b->number && same_text(a->unit_text, b->unit_text);
  case EXPR_NAME:
    return same_text(a->name, b->name) && a->indexed == b->indexed && a->primed == b->primed;
  case EXPR_UNARY:
    return a->unary == b->unary && same(a->left, b->left);
  case EXPR_BINARY:
    return a->binary == b->binary && same(a->left, b->left) && same(a->right, b->right);
  case EXPR_CALL: {
    bool equal = same_text(a->name, b->name) && a->argument_count == b->argument_count;
    for (int i = 0; equal && i < a->argument_count; i++)
      equal = same_text(a->arguments[i].keyword, b->arguments[i].keyword) &&
              same(a->arguments[i].value, b->arguments[i].value);
    return equal;
  }
  case EXPR_CASES: {
    bool equal = a->case_count == b->case_count;
    for (int i = 0; equal && i < a->case_count; i++)
      equal = a->cases[i].jump == b->cases[i].jump && same(a->cases[i].guard, b->cases[i].guard) &&
              same(a->cases[i].value, b->cases[i].value);
    return equal;
  }
  case EXPR_HOLE:
    return same_text(a->unit_text, b->unit_text);
  }
  return false;
}

static bool reads_back(const char *text, const expr *as) {
  parsed *p;
  const expr *back = parse_expr(&p, text);
  bool equal = back && same(as, back);
  parsed_free(p);
  return equal;
}

/* Position of the bracket that closes the one at `open`. */
static size_t closing(const char *text, size_t open) {
  int depth = 0;
  for (size_t i = open; text[i]; i++) {
    depth += text[i] == '(';
    depth -= text[i] == ')';
    if (depth == 0) return i;
  }
  return 0;
}

/* No pair of brackets can go without changing the meaning. */
static void expect_no_pair_idle(const char *text, const expr *e) {
  for (size_t i = 0; text[i]; i++) {
    if (text[i] != '(' || (i > 0 && text[i - 1] == 'f')) continue;
    char *without = strdup(text);
    without[i] = without[closing(text, i)] = ' ';
    bool idle = reads_back(without, e);
    if (idle) print_error("brackets to spare: %s\n", text);
    assert_false(idle);
    free(without);
  }
}

static void printing_reads_back(void **state) {
  (void)state;
  random_state = 20140915;
  for (int i = 0; i < 4000; i++) {
    arena *memory = arena_new();
    expr *e = random_expr(memory, 1 + i % 5);
    char *text = printed(e);
    if (!reads_back(text, e)) print_error("does not read back: %s\n", text);
    assert_true(reads_back(text, e));
    if (i % 5 < 3 && e->kind != EXPR_CASES) expect_no_pair_idle(text, e);
    free(text);
    arena_free(memory);
  }
}

/* --- spans, docs, forms ----------------------------------------------------------------------- */

static void expect_span(const parsed *p, span where, const char *text) {
  const source *s = &p->sources.items[where.file];
  char *found = strndup(s->text + where.begin, where.end - where.begin);
  assert_string_equal(found, text);
  free(found);
}

static void spans_cover_their_text(void **state) {
  (void)state;
  parsed *p = parse_text("!> first\n!>second \nmodel m ! name\n  law  micropolar   bond\n"
                         "  !> Stiffness.\n\n  parameter E = 30 [ GPa ] in (a, b*2]  \"text\" ! c\n"
                         "  x[j] = (y + f(2, weight = z'[j]))*-3 &  ! goes on\n\n    + 1\n"
                         "  damage w on bond = | 1 when a > b jump\n\n  ! remark\n"
                         "    |  2 otherwise\nend model m");
  expect_clean(p);
  assert_string_equal(p->model->doc, "first\nsecond");
  assert_string_equal(p->model->name, "m");
  expect_span(p, p->model->law_where, "micropolar   bond");
  assert_int_equal(p->model->law, LAW_MICROPOLAR_BOND);

  const stmt *s = p->model->first;
  expect_span(p, s->where, "parameter E = 30 [ GPa ] in (a, b*2]  \"text\"");
  expect_span(p, s->name_where, "E");
  expect_span(p, s->value->where, "30 [ GPa ]");
  expect_span(p, s->value->unit_where, "GPa");
  assert_string_equal(s->value->unit_text, "GPa");
  expect_span(p, s->in.where, "(a, b*2]");
  assert_true(s->in.given && s->in.lower_open && !s->in.upper_open);
  expect_span(p, s->in.upper->where, "b*2");
  expect_span(p, s->text_where, "\"text\"");
  assert_string_equal(s->text, "text");
  assert_string_equal(s->doc, "Stiffness.");

  s = s->next;
  assert_true(s->kind == STMT_DEFINITION && s->indexed && !s->doc);
  const expr *e = s->value;
  assert_int_equal(e->binary, OP_ADD);
  expect_span(p, e->left->where, "(y + f(2, weight = z'[j]))*-3");
  expect_span(p, e->left->right->where, "-3");
  const expr *call = e->left->left->right;
  expect_span(p, call->where, "f(2, weight = z'[j])");
  expect_span(p, call->arguments[1].keyword_where, "weight");
  expect_span(p, call->arguments[1].value->where, "z'[j]");
  assert_true(call->arguments[1].value->primed && call->arguments[1].value->indexed);
  assert_null(call->arguments[0].keyword);

  s = s->next;
  assert_true(s->kind == STMT_DAMAGE && s->place == ON_BOND);
  expect_span(p, s->place_where, "bond");
  assert_int_equal(s->value->case_count, 2);
  expect_span(p, s->value->cases[0].where, "| 1 when a > b jump");
  assert_true(s->value->cases[0].jump && !s->value->cases[1].jump);
  expect_span(p, s->value->cases[1].where, "|  2 otherwise");
  assert_null(s->value->cases[1].guard);
  assert_null(s->next);
  parsed_free(p);
}

static void forms_of_statements(void **state) {
  (void)state;
  parsed *p = parse_text(
      HEAD "for plane_stress, space\n"
           "parameter E [GPa] in [-inf, inf] 'bare'\nparameter nu\n"
           "option onset = | a | b | c\nstate x on neighbour = 0 'why'\nstate y = 1\n"
           "force state F[j] = 3 along reference\nflow x[j] by 2*x when y > 0\n"
           "flow y along 3 returned when y > 0\nnonconservative \"why\"\n"
           "output o = state + force + model ! words of other lines are names here\n" TAIL);
  expect_clean(p);
  assert_int_equal(p->model->setting_count, 2);
  assert_string_equal(p->model->settings[1], "space");
  const stmt *s = p->model->first;
  assert_null(s->value);
  assert_string_equal(s->unit_text, "GPa");
  expect_span(p, s->unit_where, "GPa");
  assert_true(s->in.given && !s->in.lower && !s->in.upper);
  s = s->next;
  assert_true(!s->unit_text && !s->value && !s->in.given);
  s = s->next;
  assert_int_equal(s->word_count, 3);
  assert_string_equal(s->words[2], "c");
  expect_span(p, s->word_where[0], "a");
  s = s->next;
  assert_true(s->place == ON_NEIGHBOUR);
  assert_string_equal(s->text, "why");
  s = s->next;
  assert_true(s->place == ON_NOTHING);
  s = s->next;
  assert_true(s->kind == STMT_FORCE_STATE && s->along_reference && s->indexed);
  s = s->next;
  assert_true(s->kind == STMT_FLOW && !s->returned && s->indexed && s->when);
  s = s->next;
  assert_true(s->kind == STMT_FLOW && s->returned && !s->indexed && s->when);
  s = s->next;
  assert_true(s->kind == STMT_NONCONSERVATIVE && !s->name);
  s = s->next;
  assert_true(s->kind == STMT_OUTPUT && s->value->kind == EXPR_BINARY);
  parsed_free(p);
}

/* Line ends of Windows, tabs, a byte-order mark and a missing last line end change nothing. */
static void layout_does_not_matter(void **state) {
  (void)state;
  char *text = read_file(GOLDEN "splm_concrete.plm");
  char *other = must_alloc(3 * strlen(text) + 4), *to = other;
  to += sprintf(to, "\xEF\xBB\xBF");
  for (const char *from = text; *from; from++) {
    if (*from == '\n') {
      if (!from[1]) break;
      *to++ = ' ';
      *to++ = '\r';
    }
    *to++ = *from;
    if (*from == '\n') *to++ = '\t';
  }
  *to = '\0';
  parsed *a = parse_text(text), *b = parse_text(other);
  expect_clean(a);
  expect_clean(b);
  char *one = dump(a->model), *two = dump(b->model);
  assert_string_equal(one, two);
  free(one);
  free(two);
  parsed_free(a);
  parsed_free(b);
  free(other);
  free(text);
}

/* One error a statement; statements around it are still read. */
static void errors_are_all_reported(void **state) {
  (void)state;
  parsed *p =
      parse_text(HEAD "a = 1\nb = 2^3^4 && 5\nc = )\nd = 4\nf = (1\n  | 2 otherwise\ng = 5\n" TAIL);
  assert_int_equal(p->messages.count, 3);
  assert_int_equal(p->messages.errors, 3);
  const char *names = "adg";
  int i = 0;
  for (const stmt *s = p->model->first; s; s = s->next)
    assert_int_equal(s->name[0], names[i++]);
  assert_int_equal(i, 3);
  parsed_free(p);

  p = parse_text("x = 3\n");
  assert_null(p->model);
  parsed_free(p);
}

/* --- includes --------------------------------------------------------------------------------- */

/* Answers from a table; "chain_N" includes "chain_N+1" without end, "wide" includes many. */
static char *answer(void *context, const char *name, const char *from, char **found) {
  int *asked = context;
  (*asked)++;
  (void)from;
  char *text = NULL;
  if (strcmp(name, "shared.plm") == 0)
    text = strdup("! shared\nfunction twice(x) = 2*x\n!> doc\nconstant k = 3 \"three\"\ninclude "
                  "'deep.plm'\n");
  else if (strcmp(name, "deep.plm") == 0)
    text = strdup("constant deep = 4");
  else if (strncmp(name, "chain_", 6) == 0 &&
           asprintf(&text, "include 'chain_%d'\n", atoi(name + 6) + 1) < 0)
    return NULL;
  if (text) *found = strdup(name);
  return text;
}

static void includes_are_spliced_in_place(void **state) {
  (void)state;
  int asked = 0;
  const parse_options options = {answer, &asked};
  const char *text = HEAD "a = 1\ninclude \"shared.plm\"\nb = 2\ninclude \"deep.plm\"\n" TAIL;
  parsed *p = parse_bytes(text, strlen(text), &options);
  expect_clean(p);
  static const char *const order[] = {"a", NULL, "twice", "k", NULL, "deep", "b", NULL};
  size_t i = 0;
  for (const stmt *s = p->model->first; s; s = s->next, i++) {
    if (order[i])
      assert_string_equal(s->name, order[i]);
    else
      assert_int_equal(s->kind, STMT_INCLUDE);
    if (s->name && strcmp(s->name, "k") == 0) {
      assert_string_equal(s->doc, "doc");
      assert_string_equal(p->sources.items[s->where.file].name, "shared.plm");
      expect_span(p, s->where, "constant k = 3 \"three\"");
    }
  }
  assert_int_equal(i, 8); /* deep.plm is read once */
  parsed_free(p);
}

static void includes_have_limits(void **state) {
  (void)state;
  int asked = 0;
  const parse_options options = {answer, &asked};
  const char *text = HEAD "include 'chain_1'\n" TAIL;
  parsed *p = parse_bytes(text, strlen(text), &options);
  expect_error(p, DIAG_INCLUDE, 1, 9);
  assert_non_null(strstr(p->messages.items[0].hint, "law.plm includes chain_1 includes chain_2"));
  assert_int_equal(asked, 17);
  parsed_free(p);
  p = parse_bytes(text, strlen(text), NULL);
  expect_error(p, DIAG_INCLUDE, 3, 9);
  parsed_free(p);
}

/* --- limits and hostile texts ----------------------------------------------------------------- */

static char *repeated(const char *piece, size_t count) {
  size_t length = strlen(piece);
  char *text = must_alloc(length * count + 1);
  for (size_t i = 0; i < count; i++)
    memcpy(text + i * length, piece, length);
  text[length * count] = '\0';
  return text;
}

static void nesting_has_a_limit(void **state) {
  (void)state;
  static const struct {
    const char *open, *close;
    size_t most; /* that are still read */
  } forms[] = {{"(", ")", 200},  {"-", "", 199},   {"1 + ", "", 199},
               {"2**", "", 199}, {"f(", ")", 199}, {"(| ", " otherwise)", 199},
               {"not ", "", 199}};
  for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++)
    for (size_t more = 0; more < 2; more++) {
      char *open = repeated(forms[i].open, forms[i].most + more);
      char *close = repeated(forms[i].close, forms[i].most + more);
      char *text = must_alloc(strlen(open) + strlen(close) + 2);
      sprintf(text, "%s1%s", open, close);
      parsed *p;
      const expr *e = parse_expr(&p, text);
      if (!e != (more == 1)) print_error("%s, %zu more\n", forms[i].open, more);
      assert_int_equal(e != NULL, more == 0);
      if (more) {
        assert_int_equal(p->messages.count, 1);
        assert_int_equal(p->messages.items[0].code, DIAG_TOO_DEEP);
      }
      parsed_free(p);
      free(text);
      free(open);
      free(close);
    }
}

static void sizes_have_limits(void **state) {
  (void)state;
  enum { MOST = 1 << 20 };
  char *text = must_calloc(MOST + 2, 1);
  const char *law = HEAD "force N = 1 [N]\n" TAIL;
  memset(text, ' ', MOST);
  memcpy(text, law, strlen(law));
  parsed *p = parse_bytes(text, MOST, NULL);
  expect_clean(p);
  parsed_free(p);
  text[MOST] = ' ';
  p = parse_bytes(text, MOST + 1, NULL);
  expect_error(p, DIAG_TOO_LONG, 1, 1);
  assert_null(p->model);
  parsed_free(p);
  free(text);

  p = parse_bytes("model\0m\n", 8, NULL);
  expect_error(p, DIAG_BAD_CHARACTER, 1, 6);
  assert_null(p->model);
  parsed_free(p);

  parsed *q;
  char *name = repeated("n", 63);
  assert_non_null(parse_expr(&q, name));
  parsed_free(q);
  free(name);
}

/* A megabyte of one piece, after a model line and within a statement: read in linear time. */
static void hostile_texts_end_soon(void **state) {
  (void)state;
  static const char *const pieces[] = {"[",
                                       "(",
                                       ")",
                                       "\n",
                                       "|",
                                       "&",
                                       "& ",
                                       "!",
                                       "!>\n",
                                       "'",
                                       "\"",
                                       "1",
                                       "1 ",
                                       "x",
                                       "x ",
                                       "x\n",
                                       "-",
                                       "**2",
                                       "+1",
                                       "\n|",
                                       "\n! ",
                                       "a'",
                                       "30 [",
                                       "]",
                                       "^",
                                       "\xC2",
                                       "\xE2\x88\x92",
                                       "not ",
                                       "| 1 when 2\n",
                                       "f(",
                                       "1,",
                                       "[j]",
                                       "x=1\n",
                                       "in (",
                                       "model m\n",
                                       "law state\n",
                                       "&\n",
                                       "include 'a'\n",
                                       " ",
                                       "\r",
                                       "x = (| 1 otherwise)\n",
                                       "end model\n",
                                       "parameter a [m] in (0, 1)\n"};
  for (size_t i = 0; i < sizeof pieces / sizeof pieces[0]; i++) {
    const char *start = HEAD "x = ";
    char *body = repeated(pieces[i], ((1 << 20) - 100) / strlen(pieces[i]));
    char *text = must_alloc(strlen(start) + strlen(body) + 1);
    sprintf(text, "%s%s", start, body);
    clock_t begun = clock();
    parsed *p = parse_text(text);
    double seconds = (double)(clock() - begun) / CLOCKS_PER_SEC;
    if (seconds > 5) print_error("%.8s takes %.1f s\n", pieces[i], seconds);
    assert_true(seconds <= 5); /* about 0.1 s; with sanitizers and a busy machine, ten times that */
    assert_true(p->messages.count > 0 && p->messages.count <= 202);
    parsed_free(p);
    free(text);
    free(body);
  }
}

static void mutate(char *text, size_t *length, size_t room) {
  static const char alphabet[] = "()[]|&!=+-*/<>'\",.:;^~ \n\r\t0129eEdDxjN_\x01\xC2\xA0\xFF";
  size_t at = random_below((uint32_t)*length), run = 1 + random_below(12);
  if (at + run > *length) run = *length - at;
  switch (random_below(5)) {
  case 0: /* another character */
    text[at] = alphabet[random_below(sizeof alphabet - 1)];
    break;
  case 1: /* a piece lost */
    memmove(text + at, text + at + run, *length - at - run);
    *length -= run;
    break;
  case 2: /* a piece twice */
    if (*length + run > room) break;
    memmove(text + at + run, text + at, *length - at);
    *length += run;
    break;
  case 3: { /* a piece from elsewhere */
    size_t from = random_below((uint32_t)(*length - run + 1));
    memmove(text + at, text + from, run);
    break;
  }
  default: /* a character more */
    if (*length + 1 > room) break;
    memmove(text + at + 1, text + at, *length - at);
    text[at] = alphabet[random_below(sizeof alphabet - 1)];
    ++*length;
  }
}

/* Damaged laws are refused or read, never more than that; what is read can be printed. */
static void damaged_texts_do_no_harm(void **state) {
  (void)state;
  char *laws[] = {read_file(GOLDEN "mplm_bilinear.plm"), read_file(GOLDEN "splm_concrete.plm")};
  FILE *nowhere = fopen("/dev/null", "w");
  int refused = 0, asked = 0;
  random_state = 1907;
  const parse_options options = {answer, &asked};
  for (int i = 0; i < 20000; i++) {
    size_t length = strlen(laws[i % 2]), room = length + 256;
    char *text = must_alloc(room + 1);
    memcpy(text, laws[i % 2], length);
    for (uint32_t n = 1 + random_below(8); n > 0 && length > 0; n--)
      mutate(text, &length, room);
    parsed *p = parse_bytes(text, length, &options);
    refused += p->messages.errors > 0;
    if (p->model) tree_dump(p->model, nowhere);
    if (i % 16 == 0) diag_print(&p->messages, nowhere);
    if (!p->model) assert_true(p->messages.errors > 0);
    parsed_free(p);
    free(text);
  }
  assert_in_range(refused, 10000, 19999); /* comments absorb some of the damage */
  fclose(nowhere);
  free(laws[0]);
  free(laws[1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(golden_pairwise_law),      cmocka_unit_test(golden_state_law),
      cmocka_unit_test(shipped_law_parses),       cmocka_unit_test(precedence_is_fortrans),
      cmocka_unit_test(printing_reads_back),      cmocka_unit_test(spans_cover_their_text),
      cmocka_unit_test(forms_of_statements),      cmocka_unit_test(layout_does_not_matter),
      cmocka_unit_test(errors_are_all_reported),  cmocka_unit_test(includes_are_spliced_in_place),
      cmocka_unit_test(includes_have_limits),     cmocka_unit_test(nesting_has_a_limit),
      cmocka_unit_test(sizes_have_limits),        cmocka_unit_test(hostile_texts_end_soon),
      cmocka_unit_test(damaged_texts_do_no_harm),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
