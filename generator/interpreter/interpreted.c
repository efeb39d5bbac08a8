/* Several threads may call a kernel: each call borrows a worker, made in advance, so that a step
   allocates nothing. */
#include "generator/interpreter/interpreted.h"

#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "generator/interpreter/interpreted_family.h"
#include "generator/ir/interpret.h"
#include "generator/lower/law_inputs.h"
#include "generator/plan/program_facts.h"

enum { LANES = INTERPRET_LANES, RUN_PREPARE = PASS_COUNT, RUN_COUNT, MOST_WORKERS = 64 };

/* One caller's working space. */
typedef struct worker {
  atomic_flag busy;
  interpreter *run[RUN_COUNT];
  family_runner *family;     /* of a law of families */
  const double **parameters; /* [parameters + uniforms] */
  const double **fields;     /* [fields] */
  unsigned char *field_stride;
  const double **bond_parameters; /* [varying] */
  unsigned char *bond_parameter_stride;
  double of_class[QUANTITY_COUNT];
  const double *quantities[QUANTITY_COUNT];
  const double *ends[ENDS_COUNT];
  unsigned char quantity_stride[QUANTITY_COUNT];
  double is_protected[LANES];
  double *results; /* [most roots][LANES] */
  double **result; /* [most roots] */
} worker;

typedef struct interpreted {
  pl_law law; /* first: what callers hold */
  const kernel_plan *plan;
  arena *memory;
  ir_node *roots[RUN_COUNT]; /* with inputs in place of the hoisted values */
  int root_count[RUN_COUNT];
  int most_roots;
  ir_node *inputs; /* [uniform_count] that stand for hoisted values */
  int worker_count;
  worker *workers;
} interpreted;

/* --- workers ---------------------------------------------------------------------------------- */

static worker *borrow(const pl_law *kernel) {
  const interpreted *p = kernel->context;
  for (;;) {
    for (int k = 0; k < p->worker_count; k++)
      if (!atomic_flag_test_and_set_explicit(&p->workers[k].busy, memory_order_acquire))
        return &p->workers[k];
    sched_yield(); /* more callers than workers: one will be back in a moment */
  }
}

static void give_back(worker *w) {
  atomic_flag_clear_explicit(&w->busy, memory_order_release);
}

static void set_up_worker(interpreted *p, worker *w) {
  const kernel_plan *plan = p->plan;
  size_t fields = (size_t)plan->law->fields.count;
  size_t parameters = (size_t)(plan->law->parameters.count + plan->uniform_count);
  atomic_flag_clear(&w->busy);
  for (int k = 0; k < RUN_COUNT; k++)
    if (p->root_count[k] > 0)
      w->run[k] = interpreter_new(plan->graph, p->roots[k], p->root_count[k]);
  if (plan->kind == PL_STATE) w->family = family_runner_new(plan, p->inputs);
  w->parameters = arena_alloc(p->memory, (parameters + 1) * sizeof *w->parameters);
  w->fields = arena_alloc(p->memory, (fields + 1) * sizeof *w->fields);
  w->field_stride = arena_alloc(p->memory, fields + 1);
  memset(w->field_stride, 1, fields + 1);
  size_t varying = (size_t)plan->variation.varying_count;
  w->bond_parameters = arena_alloc(p->memory, (varying + 1) * sizeof *w->bond_parameters);
  w->bond_parameter_stride = arena_alloc(p->memory, varying + 1);
  memset(w->bond_parameter_stride, 1, varying + 1);
  size_t most = (size_t)p->most_roots;
  w->results = arena_alloc(p->memory, (most + 1) * LANES * sizeof *w->results);
  w->result = arena_alloc(p->memory, (most + 1) * sizeof *w->result);
  for (int k = 0; k < QUANTITY_COUNT; k++)
    w->quantities[k] = &w->of_class[k];
  for (int k = 0; k < PL_STATE_INPUTS; k++)
    w->quantity_stride[law_motion[k]] = 1;
  for (size_t k = 0; k < most; k++)
    w->result[k] = w->results + k * LANES;
}

/* Values of the ends vary from bond to bond, except those of the whole strip. */
static const unsigned char ends_stride[ENDS_COUNT] = {
#define X(code, name, array, owner, component) [ENDS_##code] = (owner) != OF_STRIP,
    ENDS_INPUTS(X)
#undef X
};

