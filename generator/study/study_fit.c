#include "generator/study/study_fit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/base/units.h"
#include "generator/fit/fit_curve.h"
#include "generator/fit/fit_descent.h"
#include "generator/fit/fit_uncertainty.h"
#include "generator/kernel/document.h"
#include "generator/results/measured.h"
#include "generator/run/run.h"
#include "generator/study/study_deck.h"
#include "generator/study/study_publish.h"

static const double accuracy = 1e-4; /* of a parameter, over the width of its bounds */

typedef struct target { /* a deck, and the curve that it is to follow */
  const char *deck;
  study_text table;
  measured lab;
  fit_curve curve;
  bool read;
} target;

typedef struct fit {
  study_request *request;
  study_pool *pool;
  fit_parameter parameters[FIT_MOST]; /* in the unit of their bounds */
  const char *keys[FIT_MOST], *units[FIT_MOST];
  int count;
  target *targets; /* [decks] */
  int decks;
  study_case *cases; /* all that were asked for, deck by deck of a point */
  double *squares;   /* [case_count] of its curve */
  int case_count;
  int without; /* runs that gave no curve, since it was set to 0 */
  int stopped; /* as study_pool_run says */
} fit;

/* --- parameters ------------------------------------------------------------------------------- */

/* A number of the deck, in the unit of the bounds. */
static bool convert(const char *text, const char *wanted, double *value) {
  const char *own, *bad;
  size_t length;
  unit from = {.factor = 1}, to = {.factor = 1};
  if (!study_split_number(text, value, &own)) return false;
  if (*own && !unit_parse(own, strlen(own), &from, &bad, &length)) return false;
  if (*wanted && !unit_parse(wanted, strlen(wanted), &to, &bad, &length)) return false;
  if (*own && *wanted && !dim_equal(from.dim, to.dim)) return false; /* without one it is in SI */
  *value *= from.factor / to.factor;
  return true;
}

static bool refuse_bounds(study_request *r, const study_text *given, const char *sentence) {
  diag_report(&r->said, DIAG_BAD_VALUE, given->where, "%s", sentence);
  diag_hint(&r->said, "bounds stand in one unit, e.g. %s",
            study_written(r, "fit", "material.E=20..40 GPa"));
  return false;
}

static bool read_bounds(fit *f, const study_text *given, const study_range *range) {
  study_request *r = f->request;
  fit_parameter *p = &f->parameters[f->count];
  const char *low_unit, *high_unit;
  if (!range->low || !range->high || range->step)
    return refuse_bounds(r, given, "a parameter that is fitted has a lower and an upper bound");
  study_split_number(range->low, &p->lower, &low_unit);
  study_split_number(range->high, &p->upper, &high_unit);
  if (strcmp(low_unit, high_unit) != 0)
    return refuse_bounds(r, given, "the bounds have different units");
  if (!(p->lower < p->upper))
    return refuse_bounds(r, given, "the lower bound is not below the upper one");
  for (int k = 0; k < f->count; k++)
    if (study_same_key(f->keys[k], range->key.name))
      return refuse_bounds(r, given, "this parameter is there twice");
  f->units[f->count] = high_unit;
  f->keys[f->count] = range->key.name;
  return true;
}

/* How the middle of its bounds is set. */
static const char *middle_set(const fit *f) {
  study_request *r = f->request;
  const fit_parameter *p = &f->parameters[f->count];
  const char *middle = study_value_text(r->memory, (p->lower + p->upper) / 2, f->units[f->count]);
  return study_written(r, "set", arena_printf(r->memory, "%s=%s", f->keys[f->count], middle));
}

/* The search begins at what the first deck has. */
static bool read_start(fit *f, const study_text *given, const study_deck *deck_text) {
  study_request *r = f->request;
  fit_parameter *p = &f->parameters[f->count];
  bool good = true;
  const char *key = f->keys[f->count], *text = study_deck_value(deck_text, r, key, &good);
  if (!good) return false;
  if (!text || !convert(text, f->units[f->count], &p->start)) {
    diag_report(&r->said, DIAG_BAD_VALUE, given->where, "the deck gives no number for `%s`%s", key,
                text ? " in the unit of its bounds" : "");
    diag_hint(&r->said, "the search begins there: %s", middle_set(f));
    return false;
  }
  if (p->start >= p->lower && p->start <= p->upper) return true;
  diag_report(&r->said, DIAG_OUT_OF_BOUNDS, given->where,
              "the bounds leave out the deck's own `%s` = %s, where the search begins", key, text);
  diag_hint(&r->said, "widen them, or begin elsewhere: %s", middle_set(f));
  return false;
}

