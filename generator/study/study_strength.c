#include "generator/study/study_strength.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/elementary.h"
#include "dsl/base/units.h"
#include "generator/run/run.h"
#include "generator/study/held_load.h"
#include "generator/study/study_deck.h"
#include "generator/study/study_publish.h"
#include "runtime/base/quantity.h"

enum { MOST_LOADS = 1000, TENTHS = 20, PARTS = 5 };

typedef struct load {
  double value; /* in the unit of the key, with its sign */
  study_case run;
  double hold; /* s: of that run */
  bool judged;
  bool failed; /* its run has no result */
  held_load found;
} load;

typedef struct scan {
  study_request *request;
  study_pool *pool;
  const char *key, *unit; /* "force.per_length", "kN/m" */
  span key_where;
  bool key_alone; /* no loads were given */
  double held;    /* s: from then on the load is held, */
  double hold;    /* s: as long in the deck */
  load *loads;    /* ascending in size */
  int count;
  study_case twin; /* where there is one */
} scan;

/* --- what the deck says ----------------------------------------------------------------------- */

/* s; 0 where the deck gives none. False after a message. */
static bool read_time(study_request *r, const study_deck *t, const char *name, double *value) {
  bool good = true;
  const char *text = study_deck_value(t, r, name, &good);
  *value = 0;
  if (!good || !text || quantity_read(text, strlen(text), "s", value)) return good;
  diag_report(&r->said, DIAG_BAD_VALUE, r->strength.where,
              "a scan of loads needs times in seconds: the deck gives `%s` = %s", name, text);
  diag_hint(&r->said, "write how long it is, or %s",
            study_written(r, "set", arena_printf(r->memory, "%s=...", name)));
  return false;
}

/* "force[1].per_length" and "rise" are "force[1].rise". */
static const char *beside(study_request *r, const char *key, const char *other) {
  const char *bracket = strrchr(key, ']'), *dot = strrchr(bracket ? bracket : key, '.');
  return arena_printf(r->memory, "%.*s.%s", (int)(dot - key), key, other);
}

static bool refuse_hold(study_request *r, const char *sentence, const char *key) {
  diag_report(&r->said, DIAG_BAD_VALUE, r->strength.where, "%s `%s`", sentence, key);
  diag_hint(&r->said, "a held load has history 'ramp and hold', a rise, and an end_time beyond it");
  return false;
}

/* When the load has grown, and how long it is held. */
static bool read_times(scan *s, const study_deck *t) {
  study_request *r = s->request;
  bool good = true;
  double end, start, rise;
  const char *history = study_deck_value(t, r, beside(r, s->key, "history"), &good);
  if (!good || !read_time(r, t, "simulation.end_time", &end) ||
      !read_time(r, t, beside(r, s->key, "start"), &start) ||
      !read_time(r, t, beside(r, s->key, "rise"), &rise))
    return false;
  if (strncasecmp(s->key, "drive", strlen("drive")) == 0 || !(rise > 0) ||
      (history && strcmp(history, "ramp and hold") != 0))
    return refuse_hold(r, "this is no load that grows and is held:", s->key);
  s->held = start + rise;
  s->hold = end - s->held;
  return s->hold > 0 || refuse_hold(r, "the deck ends before this load has grown:", s->key);
}

/* --- the loads -------------------------------------------------------------------------------- */

static int by_size(const void *a, const void *b) {
  const double x = fabs(((const load *)a)->value), y = fabs(((const load *)b)->value);
  return x < y ? -1 : x > y;
}

static study_case case_of(const scan *s, double value, double hold) {
  study_request *r = s->request;
  const span where = r->strength.where;
  const study_setting varied[] = {
      study_set(r->memory, s->key, study_value_text(r->memory, value, s->unit), s->key_where,
                where),
      study_set(r->memory, "simulation.end_time",
                study_value_text(r->memory, 1e3 * (s->held + hold), "ms"), where, where)};
  return study_case_of(r, r->decks.items[0].text, varied, 2);
}

static bool is_scanned(const scan *s, double value) {
  for (int k = 0; k < s->count; k++)
    if (fabs(s->loads[k].value - value) <= 1e-9 * fabs(value)) return true;
  return false;
}

static void add_load(scan *s, double value) {
  if (is_scanned(s, value)) return;
  s->loads = arena_room(s->request->memory, s->loads, s->count, sizeof *s->loads);
  s->loads[s->count++] = (load){.value = value, .hold = s->hold, .run = case_of(s, value, s->hold)};
  qsort(s->loads, (size_t)s->count, sizeof *s->loads, by_size);
}

