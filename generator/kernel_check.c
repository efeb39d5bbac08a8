#include "generator/kernel_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "generator/interpret.h"

enum { INPUTS = 5, RESULTS = 3, TANGENTS = 12, BATCH = 512 };
static const char *const result_names[RESULTS] = {"N", "M_i", "M_j"};

double ulps_between(double a, double b) {
  if (a == b || (isnan(a) && isnan(b)))
    return 0;
  if (!isfinite(a) || !isfinite(b))
    return INFINITY;
  double larger = fmax(fabs(a), fabs(b));
  return fabs(a - b) / (nextafter(larger, INFINITY) - larger);
}

/* --- random states ------------------------------------------------------------------------------ */

/* splitmix64: any seed, any number of draws, the same everywhere. */
static uint64_t draw(uint64_t *state) {
  uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}
static double draw_unit(uint64_t *state) { return (double)(draw(state) >> 11) * 0x1p-53; }

/* Log-uniform size between 10^low and 10^high with either sign; exactly zero once in sixteen. */
static double draw_signed(uint64_t *state, double low, double high) {
  double u = draw_unit(state), size = pow(10.0, low + (high - low) * draw_unit(state));
  if (u < 1.0 / 16)
    return 0;
  return draw(state) & 1 ? size : -size;
}
static double draw_damage(uint64_t *state) {
  double u = draw_unit(state);
  return u < 0.3 ? 0 : u > 0.9 ? 1 : draw_unit(state);
}

static void draw_states(const pl_law *kernel, double s, uint64_t *seed, int count, double *const *in) {
  for (int q = 0; q < count; q++) {
    in[0][q] = fmax(draw_signed(seed, -9, 0), -0.9);
    in[1][q] = draw_signed(seed, -3, 6);
    in[2][q] = draw_signed(seed, -9, 0);
    in[3][q] = draw_signed(seed, -9, 0);
    in[4][q] = s * (1 + in[0][q]);
    for (int f = 0; f < kernel->field_count; f++)
      in[INPUTS + f][q] = kernel->fields[f].kind == PL_FIELD_DAMAGE
                              ? draw_damage(seed)
                              : kernel->fields[f].initial + draw_signed(seed, -9, 0);
  }
}

/* --- one comparison ----------------------------------------------------------------------------- */

typedef struct batch {
  double *in[INPUTS + 64], *out[2][RESULTS + 64], *tangent[2][TANGENTS];
  double *memory;
} batch;

static batch batch_new(int fields) {
  size_t columns = (size_t)(INPUTS + fields + 2 * (RESULTS + fields) + 2 * TANGENTS);
  batch b = {.memory = must_calloc(columns * BATCH, sizeof(double))};
  double *at = b.memory;
  for (int k = 0; k < INPUTS + fields; k++, at += BATCH)
    b.in[k] = at;
  for (int side = 0; side < 2; side++) {
    for (int k = 0; k < RESULTS + fields; k++, at += BATCH)
      b.out[side][k] = at;
    for (int k = 0; k < TANGENTS; k++, at += BATCH)
      b.tangent[side][k] = at;
  }
  return b;
}

/* A NaN that no computation makes: an output that still holds it was not written. */
static double poison(void) {
  uint64_t bits = UINT64_C(0x7ff4dead00000bad);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}
static bool is_poison(double value) {
  double p = poison();
  return memcmp(&value, &p, sizeof value) == 0;
}

static void compare(kernel_check *c, const char *what, const double *kernel, const double *reference, int count) {
  for (int q = 0; q < count; q++) {
    c->unwritten += is_poison(kernel[q]);
    double distance = ulps_between(kernel[q], reference[q]);
    if (distance > c->largest_ulps) {
      c->largest_ulps = distance;
      c->worst = what;
    }
  }
}

static void compare_batch(kernel_check *c, const pl_law *kernel, const pl_law *reference, const double *uniforms,
                          const double *reference_uniforms, batch *b, int count) {
  const int fields = kernel->field_count;
  for (int k = 0; k < RESULTS + fields; k++)
    for (int q = 0; q < count; q++)
      b->out[0][k][q] = poison();
  for (int k = 0; k < TANGENTS; k++)
    for (int q = 0; q < count; q++)
      b->tangent[0][k][q] = poison();
  const double *const *in = (const double *const *)b->in;
  kernel->states(kernel, uniforms, count, in, b->out[0]);
  reference->states(reference, reference_uniforms, count, in, b->out[1]);
  kernel->tangent(kernel, uniforms, count, in, b->tangent[0]);
  reference->tangent(reference, reference_uniforms, count, in, b->tangent[1]);
  for (int k = 0; k < RESULTS + fields; k++)
    compare(c, k < RESULTS ? result_names[k] : kernel->fields[k - RESULTS].name, b->out[0][k], b->out[1][k], count);
  for (int k = 0; k < TANGENTS; k++)
    compare(c, "tangent", b->tangent[0][k], b->tangent[1][k], count);
}

