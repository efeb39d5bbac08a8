#include "generator/sense/sense_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/check/physics_point_bench.h"
#include "generator/ir/random_values.h"
#include "generator/sense/point_text.h"
#include "generator/sense/sense_memory.h"
#include "generator/sense/sense_response.h"

static const double SAME = 1e-9;    /* of a stress or a state */
static const double CLEARLY = 1e-6; /* another stress */
static const double TIME_STEP = 1e-6;

/* --- states that a point reaches -------------------------------------------------------------- */

/* From virgin through some strains, the same way for all sizes; the states are kept. */
static double go_somewhere(point_bench *p, double *strain) {
  enum { STEPS = 4 };
  double to[POINT_MOST];
  const double size = pl_pow(10, draw_uniform(&p->seed, -6, -0.5));
  const int legs = 1 + (int)(draw_bits(&p->seed) % 3);
  point_bench_virgin(p);
  memset(strain, 0, POINT_MOST * sizeof *strain);
  for (int leg = 0; leg < legs; leg++) {
    double from[POINT_MOST], stress[POINT_MOST];
    memcpy(from, strain, sizeof from);
    point_bench_direction(p, size, to);
    for (int step = 1; step <= STEPS; step++) {
      for (int k = 0; k < p->strains; k++)
        strain[k] = from[k] + (to[k] - from[k]) * step / STEPS;
      point_bench_stress(p, strain, stress);
      point_bench_keep(p);
    }
  }
  return size;
}

static bool differ(const point_bench *p, const double *x, const double *y, double by) {
  const double size =
      pl_fmax(point_bench_largest(x, p->strains), point_bench_largest(y, p->strains));
  for (int k = 0; k < p->strains; k++)
    if (fabs(x[k] - y[k]) > by * size) return true;
  return false;
}

static void put_field(point_bench *p, int k, double as) {
  for (int lane = 0; lane < POINT_LANES; lane++)
    p->old_field[k][lane] = as;
}

/* --- states that change nothing --------------------------------------------------------------- */

typedef struct effect {
  bool moves, counts; /* it leaves its initial value; the next step depends on it */
} effect;

/* The fields of one state: a tensor's components follow one another. */
static int fields_of(const symbol_list *fields, int k) {
  int next = k + 1;
  while (next < fields->count && fields->items[k]->component_of && !fields->items[next]->rate_of &&
         fields->items[next]->component_of == fields->items[k]->component_of)
    next++;
  return next - k;
}

/* Whether a state, as it is or at its initial value, makes a difference at that strain. */
static void look_at_state(point_text *t, point_bench *p, int first, int count, const double *strain,
                          effect *e) {
  const symbol_list *fields = &p->law->fields;
  double kept[TENSOR_COMPONENT_COUNT];
  bool moved = false;
  for (int k = 0; k < count; k++) {
    kept[k] = p->old_field[first + k][0];
    moved = moved || kept[k] != fields->items[first + k]->initial;
  }
  if (!moved) return;
  e->moves = true;
  double *with = must_calloc((size_t)t->count, sizeof *with),
         *without = must_calloc((size_t)t->count, sizeof *without);
  point_text_run(t, p, strain, with);
  for (int k = 0; k < count; k++)
    put_field(p, first + k, fields->items[first + k]->initial);
  point_text_run(t, p, strain, without);
  for (int k = 0; k < t->count; k++) {
    const int field = k - LOWERED_STRESSES;
    const bool own = field >= first && field < first + count;
    const double size = k < LOWERED_STRESSES
                            ? pl_fmax(point_bench_largest(with, LOWERED_STRESSES),
                                      point_bench_largest(without, LOWERED_STRESSES))
                            : pl_fmax(fabs(with[k]), fabs(without[k]));
    if (!own && fabs(with[k] - without[k]) > SAME * size) e->counts = true;
  }
  for (int k = 0; k < count; k++)
    put_field(p, first + k, kept[k]);
  free(with);
  free(without);
}

