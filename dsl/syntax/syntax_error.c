#include "dsl/syntax/syntax_error.h"

#include <ctype.h>
#include <string.h>

#include "dsl/syntax/parser.h"
#include "dsl/syntax/words.h"

typedef struct trouble {
  int token; /* the one that does not fit */
  span where;
  const bool *expected; /* [TOKEN_CODES] */
} trouble;

/* Each knows one slip: reports it and returns true, or returns false. */
typedef bool (*slip_test)(parsing *p, const trouble *t);

#define TEXT(p, where) (int)((where).end - (where).begin), (p)->lex.text + (where).begin

static bool text_is(const parsing *p, span where, const char *text) {
  return where.end - where.begin == strlen(text) &&
         memcmp(p->lex.text + where.begin, text, strlen(text)) == 0;
}

static bool value_expected(const trouble *t) {
  return t->expected[T_NUMBER];
}
static bool operator_expected(const trouble *t) {
  return t->expected['*'];
}

static bool is_name(const trouble *t) {
  return t->token == T_NAME || t->token == T_PRIMED;
}

static bool is_word_of_language(int token) {
  switch (token) {
#define X(word_token, text) case T_##word_token:
    LINE_WORDS(X)
    RESERVED_WORDS(X)
#undef X
    return true;
  default:
    return false;
  }
}

static bool is_value_end(int token) {
  return token == T_NUMBER || token == T_UNIT || token == T_NAME || token == T_PRIMED ||
         token == T_HOLE || token == ')' || token == ']';
}

/* A short quotation of the text. */
static const char *quoted(parsing *p, span where) {
  enum { LONGEST = 40 };
  int length = (int)(where.end - where.begin);
  if (length <= LONGEST) return arena_printf(p->memory, "`%.*s`", TEXT(p, where));
  while (length > LONGEST ||
         ((unsigned char)p->lex.text[where.begin + (uint32_t)length] & 0xC0) == 0x80)
    length--;
  return arena_printf(p->memory, "`%.*s...`", length, p->lex.text + where.begin);
}

static const char *found_text(parsing *p, const trouble *t) {
  if (t->token == T_NEWLINE) return p->alone ? "the end" : "the end of the line";
  if (t->token == T_STRING) return "a quoted text";
  return quoted(p, t->where);
}

static void say(parsing *p, span where, const char *message) {
  diag_report(p->messages, DIAG_SYNTAX, where, "%s", message);
}

static void hint(parsing *p, const char *text) {
  diag_hint(p->messages, "%s", text);
}

/* --- statements of other languages ------------------------------------------------------------ */

static const struct {
  const char *word, *hint;
} foreign[] = {
    {"if", "choose with cases: x = | value when guard, and on the last line | value otherwise"},
    {"else", "the last of the cases is written | value otherwise"},
    {"elseif", "the next of the cases is written | value when guard"},
    {"endif", "cases end by themselves, with | value otherwise"},
    {"do", "there are no loops; sums over the family are written sum(x[j])"},
    {"while", "there are no loops"},
    {"enddo", "there are no loops"},
    {"endmodel", "write `end model`"},
    {"implicit", "nothing is implicit here; remove the line"},
    {"real", "quantities are not declared; write x = ..."},
    {"integer", "quantities are not declared; write x = ..."},
    {"double", "quantities are not declared; write x = ..."},
    {"let", "write x = ..."},
    {"var", "write x = ..."},
    {"const", "write constant x = ..."},
    {"param", "write parameter x = ..."},
    {"subroutine", "write function f(x) = ..."},
    {"def", "write function f(x) = ..."},
    {"return", "a function is one expression: function f(x) = ..."},
    {"call", "functions stand in expressions: y = f(x)"},
    {"program", "write model my_law"},
};

static bool foreign_statement(parsing *p, const trouble *t) {
  (void)t;
  if (p->lex.first != T_NAME) return false;
  for (size_t i = 0; i < sizeof foreign / sizeof foreign[0]; i++) {
    if (!text_is(p, p->lex.first_where, foreign[i].word)) continue;
    diag_report(p->messages, DIAG_SYNTAX, p->lex.first_where, "there is no statement `%s`",
                foreign[i].word);
    hint(p, foreign[i].hint);
    return true;
  }
  return false;
}

