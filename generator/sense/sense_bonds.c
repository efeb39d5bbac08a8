#include "generator/sense/sense_bonds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/semantics/law_reads.h"
#include "generator/check/physics_states.h"
#include "generator/ir/random_values.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/lower_rest.h"
#include "generator/sense/sense_memory.h"

static const double SAME = 1e-9;          /* of a force or a state */
static const double OFF_THE_LIMIT = 0.01; /* of an overstress that is small */
static const double CLEARLY = 1e-6;       /* another force */

/* The law on single bonds, with states that they reach; what the drives say is dropped. */
typedef struct memory_bench {
  sense_bench *of;
  physics *p;
  bench *b;
  double **states, **others;
  diagnostics unsaid;
} memory_bench;

/* --- opening ---------------------------------------------------------------------------------- */

static bool memory_open(memory_bench *m, sense_bench *of) {
  enum { RAYS = 48, LEGS = 12 };
  *m = (memory_bench){.of = of, .p = must_calloc(1, sizeof *m->p)};
  diag_begin(&m->unsaid, of->said->sources);
  m->p->said = &m->unsaid;
  m->b = &m->p->b;
  if (!bench_open(m->b, of->law, of->options, &m->unsaid)) return false;
  m->p->pool = must_alloc((size_t)POOL_MOST * (size_t)m->b->width * sizeof *m->p->pool);
  m->states = bench_states(m->b);
  m->others = bench_states(m->b);
  bench_allow(m->b, 0.2);
  physics_scan(m->p, RAYS, true);
  physics_histories(m->p, LEGS);
  bench_allow(m->b, 0.5);
  return true;
}

static void memory_close(memory_bench *m) {
  if (m->states) {
    bench_states_free(m->b, m->states);
    bench_states_free(m->b, m->others);
    bench_close(m->b);
  }
  free(m->p->pool);
  free(m->p);
  diag_clear(&m->unsaid);
}

/* --- rows of states --------------------------------------------------------------------------- */

/* Forces of a probe: [FORCE_COUNT][BENCH_LANES]. */
typedef double forces_of[FORCE_COUNT][BENCH_LANES];

static void run(memory_bench *m, probe *which, double *const *states, forces_of out) {
  probe_run(m->b, which, states, BENCH_LANES);
  for (int f = 0; f < FORCE_COUNT; f++)
    memcpy(out[f], which->out[f], sizeof out[f]);
}

/* Of moments by the bond's length. */
static double weight_of(const memory_bench *m, double *const *states, int f, int lane) {
  return f == FORCE_N ? 1 : bench_length(m->b, states, lane);
}

static double size_of(const memory_bench *m, double *const *states, forces_of x, int lane) {
  double size = 0;
  for (int f = 0; f < FORCE_COUNT; f++)
    size += fabs(x[f][lane]) / weight_of(m, states, f, lane);
  return size;
}

static bool differ(const memory_bench *m, double *const *states, forces_of x, forces_of y, int lane,
                   double by) {
  const double size = pl_fmax(size_of(m, states, x, lane), size_of(m, states, y, lane));
  for (int f = 0; f < FORCE_COUNT; f++)
    if (fabs(x[f][lane] - y[f][lane]) > by * size * weight_of(m, states, f, lane)) return true;
  return false;
}

/* Another motion: drawn, half of the times a pure one. */
static motion draw_motion(memory_bench *m, int k) {
  motion at = physics_draw_motion(m->p);
  at.at[AXIS_RATE] = 0;
  if (k % 4 == 1) at.at[AXIS_THETA_I] = at.at[AXIS_THETA_J] = 0;
  if (k % 4 == 3) at.at[AXIS_STRETCH] = 0;
  return at;
}

/* s; of laws that read no time 0. */
static double draw_time(memory_bench *m) {
  return m->b->reads_time ? pl_pow(10, draw_uniform(&m->b->seed, -8, 8)) : 0;
}

/* Lanes from the pool, from number `first` on, at their own motion or at another, in some time. */
static void take_from_pool(memory_bench *m, int first, bool own) {
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    const int at = (first + lane) % m->p->pool_count;
    bench_put(m->b, m->states, lane, m->p->pool + (size_t)at * (size_t)m->b->width);
    if (own) {
      bench_quantity(m->b, m->states, QUANTITY_STRETCH_RATE)[lane] = 0;
    } else {
      bench_move(m->b, m->states, lane, draw_motion(m, lane));
    }
    bench_quantity(m->b, m->states, QUANTITY_DT)[lane] = draw_time(m);
  }
}