/* --- guards ------------------------------------------------------------------------------------- */

typedef struct guard_watch {
  interpreter *interpreter;
  int count;
  double **seen;        /* values of a batch */
  unsigned char *found; /* bit 0: false seen, bit 1: true seen */
} guard_watch;

/* Conditions of all selects that the law's states need. */
static guard_watch watch_guards(const kernel_plan *p) {
  const pass *states = &p->passes[PASS_STATES];
  unsigned char *marks = must_calloc((size_t)ir_count(p->graph), 1);
  for (int k = 0; k < states->root_count; k++)
    ir_mark(p->graph, &states->roots[k].node, 1, marks);
  guard_watch w = {.count = 0};
  ir_node *conditions = must_calloc((size_t)ir_count(p->graph), sizeof *conditions);
  for (ir_node n = 0; n < ir_count(p->graph); n++) {
    if (!marks[n] || ir_operation(p->graph, n) != IR_SELECT)
      continue;
    ir_node condition = ir_operand(p->graph, n, 0);
    bool known = ir_place(p->graph, condition) <= ON_BODY;
    for (int k = 0; k < w.count; k++)
      known = known || conditions[k] == condition;
    if (!known)
      conditions[w.count++] = condition;
  }
  w.interpreter = interpreter_new(p->graph, conditions, w.count);
  w.found = must_calloc((size_t)w.count + 1, 1);
  w.seen = must_calloc((size_t)w.count + 1, sizeof *w.seen);
  for (int k = 0; k < w.count; k++)
    w.seen[k] = must_calloc(BATCH, sizeof(double));
  free(conditions);
  free(marks);
  return w;
}

static void unwatch_guards(guard_watch *w) {
  interpreter_free(w->interpreter);
  for (int k = 0; k < w->count; k++)
    free(w->seen[k]);
  free(w->seen);
  free(w->found);
}

/* Values of the quantities, from a bond class and the kinematics of states. */
typedef struct quantity_table {
  double fixed[QUANTITY_COUNT];
  const double *values[QUANTITY_COUNT];
  unsigned char stride[QUANTITY_COUNT];
} quantity_table;

static void fill_quantities(quantity_table *t, const pl_bond_class *c, double *const *kinematics) {
  memset(t, 0, sizeof *t);
  const struct {
    int quantity;
    double value;
  } fixed[] = {{QUANTITY_S, c->s},           {QUANTITY_SPACING, c->spacing},
               {QUANTITY_T, c->t},           {QUANTITY_V, c->V},
               {QUANTITY_M_END_I, c->mass_i}, {QUANTITY_M_END_J, c->mass_j},
               {QUANTITY_M_BOND, fmin(c->mass_i, c->mass_j)}, {QUANTITY_AREA, c->area},
               {QUANTITY_SHELL, c->shell},   {QUANTITY_N_FAMILY, c->n}};
  for (int q = 0; q < QUANTITY_COUNT; q++)
    t->values[q] = &t->fixed[q];
  for (size_t k = 0; k < sizeof fixed / sizeof *fixed; k++)
    t->fixed[fixed[k].quantity] = fixed[k].value;
  static const int moving[INPUTS] = {QUANTITY_STRETCH, QUANTITY_STRETCH_RATE, QUANTITY_THETA_I, QUANTITY_THETA_J,
                                     QUANTITY_LENGTH};
  for (int k = 0; k < INPUTS; k++) {
    t->values[moving[k]] = kinematics[k];
    t->stride[moving[k]] = 1;
  }
}

static interpreter_inputs law_inputs(const quantity_table *t, const double *const *parameters,
                                     double *const *fields, const unsigned char *ones) {
  interpreter_inputs in = {{0}, {0}};
  in.values[IR_FROM_PARAMETER] = parameters;
  in.values[IR_FROM_QUANTITY] = t->values;
  in.stride[IR_FROM_QUANTITY] = t->stride;
  in.values[IR_FROM_FIELD] = (const double *const *)fields;
  in.stride[IR_FROM_FIELD] = ones;
  return in;
}

static const double **parameter_pointers(const double *parameters, int count) {
  const double **pointers = must_calloc((size_t)count + 1, sizeof *pointers);
  for (int k = 0; k < count; k++)
    pointers[k] = &parameters[k];
  return pointers;
}

static void watch_batch(guard_watch *w, const interpreter_inputs *in, int count) {
  interpreter_run(w->interpreter, in, count, w->seen);
  for (int k = 0; k < w->count; k++)
    for (int q = 0; q < count; q++)
      w->found[k] |= w->seen[k][q] != 0 ? 2 : 1;
}

/* --- the check ---------------------------------------------------------------------------------- */

static const pl_bond_class usual_bond = {.s = 6.35e-3, .spacing = 6.35e-3, .t = 0.1524, .V = 5.32e-6,
                                         .mass_i = 0.01236, .mass_j = 0.01236, .area = 1e-4, .shell = 1, .n = 6,
                                         .chord = {6.35e-3, 0, 0}};