/* from..to:step */
static bool add_range(scan *s) {
  study_axis axis;
  study_request *r = s->request;
  double value;
  if (!study_axis_read(r->memory, &r->strength, &axis, &r->said)) return false;
  if (axis.key_count > 1 || axis.count > MOST_LOADS) {
    diag_report(&r->said, DIAG_BAD_VALUE, r->strength.where,
                axis.key_count > 1 ? "a scan of loads has one key" : "these are too many loads");
    return false;
  }
  for (int k = 0; k < axis.count; k++) {
    if (!study_split_number(axis.keys[0].values[k], &value, &s->unit)) {
      diag_report(&r->said, DIAG_BAD_VALUE, r->strength.where, "`%s` is no number",
                  axis.keys[0].values[k]);
      return false;
    }
    add_load(s, value);
  }
  if (s->loads[0].value * s->loads[s->count - 1].value >= 0 || s->count == 1) return true;
  diag_report(&r->said, DIAG_BAD_VALUE, r->strength.where, "a scan of loads has one sign");
  return false;
}

/* Of the key alone: tenths of the deck's value. */
static bool add_tenths(scan *s, const char *given) {
  study_request *r = s->request;
  double value = 0;
  if (!given || !study_split_number(given, &value, &s->unit) || value == 0) {
    diag_report(&r->said, DIAG_BAD_VALUE, r->strength.where,
                "the deck gives no value for `%s` to scan around", s->key);
    diag_hint(&r->said, "say which loads: %s",
              study_written(r, "strength", arena_printf(r->memory, "%s=10..20:1 kN", s->key)));
    return false;
  }
  for (int k = 1; k <= TENTHS; k++)
    add_load(s, k * value / 10);
  return true;
}

/* --- runs and verdicts ------------------------------------------------------------------------ */

/* The first load that is not borne, as far as is known; `count`: none. */
static int first_not_borne(const scan *s) {
  int k = 0;
  while (k < s->count &&
         (!s->loads[k].judged || (!s->loads[k].failed && s->loads[k].found.verdict == HELD_BORNE)))
    k++;
  return k;
}

/* Those whose verdict counts and is not known, at most as many as run at the same time. */
static int next_loads(const scan *s, load **next, int most) {
  const int limit = first_not_borne(s);
  int count = 0;
  for (int k = 0; k < limit && k < s->count && count < most; k++)
    if (!s->loads[k].judged) next[count++] = &s->loads[k];
  return count;
}

/* Twice as long, up to the longest; what comes to rest even then is borne. */
static void prolong(const scan *s, load *l) {
  if (2 * l->hold > s->request->o.longest * s->hold * (1 + 1e-9)) {
    l->found.verdict = HELD_BORNE;
    l->judged = true;
    return;
  }
  l->hold *= 2;
  l->run = case_of(s, l->value, l->hold);
}

/* False after a message. */
static bool judge(const scan *s, load *l) {
  study_request *r = s->request;
  study_row row;
  if (l->run.state != STUDY_DONE) {
    l->judged = l->failed = true;
    return true;
  }
  if (!study_row_read(r->memory, &l->run, NULL, r->o.watch, &row)) return false;
  l->found = held_load_judge(row.time, row.y, row.count, s->held, s->held + l->hold, r->o.growth,
                             r->o.limit);
  l->failed = l->found.verdict == HELD_CUT;
  l->judged = l->found.verdict != HELD_UNDECIDED;
  if (!l->judged) prolong(s, l);
  return true;
}

/* Runs what is asked for together, and the twin with the first of them. As study_pool_run. */
static int run_batch(scan *s, load **next, int count) {
  const int extra = s->request->o.twin && s->twin.state == STUDY_WAITING;
  study_case *cases =
      arena_alloc(s->request->memory, ((size_t)(count + extra) + 1) * sizeof *cases);
  for (int k = 0; k < count; k++) {
    cases[k] = next[k]->run;
    if (!study_case_check(s->request, &cases[k])) return -INPUT_WRONG;
  }
  if (extra) cases[count] = s->twin;
  const int stopped = study_pool_run(s->pool, cases, count + extra);
  for (int k = 0; k < count; k++)
    next[k]->run = cases[k];
  if (extra) s->twin = cases[count];
  return stopped;
}

static int scan_loads(scan *s) {
  load *next[MOST_LOADS];
  const int most = study_pool_jobs(s->request, MOST_LOADS);
  for (int count; (count = next_loads(s, next, most)) > 0;) {
    const int stopped = run_batch(s, next, count);
    if (stopped) return stopped;
    for (int k = 0; k < count; k++)
      if (!judge(s, next[k])) return -RUN_FAILED;
  }
  return 0;
}

/* Between what is borne and what is not, where the key alone was given. */
static int refine(scan *s) {
  const int first = first_not_borne(s);
  if (first == s->count) return 0;
  const double high = s->loads[first].value, low = first ? s->loads[first - 1].value : 0;
  for (int k = 1; k < PARTS; k++)
    add_load(s, low + (high - low) * k / PARTS);
  return scan_loads(s);
}

