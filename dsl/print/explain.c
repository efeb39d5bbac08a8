#include "dsl/print/explain.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/characters.h"
#include "dsl/print/explain_math.h"
#include "dsl/semantics/law_reads.h"
#include "dsl/semantics/resolve.h"

typedef struct page {
  const law *law;
  const law_choice *choices; /* options that are decided */
  int choice_count;
  bool latex;
  FILE *out;
} page;

static const expr *resolved(const page *p, const expr *e) {
  return resolve_options(p->law, e, p->choices, p->choice_count);
}

static void put_math(const page *p, const expr *e) {
  math_expr(p->law, resolved(p, e), p->out);
}

/* --- text ------------------------------------------------------------------------------------- */

/* Greek letters from alpha (U+03B1) on; pdflatex knows them as formulas only. */
static const char *const greek_names[] = {
    "alpha", "beta",   "gamma",   "delta",  "varepsilon", "zeta",    "eta",  "theta", "iota",
    "kappa", "lambda", "mu",      "nu",     "xi",         "omicron", "pi",   "rho",   "varsigma",
    "sigma", "tau",    "upsilon", "varphi", "chi",        "psi",     "omega"};

static void put_latex_character(const char *at, size_t length, FILE *out) {
  unsigned first = (unsigned char)at[0], second = length > 1 ? (unsigned char)at[1] : 0;
  unsigned code = length == 2 ? (first & 0x1F) << 6 | (second & 0x3F) : 0;
  if (length == 1 && strchr("&%$#_{}", at[0]))
    fprintf(out, "\\%c", at[0]);
  else if (length == 1 && strchr("\\~^", at[0]))
    fputs(at[0] == '\\'  ? "\\textbackslash{}"
          : at[0] == '~' ? "\\textasciitilde{}"
                         : "\\textasciicircum{}",
          out);
  else if (code >= 0x3B1 && code <= 0x3C9 && code != 0x3BF)
    fprintf(out, "\\ensuremath{\\%s}", greek_names[code - 0x3B1]);
  else if (length == 1 || code >= 0xA0)
    fwrite(at, 1, code >= 0x250 ? 0 : length, out);
  else
    fputc('?', out);
}

/* A description in running text or in a cell of a table; line ends become blanks. */
static void put_text(const page *p, const char *text) {
  size_t rest = strlen(text);
  while (rest > 0) {
    size_t n = utf8_length(text, rest);
    unsigned char byte = (unsigned char)*text;
    if (n == 1 && (byte < 32 || byte == 127))
      fputc(' ', p->out);
    else if (n == 0)
      fputc('?', p->out);
    else if (p->latex)
      put_latex_character(text, n, p->out);
    else if (n == 1 && strchr("|*_`<$\\", byte))
      fprintf(p->out, "\\%c", byte);
    else
      fwrite(text, 1, n, p->out);
    n = n ? n : 1;
    text += n;
    rest -= n;
  }
}

static void put_code(const page *p, const char *name) {
  if (!p->latex) {
    fprintf(p->out, "`%s`", name);
    return;
  }
  fputs("\\texttt{", p->out);
  put_text(p, name);
  fputc('}', p->out);
}

static void put_heading(const page *p, const char *text) {
  fprintf(p->out, p->latex ? "\n\\section*{%s}\n" : "\n## %s\n", text);
}

/* --- tables ----------------------------------------------------------------------------------- */

static void begin_table(const page *p, const char *const *titles, int count) {
  fputs(p->latex ? "\n\\begin{longtable}{@{}" : "\n|", p->out);
  for (int i = 0; p->latex && i < count; i++)
    fputs(i + 1 == count ? "p{0.4\\textwidth}" : "l", p->out);
  if (p->latex) fputs("@{}}\n", p->out);
  for (int i = 0; i < count; i++)
    if (p->latex)
      fprintf(p->out, "%s%s", titles[i], i + 1 == count ? " \\\\ \\hline\n" : " & ");
    else
      fprintf(p->out, " %s |", titles[i]);
  if (p->latex) return;
  fputs("\n|", p->out);
  for (int i = 0; i < count; i++)
    fputs("---|", p->out);
  fputc('\n', p->out);
}

static void end_table(const page *p) {
  if (p->latex) fputs("\\end{longtable}\n", p->out);
}

static void begin_row(const page *p) {
  if (!p->latex) fputs("| ", p->out);
}
static void next_cell(const page *p) {
  fputs(p->latex ? " & " : " | ", p->out);
}
static void end_row(const page *p) {
  fputs(p->latex ? " \\\\\n" : " |\n", p->out);
}

/* First cells of every row: the letters, then the name as the law writes it. */
static void put_name_cells(const page *p, const char *name) {
  begin_row(p);
  fputc('$', p->out);
  math_symbol(p->law, name, NO_STEP, false, false, p->out);
  fputc('$', p->out);
  next_cell(p);
  put_code(p, name);
  next_cell(p);
}