static interpreter_inputs inputs_of(const worker *w) {
  interpreter_inputs in = {
      .values = {[IR_FROM_PARAMETER] = w->parameters,
                 [IR_FROM_QUANTITY] = w->quantities,
                 [IR_FROM_FIELD] = w->fields,
                 [IR_FROM_BOND_PARAMETER] = w->bond_parameters,
                 [IR_FROM_ENDS] = w->ends},
      .stride = {[IR_FROM_QUANTITY] = w->quantity_stride,
                 [IR_FROM_FIELD] = w->field_stride,
                 [IR_FROM_BOND_PARAMETER] = w->bond_parameter_stride,
                 [IR_FROM_ENDS] = ends_stride},
  };
  return in;
}

static void point_at_uniforms(const interpreted *p, worker *w, const double *uniforms) {
  int parameters = p->plan->law->parameters.count;
  for (int k = 0; k < p->plan->uniform_count; k++)
    w->parameters[parameters + k] = uniforms + k;
}

/* --- strips ----------------------------------------------------------------------------------- */

static const double *strip_array(const pl_strip *s, const ends_origin *o) {
  switch (o->array) {
  case FROM_DISPLACEMENT:
    return o->owner == OF_I ? s->displacement_i[o->component] : s->displacement_j[o->component];
  case FROM_VELOCITY:
    return o->owner == OF_I ? s->velocity_i[o->component] : s->velocity_j[o->component];
  default:
    return NULL;
  }
}

/* Arrays that strips, or a law without rotations, do not have stay NULL: no root needs them. */
static void point_at_ends(worker *w, const pl_strip *s, long first, int count) {
  for (int k = 0; k < ENDS_COUNT; k++) {
    const double *array = strip_array(s, &ends_origins[k]);
    w->ends[k] = array ? array + first : NULL;
  }
  for (int lane = 0; lane < count; lane++)
    w->is_protected[lane] = s->flags[first + lane] & PL_PROTECTED(s->direction) ? 1 : 0;
  w->ends[ENDS_PROTECTED] = w->is_protected;
  w->ends[ENDS_TIME_STEP] = &s->time_step;
}

static void store(const pass_root *r, const pl_strip *s, long first, int count,
                  const double *from) {
  const int64_t *flags = s->flags + first;
  const int64_t present = PL_PRESENT(s->direction);
  for (int k = 0; k < count; k++) {
    bool here = (flags[k] & present) != 0;
    long at = first + k;
    switch (r->target) {
    case TO_FORCE:
      s->force[r->index][at] = here ? from[k] : 0;
      break;
    case TO_FIELD:
      if (here) s->field[r->index][at] = from[k];
      break;
    case TO_DISSIPATED_STATE:
      s->dissipated_state[at] += here ? from[k] : 0;
      break;
    case TO_DISSIPATED_RATE:
      s->dissipated_rate[at] += here ? from[k] : 0;
      break;
    default:
      s->observed[r->index][at] = here ? from[k] : 0;
    }
  }
}

static void run_strip(const pl_law *kernel, const double *uniforms, const pl_strip *s,
                      pass_kind kind) {
  const interpreted *p = kernel->context;
  const pass *a = &p->plan->passes[kind];
  worker *w = borrow(kernel);
  point_at_uniforms(p, w, uniforms);
  for (long first = 0; first < s->count; first += LANES) {
    int count = s->count - first < LANES ? (int)(s->count - first) : LANES;
    point_at_ends(w, s, first, count);
    for (int k = 0; k < p->plan->law->fields.count; k++)
      w->fields[k] = s->field[k] + first;
    for (int k = 0; k < p->plan->variation.varying_count; k++)
      w->bond_parameters[k] = s->parameter[k] + first;
    interpreter_inputs in = inputs_of(w);
    interpreter_run(w->run[kind], &in, count, w->result);
    for (int k = 0; k < a->root_count; k++)
      store(&a->roots[k], s, first, count, w->result[k]);
  }
  give_back(w);
}

#define X(pass, member, task)                                                                      \
  static void run_##member(const pl_law *kernel, const double *uniforms, const pl_strip *s) {      \
    run_strip(kernel, uniforms, s, pass);                                                          \
  }
STRIP_PASSES(X)
#undef X

/* --- single states ---------------------------------------------------------------------------- */