/* The line's first word is nothing the language knows: probably a misspelt one. */
static bool misspelt_statement(parsing *p, const trouble *t) {
  const lexing *l = &p->lex;
  bool second = l->before_last == T_NAME && l->before_where.begin == l->first_where.begin;
  if (l->first != T_NAME || !second || t->token == '=' || t->token == ')' || t->token == ']')
    return false;
#define X(token, text) text,
  static const char *const candidates[] = {LINE_WORDS(X)};
#undef X
  const int count = (int)(sizeof candidates / sizeof candidates[0]);
  const char *written = arena_text(p->memory, l->text + l->first_where.begin,
                                   l->first_where.end - l->first_where.begin);
  const char *near = nearest_name(written, candidates, count);
  if (near) {
    diag_report(p->messages, DIAG_SYNTAX, l->first_where, "there is no statement `%s`", written);
    diag_hint(p->messages, "did you mean `%s`?", near);
    return true;
  }
  diag_report(p->messages, DIAG_SYNTAX, l->first_where, "`%s` is given no value", written);
  diag_hint(p->messages,
            t->token == '(' ? "a function is written `function %s(x) = ...`" : "write `%s = ...`",
            written);
  return true;
}

/* --- names ------------------------------------------------------------------------------------ */

static bool word_as_name(parsing *p, const trouble *t) {
  if (!is_word_of_language(t->token) || !t->expected[T_NAME]) return false;
  if (value_expected(t) && !is_value_end(p->lex.before_last) && p->lex.equals > 0) {
    if (p->lex.before_last == '=' || t->token == T_ON || t->token == T_BY || t->token == T_IN) {
      diag_report(p->messages, DIAG_SYNTAX, t->where,
                  "`%.*s` is a word of the language, not a value", TEXT(p, t->where));
      return true;
    }
    return false; /* a value is missing before it */
  }
  diag_report(p->messages, DIAG_SYNTAX, t->where,
              "`%.*s` is a word of the language and cannot be a name", TEXT(p, t->where));
  hint(p, "choose another name");
  return true;
}

static bool name_missing(parsing *p, const trouble *t) {
  if (!t->expected[T_NAME] || value_expected(t)) return false;
  int before = p->lex.before_last;
  if (before == T_ON) {
    say(p, p->lex.before_where, "the place after `on` is missing");
    hint(p, HINT_PLACES);
    return true;
  }
  if (before != p->lex.first || !is_word_of_language(before)) return false;
  span keyword = p->lex.before_where;
  if (before == T_END || before == T_LAW || before == T_FOR || before == T_MODEL) return false;
  diag_report(p->messages, DIAG_SYNTAX, keyword, "a name is missing after `%.*s`",
              TEXT(p, keyword));
  if (t->token == '=')
    diag_hint(p->messages, "`%.*s` begins a declaration; a quantity of your own needs another name",
              TEXT(p, keyword));
  return true;
}

static bool index_wrong(parsing *p, const trouble *t) {
  if (p->lex.before_last != '[' || !t->expected[T_NAME] || value_expected(t)) return false;
  say(p, t->where,
      "square brackets hold `j`, the neighbour, two axes of a tensor or one of a vector");
  hint(p, "write x[j], sigma[x,y] or v[x]; units stand after numbers only");
  return true;
}

static void hint_form(parsing *p);

/* `?` where no value can stand. */
static bool hole_misplaced(parsing *p, const trouble *t) {
  if (t->token != T_HOLE || value_expected(t)) return false;
  say(p, t->where, "`?` stands for a value that is still to be written, and none can stand here");
  if (p->lex.before_last == T_NEWLINE)
    hint(p, "a line that is still to be written has its name: x = ?");
  else if (is_value_end(p->lex.before_last) && operator_expected(t))
    hint(p, "cases are chosen by | value when guard, and on the last line | value otherwise");
  else if (t->expected[T_NAME])
    hint(p, "names are written out; only values may be left open");
  else
    hint_form(p);
  return true;
}

/* --- brackets --------------------------------------------------------------------------------- */

