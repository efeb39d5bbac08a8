/* perilat report: a run, two runs or a study as one page of HTML. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "dsl/base/arena.h"
#include "dsl/base/characters.h"
#include "generator/command/commands.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/page/page.h"
#include "generator/page/page_study.h"
#include "generator/page/shell.h"
#include "generator/study/study_read.h"

static const char program[] = "perilat report";

typedef struct report_request {
  const char *results[2], *output;
  int count;
} report_request;

static bool read_request(int argc, char **argv, report_request *q) {
  int bad = 0;
  const char *v;
  for (int at = 0; at < argc && !bad;) {
    if ((v = option_value(argc, argv, &at, "-o", &bad)))
      q->output = v;
    else if (is_option_like(argv[at]))
      bad = option_unknown("report", argv[at]);
    else if (q->count == 2) {
      say_error("`%s` takes one result, two results or a study; `%s` is one more", program,
                argv[at]);
      bad = 1;
    } else
      q->results[q->count++] = argv[at++];
  }
  if (!bad && q->count == 0)
    say_error("`%s` needs a result file\n  perilat report result.h5 -o report.html", program);
  return !bad && q->count > 0;
}

/* RESULT.html for RESULT.h5, in the working folder. malloc'ed. */
static char *usual_output(const char *result) {
  const char *slash = strrchr(result, '/'), *name = slash ? slash + 1 : result,
             *dot = strrchr(name, '.');
  const size_t length = dot ? (size_t)(dot - name) : strlen(name);
  char *path = must_calloc(length + sizeof ".html", 1);
  memcpy(path, name, length);
  strcpy(path + length, ".html");
  return path;
}

static bool spares_inputs(const report_request *q, const char *output) {
  for (int k = 0; k < q->count; k++)
    if (same_file(output, q->results[k])) {
      say_error("the page would overwrite `%s`; give it another name with -o", q->results[k]);
      return false;
    }
  return true;
}

/* The table of a study whose folder of results is given, NAME.h5 beside NAME/; malloc'ed. NULL: it
   is no folder. */
static char *table_beside(const char *path) {
  struct stat about;
  if (stat(path, &about) != 0 || !S_ISDIR(about.st_mode)) return NULL;
  size_t length = strlen(path);
  while (length > 1 && path[length - 1] == '/')
    length--;
  char *table = must_calloc(length + sizeof ".h5", 1);
  memcpy(table, path, length);
  strcpy(table + length, ".h5");
  return table;
}

/* 0, or an exit status. */
static int put_page(const report_request *q, FILE *out) {
  if (q->count == 1 && study_is_table(q->results[0])) return page_of_study(out, q->results[0]);
  for (int k = 0; k < q->count; k++)
    if (study_is_table(q->results[k])) {
      say_error("`%s` is the table of a study, which is shown alone", q->results[k]);
      return 1;
    }
  return page_of_results(out, program, q->results, q->count);
}

/* The page is made whole before anything is written. */
static int write_report(const report_request *q, const char *output) {
  char *text = NULL, error[5000];
  size_t length = 0;
  if (!spares_inputs(q, output)) return 1;
  FILE *out = must_open_text(&text, &length);
  int status = put_page(q, out);
  must_close_text(out);
  if (status == 0 && !shell_write(output, text, length, error, sizeof error)) {
    say_error("%s", error);
    status = 2;
  } else if (status == 0)
    printf("written %s (%.1f kB)\n", output, (double)length / 1e3);
  free(text);
  return status;
}

int command_report(int argc, char **argv) {
  report_request q = {.count = 0};
  if (!read_request(argc, argv, &q)) return 1;
  char *table = table_beside(q.results[0]);
  if (table) q.results[0] = table;
  char *usual = usual_output(q.results[0]);
  const int status = write_report(&q, q.output ? q.output : usual);
  free(usual);
  free(table);
  return status;
}