static void put_unit_cell(const page *p, const char *unit_text) {
  if (strcmp(unit_text, "1") == 0) {
    fputs("1", p->out);
  } else {
    fputc('$', p->out);
    math_unit(unit_text, p->out);
    fputc('$', p->out);
  }
  next_cell(p);
}

static void put_dimension_cell(const page *p, dimension dim) {
  char text[64];
  dim_unit(dim, text, sizeof text);
  put_unit_cell(p, text);
}

static void put_bounds(const page *p, const bounds *b) {
  if (!b->given) return;
  fputs(b->lower_open ? "$(" : "$[", p->out);
  if (b->lower)
    put_math(p, b->lower);
  else
    fputs("-\\infty", p->out);
  fputs(",\\, ", p->out);
  if (b->upper)
    put_math(p, b->upper);
  else
    fputs("\\infty", p->out);
  fputs(b->upper_open ? ")$" : "]$", p->out);
}

static void put_default(const page *p, const symbol *of) {
  const stmt *s = of->declared;
  if (!s->value) {
    fputs("required", p->out);
    return;
  }
  fputc('$', p->out);
  put_math(p, s->value);
  fputc('$', p->out);
  if (of->follows) fprintf(p->out, " (%.6g in SI units)", of->initial);
}

/* Parameters, or the fields that a deck gives in place and time. */
static void put_parameters(const page *p, const char *title, bool fields) {
  static const char *const titles[] = {"symbol", "name", "unit", "default", "bounds", "meaning"};
  const symbol_list *list = &p->law->parameters;
  int count = 0;
  for (int i = 0; i < list->count; i++)
    count += symbol_is_field(list->items[i]) == fields;
  if (count == 0) return;
  put_heading(p, title);
  begin_table(p, titles, 6);
  for (int i = 0; i < list->count; i++) {
    const symbol *s = list->items[i];
    if (symbol_is_field(s) != fields) continue;
    if (s->component > 0) continue;
    if (s->component_of) s = s->component_of;
    put_name_cells(p, s->name);
    put_dimension_cell(p, s->dim);
    put_default(p, s);
    next_cell(p);
    put_bounds(p, &s->declared->in);
    next_cell(p);
    if (s->doc) put_text(p, s->doc);
    end_row(p);
  }
  end_table(p);
}

/* `require h in ...` */
static void put_sizes(const page *p) {
  const stmt *s = p->law->sized;
  if (!s) return;
  fputs("\nFor cells whose size $", p->out);
  math_symbol(p->law, s->name, NO_STEP, false, false, p->out);
  fputs("$ is in ", p->out);
  put_bounds(p, &s->in);
  if (s->text) fputs(": ", p->out);
  if (s->text) put_text(p, s->text);
  fputs(".\n", p->out);
}

static bool is_chosen(const page *p, const char *option) {
  for (int k = 0; k < p->choice_count; k++)
    if (strcmp(p->choices[k].option, option) == 0) return true;
  return false;
}

static void put_options(const page *p) {
  const char *const titles[] = {"option", "choices", p->choice_count ? "chosen" : "default",
                                "meaning"};
  const symbol_list *list = &p->law->options;
  if (list->count == 0) return;
  put_heading(p, "Options");
  begin_table(p, titles, 4);
  for (int i = 0; i < list->count; i++) {
    const stmt *s = list->items[i]->declared;
    begin_row(p);
    put_code(p, s->name);
    next_cell(p);
    for (int k = 0; k < s->word_count; k++) {
      if (k) fputs(", ", p->out);
      put_code(p, s->words[k]);
    }
    next_cell(p);
    if (!p->choice_count || is_chosen(p, s->name)) put_code(p, p->law->chosen[i]);
    next_cell(p);
    if (list->items[i]->doc) put_text(p, list->items[i]->doc);
    end_row(p);
  }
  end_table(p);
}

static void put_fields(const page *p) {
  static const char *const titles[] = {"symbol", "name", "unit", "lives on", "at first", "meaning"};
  const symbol_list *list = &p->law->fields;
  if (list->count == 0) return;
  put_heading(p, "States and damages");
  begin_table(p, titles, 6);
  for (int i = 0; i < list->count; i++) {
    const symbol *s = list->items[i];
    if (s->component > 0 || s->rate_of) continue;
    if (s->component_of) s = s->component_of;
    put_name_cells(p, s->name);
    put_dimension_cell(p, s->dim);
    fputs(placement_name(s->place), p->out);
    next_cell(p);
    fprintf(p->out,
            s->deviator                ? "deviator %g"
            : s->shape == SHAPE_TENSOR ? "tensor %g"
            : s->shape == SHAPE_VECTOR ? "vector %g"
                                       : "%g",
            s->kind == SYMBOL_DAMAGE ? 0.0 : s->initial);
    next_cell(p);
    if (s->doc) put_text(p, s->doc);
    if (s->kind == SYMBOL_DAMAGE)
      fputs(s->doc ? " (a damage: from 0 to 1)" : "a damage: from 0 to 1", p->out);
    end_row(p);
  }
  end_table(p);
}

