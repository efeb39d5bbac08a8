#include "dsl/print/explain_math.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* --- names ------------------------------------------------------------------------------------ */

/* X(word in a name, letter) */
#define GREEK(X)                                                                                   \
  X("alpha", "alpha")                                                                              \
  X("beta", "beta")                                                                                \
  X("gamma", "gamma")                                                                              \
  X("delta", "delta")                                                                              \
  X("eps", "varepsilon")                                                                           \
  X("epsilon", "epsilon")                                                                          \
  X("zeta", "zeta") X("eta", "eta") X("theta", "theta") X("iota", "iota") X("kappa", "kappa")      \
      X("lambda", "lambda") X("mu", "mu") X("nu", "nu") X("xi", "xi") X("pi", "pi")                \
          X("rho", "rho") X("sigma", "sigma") X("tau", "tau") X("upsilon", "upsilon")              \
              X("phi", "varphi") X("chi", "chi") X("psi", "psi") X("omega", "omega")               \
                  X("Gamma", "Gamma") X("Delta", "Delta") X("Theta", "Theta")                      \
                      X("Lambda", "Lambda") X("Xi", "Xi") X("Pi", "Pi") X("Sigma", "Sigma")        \
                          X("Upsilon", "Upsilon") X("Phi", "Phi") X("Psi", "Psi")                  \
                              X("Omega", "Omega")

static const struct {
  const char *word, *letter;
} greek[] = {
#define X(word, letter) {word, letter},
    GREEK(X)
#undef X
};

static const char *greek_letter(const char *word, size_t length) {
  for (size_t i = 0; i < sizeof greek / sizeof greek[0]; i++)
    if (strlen(greek[i].word) == length && memcmp(greek[i].word, word, length) == 0)
      return greek[i].letter;
  return NULL;
}

/* One part of a name, between underscores. */
static void put_part(const char *part, size_t length, bool subscript, FILE *out) {
  const char *letter = greek_letter(part, length);
  if (letter)
    fprintf(out, "\\%s", letter);
  else if (length == 1 || isdigit((unsigned char)part[0]))
    fprintf(out, "%.*s", (int)length, part);
  else
    fprintf(out, "\\%s{%.*s}", subscript ? "mathrm" : "mathit", (int)length, part);
}

/* Digits that end a word without underscore are a subscript too: alpha1. */
static size_t without_digits(const char *part, size_t length) {
  size_t n = length;
  while (n > 0 && isdigit((unsigned char)part[n - 1]))
    n--;
  return n > 0 ? n : length;
}

static void put_letters(const char *name, FILE *out) {
  size_t length = strcspn(name, "_"), head = without_digits(name, length);
  put_part(name, head, false, out);
  const char *rest = name + head;
  if (!*rest) return;
  fputs("_{", out);
  for (bool first = true; *rest; first = false) {
    rest += *rest == '_';
    size_t n = strcspn(rest, "_");
    if (!first) fputs(",", out);
    put_part(rest, n, true, out);
    rest += n;
  }
  fputc('}', out);
}

/* Names with empty parts have no letters. */
static bool is_plain(const char *name) {
  size_t n = strlen(name);
  return name[0] != '_' && name[n - 1] != '_' && !strstr(name, "__");
}

static char *plain_letters(const char *name) {
  char *text = NULL;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  if (is_plain(name)) {
    put_letters(name, out);
  } else {
    fputs("\\mathrm{", out);
    for (; *name; name++)
      fprintf(out, *name == '_' ? "\\_" : "%c", *name);
    fputc('}', out);
  }
  must_close_text(out);
  return text;
}

static bool differs_in_underscores_only(const char *a, const char *b) {
  for (;; a++, b++) {
    while (*a == '_')
      a++;
    while (*b == '_')
      b++;
    if (*a != *b) return false;
    if (!*a) return true;
  }
}

/* alpha1 and alpha_1 would look the same. */
static bool has_twin(const law *l, const char *name) {
  for (const stmt *s = l->tree->first; s; s = s->next)
    if (s->name && strcmp(s->name, name) != 0 && differs_in_underscores_only(s->name, name))
      return true;
  return false;
}

/* The letters of a name: `omega` is \omega, `eps_mp` is \varepsilon_{\mathrm{mp}}. Names of a law
   that would look the same are written out instead. malloc'ed. */