static bool bracket_not_closed(parsing *p, const trouble *t) {
  lexing *l = &p->lex;
  bool ends = t->token == T_NEWLINE || t->token == T_STRING || t->token == T_WHEN ||
              t->token == T_OTHERWISE || t->token == '|' || t->token == T_IN;
  if (!ends || l->open_count == 0 || (value_expected(t) && !is_value_end(l->before_last)))
    return false;
  span open = l->open[l->open_count - 1];
  diag_report(p->messages, DIAG_UNTERMINATED, open, "this `%.*s` is not closed", TEXT(p, open));
  if (t->token == T_NEWLINE && !p->alone) hint(p, "a line that goes on ends with `&`");
  return true;
}

static bool bracket_not_open(parsing *p, const trouble *t) {
  if ((t->token != ')' && t->token != ']') || !p->lex.stray_close) return false;
  diag_report(p->messages, DIAG_SYNTAX, t->where, "this `%c` closes nothing", t->token);
  return true;
}

static bool bracket_empty(parsing *p, const trouble *t) {
  if (t->token != ')' || p->lex.before_last != '(' || !value_expected(t)) return false;
  say(p, span_join(p->lex.before_where, t->where), "there is nothing in these brackets");
  return true;
}

/* sigma[x,y] = ... */
static bool component_set(parsing *p, const trouble *t) {
  const int first = p->lex.first;
  const bool of_name = t->token == ',' && t->expected[']'] && first == T_NAME,
             of_tensor = t->token == '[' && (first == T_STRESS || first == T_STRAIN);
  if (p->lex.equals > 0 || (!of_name && !of_tensor)) return false;
  say(p, t->where, "the components of a tensor are given all at once");
  hint(p, "write `= tensor(xx, yy, zz, xy)`, and behind these yz and xz where they are not 0");
  return true;
}

/* Whether [x,y] stands there. */
static bool is_component(const parsing *p, span bracket) {
  const char *at = p->lex.text + bracket.end;
  return bracket.end + 1 < p->lex.length && strchr("xyz", at[0]) && at[1] == ',';
}

static bool unit_misplaced(parsing *p, const trouble *t) {
  if (t->token != '[' || !is_value_end(p->lex.before_last)) return false;
  say(p, t->where, "a square bracket cannot stand here");
  hint(p, is_component(p, t->where)   ? "give the tensor a name, and take its component from that"
          : p->lex.before_last == ')' ? "a unit belongs to a number: 3 [mm]*(a + b)"
                                      : "units stand after numbers, [j] after names");
  return true;
}

static bool bounds_wrong(parsing *p, const trouble *t) {
  bool at_start = p->lex.before_last == T_IN;
  const bool declares = p->lex.first == T_PARAMETER || p->lex.first == T_FIELD;
  bool at_comma = t->expected[','] && !t->expected[')'] && p->lex.equals <= 1 && declares;
  if (!at_start && !at_comma) return false;
  if (at_start && t->token == T_NEWLINE)
    say(p, p->lex.before_where, "the bounds after `in` are missing");
  else
    diag_report(p->messages, DIAG_SYNTAX, t->where, "bounds were expected here, not %s",
                found_text(p, t));
  hint(p, "bounds are written (0, 1), [0, 1), (0, inf), ...; a round bracket leaves the end out");
  return true;
}

/* --- values and operators --------------------------------------------------------------------- */

static bool equal_for_equality(parsing *p, const trouble *t) {
  if (t->token != '=' || p->lex.equals < 2) return false;
  say(p, t->where, "`=` gives a name its value; it does not compare");
  hint(p, "equality is written `==`");
  return true;
}

/* Whether two commas stand before this one in the same brackets. */
static bool is_third_comma(const lexing *l, uint32_t at) {
  int commas = 0, depth = 0;
  while (at-- > 0 && l->text[at] != '\n' && depth >= 0) {
    depth += (l->text[at] == ')') - (l->text[at] == '(');
    commas += depth == 0 && l->text[at] == ',';
  }
  return depth < 0 && commas == 2;
}

