#include "generator/report/resuming.h"

#include <stdlib.h>
#include <string.h>

#include "runtime/result/checkpoint.h"

/* As a word of a shell. */
static void print_word(const char *word, FILE *out) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                              "_./:=,+-";
  if (*word && strspn(word, plain) == strlen(word)) {
    fputs(word, out);
    return;
  }
  fputc('\'', out);
  for (; *word; word++)
    fputs(*word == '\'' ? "'\\''" : (char[]){*word, 0}, out);
  fputc('\'', out);
}

void print_resume(const run *r, FILE *out) {
  const run_options *o = r->options;
  if (o->deck_text)
    fputs("  ", out);
  else
    fprintf(out, "  %s ", o->program);
  print_word(o->deck_text ? o->program : o->deck_path, out);
  for (int k = 0; k < o->override_count; k++) {
    fputs(" --set ", out);
    print_word(o->overrides[k].text, out);
  }
  fputs(o->interpret ? " --interpret --resume\n" : " --resume\n", out);
}

/* One line, cut to what is near the byte at which two lines begin to differ. */
static void print_near(const char *title, const char *line, size_t differs) {
  enum { BEFORE = 50, WIDTH = 120 };
  size_t length = strcspn(line, "\n"), from = differs > BEFORE ? differs - BEFORE : 0;
  size_t shown = length - from < WIDTH ? length - from : WIDTH;
  fprintf(stderr, "    %s %s%.*s%s\n", title, from ? "..." : "", (int)shown, line + from,
          from + shown < length ? "..."
          : length              ? ""
                                : "nothing more");
}

void print_misfit(const run *r) {
  char *stopped = checkpoint_fingerprint(r->checkpoint_path);
  if (!stopped || strcmp(stopped, r->fingerprint) == 0) {
    free(stopped);
    return;
  }
  size_t line = 0, at = 0;
  for (; stopped[at] == r->fingerprint[at]; at++)
    if (stopped[at] == '\n') line = at + 1;
  fputs("  they differ first here:\n", stderr);
  print_near("stopped run:", stopped + line, at - line);
  print_near("this run:   ", r->fingerprint + line, at - line);
  fputs("  a run goes on with the deck and the --set options that it began with\n", stderr);
  free(stopped);
}
