#include "generator/grade/judge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "generator/against/difference_words.h"
#include "generator/grade/curve_text.h"
#include "generator/grade/judge_path.h"
#include "generator/grade/measure.h"
#include "generator/sense/sense.h"
#include "runtime/deck/deck_value.h"

enum { MOST_MESSAGES = 100 };

typedef struct judging {
  const judge_request *q;
  const grade_basis *b;
  arena *memory;
  FILE *out;
  bool reads, obeys;
  declared_names declared;
  path_outcome *outcomes; /* [case_count], of those that were driven */
  cases_seen seen;
  driven_law kept; /* the answer, as paths drive it */
  runs_made runs;
  bool all_right;
  const char *first_error; /* "code: message" of a law that does not read */
} judging;

static void put_mark(const judging *j, int item, double share, int passed, int of, double value) {
  const double numbers[4] = {share, passed, of, value};
  record_write(j->out, RECORD_MARK, item, numbers, NULL);
}

/* --- check ------------------------------------------------------------------------------------ */

/* One message as `perilat check` prints it. */
static void put_message(const judging *j, const diagnostics *said, const diagnostic *one) {
  diagnostics alone = *said;
  diagnostic copy = *one;
  char *text;
  size_t length;
  alone.items = &copy;
  alone.count = 1;
  FILE *to = must_open_text(&text, &length);
  diag_print(&alone, to);
  must_close_text(to);
  while (length > 0 && text[length - 1] == '\n')
    text[--length] = 0;
  const bool error = diag_severity(one->code) == SEVERITY_ERROR;
  record_write(j->out, error ? RECORD_MESSAGE : RECORD_ADVICE, -1, NULL, text);
  free(text);
}

/* Those of one severity, the first hundred. */
static int put_severity(const judging *j, const diagnostics *said, const diagnostic *const *order,
                        bool errors) {
  int count = 0;
  for (int k = 0; k < said->count; k++) {
    if ((diag_severity(order[k]->code) == SEVERITY_ERROR) != errors) continue;
    if (count++ < MOST_MESSAGES) put_message(j, said, order[k]);
  }
  if (count > MOST_MESSAGES)
    record_write(j->out, errors ? RECORD_MESSAGE : RECORD_ADVICE, -1, NULL,
                 arena_printf(j->memory, "and %d more like these", count - MOST_MESSAGES));
  return count;
}

/* They name the law as it was handed in. */
static void put_messages(const judging *j, const diagnostics *said, source_set *sources) {
  const diagnostic **order = diag_sorted(said);
  int holes = 0;
  for (int k = 0; k < said->count; k++)
    holes += said->items[k].code == DIAG_HOLE;
  if (sources->count) {
    free(sources->items[0].name);
    sources->items[0].name = must_copy(j->q->shown);
  }
  const int errors = put_severity(j, said, order, true),
            warnings = put_severity(j, said, order, false);
  const double numbers[4] = {errors, warnings, holes, 0};
  record_write(j->out, RECORD_CHECKED, -1, numbers, NULL);
  free(order);
}

static const char *first_error(arena *a, const diagnostics *said) {
  for (int k = 0; k < said->count; k++)
    if (diag_severity(said->items[k].code) == SEVERITY_ERROR)
      return arena_printf(a, "%s: %s", diag_name(said->items[k].code), said->items[k].message);
  return NULL;
}

static void check(judging *j) {
  model m;
  const bool opened = model_open(&m, j->q->answer, NULL, 0);
  j->reads = opened && model_plan(&m);
  j->obeys = j->reads && law_is_sound(m.law, &(physics_options){.strict = true}, &m.said, NULL);
  j->first_error = j->reads ? NULL : first_error(j->memory, &m.said);
  put_messages(j, &m.said, &m.sources);
  model_close(&m);
  if (j->reads) j->declared = names_declared(j->memory, j->q->answer);
}

static void judge_check(judging *j, int k) {
  const char *of = j->b->of->items[k].of;
  const bool reads = !of || strcmp(of, "reads") == 0, physics = !of || strcmp(of, "physics") == 0;
  const int parts = reads + physics, passed = (reads && j->reads) + (physics && j->obeys);
  put_mark(j, k, (double)passed / parts, passed, parts, NAN);
  j->all_right = j->all_right && passed == parts;
}