static void run_law(const pl_law *kernel, const double *uniforms, const pl_states *s,
                    pass_kind kind) {
  const int results = kind == PASS_TANGENT ? PL_TANGENTS : PL_STATE_RESULTS;
  const interpreted *p = kernel->context;
  const pass *a = &p->plan->passes[kind];
  worker *w = borrow(kernel);
  point_at_uniforms(p, w, uniforms);
  for (long first = 0; first < s->count; first += LANES) {
    int now = s->count - first < LANES ? (int)(s->count - first) : LANES;
    for (int k = 0; k < PL_STATE_INPUTS; k++)
      w->quantities[law_motion[k]] = s->in[k] + first;
    for (int k = 0; k < p->plan->law->fields.count; k++)
      w->fields[k] = s->field[k] + first;
    interpreter_inputs inputs = inputs_of(w);
    interpreter_run(w->run[kind], &inputs, now, w->result);
    for (int k = 0; k < a->root_count; k++) {
      const int index = a->roots[k].index;
      double *to = index < results ? s->out[index] : s->new_field[index - results];
      memcpy(to + first, w->result[k], (size_t)now * sizeof(double));
    }
  }
  give_back(w);
}

static void run_states(const pl_law *kernel, const double *uniforms, const pl_states *s) {
  run_law(kernel, uniforms, s, PASS_STATES);
}

static void run_tangent(const pl_law *kernel, const double *uniforms, const pl_states *s) {
  run_law(kernel, uniforms, s, PASS_TANGENT);
}

/* --- values of a bond class, bounds ----------------------------------------------------------- */

static void run_prepare(const pl_law *kernel, const double *parameters, const pl_bond_class *bonds,
                        double *uniforms) {
  const interpreted *p = kernel->context;
  worker *w = borrow(kernel);
  law_class_values(bonds, w->of_class);
  w->ends[ENDS_CLASS_CHORD_X] = &bonds->chord[0];
  w->ends[ENDS_CLASS_CHORD_Y] = &bonds->chord[1];
  w->ends[ENDS_CLASS_CHORD_Z] = &bonds->chord[2];
  for (int k = 0; k < p->plan->law->parameters.count; k++)
    w->parameters[k] = parameters + k;
  interpreter_inputs in = inputs_of(w);
  if (w->run[RUN_PREPARE]) interpreter_run(w->run[RUN_PREPARE], &in, 1, w->result);
  for (int k = 0; k < p->plan->uniform_count; k++)
    uniforms[k] = w->result[k][0];
  give_back(w);
}

static void run_bounds(const pl_law *kernel, const double *parameters, double *lower, double *upper,
                       unsigned char *low_open, unsigned char *high_open) {
  const interpreted *p = kernel->context;
  const pass *a = &p->plan->passes[PASS_BOUNDS];
  const symbol_list *list = &p->plan->law->parameters;
  worker *w = borrow(kernel);
  for (int k = 0; k < list->count; k++) {
    w->parameters[k] = parameters + k;
    low_open[k] = list->items[k]->declared->in.lower_open;
    high_open[k] = list->items[k]->declared->in.upper_open;
  }
  interpreter_inputs in = inputs_of(w);
  if (w->run[PASS_BOUNDS]) interpreter_run(w->run[PASS_BOUNDS], &in, 1, w->result);
  for (int k = 0; k < a->root_count; k++)
    (a->roots[k].target == TO_LOWER ? lower : upper)[a->roots[k].index] = w->result[k][0];
  give_back(w);
}

/* --- programs of families --------------------------------------------------------------------- */

static void run_family(const pl_law *kernel, const double *uniforms, const pl_family *family,
                       runner_program which, int number) {
  worker *w = borrow(kernel);
  family_runner_run(w->family, which, number, uniforms, family);
  give_back(w);
}

/* One function for each pass that a program may have. */
#define PASS_NUMBERS(X) X(0) X(1) X(2) X(3) X(4) X(5) X(6) X(7)
#define RUN(name, which, n)                                                                        \
  static void run_##name##_##n(const pl_law *k, const double *u, const pl_family *f) {             \
    run_family(k, u, f, which, n);                                                                 \
  }
#define X(n) RUN(step, RUN_STEP, n) RUN(losses, RUN_LOSSES, n) RUN(observe, RUN_OBSERVE, n)
PASS_NUMBERS(X)
#undef X
static const pl_family_function passes_of[RUN_PROGRAMS][PLAN_MOST_PASSES] = {
#define X(n)                                                                                       \
  [RUN_STEP][n] = run_step_##n, [RUN_LOSSES][n] = run_losses_##n,                                  \
  [RUN_OBSERVE][n] = run_observe_##n,
    PASS_NUMBERS(X)
#undef X
};

