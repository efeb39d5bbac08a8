#include "generator/command/manual.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "generator/command/commands.h"
#include "generator/kernel/document.h"
#include "generator/kernel/version.h"

enum { WRITE_FAILED = 2 };

/* X(variable, meaning) */
#define VARIABLES(X)                                                                               \
  X("PERILAT_MODELS",                                                                              \
    "a folder in which laws are looked for by name, before those that were installed")             \
  X("PERILAT_CC", "the C compiler of kernels, with options if needed; otherwise CC, or the first " \
                  "of cc, gcc, clang")                                                             \
  X("PERILAT_PROCESSOR", "what kernels are compiled for: x86-64, x86-64-v2, x86-64-v3 (AVX2), "    \
                         "x86-64-v4 (AVX-512); otherwise this processor")                          \
  X("PERILAT_CACHE",                                                                               \
    "the folder of compiled kernels; otherwise perilat in XDG_CACHE_HOME or in ~/.cache")

/* Text as it is meant to be read: no character of it is taken for a request or a typographer's
   dash or quote. */
static void put_text(FILE *out, const char *text) {
  if (*text == '.' || *text == '\'') fputs("\\&", out);
  for (; *text; text++) {
    static const char marks[] = "\\-'`";
    static const char *const written[] = {"\\e", "\\-", "\\(aq", "\\(ga"};
    const char *mark = strchr(marks, *text);
    if (mark)
      fputs(written[mark - marks], out);
    else
      fputc(*text, out);
  }
}

/* One entry of a list: a bold term, a value in italics or "", what it means. */
static void put_entry(FILE *out, const char *term, const char *value, const char *meaning) {
  fputs(".TP\n\\fB", out);
  put_text(out, term);
  fputs("\\fR", out);
  if (*value) {
    fputs(" \\fI", out);
    put_text(out, value);
    fputs("\\fR", out);
  }
  fputc('\n', out);
  put_text(out, meaning);
  fputc('\n', out);
}

static void put_head(FILE *out, const char *title, const char *name, const char *purpose) {
  fprintf(out, ".TH %s 1 \"\" \"perilat %s\" \"perilat\"\n.SH NAME\n", title, perilat_version);
  put_text(out, name);
  fputs(" \\- ", out);
  put_text(out, purpose);
  fputs("\n.SH SYNOPSIS\n", out);
}

static void write_main_page(FILE *out) {
  put_head(out, "PERILAT", "perilat", "compiler and simulator for particle-lattice material laws");
  fputs(".B perilat\n.I COMMAND\n[options] files\n.SH DESCRIPTION\n", out);
  put_text(out, "A law, in a text file .plm, gives the force in the bond between two particles of "
                "a lattice. A deck, in a "
                "namelist file .nml, gives lattice, loads and outputs. perilat checks both, "
                "compiles the law to a C "
                "kernel and runs the deck; results are HDF5 files.");
  fputs("\n.PP\n", out);
  put_text(out, "perilat new NAME writes a law, a path of one bond and a deck to start from. "
                "perilat help TOPIC explains "
                "words, messages and groups.");
  fputs("\n.SH COMMANDS\n", out);
  for (int k = 0; k < command_count; k++)
    put_entry(out, command_table[k].name, command_table[k].files, command_table[k].purpose);
  fputs(".SH ENVIRONMENT\n", out);
#define X(variable, meaning) put_entry(out, variable, "", meaning);
  VARIABLES(X)
#undef X
  fputs(".SH EXIT STATUS\n", out);
  put_text(out, COMMAND_STATUS);
  fputs(".\n.SH SEE ALSO\n", out);
  for (int k = 0; k < command_count; k++)
    fprintf(out, ".BR perilat\\-%s (1)%s\n", command_table[k].name,
            k + 1 < command_count ? "," : "");
}

static void write_command_page(FILE *out, int k) {
  const command_entry *c = &command_table[k];
  char name[64];
  snprintf(name, sizeof name, "perilat-%s", c->name);
  put_head(out, name, name, c->purpose);
  fprintf(out, ".B perilat %s\n%s", c->name, command_has_options(c->name) ? "[options]\n" : "");
  put_text(out, c->files);
  fputc('\n', out);
  if (command_has_options(c->name)) fputs(".SH OPTIONS\n", out);
  for (int o = 0; o < option_count; o++)
    if (strcmp(option_table[o].command, c->name) == 0)
      put_entry(out, option_table[o].name, option_table[o].value, option_table[o].meaning);
  fputs(".SH EXIT STATUS\n", out);
  put_text(out, c->status);
  fputs(".\n.SH SEE ALSO\n.BR perilat (1)\n", out);
}

/* 0, or an exit status after a message. */
static int end_file(FILE *out, const char *path) {
  bool good = out && !ferror(out);
  if (out) good = fclose(out) == 0 && good;
  if (!good) say_error("cannot write `%s`: %s", path, strerror(errno));
  return good ? 0 : WRITE_FAILED;
}

int manual_write(const char *folder) {
  char path[4096];
  snprintf(path, sizeof path, "%s/perilat.1", folder);
  FILE *out = fopen(path, "w");
  if (out) write_main_page(out);
  int status = end_file(out, path);
  for (int k = 0; k < command_count && !status; k++) {
    snprintf(path, sizeof path, "%s/perilat-%s.1", folder, command_table[k].name);
    out = fopen(path, "w");
    if (out) write_command_page(out, k);
    status = end_file(out, path);
  }
  return status;
}