/* The virgin bond with the defaults, in all lanes. */
static void put_virgins(memory_bench *m) {
  bench_draw(m->b, m->states, 0);
  bench_virgin(m->b, m->states, 0);
  for (int k = 0; k < m->b->width; k++)
    for (int lane = 1; lane < BENCH_LANES; lane++)
      m->states[k][lane] = m->states[k][0];
}

static void copy_states(memory_bench *m) {
  for (int k = 0; k < m->b->width; k++)
    memcpy(m->others[k], m->states[k], BENCH_LANES * sizeof(double));
}

/* --- states that change nothing --------------------------------------------------------------- */

enum { PURE_TENSION, PURE_BENDING, PURE_SHEAR, PURE_COUNT };

typedef struct effect {
  bool moves;                              /* it leaves its initial value */
  bool on_forces;                          /* the forces with all fields held depend on it */
  bool on_others;                          /* another field's new value does */
  bool on_step;                            /* the forces of a step do */
  int grown[PURE_COUNT], felt[PURE_COUNT]; /* growths, and those that the force there feels */
} effect;

static void look_for_movement(memory_bench *m, effect *seen) {
  for (int at = 0; at < m->p->pool_count; at++)
    for (int k = 0; k < m->b->field_count; k++) {
      const double *column = m->p->pool + (size_t)at * (size_t)m->b->width;
      if (column[m->b->parameter_count + QUANTITY_COUNT + k] != m->b->law->fields.items[k]->initial)
        seen[k].moves = true;
    }
}

/* Whether field f is field k, or its rate. */
static bool is_own(const law *l, int f, int k) {
  return f == k || l->fields.items[f]->rate_of == l->fields.items[k];
}

/* Forces and new fields with field k as it is and at its initial value. */
static void look_for_effect(memory_bench *m, int k, effect *e) {
  forces_of held, held_less, step, step_less;
  const int fields = m->b->field_count;
  double *after = must_alloc((size_t)fields * BENCH_LANES * sizeof *after);
  copy_states(m);
  for (int lane = 0; lane < BENCH_LANES; lane++)
    bench_field(m->b, m->others, k)[lane] = m->b->law->fields.items[k]->initial;
  run(m, &m->b->frozen, m->states, held);
  run(m, &m->b->frozen, m->others, held_less);
  run(m, &m->b->step, m->states, step);
  for (int f = 0; f < fields; f++)
    memcpy(after + f * BENCH_LANES, m->b->step.out[FORCE_COUNT + f], BENCH_LANES * sizeof *after);
  run(m, &m->b->step, m->others, step_less);
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    e->on_forces = e->on_forces || differ(m, m->states, held, held_less, lane, SAME);
    e->on_step = e->on_step || differ(m, m->states, step, step_less, lane, SAME);
    for (int f = 0; f < fields; f++) {
      const double x = after[f * BENCH_LANES + lane], y = m->b->step.out[FORCE_COUNT + f][lane];
      if (!is_own(m->b->law, f, k) && fabs(x - y) > SAME * pl_fmax(fabs(x), fabs(y)))
        e->on_others = true;
    }
  }
  free(after);
}

static motion pure_motion(int which, double size) {
  motion m = {{0}};
  if (which == PURE_TENSION) m.at[AXIS_STRETCH] = size;
  if (which != PURE_TENSION) m.at[AXIS_THETA_I] = size;
  if (which != PURE_TENSION) m.at[AXIS_THETA_J] = which == PURE_BENDING ? -size : size;
  return m;
}

/* Growths of field k from `states` to `others`, and which of them the force there feels, with all
   other damages at 0: one may hide another, as in `max(omega_t, omega_c)`. */
