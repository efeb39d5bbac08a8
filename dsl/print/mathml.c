#include "dsl/print/mathml.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/characters.h"

/* What is left of a formula. */
typedef struct reader {
  const char *at, *end;
  int depth;
} reader;

enum { DEEPEST = 400 };

static void put_items(reader *r, const char *const *stops, FILE *out);

/* --- commands that are one sign --------------------------------------------------------------- */

/* X(command, element, what it holds) */
#define SIGNS(X)                                                                                   \
  X("alpha", "mi", "α")                                                                            \
  X("beta", "mi", "β")                                                                             \
  X("gamma", "mi", "γ")                                                                            \
  X("delta", "mi", "δ")                                                                            \
  X("varepsilon", "mi", "ε")                                                                       \
  X("epsilon", "mi", "ϵ")                                                                          \
  X("zeta", "mi", "ζ")                                                                             \
  X("eta", "mi", "η")                                                                              \
  X("theta", "mi", "θ")                                                                            \
  X("iota", "mi", "ι")                                                                             \
  X("kappa", "mi", "κ")                                                                            \
  X("lambda", "mi", "λ")                                                                           \
  X("mu", "mi", "μ")                                                                               \
  X("nu", "mi", "ν")                                                                               \
  X("xi", "mi", "ξ")                                                                               \
  X("pi", "mi", "π")                                                                               \
  X("rho", "mi", "ρ")                                                                              \
  X("sigma", "mi", "σ")                                                                            \
  X("tau", "mi", "τ")                                                                              \
  X("upsilon", "mi", "υ")                                                                          \
  X("varphi", "mi", "φ")                                                                           \
  X("phi", "mi", "ϕ")                                                                              \
  X("chi", "mi", "χ")                                                                              \
  X("psi", "mi", "ψ")                                                                              \
  X("omega", "mi", "ω")                                                                            \
  X("Gamma", "mi", "Γ")                                                                            \
  X("Delta", "mi", "Δ")                                                                            \
  X("Theta", "mi", "Θ")                                                                            \
  X("Lambda", "mi", "Λ")                                                                           \
  X("Xi", "mi", "Ξ")                                                                               \
  X("Pi", "mi", "Π")                                                                               \
  X("Sigma", "mi", "Σ")                                                                            \
  X("Upsilon", "mi", "Υ")                                                                          \
  X("Phi", "mi", "Φ")                                                                              \
  X("Psi", "mi", "Ψ")                                                                              \
  X("Omega", "mi", "Ω")                                                                            \
  X("partial", "mi", "∂")                                                                          \
  X("infty", "mi", "∞")                                                                            \
  X("max", "mi", "max")                                                                            \
  X("min", "mi", "min")                                                                            \
  X("exp", "mi", "exp")                                                                            \
  X("ln", "mi", "ln")                                                                              \
  X("log", "mi", "log")                                                                            \
  X("sin", "mi", "sin")                                                                            \
  X("cos", "mi", "cos")                                                                            \
  X("tan", "mi", "tan")                                                                            \
  X("arcsin", "mi", "arcsin")                                                                      \
  X("arccos", "mi", "arccos")                                                                      \
  X("sinh", "mi", "sinh")                                                                          \
  X("cosh", "mi", "cosh")                                                                          \
  X("tanh", "mi", "tanh")                                                                          \
  X("sum", "mo", "∑")                                                                              \
  X("cdot", "mo", "·")                                                                             \
  X("times", "mo", "×")                                                                            \
  X("le", "mo", "≤")                                                                               \
  X("ge", "mo", "≥")                                                                               \
  X("ne", "mo", "≠")                                                                               \
  X("prime", "mo", "′")                                                                            \
  X("lVert", "mo", "‖")                                                                            \
  X("rVert", "mo", "‖")                                                                            \
  X("langle", "mo", "⟨")                                                                           \
  X("rangle", "mo", "⟩")                                                                           \
  X("to", "mo", "→")

static const struct {
  const char *command, *element, *text;
} signs[] = {
#define X(command, element, text) {command, element, text},
    SIGNS(X)
#undef X
};

/* --- pieces ----------------------------------------------------------------------------------- */

static bool begins(const reader *r, const char *word) {
  const size_t length = strlen(word);
  return (size_t)(r->end - r->at) >= length && memcmp(r->at, word, length) == 0;
}

/* The command at hand, without its backslash; "" where the sign behind it is no letter. */
static size_t command_length(const reader *r) {
  size_t length = 0;
  while (r->at + 1 + length < r->end && isalpha((unsigned char)r->at[1 + length]))
    length++;
  return length;
}

static bool is_command(const reader *r, const char *name) {
  const size_t length = strlen(name);
  return r->at < r->end && *r->at == '\\' && command_length(r) == length &&
         memcmp(r->at + 1, name, length) == 0;
}

