/* Rays and histories: the states in which a law is looked at. */
#include "generator/check/physics_states.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/check/physics_energy.h"
#include "generator/ir/random_values.h"
#include "generator/lower/lower_inputs.h"

static const double LARGEST_SHORTENING = -0.95; /* a bond has a length */
static const double EXCHANGE_TOLERANCE = 1e-9;  /* the ends' terms are summed in another order */
static const double JUMP_TOLERANCE = 1e-6;      /* of the force, between neighbouring numbers */
static const double DAMAGE_TOLERANCE = 1e-9;

static double limited_stretch(double stretch) {
  return pl_fmin(pl_fmax(stretch, LARGEST_SHORTENING), 10);
}

/* --- drawing ---------------------------------------------------------------------------------- */

static motion draw_anywhere(bench *b) {
  motion m;
  m.at[AXIS_STRETCH] = limited_stretch(draw_size(&b->seed, -7, 0));
  m.at[AXIS_RATE] = draw_size(&b->seed, -3, 5);
  m.at[AXIS_THETA_I] = draw_size(&b->seed, -6, 0);
  m.at[AXIS_THETA_J] = draw_size(&b->seed, -6, 0);
  return m;
}

motion physics_draw_motion(physics *p) {
  bench *b = &p->b;
  motion m = draw_anywhere(b);
  if (!p->scale_count || draw_bits(&b->seed) % 4 == 0) return m;
  const motion *near = &p->scales[draw_bits(&b->seed) % (uint64_t)p->scale_count];
  double factor = pl_pow(10, draw_uniform(&b->seed, -0.5, 0.7));
  for (int k = 0; k < AXIS_COUNT; k++)
    if (near->at[k] != 0 && isfinite(near->at[k]))
      m.at[k] = near->at[k] * factor * (draw_bits(&b->seed) % 4 ? 1 : -1) *
                draw_uniform(&b->seed, 0.5, 1);
  m.at[AXIS_STRETCH] = limited_stretch(m.at[AXIS_STRETCH]);
  return m;
}

motion physics_draw_corner(physics *p, motion amplitude) {
  bench *b = &p->b;
  for (int k = 0; k < AXIS_COUNT; k++)
    amplitude.at[k] *=
        pl_pow(10, draw_uniform(&b->seed, -1, 0)) * (draw_bits(&b->seed) % 2 ? 1 : -1);
  amplitude.at[AXIS_STRETCH] = limited_stretch(amplitude.at[AXIS_STRETCH]);
  amplitude.at[AXIS_RATE] = 0;
  return amplitude;
}

/* --- the pool --------------------------------------------------------------------------------- */

static void keep_state(physics *p, double *const *states, int lane) {
  int at = p->pool_count < POOL_MOST ? p->pool_count++ : (int)(draw_bits(&p->b.seed) % POOL_MOST);
  double *column = p->pool + (size_t)at * (size_t)p->b.width;
  bench_get(&p->b, states, lane, column);
  column[p->b.parameter_count + (int)QUANTITY_DT] = 0;
}

static void keep_scale(physics *p, motion m) {
  const double least = 1e-10; /* guards at 0 have no scale */
  for (int k = 0; k < AXIS_COUNT; k++)
    if (fabs(m.at[k]) < least) m.at[k] = 0;
  int at =
      p->scale_count < SCALES_MOST ? p->scale_count++ : (int)(draw_bits(&p->b.seed) % SCALES_MOST);
  p->scales[at] = m;
}

/* --- rays ------------------------------------------------------------------------------------- */

typedef struct ray {
  const double *column;
  motion from, along;
  double **states;
  double force; /* largest along it */
} ray;

static motion on_ray(const ray *r, double way) {
  motion m;
  for (int k = 0; k < AXIS_COUNT; k++)
    m.at[k] = r->from.at[k] + way * r->along.at[k];
  m.at[AXIS_STRETCH] = limited_stretch(m.at[AXIS_STRETCH]);
  return m;
}

static void put_on_ray(physics *p, const ray *r, int lane, double way) {
  bench_put(&p->b, r->states, lane, r->column);
  bench_move(&p->b, r->states, lane, on_ray(r, way));
}