static void count_growths(memory_bench *m, int k, int which, effect *e) {
  forces_of old, now;
  const size_t size = BENCH_LANES * sizeof(double);
  const int fields = m->b->field_count;
  double *kept = must_alloc((size_t)fields * size);
  double *grown = bench_field(m->b, m->others, k), *was = bench_field(m->b, m->states, k);
  for (int f = 0; f < fields; f++) {
    memcpy(kept + f * BENCH_LANES, bench_field(m->b, m->others, f), size);
    if (f != k && m->b->law->fields.items[f]->kind == SYMBOL_DAMAGE)
      memset(bench_field(m->b, m->others, f), 0, size);
  }
  run(m, &m->b->frozen, m->others, now);
  memcpy(grown, was, size);
  run(m, &m->b->frozen, m->others, old);
  for (int f = 0; f < fields; f++)
    memcpy(bench_field(m->b, m->others, f), kept + f * BENCH_LANES, size);
  free(kept);
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    if (!(fabs(grown[lane] - was[lane]) > CLEARLY)) continue;
    e->grown[which]++;
    e->felt[which] += differ(m, m->others, now, old, lane, SAME);
  }
}

/* A virgin bond is drawn out, or bent: does the force there know the field that grows? */
static void look_in_pure_motion(memory_bench *m, int which, effect *seen) {
  enum { STEPS = 48 };
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    bench_draw(m->b, m->states, lane);
    bench_virgin(m->b, m->states, lane);
  }
  for (int step = 0; step < STEPS; step++) {
    const double size = pl_pow(10, -7 + 6.7 * step / (STEPS - 1));
    for (int lane = 0; lane < BENCH_LANES; lane++)
      bench_move(m->b, m->states, lane, pure_motion(which, size));
    probe_run(m->b, &m->b->step, m->states, BENCH_LANES);
    copy_states(m);
    bench_accept(m->b, m->others, BENCH_LANES);
    for (int k = 0; k < m->b->field_count; k++)
      count_growths(m, k, which, &seen[k]);
    for (int k = 0; k < m->b->field_count; k++)
      memcpy(bench_field(m->b, m->states, k), bench_field(m->b, m->others, k),
             BENCH_LANES * sizeof(double));
  }
}

/* Whether the law, with the options in force, lets field k follow what the bond undergoes, and its
   forces or other fields follow field k: where it does not, options have decided so, or the text
   says as much. */
typedef struct written {
  bool moves, counts;
  bool on_rest; /* the rest state follows it */
} written;

static written written_of(const memory_bench *m, int k) {
  const bench *b = m->b;
  const ir_node old = lower_field(b->graph, b->law, k), now = b->law_step.fields[k];
  const lowered_law *f = &b->law_frozen;
  const ir_node forces[] = {f->N, f->M_i[0], f->M_j[0]};
  written w = {.moves = now != old && !ir_is_uniform(b->graph, now)};
  w.on_rest = f->rest != IR_NONE && rewrite_depends(b->graph, &f->rest, 1, &old, 1);
  w.counts = w.on_rest || rewrite_depends(b->graph, forces, FORCE_COUNT, &old, 1);
  for (int q = 0; q < b->field_count; q++)
    if (!is_own(b->law, q, k) && rewrite_depends(b->graph, &b->law_step.fields[q], 1, &old, 1))
      w.counts = true;
  return w;
}

/* A state may be there to be looked at: whether an output depends on it. */
static bool is_seen(memory_bench *m, int k) {
  const int outputs = m->b->law->outputs.count;
  bool seen = false;
  probe shown = probe_new(m->b, m->b->law_frozen.outputs, outputs);
  double *with = must_calloc((size_t)outputs * BENCH_LANES + 1, sizeof *with);
  for (int round = 0; round < 8 && !seen && outputs > 0; round++) {
    take_from_pool(m, round * BENCH_LANES, true);
    probe_run(m->b, &shown, m->states, BENCH_LANES);
    for (int o = 0; o < outputs; o++)
      memcpy(with + o * BENCH_LANES, shown.out[o], BENCH_LANES * sizeof *with);
    for (int lane = 0; lane < BENCH_LANES; lane++)
      bench_field(m->b, m->states, k)[lane] = m->b->law->fields.items[k]->initial;
    probe_run(m->b, &shown, m->states, BENCH_LANES);
    for (int o = 0; o < outputs; o++)
      for (int lane = 0; lane < BENCH_LANES; lane++) {
        const double x = with[o * BENCH_LANES + lane], y = shown.out[o][lane];
        seen = seen || fabs(x - y) > SAME * pl_fmax(fabs(x), fabs(y));
      }
  }
  probe_free(&shown);
  free(with);
  return seen;
}