/* --- paths ------------------------------------------------------------------------------------ */

/* Those of a public path are no secret. */
static bool shows_curves(const exercise_item *item) {
  return item->show >= SHOW_CURVE || (item->show == SHOW_STATE && !item->hidden);
}

/* "path 2 of 3: ..."; what is said is the item's choice. */
static void put_outcome(const judging *j, int k, const path_case *c, int of,
                        const path_outcome *o) {
  const exercise_item *item = &j->b->of->items[k];
  if (item->show == SHOW_NOTHING) return;
  char *words =
      of > 1 ? arena_printf(j->memory, "path %d of %d: %s", c->number, of, o->words) : o->words;
  record_write(j->out, RECORD_WORDS, k, NULL, words);
  if (item->show >= SHOW_STATE && o->state) record_write(j->out, RECORD_STATE, k, NULL, o->state);
  if (!shows_curves(item) || !c->referenced || !o->table.memory) return;
  char *curve = curve_text(&o->table, &c->right.table);
  record_write(j->out, RECORD_CURVE, k, NULL, curve);
  free(curve);
}

/* The item's paths, from case `first` on. Words are about the first that is wrong. */
static void judge_cases(judging *j, int k, path_case *cases, int count, path_outcome *outcomes) {
  int passed = 0;
  bool said = false;
  for (int c = 0; c < count && j->reads; c++) {
    judge_path(&outcomes[c], j->memory, &cases[c], j->q->answer, &j->declared, &j->kept, &j->seen);
    passed += outcomes[c].right;
    if (outcomes[c].right || said) continue;
    put_outcome(j, k, &cases[c], count, &outcomes[c]);
    said = true;
  }
  const bool all_or_nothing = j->b->of->items[k].kind == ITEM_SAMPLE;
  const double share = count ? (double)passed / count : 0;
  put_mark(j, k, all_or_nothing ? floor(share) : share, passed, count, NAN);
  j->all_right = j->all_right && passed == count;
}

static void judge_paths(judging *j, int k) {
  int first = 0;
  while (first < j->b->case_count && j->b->cases[first].item != &j->b->of->items[k])
    first++;
  judge_cases(j, k, &j->b->cases[first], j->b->of->items[k].found_count, &j->outcomes[first]);
}

static void judge_samples(judging *j, int k) {
  int first = 0, count = 0;
  while (first < j->q->sample_count && j->q->samples[first].item != &j->b->of->items[k])
    first++;
  while (first + count < j->q->sample_count &&
         j->q->samples[first + count].item == &j->b->of->items[k])
    count++;
  path_outcome *outcomes = arena_alloc(j->memory, ((size_t)count + 1) * sizeof *outcomes);
  judge_cases(j, k, &j->q->samples[first], count, outcomes);
  for (int c = 0; c < count; c++)
    if (outcomes[c].table.memory) drive_table_free(&outcomes[c].table);
}

/* --- numbers ---------------------------------------------------------------------------------- */

/* What is expected; NaN after a mark of 0. */
static double expected_value(const judging *j, int k) {
  const exercise_item *item = &j->b->of->items[k];
  deck_quantity quantity;
  source_set sources = {NULL, 0};
  diagnostics unheard;
  if (!item->value) return j->b->measured[k];
  diag_begin(&unheard, &sources);
  const bool good = deck_quantity_read(&item->value->values[0], "value", &quantity, &unheard);
  diag_clear(&unheard);
  return good ? quantity.value : NAN;
}

static bool is_right(const exercise_item *item, double value, double expected) {
  return fabs(value - expected) <= item->tolerance * fabs(expected);
}

typedef void ratio_teller(double ratio, const char *should, FILE *out);

/* What students can judge by themselves tells no formula; of a run nothing holds to the last
   digits. */
static ratio_teller *teller_of(const exercise_item *item) {
  return item_is_public(item)     ? plain_ratio_say
         : item->kind != ITEM_RUN ? exact_ratio_say
                                  : ratio_say;
}