static char *math_letters(const law *l, const char *name) {
  if (!is_plain(name) || !has_twin(l, name)) return plain_letters(name);
  char *text = must_calloc(2 * strlen(name) + 16, 1), *to = text;
  to += sprintf(to, "\\mathrm{");
  for (; *name; name++) {
    if (*name == '_') *to++ = '\\';
    *to++ = *name;
  }
  *to = '}';
  return text;
}

bool math_has_step(const symbol *s) {
  return s && (s->kind == SYMBOL_STATE || s->kind == SYMBOL_DAMAGE);
}

/* The neighbour joins a subscript that is there. */
static void put_with_neighbour(char *letters, FILE *out) {
  size_t n = strlen(letters);
  if (strchr(letters, '_') && letters[n - 1] == '}' && strncmp(letters, "\\mathrm{", 8) != 0) {
    letters[n - 1] = 0;
    fprintf(out, "%s,j}", letters);
  } else {
    fprintf(out, "%s_{j}", letters);
  }
}

void math_symbol(const law *l, const char *name, step_index step, bool indexed, bool primed,
                 FILE *out) {
  char *letters = math_letters(l, name);
  if (indexed || primed)
    put_with_neighbour(letters, out);
  else
    fputs(letters, out);
  free(letters);
  static const char *const steps[] = {"", "(n-1)", "(n)", "(*)"};
  if (step != NO_STEP || primed) fprintf(out, "^{%s%s}", primed ? "\\prime " : "", steps[step]);
}

/* --- units and numbers ------------------------------------------------------------------------ */

/* The exponent that begins at `at`; returns where it ends. */
static const char *put_exponent(const char *at, FILE *out) {
  fputs("^{", out);
  if (*at == '(') {
    size_t n = strcspn(at, ")");
    fprintf(out, "%.*s", (int)n - 1, at + 1);
    at += n + (at[n] == ')');
  } else {
    size_t n = strspn(at, "+-.0123456789");
    fprintf(out, "%.*s", (int)n, at);
    at += n;
  }
  fputc('}', out);
  return at;
}

static void put_unit(const char *at, const char *end, FILE *out);

/* Behind `sqrt(`; returns what stands behind its end. */
static const char *put_unit_root(const char *at, const char *end, FILE *out) {
  const char *to = at;
  for (int depth = 1; to < end && (depth -= *to == ')') > 0; to++)
    depth += *to == '(';
  fputs("\\sqrt{", out);
  put_unit(at, to, out);
  fputc('}', out);
  return to < end ? to + 1 : end;
}

static void put_unit(const char *at, const char *end, FILE *out) {
  while (at < end) {
    size_t letters = 0;
    while (isalpha((unsigned char)at[letters]))
      letters++;
    if (strncmp(at, "sqrt(", 5) == 0) {
      at = put_unit_root(at + 5, end, out);
    } else if (letters > 0) {
      fprintf(out, "\\mathrm{%.*s}", (int)letters, at);
      at += letters;
    } else if (strncmp(at, "**", 2) == 0) {
      at = put_exponent(at + 2, out);
    } else if (*at == '^') {
      at = put_exponent(at + 1, out);
    } else if (strncmp(at, "\xC2\xB5", 2) == 0 || strncmp(at, "\xCE\xBC", 2) == 0) {
      fputs("\\mu", out);
      at += 2;
    } else {
      if (*at == '*')
        fputs("\\,", out);
      else if (*at == '%')
        fputs("\\%", out);
      else if (*at != ' ' && (unsigned char)*at < 128)
        fputc(*at, out);
      at++;
    }
  }
}

void math_unit(const char *unit_text, FILE *out) {
  put_unit(unit_text, unit_text + strlen(unit_text), out);
}

static bool is_small(double number) {
  return number != 0 && number < 1e-3;
}

/* The fewest digits that give the number back; powers of ten where there are any. */
static void put_number(const expr *e, FILE *out) {
  char text[40];
  bool tiny = is_small(e->number);
  for (int digits = tiny ? 0 : 6; digits <= 17; digits++) {
    snprintf(text, sizeof text, tiny ? "%.*e" : "%.*g", digits, e->number);
    if (strtod(text, NULL) == e->number) break;
  }
  char *exponent = strchr(text, 'e');
  if (exponent) {
    *exponent = 0;
    const char *mantissa = strcmp(text, "1") == 0 ? "" : text;
    fprintf(out, "%s%s10^{%ld}", mantissa, *mantissa ? "\\cdot " : "",
            strtol(exponent + 1, NULL, 10));
  } else {
    fputs(text, out);
  }
  if (!e->unit_text) return;
  bool rate = strncmp(e->unit_text, "1/", 2) == 0; /* 10/s rather than 10 1/s */
  if (!rate) fputs("\\,", out);
  math_unit(e->unit_text + rate, out);
}