/* --- the descriptor --------------------------------------------------------------------------- */

static const char *unit_text(arena *memory, const symbol *s) {
  char text[64];
  dim_unit(s->dim, text, sizeof text);
  return arena_text(memory, text, strlen(text));
}

static const pl_parameter *describe_parameters(arena *memory, const symbol_list *list) {
  pl_parameter *all = arena_alloc(memory, ((size_t)list->count + 1) * sizeof *all);
  for (int k = 0; k < list->count; k++) {
    const symbol *s = list->items[k];
    all[k] = (pl_parameter){s->name, unit_text(memory, s), s->doc ? s->doc : "", s->initial,
                            s->has_default};
  }
  return all;
}

static const pl_input *describe_state_inputs(arena *memory) {
  pl_input *all = arena_alloc(memory, PL_STATE_INPUTS * sizeof *all);
  law_state_inputs(all);
  return all;
}

static int field_kind(const symbol *s) {
  if (s->kind == SYMBOL_DAMAGE) return PL_FIELD_DAMAGE;
  return s->kind == SYMBOL_STATE ? PL_FIELD_STATE : PL_FIELD_OUTPUT;
}

static int field_place(const symbol *s) {
  if (s->place <= ON_PARTICLE) return PL_ON_PARTICLE;
  return s->place == ON_BOND ? PL_ON_BOND : PL_ON_NEIGHBOUR;
}

static const pl_field *describe_fields(arena *memory, const symbol_list *list) {
  pl_field *all = arena_alloc(memory, ((size_t)list->count + 1) * sizeof *all);
  for (int k = 0; k < list->count; k++) {
    const symbol *s = list->items[k];
    all[k] = (pl_field){s->name,    unit_text(memory, s), s->doc ? s->doc : "",
                        s->initial, field_kind(s),        field_place(s)};
  }
  return all;
}

static pl_program program_facts(arena *memory, const ir *g, const family_program *p,
                                const pl_family_function *passes) {
  uint64_t *shared = arena_alloc(memory, ((size_t)p->pass_count + 1) * sizeof *shared);
  for (int k = 0; k < p->pass_count; k++)
    shared[k] = program_shared_by(&p->passes[k]);
  return (pl_program){.pass_count = p->pass_count,
                      .pass = passes,
                      .at_hand = program_at_hand(g, p),
                      .upward = program_upward(g, p),
                      .spared = program_reaches_spared(g, p),
                      .shared = shared};
}

/* The passes of a step, then those of its losses. */
static pl_program ledger_facts(arena *memory, const kernel_plan *plan) {
  const family_program ledger = program_joined(memory, "ledger", &plan->step, &plan->losses);
  pl_family_function *passes =
      arena_alloc(memory, ((size_t)ledger.pass_count + 1) * sizeof *passes);
  for (int k = 0; k < ledger.pass_count; k++)
    passes[k] = k < plan->step.pass_count ? passes_of[RUN_STEP][k]
                                          : passes_of[RUN_LOSSES][k - plan->step.pass_count];
  return program_facts(memory, plan->graph, &ledger, passes);
}

