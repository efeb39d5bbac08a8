/* perilat compare: two results (compare_results.h), or a result and a table (compare_curve.h). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/command/commands.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/results/compare_curve.h"
#include "generator/results/compare_results.h"
#include "runtime/base/text_table.h"

enum { SAME = 0, WRONG = 1 }; /* as the comparisons have it; 2: different */
static const char program[] = "perilat compare";

typedef struct compare_request {
  bool json;
  int result_count;
  results_request of;
  const char *x, *y, *band;          /* of a curve beside a table */
  const char *of_curve, *of_results; /* an option that only these know, when one was given */
} compare_request;

/* --- the command ------------------------------------------------------------------------------ */

static bool read_tolerance(const char *text, double *tolerance) {
  char *end;
  *tolerance = strtod(text, &end);
  if (!*end && end != text && *tolerance >= 0 && isfinite(*tolerance)) return true;
  say_error("--tolerance needs a number that is not negative, not `%s`", text);
  return false;
}

/* One option or file. */
static int read_one(int argc, char **argv, int *at, compare_request *q) {
  int bad = 0;
  const char *v;
  if ((v = option_value(argc, argv, at, "--tolerance", &bad)))
    bad = bad || !read_tolerance(v, &q->of.tolerance);
  else if ((v = option_value(argc, argv, at, "--history", &bad)))
    q->of.histories[q->of.history_count++] = q->of_results = v;
  else if ((v = option_value(argc, argv, at, "--field", &bad)))
    q->of.fields[q->of.field_count++] = q->of_results = v;
  else if ((v = option_value(argc, argv, at, "--x", &bad)))
    q->x = q->of_curve = v;
  else if ((v = option_value(argc, argv, at, "--y", &bad)))
    q->y = q->of_curve = v;
  else if ((v = option_value(argc, argv, at, "--band", &bad)))
    q->band = q->of_curve = v;
  else if (option_flag(argv, at, "--json"))
    q->json = true;
  else if (argv[*at][0] == '-')
    bad = option_unknown("compare", argv[*at]);
  else if (q->result_count == 2) {
    say_error("`%s` takes two files; `%s` is a third one", program, argv[*at]);
    bad = 1;
  } else
    q->of.results[q->result_count++] = argv[(*at)++];
  return bad;
}

static bool read_request(int argc, char **argv, compare_request *q) {
  for (int at = 0; at < argc;)
    if (read_one(argc, argv, &at, q)) return false;
  if (q->result_count == 2) return true;
  say_error("`perilat compare` needs two results, or a result and a table\n  perilat compare a.h5 "
            "b.h5 --tolerance 1e-6\n  perilat compare a.h5 lab.csv --x cmod --y load");
  return false;
}

/* By its ending, or because columns of it are named. */
static bool is_table(const char *given) {
  const char *columns;
  char *path = text_table_split(given, &columns);
  const bool table = columns || kind_of_file(path) == FILE_TABLE;
  free(path);
  return table;
}

static int compare_with_table(const compare_request *q, json *w) {
  const curve_request curve = {q->of.results[0], q->of.results[1], q->x, q->y,
                               q->band,          q->of.tolerance};
  if (!file_suits(q->of.results[0], FILES(RESULT), program, "a result first, then a table"))
    return WRONG;
  if (!q->of_results) return compare_curve(&curve, w);
  say_error("--history and --field compare two results; with a table --x and --y name the curve");
  return WRONG;
}

/* As text, or into the document. */
static int compare_files(const compare_request *q, json *w) {
  if (is_table(q->of.results[1]) || is_table(q->of.results[0])) return compare_with_table(q, w);
  if (!q->of_curve) return compare_results(&q->of, w);
  if (kind_of_file(q->of.results[1]) != FILE_RESULT) return compare_with_table(q, w);
  say_error("--x, --y and --band are for a result and a table");
  return WRONG;
}

static int compare_to_json(const compare_request *q) {
  document d;
  document_begin(&d);
  json_put_array(&d.writer, "results");
  for (int k = 0; k < 2; k++)
    json_text(&d.writer, q->of.results[k]);
  json_array_end(&d.writer);
  json_put_number(&d.writer, "tolerance", q->of.tolerance);
  json_put_array(&d.writer, "quantities");
  const int status = compare_files(q, &d.writer);
  json_array_end(&d.writer);
  json_put_bool(&d.writer, "same", status == SAME);
  return document_end(&d, status);
}

static int compare_as_asked(const compare_request *q) {
  return q->json ? compare_to_json(q) : compare_files(q, NULL);
}

int command_compare(int argc, char **argv) {
  compare_request q = {.json = false};
  q.of.histories = must_calloc((size_t)argc + 1, sizeof *q.of.histories);
  q.of.fields = must_calloc((size_t)argc + 1, sizeof *q.of.fields);
  const int status = read_request(argc, argv, &q) ? compare_as_asked(&q) : WRONG;
  free(q.of.histories);
  free(q.of.fields);
  return status;
}
