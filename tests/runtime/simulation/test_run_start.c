/* The state that a run leaves is what its arrays hold, by particles and bonds; another run that
   begins from it has it. Results whose state is made up are refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

#include <cmocka.h>

#include "runtime/parts/run_start.h"
#include "runtime/result/result.h"
#include "runtime/simulation/simulation_state.h"
#include "tests/runtime/family_law.h"
#include "tests/runtime/small_run.h"

static const char path[] = "test_run_start.h5";

#define BODY(more)                                                                                 \
  "&simulation end_time = 2e-4 step = 1e-7 threads = 1 /\n"                                        \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&material lattice = 'c' model = 'm' S_t = 1e-5 /\n"                                             \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.06, 0.04 /\n"                    \
  "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = 0.004, 0.1 /\n"                  \
  "&support region = 'left' fix = 'xy' /\n"                                                        \
  "&gravity acceleration = 0, -1e4 /\n&output frames = 0 /\n" more

#define FIRST  BODY("")
#define SECOND BODY("&start result = 'test_run_start.h5' /\n")

static void open_run(small_run *r, const char *text) {
  small_open(r, &elastic_beam, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* A result with this state and the run's particles and bonds. */
static void leave(const simulation *s, const result_state *state) {
  char error[500];
  const rows *g = s->bodies[0].lattice_rows;
  const run_law *l = &s->laws[0];
  const size_t n = (size_t)g->particle_count, m = (size_t)g->bond_count;
  double *at = must_calloc(2 * n, sizeof *at), *volume = must_calloc(n, sizeof *volume);
  int32_t *of = must_calloc(n, sizeof *of), *pairs = must_calloc(2 * m, sizeof *pairs);
  for (size_t p = 0; p < n; p++) {
    at[2 * p] = g->x[g->particle_site[p]];
    at[2 * p + 1] = g->y[g->particle_site[p]];
  }
  for (size_t b = 0; b < m; b++) {
    pairs[2 * b] = l->bonds[b].i;
    pairs[2 * b + 1] = l->bonds[b].j;
  }
  const result_bonds bonds = {"c", (long)m, pairs};
  const result_header h = {.path = path,
                           .fingerprint = "one",
                           .title = "",
                           .started = "now",
                           .version = "0",
                           .kernel_key = "k",
                           .deck_text = FIRST,
                           .particle_count = (long)n,
                           .dimensions = 2,
                           .reference = at,
                           .volume = volume,
                           .body = of,
                           .bonds = &bonds,
                           .interaction_count = 1};
  const result_ending e = {.ended = "end", .dt = 1e-7, .steps = 1, .state = state};
  result *r = result_open(&h, false, error, sizeof error);
  assert_true(r && result_begin(r, error, sizeof error) &&
              result_finish(r, &e, error, sizeof error));
  result_discard(r);
  result_close(r);
  free(at);
  free(volume);
  free(of);
  free(pairs);
}

static void the_state_is_that_of_the_arrays(void **state) {
  (void)state;
  small_run first, second;
  open_run(&first, FIRST);
  assert_int_equal(small_go(&first), STEP_END);
  const simulation *s = first.simulation;
  const run_law *l = &s->laws[0];
  const rows *g = s->bodies[0].lattice_rows;
  result_state *left =
      run_state_take(s->bodies, 1, &s->contacts, &s->stamps, s->deck, s->limit.step);
  assert_true(left->step == 1e-7 && left->body_count == 1 && left->law_count == 1);
  const state_body *b = &left->bodies[0];
  const state_field *f = &left->laws[0].fields[0];
  assert_true(b->count == g->particle_count && b->dof == 3 && f->count == g->bond_count);
  double most = 0;
  for (long p = 0; p < b->count; p++)
    for (int c = 0; c < 3; c++) {
      const long site = g->particle_site[p];
      assert_true(b->displacement[3 * p + c] == s->bodies[0].body->displacement[c][site]);
      assert_true(b->velocity[3 * p + c] == s->bodies[0].body->velocity[c][site]);
    }
  for (long m = 0; m < f->count; m++) {
    assert_true(f->values[m] == sweep_bond_value(l->state, l->state->field[0], &l->bonds[m]));
    most = fmax(most, f->values[m]);
  }
  assert_true(most > 0.1);
  leave(s, left);
  open_run(&second, SECOND);
  result_state *found =
      run_state_take(second.simulation->bodies, 1, &second.simulation->contacts,
                     &second.simulation->stamps, second.simulation->deck, left->step);
  const size_t bytes = 3 * (size_t)b->count * sizeof(double);
  assert_memory_equal(found->bodies[0].displacement, b->displacement, bytes);
  assert_memory_equal(found->bodies[0].velocity, b->velocity, bytes);
  assert_memory_equal(found->laws[0].fields[0].values, f->values,
                      (size_t)f->count * sizeof(double));
  const run_going going = simulation_going(second.simulation, 0);
  assert_true(going.particles == b->count && going.bonds == f->count && going.new_bonds == 0 &&
              going.gone_bonds == 0 && going.new_particles == 0 && going.gone_particles == 0);
  assert_true(simulation_started_from(second.simulation) != 0);
  result_state_free(found);
  result_state_free(left);
  small_close(&first);
  small_close(&second);
  unlink(path);
}

