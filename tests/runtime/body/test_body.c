/* A body of particles on rows: who works on which rows, and how a row moves, against the leapfrog
   step written out. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/base/lane_sum.h"
#include "runtime/body/body.h"
#include "runtime/body/motion.h"
#include "runtime/body/rotation_vector.h"
#include "tests/runtime/beam_law.h"
#include "tests/runtime/small_run.h"

enum { DOF = 2 };
static const double step = 1e-7;

#define WEDGE                                                                                      \
  "&simulation end_time = 1e-5 step = 1e-7 /\n"                                                    \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'polygon' points = 0, 0, 0.4, 0, 0, 0.3 /\n"                        \
  "&material lattice = 'c' model = 'm' /\n&output frames = 0 /\n"

static const rows *open_wedge(small_run *r) {
  small_open(r, &elastic_bar, WEDGE);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
  return simulation_rows(r->simulation, 0);
}

static long sites_of(const body *w, const body_block *b) {
  long sum = 0;
  for (int row = b->first; row < b->last; row++)
    sum += w->count[row];
  return sum;
}

/* Rows are shared out in one piece each, whatever is shared evenly: rows, or what stands on them.
   */
static void blocks_share_out_all_rows(void **state) {
  (void)state;
  enum { THREADS = 4 };
  small_run r;
  const rows *g = open_wedge(&r);
  long most[2] = {0, 0};
  for (int share = BODY_SHARE_ROWS; share <= BODY_SHARE_SITES; share++) {
    body *w = body_new(g, DOF, step, THREADS, (body_share)share);
    assert_int_equal(w->block_count, THREADS);
    for (int k = 0; k < THREADS; k++) {
      const body_block *b = &w->blocks[k];
      assert_int_equal(b->first, k ? w->blocks[k - 1].last : 0);
      assert_true(b->last > b->first);
      if (share == BODY_SHARE_ROWS)
        assert_true(labs((b->last - b->first) * (long)THREADS - g->row_count) < THREADS);
      if (sites_of(w, b) > most[share]) most[share] = sites_of(w, b);
    }
    assert_int_equal(w->blocks[THREADS - 1].last, g->row_count);
    body_free(w);
  }
  assert_true(most[BODY_SHARE_SITES] < most[BODY_SHARE_ROWS]); /* a wedge has long rows below */
  small_close(&r);
}

static void set_motion(body *w, int row, double *next) {
  const long start = body_start(w, row), pitch = w->lattice->pitch;
  for (int d = 0; d < DOF; d++)
    for (long q = 0; q < w->count[row]; q++) {
      const bool there = w->lattice->present[start + q];
      w->velocity[d][start + q] = there ? 0.1 * (double)(q + 1) + d : 0;
      w->force[d][start + q] = there ? 3.0 * (double)q - 7 : 0;
      next[d * pitch + q] = there ? 0.2 * (double)(q + 1) - d : 0;
    }
}

/* v+ becomes v, u grows by dt v+; gravity adds dt g to v+ where there are particles. */
static void a_row_drifts_by_its_new_velocities(void **state) {
  (void)state;
  enum { ROW = 3 };
  small_run r;
  const rows *g = open_wedge(&r);
  body *w = body_new(g, DOF, step, 1, BODY_SHARE_ROWS);
  double *next = w->blocks[0].next;
  body_add_gravity(w);
  w->gravity[1] = -9.81;
  set_motion(w, ROW, next);
  const row_part whole = whole_row(w, ROW);
  for (int d = 0; d < DOF; d++)
    assert_true(!motion_push(w, &whole, d, next + d * g->pitch));
  motion_drift(w, &w->blocks[0], &whole);
  const long start = body_start(w, ROW);
  for (int d = 0; d < DOF; d++)
    for (long q = 0; q < w->count[ROW]; q++) {
      const double v = g->present[start + q] ? 0.2 * (double)(q + 1) - d + step * w->gravity[d] : 0;
      assert_true(w->velocity[d][start + q] == v);
      assert_true(w->displacement[d][start + q] == step * v);
    }
  body_free(w);
  small_close(&r);
}

/* From a particle on that would move a spacing in a step, or by what is no number, its row stays.
   */