static bool read_parameters(fit *f) {
  study_request *r = f->request;
  study_deck deck_text;
  bool good = study_deck_open(&deck_text, r, &r->decks.items[0]);
  for (int k = 0; k < r->fit.count && good; k++, f->count++) {
    const study_text *given = &r->fit.items[k];
    study_range range;
    if (k == FIT_MOST) return refuse_bounds(r, given, "these are too many parameters");
    good = study_range_read(r->memory, given, &range, &r->said) && read_bounds(f, given, &range) &&
           read_start(f, given, &deck_text);
    f->parameters[k].name = f->keys[k];
  }
  study_deck_close(&deck_text);
  return good;
}

/* --- curves ----------------------------------------------------------------------------------- */

/* "lab.csv:cmod,low,high" is a band over cmod. */
static const char *split_band(arena *a, const char *given, const char **band) {
  const char *columns;
  char *path = text_table_split(given, &columns);
  const char *first = columns ? strchr(columns, ',') : NULL,
             *second = first ? strchr(first + 1, ',') : NULL;
  free(path);
  *band = second ? first + 1 : NULL;
  return second ? arena_text(a, given, (size_t)(first - given)) : given;
}

/* With the units of the histories, which a first run has told. False after messages. */
static bool read_target(fit *f, int k, const study_row *row) {
  study_request *r = f->request;
  target *t = &f->targets[k];
  const char *band, *given = split_band(r->memory, t->table.text, &band);
  const measured_axes axes = {.x = row->x_name,
                              .ys = &row->y_name,
                              .y_count = 1,
                              .x_unit = row->x_unit,
                              .y_unit = row->y_unit};
  t->read = true;
  if (!measured_read(&t->lab, r->grouped ? "to" : "--to", given, band, &axes, &r->said))
    return false;
  const curve_points points = {.x = t->lab.x,
                               .low = band ? t->lab.low : t->lab.y,
                               .high = band ? t->lab.high : t->lab.y,
                               .count = t->lab.count};
  const double weight = r->o.weight_count ? r->o.weights[k] : 1;
  if (fit_curve_begin(&t->curve, &points, weight)) return true;
  diag_report(&r->said, DIAG_BAD_VALUE, t->table.where, "`%s` holds no curve to follow", given);
  return false;
}

/* Before anything runs: the table is there. */
static bool find_table(fit *f, const target *t) {
  study_request *r = f->request;
  const char *columns;
  text_table table = {.rows = 0};
  const bool good =
      text_table_read(&table, text_table_split(t->table.text, &columns), t->table.where, &r->said);
  text_table_free(&table);
  return good;
}

/* --- runs ------------------------------------------------------------------------------------- */

static int find_case(const fit *f, const char *name) {
  for (int k = 0; k < f->case_count; k++)
    if (strcmp(f->cases[k].name, name) == 0) return k;
  return -1;
}

static study_case case_of(const fit *f, int of, const double *point) {
  study_request *r = f->request;
  study_setting varied[FIT_MOST];
  for (int p = 0; p < f->count; p++) {
    const char *value = study_value_text(r->memory, point[p], f->units[p]);
    varied[p] =
        study_set(r->memory, f->keys[p], value, r->fit.items[p].where, r->fit.items[p].where);
  }
  return study_case_of(r, f->targets[of].deck, varied, f->count);
}

/* Its number; new ones are taken up. Negative after a message. */
static int take_case(fit *f, int of, const double *point) {
  arena *a = f->request->memory;
  study_case c = case_of(f, of, point);
  const int known = find_case(f, c.name);
  if (known >= 0) return known;
  if (!study_case_check(f->request, &c)) return -1;
  f->cases = arena_room(a, f->cases, f->case_count, sizeof *f->cases);
  f->squares = arena_room(a, f->squares, f->case_count, sizeof *f->squares);
  f->squares[f->case_count] = NAN;
  f->cases[f->case_count] = c;
  return f->case_count++;
}