/* A state may be there to be looked at: whether an output depends on it. */
static bool is_seen(point_bench *p, int first, int count, const double *strain) {
  const int outputs = p->law->outputs.count;
  double *with = must_calloc((size_t)outputs + 1, sizeof *with), kept[TENSOR_COMPONENT_COUNT];
  bool seen = false;
  point_bench_strain(p, strain, NULL);
  point_bench_run(p, p->kernel->point_observe, TIME_STEP);
  for (int k = 0; k < outputs; k++)
    with[k] = p->observed[1 + k][0];
  for (int k = 0; k < count; k++) {
    kept[k] = p->old_field[first + k][0];
    put_field(p, first + k, p->law->fields.items[first + k]->initial);
  }
  point_bench_run(p, p->kernel->point_observe, TIME_STEP);
  for (int k = 0; k < outputs; k++)
    seen = seen || fabs(with[k] - p->observed[1 + k][0]) > SAME * fabs(with[k]);
  for (int k = 0; k < count; k++)
    put_field(p, first + k, kept[k]);
  free(with);
  return seen;
}

static void say_effect(sense_bench *b, const symbol *field, const effect *e) {
  const symbol *s = field->component_of ? field->component_of : field;
  if (!e->moves)
    sense_say_never_moves(b, s);
  else if (!e->counts &&
           s != b->law->failed) /* what has failed bears nothing, whatever is written */
    sense_say_without_effect(b, s,
                             "let the stress depend on it; is its limit in the range of strains?");
}

static void look_at_states(point_text *t, point_bench *p, effect *seen) {
  enum { ROUNDS = 160 };
  const symbol_list *fields = &p->law->fields;
  bool all = false;
  for (int round = 0; round < ROUNDS && !all; round++) {
    double strain[POINT_MOST], next[POINT_MOST];
    const double size = go_somewhere(p, strain);
    point_bench_direction(p, size * draw_uniform(&p->seed, 0, 1), next);
    all = true;
    for (int k = 0; k < fields->count; k += fields_of(fields, k)) {
      const int count = fields_of(fields, k);
      if (!seen[k].counts) look_at_state(t, p, k, count, next, &seen[k]);
      if (!seen[k].counts && fields->items[k]->kind == SYMBOL_STATE)
        seen[k].counts = is_seen(p, k, count, next);
      all = all && seen[k].counts;
    }
  }
}

static void check_effects(sense_bench *b, point_bench *p) {
  const symbol_list *fields = &b->law->fields;
  point_text t;
  effect *seen = must_calloc((size_t)fields->count + 1, sizeof *seen);
  if (point_text_open(&t, p)) {
    look_at_states(&t, p, seen);
    for (int k = 0; k < fields->count && b->law->options.count == 0; k += fields_of(fields, k))
      if (point_text_moves(&t, p, k)) say_effect(b, fields->items[k], &seen[k]);
  }
  point_text_close(&t);
  free(seen);
}

/* Damage that neither a pull nor a push with free sides brings. */
static void check_weakening(sense_bench *b) {
  static response r;
  const symbol *damage = b->law->failed;
  for (int k = 0; k < b->law->fields.count; k++) {
    const symbol *s = b->law->fields.items[k];
    if (s->kind == SYMBOL_DAMAGE) damage = damage ? damage : s;
    if (s->kind == SYMBOL_STATE) return;
  }
  if (!damage || b->law->options.count > 0) return;
  for (int sign = 1; sign >= -1; sign -= 2)
    if (!response_of(b, b->parameters, sign, &r) || r.limit >= 0) return;
  sense_say(b, DIAG_ELASTIC, damage->rule ? damage->rule->where : damage->where,
            "look at the sign and the limit in its condition",
            "neither pulled nor pushed does a point lose anything, up to a strain of 1: `%s` is "
            "never reached there",
            damage->name);
}

/* --- a step late ------------------------------------------------------------------------------ */

static bool fields_differ(const point_bench *p, double *const *x, double *const *y, double by) {
  for (int k = 0; k < p->law->fields.count; k++)
    if (!p->law->fields.items[k]->rate_of &&
        fabs(x[k][0] - y[k][0]) > by * pl_fmax(fabs(x[k][0]), fabs(y[k][0])))
      return true;
  return false;
}

static void check_lateness(sense_bench *b, point_bench *p) {
  enum { ROUNDS = 120 };
  point_text t;
  sense_held held = {0};
  sense_reads reads = {false, false};
  if (point_text_open(&t, p))
    reads = sense_forces_read(t.graph, &p->setting, t.step.sigma, LOWERED_STRESSES, t.step.fields);
  point_text_close(&t);
  for (int round = 0; round < ROUNDS; round++) {
    double strain[POINT_MOST], next[POINT_MOST], once[POINT_MOST], twice[POINT_MOST];
    if (p->reads_time) p->advance = pl_pow(10, draw_uniform(&p->seed, -8, 8));
    const double size = go_somewhere(p, strain);
    point_bench_direction(p, 2 * size, next);
    point_bench_stress(p, next, once);
    const bool moved = fields_differ(p, p->old_field, p->new_field, CLEARLY);
    point_bench_keep(p);
    p->advance = 0;
    point_bench_stress(p, next, twice);
    if (!fields_differ(p, p->old_field, p->new_field, SAME))
      sense_hold(&held, moved, differ(p, once, twice, CLEARLY));
  }
  sense_say_held(b, &held, reads);
}