static int count_damages(const law *l) {
  int count = 0;
  for (int k = 0; k < l->fields.count; k++)
    count += l->fields.items[k]->kind == SYMBOL_DAMAGE;
  return count;
}

static void say_effect(memory_bench *m, int k, const effect *e) {
  enum { FEW = 8 };
  const symbol *s = m->b->law->fields.items[k];
  const bool options = m->b->law->options.count > 0;
  const written w = written_of(m, k);
  if (s->rate_of) return; /* it belongs to the state whose rate it is */
  if (!w.moves || (options && !w.counts)) return;
  char mend[256];
  const span where = s->rule ? s->rule->where : s->where;
  if (!e->moves) {
    sense_say_never_moves(m->of, s);
  } else if (!e->on_forces && !e->on_others && !e->on_step && !w.on_rest) {
    if (s->kind == SYMBOL_STATE && is_seen(m, k)) return;
    snprintf(mend, sizeof mend, "let the force depend on it, as in `(1 - %s)*...`", s->name);
    sense_say_without_effect(m->of, s, s->kind == SYMBOL_DAMAGE ? mend : NULL);
  } else if (s->kind == SYMBOL_DAMAGE && e->on_forces) {
    const int damages = count_damages(m->b->law); /* several may share tension and bending */
    for (int which = 0; which < (damages > 1 ? 1 : PURE_COUNT); which++) {
      if (e->grown[which] < FEW || e->felt[which] > 0) continue;
      snprintf(mend, sizeof mend, "let the %s carry `(1 - %s)`%s",
               which == PURE_TENSION ? "force in tension" : "moments", s->name,
               which == PURE_TENSION ? "; are the branches of a case swapped?" : "");
      sense_say(m->of, DIAG_ELASTIC, where, mend,
                "the damage `%s` grows as a bond is %s, but never weakens it there", s->name,
                which == PURE_TENSION ? "drawn out" : "bent");
    }
  }
}

/* Half of the lanes on their way. */
static void set_going(memory_bench *m) {
  for (int lane = 1; lane < BENCH_LANES; lane += 2)
    bench_quantity(m->b, m->states, QUANTITY_STRETCH_RATE)[lane] = draw_size(&m->b->seed, -3, 5);
}

/* A tensor or vector is one state: what one of its components does, all do. */
static void share_effects(const law *l, effect *seen) {
  for (int p = 0; p < l->fields.count; p++)
    for (int q = 0; q < p; q++) {
      const symbol *one = l->fields.items[p], *other = l->fields.items[q];
      if (!one->component_of || one->component_of != other->component_of || one->rate_of ||
          other->rate_of)
        continue;
      seen[p].moves = seen[q].moves = seen[p].moves || seen[q].moves;
      seen[p].on_forces = seen[q].on_forces = seen[p].on_forces || seen[q].on_forces;
      seen[p].on_others = seen[q].on_others = seen[p].on_others || seen[q].on_others;
      seen[p].on_step = seen[q].on_step = seen[p].on_step || seen[q].on_step;
    }
}

static void check_effects(memory_bench *m) {
  enum {
    ROUNDS = 24,
    MOST_FIELDS = 64
  }; /* each is tried against all: more are not written by hand */
  if (m->b->field_count > MOST_FIELDS) return;
  effect *seen = must_calloc((size_t)m->b->field_count + 1, sizeof *seen);
  look_for_movement(m, seen);
  for (int k = 0; k < m->b->field_count; k++)
    for (int round = 0; round < ROUNDS && !(seen[k].on_forces || (round && bench_tired(m->b)));
         round++) {
      take_from_pool(m, round * BENCH_LANES / 2, round % 2 == 0);
      set_going(m);
      look_for_effect(m, k, &seen[k]);
    }
  for (int which = 0; which < (m->b->micropolar ? PURE_COUNT : 1); which++)
    look_in_pure_motion(m, which, seen);
  share_effects(m->b->law, seen);
  for (int k = 0; k < m->b->field_count; k++)
    say_effect(m, k, &seen[k]);
  free(seen);
}

/* --- a step late ------------------------------------------------------------------------------ */

/* Whether the fields are the same after a second step at the same motion; *moved: after the first
   they were others. */