/* Sizes from 1e-9 to 1, negative ones first. */
static double way_at(int k) {
  enum { HALF = BENCH_LANES / 2 };
  int size = k < HALF ? HALF - 1 - k : k - HALF;
  double way = pl_pow(10, -9 + 9.0 * size / (HALF - 1));
  return k < HALF ? -way : way;
}

static bool same_side(const bench *b, int p, int q) {
  for (int k = 0; k < b->guards.count; k++)
    if ((b->guards.out[k][p] != 0) != (b->guards.out[k][q] != 0)) return false;
  return true;
}

/* Narrows [*before, *after], on whose ends guards differ, to neighbouring numbers. */
static void find_crossing(physics *p, const ray *r, double *before, double *after) {
  for (int round = 0; round < 14 && nextafter(*before, *after) != *after; round++) {
    double way[BENCH_LANES];
    for (int k = 0; k < BENCH_LANES; k++) {
      way[k] = k == BENCH_LANES - 1 ? *after : *before + (*after - *before) * k / (BENCH_LANES - 1);
      put_on_ray(p, r, k, way[k]);
    }
    probe_run(&p->b, &p->b.guards, r->states, BENCH_LANES);
    int k = 1;
    while (k < BENCH_LANES - 1 && same_side(&p->b, 0, k))
      k++;
    if (way[k - 1] == *before && way[k] == *after) return;
    *before = way[k - 1];
    *after = way[k];
  }
}

/* --- continuity ------------------------------------------------------------------------------- */

/* Line of the group that begins at `first` in force in a lane. */
static int line_in_force(const bench *b, int first, int lane) {
  const lowered_text *t = &b->law_step.text;
  int k = first;
  for (; k < t->line_count && t->lines[k].group == t->lines[first].group; k++)
    if (b->guards.out[k][lane] != 0) return t->lines[k].line;
  return t->lines[first].cases->case_count - 1;
}

/* The line at whose end lanes 0 and 1 part; NULL where none does or a jump is meant. */
static const case_line *parting_line(const bench *b) {
  const lowered_text *t = &b->law_step.text;
  const case_line *parting = NULL;
  for (int k = 0; k < t->line_count; k++) {
    if (k > 0 && t->lines[k].group == t->lines[k - 1].group) continue;
    int a = line_in_force(b, k, 0), c = line_in_force(b, k, 1);
    const case_line *lines = t->lines[k].cases->cases;
    for (int q = a < c ? a : c; a != c && q <= (a < c ? c : a); q++)
      if (lines[q].jump) return NULL;
    if (a != c && !parting) parting = &lines[a < c ? a : c];
  }
  return parting;
}

/* A force that a virgin bond would need no stretch worth the name for. */
static bool is_negligible(physics *p, const ray *r, double size) {
  const motion tiny = {{1e-12, 0, 1e-12, 2e-12}};
  bench *b = &p->b;
  double **one = bench_states(b);
  bench_put(b, one, 0, r->column);
  bench_virgin(b, one, 0);
  bench_move(b, one, 0, tiny);
  probe_run(b, &b->frozen, one, 1);
  bool negligible = size < bench_size(b, one, &b->frozen, 0);
  bench_states_free(b, one);
  return negligible;
}

/* Lanes 0 and 1 lie on either side of a guard. */
static void check_continuity(physics *p, const ray *r) {
  bench *b = &p->b;
  const case_line *line = parting_line(b);
  if (!line || p->failed[DIAG_CONTINUITY]) return;
  double size =
      pl_fmax(bench_size(b, r->states, &b->step, 0), bench_size(b, r->states, &b->step, 1));
  for (int k = 0; k < FORCE_COUNT; k++) {
    double weight = k == FORCE_N ? 1 : bench_length(b, r->states, 0);
    double a = b->step.out[k][0], c = b->step.out[k][1];
    if (!(fabs(a - c) > weight * (JUMP_TOLERANCE * size + 1e-9 * r->force)) ||
        is_negligible(p, r, size))
      continue;
    double *column = must_alloc((size_t)b->width * sizeof *column);
    bench_get(b, r->states, 0, column);
    physics_say(p, DIAG_CONTINUITY, line->where, column,
                "the law jumps where this case ends: `%s` goes from %.6g to %.6g %s",
                physics_force_names[k], a, c, physics_force_units[k]);
    diag_hint(
        p->said,
        "let the two values meet, or write `jump` at the end of the line if the jump is meant");
    free(column);
    return;
  }
}