static bool take_command(reader *r, const char *name) {
  if (!is_command(r, name)) return false;
  r->at += 1 + strlen(name);
  return true;
}

static void skip_blanks(reader *r) {
  while (r->at < r->end && isspace((unsigned char)*r->at))
    r->at++;
}

static void put_escaped(const char *text, size_t length, FILE *out) {
  for (size_t k = 0; k < length; k++)
    markup_put(out, text[k]);
}

/* {words}, where signs of LaTeX have a backslash; blanks at the ends are kept by browsers alone
   when they cannot be broken. */
static void put_words(reader *r, const char *open, const char *close, FILE *out) {
  static const char blank[] = "\xC2\xA0";
  fputs(open, out);
  if (r->at < r->end && *r->at == '{') r->at++;
  for (; r->at < r->end && *r->at != '}'; r->at++) {
    if (*r->at == '\\' && r->at + 1 < r->end) r->at++;
    if (*r->at == ' ')
      fputs(blank, out);
    else
      put_escaped(r->at, 1, out);
  }
  if (r->at < r->end) r->at++;
  fputs(close, out);
}

/* {items}, or the next item alone. */
static void put_group(reader *r, FILE *out) {
  static const char *const close[] = {"}", NULL};
  skip_blanks(r);
  fputs("<mrow>", out);
  if (r->at < r->end && *r->at == '{') {
    r->at++;
    put_items(r, close, out);
    if (r->at < r->end) r->at++;
  }
  fputs("</mrow>", out);
}

/* What stands behind \left or \right; a full stop is none. */
static void put_fence(reader *r, FILE *out) {
  skip_blanks(r);
  if (r->at >= r->end) return;
  for (size_t k = 0; k < sizeof signs / sizeof *signs && *r->at == '\\'; k++)
    if (take_command(r, signs[k].command)) {
      fprintf(out, "<mo fence=\"true\" stretchy=\"true\">%s</mo>", signs[k].text);
      return;
    }
  if (*r->at != '.') {
    fputs("<mo fence=\"true\" stretchy=\"true\">", out);
    put_escaped(r->at, 1, out);
    fputs("</mo>", out);
  }
  r->at++;
}

static void put_fenced(reader *r, FILE *out) {
  static const char *const right[] = {"\\right", NULL};
  fputs("<mrow>", out);
  put_fence(r, out);
  put_items(r, right, out);
  if (take_command(r, "right")) put_fence(r, out);
  fputs("</mrow>", out);
}

static void put_root(reader *r, FILE *out) {
  char degree = 0;
  if (r->at + 2 < r->end && r->at[0] == '[' && r->at[2] == ']') {
    degree = r->at[1];
    r->at += 3;
  }
  fputs(degree ? "<mroot>" : "<msqrt>", out);
  put_group(r, out);
  if (degree)
    fprintf(out, "<mn>%c</mn></mroot>", isdigit((unsigned char)degree) ? degree : '3');
  else
    fputs("</msqrt>", out);
}

/* value & condition \\ ... The brace is the left border of the table: few fonts have one that
   grows. */
static void put_cases(reader *r, FILE *out) {
  static const char *const stops[] = {"&", "\\\\", "\\end{cases}", NULL};
  fputs("<mtable class=\"cases\" displaystyle=\"true\">", out);
  while (r->at < r->end && !begins(r, stops[2])) {
    fputs("<mtr>", out);
    for (bool more = true; more;) {
      fputs("<mtd>", out);
      put_items(r, stops, out);
      fputs("</mtd>", out);
      more = begins(r, "&");
      r->at += more;
    }
    fputs("</mtr>", out);
    if (begins(r, stops[1])) r->at += 2;
  }
  if (begins(r, stops[2])) r->at += strlen(stops[2]);
  fputs("</mtable>", out);
}

/* --- items ------------------------------------------------------------------------------------ */

static bool put_space(reader *r, FILE *out) {
  static const struct {
    const char *command, *width;
  } spaces[] = {{"\\,", "0.17em"}, {"\\;", "0.28em"}, {"\\qquad", "2em"}, {"\\ ", "0.25em"}};
  for (size_t k = 0; k < sizeof spaces / sizeof *spaces; k++)
    if (begins(r, spaces[k].command)) {
      r->at += strlen(spaces[k].command);
      fprintf(out, "<mspace width=\"%s\"></mspace>", spaces[k].width);
      return true;
    }
  return false;
}

