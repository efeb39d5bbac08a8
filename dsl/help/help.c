#include "dsl/help/help.h"

#include <string.h>

#include "dsl/base/units.h"
#include "dsl/semantics/builtins.h"

/* X(code, line of a law) */
#define FUNCTION_EXAMPLES(X)                                                                       \
  X(ABS, "x = abs(stretch)")                                                                       \
  X(SQRT, "x = sqrt(length*s)")                                                                    \
  X(CBRT, "x = cbrt(V)")                                                                           \
  X(EXP, "x = exp(-stretch/S_t)")                                                                  \
  X(LOG, "x = log(1 + stretch)")                                                                   \
  X(SIN, "x = sin(norm(theta_i))")                                                                 \
  X(COS, "x = cos(30 [deg])")                                                                      \
  X(TAN, "x = tan(30 [deg])")                                                                      \
  X(TANH, "x = tanh(stretch/S_t)")                                                                 \
  X(ATAN2, "x = atan2(norm(theta_i), stretch)")                                                    \
  X(SIGN, "x = sign(stretch)")                                                                     \
  X(SOFT_SIGN, "x = soft_sign(stretch_rate/10 [1/s])")                                             \
  X(MACAULAY, "x = positive_part(stretch - S_t)")                                                  \
  X(MIN, "x = min(stretch, S_t)")                                                                  \
  X(MAX, "x = max(norm(theta_i), norm(theta_j))")                                                  \
  X(NORM, "x = norm(theta_i + theta_j)")                                                           \
  X(PREVIOUS, "x = omega - previous(omega)")                                                       \
  X(DIFF, "x = diff(stretch**2, stretch)")                                                         \
  X(SUM, "x = sum(stretch[j])")                                                                    \
  X(MEAN, "x = mean(stretch[j], weight = length[j])")                                              \
  X(DEVIATOR, "x[j] = deviator(F[j])")                                                             \
  X(VIRTUAL_WORK, "stress x = virtual_work(F)")                                                    \
  X(FIT, "strain x = fit(stretch)")                                                                \
  X(UNIFORM_FORCE, "x[j] = uniform_force(virtual_work(F))")                                        \
  X(UNIFORM_STRETCH, "x[j] = stretch[j] - uniform_stretch(fit(stretch))")                          \
  X(HOOKE, "stress x = hooke(fit(stretch), 30 [GPa], 0.2)")                                        \
  X(PRINCIPAL, "x = principal(fit(stretch), 1)")                                                   \
  X(TRACE, "x = trace(fit(stretch))")                                                              \
  X(DEV, "x = norm(dev(fit(stretch)))")                                                            \
  X(J2, "x = J2(virtual_work(F))")                                                                 \
  X(VON_MISES, "x = von_mises(virtual_work(F))")

/* X(code, line of a law) */
#define QUANTITY_EXAMPLES(X)                                                                       \
  X(STRETCH, "x = stretch**2")                                                                     \
  X(STRETCH_RATE, "x = stretch_rate/10 [1/s]")                                                     \
  X(THETA_I, "x = norm(2*theta_i + theta_j)")                                                      \
  X(THETA_J, "x = norm(2*theta_j + theta_i)")                                                      \
  X(TWIST, "x = twist/s")                                                                          \
  X(LENGTH, "x = length/s - 1")                                                                    \
  X(S, "x = stretch*s")                                                                            \
  X(SPACING, "x = s/spacing")                                                                      \
  X(T, "x = s*t")                                                                                  \
  X(V, "x = V/spacing**2")                                                                         \
  X(M_BOND, "x = sqrt(EA/s/m)")                                                                    \
  X(M_END_I, "x = m_i*m_j/(m_i + m_j)")                                                            \
  X(M_END_J, "x = min(m_i, m_j)/m_j")                                                              \
  X(AREA, "x = area*length")                                                                       \
  X(SHELL, "x = | 1 when shell == 1 | 0.5 otherwise")                                              \
  X(HORIZON, "x = s/horizon")                                                                      \
  X(WEIGHT, "x = sum(weight*stretch[j])")                                                          \
  X(RESOLVED, "x = | 1 when resolved >= 1 | 0 otherwise")                                          \
  X(N_FAMILY, "x = sum(stretch[j])/n")                                                             \
  X(DIRECTION, "x = norm(direction)")

const char *help_function_example(int function) {
  switch (function) {
#define X(code, line)                                                                              \
  case FUNCTION_##code:                                                                            \
    return line;
    FUNCTION_EXAMPLES(X)
#undef X
  default:
    return NULL;
  }
}