kernel_check kernel_check_run(const kernel_plan *p, const pl_law *kernel, const double *parameters, long count,
                              uint64_t seed) {
  kernel_check c = {.states = count};
  pl_law *reference = plan_interpreted(p, "");
  double *uniforms = must_calloc((size_t)kernel->uniform_count + 1, sizeof(double));
  double *reference_uniforms = must_calloc((size_t)reference->uniform_count + 1, sizeof(double));
  kernel->prepare(kernel, parameters, &usual_bond, uniforms);
  reference->prepare(reference, parameters, &usual_bond, reference_uniforms);
  batch b = batch_new(kernel->field_count);
  guard_watch guards = watch_guards(p);
  const double **pointers = parameter_pointers(parameters, kernel->parameter_count);
  unsigned char ones[64];
  memset(ones, 1, sizeof ones);
  for (long done = 0; done < count; done += BATCH) {
    int now = count - done < BATCH ? (int)(count - done) : BATCH;
    draw_states(kernel, usual_bond.s, &seed, now, b.in);
    compare_batch(&c, kernel, reference, uniforms, reference_uniforms, &b, now);
    quantity_table quantities;
    fill_quantities(&quantities, &usual_bond, b.in);
    interpreter_inputs in = law_inputs(&quantities, pointers, &b.in[INPUTS], ones);
    watch_batch(&guards, &in, now);
  }
  c.guards = guards.count;
  for (int k = 0; k < guards.count; k++)
    c.guards_both += guards.found[k] == 3;
  unwatch_guards(&guards);
  free(pointers);
  free(b.memory);
  free(uniforms);
  free(reference_uniforms);
  plan_interpreted_free(reference);
  return c;
}

bool kernel_check_report(const kernel_plan *p, const pl_law *kernel, const double *parameters, long count, FILE *out) {
  kernel_check c = kernel_check_run(p, kernel, parameters, count, 1);
  fprintf(out, "kernel check: %s on %ld random states (%d of %d guards seen both ways): largest difference from the "
               "interpreter %.3g ulp%s%s%s\n",
          kernel->name, c.states, c.guards_both, c.guards, c.largest_ulps, c.worst ? " in " : "",
          c.worst ? c.worst : "", c.unwritten ? "; some outputs were not written" : "");
  return c.largest_ulps <= 1 && c.unwritten == 0;
}

void kernel_check_explain_bad(const kernel_plan *p, const double *parameters,
                              const rows *w, const bad_state *b, FILE *out) {
  const pass *states = &p->passes[PASS_STATES];
  ir_node *roots = must_calloc((size_t)states->root_count, sizeof *roots);
  double **sink = must_calloc((size_t)states->root_count, sizeof *sink);
  double *values = must_calloc((size_t)states->root_count, sizeof *values);
  for (int k = 0; k < states->root_count; k++) {
    roots[k] = states->roots[k].node;
    sink[k] = &values[k];
  }
  double kinematics[INPUTS] = {b->stretch, b->stretch_rate, b->theta_i, b->theta_j, w->spacing * (1 + b->stretch)};
  double *in_pointers[INPUTS];
  for (int k = 0; k < INPUTS; k++)
    in_pointers[k] = &kinematics[k];
  pl_bond_class bond = rows_bond_class(w, 0);
  quantity_table quantities;
  fill_quantities(&quantities, &bond, in_pointers);
  int fields = p->law->fields.count;
  double *field_values = must_calloc((size_t)fields + 1, sizeof *field_values);
  double **field_pointers = must_calloc((size_t)fields + 1, sizeof *field_pointers);
  for (int f = 0; f < fields; f++) {
    field_values[f] = f < b->field_count ? b->fields[f] : p->law->fields.items[f]->initial;
    field_pointers[f] = &field_values[f];
  }
  const double **pointers = parameter_pointers(parameters, p->law->parameters.count);
  interpreter *program = interpreter_new(p->graph, roots, states->root_count);
  interpreter_inputs in = law_inputs(&quantities, pointers, field_pointers, NULL);
  interpreter_run(program, &in, 1, sink);
  ir_node bad = interpreter_first_bad(program);
  while (bad != IR_NONE && !ir_name(p->graph, bad) && bad + 1 < ir_count(p->graph))
    bad++; /* the named quantity that it goes into stands behind it */
  if (bad != IR_NONE && ir_name(p->graph, bad)) {
    span where = ir_where(p->graph, bad);
    place at = source_place(p->law->sources, where.file, where.begin);
    fprintf(out, "  the law's `%s` (line %d) stops being finite there\n", ir_name(p->graph, bad), at.line);
  }
  interpreter_free(program);
  free(pointers);
  free(field_values);
  free(field_pointers);
  free(roots);
  free(sink);
  free(values);
}