static bool settled(const memory_bench *m, int lane, bool *moved) {
  bool same = true;
  *moved = false;
  for (int k = 0; k < m->b->field_count; k++) {
    if (m->b->law->fields.items[k]->rate_of) continue;
    const double old = bench_field(m->b, m->states, k)[lane],
                 once = bench_field(m->b, m->others, k)[lane],
                 twice = m->b->step.out[FORCE_COUNT + k][lane];
    const double size = pl_fmax(fabs(once), fabs(twice));
    same = same && fabs(once - twice) <= 1e-12 * size;
    *moved = *moved || fabs(once - old) > CLEARLY * pl_fmax(size, fabs(old));
  }
  return same;
}

/* Fields that stay in a second step at the same motion, in which no time goes on, are the new ones;
   a force that changes all the same was made of the old ones, or of the step itself. */
static void check_lateness(memory_bench *m) {
  enum { ROUNDS = 8 };
  const bench *b = m->b;
  const ir_node of_step[] = {b->law_step.N, b->law_step.M_i[0], b->law_step.M_j[0]};
  const sense_reads reads =
      sense_forces_read(b->graph, b->law, of_step, FORCE_COUNT, b->law_step.fields);
  forces_of once, twice;
  sense_held held = {0};
  for (int round = 0; round < ROUNDS && !bench_tired(m->b); round++) {
    take_from_pool(m, round * BENCH_LANES, false);
    run(m, &m->b->step, m->states, once);
    copy_states(m);
    bench_accept(m->b, m->others, BENCH_LANES);
    memset(bench_quantity(b, m->others, QUANTITY_DT), 0, BENCH_LANES * sizeof(double));
    run(m, &m->b->step, m->others, twice);
    for (int lane = 0; lane < BENCH_LANES; lane++) {
      bool moved;
      if (settled(m, lane, &moved))
        sense_hold(&held, moved, differ(m, m->states, once, twice, lane, CLEARLY));
    }
  }
  sense_say_held(m->of, &held, reads);
}

/* --- a stress as a state ---------------------------------------------------------------------- */

static void check_stress_state(memory_bench *m) {
  forces_of held, step;
  const double small = 1e-9;
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    bench_draw(m->b, m->states, lane);
    bench_virgin(m->b, m->states, lane);
    bench_move(m->b, m->states, lane, (motion){.at[AXIS_STRETCH] = lane % 2 ? small : -small});
  }
  run(m, &m->b->frozen, m->states, held);
  run(m, &m->b->step, m->states, step);
  for (int lane = 0; lane < BENCH_LANES; lane++)
    if (held[FORCE_N][lane] != 0 || step[FORCE_N][lane] == 0) return;
  const symbol *kept = NULL;
  for (int k = 0; k < m->b->field_count; k++) {
    const symbol *s = m->b->law->fields.items[k];
    if (dim_equal(s->dim, dimension_of("Pa")) || dim_equal(s->dim, dimension_of("N"))) kept = s;
  }
  if (!kept) return;
  sense_say(m->of, DIAG_STRESS_STATE, kept->rule ? kept->rule->where : kept->where,
            "keep the strain that stays as the state, and let the force be a stiffness times "
            "(stretch - that)",
            "the force is kept as the state `%s`: with its states held the bond has no stiffness, "
            "and so stores nothing",
            kept->name);
}

/* --- softening without memory ----------------------------------------------------------------- */

static void check_reversible(memory_bench *m) {
  enum { STEPS = BENCH_LANES };
  const law *l = m->b->law;
  if (m->b->field_count > 0 || l->nonconservative || l->results[RESULT_W]) return;
  forces_of out;
  double peak = 0, least = INFINITY;
  put_virgins(m);
  for (int lane = 0; lane < STEPS; lane++)
    bench_move(m->b, m->states, lane,
               (motion){.at[AXIS_STRETCH] = pl_pow(10, -6 + 5.7 * lane / (STEPS - 1))});
  run(m, &m->b->step, m->states, out);
  for (int lane = 0; lane < STEPS; lane++) {
    if (out[FORCE_N][lane] > peak) {
      peak = out[FORCE_N][lane];
      least = INFINITY;
    }
    least = pl_fmin(least, out[FORCE_N][lane]);
  }
  if (!(peak > 0) || !(least < 0.5 * peak)) return;
  sense_say(m->of, DIAG_REVERSIBLE, sense_force(l),
            "declare what is lost as `damage x`, or keep the largest stretch in a `state`",
            "this law softens and remembers nothing: drawn out, the force falls from %.4g to %.4g "
            "N, and it comes back as the bond closes",
            peak, least);
}