/* --- what comes out --------------------------------------------------------------------------- */

static const char *verdict_word(const load *l) {
  if (l->failed) return l->run.state == STUDY_DONE ? "ended before the hold" : "no result";
  return l->found.verdict == HELD_BORNE ? "borne" : "collapsed";
}

typedef struct strength {
  bool has_lower, has_upper;
  double lower, upper; /* sizes, SI */
  double peak;         /* of the twin, SI of the load; NaN without one */
  const char *no_peak; /* why there is none, or NULL */
  const char *unit;    /* SI */
  double factor;       /* of the key's unit */
} strength;

/* Of the key in SI. */
static double si_factor(const scan *s, const char **si_unit, arena *a) {
  unit u = {.factor = 1};
  const char *bad;
  size_t length;
  char text[64];
  if (*s->unit && !unit_parse(s->unit, strlen(s->unit), &u, &bad, &length)) return 1;
  dim_unit(u.dim, text, sizeof text);
  *si_unit = arena_text(a, text, strlen(text));
  return u.factor;
}

/* A load that is borne, and is one. */
static const load *borne(const scan *s) {
  for (int k = first_not_borne(s) - 1; k >= 0; k--)
    if (s->loads[k].value != 0) return &s->loads[k];
  return NULL;
}

/* The twin's largest load, as a load of the key: by what a load that is borne amounts to. False
   after a message. */
static bool find_peak(const scan *s, double factor, strength *f) {
  study_request *r = s->request;
  const load *l = borne(s);
  study_row twin, held;
  f->peak = NAN;
  if (!r->o.twin || !l) return true;
  if (s->twin.state != STUDY_DONE || s->twin.status != 0) {
    f->no_peak = "its twin has no result";
    return true;
  }
  if (!study_row_read(r->memory, &s->twin, NULL, r->o.y, &twin) ||
      !study_row_read(r->memory, &l->run, NULL, r->o.y, &held))
    return false;
  const study_history *h = study_row_history(&held, held.y_name);
  if (!h || h->last == 0 || strcmp(twin.y_name, held.y_name) != 0 ||
      strcmp(twin.y_unit, held.y_unit) != 0)
    f->no_peak = arena_printf(
        r->memory, "deck and twin have no history in common that says the load: name it with %s",
        study_word(r, "y"));
  else
    f->peak = fabs(twin.peak * l->value * factor / h->last);
  return true;
}

static bool conclude(const scan *s, strength *found) {
  const int first = first_not_borne(s);
  const double factor = found->factor = si_factor(s, &found->unit, s->request->memory);
  found->has_lower = first > 0;
  found->has_upper = first < s->count && !s->loads[first].failed;
  if (found->has_lower) found->lower = fabs(s->loads[first - 1].value) * factor;
  if (found->has_upper) found->upper = fabs(s->loads[first].value) * factor;
  return find_peak(s, factor, found);
}

static void put_end(json *w, const char *name, bool known, double value) {
  json_key(w, name);
  if (known)
    json_number(w, value);
  else
    json_null(w);
}

/* "bears 42 kN/m, not 44 kN/m" */
static void tell_ends(const scan *s, const strength *f) {
  const int first = first_not_borne(s);
  const bool known = f->has_lower || f->has_upper;
  fputs("  ", stdout);
  if (f->has_lower) printf("bears %.6g %s", f->lower / f->factor, s->unit);
  if (f->has_upper)
    printf("%s %.6g %s", f->has_lower ? ", not" : "does not bear", f->upper / f->factor, s->unit);
  else if (first == s->count)
    printf("%sno load made it collapse", known ? "; " : "");
  else
    printf("%sthe run with %.6g %s says nothing: %s (%s)", known ? "; " : "",
           fabs(s->loads[first].value), s->unit, verdict_word(&s->loads[first]),
           s->loads[first].run.log);
}

/* By what a load is borne, and where the twin is. */
static void tell_rule(const scan *s) {
  const study_request *r = s->request;
  printf("  borne: `%s` is the same in both halves of the hold, within %g %%, and below %g m; "
         "collapsed: it is larger in the second; where it is smaller, the hold is doubled\n",
         r->o.watch, 100 * r->o.growth, r->o.limit);
  if (r->o.twin)
    printf("  twin: `%s`, %s\n", r->o.twin,
           s->twin.state == STUDY_DONE ? s->twin.result : s->twin.log);
}

static void tell(const scan *s, const strength *f, json *w) {
  tell_ends(s, f);
  if (isfinite(f->peak))
    printf("; moved, not loaded, its peak is %.6g %s", f->peak / f->factor, s->unit);
  printf("%s%s\n", f->no_peak ? "; " : "", f->no_peak ? f->no_peak : "");
  tell_rule(s);
  if (!w) return;
  json_put_text(w, "key", s->key);
  json_put_text(w, "unit", f->unit);
  put_end(w, "lower", f->has_lower, f->lower);
  put_end(w, "upper", f->has_upper, f->upper);
  put_end(w, "peak", isfinite(f->peak), f->peak);
}