static void a_row_stays_from_a_bad_velocity_on(void **state) {
  (void)state;
  enum { ROW = 2, PLACE = 9 };
  const double bad[] = {1.001 * 0.01 / 1e-7, NAN};
  small_run r;
  const rows *g = open_wedge(&r);
  for (int k = 0; k < 2; k++) {
    body *w = body_new(g, DOF, step, 1, BODY_SHARE_ROWS);
    body_block *b = &w->blocks[0];
    const long start = body_start(w, ROW);
    assert_int_equal(body_bad(w), -1);
    b->next[g->pitch + PLACE] = bad[k];
    motion_note_bad(w, b, ROW, PL_LANES);
    assert_int_equal(body_bad(w), 0);
    assert_int_equal(b->bad_site, start + PLACE);
    assert_int_equal(b->bad_component, 1);
    assert_true(body_has_moved(w, start + PL_LANES - 1));
    assert_false(body_has_moved(w, start + PL_LANES));
    assert_true(body_has_moved(w, body_start(w, ROW + 1)));
    body_free(w);
  }
  small_close(&r);
}

/* Kinetic energy is half m v- v+, the work against the bonds half a step of -f v. */
static void a_row_tells_its_energies(void **state) {
  (void)state;
  enum { ROW = 1 };
  small_run r;
  const rows *g = open_wedge(&r);
  body *w = body_new(g, DOF, step, 1, BODY_SHARE_ROWS);
  const long start = body_start(w, ROW);
  double kinetic = 0, internal = 0;
  set_motion(w, ROW, w->blocks[0].next);
  motion_observe(w, &w->blocks[0], ROW);
  for (int d = 0; d < DOF; d++)
    for (long q = 0; q < w->count[ROW]; q++) {
      const double v = w->velocity[d][start + q];
      kinetic += 0.5 * body_mass(w, d, start + q) * v * w->blocks[0].next[d * g->pitch + q];
      internal -= 0.5 * step * w->force[d][start + q] * v;
    }
  const body_totals sum = body_sum(w);
  assert_true(kinetic != 0 && fabs(sum.kinetic / kinetic - 1) < 1e-14);
  assert_true(internal != 0 && fabs(sum.internal / internal - 1) < 1e-12);
  body_free(w);
  small_close(&r);
}

/* Eight lanes, then their sum from the first to the last. */
static void sums_have_an_order_of_their_own(void **state) {
  (void)state;
  double a[3 * PL_LANES], b[3 * PL_LANES], weight[3 * PL_LANES], lane[4][PL_LANES] = {{0}};
  double sum[4] = {0};
  for (int q = 0; q < 3 * PL_LANES; q++) {
    a[q] = sin(q) * 1e3, b[q] = cos(3 * q) / 7, weight[q] = 1 + 0.1 * q;
    const double term[] = {a[q], a[q] * b[q], weight[q] * (a[q] * b[q]),
                           weight[q] * ((a[q] + b[q]) * (a[q] + b[q]))};
    for (int k = 0; k < 4; k++)
      lane[k][q % PL_LANES] += term[k];
  }
  for (int k = 0; k < 4; k++)
    for (int l = 0; l < PL_LANES; l++)
      sum[k] += lane[k][l];
  assert_true(lane_total(3 * PL_LANES, a) == sum[0]);
  assert_true(lane_dot(3 * PL_LANES, NULL, a, b) == sum[1]);
  assert_true(lane_dot(3 * PL_LANES, weight, a, b) == sum[2]);
  assert_true(lane_square(3 * PL_LANES, weight, a, b) == sum[3]);
}

/* --- rotations in space ----------------------------------------------------------------------- */

#define CUBES                                                                                      \
  "&simulation end_time = 1e-5 step = 1e-7 /\n"                                                    \
  "&lattice name = 'c' kind = 'cubic' spacing = 0.01 /\n"                                          \
  "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.05, 0.05, 0.05 /\n"                 \
  "&material lattice = 'c' model = 'm' /\n&output frames = 0 /\n"

/* What both rotation vectors do to the axes, one after the other, and what `now` does: farthest
   apart. */