/* --- flow ------------------------------------------------------------------------------------- */

/* Overstress before and after the flow, at the same motion: roots for a probe. */
static void overstress_nodes(bench *b, const lowered_flow *f, ir_node *before, ir_node *after) {
  ir_node old = lower_field(b->graph, b->law, f->field);
  *before = f->overstress;
  ir_substitute(b->graph, &f->overstress, 1, &old, &b->law_step.fields[f->field], 1, after);
}

/* How much the overstress of each lane changes when all fields change by a part in 1e10. */
static void overstress_noise(physics *p, probe *over, const ray *r, int count, double *noise) {
  bench *b = &p->b;
  double **nudged = bench_states(b);
  for (int k = 0; k < b->width; k++)
    for (int lane = 0; lane < count; lane++)
      nudged[k][lane] =
          r->states[k][lane] * (k >= b->parameter_count + QUANTITY_COUNT ? 1 + 1e-10 : 1);
  probe_run(b, over, nudged, count);
  memcpy(noise, over->out[0], (size_t)count * sizeof *noise);
  probe_run(b, over, r->states, count);
  for (int lane = 0; lane < count; lane++)
    noise[lane] = fabs(noise[lane] - over->out[0][lane]);
  bench_states_free(b, nudged);
}

static void check_removed_share(physics *p, const lowered_flow *f, const ray *r, int count) {
  ir_node nodes[2];
  if (f->overstress == IR_NONE || p->failed[DIAG_FLOW]) return;
  overstress_nodes(&p->b, f, &nodes[0], &nodes[1]);
  probe over = probe_new(&p->b, nodes, 2);
  double noise[BENCH_LANES];
  overstress_noise(p, &over, r, count, noise);
  double *column = must_alloc((size_t)p->b.width * sizeof *column);
  for (int lane = 0; lane < count; lane++) {
    double share = (over.out[0][lane] - over.out[1][lane]) / over.out[0][lane];
    bool resolved = over.out[0][lane] > 1e-3 * noise[lane]; /* far above rounding */
    if (!(over.out[0][lane] > 0) || !resolved || (share > 1e-9 && share < 2 - 1e-9)) continue;
    bench_get(&p->b, r->states, lane, column);
    physics_say(p, DIAG_FLOW, f->rule->where, column,
                "this flow removes %.4g of the overstress in a step; it must remove more than 0 "
                "and less than 2",
                share);
    diag_hint(
        p->said,
        share <= 0
            ? "the flow must lower the yield function: look at its sign and at what it changes"
            : "a flow that removes 1 returns to the yield limit; more than 2 runs away");
  }
  free(column);
  probe_free(&over);
}

static void check_plastic_power(physics *p, const lowered_flow *f, const ray *r, int count) {
  double *column = must_alloc((size_t)p->b.width * sizeof *column);
  for (int lane = 0; lane < count && !p->failed[DIAG_FLOW]; lane++) {
    double gain, stored;
    if (!physics_flow_gains(p, r->states, lane, &gain, &stored)) continue;
    bench_get(&p->b, r->states, lane, column);
    physics_say(p, DIAG_FLOW, f->rule->where, column,
                "this flow raises the energy that the bond stores, by %.4g of %.4g J: plastic "
                "power is negative",
                gain, stored);
    diag_hint(p->said, "a flow goes the way the force pulls");
  }
  free(column);
}

/* Way over which the motion changes by as much as it is: the overstress then stands out from
 * rounding. */
static double size_on_ray(const ray *r, double way) {
  motion m = on_ray(r, way);
  double size = 0, reach = 0;
  for (int k = 0; k < AXIS_COUNT; k++)
    if (k != AXIS_RATE) {
      size = pl_fmax(size, fabs(m.at[k]));
      reach = pl_fmax(reach, fabs(r->along.at[k]));
    }
  return reach > 0 ? size / reach : 0;
}