static bool decimal_comma(parsing *p, const trouble *t) {
  const lexing *l = &p->lex;
  if (t->token != ',' || l->before_last != T_NUMBER || l->before_where.end != t->where.begin ||
      !isdigit((unsigned char)l->text[t->where.end]))
    return false;
  if (is_third_comma(l, t->where.begin)) {
    say(p, t->where, "a vector has two or three components");
    return true;
  }
  uint32_t end = t->where.end;
  while (isdigit((unsigned char)l->text[end]))
    end++;
  say(p, t->where, "a comma cannot stand here");
  if (end - t->where.end == 3)
    hint(p, "the decimal sign is a point, and digits are not grouped");
  else
    diag_hint(p->messages, "the decimal sign is a point: %.*s.%.*s", TEXT(p, l->before_where),
              (int)(end - t->where.end), l->text + t->where.end);
  return true;
}

static bool continues_name(char c) {
  return isalnum((unsigned char)c) || c == '_';
}

/* Longest run at `begin` that looks like a unit and is one; 0 without. No name is cut in two. */
static uint32_t unit_length(const parsing *p, uint32_t begin) {
  const char *text = p->lex.text + begin;
  uint32_t length = 0;
  while (text[length] && (isalnum((unsigned char)text[length]) || strchr("/*^%", text[length])))
    length++;
  unit ignored;
  const char *bad;
  size_t bad_length;
  for (; length > 0; length--)
    if (!continues_name(text[length]) && unit_parse(text, length, &ignored, &bad, &bad_length))
      return length;
  return 0;
}

static bool two_values(parsing *p, const trouble *t) {
  const lexing *l = &p->lex;
  if (!is_value_end(l->before_last) || !operator_expected(t)) return false;
  if (!is_name(t) && t->token != T_NUMBER && t->token != '(') return false;
  uint32_t length = is_name(t) && l->before_last == T_NUMBER ? unit_length(p, t->where.begin) : 0;
  if (length > 0) {
    span written = {t->where.begin, t->where.begin + length, p->file};
    say(p, written, "a unit stands in square brackets");
    diag_hint(p->messages, "write %.*s [%.*s]", TEXT(p, l->before_where), TEXT(p, written));
    return true;
  }
  if (text_is(p, t->where, "if") || text_is(p, t->where, "else")) {
    bool is_if = text_is(p, t->where, "if");
    diag_report(p->messages, DIAG_SYNTAX, t->where, "there is no `%s`", is_if ? "if" : "else");
    hint(p, is_if ? "a case is written | value when guard"
                  : "the last of the cases is written | value otherwise");
    return true;
  }
  diag_report(p->messages, DIAG_SYNTAX, t->where, "an operator is missing before %s",
              found_text(p, t));
  if (l->before_last == T_NUMBER || l->before_last == ')') hint(p, "products are written with `*`");
  return true;
}

static bool begins_line(const parsing *p, span where) {
  uint32_t at = where.begin;
  while (at > 0 && (p->lex.text[at - 1] == ' ' || p->lex.text[at - 1] == '\t'))
    at--;
  return at == 0 || p->lex.text[at - 1] == '\n';
}

static bool value_missing(parsing *p, const trouble *t) {
  const lexing *l = &p->lex;
  if (!value_expected(t)) return false;
  if (l->comment.end > l->comment.begin && (t->token == T_NEWLINE || t->token == '|') &&
      l->before_last != '=' && l->comment.end > l->comment.begin + 1 &&
      l->text[l->comment.begin + 1] != ' ') {
    say(p, l->comment, "`!` begins a comment, so a value is missing here");
    hint(p, "negation is written `not`");
    return true;
  }
  diag_report(p->messages, DIAG_SYNTAX, l->before_where, "the value after %s is missing",
              quoted(p, l->before_where));
  if (t->token == T_NEWLINE && p->alone)
    return true;
  else if (t->token == T_NEWLINE && !is_word_of_language(l->before_last) && l->before_last != '=')
    hint(p, "a line that goes on ends with `&`");
  else if (t->token == '|' && l->before_last != '|')
    hint(p, begins_line(p, t->where)
                ? "a line that begins with `|` continues the one above"
                : "cases inside an expression stand in round brackets of their own: max((| a when "
                  "guard | b otherwise), c)");
  else if (t->token == T_NOT)
    hint(p, "`not` and what it denies stand in brackets here: (not a)");
  else if (t->token == '*' && l->before_last == '/')
    hint(p, "comments begin with `!`");
  return true;
}