/* The residuals of a case that has run. */
static bool residuals_of(fit *f, int of, int at, double *residuals) {
  study_request *r = f->request;
  study_row row;
  const study_case *c = &f->cases[at];
  target *t = &f->targets[of];
  const bool ran = c->state == STUDY_DONE && c->status == 0;
  if (ran && !study_row_read(r->memory, c, r->o.x, r->o.y, &row)) return false;
  if (ran)
    fit_curve_residuals(&t->curve, row.x, row.y, row.count, residuals);
  else {
    fit_curve_failed(&t->curve, residuals);
    f->without++;
  }
  f->squares[at] = 0;
  for (long k = 0; k < t->curve.count; k++)
    f->squares[at] += residuals[k] * residuals[k];
  return true;
}

/* Runs all decks at the points. */
static bool run_points(fit *f, const double *points, int count, int *at) {
  const int before = f->case_count;
  for (int k = 0; k < count * f->decks; k++)
    if ((at[k] = take_case(f, k % f->decks, points + (size_t)(k / f->decks * f->count))) < 0) {
      f->stopped = -INPUT_WRONG;
      return false;
    }
  const int new = f->case_count - before;
  f->stopped = new ? study_pool_run(f->pool, f->cases + before, new) : 0;
  return f->stopped == 0;
}

static bool evaluate(void *context, const double *points, int count, double *residuals) {
  fit *f = context;
  int *at = arena_alloc(f->request->memory, (size_t)(count * f->decks) * sizeof *at);
  if (!run_points(f, points, count, at)) return false;
  for (int k = 0; k < count * f->decks; k++) {
    if (!residuals_of(f, k % f->decks, at[k], residuals)) {
      f->stopped = -RUN_FAILED;
      return false;
    }
    residuals += f->targets[k % f->decks].curve.count;
  }
  return true;
}

/* The first runs tell the units of the curves. */
static bool begin(fit *f, long *residuals) {
  study_request *r = f->request;
  double start[FIT_MOST];
  int *at = arena_alloc(r->memory, (size_t)f->decks * sizeof *at);
  for (int p = 0; p < f->count; p++)
    start[p] = f->parameters[p].start;
  if (!run_points(f, start, 1, at)) return false;
  *residuals = 0;
  for (int k = 0; k < f->decks; k++) {
    study_row row;
    if (!study_row_read(r->memory, &f->cases[at[k]], r->o.x, r->o.y, &row)) return false;
    if (!row.there) {
      say_error("the run that the search begins with has no result: %s\n  %s", row.ended,
                f->cases[at[k]].log);
      return false;
    }
    if (!read_target(f, k, &row)) return false;
    *residuals += f->targets[k].curve.count;
  }
  return true;
}

/* --- what comes out --------------------------------------------------------------------------- */

static const char *unit_shown(const char *unit_text) {
  return *unit_text ? unit_text : "1";
}

/* Of all curves, as they are weighted; a band counts more where it is narrow. */
static double root_mean_square(const fit *f, const fit_found *found) {
  double weights = 0;
  for (int k = 0; k < f->decks; k++)
    weights += f->request->o.weight_count ? f->request->o.weights[k] : 1;
  return sqrt(found->squares / weights);
}

static void tell(const fit *f, const fit_problem *q, const fit_found *found,
                 const fit_uncertainty *u) {
  for (int p = 0; p < f->count; p++) {
    char words[400];
    fit_verdict_text(q, u, p, words, sizeof words);
    printf("  %s = %.6g %s", f->keys[p], found->best[p], f->units[p]);
    if (isfinite(u->error[p])) printf(", 95 %% from %.6g to %.6g", u->lower[p], u->upper[p]);
    printf("%s%s\n", *words ? ": " : "", words);
  }
  puts("  (intervals take the distances as independent of each other; of smooth curves they are "
       "too narrow)");
  for (int p = 0; p < f->count; p++)
    for (int q2 = 0; q2 < p; q2++)
      if (fabs(u->correlation[p][q2]) > 0.5)
        printf("  correlation of %s and %s: %.3f\n", f->keys[q2], f->keys[p],
               u->correlation[p][q2]);
  printf("  misfit %.3g %% of the largest measured value (root of the weighted mean square; of a "
         "band its middle counts, the more the narrower it is); %d points tried, %d more for the "
         "intervals%s%s\n",
         100 * root_mean_square(f, found), found->runs, u->runs,
         found->end == FIT_LIMIT ? "; the search was cut short: more with " : "",
         found->end == FIT_LIMIT ? study_word(f->request, "runs") : "");
}