/* "E is 6e+10 Pa, minus twice what it should be"; "E is 0". */
static void say_number(FILE *out, const char *what, double value, const char *unit_text,
                       double expected, ratio_teller *tell) {
  const double ratio = value / expected;
  const char *gap = *unit_text ? " " : "";
  fprintf(out, "%s is ", what);
  if (expected != 0 && fabs(ratio) >= 1e-9) fprintf(out, "%.5g%s%s, ", value, gap, unit_text);
  if (expected != 0)
    tell(ratio, "what it should be", out);
  else
    fprintf(out, "%.5g%s%s, not 0", value, gap, unit_text);
  rounding_say(ratio, out);
}

static char *number_words(judging *j, const exercise_item *item, const char *what, double value,
                          double expected) {
  const char *unit_text = item->kind == ITEM_RUN ? j->runs.unit : implied_unit(item);
  char *text;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  say_number(out, what, value, unit_is_pure(unit_text) ? "" : unit_text, expected, teller_of(item));
  must_close_text(out);
  char *words = arena_text(j->memory, text, length);
  free(text);
  return words;
}

static void put_number(judging *j, int k, double value, double expected, const char *why) {
  const exercise_item *item = &j->b->of->items[k];
  const bool right = is_right(item, value, expected);
  const char *what = item->kind != ITEM_RUN                ? item->quantity
                     : strcmp(item->of, "dissipated") == 0 ? "the dissipated energy"
                                                           : item->monitor;
  put_mark(j, k, right, right, 1, value);
  j->all_right = j->all_right && right;
  if (right || item->show == SHOW_NOTHING || !j->reads) return;
  if (isnan(value))
    record_write(j->out, RECORD_WORDS, k, NULL, why);
  else
    record_write(j->out, RECORD_WORDS, k, NULL, number_words(j, item, what, value, expected));
}

static void judge_implied(judging *j, int k) {
  const exercise_item *item = &j->b->of->items[k];
  const char *why = "", *unheard;
  const double expected = expected_value(j, k);
  double value = j->reads ? measure_implied(j->memory, item, j->q->answer, false, &why) : NAN;
  if (j->reads && !is_right(item, value, expected)) {
    const double other = measure_implied(j->memory, item, j->q->answer, true, &unheard);
    value = is_right(item, other, expected) ? other : value;
  }
  put_number(j, k, value, expected, why);
}

/* The energies must balance. */
static void put_imbalance(judging *j, int k, double value, const char *why) {
  const exercise_item *item = &j->b->of->items[k];
  const bool right = value <= item->tolerance;
  put_mark(j, k, right, right, 1, value);
  j->all_right = j->all_right && right;
  if (right || item->show == SHOW_NOTHING) return;
  record_write(
      j->out, RECORD_WORDS, k, NULL,
      isnan(value)
          ? why
          : arena_printf(j->memory, "the energies of the run miss %.3g of the largest", value));
}

/* As the same law got it. */
static void repeat_run(judging *j, int k, const item_mark *mark) {
  const double numbers[4] = {mark->share, mark->passed, mark->of, mark->value};
  record_write(j->out, RECORD_MARK, k, numbers, NULL);
  j->all_right = j->all_right && mark->share == 1;
  if (mark->words) record_write(j->out, RECORD_WORDS, k, NULL, mark->words);
}

static void judge_run(judging *j, int k) {
  const exercise_item *item = &j->b->of->items[k];
  /* A text without its comments is the same whether or not it reads: `a != b` is no comment. */
  if (j->reads && j->q->like && j->q->like->items[k].judged) {
    repeat_run(j, k, &j->q->like->items[k]);
    return;
  }
  const char *why = "";
  const double value =
      j->reads ? measure_run(j->memory, item, j->q->answer, NULL, 0, &j->runs, &why) : NAN;
  double expected = expected_value(j, k);
  if (j->reads && item->like_count && !isnan(value))
    expected =
        measure_run(j->memory, item, j->q->answer, item->like, item->like_count, &j->runs, &why);
  if (strcmp(item->of, "imbalance") == 0)
    put_imbalance(j, k, value, why);
  else
    put_number(j, k, value, expected, why);
}

/* --- known wrong laws ------------------------------------------------------------------------- */