/* --- expressions ------------------------------------------------------------------------------ */

/* How tightly a formula holds together; what stands in a tighter place needs brackets. */
typedef enum level {
  HOLDS_OR,
  HOLDS_AND,
  HOLDS_NOT,
  HOLDS_RELATION,
  HOLDS_SUM,
  HOLDS_SIGN,
  HOLDS_PRODUCT,
  HOLDS_ATOM
} level;

static bool is_call_of(const expr *e, int function) {
  return e->kind == EXPR_CALL && e->builtin == function;
}

static level level_of(const expr *e) {
  switch (e->kind) {
  case EXPR_NUMBER:
    return e->unit_text || e->number >= 1e6 || is_small(e->number) ? HOLDS_PRODUCT : HOLDS_ATOM;
  case EXPR_UNARY:
    return e->unary >= OP_COMPONENT ? HOLDS_ATOM : e->unary == OP_NOT ? HOLDS_NOT : HOLDS_SIGN;
  case EXPR_BINARY:
    switch (e->binary) {
    case OP_OR:
      return HOLDS_OR;
    case OP_AND:
      return HOLDS_AND;
    case OP_ADD:
    case OP_SUB:
      return HOLDS_SUM;
    case OP_MUL:
    case OP_CONTRACT:
    case OP_DIV:
      return HOLDS_PRODUCT;
    case OP_POW:
      return HOLDS_ATOM;
    default:
      return HOLDS_RELATION;
    }
  case EXPR_CASES:
    return HOLDS_OR;
  case EXPR_CALL:
    return is_call_of(e, FUNCTION_DOT) || is_call_of(e, FUNCTION_CROSS) ? HOLDS_SIGN : HOLDS_ATOM;
  default:
    return HOLDS_ATOM;
  }
}

/* In brackets unless the expression holds together at least this tightly. */
static void put(const law *l, const expr *e, level least, FILE *out);

static void put_in_brackets(const law *l, const expr *e, FILE *out) {
  fputs("\\left(", out);
  put(l, e, HOLDS_OR, out);
  fputs("\\right)", out);
}

static void put_name(const law *l, const expr *e, FILE *out) {
  const symbol *s = e->symbol;
  if (s && (s->kind == SYMBOL_OPTION || s->kind == SYMBOL_CHOICE)) {
    fputs("\\mathrm{", out);
    for (const char *c = e->name; *c; c++)
      fprintf(out, *c == '_' ? "\\_" : "%c", *c);
    fputc('}', out);
    return;
  }
  const bool flows = math_has_step(s) && s->rule && s->rule->returned;
  step_index step = !math_has_step(s) || e->goes_on ? NO_STEP
                    : !e->reads_old                 ? STEP_NEW
                    : flows                         ? STEP_FLOWING
                                                    : STEP_OLD;
  math_symbol(l, e->name, step, e->indexed, e->primed, out);
}

static bool begins_with_digit(const expr *e) {
  while (e->kind == EXPR_BINARY && (e->binary == OP_MUL || e->binary == OP_POW))
    e = e->left;
  return e->kind == EXPR_NUMBER;
}

static bool is_product(const expr *e) {
  return e->kind == EXPR_BINARY && (e->binary == OP_MUL || e->binary == OP_DIV);
}

/* Factors side by side; one that is a product was in brackets and keeps them, unless it is a
 * fraction. */
static void put_factors(const law *l, const expr *const *factors, int count, FILE *out) {
  for (int i = 0; i < count; i++) {
    const expr *e = factors[i];
    bool fraction = is_product(e) && e->binary == OP_DIV;
    if (i) fputs(begins_with_digit(e) ? "\\cdot " : "\\,", out);
    put(l, e, count == 1 ? HOLDS_OR : fraction || i == 0 ? HOLDS_PRODUCT : HOLDS_ATOM, out);
  }
}

