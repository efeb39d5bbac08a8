#include "generator/fit/fit_search.h"

#include <math.h>
#include <nlopt.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

static const double first_step = 0.125; /* of the width of the bounds */
enum { MOST_FIRST = 2 * FIT_MOST + 2 };

/* What has been computed, by place in the box: 0 at the lower bounds, 1 at the upper ones. */
typedef struct known {
  double *places, *squares; /* [room*parameters], [room] */
  int count, room;
} known;

typedef struct search {
  const fit_problem *problem;
  fit_found *found;
  known known;
  double *places; /* [MOST_FIRST*parameters]: of a batch */
  double *points, *residuals;
  nlopt_opt optimizer;
} search;

/* At 0, 1 and the start the bounds and the start themselves, to the bit. */
static double value_of(const fit_parameter *p, double place) {
  const double width = p->upper - p->lower, start = (p->start - p->lower) / width;
  if (place == start) return p->start;
  if (place >= 1) return p->upper;
  return pl_fmin(pl_fmax(p->lower + place * width, p->lower), p->upper);
}

static int known_at(const search *s, const double *place) {
  const size_t n = (size_t)s->problem->parameters;
  for (int k = 0; k < s->known.count; k++)
    if (!memcmp(&s->known.places[(size_t)k * n], place, n * sizeof(double))) return k;
  return -1;
}

static void keep(search *s, const double *place, double squares) {
  known *k = &s->known;
  const size_t n = (size_t)s->problem->parameters;
  if (k->count == k->room) {
    k->room = 2 * k->room + 64;
    k->places = must_realloc(k->places, (size_t)k->room * n * sizeof(double));
    k->squares = must_realloc(k->squares, (size_t)k->room * sizeof(double));
  }
  memcpy(&k->places[(size_t)k->count * n], place, n * sizeof(double));
  k->squares[k->count++] = squares;
}

/* The first of equals stays the best. */
static void take(search *s, int k) {
  const size_t n = (size_t)s->problem->parameters, m = (size_t)s->problem->residuals;
  const double *r = &s->residuals[(size_t)k * m];
  fit_found *f = s->found;
  double squares = 0;
  for (size_t i = 0; i < m; i++)
    squares += r[i] * r[i];
  if (!isfinite(squares)) f->end = FIT_BROKEN;
  keep(s, &s->places[(size_t)k * n], squares);
  f->runs++;
  if (!(squares < f->squares)) return;
  if (!f->residuals) f->residuals = must_alloc(m * sizeof(double));
  f->squares = squares;
  memcpy(f->residuals, r, m * sizeof(double));
  memcpy(f->best, &s->points[(size_t)k * n], n * sizeof(double));
}

/* s->places[0..count): those not known, each once, in one batch. */
static bool compute(search *s, int count) {
  const fit_problem *p = s->problem;
  const size_t n = (size_t)p->parameters;
  int new = 0;
  for (int k = 0; k < count; k++) {
    const double *place = &s->places[(size_t)k * n];
    bool there = known_at(s, place) >= 0;
    for (int i = 0; i < new && !there; i++)
      there = !memcmp(&s->places[(size_t)i * n], place, n * sizeof(double));
    if (there) continue;
    memmove(&s->places[(size_t) new ++*n], place, n * sizeof(double));
  }
  for (size_t i = 0; i < (size_t) new *n; i++)
    s->points[i] = value_of(&p->parameter[i % n], s->places[i]);
  if (new && !p->evaluate(p->context, s->points, new, s->residuals)) s->found->end = FIT_BROKEN;
  for (int k = 0; k < new && s->found->end != FIT_BROKEN; k++)
    take(s, k);
  return s->found->end != FIT_BROKEN;
}

static double objective(unsigned n, const double *place, double *gradient, void *context) {
  search *s = context;
  (void)gradient;
  int k = known_at(s, place);
  if (k < 0 && s->found->runs < s->problem->most_runs) {
    memcpy(s->places, place, n * sizeof(double));
    if (compute(s, 1)) k = s->known.count - 1;
  } else if (k < 0) {
    s->found->end = FIT_LIMIT;
  }
  if (k < 0) nlopt_force_stop(s->optimizer);
  return k < 0 ? HUGE_VAL : s->known.squares[k];
}

/* The places where an optimizer begins do not hang on values: those of a flat function. */
static double note_place(unsigned n, const double *place, double *gradient, void *context) {
  search *s = context;
  (void)gradient;
  const int k = s->found->runs++;
  memcpy(&s->places[(size_t)k * n], place, n * sizeof(double));
  return 0;
}

static void start_of(const search *s, double *place) {
  for (int i = 0; i < s->problem->parameters; i++) {
    const fit_parameter *p = &s->problem->parameter[i];
    place[i] = (p->start - p->lower) / (p->upper - p->lower);
  }
}

static nlopt_result optimize(search *s, nlopt_func function, int most) {
  const fit_problem *p = s->problem;
  double place[FIT_MOST], least;
  s->optimizer = nlopt_create(p->method == FIT_BOBYQA ? NLOPT_LN_BOBYQA : NLOPT_LN_NELDERMEAD,
                              (unsigned)p->parameters);
  nlopt_set_lower_bounds1(s->optimizer, 0);
  nlopt_set_upper_bounds1(s->optimizer, 1);
  nlopt_set_initial_step1(s->optimizer, first_step);
  nlopt_set_xtol_abs1(s->optimizer, p->tolerance);
  nlopt_set_maxeval(s->optimizer, most);
  nlopt_set_min_objective(s->optimizer, function, s);
  start_of(s, place);
  const nlopt_result result = nlopt_optimize(s->optimizer, place, &least);
  nlopt_destroy(s->optimizer);
  return result;
}

/* The start, which an optimizer may move away from a bound that is near, and the places where it
   begins, at the same time. */
static bool begin(search *s) {
  const int n = s->problem->parameters;
  optimize(s, note_place, s->problem->method == FIT_BOBYQA ? 2 * n + 1 : n + 1);
  const int count = s->found->runs;
  s->found->runs = 0;
  start_of(s, &s->places[(size_t)count * (size_t)n]);
  return compute(s, count + 1);
}

void fit_search(const fit_problem *problem, fit_found *found) {
  const size_t n = (size_t)problem->parameters, m = (size_t)problem->residuals;
  *found = (fit_found){.end = FIT_FOUND, .squares = INFINITY};
  search s = {.problem = problem, .found = found};
  s.places = must_alloc(MOST_FIRST * n * sizeof(double));
  s.points = must_alloc(MOST_FIRST * n * sizeof(double));
  s.residuals = must_alloc(MOST_FIRST * m * sizeof(double));
  /* where rounding rules, nothing better is to be found */
  const nlopt_result result = begin(&s) ? optimize(&s, objective, 0) : NLOPT_FORCED_STOP;
  if (result < 0 && result != NLOPT_FORCED_STOP && result != NLOPT_ROUNDOFF_LIMITED)
    found->end = FIT_BROKEN;
  free(s.places);
  free(s.points);
  free(s.residuals);
  free(s.known.places);
  free(s.known.squares);
}

void fit_found_free(fit_found *found) {
  free(found->residuals);
  found->residuals = NULL;
}