static bool tables_agree(const drive_table *answer, const reference_law *wrong) {
  const drive_table *w = &wrong->table;
  table_difference d;
  if (answer->of != w->of) return false;
  if ((answer->bad_row >= 0) != (w->bad_row >= 0)) return false;
  table_difference_find(&d, answer, w, 1e-6, wrong->skip, true);
  const bool none = d.kind == DIFFERENCE_NONE;
  table_difference_free(&d);
  return none;
}

static bool answers_like(const judging *j, int wrong) {
  const grade_basis *b = j->b;
  int alike = 0;
  for (int k = 0; k < b->case_count; k++) {
    const reference_law *w = wrong_table(b, k, wrong);
    const bool driven = j->outcomes[k].table.memory != NULL;
    if (!w && !driven) continue;
    if (!w || !driven || !tables_agree(&j->outcomes[k].table, w)) return false;
    alike++;
  }
  return alike > 0;
}

/* One that does not read is known by what is first said of it. */
static bool fails_like(const judging *j, int wrong) {
  model m;
  const bool reads = model_open(&m, j->b->of->wrong[wrong].path, NULL, 0);
  const char *first = reads ? NULL : first_error(j->memory, &m.said);
  model_close(&m);
  return first && j->first_error && strcmp(first, j->first_error) == 0;
}

static void find_known(const judging *j) {
  const exercise *e = j->b->of;
  if (j->all_right || !j->b->declared) return;
  for (int w = 0; w < e->wrong_count; w++) {
    const bool alike = j->reads ? answers_like(j, w) : !j->b->declared[w].count && fails_like(j, w);
    if (!alike) continue;
    record_write(j->out, RECORD_SENTENCE, -1, (const double[4]){w, 0, 0, 0}, e->wrong[w].sentence);
    return;
  }
}

/* --- cases ------------------------------------------------------------------------------------ */

/* What of the law no path has tried. */
static void put_cases(const judging *j) {
  model m;
  int reached = 0, last = 0;
  const bool reads = model_open(&m, j->q->answer, NULL, 0);
  for (int k = 0; k < j->seen.count && reads; k++) {
    const case_seen *one = &j->seen.items[k];
    const bool known = one->where.end > 0 && one->where.file == 0;
    const int line = known ? source_line_number(&m.sources, 0, one->where.begin) : 0;
    reached += one->was_true && one->was_false;
    if ((one->was_true && one->was_false) || line == last) continue;
    last = line;
    record_write(j->out, RECORD_NOTE, -1, NULL,
                 line ? arena_printf(j->memory, "a case of line %d is never reached", line)
                      : "a case of the law is never reached");
  }
  model_close(&m);
  record_write(j->out, RECORD_CASES, -1, (const double[4]){j->seen.count, reached, 0, 0}, NULL);
}

/* --- the whole -------------------------------------------------------------------------------- */

static void judge_item(judging *j, int k) {
  const exercise_item *item = &j->b->of->items[k];
  if (!item_is_judged(item, j->q->only_public)) return;
  switch ((item_kind)item->kind) {
  case ITEM_CHECK:
    judge_check(j, k);
    return;
  case ITEM_PATH:
    judge_paths(j, k);
    return;
  case ITEM_SAMPLE:
    judge_samples(j, k);
    return;
  case ITEM_IMPLIED:
    judge_implied(j, k);
    return;
  case ITEM_RUN:
    judge_run(j, k);
    return;
  default:
    return;
  }
}

static bool takes_long(const exercise_item *item) {
  return item->kind == ITEM_RUN;
}

void judge_answer(const judge_request *q, FILE *out) {
  const grade_basis *b = q->basis;
  judging j = {.q = q, .b = b, .memory = arena_new(), .out = out, .all_right = true};
  j.outcomes = arena_alloc(j.memory, ((size_t)b->case_count + 1) * sizeof *j.outcomes);
  check(&j);
  for (int late = 0; late < 2; late++) {
    for (int k = 0; k < b->of->item_count; k++)
      if (takes_long(&b->of->items[k]) == late) judge_item(&j, k);
    if (!late) find_known(&j);
  }
  if (j.reads) put_cases(&j);
  record_write(out, RECORD_END, -1, NULL, NULL);
  for (int k = 0; k < b->case_count; k++)
    if (j.outcomes[k].table.memory) drive_table_free(&j.outcomes[k].table);
  driven_law_close(&j.kept);
  free(j.seen.items);
  arena_free(j.memory);
}
