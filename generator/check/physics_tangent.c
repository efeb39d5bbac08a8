/* The law at rest, its stiffness there, and its tangent anywhere. */
#include "generator/check/physics_tangent.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/ir/derive.h"
#include "generator/ir/random_values.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/law_inputs.h"
#include "generator/lower/lower_inputs.h"

static const double REST_TOLERANCE = 1e-12;     /* of the force at a stretch and rotation of 1e-3 */
static const double STIFFNESS_TOLERANCE = 1e-6; /* stretches of 1e-7 leave nine digits */
static const double TANGENT_TOLERANCE = 1e-4;
static const double LEAST_MOTION = 1e-12; /* about what positions in double precision can hold */
static const double LEAST_FORCE = 1e-290; /* smaller ones have not all their digits */

static const bench_axis force_axis[FORCE_COUNT] = {AXIS_STRETCH, AXIS_THETA_I, AXIS_THETA_J};

static void virgin_batch(bench *b, double *const *states) {
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    bench_draw(b, states, lane);
    bench_virgin(b, states, lane);
  }
}

/* --- rest ------------------------------------------------------------------------------------- */

void physics_check_rest(physics *p) {
  bench *b = &p->b;
  double **states = bench_states(b), size[BENCH_LANES],
         *column = must_alloc((size_t)b->width * sizeof *column);
  virgin_batch(b, states);
  for (int lane = 0; lane < BENCH_LANES; lane++)
    bench_move(b, states, lane, (motion){{1e-3, 0, 1e-3, 2e-3}});
  probe_run(b, &b->frozen, states, BENCH_LANES);
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    size[lane] = bench_size(b, states, &b->frozen, lane);
    bench_virgin(b, states, lane);
  }
  probe_run(b, &b->step, states, BENCH_LANES);
  for (int lane = 0; lane < BENCH_LANES; lane++)
    for (int k = 0; k < FORCE_COUNT; k++) {
      double force = b->step.out[k][lane], s = k == FORCE_N ? 1 : bench_length(b, states, lane);
      if (fabs(force) <= REST_TOLERANCE * s * (isfinite(size[lane]) ? size[lane] : 0) ||
          p->failed[DIAG_REST_FORCE])
        continue;
      bench_get(b, states, lane, column);
      if (isfinite(force))
        physics_say(p, DIAG_REST_FORCE, physics_fault(p, k, column), column,
                    "a virgin bond at rest carries `%s` = %.6g %s; it should carry nothing",
                    physics_force_names[k], force, physics_force_units[k]);
      else
        physics_say(p, DIAG_REST_FORCE, physics_fault(p, k, column), column,
                    "`%s` of a virgin bond at rest is not a finite number", physics_force_names[k]);
      diag_hint(
          p->said,
          "at stretch = 0 and without rotations every force is 0, and 0/0 is not a number; what "
          "a bond has grown by goes into `rest stretch = ...`, and a prestress that is meant is "
          "told by `accept rest-force \"why\"`");
    }
  bench_states_free(b, states);
  free(column);
}

/* --- stiffness -------------------------------------------------------------------------------- */

/* The axes both ways, then any direction. */
static motion direction_of(bench *b, int lane) {
  motion m = {{0}};
  int ways = b->micropolar ? FORCE_COUNT : 1;
  if (lane < 2 * ways)
    m.at[force_axis[lane / 2]] = lane % 2 ? -1 : 1;
  else
    for (int k = 0; k < ways; k++)
      m.at[force_axis[k]] = draw_uniform(&b->seed, -1, 1);
  return m;
}

void physics_check_stiffness(physics *p) {
  const double size = 1e-7;
  bench *b = &p->b;
  double **states = bench_states(b), *column = must_alloc((size_t)b->width * sizeof *column);
  motion way[BENCH_LANES];
  virgin_batch(b, states);
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    way[lane] = direction_of(b, lane);
    for (int k = 0; k < AXIS_COUNT; k++)
      way[lane].at[k] *= size;
    bench_move(b, states, lane, way[lane]);
  }
  probe_run(b, &b->step, states, BENCH_LANES);
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    double work = 0, total = 0, least = 0;
    int worst = FORCE_N;
    for (int k = 0; k < FORCE_COUNT; k++) {
      double part = b->step.out[k][lane] * way[lane].at[force_axis[k]] *
                    (k == FORCE_N ? bench_length(b, states, lane) : 1);
      work += part;
      total += fabs(part);
      worst = part < least ? k : worst;
      least = pl_fmin(least, part);
    }
    if (!(work < -STIFFNESS_TOLERANCE * total) || p->failed[DIAG_STIFFNESS]) continue;
    bench_get(b, states, lane, column);
    physics_say(p, DIAG_STIFFNESS, physics_fault(p, worst, column), column,
                "a virgin bond has a negative stiffness: a small motion makes `%s` push it on",
                physics_force_names[worst]);
    diag_hint(p->said,
              "N pulls the ends together when stretch > 0; M_i opposes theta_i: look at the signs");
  }
  bench_states_free(b, states);
  free(column);
}