const char *help_quantity_example(int quantity) {
  switch (quantity) {
#define X(code, line)                                                                              \
  case QUANTITY_##code:                                                                            \
    return line;
    QUANTITY_EXAMPLES(X)
#undef X
  default:
    return NULL;
  }
}

/* --- pages ------------------------------------------------------------------------------------ */

/* A Markdown page for a terminal: examples are indented instead of fenced. */
static void print_page(const help_page *p, FILE *out) {
  bool fenced = false;
  fprintf(out, p->section == HELP_CODES ? "%s (a message)\n" : "%s (a word of the language)\n",
          p->name);
  const char *line = p->text + strcspn(p->text, "\n"); /* the heading has been printed */
  for (line += *line == '\n'; *line;) {
    size_t n = strcspn(line, "\n");
    if (strncmp(line, "```", 3) == 0)
      fenced = !fenced;
    else
      fprintf(out, "%s%.*s\n", fenced && n ? "    " : "", (int)n, line);
    line += n + (line[n] == '\n');
  }
}

static int show_pages(const char *topic, FILE *out) {
  int shown = 0;
  for (int i = 0; i < help_page_count; i++) {
    if (strcmp(help_pages[i].name, topic) != 0) continue;
    if (shown++) fputc('\n', out);
    print_page(&help_pages[i], out);
  }
  return shown;
}

/* --- built-ins -------------------------------------------------------------------------------- */

static void show_quantity(int q, FILE *out) {
  static const char *const laws[] = {[IN_CENTRAL] = "central bond laws",
                                     [IN_MICROPOLAR] = "micropolar bond laws",
                                     [IN_PAIR] = "bond laws",
                                     [IN_STATE] = "state laws",
                                     [IN_CENTRAL | IN_STATE] = "central bond and state laws",
                                     [IN_MICROPOLAR | IN_STATE] = "micropolar bond and state laws",
                                     [IN_ANY] = "all laws"};
  static const char *const shapes[] = {"number", "logical value", "bending quantity", "vector",
                                       "tensor"};
  const builtin_quantity_info *b = &builtin_quantities[q];
  fprintf(out, "%s (a quantity of lattice and motion)\n\n%s.\n", b->name, b->meaning);
  fprintf(out, "unit %s; a %s of the %s; in %s\n\n    %s\n", b->unit, shapes[b->shape],
          placement_name(b->place), laws[b->kinds], help_quantity_example(q));
}

static void show_function(int f, FILE *out) {
  const builtin_function_info *b = &builtin_functions[f];
  fprintf(out, "%s (a function)\n\n%s.\n", b->name, b->meaning);
  if (b->least == b->most)
    fprintf(out, "%d argument%s\n", b->least, b->least == 1 ? "" : "s");
  else
    fprintf(out, "%d to %d arguments\n", b->least, b->most);
  fprintf(out, "\n    %s\n", help_function_example(f));
}

static void show_units(FILE *out) {
  int count, column = 0;
  const char *const *symbols = unit_symbols(&count);
  fputs("units\n\nA unit stands in brackets after a number: 30 [GPa], 2323 [kg/m^3], 10 [1/s], 5 "
        "[J/(kg*K)].\n"
        "The symbols are\n\n   ",
        out);
  for (int i = 0; i < count; i++) {
    if (column > 0 && column % 15 == 0) fputs("\n   ", out);
    fprintf(out, " %s", symbols[i]);
    column++;
  }
  fputc('\n', out);
}

int help_show(const char *topic, FILE *out) {
  int shown = show_pages(topic, out);
  int q = builtin_quantity_find(topic), f = builtin_function_find(topic);
  if (q >= 0) {
    if (shown++) fputc('\n', out);
    show_quantity(q, out);
  }
  if (f >= 0) {
    if (shown++) fputc('\n', out);
    show_function(f, out);
  }
  if (strcmp(topic, "units") == 0) {
    if (shown++) fputc('\n', out);
    show_units(out);
  }
  return shown;
}

int help_topic_count(void) {
  return help_page_count + (int)QUANTITY_COUNT + (int)FUNCTION_COUNT + 1;
}

void help_topics(const char **names) {
  int n = 0;
  for (int i = 0; i < help_page_count; i++)
    names[n++] = help_pages[i].name;
  for (int q = 0; q < QUANTITY_COUNT; q++)
    names[n++] = builtin_quantities[q].name;
  for (int f = 0; f < FUNCTION_COUNT; f++)
    names[n++] = builtin_functions[f].name;
  names[n] = "units";
}