/* --- quantities that the law reads ------------------------------------------------------------ */

/* From what it is measured. */
static void put_rest(const page *p, const char *quantity) {
  const symbol *rest = p->law->rest;
  if (!rest || strcmp(quantity, law_resting(p->law->tree->law)) != 0) return;
  put_text(p, "; less ");
  put_code(p, rest->name);
}

static void put_quantities(const page *p) {
  static const char *const titles[] = {"symbol", "name", "unit", "meaning"};
  bool read[QUANTITY_COUNT] = {false}, any = false;
  for (const stmt *s = p->law->tree->first; s; s = s->next) {
    quantities_read(resolved(p, s->value), read);
    quantities_read(resolved(p, s->when), read);
  }
  read[QUANTITY_PI] = false; /* a number */
  for (int q = 0; q < QUANTITY_COUNT; q++)
    any |= read[q];
  if (!any) return;
  const law_kind kind = p->law->tree->law;
  put_heading(p, kind == LAW_CONTINUUM ? "Given by the motion of the point"
                 : kind == LAW_CRACK   ? "Given at the tip"
                                       : "Given by lattice and motion");
  begin_table(p, titles, 4);
  for (int q = 0; q < QUANTITY_COUNT; q++) {
    if (!read[q]) continue;
    put_name_cells(p, builtin_quantities[q].name);
    put_unit_cell(p, builtin_quantities[q].unit);
    put_text(p, builtin_quantities[q].meaning);
    put_rest(p, builtin_quantities[q].name);
    end_row(p);
  }
  end_table(p);
}

/* --- equations -------------------------------------------------------------------------------- */

static void begin_formula(const page *p) {
  fputs(p->latex ? "\\[ " : "$$", p->out);
}
static void end_formula(const page *p) {
  fputs(p->latex ? " \\]\n" : "$$\n", p->out);
}

static void put_letters(const page *p, const stmt *s, step_index step) {
  math_symbol(p->law, s->name, step, s->indexed, false, p->out);
}

static void put_function(const page *p, const stmt *s) {
  put_letters(p, s, NO_STEP);
  fputs("\\left(", p->out);
  for (int i = 0; i < s->word_count; i++) {
    if (i) fputs(",\\, ", p->out);
    math_symbol(p->law, s->words[i], NO_STEP, false, false, p->out);
  }
  fputs("\\right) = ", p->out);
  put_math(p, s->value);
}

/* What the compiler makes of a damage rule: it never decreases and stays in [0, 1]. */
static void put_damage(const page *p, const stmt *s) {
  put_letters(p, s, STEP_NEW);
  fputs(" = \\max\\left(", p->out);
  put_letters(p, s, STEP_OLD);
  fputs(",\\, \\min\\left(1,\\, \\hat{d}\\right)\\right), \\qquad \\hat{d} = ", p->out);
  put_math(p, s->value);
}

/* One increment a step where the guard is true. */
static void put_flow(const page *p, const stmt *s) {
  put_letters(p, s, STEP_NEW);
  fputs(" = ", p->out);
  put_letters(p, s, STEP_OLD);
  fputs(s->returned ? " + \\begin{cases} \\Delta\\left(" : " + \\begin{cases} ", p->out);
  put_math(p, s->value);
  fputs(s->returned ? "\\right) \\text{ back to the limit} & \\text{when } " : " & \\text{when } ",
        p->out);
  put_math(p, s->when);
  fputs(" \\\\ 0 & \\text{otherwise} \\end{cases}", p->out);
}

/* A differential equation. What it reads of the state is the state itself. */
static void put_rate(const page *p, const stmt *s) {
  fputs("\\frac{\\mathrm{d}}{\\mathrm{d}t}\\,", p->out);
  put_letters(p, s, NO_STEP);
  fputs(" = ", p->out);
  put_math(p, s->value);
}

static void put_equation(const page *p, const stmt *s) {
  const symbol *target = s->symbol;
  if (s->kind == STMT_FUNCTION) {
    put_function(p, s);
  } else if (s->kind == STMT_FLOW) {
    put_flow(p, s);
  } else if (s->kind == STMT_RATE) {
    put_rate(p, s);
  } else if (target && target->kind == SYMBOL_DAMAGE) {
    put_damage(p, s);
  } else {
    put_letters(p, s, math_has_step(target) ? STEP_NEW : NO_STEP);
    fputs(" = ", p->out);
    put_math(p, s->value);
  }
}