static double apart(const double first[3], const double then[3], const double now[3]) {
  double most = 0;
  for (int k = 0; k < 3; k++) {
    double v[3] = {k == 0, k == 1, k == 2}, once[3], twice[3], at_once[3];
    beam_turned(now, v, at_once);
    beam_turned(first, v, once);
    for (int c = 0; c < 3; c++)
      once[c] += v[c];
    beam_turned(then, once, twice);
    for (int c = 0; c < 3; c++)
      most = fmax(most, fabs(once[c] + twice[c] - v[c] - at_once[c]));
  }
  return most;
}

/* Velocities turn a particle further than it has turned, about axes that stand still; rotation
   vectors go on beyond whole turns. A small turn keeps its digits. */
static void rotations_follow_each_other(void **state) {
  (void)state;
  enum { ROW = 0 };
  static const double starts[][3] = {{0, 0, 0},    {1e-9, -2e-9, 3e-9}, {0.1, 0.2, -0.3},
                                     {1, -2, 1.5}, {0, 0, 3.1},         {0, 0, 6.2},
                                     {-4, 7, 2},   {14, 0, 0},          {2e-160, 0, 0}};
  static const double turns[][3] = {{0, 0, 0},     {1e-9, 1e-9, 0}, {0.01, -0.02, 0.005},
                                    {0, 0, 0.1},   {2e-3, 0, 0},    {0.3, 1, -2},
                                    {1e-170, 0, 0}};
  const pl_law law = beams_in(3, PL_ROWS);
  small_run r;
  small_open(&r, &law, CUBES);
  assert_non_null(r.simulation);
  const rows *g = simulation_rows(r.simulation, 0);
  body *w = body_new(g, 6, step, 1, BODY_SHARE_ROWS);
  const long q = body_start(w, ROW);
  for (int n = 0; n < 9; n++)
    for (int m = 0; m < 7; m++) {
      double now[3], sum[3], size = 0, whole = 0;
      for (int k = 0; k < 3; k++) {
        w->displacement[3 + k][q] = starts[n][k];
        w->blocks[0].next[(3 + k) * g->pitch] = turns[m][k] / step;
        sum[k] = starts[n][k] + turns[m][k];
        size = fmax(size, fabs(sum[k]));
      }
      const row_part row = whole_row(w, ROW);
      motion_drift(w, &w->blocks[0], &row);
      for (int k = 0; k < 3; k++) {
        assert_true(w->velocity[3 + k][q] == turns[m][k] / step);
        now[k] = w->displacement[3 + k][q];
        whole = fmax(whole, fabs(now[k] - sum[k]));
      }
      assert_true(apart(starts[n], turns[m], now) < 2e-15 * (1 + size));
      double across[3];
      beam_cross(starts[n], turns[m], across);
      if (beam_dot(across, across) == 0) assert_true(whole <= 1e-15 * size);
      if (size < 1e-8) assert_true(whole <= 1e-8 * size);
    }
  body_free(w);
  small_close(&r);
}

/* Whatever has turned beside it, far or little, a particle turns with the same bits, in the last
   place of a row, too. */
static void a_turn_has_the_same_bits_in_any_company(void **state) {
  (void)state;
  enum { COUNT = 150 };
  const double scales[] = {1e-170, 1e-9, 0.02, 0.13, 0.249, 0.251, 1.7, 9};
  double turned[3][COUNT], rate[3][COUNT];
  unsigned seed = 7;
  for (long q = 0; q < COUNT; q++)
    for (int k = 0; k < 3; k++) {
      const double size = q < 70 ? scales[q % 4] : scales[q % 8]; /* the first 64 turn little */
      turned[k][q] = size * ((double)(seed = seed * 1664525u + 1013904223u) / 4294967296.0 - 0.5);
      rate[k][q] = scales[(q / 8) % 6] *
                   ((double)(seed = seed * 1664525u + 1013904223u) / 4294967296.0 - 0.5) / step;
    }
  double alone[3][COUNT];
  for (long q = 0; q < COUNT; q++) {
    double r[3], a[3];
    for (int k = 0; k < 3; k++)
      r[k] = turned[k][q], a[k] = step * rate[k][q];
    rotation_vector_turn(r, a);
    for (int k = 0; k < 3; k++)
      alone[k][q] = r[k];
  }
  const double *const rates[3] = {rate[0], rate[1], rate[2]};
  double *const all[3] = {turned[0], turned[1], turned[2]};
  rotation_vector_turn_all(COUNT, step, rates, all);
  assert_memory_equal(turned, alone, sizeof alone);
}