/* --- energies --------------------------------------------------------------------------------- */

/* J/m^3, with the fields at hand. */
static double stored(point_bench *p, const double *strain) {
  point_bench_strain(p, strain, NULL);
  point_bench_run(p, p->kernel->point_observe, TIME_STEP);
  return p->observed[0][0];
}

/* Sheared and back, in a time (s; 0 of laws that read none): what the steps lose, by the law's own
   energy. */
static sense_losses sheared(point_bench *p, double amplitude, double time, int steps) {
  const int shear = p->strains == 3 ? 2 : 3;
  double strain[POINT_MOST] = {0}, before = 0, kept, stress[POINT_MOST];
  sense_losses losses = {0, 0};
  point_bench_virgin(p);
  point_bench_stress(p, strain, stress);
  if (p->reads_time) point_bench_keep(p); /* how quickly states begin to change */
  kept = stored(p, strain);
  for (int step = 1; step <= 2 * steps; step++) {
    const int part = step <= steps ? step : 2 * steps - step;
    const double next = amplitude * part / steps;
    double change[POINT_MOST] = {0}, mean[POINT_MOST] = {0}, size = 0;
    change[shear] = next - strain[shear];
    strain[shear] = next;
    p->advance = time / steps;
    point_bench_stress(p, strain, stress);
    p->advance = 0;
    point_bench_keep(p);
    mean[shear] = 0.5 * (stress[shear] + before);
    before = stress[shear];
    const double work = point_bench_work(p, mean, change, &size), left = stored(p, strain);
    sense_lose(&losses, work, work - (left - kept));
    kept = left;
  }
  return losses;
}

/* By amplitudes of many sizes, in many times. */
static void check_locked_energy(sense_bench *b, point_bench *p) {
  enum { SIZES = 12, STEPS = 200 };
  if (!b->law->results[RESULT_W] || !b->law->results[RESULT_SIGMA] || b->law->nonconservative)
    return;
  bool said = false;
  for (int size = 0; size < SIZES && !said; size++) {
    const double amplitude = pl_pow(10, -4 + 3.7 * size / (SIZES - 1));
    const double time =
        p->reads_time ? pl_pow(10, -6 + 15.0 * (size * 5 % SIZES) / (SIZES - 1)) : 0;
    const sense_losses losses = sheared(p, amplitude, time, STEPS);
    if (!sense_gains(&losses)) continue;
    const sense_losses finer = sheared(p, amplitude, time, 4 * STEPS);
    char way[64];
    snprintf(way, sizeof way, "sheared by %.3g", amplitude);
    said =
        sense_say_losses(b, &losses, &finer, way,
                         p->reads_time ? "add the springs beside the dashpots, as `mu_1*(e_v:e_v)`"
                                       : "add what the states lock in, as `H/3*(eps_p:eps_p)` of a "
                                         "linear kinematic hardening");
  }
}

void sense_check_points(sense_bench *b) {
  const physics_options with = {.parameters = b->parameters};
  physics_report unwanted = {0};
  point_bench *p = must_calloc(1, sizeof *p);
  *p = (point_bench){.law = b->law, .said = b->said, .report = &unwanted, .seed = 20260102};
  const law_setting setting = law_is_for(b->law, SETTING_SPACE) ? SETTING_SPACE : b->law->setting;
  if (point_bench_open(p, setting)) {
    point_bench_parameters(p, &with, true);
    if (!p->reads_time) check_effects(b, p); /* what needs an hour does not show in a step */
    if (!p->reads_time) check_weakening(b);
    if (!p->kernel->reads_rates) check_lateness(b, p);
    if (!p->kernel->reads_rates && b->law->fields.count > 0 && !b->said_of[DIAG_ONE_STEP_LATE])
      check_locked_energy(b, p);
  }
  point_bench_close(p);
  free(p);
}