/* Both sides of a yield limit between `before` and `after`, from just beyond it to twice as far. */
static void check_flow(physics *p, const ray *r, double before, double after) {
  static const double beyond[] = {1e-4, 1e-3, 1e-2, 0.1, 0.5};
  enum { COUNT = sizeof beyond / sizeof *beyond };
  bench *b = &p->b;
  const lowered_text *t = &b->law_step.text;
  for (int k = 0; k < t->flow_count && !p->failed[DIAG_FLOW]; k++) {
    double *truth = b->guards.out[t->line_count + k];
    put_on_ray(p, r, 0, before);
    put_on_ray(p, r, 1, after);
    probe_run(b, &b->guards, r->states, 2);
    if ((truth[0] != 0) == (truth[1] != 0)) continue;
    double limit = truth[1] != 0 ? after : before,
           away = truth[1] != 0 ? after - before : before - after;
    double outward = copysign(pl_fmax(fabs(limit), size_on_ray(r, limit)), away);
    for (int q = 0; q < COUNT; q++)
      put_on_ray(p, r, q, limit + outward * beyond[q]);
    probe_run(b, &b->guards, r->states, COUNT);
    int yielding = 0;
    while (yielding < COUNT && b->guards.out[t->line_count + k][yielding] != 0)
      yielding++;
    check_removed_share(p, &t->flows[k], r, yielding);
    check_plastic_power(p, &t->flows[k], r, yielding);
  }
}

/* --- scanning --------------------------------------------------------------------------------- */

static void visit_crossing(physics *p, const ray *r, double before, double after) {
  bench *b = &p->b;
  find_crossing(p, r, &before, &after);
  put_on_ray(p, r, 0, before);
  put_on_ray(p, r, 1, after);
  bench_watch(b, r->states, 2);
  probe_run(b, &b->step, r->states, 2);
  keep_scale(p, on_ray(r, after));
  keep_state(p, r->states, 0);
  keep_state(p, r->states, 1);
  check_continuity(p, r);
  check_flow(p, r, before, after);
}

static void scan_ray(physics *p, ray *r) {
  enum { MOST_CROSSINGS = 4 };
  bench *b = &p->b;
  int crossing[MOST_CROSSINGS], count = 0;
  for (int k = 0; k < BENCH_LANES; k++)
    put_on_ray(p, r, k, way_at(k));
  probe_run(b, &b->step, r->states, BENCH_LANES);
  r->force = 0;
  for (int k = 0; k < BENCH_LANES; k++)
    r->force = pl_fmax(r->force, bench_size(b, r->states, &b->step, k));
  bench_watch(b, r->states, BENCH_LANES);
  int first = (int)(draw_bits(&b->seed) % (BENCH_LANES - 1));
  for (int k = 0; k < BENCH_LANES - 1 && count < MOST_CROSSINGS; k++) {
    int at = (first + k) % (BENCH_LANES - 1);
    if (!same_side(b, at, at + 1)) crossing[count++] = at;
  }
  for (int k = 0; k < count; k++)
    visit_crossing(p, r, way_at(crossing[k]), way_at(crossing[k] + 1));
}

/* One axis, or all with different weights. */
static motion draw_direction(bench *b, int which) {
  static const double reach[AXIS_COUNT] = {1, 1e6, 3, 3};
  motion m = {{0}};
  int axis = which % (2 * AXIS_COUNT);
  for (int k = 0; k < AXIS_COUNT; k++)
    if (axis == k)
      m.at[k] = reach[k];
    else if (axis >= AXIS_COUNT)
      m.at[k] = reach[k] * draw_size(&b->seed, -4, 0);
  return m;
}

void physics_scan(physics *p, int rays, bool from_rest) {
  bench *b = &p->b;
  if (!b->guards.count) return;
  double *column = must_alloc((size_t)b->width * sizeof *column);
  double **states = bench_states(b), **start = bench_states(b);
  for (int k = 0; k < rays && !(k && bench_tired(b)); k++) {
    ray r = {.column = column, .along = draw_direction(b, k), .states = states};
    if (from_rest || !p->pool_count) {
      bench_draw(b, start, k / AXIS_COUNT ? 1 : 0);
      int lane = k / AXIS_COUNT ? 1 : 0;
      bench_virgin(b, start, lane);
      bench_get(b, start, lane, column);
    } else {
      uint64_t at = draw_bits(&b->seed) % (uint64_t)p->pool_count;
      memcpy(column, p->pool + at * (size_t)b->width, (size_t)b->width * sizeof *column);
      bench_put(b, start, 0, column);
      if (k % 2) r.from = bench_motion(b, start, 0);
    }
    scan_ray(p, &r);
  }
  bench_states_free(b, states);
  bench_states_free(b, start);
  free(column);
}