static bool chained_comparison(parsing *p, const trouble *t) {
  bool relation = t->token == '<' || t->token == '>' || t->token == T_LE || t->token == T_GE ||
                  t->token == T_EQ || t->token == T_NE;
  if (!relation || !operator_expected(t)) return false;
  say(p, t->where, "comparisons cannot be chained");
  hint(p, "write a < b and b < c");
  return true;
}

/* --- cases ------------------------------------------------------------------------------------ */

static bool case_without_guard(parsing *p, const trouble *t) {
  if (!t->expected[T_OTHERWISE] || (t->token != T_NEWLINE && t->token != '|' && t->token != ')'))
    return false;
  if (t->token == ')' && p->lex.stray_close) return false;
  diag_report(p->messages, DIAG_SYNTAX, p->lex.before_where,
              "this case does not say when it applies");
  hint(p, "write | value when guard, and on the last line | value otherwise");
  return true;
}

static bool case_misplaced(parsing *p, const trouble *t) {
  if (t->token != '|') return false;
  if (p->lex.first == '|' || p->lex.equals == 0) {
    say(p, t->where, "a line that begins with `|` continues the one above, which has no cases");
    return true;
  }
  if (is_value_end(p->lex.before_last) && operator_expected(t)) {
    say(p, t->where, "cases follow `=`, or stand in brackets of their own");
    return true;
  }
  return false;
}

static bool guard_without_case(parsing *p, const trouble *t) {
  if (t->token != T_WHEN && t->token != T_OTHERWISE) return false;
  if (!operator_expected(t) || p->lex.first == T_FLOW) return false;
  diag_report(p->messages, DIAG_SYNTAX, t->where, "`%.*s` belongs to a case", TEXT(p, t->where));
  hint(p, "a case begins with `|`: | value when guard, and on the last line | value otherwise");
  return true;
}

/* --- declarations ----------------------------------------------------------------------------- */

static const struct {
  int token;
  const char *form;
} forms[] = {
    {T_MODEL, "model my_law"},
    {T_END, "end model"},
    {T_LAW, "law central bond` or `law micropolar bond` or `law state"},
    {T_FOR, "for plane_stress, space"},
    {T_PARAMETER, "parameter E = 30 [GPa] in (0, inf) \"Young's modulus\""},
    {T_FIELD, "field T [K] on particle = 293 [K] \"temperature\""},
    {T_CONSTANT, "constant EA = E*area"},
    {T_OPTION, "option onset = rankine | mohr_coulomb"},
    {T_STATE, "state x on bond = 0"},
    {T_DAMAGE, "damage omega on bond = expression"},
    {T_FUNCTION, "function f(x, y) = expression"},
    {T_FORCE, "force N = expression` or, in a state law, `force state F[j] = expression"},
    {T_MOMENT, "moment M_i = expression"},
    {T_ENERGY, "energy W = expression"},
    {T_STRESS, "stress sigma = expression"},
    {T_STRAIN, "strain eps = expression"},
    {T_YIELD, "yield f = expression"},
    {T_FLOW, "flow x by increment when guard` or `flow x along direction returned when guard"},
    {T_RATE, "rate x = expression"},
    {T_OUTPUT, "output x = expression \"what it is\""},
    {T_NONCONSERVATIVE, "nonconservative \"why\""},
    {T_REST, "rest stretch = expression` or, in a law of a continuum, `rest strain = expression"},
    {T_ACCEPT, "accept patch \"why\""},
    {T_INCLUDE, "include \"shared.plm\""},
};

static void hint_form(parsing *p) {
  for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++)
    if (forms[i].token == p->lex.first) diag_hint(p->messages, "its form is `%s`", forms[i].form);
}

static bool unit_before_value(parsing *p, const trouble *t) {
  if (t->token != '=' || p->lex.before_last != T_UNIT) return false;
  say(p, p->lex.before_where, "the unit stands after the number");
  hint(p, "write parameter E = 30 [GPa]");
  return true;
}

