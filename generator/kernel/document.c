#include "generator/kernel/document.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "dsl/base/terminal.h"
#include "generator/kernel/version.h"

enum { CANNOT_WRITE = 2, LONGEST = 8192 };

static char first_error[LONGEST];

void keep_error(const char *sentence) {
  if (!*first_error) snprintf(first_error, strcspn(sentence, "\n") + 1, "%s", sentence);
}

void say_error(const char *format, ...) {
  char sentence[LONGEST];
  va_list values;
  va_start(values, format);
  vsnprintf(sentence, sizeof sentence, format, values);
  va_end(values);
  keep_error(sentence);
  fprintf(stderr, "perilat: error: %s\n", sentence);
}

void document_begin(document *d) {
  *d = (document){.text = NULL};
  *first_error = 0;
  fflush(stdout);
  d->standard_output = dup(STDOUT_FILENO);
  if (d->standard_output >= 0) dup2(STDERR_FILENO, STDOUT_FILENO);
  d->memory = must_open_text(&d->text, &d->length);
  json_document(&d->writer, d->memory, perilat_version);
}

static bool write_out(document *d) {
  must_close_text(d->memory);
  if (d->standard_output < 0) return false;
  fflush(stdout);
  clearerr(stdout); /* what was said for people may be lost */
  const bool back = dup2(d->standard_output, STDOUT_FILENO) >= 0;
  close(d->standard_output);
  terminal_expect_data();
  return back && fwrite(d->text, 1, d->length, stdout) == d->length && fflush(stdout) == 0;
}

int document_end(document *d, int status) {
  json_put_text(&d->writer, d->error_key ? d->error_key : "error",
                *first_error ? first_error : NULL);
  json_document_end(&d->writer);
  const bool good = write_out(d);
  free(d->text);
  return good ? status : CANNOT_WRITE;
}

int end_output(int status) {
  if (fflush(stdout) == 0 && !ferror(stdout)) return status;
  say_error("cannot write to the standard output: %s", strerror(errno));
  return status ? status : CANNOT_WRITE;
}