/* Of a study without any result it does not matter. */
static const char *unit_of_watched(const study_outcome *o) {
  for (int k = 0; k < o->count; k++)
    if (o->rows[k].there) return o->rows[k].y_unit;
  return "1";
}

/* Loads up to the first that is not borne, as rows: what was run beyond hangs on the jobs. */
static bool publish(const scan *s, json *w) {
  study_request *r = s->request;
  const char *const keys[] = {study_key_shown(&s->key, 1, 0), "end_time"};
  study_outcome o = {.request = r, .keys = keys, .key_count = 2, .y = r->o.watch};
  o.cases = arena_alloc(r->memory, ((size_t)s->count + 1) * sizeof *o.cases);
  const size_t rows = (size_t)s->count + 1;
  study_column halves[] = {{.name = "first half", .shown = true},
                           {.name = "second half", .shown = true}},
               verdict = {.name = "verdict", .shown = true};
  halves[0].values = arena_alloc(r->memory, rows * sizeof(double));
  halves[1].values = arena_alloc(r->memory, rows * sizeof(double));
  verdict.texts = arena_alloc(r->memory, rows * sizeof *verdict.texts);
  for (int k = 0; k < s->count && k <= first_not_borne(s); k++) {
    const load *l = &s->loads[k];
    halves[0].values[o.count] = l->failed ? NAN : l->found.first;
    halves[1].values[o.count] = l->failed ? NAN : l->found.second;
    verdict.texts[o.count] = verdict_word(l);
    if (!l->failed && l->found.verdict == HELD_BORNE)
      o.y_most = pl_fmax(o.y_most, 2 * pl_fmax(l->found.first, l->found.second));
    o.cases[o.count++] = l->run;
  }
  if (!study_read_rows(&o)) return false;
  halves[0].unit = halves[1].unit = unit_of_watched(&o);
  const study_column more[] = {halves[0], halves[1], verdict};
  o.more = more;
  o.more_count = 3;
  return study_publish(&o, w);
}

static int tell_stopped(const scan *s, int signal_number) {
  int judged = 0;
  for (int k = 0; k < s->count; k++)
    judged += s->loads[k].judged;
  printf("stopped as asked: %d loads are judged; the same command goes on from here\n", judged);
  return 128 + signal_number;
}

/* The deck's own load tells which way it acts. */
static void warn_of_sign(const scan *s, const char *given) {
  study_request *r = s->request;
  double own;
  const char *unit_text;
  if (!given || !study_split_number(given, &own, &unit_text) ||
      own * s->loads[s->count - 1].value >= 0)
    return;
  diag_report(&r->said, DIAG_DECK_WARNING, r->strength.where,
              "these loads act against the deck's own: `%s` is %s there", s->key, given);
  diag_hint(&r->said, "give them its sign");
}

static bool prepare(scan *s) {
  study_request *r = s->request;
  study_deck t;
  study_range range;
  if (!study_range_read(r->memory, &r->strength, &range, &r->said) ||
      !study_deck_open(&t, r, &r->decks.items[0]))
    return false;
  s->key = range.key.name;
  s->key_where = range.key.where;
  s->key_alone = !range.low;
  s->unit = "";
  bool good = true;
  const char *given = study_deck_value(&t, r, s->key, &good);
  good = good && read_times(s, &t) && (s->key_alone ? add_tenths(s, given) : add_range(s));
  study_deck_close(&t);
  if (good) warn_of_sign(s, given);
  if (!good || !r->o.twin) return good;
  s->twin = study_case_of(r, r->o.twin, NULL, 0);
  s->twin.twin = true;
  return study_case_check(r, &s->twin);
}

int study_strength(study_request *r, study_pool *pool, json *w) {
  scan s = {.request = r, .pool = pool};
  strength found = {.peak = NAN};
  if (!prepare(&s)) return 1;
  for (int k = 0; k < s.count; k++) /* before anything runs */
    if (!study_case_check(r, &s.loads[k].run)) return 1;
  study_warn_of_units(r, &s.loads[s.count - 1].run, 1);
  if (r->check_only) return 0;
  if (!study_folder_open(pool->folder, r)) return 1;
  int stopped = scan_loads(&s);
  if (!stopped && s.key_alone) stopped = refine(&s);
  if (stopped > 0) return tell_stopped(&s, stopped);
  if (stopped < 0) return -stopped;
  if (!publish(&s, w) || !conclude(&s, &found)) return 2;
  tell(&s, &found, w);
  return found.has_lower && found.has_upper ? 0 : 2;
}