static void describe(interpreted *p) {
  const kernel_plan *plan = p->plan;
  const law *l = plan->law;
  p->law = (pl_law){
      .abi = PL_KERNEL_ABI,
      .size = sizeof(pl_law),
      .kind = plan->kind,
      .dimensions = plan->dimensions,
      .dof = plan->dof,
      .force_planes = plan->force_planes,
      .name = l->tree->name,
      .key = "",
      .parameter_count = l->parameters.count,
      .parameters = describe_parameters(p->memory, &l->parameters),
      .density = l->rho ? l->rho->index : -1,
      .varying_count = plan->variation.varying_count,
      .varying = plan->variation.varying,
      .field_count = l->fields.count,
      .fields = describe_fields(p->memory, &l->fields),
      .output_count = l->outputs.count,
      .outputs = describe_fields(p->memory, &l->outputs),
      .stores = plan->stores,
      .reads_rates = plan->reads_rates,
      .uniform_count = plan->uniform_count,
      .flops_per_bond = plan->flops_per_bond,
      .divisions_per_bond = plan->divisions_per_bond,
      .prepare = run_prepare,
      .bounds = run_bounds,
#define X(pass, member, task) .member = run_##member,
      STRIP_PASSES(X)
#undef X
          .state_input_count = PL_STATE_INPUTS,
      .state_inputs = describe_state_inputs(p->memory),
      .states = run_states,
      .tangent = run_tangent,
      .context = p,
  };
  if (plan->kind != PL_STATE) return;
  p->law.rows = p->law.rows_ledger = p->law.rows_observe = NULL;
  p->law.state_input_count = 0;
  p->law.state_inputs = NULL;
  p->law.states = NULL;
  p->law.tangent = NULL;
  p->law.link_count = plan->links.of_particles;
  p->law.bond_link_count = plan->links.of_bonds;
  p->law.sum_count = program_sum_count(&plan->step);
  p->law.reads_shape = plan->reads_shape;
  p->law.reads_share = plan->reads_share;
  p->law.reads_mass = plan->reads_mass;
  p->law.varying_place = l->tree->law == LAW_STATE ? PL_ON_PARTICLE : PL_ON_BOND;
  p->law.pairwise = l->tree->law != LAW_STATE;
  p->law.topology = l->irregular ? PL_LIST : PL_ROWS;
  p->law.step = program_facts(p->memory, plan->graph, &plan->step, passes_of[RUN_STEP]);
  p->law.observe = program_facts(p->memory, plan->graph, &plan->observe, passes_of[RUN_OBSERVE]);
  if (plan->losses.pass_count) p->law.ledger = ledger_facts(p->memory, plan);
}

/* --- making and freeing ----------------------------------------------------------------------- */

/* Roots in which each hoisted value is an input, numbered after the parameters: as in compiled
   kernels it is computed in `prepare` and read by strips. */
static void take_roots(interpreted *p, int run, const ir_node *inputs) {
  const kernel_plan *plan = p->plan;
  const pass *a = &plan->passes[run];
  p->root_count[run] = a->root_count;
  p->roots[run] = arena_alloc(p->memory, ((size_t)a->root_count + 1) * sizeof(ir_node));
  for (int k = 0; k < a->root_count; k++)
    p->roots[run][k] = a->roots[k].node;
  if (run != PASS_BOUNDS)
    ir_substitute(plan->graph, p->roots[run], a->root_count, plan->uniforms, inputs,
                  plan->uniform_count, p->roots[run]);
}

static void take_all_roots(interpreted *p) {
  const kernel_plan *plan = p->plan;
  size_t bytes = ((size_t)plan->uniform_count + 1) * sizeof(ir_node);
  ir_node *inputs = arena_alloc(p->memory, bytes);
  for (int k = 0; k < plan->uniform_count; k++) {
    const char *name = ir_name(plan->graph, plan->uniforms[k]);
    inputs[k] = ir_input(plan->graph, IR_FROM_PARAMETER, plan->law->parameters.count + k,
                         name ? name : "uniform", ON_BODY);
  }
  p->inputs = inputs;
  for (int run = 0; run < PASS_COUNT; run++)
    take_roots(p, run, inputs);
  p->roots[RUN_PREPARE] = plan->uniforms;
  p->root_count[RUN_PREPARE] = plan->uniform_count;
  for (int run = 0; run < RUN_COUNT; run++)
    if (p->root_count[run] > p->most_roots) p->most_roots = p->root_count[run];
}

/* One for each processor: more callers than that would only wait for processors. */
static int count_workers(void) {
  long processors = sysconf(_SC_NPROCESSORS_ONLN);
  return processors < 1 ? 1 : processors > MOST_WORKERS ? MOST_WORKERS : (int)processors;
}

pl_law *plan_interpreted(const kernel_plan *plan) {
  interpreted *p = must_calloc(1, sizeof *p);
  p->plan = plan;
  p->memory = arena_new();
  take_all_roots(p);
  describe(p);
  p->worker_count = count_workers();
  p->workers = must_calloc((size_t)p->worker_count, sizeof *p->workers);
  for (int k = 0; k < p->worker_count; k++)
    set_up_worker(p, &p->workers[k]);
  return &p->law;
}

void plan_interpreted_free(pl_law *kernel) {
  if (!kernel) return;
  interpreted *p = (interpreted *)kernel;
  for (int k = 0; k < p->worker_count; k++)
    for (int run = 0; run < RUN_COUNT; run++)
      interpreter_free(p->workers[k].run[run]);
  for (int k = 0; k < p->worker_count; k++)
    family_runner_free(p->workers[k].family);
  free(p->workers);
  arena_free(p->memory);
  free(p);
}
