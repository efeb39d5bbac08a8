/* A plain state that takes force from the bond as a damage does, and gives it back. */
#include "generator/check/physics_healing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/base/powers.h"
#include "generator/check/physics_paths.h"
#include "generator/check/physics_states.h"
#include "generator/ir/random_values.h"

static const double FACTOR_TOLERANCE = 1e-6; /* of a factor of the force, at two sizes of motion */
static const double LEAST_LOSS = 1e-3;       /* of a force that a state must take to count */
static const double LEAST_RETURN = 1e-9;     /* of a state and of the force that come back */

/* --- states that are factors of the forces ---------------------------------------------------- */

enum { LEVELS = 12, LOOKS = 16 };

/* How far a state is from its initial value: 0, then over nine decades, for it may count
   openings or shares. */
static double level_at(int k) {
  return k == 0 ? 0 : k == LEVELS - 1 ? 1 : k == LEVELS - 2 ? 0.5 : power_of(10, k - 10);
}

typedef double level_forces[FORCE_COUNT][LEVELS];

static void forces_at_levels(physics *p, double *const *states, motion m, level_forces out) {
  for (int k = 0; k < LEVELS; k++)
    bench_move(&p->b, states, k, m);
  probe_run(&p->b, &p->b.frozen, states, LEVELS);
  for (int f = 0; f < FORCE_COUNT; f++)
    memcpy(out[f], p->b.frozen.out[f], LEVELS * sizeof(double));
}

static motion scaled(motion m, double factor) {
  for (int k = 0; k < AXIS_COUNT; k++)
    m.at[k] *= factor;
  return m;
}

typedef enum answer { NOTHING, WEAKENS, NO_FACTOR } answer;

/* Whether the levels multiply a force by ever smaller factors, the same at motion m and half of
   it. */
static answer factors_of(physics *p, double *const *states, motion m) {
  level_forces full, half, rest;
  forces_at_levels(p, states, m, full);
  forces_at_levels(p, states, scaled(m, 0.5), half);
  forces_at_levels(p, states, (motion){{0}}, rest);
  answer found = NOTHING;
  for (int f = 0; f < FORCE_COUNT; f++) {
    if (full[f][0] == 0 || half[f][0] == 0) continue;
    double before = 1;
    for (int k = 0; k < LEVELS; k++) {
      double factor = full[f][k] / full[f][0];
      bool same = fabs(factor - half[f][k] / half[f][0]) <= FACTOR_TOLERANCE;
      bool falls = factor >= -FACTOR_TOLERANCE && factor <= before + FACTOR_TOLERANCE;
      if (!same || !falls || fabs(rest[f][k]) > FACTOR_TOLERANCE * fabs(full[f][0]))
        return NO_FACTOR;
      if (factor < 1 - LEAST_LOSS) found = WEAKENS;
      before = factor;
    }
  }
  return found;
}

static motion without_rate(motion m) {
  m.at[AXIS_RATE] = 0;
  return m;
}

/* 1 or -1: the way from its initial value in which a field weakens the bond; 0: it does not
   scale the forces. */
static int weakening_way(physics *p, int field, double *const *states) {
  bench *b = &p->b;
  const double initial = b->law->fields.items[field]->initial;
  double *column = must_alloc((size_t)b->width * sizeof *column);
  int found = 0;
  for (int way = 1; way >= -1 && !found; way -= 2) {
    answer all = NOTHING;
    for (int look = 0; look < LOOKS && all != NO_FACTOR; look++) {
      bench_draw(b, states, look);
      bench_virgin(b, states, look);
      bench_get(b, states, look, column);
      for (int k = 0; k < LEVELS; k++) {
        bench_put(b, states, k, column);
        bench_field(b, states, field)[k] = initial + way * level_at(k);
      }
      answer one = factors_of(p, states, without_rate(physics_draw_motion(p)));
      all = one != NOTHING ? one : all;
    }
    if (all == WEAKENS) found = way;
  }
  free(column);
  return found;
}

/* --- driving there and back ------------------------------------------------------------------- */

enum { CORNERS = 5, STEPS = 16 };

typedef struct tour {
  motion corner[CORNERS];   /* rest, a, rest, b, rest */
  double rate[CORNERS - 1]; /* of the stretch on each leg, 1/s */
} tour;

static tour draw_tour(physics *p) {
  motion amplitude = physics_draw_motion(p);
  double speed = pl_pow(10, draw_uniform(&p->b.seed, -3, 5));
  tour t = {0};
  for (int k = 1; k < CORNERS; k += 2) {
    t.corner[k] = physics_draw_corner(p, amplitude);
    t.rate[k - 1] = copysign(speed, t.corner[k].at[AXIS_STRETCH]);
    t.rate[k] = -t.rate[k - 1];
  }
  return t;
}

static motion on_tour(const tour *t, int leg, int step) {
  motion m = {{0}};
  for (int k = 0; k < AXIS_COUNT; k++)
    m.at[k] =
        t->corner[leg].at[k] + (t->corner[leg + 1].at[k] - t->corner[leg].at[k]) * step / STEPS;
  m.at[AXIS_RATE] = t->rate[leg];
  return m;
}

/* True when the bond of lane `lane` is stronger with `field` at `now`, drawn out or pushed
   together. */