/* Beyond the end of a computed curve its last value stands. */
static void warn_of_ends(const fit *f, const fit_found *found) {
  for (int k = 0; k < f->decks; k++) {
    const fit_curve *c = &f->targets[k].curve;
    const int at = find_case(f, case_of(f, k, found->best).name);
    study_row row;
    double reached = -INFINITY;
    if (at < 0 || f->cases[at].state != STUDY_DONE ||
        !study_row_read(f->request->memory, &f->cases[at], f->request->o.x, f->request->o.y, &row))
      continue;
    for (long n = 0; n < row.count; n++)
      reached = pl_fmax(reached, c->along * row.x[n]);
    long beyond = 0;
    for (long n = 0; n < c->count; n++)
      beyond += c->along * c->x[n] > reached;
    if (beyond * 20 > c->count)
      fprintf(stderr,
              "perilat: warning: %ld of %ld measured points of `%s` lie beyond the end of the run, "
              "%s = %.4g %s; its last value stands for them: run on, or cut the table\n",
              beyond, c->count, f->targets[k].table.text, row.x_name, c->along * reached,
              unit_shown(row.x_unit));
  }
}

static void put(const fit *f, const fit_problem *q, const fit_found *found,
                const fit_uncertainty *u, json *w) {
  json_put_array(w, "parameters");
  for (int p = 0; p < f->count; p++) {
    char words[400];
    fit_verdict_text(q, u, p, words, sizeof words);
    json_object(w);
    json_put_text(w, "name", f->keys[p]);
    json_put_text(w, "unit", unit_shown(f->units[p]));
    json_put_number(w, "value", found->best[p]);
    json_put_number(w, "error", u->error[p]);
    json_put_number(w, "lower", u->lower[p]);
    json_put_number(w, "upper", u->upper[p]);
    json_put_number(w, "sensitivity", u->sensitivity[p]);
    json_put_bool(w, "told", u->verdict[p] == FIT_TOLD);
    json_put_text(w, "verdict", *words ? words : NULL);
    json_object_end(w);
  }
  json_array_end(w);
  json_put_array(w, "correlation");
  for (int p = 0; p < f->count; p++) {
    json_array(w);
    for (int o = 0; o < f->count; o++)
      json_number(w, u->correlation[p][o]);
    json_array_end(w);
  }
  json_array_end(w);
  json_put_number(w, "rms", root_mean_square(f, found));
  json_put_bool(w, "found", found->end == FIT_FOUND);
  json_put_integer(w, "points", found->runs);
  json_put_integer(w, "points_of_intervals", u->runs);
}

/* Measured curves beside those of the best point. */
static bool publish(fit *f, const fit_found *found, json *w) {
  study_request *r = f->request;
  arena *a = r->memory;
  study_outcome o = {.request = r,
                     .key_count = f->count,
                     .cases = f->cases,
                     .count = f->case_count,
                     .x = r->o.x,
                     .y = r->o.y};
  const char **keys = arena_alloc(a, (size_t)f->count * sizeof *keys);
  bool *drawn = arena_alloc(a, (size_t)f->case_count * sizeof *drawn);
  plot_beside *lab = arena_alloc(a, (size_t)f->decks * sizeof *lab);
  for (int p = 0; p < f->count; p++)
    keys[p] = study_key_shown(f->keys, f->count, p);
  for (int k = 0; k < f->decks; k++) {
    const measured *m = &f->targets[k].lab;
    const study_case best = case_of(f, k, found->best);
    const int at = find_case(f, best.name);
    lab[k] = (plot_beside){
        .label = m->label, .x = m->x, .y = m->y, .low = m->low, .high = m->high, .count = m->count};
    if (at >= 0) drawn[at] = true;
  }
  const study_column misfit = {.name = "misfit", .unit = "1", .values = f->squares, .shown = true};
  o.keys = keys;
  o.drawn = drawn;
  o.beside = lab;
  o.beside_count = f->decks;
  o.more = &misfit;
  o.more_count = 1;
  for (int k = 0; k < f->case_count; k++)
    f->squares[k] = sqrt(f->squares[k]);
  return study_read_rows(&o) && study_publish(&o, w);
}