static void put_command(reader *r, FILE *out) {
  for (size_t k = 0; k < sizeof signs / sizeof *signs; k++)
    if (take_command(r, signs[k].command)) {
      fprintf(out, "<%s>%s</%s>", signs[k].element, signs[k].text, signs[k].element);
      return;
    }
  if (take_command(r, "frac")) {
    fputs("<mfrac>", out);
    put_group(r, out);
    put_group(r, out);
    fputs("</mfrac>", out);
  } else if (take_command(r, "left"))
    put_fenced(r, out);
  else if (take_command(r, "sqrt"))
    put_root(r, out);
  else if (take_command(r, "hat")) {
    fputs("<mover accent=\"true\">", out);
    put_group(r, out);
    fputs("<mo>^</mo></mover>", out);
  } else if (take_command(r, "mathrm") || take_command(r, "operatorname"))
    put_words(r, "<mi mathvariant=\"normal\">", "</mi>", out);
  else if (take_command(r, "mathit"))
    put_words(r, "<mi class=\"word\">", "</mi>", out);
  else if (take_command(r, "text"))
    put_words(r, "<mtext>", "</mtext>", out);
  else if (begins(r, "\\begin{cases}")) {
    r->at += strlen("\\begin{cases}");
    put_cases(r, out);
  } else if (!put_space(r, out)) { /* \%, \_ */
    r->at++;
    const size_t length = command_length(&(reader){r->at - 1, r->end, 0});
    fputs("<mtext>", out);
    put_escaped(r->at, length ? length : r->at < r->end, out);
    fputs("</mtext>", out);
    r->at += length ? length : r->at < r->end;
  }
}

static void put_number(reader *r, FILE *out) {
  const char *begun = r->at;
  while (r->at < r->end && (isdigit((unsigned char)*r->at) || *r->at == '.'))
    r->at++;
  fprintf(out, "<mn>%.*s</mn>", (int)(r->at - begun), begun);
}

/* One item, without scripts. */
static void put_base(reader *r, FILE *out) {
  const unsigned char c = (unsigned char)*r->at;
  if (c == '\\')
    put_command(r, out);
  else if (c == '{')
    put_group(r, out);
  else if (isdigit(c))
    put_number(r, out);
  else if (c == '-') {
    fputs("<mo>−</mo>", out);
    r->at++;
  } else {
    const size_t known = utf8_length(r->at, (size_t)(r->end - r->at)), length = known ? known : 1;
    fputs(isalpha(c) || c >= 128 ? "<mi>" : "<mo>", out);
    put_escaped(r->at, length, out);
    fputs(isalpha(c) || c >= 128 ? "</mi>" : "</mo>", out);
    r->at += length;
  }
}

/* What a group of braces, or one item, is as MathML; malloc'ed. */
static char *text_of(reader *r, void (*put)(reader *, FILE *)) {
  char *text = NULL;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  put(r, out);
  must_close_text(out);
  return text;
}

static void put_script(reader *r, FILE *out) {
  skip_blanks(r);
  if (r->at >= r->end)
    fputs("<mrow></mrow>", out);
  else if (*r->at == '{')
    put_group(r, out);
  else
    put_base(r, out);
}

/* An item with what stands below and above it. */
static void put_item(reader *r, FILE *out) {
  char *base = text_of(r, put_base), *scripts[2] = {NULL, NULL}; /* below, above */
  for (skip_blanks(r); r->at < r->end && (*r->at == '_' || *r->at == '^'); skip_blanks(r)) {
    const int k = *r->at++ == '^';
    free(scripts[k]);
    scripts[k] = text_of(r, put_script);
  }
  static const char *const elements[2][2] = {{NULL, "msup"}, {"msub", "msubsup"}};
  const char *element = elements[scripts[0] != NULL][scripts[1] != NULL];
  if (element) fprintf(out, "<%s>", element);
  fputs(base, out);
  for (int k = 0; k < 2; k++) {
    if (scripts[k]) fputs(scripts[k], out);
    free(scripts[k]);
  }
  if (element) fprintf(out, "</%s>", element);
  free(base);
}

/* Up to one of the stops, which is left. */
static void put_items(reader *r, const char *const *stops, FILE *out) {
  if (++r->depth > DEEPEST) r->at = r->end;
  for (skip_blanks(r); r->at < r->end; skip_blanks(r)) {
    bool stop = false;
    for (int k = 0; stops[k]; k++)
      stop = stop || begins(r, stops[k]);
    if (stop) break;
    if (*r->at == '}') /* closes nothing */
      r->at++;
    else
      put_item(r, out);
  }
  r->depth--;
}

void mathml_put(const char *latex, size_t length, bool block, FILE *out) {
  static const char *const none[] = {NULL};
  reader r = {latex, latex + length, 0};
  fprintf(out, "<math%s><mrow>", block ? " display=\"block\"" : "");
  put_items(&r, none, out);
  fputs("</mrow></math>", out);
}