/* --- histories -------------------------------------------------------------------------------- */

enum { AS_IS, EXCHANGED, MIRRORED, VARIANTS, LEG_STEPS = 8 };

typedef struct histories {
  double **states[VARIANTS];
  double force_of[VARIANTS][FORCE_COUNT][BENCH_LANES]; /* the forces */
  motion from[BENCH_LANES], to[BENCH_LANES];
  double force[BENCH_LANES]; /* largest so far */
  double dt[BENCH_LANES];    /* s, of every other lane where the law reads it; else 0 */
  double *column;
} histories;

static void swap(double *a, double *b) {
  double c = *a;
  *a = *b;
  *b = c;
}

static motion seen_as(int variant, motion m) {
  if (variant == EXCHANGED) swap(&m.at[AXIS_THETA_I], &m.at[AXIS_THETA_J]);
  if (variant == MIRRORED) {
    m.at[AXIS_THETA_I] = -m.at[AXIS_THETA_I];
    m.at[AXIS_THETA_J] = -m.at[AXIS_THETA_J];
  }
  return m;
}

static void begin_histories(physics *p, histories *h) {
  bench *b = &p->b;
  memset(h, 0, sizeof *h);
  h->column = must_alloc((size_t)b->width * sizeof *h->column);
  for (int v = 0; v < VARIANTS; v++)
    h->states[v] = bench_states(b);
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    bench_draw(b, h->states[AS_IS], lane);
    bench_virgin(b, h->states[AS_IS], lane);
    bench_get(b, h->states[AS_IS], lane, h->column);
    for (int v = 1; v < VARIANTS; v++)
      bench_put(b, h->states[v], lane, h->column);
    swap(&bench_quantity(b, h->states[EXCHANGED], QUANTITY_M_END_I)[lane],
         &bench_quantity(b, h->states[EXCHANGED], QUANTITY_M_END_J)[lane]);
    bench_turn(b, h->states[EXCHANGED], lane);
  }
}

static void end_histories(physics *p, histories *h) {
  for (int v = 0; v < VARIANTS; v++)
    bench_states_free(&p->b, h->states[v]);
  free(h->column);
}

static void compare_variant(physics *p, histories *h, int lane, int variant, diag_code code) {
  static const int exchanged[FORCE_COUNT] = {FORCE_N, FORCE_M_J, FORCE_M_I};
  bench *b = &p->b;
  double s = bench_length(b, h->states[AS_IS], lane), size = 0;
  for (int k = 0; k < FORCE_COUNT; k++)
    size += (fabs(h->force_of[AS_IS][k][lane]) + fabs(h->force_of[variant][k][lane])) /
            (k == FORCE_N ? 1 : s);
  for (int k = 0; k < FORCE_COUNT && !p->failed[code]; k++) {
    int other = variant == EXCHANGED ? exchanged[k] : k;
    double sign = variant == MIRRORED && k != FORCE_N ? -1 : 1;
    double here = h->force_of[AS_IS][k][lane], there = h->force_of[variant][other][lane];
    double weight = k == FORCE_N ? 1 : s;
    if (!(fabs(here - sign * there) >
          weight * (EXCHANGE_TOLERANCE * size + 1e-13 * h->force[lane])))
      continue;
    const char *name = physics_force_names[k], *in = physics_force_units[k];
    bench_get(b, h->states[AS_IS], lane, h->column);
    if (code == DIAG_EXCHANGE)
      physics_say(p, code, physics_fault(p, k, h->column), h->column,
                  "the law is not the same from both ends: `%s` is %.6g %s, and `%s` with the ends "
                  "exchanged is %.6g %s",
                  name, here, in, physics_force_names[other], there, in);
    else
      physics_say(
          p, code, physics_fault(p, k, h->column), h->column,
          "the law is not the same in a mirror: `%s` is %.6g %s, and %.6g %s with both rotations "
          "reversed; it should %s",
          name, here, in, there, in, k == FORCE_N ? "stay" : "change its sign only");
  }
}