/* --- tangent ---------------------------------------------------------------------------------- */

enum { RESULTS_AND_AXES = FORCE_COUNT * AXIS_COUNT };

/* d(force)/d(axis): the present length follows the stretch. */
static ir_node slope(bench *b, ir_node force, bench_axis axis) {
  ir *g = b->graph;
  if (force == IR_NONE) return ir_constant(g, 0);
  ir_node d = ir_derivative(g, force, lower_quantity(g, law_motion[axis]));
  if (axis == AXIS_STRETCH) {
    const ir_node by_length = ir_derivative(g, force, lower_quantity(g, QUANTITY_LENGTH));
    d = ir_add(g, d, ir_mul(g, lower_quantity(g, QUANTITY_S), by_length));
  }
  rewrite_zero(g, &d, 1, NULL, 0, &d);
  return d;
}

/* What decides at a kink: which side of it a state is on. IR_NONE: no kink. */
static ir_node side_of(ir *g, ir_node n) {
  ir_op op = ir_operation(g, n);
  switch (op) {
  case IR_LT:
  case IR_LE:
  case IR_EQ:
    return n;
  case IR_MIN:
  case IR_MAX:
    return ir_make(g, IR_LT, ir_operand(g, n, 0), ir_operand(g, n, 1), IR_NONE);
  default:
    if (!operation_has(op, KINKED)) return IR_NONE;
    return ir_make(g, IR_LT, ir_operand(g, n, ir_arity(op) - 1), ir_constant(g, 0), IR_NONE);
  }
}

static probe kinks_of(bench *b) {
  ir *g = b->graph;
  int nodes = ir_count(g), count = 0;
  unsigned char *marks = must_calloc((size_t)nodes, 1);
  ir_node *sides = must_alloc((size_t)nodes * sizeof *sides);
  ir_node forces[FORCE_COUNT] = {b->law_step.N, b->law_step.M_i[0], b->law_step.M_j[0]};
  ir_mark(g, forces, FORCE_COUNT, marks);
  for (ir_node n = 0; n < nodes; n++) {
    ir_node side = marks[n] ? side_of(g, n) : IR_NONE;
    if (side != IR_NONE && !ir_is_uniform(g, side)) sides[count++] = side;
  }
  probe p = probe_new(b, sides, count);
  free(sides);
  free(marks);
  return p;
}

enum { STENCIL = 5 };
static const double stencil[STENCIL] = {0, 1, -1, 0.5, -0.5};

typedef struct tangent_test {
  probe tangent, kinks;
  double **states, **moved;
  double step[BENCH_LANES];
  double force[STENCIL][FORCE_COUNT][BENCH_LANES];
  bool dropped[BENCH_LANES];
  double largest[RESULTS_AND_AXES]; /* derivative of the batch */
  double force_size[FORCE_COUNT]; /* largest of the batch: what rounding inside the law is measured
                                     by */
  double intact[FORCE_COUNT][BENCH_LANES]; /* forces of the bond as a new one: of a broken bond
                                              1 - damage is all rounding */
} tangent_test;

static void walk_stencil(physics *p, tangent_test *t, int count, bench_axis axis) {
  bench *b = &p->b;
  double *side = must_calloc((size_t)t->kinks.count * BENCH_LANES + 1, sizeof *side);
  for (int q = 0; q < STENCIL; q++) {
    for (int lane = 0; lane < count; lane++) {
      motion m = bench_motion(b, t->states, lane);
      m.at[axis] += stencil[q] * t->step[lane];
      bench_move(b, t->moved, lane, m);
    }
    probe_run(b, &b->step, t->moved, count);
    for (int k = 0; k < FORCE_COUNT; k++)
      memcpy(t->force[q][k], b->step.out[k], (size_t)count * sizeof(double));
    probe_run(b, &t->kinks, t->moved, count);
    for (int k = 0; k < t->kinks.count; k++)
      for (int lane = 0; lane < count; lane++) {
        double *known = &side[k * BENCH_LANES + lane];
        if (q == 0)
          *known = t->kinks.out[k][lane];
        else if (*known != t->kinks.out[k][lane])
          t->dropped[lane] = true;
      }
  }
  free(side);
}

