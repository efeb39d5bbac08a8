/* Every law in models/ and beside this test: its compiled kernel against the interpreter, on random
 * states and random strips with absent and protected bonds and large rotations. Both read the same
 * graph with the same operations, so the bits must be the same. PERILAT_DEEP=1 takes ten times as
 * many states. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <glob.h>
#include <math.h>
#include <sys/wait.h>

#include "dsl/arena.h"
#include "generator/interpret.h"
#include "generator/model.h"

enum {
  STATES = 4096,
  INPUTS = 5,
  RESULTS = 3,
  TANGENTS = 12,
  SITES = 1024,
  LISTED = 1003,
  PARAMETER_SETS = 4
};
static const pl_bond_class bond_class = {.s = 6.35e-3,
                                         .spacing = 6.35e-3,
                                         .t = 0.1524,
                                         .V = 5.32e-6,
                                         .mass_i = 0.0124,
                                         .mass_j = 0.0124,
                                         .area = 1e-4,
                                         .shell = 1,
                                         .n = 6,
                                         .chord = {6.35e-3 * 0.5, 6.35e-3 * 0.8660254037844386, 0}};

/* --- random numbers ------------------------------------------------------------------------------
 */

static uint64_t draw(uint64_t *state) { /* splitmix64 (Steele et al. 2014) */
  uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

static double uniform(uint64_t *state, double low, double high) {
  return low + (high - low) * (double)(draw(state) >> 11) * 0x1p-53;
}

/* Any size between the powers of ten, any sign; 0 now and then. */
static double any_size(uint64_t *state, double low, double high) {
  double size = pow(10, uniform(state, low, high));
  uint64_t choice = draw(state) % 16;
  return choice == 0 ? 0 : choice % 2 ? size : -size;
}

static double any_field(uint64_t *state, const pl_field *field) {
  uint64_t choice = draw(state) % 4;
  if (field->kind == PL_FIELD_DAMAGE)
    return choice == 0 ? 0 : choice == 1 ? 1 : uniform(state, 0, 1);
  return field->initial + any_size(state, -8, -1);
}

/* --- comparing -----------------------------------------------------------------------------------
 */

/* A NaN that no operation gives: what still holds it was not written. */
static const uint64_t poison_bits = UINT64_C(0x7ff4deadbeef0001);

static void poison(double *values, long count) {
  for (long q = 0; q < count; q++)
    memcpy(&values[q], &poison_bits, sizeof *values);
}

/* Doubles in order of size as integers in order: their difference counts the doubles between. */
static int64_t in_order(double x) {
  int64_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits < 0 ? INT64_MIN - bits : bits;
}

static double ulps(double a, double b) {
  if (isnan(a) && isnan(b)) return 0;
  if (isnan(a) || isnan(b)) return INFINITY;
  return fabs((double)in_order(a) - (double)in_order(b));
}

typedef struct comparison {
  double largest; /* ulps */
  long values;
} comparison;

static void compare(comparison *c, const char *what, int plane, const double *kernel,
                    const double *interpreted, long count) {
  for (long q = 0; q < count; q++) {
    if (memcmp(&kernel[q], &poison_bits, sizeof poison_bits) == 0)
      fail_msg("%s, plane %d, element %ld was not written by the kernel", what, plane, q);
    if (memcmp(&interpreted[q], &poison_bits, sizeof poison_bits) == 0)
      fail_msg("%s, plane %d, element %ld was not written by the interpreter", what, plane, q);
    double distance = ulps(kernel[q], interpreted[q]);
    if (distance > 0)
      fail_msg("%s, plane %d, element %ld: kernel %.17g, interpreter %.17g, %g ulp apart", what,
               plane, q, kernel[q], interpreted[q], distance);
    c->largest = fmax(c->largest, distance);
    c->values++;
  }
}

/* --- a law under test ----------------------------------------------------------------------------
 */

typedef struct subject {
  const char *name;
  model model;
  const pl_law *kernel, *interpreted;
  pl_law *owned;
  double *parameters, *uniforms, *other_uniforms;
  comparison states, strips;
  unsigned char *guard_seen; /* bit 1: true, bit 0: false */
  ir_node *guards;
  int guard_count;
} subject;

/* a < b ? b : a and the like: a limit put on a value, which a good law may never reach; not a case.
 */
static bool is_limit(const ir *g, ir_node choice) {
  ir_node guard = ir_operand(g, choice, 0), yes = ir_operand(g, choice, 1),
          no = ir_operand(g, choice, 2);
  if (ir_arity(ir_operation(g, guard)) != 2) return false;
  ir_node a = ir_operand(g, guard, 0), b = ir_operand(g, guard, 1);
  return (yes == a && no == b) || (yes == b && no == a);
}

/* Conditions that decide between cases. */
static void find_guards(subject *s) {
  const kernel_plan *plan = s->model.plan;
  const ir *g = plan->graph;
  size_t count = (size_t)ir_count(g);
  unsigned char *marks = must_calloc(count, 1);
  const pass *p = &plan->passes[PASS_STATES];
  ir_node *roots = must_calloc((size_t)p->root_count, sizeof *roots);
  for (int k = 0; k < p->root_count; k++)
    roots[k] = p->roots[k].node;
  ir_mark(g, roots, p->root_count, marks);
  s->guards = must_calloc(count, sizeof *s->guards);
  s->guard_seen = must_calloc(count, 1);
  for (ir_node n = 0; n < (ir_node)count; n++)
    if (marks[n] && ir_operation(g, n) == IR_SELECT && !is_limit(g, n))
      marks[ir_operand(g, n, 0)] = 2;
  for (ir_node n = 0; n < (ir_node)count; n++)
    if (marks[n] == 2) s->guards[s->guard_count++] = n;
  free(marks);
  free(roots);
}

static void subject_open(subject *s, const char *path) {
  char error[2000] = "";
  const char *note;
  *s = (subject){.name = strrchr(path, '/') + 1};
  if (!model_open(&s->model, path, NULL, 0) || !model_plan(&s->model)) {
    diag_print(&s->model.said, stderr);
    fail_msg("%s cannot be compiled", path);
  }
  s->kernel = model_kernel(&s->model, false, &note, error, sizeof error);
  if (!s->kernel) fail_msg("%s", error);
  assert_null(note);
  s->interpreted = s->owned = plan_interpreted(s->model.plan, s->model.key);
  s->parameters = must_calloc((size_t)s->kernel->parameter_count + 1, sizeof(double));
  s->uniforms = must_calloc((size_t)s->kernel->uniform_count + 1, sizeof(double));
  s->other_uniforms = must_calloc((size_t)s->kernel->uniform_count + 1, sizeof(double));
  find_guards(s);
}

static void subject_close(subject *s) {
  plan_interpreted_free(s->owned);
  model_close(&s->model);
  free(s->parameters);
  free(s->uniforms);
  free(s->other_uniforms);
  free(s->guards);
  free(s->guard_seen);
}

static void assert_same_bounds(const subject *s) {
  enum { MOST = 64 };
  double low[2][MOST], high[2][MOST];
  unsigned char open[4][MOST];
  int count = s->kernel->parameter_count;
  assert_true(count <= MOST);
  s->kernel->bounds(s->kernel, s->parameters, low[0], high[0], open[0], open[1]);
  s->interpreted->bounds(s->interpreted, s->parameters, low[1], high[1], open[2], open[3]);
  for (int k = 0; k < count; k++) {
    assert_true(low[0][k] == low[1][k] && high[0][k] == high[1][k]);
    assert_true(open[0][k] == open[2][k] && open[1][k] == open[3][k]);
    assert_true(low[0][k] <= high[0][k]);
  }
}

/* Set 0 are the defaults; the others vary each by a factor up to 2, back within the bounds. */
static void choose_parameters(subject *s, int set, uint64_t *seed) {
  enum { MOST = 64 };
  double low[MOST], high[MOST];
  unsigned char low_open[MOST], high_open[MOST];
  const pl_law *k = s->kernel;
  assert_true(k->parameter_count <= MOST);
  for (int p = 0; p < k->parameter_count; p++) {
    s->parameters[p] = k->parameters[p].has_default ? k->parameters[p].initial : 1;
    k->bounds(k, s->parameters, low, high, low_open, high_open);
    double wanted = s->parameters[p] * (set ? uniform(seed, 0.5, 2) : 1);
    bool inside = (low_open[p] ? wanted > low[p] : wanted >= low[p]) &&
                  (high_open[p] ? wanted < high[p] : wanted <= high[p]);
    if (inside) s->parameters[p] = wanted;
  }
  k->prepare(k, s->parameters, &bond_class, s->uniforms);
  s->interpreted->prepare(s->interpreted, s->parameters, &bond_class, s->other_uniforms);
  compare(&s->states, "prepare", 0, s->uniforms, s->other_uniforms, k->uniform_count);
  assert_same_bounds(s);
}

static double **new_planes(long planes, long count) {
  double **p = must_calloc((size_t)planes + 1, sizeof *p);
  for (long k = 0; k < planes; k++) {
    p[k] = aligned_alloc(PL_ALIGNMENT, ((size_t)count * sizeof(double) + PL_ALIGNMENT - 1) /
                                           PL_ALIGNMENT * PL_ALIGNMENT);
    assert_non_null(p[k]);
  }
  return p;
}

static void free_planes(double **p, long planes) {
  for (long k = 0; k < planes; k++)
    free(p[k]);
  free(p);
}

/* --- the law alone -------------------------------------------------------------------------------
 */

static void fill_states(const subject *s, double **in, uint64_t *seed) {
  for (int q = 0; q < STATES; q++) {
    in[0][q] = fmax(any_size(seed, -9, 0), -0.9);
    in[1][q] = any_size(seed, -3, 6);
    in[2][q] = any_size(seed, -9, 0.5);
    in[3][q] = any_size(seed, -9, 0.5);
    in[4][q] = bond_class.s * (1 + in[0][q]);
    for (int f = 0; f < s->kernel->field_count; f++)
      in[INPUTS + f][q] = any_field(seed, &s->kernel->fields[f]);
  }
}

/* Which conditions of the law were seen true and which false. */
static void watch_guards(subject *s, double **in) {
  const double *quantities[QUANTITY_COUNT] = {[QUANTITY_STRETCH] = in[0],
                                              [QUANTITY_STRETCH_RATE] = in[1],
                                              [QUANTITY_THETA_I] = in[2],
                                              [QUANTITY_THETA_J] = in[3],
                                              [QUANTITY_LENGTH] = in[4],
                                              [QUANTITY_S] = &bond_class.s,
                                              [QUANTITY_SPACING] = &bond_class.spacing,
                                              [QUANTITY_T] = &bond_class.t,
                                              [QUANTITY_V] = &bond_class.V,
                                              [QUANTITY_M_BOND] = &bond_class.mass_i,
                                              [QUANTITY_M_END_I] = &bond_class.mass_i,
                                              [QUANTITY_M_END_J] = &bond_class.mass_j,
                                              [QUANTITY_AREA] = &bond_class.area,
                                              [QUANTITY_SHELL] = &bond_class.shell,
                                              [QUANTITY_N_FAMILY] = &bond_class.n};
  unsigned char strides[QUANTITY_COUNT] = {0}, field_strides[64];
  for (int k = 0; k < QUANTITY_COUNT; k++)
    strides[k] = k == QUANTITY_STRETCH || k == QUANTITY_STRETCH_RATE || k == QUANTITY_THETA_I ||
                 k == QUANTITY_THETA_J || k == QUANTITY_LENGTH;
  memset(field_strides, 1, sizeof field_strides);
  const double *parameters[64];
  for (int k = 0; k < s->kernel->parameter_count; k++)
    parameters[k] = &s->parameters[k];
  double **out = new_planes(s->guard_count, STATES);
  interpreter *p = interpreter_new(s->model.plan->graph, s->guards, s->guard_count);
  interpreter_inputs inputs = {
      .values = {[IR_FROM_PARAMETER] = parameters,
                 [IR_FROM_QUANTITY] = quantities,
                 [IR_FROM_FIELD] = (const double *const *)(in + INPUTS)},
      .stride = {[IR_FROM_QUANTITY] = strides, [IR_FROM_FIELD] = field_strides}};
  interpreter_run(p, &inputs, STATES, out);
  interpreter_free(p);
  for (int k = 0; k < s->guard_count; k++)
    for (int q = 0; q < STATES; q++)
      s->guard_seen[k] |= out[k][q] != 0 ? 2 : 1;
  free_planes(out, s->guard_count);
}

static void compare_states(subject *s, long wanted, uint64_t *seed) {
  int fields = s->kernel->field_count,
      outs = RESULTS + fields > TANGENTS ? RESULTS + fields : TANGENTS;
  double **in = new_planes(INPUTS + fields, STATES),
         **out[2] = {new_planes(outs, STATES), new_planes(outs, STATES)};
  const double *const *const_in = (const double *const *)in;
  for (long done = 0; done < wanted; done += STATES) {
    fill_states(s, in, seed);
    if (s->guard_count) watch_guards(s, in);
    for (int tangent = 0; tangent < 2; tangent++) {
      int planes = tangent ? TANGENTS : RESULTS + fields;
      for (int k = 0; k < planes; k++) {
        poison(out[0][k], STATES);
        poison(out[1][k], STATES);
      }
      (tangent ? s->kernel->tangent : s->kernel->states)(s->kernel, s->uniforms, STATES, const_in,
                                                         out[0]);
      (tangent ? s->interpreted->tangent : s->interpreted->states)(
          s->interpreted, s->other_uniforms, STATES, const_in, out[1]);
      for (int k = 0; k < planes; k++)
        compare(&s->states, tangent ? "tangent" : "states", k, out[0][k], out[1][k], STATES);
    }
  }
  free_planes(in, INPUTS + fields);
  free_planes(out[0], outs);
  free_planes(out[1], outs);
}

/* --- strips --------------------------------------------------------------------------------------
 */

/* Arrays of a strip; the outputs are there twice, for the two readers. */
typedef struct strip_arrays {
  double **motion; /* [12][SITES + 1]: displacement of i, of j, velocity of i, of j */
  double **chord;  /* [2][SITES] */
  double **field[2], **force[2], **observed[2], **dissipated[2];
  int64_t *flags;
  int32_t *i, *j;
} strip_arrays;

enum { MOTIONS = 12, DIRECTION = 5 };

static strip_arrays arrays_new(const pl_law *k) {
  strip_arrays a = {.motion = new_planes(MOTIONS, SITES + 1), .chord = new_planes(2, SITES)};
  for (int side = 0; side < 2; side++) {
    a.field[side] = new_planes(k->field_count, SITES);
    a.force[side] = new_planes(k->force_planes, SITES);
    a.observed[side] = new_planes(1 + k->output_count, SITES);
    a.dissipated[side] = new_planes(2, SITES);
  }
  a.flags = aligned_alloc(PL_ALIGNMENT, SITES * sizeof *a.flags);
  a.i = must_calloc(SITES, sizeof *a.i);
  a.j = must_calloc(SITES, sizeof *a.j);
  return a;
}

static void arrays_free(strip_arrays *a, const pl_law *k) {
  free_planes(a->motion, MOTIONS);
  free_planes(a->chord, 2);
  for (int side = 0; side < 2; side++) {
    free_planes(a->field[side], k->field_count);
    free_planes(a->force[side], k->force_planes);
    free_planes(a->observed[side], 1 + k->output_count);
    free_planes(a->dissipated[side], 2);
  }
  free(a->flags);
  free(a->i);
  free(a->j);
}

/* Bond q turned as a whole by up to 14 rad, then deformed and rotated at its ends by any small or
 * large amount. */
static void fill_motion(strip_arrays *a, uint64_t *seed) {
  for (int q = 0; q <= SITES; q++) {
    double turn = q % 3 ? uniform(seed, -14, 14) : any_size(seed, -9, 0);
    double c_x = bond_class.chord[0], c_y = bond_class.chord[1],
           stretched = 1 + fmax(any_size(seed, -8, 0), -0.9);
    double x = stretched * (cos(turn) * c_x - sin(turn) * c_y) - c_x,
           y = stretched * (sin(turn) * c_x + cos(turn) * c_y) - c_y;
    double moved_x = any_size(seed, -9, -2), moved_y = any_size(seed, -9, -2);
    double values[MOTIONS] = {moved_x,     moved_y,     turn + any_size(seed, -9, 0),
                              moved_x + x, moved_y + y, turn + any_size(seed, -9, 0)};
    for (int k = 6; k < MOTIONS; k++)
      values[k] = any_size(seed, -6, 3);
    for (int k = 0; k < MOTIONS; k++)
      a->motion[k][q] = values[k];
  }
}

static void fill_bonds(strip_arrays *a, const pl_law *k, uint64_t *seed) {
  for (int q = 0; q < SITES; q++) {
    uint64_t kind = draw(seed) % 8; /* 0: absent, 1: protected */
    a->flags[q] =
        (int64_t)(draw(seed) & ~(uint64_t)(PL_PRESENT(DIRECTION) | PL_PROTECTED(DIRECTION)));
    a->flags[q] |=
        (kind != 0 ? PL_PRESENT(DIRECTION) : 0) | (kind == 1 ? PL_PROTECTED(DIRECTION) : 0);
    double angle = uniform(seed, -3.2, 3.2), size = uniform(seed, 2e-3, 2e-2);
    a->chord[0][q] = size * cos(angle);
    a->chord[1][q] = size * sin(angle);
    a->i[q] = (int32_t)(draw(seed) % SITES);
    a->j[q] = (int32_t)(draw(seed) % SITES);
    for (int f = 0; f < k->field_count; f++)
      a->field[0][f][q] = a->field[1][f][q] = any_field(seed, &k->fields[f]);
    for (int e = 0; e < 2; e++)
      a->dissipated[0][e][q] = a->dissipated[1][e][q] = any_size(seed, -6, 0);
  }
}

static pl_strip strip_of(strip_arrays *a, int side, bool list) {
  pl_strip s = {.count = list ? LISTED : SITES,
                .direction = DIRECTION,
                .flags = a->flags,
                .time_step = 1.7e-7,
                .field = a->field[side],
                .force = a->force[side],
                .observed = a->observed[side],
                .dissipated_state = a->dissipated[side][0],
                .dissipated_rate = a->dissipated[side][1]};
  for (int k = 0; k < 3; k++) {
    s.displacement_i[k] = a->motion[k];
    s.displacement_j[k] = a->motion[3 + k];
    s.velocity_i[k] = a->motion[6 + k];
    s.velocity_j[k] = a->motion[9 + k];
  }
  if (list) {
    s.i = a->i;
    s.j = a->j;
    s.chord[0] = a->chord[0];
    s.chord[1] = a->chord[1];
  }
  return s;
}

/* What a pass writes: forces and fields, dissipated energies, observed planes. */
typedef struct pass_case {
  const char *name;
  size_t function; /* offset in pl_law */
  bool list, forces, ledger, observes;
} pass_case;

static const pass_case pass_cases[] = {
    {"rows", offsetof(pl_law, rows), false, true, false, false},
    {"rows_ledger", offsetof(pl_law, rows_ledger), false, true, true, false},
    {"rows_observe", offsetof(pl_law, rows_observe), false, false, false, true},
    {"list", offsetof(pl_law, list), true, true, false, false},
    {"list_ledger", offsetof(pl_law, list_ledger), true, true, true, false},
    {"list_observe", offsetof(pl_law, list_observe), true, false, false, true},
};

static void run_pass(const pl_law *l, const pass_case *c, const double *uniforms,
                     const pl_strip *strip) {
  pl_strip_function f;
  memcpy(&f, (const char *)l + c->function, sizeof f);
  f(l, uniforms, strip);
}

static void assert_absent_is_left_alone(const strip_arrays *a, const pl_law *k, const pass_case *c,
                                        double *const *old, long count) {
  for (long q = 0; q < count; q++) {
    bool present = a->flags[q] & PL_PRESENT(DIRECTION),
         held = a->flags[q] & PL_PROTECTED(DIRECTION);
    for (int p = 0; c->forces && !present && p < k->force_planes; p++)
      assert_true(a->force[0][p][q] == 0);
    for (int f = 0; f < k->field_count; f++)
      if (!present || !c->forces || (held && k->fields[f].kind == PL_FIELD_DAMAGE))
        assert_memory_equal(&a->field[0][f][q], &old[f][q], sizeof(double));
  }
}

static void compare_outputs(subject *s, const strip_arrays *a, const pass_case *c, long count) {
  const pl_law *k = s->kernel;
  for (int p = 0; c->forces && p < k->force_planes; p++)
    compare(&s->strips, c->name, p, a->force[0][p], a->force[1][p], count);
  for (int f = 0; f < k->field_count; f++)
    compare(&s->strips, c->name, 20 + f, a->field[0][f], a->field[1][f], SITES);
  for (int e = 0; e < 2; e++)
    compare(&s->strips, c->name, 100 + e, a->dissipated[0][e], a->dissipated[1][e], SITES);
  for (int p = 0; c->observes && p < 1 + k->output_count; p++)
    compare(&s->strips, c->name, 200 + p, a->observed[0][p], a->observed[1][p], count);
}

static void compare_strip(subject *s, strip_arrays *a, const pass_case *c, uint64_t *seed) {
  const pl_law *k = s->kernel;
  fill_motion(a, seed);
  fill_bonds(a, k, seed);
  double **old = new_planes(k->field_count, SITES);
  for (int f = 0; f < k->field_count; f++)
    memcpy(old[f], a->field[0][f], SITES * sizeof(double));
  for (int side = 0; side < 2; side++) {
    for (int p = 0; p < k->force_planes; p++)
      poison(a->force[side][p], SITES);
    for (int p = 0; p < 1 + k->output_count; p++)
      poison(a->observed[side][p], SITES);
    pl_strip strip = strip_of(a, side, c->list);
    run_pass(side ? s->interpreted : k, c, side ? s->other_uniforms : s->uniforms, &strip);
  }
  compare_outputs(s, a, c, c->list ? LISTED : SITES);
  assert_absent_is_left_alone(a, k, c, old, c->list ? LISTED : SITES);
  free_planes(old, k->field_count);
}

static void compare_strips(subject *s, long wanted, uint64_t *seed) {
  strip_arrays a = arrays_new(s->kernel);
  for (long done = 0; done < wanted; done += SITES)
    for (size_t c = 0; c < sizeof pass_cases / sizeof *pass_cases; c++)
      compare_strip(s, &a, &pass_cases[c], seed);
  arrays_free(&a, s->kernel);
}

/* --- the text
 * ------------------------------------------------------------------------------------- */

/* Compiles the kernel again with more flags; what the compiler says (malloc'ed), or NULL without
 * such a compiler. */
static char *compiler_says(const subject *s, const char *compiler, const char *more) {
  char command[2000];
  snprintf(command, sizeof command, "%s --version >/dev/null 2>&1", compiler);
  if (system(command) != 0) return NULL;
  snprintf(command, sizeof command, "%s %s %s -o /dev/null -x c - 2>&1 <'%s/%s.c'", compiler,
           toolchain_flags(), more, toolchain_cache(), s->model.key);
  FILE *in = popen(command, "r");
  const size_t room = 1 << 20;
  char *said = must_calloc(room, 1);
  assert_true(fread(said, 1, room - 1, in) < room - 1);
  int status = pclose(in);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail_msg("%s: %s", command, said);
  return said;
}

static void assert_clean_and_vectorised(const subject *s) {
  const char *text = s->model.c_text,
             *loop = strstr(strstr(text, "static void rows("), "for (long q");
  char expected[64];
  int line = 1;
  for (const char *c = text; c < loop; c++)
    line += *c == '\n';
  snprintf(expected, sizeof expected, ":%d:3: optimized: loop vectorized", line);
  char *gcc = compiler_says(s, "gcc", "-Wall -Wextra -Werror -fopt-info-vec-optimized");
  if (gcc && !strstr(gcc, expected))
    fail_msg("the main loop of %s does not vectorise: %s", s->name, gcc);
  free(gcc);
  free(compiler_says(s, "clang", "-Wall -Wextra -Werror -Wno-unused-command-line-argument"));
}

/* --- all models
 * ------------------------------------------------------------------------------------ */

static void report(const subject *s) {
  int both = 0;
  for (int k = 0; k < s->guard_count; k++)
    both += s->guard_seen[k] == 3;
  print_message("%s: largest difference %g ulp over %ld values of states, %g ulp over %ld of "
                "strips; %d of %d conditions "
                "both true and false\n",
                s->name, s->states.largest, s->states.values, s->strips.largest, s->strips.values,
                both, s->guard_count);
  if (both < s->guard_count)
    fail_msg("%s: %d conditions were never both true and false", s->name, s->guard_count - both);
}

static void check_model(const char *path, long states) {
  subject s;
  uint64_t seed = 20;
  subject_open(&s, path);
  assert_clean_and_vectorised(&s);
  for (int set = 0; set < PARAMETER_SETS; set++) {
    choose_parameters(&s, set, &seed);
    compare_states(&s, states / PARAMETER_SETS, &seed);
    compare_strips(&s, states / (4 * PARAMETER_SETS), &seed);
  }
  report(&s);
  subject_close(&s);
}

static void check_folder(const char *pattern) {
  glob_t models;
  assert_int_equal(glob(pattern, 0, NULL, &models), 0);
  assert_true(models.gl_pathc > 0);
  for (size_t k = 0; k < models.gl_pathc; k++)
    check_model(models.gl_pathv[k], getenv("PERILAT_DEEP") ? 1000000 : 120000);
  globfree(&models);
}

static void kernels_of_the_models_match(void **state) {
  (void)state;
  check_folder(SOURCE_DIR "/models/*.plm");
}

/* Central bonds, plastic states, outputs, energies, shear and all functions. */
static void kernels_of_the_test_laws_match(void **state) {
  (void)state;
  check_folder(SOURCE_DIR "/tests/generator/laws/*.plm");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_of_the_models_match),
                                     cmocka_unit_test(kernels_of_the_test_laws_match)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
