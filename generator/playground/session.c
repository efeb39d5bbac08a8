#include "generator/playground/session.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/diagnostics.h"
#include "dsl/print/mathml.h"
#include "dsl/semantics/builtins.h"
#include "dsl/syntax/words.h"
#include "generator/command/commands.h"
#include "generator/kernel/document.h"

static const struct {
  const char *name;
  int (*run)(int argc, char **argv);
} commands[] = {{"check", command_check},   {"drive", command_drive}, {"explain", command_explain},
                {"format", command_format}, {"grade", command_grade}, {"help", command_help}};

enum { MOST_ARGUMENTS = 64 };

/* Cuts the text at its line ends. */
static int split(char *text, char *parts[MOST_ARGUMENTS]) {
  int count = 0;
  for (char *at = text; at && count < MOST_ARGUMENTS;) {
    parts[count++] = at;
    at = strchr(at, '\n');
    if (at) *at++ = 0;
  }
  return count;
}

int play_command(const char *line) {
  char *text = must_copy(line), *parts[MOST_ARGUMENTS];
  const int count = split(text, parts);
  int status = 1;
  for (size_t k = 0; k < sizeof commands / sizeof *commands; k++)
    if (strcmp(parts[0], commands[k].name) == 0) status = commands[k].run(count - 1, parts + 1);
  diag_print_topics(stderr);
  fflush(NULL);
  free(text);
  return status;
}

const char *play_formula(const char *latex) {
  static char *text;
  size_t length;
  free(text);
  FILE *out = must_open_text(&text, &length);
  mathml_put(latex, strlen(latex), true, out);
  must_close_text(out);
  return text;
}

const char *play_words(void) {
  static char *text;
  size_t length;
  free(text);
  FILE *out = must_open_text(&text, &length);
#define X(token, word) " " word
  fputs("statement" LINE_WORDS(X) "\nreserved" RESERVED_WORDS(X) "\nquantity", out);
#undef X
  for (int k = 0; k < QUANTITY_COUNT; k++)
    fprintf(out, " %s", builtin_quantities[k].name);
  fputs("\nfunction", out);
  for (int k = 0; k < FUNCTION_COUNT; k++)
    fprintf(out, " %s", builtin_functions[k].name);
  fputc('\n', out);
  must_close_text(out);
  return text;
}