/* a*b/c*d/e as written, from left to right: the fraction ab/c, then d/e. */
static void put_product(const law *l, const expr *e, FILE *out) {
  const expr *factors[TREE_DEEPEST + 1];
  bool divides[TREE_DEEPEST + 1];
  int first = TREE_DEEPEST + 1;
  for (; is_product(e); e = e->left) {
    factors[--first] = e->right;
    divides[first] = e->binary == OP_DIV;
  }
  factors[--first] = e;
  divides[first] = false;
  for (int at = first, end = TREE_DEEPEST + 1; at < end;) {
    int below = at, next;
    while (below < end && !divides[below])
      below++;
    for (next = below; next < end && divides[next];)
      next++;
    if (at > first) fputs(below == next && begins_with_digit(factors[at]) ? "\\cdot " : "\\,", out);
    if (below < next) fputs("\\frac{", out);
    bool alone = below == next && at > first && next == at + 1; /* beside a fraction, not in one */
    if (alone)
      put(l, factors[at], HOLDS_ATOM, out);
    else
      put_factors(l, factors + at, below - at, out);
    if (below < next) {
      fputs("}{", out);
      put_factors(l, factors + below, next - below, out);
      fputc('}', out);
    }
    at = next;
  }
}

/* A base that is a letter alone, or has its own brackets. */
static bool is_good_base(const expr *e) {
  if (e->kind == EXPR_NUMBER) return level_of(e) == HOLDS_ATOM;
  if (e->kind == EXPR_NAME) return !math_has_step(e->symbol) && !e->primed;
  return e->kind == EXPR_CALL && e->builtin >= 0 &&
         strncmp(builtin_functions[e->builtin].formula, "\\left", 5) == 0;
}

static void put_power(const law *l, const expr *e, FILE *out) {
  fputc('{', out);
  if (is_good_base(e->left))
    put(l, e->left, HOLDS_ATOM, out);
  else
    put_in_brackets(l, e->left, out);
  fputs("}^{", out);
  put(l, e->right, HOLDS_OR, out);
  fputc('}', out);
}

static void put_infix(const law *l, const expr *e, FILE *out) {
  static const char *const signs[OP_BINARY_COUNT] = {[OP_OR] = " \\;\\text{or}\\; ",
                                                     [OP_AND] = " \\;\\text{and}\\; ",
                                                     [OP_EQ] = " = ",
                                                     [OP_NE] = " \\ne ",
                                                     [OP_LT] = " < ",
                                                     [OP_LE] = " \\le ",
                                                     [OP_GT] = " > ",
                                                     [OP_GE] = " \\ge ",
                                                     [OP_ADD] = " + ",
                                                     [OP_SUB] = " - ",
                                                     [OP_CONTRACT] = " : "};
  level own = level_of(e);
  put(l, e->left, own == HOLDS_RELATION ? HOLDS_SUM : own, out);
  fputs(signs[e->binary], out);
  level right = own == HOLDS_RELATION ? HOLDS_SUM
                : own == HOLDS_SUM    ? HOLDS_PRODUCT
                                      : (level)(own + 1);
  put(l, e->right, right, out);
}

static void put_binary(const law *l, const expr *e, FILE *out) {
  switch (e->binary) {
  case OP_MUL:
  case OP_DIV:
    put_product(l, e, out);
    break;
  case OP_POW:
    put_power(l, e, out);
    break;
  default:
    put_infix(l, e, out);
    break;
  }
}

static void put_cases(const law *l, const expr *e, FILE *out) {
  fputs("\\begin{cases} ", out);
  for (int i = 0; i < e->case_count; i++) {
    const case_line *c = &e->cases[i];
    if (i) fputs(" \\\\ ", out);
    put(l, c->value, HOLDS_OR, out);
    fputs(c->guard ? " & \\text{when } " : " & \\text{otherwise}", out);
    if (c->guard) put(l, c->guard, HOLDS_OR, out);
  }
  fputs(" \\end{cases}", out);
}

/* --- functions -------------------------------------------------------------------------------- */

static void put_arguments(const law *l, const expr *e, FILE *out) {
  fputs("\\left(", out);
  for (int i = 0; i < e->argument_count; i++) {
    const argument *a = &e->arguments[i];
    if (i) fputs(",\\, ", out);
    if (a->keyword) fprintf(out, "\\text{%s } ", a->keyword);
    put(l, a->value, HOLDS_OR, out);
  }
  fputs("\\right)", out);
}