static bool equal_missing(parsing *p, const trouble *t) {
  if (!t->expected['='] || p->lex.equals > 0) return false;
  span before = p->lex.before_where;
  diag_report(p->messages, DIAG_SYNTAX, before, "`=` and a value are missing after %s",
              quoted(p, before));
  hint_form(p);
  return true;
}

static bool text_not_last(parsing *p, const trouble *t) {
  if (p->lex.before_last != T_STRING || t->token == T_NEWLINE) return false;
  say(p, t->where, "the quoted text ends a declaration");
  hint(p, "put it last on the line");
  return true;
}

static bool text_missing(parsing *p, const trouble *t) {
  if (!t->expected[T_STRING] || t->expected[T_NEWLINE]) return false;
  diag_report(p->messages, DIAG_SYNTAX, p->lex.before_where, "a quoted text is missing after %s",
              quoted(p, p->lex.before_where));
  hint_form(p);
  return true;
}

static const char *word_of_token(parsing *p, int token) {
  switch (token) {
  case T_NEWLINE:
    return "the end of the line";
  case T_NAME:
    return "a name";
  case T_STRING:
    return "a quoted text";
#define X(word_token, text)                                                                        \
  case T_##word_token:                                                                             \
    return "`" text "`";
    LINE_WORDS(X)
    RESERVED_WORDS(X)
#undef X
  default:
    return token < 256 ? arena_printf(p->memory, "`%c`", token) : NULL;
  }
}

/* Signs that may follow almost anything; naming them would not help. */
static bool goes_without_saying(const trouble *t, int token) {
  if (token == T_AND || token == T_OR || token == T_NOT) return true;
  if (token == '[') return true;
  return token < 256 && operator_expected(t) && strchr("+-*/:<>(", token) != NULL;
}

/* "`)` or `,`": what could have stood here. */
static const char *expected_text(parsing *p, const trouble *t) {
  const char *list = NULL;
  for (int token = 1; token < TOKEN_CODES; token++) {
    if (!t->expected[token] || goes_without_saying(t, token)) continue;
    const char *one = word_of_token(p, token);
    if (!one) continue;
    list = list ? arena_printf(p->memory, "%s or %s", list, one) : one;
  }
  return list;
}

static bool line_begins_wrong(parsing *p, const trouble *t) {
  if (p->lex.before_last != T_NEWLINE) return false;
  diag_report(p->messages, DIAG_SYNTAX, t->where, "a line cannot begin with %s", found_text(p, t));
  if (t->token != T_STRING && t->token != T_NUMBER)
    hint(p, "when it continues the line above, that one ends with `&`");
  return true;
}

static bool anything_else(parsing *p, const trouble *t) {
  const char *expected = expected_text(p, t);
  if (!expected)
    diag_report(p->messages, DIAG_SYNTAX, t->where, "%s cannot stand here", found_text(p, t));
  else if (t->token == T_NEWLINE)
    diag_report(p->messages, DIAG_SYNTAX, t->where, "the line ends too early; expected %s",
                expected);
  else
    diag_report(p->messages, DIAG_SYNTAX, t->where, "%s cannot stand here; expected %s",
                found_text(p, t), expected);
  hint_form(p);
  return true;
}

void syntax_error(parsing *p, int token, span where, const bool expected[TOKEN_CODES]) {
  static const slip_test tests[] = {
      foreign_statement,  hole_misplaced,     misspelt_statement, unit_before_value,
      equal_for_equality, decimal_comma,      bounds_wrong,       bracket_not_open,
      bracket_empty,      case_without_guard, case_misplaced,     word_as_name,
      name_missing,       index_wrong,        bracket_not_closed, guard_without_case,
      chained_comparison, component_set,      two_values,         unit_misplaced,
      text_not_last,      text_missing,       line_begins_wrong,  value_missing,
      equal_missing,      anything_else};
  if (!first_complaint(p)) return;
  trouble t = {token, where, expected};
  for (size_t i = 0; i < sizeof tests / sizeof tests[0]; i++)
    if (tests[i](p, &t)) return;
}

/* --- characters and numbers that are no tokens ------------------------------------------------ */