static bool is_stronger(physics *p, double *const *states, int lane, int field, double now,
                        double **few) {
  enum { BEFORE, AFTER, BEFORE_BACK, AFTER_BACK, LANES };
  bench *b = &p->b;
  double *column = must_alloc((size_t)b->width * sizeof *column);
  motion m = without_rate(bench_motion(b, states, lane)), back = m;
  back.at[AXIS_STRETCH] = pl_fmax(-m.at[AXIS_STRETCH], -0.5);
  bench_get(b, states, lane, column);
  for (int k = 0; k < LANES; k++) {
    bench_put(b, few, k, column);
    bench_move(b, few, k, k < BEFORE_BACK ? m : back);
  }
  bench_field(b, few, field)[AFTER] = bench_field(b, few, field)[AFTER_BACK] = now;
  probe_run(b, &b->frozen, few, LANES);
  free(column);
  for (int k = 0; k < LANES; k += 2)
    if (bench_size(b, few, &b->frozen, k + 1) >
        (1 + LEAST_RETURN) * bench_size(b, few, &b->frozen, k))
      return true;
  return false;
}

typedef struct healing {
  int field, way;
  double began; /* of the field */
  bool moved;   /* the field left it */
  tour of[BENCH_LANES];
  double **states, **few;
} healing;

static void say_healing(physics *p, const healing *h, int lane, int leg, double before,
                        double now) {
  const symbol *s = p->b.law->fields.items[h->field];
  motion way[CORNERS + 1];
  char corners[640], began[128] = "";
  memcpy(way, h->of[lane].corner, ((size_t)leg + 1) * sizeof *way);
  way[leg + 1] = bench_motion(&p->b, h->states, lane);
  physics_describe_way(p, way, h->of[lane].rate, NULL, leg + 2, corners, sizeof corners);
  if (h->began != s->initial)
    snprintf(began, sizeof began, ", begun with %s = %g", s->name, h->began);
  physics_say(
      p, DIAG_HEALING, s->rule ? s->rule->where : s->declared->where, NULL,
      "state `%s` acts as a damage does, but goes back, here from %.6g to %.6g: the bond heals",
      s->name, before, now);
  diag_note(p->said, (span){0, 0, UINT16_MAX}, "found on the way through %s = %s%s",
            p->b.micropolar ? "(stretch, theta_i, theta_j)" : "stretch", corners, began);
  if (h->way > 0)
    diag_hint(p->said,
              "write `damage %s`, which never decreases, or `%s = max(%s, ...)`; if healing is "
              "meant, say `nonconservative \"why\"`",
              s->name, s->name, s->name);
  else
    diag_hint(p->said,
              "keep the smallest value, `%s = min(%s, ...)`; if healing is meant, say "
              "`nonconservative \"why\"`",
              s->name, s->name);
}

static void look_at_step(physics *p, healing *h, int leg) {
  bench *b = &p->b;
  const double *before = bench_field(b, h->states, h->field),
               *now = b->step.out[FORCE_COUNT + h->field];
  for (int lane = 0; lane < BENCH_LANES && !p->failed[DIAG_HEALING]; lane++) {
    double back = (before[lane] - now[lane]) * h->way,
           size = pl_fmax(fabs(before[lane]), fabs(now[lane]));
    h->moved = h->moved || before[lane] != now[lane];
    bool weakened = (before[lane] - b->law->fields.items[h->field]->initial) * h->way > 0;
    if (weakened && back > LEAST_RETURN * size &&
        is_stronger(p, h->states, lane, h->field, now[lane], h->few))
      say_healing(p, h, lane, leg, before[lane], now[lane]);
  }
}

static void drive_round(physics *p, healing *h) {
  bench *b = &p->b;
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    bench_draw(b, h->states, lane);
    bench_virgin(b, h->states, lane);
    bench_field(b, h->states, h->field)[lane] = h->began;
    h->of[lane] = draw_tour(p);
  }
  for (int leg = 0; leg < CORNERS - 1; leg++)
    for (int step = 1; step <= STEPS && !p->failed[DIAG_HEALING]; step++) {
      for (int lane = 0; lane < BENCH_LANES; lane++)
        bench_move(b, h->states, lane, on_tour(&h->of[lane], leg, step));
      probe_run(b, &b->step, h->states, BENCH_LANES);
      look_at_step(p, h, leg);
      bench_accept(b, h->states, BENCH_LANES);
    }
}

/* A state that no motion moves is looked at half way to a factor of its own accord. */
static void check_field(physics *p, healing *h) {
  h->began = p->b.law->fields.items[h->field]->initial;
  drive_round(p, h);
  if (h->moved) return;
  h->began += 0.5 * h->way;
  drive_round(p, h);
}

void physics_check_healing(physics *p) {
  bench *b = &p->b;
  if (b->law->nonconservative) return;
  healing *h = must_calloc(1, sizeof *h);
  h->states = bench_states(b);
  h->few = bench_states(b);
  for (int k = 0; k < b->field_count && !p->failed[DIAG_HEALING] && !(k && bench_tired(b)); k++) {
    if (b->law->fields.items[k]->kind != SYMBOL_STATE) continue;
    h->field = k;
    h->moved = false;
    h->way = weakening_way(p, k, h->states);
    if (h->way) check_field(p, h);
  }
  bench_states_free(b, h->states);
  bench_states_free(b, h->few);
  free(h);
}