/* Held components come to their targets; what holds them is a moment without work on all motions
   that leave them where they are. */
static void what_holds_a_component_does_no_work(void **state) {
  (void)state;
  static const double starts[][3] = {{0, 0, 0},    {1e-9, 2e-9, 0}, {0.3, -0.1, 0.2},
                                     {0.5, 2, -1}, {3.1, 0.4, 0},   {0, 0, 9}};
  const double w[3] = {30, -20, 50}, moment[3] = {2, 3, -1}, dt = 1e-4;
  for (int n = 0; n < 6; n++)
    for (int held = 1; held < 8; held++) {
      const double *r = starts[n];
      const double target[3] = {r[0] + 1e-3, r[1] - 2e-3, r[2] + 1e-3};
      double pulled[3] = {w[0], w[1], w[2]}, idle[3] = {w[0], w[1], w[2]}, after[3], turn[3],
             left[3] = {moment[0], moment[1], moment[2]}, again[3], work = 0;
      rotation_vector_reach(r, dt, held, target, pulled);
      rotation_vector_reach(r, 1e-9, held, r, idle); /* so short a step that it is straight */
      rotation_vector_release(r, held, left);
      memcpy(again, left, sizeof again);
      rotation_vector_release(r, held, again);
      for (int k = 0; k < 3; k++) {
        after[k] = r[k];
        turn[k] = dt * pulled[k];
        work += (moment[k] - left[k]) * idle[k];
        assert_true(fabs(again[k] - left[k]) < 1e-13);
        if (held == 7) assert_true(fabs(left[k]) < 1e-13);
      }
      rotation_vector_turn(after, turn);
      for (int k = 0; k < 3; k++)
        if (held >> k & 1) assert_true(fabs(after[k] - target[k]) < 4e-15);
      assert_true(fabs(work) < 1e-4);
    }
}

/* A particle that turns out to be quicker turns as if it had been so from the beginning of the
   step, not about one axis after the others. */
static void a_change_of_velocity_takes_the_place_along(void **state) {
  (void)state;
  const pl_law law = beams_in(3, PL_ROWS);
  const double start[3] = {0.4, -1.1, 0.7};
  small_run r;
  small_open(&r, &law, CUBES);
  body *w = body_new(simulation_rows(r.simulation, 0), 6, step, 1, BODY_SHARE_ROWS);
  const long q = body_start(w, 1) + 1;
  for (int axis = 0; axis < 3; axis++) {
    double turned[3] = {0.2, 0.1, -0.3}, now[3], before[3];
    memcpy(now, start, sizeof now);
    rotation_vector_turn(now, turned);
    for (int k = 0; k < 3; k++) {
      w->displacement[3 + k][q] = now[k];
      w->velocity[3 + k][q] = turned[k] / step;
    }
    motion_change(w, 3 + axis, q, 0.4 / step);
    turned[axis] += 0.4;
    motion_turned_before(w, q, before);
    for (int k = 0; k < 3; k++) {
      now[k] = w->displacement[3 + k][q];
      assert_true(fabs(before[k] - start[k]) < 2e-15);
      assert_true(fabs(w->velocity[3 + k][q] * step - turned[k]) < 1e-15);
    }
    assert_true(apart(start, turned, now) < 2e-15);
    motion_change(w, axis, q, 0.25 / step);
    assert_true(w->displacement[axis][q] == step * (0.25 / step));
    assert_true(w->velocity[axis][q] == 0.25 / step && w->displacement[3][q] == now[0]);
  }
  body_free(w);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(blocks_share_out_all_rows),
                                     cmocka_unit_test(a_row_drifts_by_its_new_velocities),
                                     cmocka_unit_test(a_row_stays_from_a_bad_velocity_on),
                                     cmocka_unit_test(a_row_tells_its_energies),
                                     cmocka_unit_test(sums_have_an_order_of_their_own),
                                     cmocka_unit_test(rotations_follow_each_other),
                                     cmocka_unit_test(a_turn_has_the_same_bits_in_any_company),
                                     cmocka_unit_test(what_holds_a_component_does_no_work),
                                     cmocka_unit_test(a_change_of_velocity_takes_the_place_along)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