static const struct {
  const char *text, *hint;
} slips[] = {
    {"^", "powers are written `**`"},
    {"&&", "write `and`"},
    {"||", "write `or`"},
    {"~", "negation is written `not`"},
    {";", "each statement has its own line"},
    {"&", "`&` continues a line and is the last character on it; `and` joins conditions"},
    {"!=", "not equal is written `/=`; `!` begins a comment"},
    {"<>", "not equal is written `/=`"},
    {"=<", "write `<=`"},
    {"=>", "write `>=`"},
    {"===", "equality is written `==`"},
    {":=", "write `=`"},
    {"->", "write `=`"},
    {"+=", "a name is given its value once; use a new name, or a state"},
    {"-=", "a name is given its value once; use a new name, or a state"},
    {"*=", "a name is given its value once; use a new name, or a state"},
    {"//", "comments begin with `!`"},
    {"#", "comments begin with `!`"},
    {"%", "write a percentage as a number: 5 [%] or 0.05"},
    {"{", "write round brackets; in a unit, square ones"},
    {"}", "write round brackets; in a unit, square ones"},
    {".and.", "write `and`"},
    {".or.", "write `or`"},
    {".not.", "write `not`"},
    {".eq.", "write `==`"},
    {".ne.", "write `/=`"},
    {".lt.", "write `<`"},
    {".le.", "write `<=`"},
    {".gt.", "write `>`"},
    {".ge.", "write `>=`"},
    {"\xE2\x88\x92", "write the minus sign of the keyboard, `-`"}, /* U+2212 */
    {"\xE2\x80\x93", "write the minus sign of the keyboard, `-`"}, /* en dash */
    {"\xC2\xB7", "write `*`"},
    {"\xC3\x97", "write `*`"},
    {"\xE2\x89\xA4", "write `<=`"},
    {"\xE2\x89\xA5", "write `>=`"},
    {"\xE2\x89\xA0", "write `/=`"},
    {"\xE2\x88\x9E", "write `inf`"},
    {"\xC2\xB2", "write `**2`"},
    {"\xC2\xB3", "write `**3`"},
    {"\xE2\x80\x9C", "texts stand in straight quotes, \"...\""},
    {"\xE2\x80\x9D", "texts stand in straight quotes, \"...\""},
    {"\xE2\x80\x98", "texts stand in straight quotes, '...'"},
    {"\xE2\x80\x99", "write the straight quote of the keyboard, '"},
    {"\xC2\xA0", "this is a no-break space; write an ordinary one"},
};

void syntax_slip(parsing *p, span where) {
  if (!first_complaint(p)) return;
  unsigned char first = (unsigned char)p->lex.text[where.begin];
  bool one = where.end - where.begin == 1;
  if (one && (!isprint(first) || first >= 0x80))
    diag_report(p->messages, DIAG_BAD_CHARACTER, where, "the character with code %d cannot be read",
                first);
  else
    diag_report(p->messages, DIAG_BAD_CHARACTER, where, "`%.*s` means nothing here",
                TEXT(p, where));
  for (size_t i = 0; i < sizeof slips / sizeof slips[0]; i++)
    if (text_is(p, where, slips[i].text)) {
      hint(p, slips[i].hint);
      return;
    }
  if (first >= 0xC2) hint(p, "names are made of the letters a-z and A-Z, digits and `_`");
}

void syntax_bad_number(parsing *p, span where) {
  if (!first_complaint(p)) return;
  const char *text = p->lex.text + where.begin;
  uint32_t digits = (uint32_t)strspn(text, "0123456789."), length = where.end - where.begin;
  diag_report(p->messages, DIAG_BAD_NUMBER, where, "%s is not a number", quoted(p, where));
  uint32_t rest = unit_length(p, where.begin + digits);
  if (digits < length && rest > 0 && digits + rest >= length)
    diag_hint(p->messages, "a unit stands in square brackets: %.*s [%.*s]", (int)digits, text,
              (int)rest, text + digits);
  else if (text[0] != '0' && isalpha((unsigned char)text[digits]) && !strchr("eEdD", text[digits]))
    diag_hint(p->messages, "a product is written %.*s*%.*s", (int)digits, text,
              (int)(length - digits), text + digits);
  else if (text[digits] == '_')
    hint(p, "digits are not grouped");
  else
    hint(p, "numbers are written 30, 0.2, 1e-3, 1.18d-4");
}
