#include "generator/grade/judge_path.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "generator/against/difference_words.h"
#include "generator/drive/drive_expect.h"

static const char should[] = "what it should be";

/* Takes over a text that was written with must_open_text. */
static char *kept(arena *a, char *text, size_t length) {
  while (length > 0 && text[length - 1] == '\n')
    length--;
  char *copy = arena_text(a, text, length);
  free(text);
  return copy;
}

/* --- driving ---------------------------------------------------------------------------------- */

/* Found in the folder that the process works in, whatever the path's own is. */
static drive_input *input_here(arena *a, const path_case *c, const drive_input *from,
                               const char *answer, const declared_names *declared,
                               const char **missing) {
  drive_input *in = input_suited(a, c, from, declared, missing);
  in->path = "path.nml";
  in->material.model = answer;
  return in;
}

/* What is wrong with path and law together; the path's own text is not shown. */
static char *unsuited_words(arena *a, const diagnostics *said) {
  for (int k = 0; k < said->count; k++)
    if (diag_severity(said->items[k].code) == SEVERITY_ERROR)
      return arena_printf(a, "your law does not suit the exercise: %s", said->items[k].message);
  return arena_printf(a, "your law can not be driven along this path");
}

static bool march(path_outcome *out, const driven_law *of, cases_seen *seen) {
  drive_band band;
  case_witness *w = seen ? case_witness_begin(of->law) : NULL;
  const bool good = driven_law_march(of, &out->table, &band);
  if (w) case_witness_end(w, seen);
  return good;
}

/* False after words. */
static bool drive_along(path_outcome *out, arena *a, driven_law *of, driven_law *kept,
                        const drive_input *in, cases_seen *seen, diagnostics *said) {
  const driven_outcome outcome = driven_law_open_kept(of, kept, a, in, said);
  if (outcome == DRIVEN_BAD_LAW && of->opened && of->model.said.errors > 0)
    out->words = arena_printf(a, "your law has errors");
  else if (outcome != DRIVEN_READY || !march(out, of, seen))
    out->words = unsuited_words(a, said);
  return !out->words;
}

/* --- against the solution --------------------------------------------------------------------- */

static void say_difference(path_outcome *out, arena *a, const table_difference *d,
                           const drive_table *reference) {
  static const char *const names[] = {"yours", "right"};
  char *text;
  size_t length;
  FILE *to = must_open_text(&text, &length);
  difference_say(d, &out->table, should, to);
  must_close_text(to);
  out->words = kept(a, text, length);
  to = must_open_text(&text, &length);
  difference_rows(d, reference, names, "", to);
  must_close_text(to);
  out->state = length ? kept(a, text, length) : NULL;
  if (!length) free(text);
}

/* As far as numbers agree that somebody has rounded. */
static bool agrees(const path_case *c, const drive_table *t, const reference_law *right) {
  const double rounded = 2e-3;
  table_difference d;
  if (t->of != right->table.of) return false;
  table_difference_find(&d, t, &right->table, pl_fmax(rounded, c->item->tolerance), right->skip,
                        c->item->energies);
  const bool none = d.kind == DIFFERENCE_NONE;
  table_difference_free(&d);
  return none;
}

/* Right with the values that are at hand, wrong with others: numbers stand where names should. */
static bool only_at_hand(const path_outcome *out, arena *a, const path_case *c, const char *answer,
                         const declared_names *declared, driven_law *kept, diagnostics *said) {
  const char *missing;
  path_outcome plain = {.words = NULL};
  driven_law of;
  if (!c->plain || agrees(c, &out->table, &c->right)) return false;
  const drive_input *in = input_here(a, c, c->plain, answer, declared, &missing);
  const bool good =
      drive_along(&plain, a, &of, kept, in, NULL, said) && agrees(c, &plain.table, &c->right_plain);
  driven_law_close(&of);
  if (plain.table.memory) drive_table_free(&plain.table);
  return good;
}

static void compare(path_outcome *out, arena *a, const path_case *c) {
  table_difference d;
  if (out->table.of != c->right.table.of) {
    out->words = arena_printf(a, "your law is a law of something else than the exercise asks for");
    return;
  }
  table_difference_find(&d, &out->table, &c->right.table, c->item->tolerance, c->right.skip,
                        c->item->energies);
  out->right = d.kind == DIFFERENCE_NONE;
  if (!out->right) say_difference(out, a, &d, &c->right.table);
  table_difference_free(&d);
}