static int tell_stopped(const fit *f) {
  if (f->stopped <= 0) return f->stopped ? -f->stopped : RUN_FAILED;
  printf("stopped as asked after %d runs; the same command goes on from here\n", f->case_count);
  return 128 + f->stopped;
}

static bool all_told(const fit *f, const fit_uncertainty *u) {
  bool told = true;
  for (int p = 0; p < f->count; p++)
    told = told && u->verdict[p] == FIT_TOLD;
  return told;
}

/* A run beside the best point failed: its residuals are none. */
static void forget_intervals(const fit *f, fit_uncertainty *u) {
  fprintf(stderr,
          "perilat: warning: %d run%s beside the best point gave no curve: the intervals of "
          "the parameters are not known\n",
          f->without, f->without == 1 ? "" : "s");
  for (int p = 0; p < f->count; p++) {
    u->error[p] = u->lower[p] = u->upper[p] = u->sensitivity[p] = NAN;
    if (u->verdict[p] == FIT_TOLD) u->verdict[p] = FIT_UNTOLD;
    for (int o = 0; o < f->count; o++)
      u->correlation[p][o] = NAN;
  }
}

static int search(fit *f, json *w) {
  long residuals;
  fit_found found = {.residuals = NULL};
  fit_uncertainty u;
  if (!begin(f, &residuals)) return tell_stopped(f);
  const fit_problem q = {
      .parameter = f->parameters,
      .parameters = f->count,
      .residuals = (int)residuals,
      .evaluate = evaluate,
      .context = f,
      .method = strcmp(f->request->o.search, "nelder-mead") == 0 ? FIT_NELDER_MEAD : FIT_BOBYQA,
      .tolerance = accuracy,
      .most_runs = f->request->o.runs};
  fit_search(&q, &found);
  fit_descend(&q, &found);
  f->without = 0;
  bool good = found.end != FIT_BROKEN && fit_uncertainty_find(&q, &found, &u);
  if (good && f->without) forget_intervals(f, &u);
  good = good && publish(f, &found, w);
  if (good) tell(f, &q, &found, &u);
  if (good) warn_of_ends(f, &found);
  if (good && w) put(f, &q, &found, &u, w);
  const bool answered = good && found.end == FIT_FOUND && all_told(f, &u);
  fit_found_free(&found);
  if (f->stopped) return tell_stopped(f);
  return answered ? 0 : 2;
}

static bool prepare(fit *f) {
  study_request *r = f->request;
  if (!read_parameters(f)) return false;
  double start[FIT_MOST];
  for (int p = 0; p < f->count; p++)
    start[p] = f->parameters[p].start;
  f->decks = r->decks.count;
  f->targets = arena_alloc(r->memory, (size_t)f->decks * sizeof *f->targets);
  for (int k = 0; k < f->decks; k++) {
    f->targets[k] = (target){.deck = r->decks.items[k].text, .table = r->to.items[k]};
    if (!find_table(f, &f->targets[k])) return false;
  }
  for (int k = 0; k < f->decks; k++) {
    study_case c = case_of(f, k, start);
    if (!study_case_check(r, &c)) return false;
    if (k == 0) study_warn_of_units(r, &c, 1);
  }
  if (r->o.runs >= 2 * f->count + 2) return true;
  diag_report(&r->said, DIAG_BAD_VALUE, r->fit.items[0].where,
              "a search for %d parameter%s needs %d runs at least", f->count,
              f->count == 1 ? "" : "s", 2 * f->count + 2);
  return false;
}

static void let_go(fit *f) {
  for (int k = 0; k < f->decks && f->targets; k++)
    if (f->targets[k].read) {
      measured_free(&f->targets[k].lab);
      fit_curve_free(&f->targets[k].curve);
    }
}

int study_fit(study_request *r, study_pool *pool, json *w) {
  fit f = {.request = r, .pool = pool};
  int status = 1;
  if (prepare(&f)) {
    if (r->check_only)
      status = 0;
    else if (study_folder_open(f.pool->folder, r)) {
      f.pool->expected = (r->o.runs + 2 * f.count) * f.decks;
      status = search(&f, w);
    }
  }
  let_go(&f);
  return status;
}