/* Of laws of families a bond has a value at either end; particles have theirs. */
static void both_ends_keep_their_values(void **state) {
  (void)state;
  small_run first, second;
  small_open(&first, &family_hexagon, FIRST);
  assert_non_null(first.simulation);
  const simulation *s = first.simulation;
  const sweep *w = s->laws[0].state;
  const rows *g = w->lattice;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    w->field[0][q] = 1e-3 * (double)(p + 1);
    for (int k = 0; k < 2 * g->directions; k++)
      if (rows_has_neighbour(g, q, k)) w->field[1][k * g->size + q] = (double)(10 * p + k);
  }
  result_state *left = run_state_take(s->bodies, 1, &s->contacts, &s->stamps, s->deck, 1e-7);
  leave(s, left);
  result_state_free(left);
  small_open(&second, &family_hexagon, SECOND);
  assert_non_null(second.simulation);
  const sweep *v = second.simulation->laws[0].state;
  const size_t bytes = (size_t)g->size * sizeof(double);
  assert_memory_equal(v->field[0], w->field[0], bytes);
  assert_memory_equal(v->field[1], w->field[1], 2 * (size_t)g->directions * bytes);
  small_close(&first);
  small_close(&second);
  unlink(path);
}

/* The second deck is told off with this sentence. */
static void refused(const simulation *s, const result_state *state, const char *text,
                    const char *wanted) {
  small_run r;
  leave(s, state);
  small_open(&r, &elastic_beam, text);
  assert_null(r.simulation);
  bool told = false;
  for (int k = 0; k < r.said.count; k++)
    told = told || strstr(r.said.items[k].message, wanted);
  if (!told) small_print(&r);
  assert_true(told);
  small_close(&r);
}

static void a_made_up_state_is_refused(void **state) {
  (void)state;
  static const char damaged[] = "is damaged: the state at its end cannot be read",
                    other[] = "has other states and damage";
  small_run first;
  open_run(&first, FIRST);
  const simulation *s = first.simulation;
  result_state *left = run_state_take(s->bodies, 1, &s->contacts, &s->stamps, s->deck, 1e-7);
  state_body *b = &left->bodies[0];
  state_law *l = &left->laws[0];
  b->first = 1; /* its last particle is none */
  refused(s, left, SECOND, damaged);
  b->first = -1;
  refused(s, left, SECOND, damaged);
  b->first = 0;
  b->spacing = NAN;
  refused(s, left, SECOND, damaged);
  b->spacing = 0.01;
  left->step = -1;
  refused(s, left, SECOND, damaged);
  left->step = NAN;
  refused(s, left, SECOND, damaged);
  left->step = 1e-7;
  b->velocity[4] = NAN;
  refused(s, left, SECOND, damaged);
  b->velocity[4] = 0;
  l->fields[0].count--;
  refused(s, left, SECOND, other);
  l->fields[0].count++;
  l->field_count = 0;
  refused(s, left, SECOND, other);
  l->field_count = 1;
  result_state_free(left);
  small_close(&first);
  unlink(path);
}

static void made_up_stamps_are_refused(void **state) {
  (void)state;
  static const char damaged[] = "is damaged: the state at its end cannot be read",
                    other[] = "where it is drawn with another shape or elsewhere",
                    with[] = BODY("&start result = 'test_run_start.h5' /\n"
                                  "&stamp name = 'ball' shape = 'disc' centre = 1, 0 radius = 0.1 "
                                  "mass = 1 /\n");
  small_run first;
  open_run(&first, FIRST);
  const simulation *s = first.simulation;
  result_state *left = run_state_take(s->bodies, 1, &s->contacts, &s->stamps, s->deck, 1e-7);
  const long count = left->bodies[0].count;
  char lattice[] = "c", name[] = "ball";
  state_field dragged = {.name = lattice, .unit = "m", .count = count, .columns = 2};
  dragged.values = must_calloc(2 * (size_t)count, sizeof(double));
  state_stamp ball = {.name = name, .dragged = &dragged, .dragged_count = 1}, *own = left->stamps;
  left->stamps = &ball;
  left->stamp_count = 1;
  refused(s, left, with, other);
  dragged.values[3] = NAN;
  refused(s, left, with, damaged);
  dragged.values[3] = 0;
  ball.surface[2] = INFINITY;
  refused(s, left, with, damaged);
  ball.surface[2] = 0;
  ball.velocity[0] = NAN;
  refused(s, left, with, damaged);
  left->stamps = own;
  left->stamp_count = 0;
  free(dragged.values);
  result_state_free(left);
  small_close(&first);
  unlink(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_state_is_that_of_the_arrays),
      cmocka_unit_test(both_ends_keep_their_values),
      cmocka_unit_test(a_made_up_state_is_refused),
      cmocka_unit_test(made_up_stamps_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
