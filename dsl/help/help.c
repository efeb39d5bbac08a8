#include "dsl/help/help.h"

#include <string.h>

#include "dsl/base/units.h"
#include "dsl/semantics/builtins.h"

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

/* What a word of the language declares stands on its page. */
static const struct {
  const char *name, *page;
} declared[] = {{"rest_stretch", "rest"},
                {"total_stretch", "rest"},
                {"rest_strain", "rest"},
                {"total_strain", "rest"}};
enum { DECLARED = sizeof declared / sizeof *declared };

static int show_pages(const char *topic, FILE *out) {
  int shown = 0;
  for (int i = 0; i < DECLARED; i++)
    if (strcmp(declared[i].name, topic) == 0) topic = declared[i].page;
  for (int i = 0; i < help_page_count; i++) {
    if (strcmp(help_pages[i].name, topic) != 0) continue;
    if (shown++) fputc('\n', out);
    print_page(&help_pages[i], out);
  }
  return shown;
}

/* --- built-ins -------------------------------------------------------------------------------- */

static void show_quantity(int q, FILE *out) {
  static const char *const shapes[] = {"number", "logical value", "bending quantity", "vector",
                                       "tensor"};
  const builtin_quantity_info *b = &builtin_quantities[q];
  fprintf(out, "%s (a quantity that a law may read)\n\n%s.\n", b->name, b->meaning);
  fprintf(out, "unit %s; a %s of the %s; laws: %s\n\n    %s\n", b->unit, shapes[b->shape],
          placement_name(b->place), builtin_laws(b->kinds), b->example);
}

static void show_function(int f, FILE *out) {
  const builtin_function_info *b = &builtin_functions[f];
  fprintf(out, "%s (a function)\n\n%s.\n", b->name, b->meaning);
  if (b->least == b->most)
    fprintf(out, "%d argument%s\n", b->least, b->least == 1 ? "" : "s");
  else
    fprintf(out, "%d to %d arguments\n", b->least, b->most);
  fprintf(out, "\n    %s\n", b->example);
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
  return help_page_count + DECLARED + (int)QUANTITY_COUNT + (int)FUNCTION_COUNT + 1;
}

void help_topics(const char **names) {
  int n = 0;
  for (int i = 0; i < help_page_count; i++)
    names[n++] = help_pages[i].name;
  for (int i = 0; i < DECLARED; i++)
    names[n++] = declared[i].name;
  for (int q = 0; q < QUANTITY_COUNT; q++)
    names[n++] = builtin_quantities[q].name;
  for (int f = 0; f < FUNCTION_COUNT; f++)
    names[n++] = builtin_functions[f].name;
  names[n] = "units";
}