/* What grows in time may do so without end in one of the steps taken here. */
static void check_finite(physics *p, histories *h, int lane) {
  for (int k = 0; k < FORCE_COUNT && h->dt[lane] == 0; k++) {
    if (isfinite(h->force_of[AS_IS][k][lane]) || p->failed[DIAG_NOT_FINITE]) continue;
    bench_get(&p->b, h->states[AS_IS], lane, h->column);
    physics_say(p, DIAG_NOT_FINITE, physics_fault(p, k, h->column), h->column,
                "`%s` is not a finite number in a state that a bond can reach",
                physics_force_names[k]);
  }
}

static void check_damage_range(physics *p, histories *h, int lane) {
  bench *b = &p->b;
  for (int k = 0; k < b->field_count; k++) {
    const symbol *s = b->law->fields.items[k];
    double rule = b->step.out[FORCE_COUNT + b->field_count + k][lane];
    if (s->kind != SYMBOL_DAMAGE || !(rule < -DAMAGE_TOLERANCE || rule > 1 + DAMAGE_TOLERANCE) ||
        p->failed[DIAG_DAMAGE_RANGE])
      continue;
    bench_get(b, h->states[AS_IS], lane, h->column);
    physics_say(p, DIAG_DAMAGE_RANGE, s->rule->where, h->column,
                "the rule of damage `%s` gives %.6g, outside [0, 1]; it is cut off there", s->name,
                rule);
  }
}

static void step_histories(physics *p, histories *h, int step) {
  bench *b = &p->b;
  for (int v = VARIANTS - 1; v >= 0; v--) { /* as it is comes last: its rules are looked at below */
    for (int lane = 0; lane < BENCH_LANES; lane++) {
      motion m = h->to[lane];
      for (int k = 0; k < AXIS_COUNT; k++)
        if (k != AXIS_RATE)
          m.at[k] =
              h->from[lane].at[k] + (h->to[lane].at[k] - h->from[lane].at[k]) * step / LEG_STEPS;
      bench_move(b, h->states[v], lane, seen_as(v, m));
      bench_quantity(b, h->states[v], QUANTITY_DT)[lane] = h->dt[lane];
    }
    probe_run(b, &b->step, h->states[v], BENCH_LANES);
    for (int k = 0; k < FORCE_COUNT; k++)
      memcpy(h->force_of[v][k], b->step.out[k], sizeof h->force_of[v][k]);
    if (v != AS_IS) bench_accept(b, h->states[v], BENCH_LANES);
  }
  bench_watch(b, h->states[AS_IS], BENCH_LANES);
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    check_finite(p, h, lane);
    check_damage_range(p, h, lane);
    compare_variant(p, h, lane, EXCHANGED, DIAG_EXCHANGE);
    if (b->micropolar && !b->law->tree->anisotropic)
      compare_variant(p, h, lane, MIRRORED, DIAG_MIRROR);
    h->force[lane] = pl_fmax(h->force[lane], bench_size(b, h->states[AS_IS], &b->step, lane));
    if (draw_bits(&b->seed) % 16 == 0 && (h->dt[lane] == 0 || isfinite(h->force[lane])))
      keep_state(p, h->states[AS_IS], lane);
  }
  bench_accept(b, h->states[AS_IS], BENCH_LANES);
}

void physics_histories(physics *p, int legs) {
  histories *h = must_alloc(sizeof *h);
  begin_histories(p, h);
  for (int leg = 0; leg < legs && !(leg && bench_tired(&p->b)); leg++) {
    for (int lane = 0; lane < BENCH_LANES; lane++) {
      h->from[lane] = h->to[lane];
      h->to[lane] = physics_draw_motion(p);
      if (p->b.reads_time && lane % 2) h->dt[lane] = pl_pow(10, draw_uniform(&p->b.seed, -8, 8));
    }
    for (int step = 1; step <= LEG_STEPS; step++)
      step_histories(p, h, step);
  }
  end_histories(p, h);
  free(h);
}