static void put_statement(const page *p, const stmt *s) {
  fputc('\n', p->out);
  static const char *const words[STMT_COUNT] = {
      [STMT_FORCE] = "Force",   [STMT_FORCE_STATE] = "Force state",
      [STMT_MOMENT] = "Moment", [STMT_ENERGY] = "Energy",
      [STMT_OUTPUT] = "Output", [STMT_YIELD] = "Yield function"};
  const char *word = words[s->kind];
  if (word) fputs(word, p->out);
  for (int i = 0; i < 2; i++) {
    const char *text = i ? s->text : s->doc;
    if (!text) continue;
    if (word) fputs(": ", p->out);
    put_text(p, text);
    word = text;
  }
  if (word) fputs("\n\n", p->out);
  begin_formula(p);
  put_equation(p, s);
  end_formula(p);
}

static bool is_rule(const stmt *s) {
  switch (s->kind) {
  case STMT_PARAMETER:
  case STMT_FIELD:
  case STMT_OPTION:
  case STMT_STATE:
  case STMT_NONCONSERVATIVE:
  case STMT_ACCEPT:
  case STMT_INCLUDE:
    return false;
  default:
    return s->value != NULL && !(s->total && !s->symbol->used);
  }
}

static void put_section(const page *p, const char *title, bool fixed) {
  bool begun = false;
  for (const stmt *s = p->law->tree->first; s; s = s->next) {
    bool is_fixed = s->kind == STMT_CONSTANT || s->kind == STMT_FUNCTION;
    if (!is_rule(s) || is_fixed != fixed) continue;
    if (!begun) put_heading(p, title);
    begun = true;
    put_statement(p, s);
  }
}

/* --- the whole -------------------------------------------------------------------------------- */

static void put_settings(const page *p) {
  const tree *t = p->law->tree;
  for (int i = 0; i < t->setting_count; i++) {
    fputs(i ? ", " : "\nFor ", p->out);
    put_code(p, t->settings[i]);
  }
  if (t->setting_count) fputs(".\n", p->out);
  if (t->anisotropic) fputs("\nIts response depends on the axes.\n", p->out);
}

static void put_head(const page *p) {
  static const char preamble[] = "\\documentclass[11pt]{article}\n\\usepackage[utf8]{inputenc}\n"
                                 "\\usepackage[T1]{fontenc}\n\\usepackage{amsmath,amssymb}\n"
                                 "\\usepackage{longtable}\n\\usepackage[margin=25mm]{geometry}\n"
                                 "\\setlength{\\parindent}{0pt}\n\\begin{document}\n\\section*{";
  fputs(p->latex ? preamble : "# ", p->out);
  put_text(p, p->law->tree->name);
  fputs(p->latex ? "}\n\n" : "\n\n", p->out);
  fputs("Kind: ", p->out);
  put_code(p, law_kind_name(p->law->tree->law));
  fputs(".\n", p->out);
  if (p->law->tree->doc) {
    fputc('\n', p->out);
    put_text(p, p->law->tree->doc);
    fputc('\n', p->out);
  }
  put_settings(p);
}

static void put_steps(const page *p) {
  const symbol_list *fields = &p->law->fields;
  bool returned = false, rates = false;
  if (fields->count == 0) return;
  for (int k = 0; k < fields->count; k++) {
    const stmt *rule = fields->items[k]->rule;
    returned = returned || (rule && rule->returned);
    rates = rates || (rule && rule->kind == STMT_RATE);
  }
  fprintf(
      p->out,
      "\nThe index $(n)$ marks values of the present step, $(n-1)$ those at the end of the last "
      "one%s; everything else is of the present step%s.\n",
      returned ? ", $(*)$ those on the way back to the limit" : "",
      rates ? ", a state without an index as it goes on within the step" : "");
}

void explain_law(const law *l, explain_form form, const law_choice *choices, int choice_count,
                 FILE *out) {
  page p = {l, choices, choice_count, form == EXPLAIN_LATEX, out};
  put_head(&p);
  put_parameters(&p, "Parameters", false);
  put_parameters(&p, "Fields in place and time", true);
  put_sizes(&p);
  put_options(&p);
  put_fields(&p);
  put_quantities(&p);
  put_section(&p, "Fixed", true);
  put_section(&p, "In each step, in this order", false);
  put_steps(&p);
  const char *check, *why;
  for (int k = 0; law_says(l, k, &check, &why); k++) {
    fprintf(out, "\nAccepted, %s: ", check);
    put_text(&p, why);
    fputs("\n", out);
  }
  if (p.latex) fputs("\\end{document}\n", out);
}