/* --- flows that miss their limit -------------------------------------------------------------- */

/* Time in a parameter: such a flow may go slowly on purpose. */
static bool knows_time(const law *l) {
  for (int k = 0; k < l->parameters.count; k++) {
    const dimension d = l->parameters.items[k]->dim;
    if (d.twelfths[2] != 0 && d.twelfths[2] != -24) return true;
  }
  return law_reads_time(l) || law_reads(l, QUANTITY_STRETCH_RATE) ||
         law_reads(l, QUANTITY_SLIP_RATE);
}

/* Overstress of flow f before and after, with all new fields, at the same motion. */
static probe open_overstress(memory_bench *m, const lowered_flow *f) {
  bench *b = m->b;
  ir_node nodes[2] = {f->overstress, IR_NONE};
  ir_node *old = must_alloc((size_t)b->field_count * sizeof *old);
  for (int k = 0; k < b->field_count; k++)
    old[k] = lower_field(b->graph, b->law, k);
  ir_substitute(b->graph, &f->overstress, 1, old, b->law_step.fields, b->field_count, &nodes[1]);
  free(old);
  return probe_new(b, nodes, 2);
}

/* The virgin bond, moved along `axis` by `size`, in lane 0: the overstress. */
static double overstress_at(memory_bench *m, probe *over, bench_axis axis, double size) {
  motion at = {{0}};
  at.at[axis] = size;
  bench_virgin(m->b, m->states, 0);
  bench_move(m->b, m->states, 0, at);
  if (axis == AXIS_THETA_I) bench_quantity(m->b, m->states, QUANTITY_THETA_J)[0] = size;
  probe_run(m->b, over, m->states, 1);
  return over->out[0][0];
}

static double share_at(memory_bench *m, probe *over, bench_axis axis, double size) {
  overstress_at(m, over, axis, size);
  return (over->out[0][0] - over->out[1][0]) / over->out[0][0];
}

/* The share of a small overstress that the flow removes; NaN where the axis does not make it yield,
   and where it removes less because it is not linear: such a flow comes near by and by. */
static double share_just_beyond(memory_bench *m, probe *over, bench_axis axis) {
  double low = 1e-9, high = 1e-9;
  if (!(overstress_at(m, over, axis, low) < 0)) return NAN;
  while (high < 1 && !(overstress_at(m, over, axis, high) > 0))
    high *= 1.3;
  if (high >= 1) return NAN;
  for (int k = 0; k < 50; k++) {
    const double middle = 0.5 * (low + high);
    *(overstress_at(m, over, axis, middle) > 0 ? &high : &low) = middle;
  }
  const double little = share_at(m, over, axis, high * 1.001),
               much = share_at(m, over, axis, high * 2);
  return little > 1 || fabs(little - much) <= CLEARLY ? little : NAN;
}

static void check_flows(memory_bench *m) {
  const lowered_text *t = &m->b->law_step.text;
  if (knows_time(m->b->law)) return;
  bench_draw(m->b, m->states, 0);
  for (int k = 0; k < t->flow_count; k++) {
    if (t->flows[k].overstress == IR_NONE || t->flows[k].rule->returned) continue;
    probe over = open_overstress(m, &t->flows[k]);
    for (int axis = AXIS_STRETCH; axis <= AXIS_THETA_I; axis += AXIS_THETA_I - AXIS_STRETCH) {
      const double share = share_just_beyond(m, &over, (bench_axis)axis);
      if (!isfinite(share) || fabs(share - 1) <= OFF_THE_LIMIT) continue;
      sense_say(m->of, DIAG_STEP_DEPENDENT, t->flows[k].rule->where,
                "divide the overstress by all that the flow takes from it: the stiffness and the "
                "slope of the hardening",
                "this flow removes %.4g of a small overstress, not all of it: what the bond does "
                "depends on how many steps there are",
                share);
    }
    probe_free(&over);
  }
}

/* --- energies --------------------------------------------------------------------------------- */