/* As the table of functions has it: |x|, or a name before bracketed arguments. */
static void put_function(const law *l, const expr *e, FILE *out) {
  const char *formula = e->builtin < 0 ? "" : builtin_functions[e->builtin].formula;
  const size_t before = strcspn(formula, "#");
  if (formula[before]) {
    fprintf(out, "%.*s", (int)before, formula);
    put(l, e->arguments[0].value, HOLDS_OR, out);
    fputs(formula + before + 1, out);
    return;
  }
  if (*formula)
    fputs(formula, out);
  else
    math_symbol(l, e->name, NO_STEP, false, false, out);
  put_arguments(l, e, out);
}

static void put_derivative(const law *l, const expr *e, FILE *out) {
  fputs("\\frac{\\partial}{\\partial ", out);
  put(l, e->arguments[1].value, HOLDS_OR, out);
  fputc('}', out);
  put_in_brackets(l, e->arguments[0].value, out);
}

static void put_vector_product(const law *l, const expr *e, FILE *out) {
  put(l, e->arguments[0].value, HOLDS_ATOM, out);
  fputs(is_call_of(e, FUNCTION_DOT) ? " \\cdot " : " \\times ", out);
  put(l, e->arguments[1].value, HOLDS_ATOM, out);
}

/* A^T, A^-1 */
static void put_raised(const law *l, const expr *e, FILE *out) {
  fputc('{', out);
  put(l, e->arguments[0].value, HOLDS_ATOM, out);
  fputs(is_call_of(e, FUNCTION_TRANSPOSE) ? "}^{T}" : "}^{-1}", out);
}

static void put_call(const law *l, const expr *e, FILE *out) {
  const expr *first = e->argument_count ? e->arguments[0].value : NULL;
  if (is_call_of(e, FUNCTION_PREVIOUS) && first && first->kind == EXPR_NAME) {
    math_symbol(l, first->name, STEP_OLD, first->indexed, first->primed, out);
  } else if (is_call_of(e, FUNCTION_DIFF) && e->argument_count == 2) {
    put_derivative(l, e, out);
  } else if (is_call_of(e, FUNCTION_VECTOR)) {
    put_arguments(l, e, out);
  } else if (is_call_of(e, FUNCTION_DOT) || is_call_of(e, FUNCTION_CROSS)) {
    put_vector_product(l, e, out);
  } else if (is_call_of(e, FUNCTION_TRANSPOSE) || is_call_of(e, FUNCTION_INVERSE)) {
    put_raised(l, e, out);
  } else {
    put_function(l, e, out);
  }
}

static void put_component(const law *l, const expr *e, FILE *out) {
  fputs("{", out);
  put(l, e->left, HOLDS_ATOM, out);
  if (e->unary == OP_AXIS)
    fprintf(out, "}_{%c}", vector_axis(e->component));
  else
    fprintf(out, "}_{%c%c}", tensor_axis(e->component, 0), tensor_axis(e->component, 1));
}

static void put_bare(const law *l, const expr *e, FILE *out) {
  static const char *const signs[] = {[OP_NEG] = "-", [OP_PLUS] = "+", [OP_NOT] = "\\text{not }"};
  switch (e->kind) {
  case EXPR_NUMBER:
    put_number(e, out);
    break;
  case EXPR_NAME:
    put_name(l, e, out);
    break;
  case EXPR_UNARY:
    if (e->unary >= OP_COMPONENT) {
      put_component(l, e, out);
      break;
    }
    fputs(signs[e->unary], out);
    put(l, e->left, e->unary == OP_NOT ? HOLDS_ATOM : HOLDS_PRODUCT, out);
    break;
  case EXPR_BINARY:
    put_binary(l, e, out);
    break;
  case EXPR_CALL:
    put_call(l, e, out);
    break;
  case EXPR_CASES:
    put_cases(l, e, out);
    break;
  case EXPR_HOLE: /* of a law that is not checked, and so not explained */
    break;
  }
}

static void put(const law *l, const expr *e, level least, FILE *out) {
  bool bare = level_of(e) >= least;
  if (!bare) fputs("\\left(", out);
  put_bare(l, e, out);
  if (!bare) fputs("\\right)", out);
}

void math_expr(const law *l, const expr *e, FILE *out) {
  put(l, e, HOLDS_OR, out);
}