/* --- against what the path expects ------------------------------------------------------------ */

/* Where it says more than the numbers do. Students have the path, and are to find the formula. */
static void say_known_ratio(double ratio, bool alike, FILE *out) {
  const bool rounding = alike && ratio_is_rounding(ratio),
             known = rounding || ratio_words(fabs(ratio)) || (alike && ratio_is_known(fabs(ratio)));
  if (!known || !isfinite(ratio) || fabs(ratio) < 1e-9) return;
  fputs(rounding ? ", " : ": ", out);
  plain_ratio_say(ratio, should, out);
  rounding_say(ratio, out);
}

/* All that fail do so by one factor: then that says something, however odd it is. */
static bool fail_alike(const drive_input *in, const drive_verdict *verdicts) {
  double low = INFINITY, high = -INFINITY;
  for (int k = 0; k < in->expect_count; k++) {
    if (verdicts[k].passed) continue;
    const double ratio = verdicts[k].found / verdicts[k].expected;
    if (!isfinite(ratio)) return false;
    low = pl_fmin(low, ratio);
    high = pl_fmax(high, ratio);
  }
  return high - low <= 2e-3 * fabs(high);
}

static void say_failures(path_outcome *out, arena *a, const drive_input *in,
                         const drive_verdict *verdicts) {
  char *text;
  size_t length;
  const bool alike = fail_alike(in, verdicts);
  FILE *to = must_open_text(&text, &length);
  for (int k = 0; k < in->expect_count; k++) {
    const drive_verdict *v = &verdicts[k];
    const char *unit_text = unit_is_pure(v->unit) ? "" : v->unit;
    if (v->passed) continue;
    fprintf(to, "%s is %.6g, expected %.6g%s%s (at %.6g s)", in->expects[k].quantity,
            v->found + 0.0, v->expected + 0.0, *unit_text ? " " : "", unit_text, v->time);
    say_known_ratio(v->found / v->expected, alike, to);
    fputc('\n', to);
  }
  must_close_text(to);
  out->words = kept(a, text, length);
}

static void meet(path_outcome *out, arena *a, const driven_law *of, const drive_input *in,
                 diagnostics *said) {
  drive_table columns;
  driven_law_columns(of, &columns);
  drive_expectations *x = drive_expectations_read(in, &of->model, &columns, said);
  if (x && out->table.bad_row < 0) {
    drive_verdict *verdicts = arena_alloc(a, ((size_t)in->expect_count + 1) * sizeof *verdicts);
    drive_judge(x, of->parameters, &out->table, verdicts);
    out->right = true;
    for (int k = 0; k < in->expect_count; k++)
      out->right = out->right && verdicts[k].passed;
    if (!out->right) say_failures(out, a, in, verdicts);
  } else {
    out->words = x ? arena_printf(a, "your law gives something that is not a number")
                   : unsuited_words(a, said);
  }
  if (x) drive_expectations_free(x);
  drive_table_free(&columns);
}

/* --- the whole -------------------------------------------------------------------------------- */

void judge_path(path_outcome *out, arena *a, const path_case *c, const char *answer,
                const declared_names *declared, driven_law *kept, cases_seen *seen) {
  const char *missing;
  source_set sources = {NULL, 0};
  diagnostics said;
  driven_law of = {.in = NULL};
  *out = (path_outcome){.right = false};
  diag_begin(&said, &sources);
  const drive_input *in = input_here(a, c, c->in, answer, declared, &missing);
  const bool expects = c->item->kind == ITEM_PATH && c->item->against == AGAINST_EXPECTATIONS;
  if (missing) {
    out->words = arena_printf(
        a, "your law has no parameter `%s`, which the exercise sets: keep those of the starter",
        missing);
  } else if (drive_along(out, a, &of, kept, in, seen, &said)) {
    if (expects)
      meet(out, a, &of, in, &said);
    else
      compare(out, a, c);
    if (!out->right && !expects && only_at_hand(out, a, c, answer, declared, kept, &said))
      out->words = arena_printf(a,
                                "right with the values of the starter, wrong with others (%s): "
                                "did you write numbers for them?\n%s",
                                c->varied, out->words);
  }
  driven_law_close(&of);
  diag_clear(&said);
  source_clear(&sources);
}