/* How far lane `lane` is drawn out, and in what time (s). */
static double amplitude_of(int lane) {
  return pl_pow(10, -5 + 4.7 * lane / (BENCH_LANES - 1));
}

static double time_of(int lane) {
  return pl_pow(10, -6 + 15.0 * ((lane * 5) % BENCH_LANES) / (BENCH_LANES - 1));
}

typedef struct drawn {
  probe energy;
  double force[BENCH_LANES], stored[BENCH_LANES];
  sense_losses lost[BENCH_LANES];
} drawn;

static void look_at_energy(memory_bench *m, drawn *d, double *stored) {
  probe_run(m->b, &d->energy, m->states, BENCH_LANES);
  memcpy(stored, d->energy.out[0], BENCH_LANES * sizeof *stored);
}

/* To the share `to` of the way, from `from`. */
static void draw_by(memory_bench *m, drawn *d, double from, double to) {
  bench *b = m->b;
  double now[BENCH_LANES], stored[BENCH_LANES];
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    bench_move(b, m->states, lane, (motion){.at[AXIS_STRETCH] = amplitude_of(lane) * to});
    if (b->reads_time)
      bench_quantity(b, m->states, QUANTITY_DT)[lane] = time_of(lane) * fabs(to - from);
  }
  probe_run(b, &b->step, m->states, BENCH_LANES);
  memcpy(now, b->step.out[FORCE_N], sizeof now);
  bench_accept(b, m->states, BENCH_LANES);
  look_at_energy(m, d, stored);
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    const double way = (to - from) * amplitude_of(lane) * bench_length(b, m->states, lane);
    const double work = 0.5 * (d->force[lane] + now[lane]) * way;
    sense_lose(&d->lost[lane], work, work - (stored[lane] - d->stored[lane]));
    d->force[lane] = now[lane];
    d->stored[lane] = stored[lane];
  }
}

static void draw_out_and_back(memory_bench *m, drawn *d, int steps) {
  bench *b = m->b;
  *d = (drawn){.energy = probe_new(b, &b->law_frozen.W, 1)};
  put_virgins(m);
  look_at_energy(m, d, d->stored);
  draw_by(m, d, 0, 0); /* how quickly states begin to change */
  for (int step = 1; step <= steps; step++)
    draw_by(m, d, (step - 1.0) / steps, (double)step / steps);
  for (int step = steps; step > 0; step--)
    draw_by(m, d, (double)step / steps, (step - 1.0) / steps);
  probe_free(&d->energy);
}

/* Drawn out and back by amplitudes of many sizes, a bond loses: work less what the law's energy
   grows by. Steps that lose less than nothing say that the energy lacks something. A rest state
   that moves does work of its own. */
static void check_locked_energy(memory_bench *m) {
  enum { STEPS = 400 };
  bench *b = m->b;
  if (b->law_frozen.W == IR_NONE || b->law->nonconservative || b->law->tree->law == LAW_SLIP_BOND ||
      rest_reads_states(b->graph, b->law, &b->law_frozen.rest,
                        b->law_frozen.rest != IR_NONE))
    return;
  drawn d, finer;
  bool gains = false, said = false;
  draw_out_and_back(m, &d, STEPS);
  for (int lane = 0; lane < BENCH_LANES; lane++)
    gains = gains || sense_gains(&d.lost[lane]);
  if (!gains) return;
  draw_out_and_back(m, &finer, 4 * STEPS);
  for (int lane = 0; lane < BENCH_LANES && !said; lane++)
    said = sense_say_losses(
        m->of, &d.lost[lane], &finer.lost[lane], "drawn out",
        b->reads_time ? "add the springs beside the dashpots, as `E_1/2*v**2`"
                      : "add what the states lock in, as `H/2*x**2` of a linear hardening");
}

void sense_check_bonds(sense_bench *b) {
  memory_bench m;
  if (memory_open(&m, b)) {
    check_reversible(&m);
    if (!m.b->reads_time) check_stress_state(&m); /* what goes by a rate moves in time alone */
    if (m.p->pool_count > 0) {
      check_effects(&m);
      if (!b->said_of[DIAG_STRESS_STATE]) check_lateness(&m);
      check_flows(&m);
      if (!b->said_of[DIAG_ONE_STEP_LATE] && m.b->field_count > 0) check_locked_energy(&m);
    }
  }
  memory_close(&m);
}