static void compare_slope(physics *p, tangent_test *t, int lane, bench_axis axis, double wrong) {
  static const char *const axis_names[AXIS_COUNT] = {"stretch", "stretch_rate", "theta_i",
                                                     "theta_j"};
  for (int k = 0; k < FORCE_COUNT; k++) {
    double step = t->step[lane], at = t->force[0][k][lane];
    double wide = (t->force[1][k][lane] - t->force[2][k][lane]) / (2 * step);
    double close = (t->force[3][k][lane] - t->force[4][k][lane]) / step;
    double symbolic = t->tangent.out[k * AXIS_COUNT + (int)axis][lane];
    if (k == FORCE_N && axis == AXIS_STRETCH) symbolic += wrong;
    double noise = (1e-13 * fabs(at) + 1e-15 * (t->force_size[k] + fabs(t->intact[k][lane])) +
                    LEAST_FORCE) /
                   step,
           size = pl_fmax(fabs(close), fabs(symbolic));
    if (size <= 1e-10 * t->largest[k * AXIS_COUNT + (int)axis])
      continue; /* what rounding leaves of a broken bond */
    bool resolved = fabs(wide - close) <= 1e-5 * pl_fmax(fabs(wide), fabs(close)) + noise;
    if (!resolved || !(fabs(symbolic - close) > TANGENT_TOLERANCE * size + 10 * noise)) continue;
    double *column = must_alloc((size_t)p->b.width * sizeof *column);
    bench_get(&p->b, t->states, lane, column);
    physics_say(p, DIAG_TANGENT, physics_fault(p, k, column), column,
                "the derivative of `%s` by `%s` is %.6g, but differences of the force give %.6g",
                physics_force_names[k], axis_names[axis], symbolic, close);
    diag_hint(p->said,
              "this is a fault of the compiler, not of the law: please report it with the law");
    free(column);
  }
}

static void find_intact(physics *p, tangent_test *t, int count) {
  bench *b = &p->b;
  for (int lane = 0; lane < count; lane++) {
    bench_virgin(b, t->moved, lane);
    bench_move(b, t->moved, lane, bench_motion(b, t->states, lane));
  }
  probe_run(b, &b->frozen, t->moved, count);
  for (int k = 0; k < FORCE_COUNT; k++)
    memcpy(t->intact[k], b->frozen.out[k], (size_t)count * sizeof(double));
}

static void copy_to_moved(physics *p, tangent_test *t, int count) {
  for (int k = 0; k < p->b.width; k++)
    memcpy(t->moved[k], t->states[k], (size_t)count * sizeof(double));
}

static void test_batch(physics *p, tangent_test *t, int count, double wrong) {
  bench *b = &p->b;
  probe_run(b, &t->tangent, t->states, count);
  for (int k = 0; k < RESULTS_AND_AXES; k++)
    for (int lane = 0; lane < count; lane++)
      t->largest[k] = pl_fmax(t->largest[k], fabs(t->tangent.out[k][lane]));
  copy_to_moved(p, t, count);
  find_intact(p, t, count);
  copy_to_moved(p, t, count);
  probe_run(b, &b->step, t->states, count);
  for (int k = 0; k < FORCE_COUNT; k++)
    for (int lane = 0; lane < count; lane++)
      t->force_size[k] = pl_fmax(t->force_size[k], fabs(b->step.out[k][lane]));
  for (int axis = 0; axis < AXIS_COUNT; axis++) {
    if (!b->micropolar && axis >= AXIS_THETA_I) break;
    memset(t->dropped, 0, sizeof t->dropped);
    for (int lane = 0; lane < count; lane++) {
      motion m = bench_motion(b, t->states, lane);
      double others = axis == AXIS_RATE
                          ? 0
                          : pl_fmax(fabs(m.at[AXIS_STRETCH]),
                                    pl_fmax(fabs(m.at[AXIS_THETA_I]), fabs(m.at[AXIS_THETA_J])));
      double size = pl_fmax(fabs(m.at[axis]), 1e-3 * others);
      t->step[lane] = size > LEAST_MOTION ? 1e-4 * size : 1e-9;
    }
    walk_stencil(p, t, count, (bench_axis)axis);
    for (int lane = 0; lane < count; lane++)
      if (!t->dropped[lane]) compare_slope(p, t, lane, (bench_axis)axis, wrong);
  }
}

void physics_check_tangent(physics *p, double wrong) {
  bench *b = &p->b;
  tangent_test *t = must_calloc(1, sizeof *t);
  ir_node nodes[RESULTS_AND_AXES],
      forces[FORCE_COUNT] = {b->law_step.N, b->law_step.M_i[0], b->law_step.M_j[0]};
  for (int k = 0; k < RESULTS_AND_AXES; k++)
    nodes[k] = slope(b, forces[k / AXIS_COUNT], (bench_axis)(k % AXIS_COUNT));
  t->tangent = probe_new(b, nodes, RESULTS_AND_AXES);
  t->kinks = kinks_of(b);
  t->states = bench_states(b);
  t->moved = bench_states(b);
  for (int first = 0;
       first < p->pool_count && first < 4 * BENCH_LANES && !(first && bench_tired(b));
       first += BENCH_LANES) {
    int count = 0;
    for (int k = first; k < p->pool_count && count < BENCH_LANES; k++)
      bench_put(b, t->states, count++, p->pool + (size_t)k * (size_t)b->width);
    test_batch(p, t, count, wrong);
  }
  bench_states_free(b, t->states);
  bench_states_free(b, t->moved);
  probe_free(&t->tangent);
  probe_free(&t->kinks);
  free(t);
}
